"""What else a campaign tells: the closed loop, coherence, covariances of spectra, and estimates by other names."""

import numpy as np
import pytest

import frfid

T, N, LINES = 1e-3, 200, np.arange(3, 90)
PLANT, CONTROLLER = 1.3 * np.exp(0.5j), 0.9 * np.exp(-0.6j)


def periods(spectra):
    """(..., line) to (..., sample)."""
    full = np.zeros(spectra.shape[:-1] + (N // 2 + 1,), complex)
    full[..., LINES] = spectra
    return np.fft.irfft(full, N)


def campaign(disturbance, n_p=5, n_q=4, seed=1):
    """One axis under u = C (r - y), a disturbance at the output: u, y, r (realization, experiment, period, channel, sample)."""
    rng = np.random.default_rng(seed)
    shape = (n_p, 1, n_q, 1, len(LINES))
    r = np.broadcast_to(np.exp(2j * np.pi * rng.random((n_p, 1, 1, 1, len(LINES)))), shape)
    v = disturbance * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2)
    y = (PLANT * CONTROLLER * r + v) / (1 + PLANT * CONTROLLER)
    return (periods(x) for x in (CONTROLLER * (r - y), y, r))


OPTIONS = {"sample_time_s": T, "harmonics": LINES}


def test_the_loop_has_every_response():
    u, y, r = campaign(0.02)
    found = frfid.estimate_loop(u, y, r, loop="set-point", **OPTIONS)
    sensitivity = 1 / (1 + PLANT * CONTROLLER)
    truth = {
        "u_to_y": PLANT, "r_to_u": CONTROLLER * sensitivity, "r_to_y": 1 - sensitivity, "sensitivity": sensitivity,
        "complementary_sensitivity": 1 - sensitivity, "open_loop": PLANT * CONTROLLER,
    }
    assert set(found) == set(truth)
    for name, frf in found.items():
        error = np.abs(frf.response[:, 0, 0] - truth[name]) ** 2
        dof = frf.noise_degrees_of_freedom
        assert 0.88 < np.mean(error <= frf.noise_variance[:, 0, 0] * dof * (0.05 ** (-1 / dof) - 1)) <= 1, name
    assert set(frfid.estimate_loop(u, y, r, **OPTIONS)) == {"u_to_y", "r_to_u", "r_to_y"}
    with pytest.raises(ValueError, match="loop: unknown variant"):
        frfid.estimate_loop(u, y, r, loop="inner", **OPTIONS)


def test_coherence_is_that_of_numpy_and_its_interval_holds():
    u, y, _ = campaign(0.0)
    y = y + 0.05 * np.random.default_rng(2).standard_normal(y.shape)
    value, low, high = frfid.coherence(u, y, **OPTIONS)
    spectra_u, spectra_y = (np.fft.rfft(x)[..., LINES].reshape(-1, len(LINES)) for x in (u, y))
    cross = np.abs(np.sum(spectra_y * spectra_u.conj(), axis=0)) ** 2
    powers = np.sum(np.abs(spectra_u) ** 2, axis=0) * np.sum(np.abs(spectra_y) ** 2, axis=0)
    assert np.allclose(value[:, 0], cross / powers, rtol=1e-12) and value.shape == (len(LINES), 1)
    signal, noise = np.mean(np.abs(PLANT * spectra_u) ** 2, axis=0), 0.05**2 * N
    truth = signal / (signal + noise)
    assert np.mean((low[:, 0] <= truth) & (truth <= high[:, 0])) > 0.85


def test_covariances_of_spectra_are_those_of_numpy():
    u, y, r = campaign(0.1)
    found = frfid.spectra_covariance(u, y, r=r, **OPTIONS)
    z = np.concatenate([np.fft.rfft(x)[..., LINES] for x in (u, y)], axis=3)[:, 0]  # (realization, period, channel, line)
    deviation = z - z.mean(axis=1, keepdims=True)
    noise = np.einsum("pqif,pqjf->fij", deviation, deviation.conj()) / (5 * 3)
    assert np.allclose(found["noise"], noise, rtol=1e-10)
    response = frfid.estimate_bla(u, y, r=r, **OPTIONS).response[:, 0, 0]
    error = z.mean(axis=1)[:, 1] - response * z.mean(axis=1)[:, 0]
    assert np.allclose(found["equation_error"][:, 0, 0], np.sum(np.abs(error) ** 2, axis=0) / 4, rtol=1e-10)
    turn = np.stack([-response, np.ones(len(LINES))], axis=1)
    of_noise = np.einsum("fi,fij,fj->f", turn, noise, turn.conj()) / 4
    assert np.allclose(found["equation_noise"][:, 0, 0], of_noise, rtol=1e-9)
    assert np.allclose(found["nonlinear"], found["equation_error"] - found["equation_noise"])
    once = frfid.spectra_covariance(u[:1, :, :1], y[:1, :, :1], **OPTIONS)
    assert all(covariance is None for covariance in once.values())


def test_the_default_takes_the_reference_and_names_the_bias_of_others():
    u, y, r = campaign(1.5, n_q=10)
    through, spectra = frfid.estimate(u, y, r=r, **OPTIONS), frfid.estimate(u, y, **OPTIONS)
    named = frfid.estimate(u, y, r=r, method="joint-input-output", **OPTIONS)
    assert np.array_equal(through.response, named.response)
    assert np.array_equal(spectra.response, frfid.estimate(u, y, method="mean-of-spectra", **OPTIONS).response)
    paper = frfid.estimate_bla(u, y, average="frfs", **OPTIONS)
    check = next(check for check in paper.checks if check["name"] == "noise on the input")
    assert not check["passed"] and "dB" in check["found"]
    assert all(check["passed"] for check in through.checks if check["name"] == "noise on the input")


def test_h1_and_h2_are_those_of_numpy():
    u, y, _ = campaign(0.3)
    a, b = (np.fft.rfft(x)[..., LINES].reshape(-1, len(LINES)) for x in (u, y))
    sums = {name: np.sum(x * z.conj(), axis=0) for name, x, z in (("yu", b, a), ("uu", a, a), ("yy", b, b), ("uy", a, b))}
    h1, h2 = (frfid.estimate(u, y, method=method, **OPTIONS) for method in ("h1", "h2"))
    assert np.allclose(h1.response[:, 0, 0], sums["yu"] / sums["uu"], rtol=1e-12)
    assert np.allclose(h2.response[:, 0, 0], sums["yy"] / sums["uy"], rtol=1e-12)
