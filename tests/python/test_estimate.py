"""Estimators against independent implementations in numpy, and against measured records."""

import numpy as np
import pytest
import scipy.signal

import frfid

RNG = np.random.default_rng(11)


def numpy_bla(u, y, harmonics):
    """SK15 (13) and (14) with pinv, in the plainest words; response, noise covariance, total covariance."""
    spectra = [np.moveaxis(np.fft.rfft(x)[..., harmonics], -1, 0) for x in (u, y)]
    u_lines, y_lines = (np.moveaxis(x, 2, -1) for x in spectra)  # line, realization, period, channel, experiment
    per_period = y_lines @ np.linalg.pinv(u_lines)
    per_realization = per_period.mean(axis=2)
    response = per_realization.mean(axis=1)
    vec = lambda g: np.swapaxes(g, -1, -2).reshape(*g.shape[:-2], -1)
    outer = lambda d: d[..., :, None] * d[..., None, :].conj()
    n_p, n_q = per_period.shape[1:3]
    noise = outer(vec(per_period - per_realization[:, :, None])).sum(axis=(1, 2)) / (n_p**2 * n_q * (n_q - 1))
    total = outer(vec(per_realization - response[:, None])).sum(axis=1) / (n_p * (n_p - 1))
    return response, noise, total


@pytest.mark.parametrize("n_inputs, n_outputs, n_experiments, n_samples", [(3, 2, 3, 2500), (2, 3, 4, 19838), (1, 1, 1, 8192)])
def test_bla_is_numpy_s(n_inputs, n_outputs, n_experiments, n_samples):
    n_p, n_q, harmonics = 4, 3, np.array([1, 3, 77, n_samples // 2 - 1])
    u = RNG.standard_normal((n_p, n_experiments, 1, n_inputs, n_samples))
    u, y = (
        np.broadcast_to(x, (n_p, n_experiments, n_q, *x.shape[3:])) + 0.1 * RNG.standard_normal((n_p, n_experiments, n_q, *x.shape[3:]))
        for x in (u, RNG.standard_normal((n_p, n_experiments, 1, n_outputs, n_samples)))
    )
    frf = frfid.estimate_bla(u, y, sample_time_s=1e-3, harmonics=harmonics, average="frfs")
    response, noise, total = numpy_bla(u, y, harmonics)
    np.testing.assert_allclose(frf.frequency_hz, harmonics / (n_samples * 1e-3), rtol=1e-15)
    for found, expected in ((frf.response, response), (frf.noise_covariance, noise), (frf.total_covariance, total)):
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_the_condition_number_is_numpy_s():
    u = RNG.standard_normal((1, 3, 1, 3, 100))
    frf = frfid.estimate_bla(u, u, sample_time_s=1.0, harmonics=[3, 4])
    expected = np.linalg.cond(np.moveaxis(np.fft.rfft(u[0, :, 0])[..., [3, 4]], -1, 0))
    np.testing.assert_allclose(frf.condition, expected, rtol=1e-10)


def test_the_reference_cures_the_bias_of_a_noisy_input():
    n_q, n, lines = 200, 64, np.arange(1, 31)
    r = np.broadcast_to(RNG.standard_normal(n), (1, 1, n_q, 1, n))
    u = r + RNG.standard_normal(r.shape)
    y = 2 * r
    direct = frfid.estimate_bla(u[:, :, :1], y[:, :, :1], sample_time_s=1.0, harmonics=lines)
    indirect = frfid.estimate_bla(u, y, r=r, sample_time_s=1.0, harmonics=lines)
    cross = lambda x: (np.fft.rfft(x) * np.fft.rfft(r).conj()).sum(axis=2)[0, 0, 0, lines]
    np.testing.assert_allclose(indirect.response[:, 0, 0], cross(y) / cross(u), rtol=1e-12)
    off = lambda frf: np.abs(frf.response - 2).mean()
    assert off(indirect) < 0.2 < off(direct)
    assert indirect.noise_degrees_of_freedom == n_q - 1 and indirect.total_variance is None


def test_alike_experiments_are_a_numerical_error_and_few_a_value_error():
    u = np.repeat(RNG.standard_normal((1, 1, 1, 2, 50)), 2, axis=1)
    with pytest.raises(frfid.NumericalError, match="experiments 0 and 1 are the most alike"):
        frfid.estimate_bla(u, u, sample_time_s=1e-3, harmonics=[1, 2])
    with pytest.raises(ValueError, match="1 experiments for 2 inputs"):
        frfid.estimate_bla(u[:, :1], u[:, :1], sample_time_s=1e-3, harmonics=[1, 2])
    with pytest.raises(ValueError, match="line 25 is not between 1 and 24"):
        frfid.estimate_bla(u, u, sample_time_s=1e-3, harmonics=[1, 25])
    assert issubclass(frfid.NumericalError, ArithmeticError)


def numpy_excerpt(x, chirp, hz, sample_time_s):
    """SK15 section 5.1 step by step: cut, mean, low-pass, ten samples per period, Hann, DFT."""
    half_s = 2 / hz
    centre_s = chirp.instant_of(hz)
    first = int(np.ceil(max(centre_s - half_s, 0) / sample_time_s))
    last = int(np.floor(min(centre_s + half_s, chirp.duration_s) / sample_time_s))
    last = min(last, len(x) - 1)
    x = x - x[first : last + 1].mean()
    step = max(int(0.1 / hz / sample_time_s), 1)
    if step > 1:
        window = scipy.signal.windows.hann(4 * step + 1)
        x = scipy.signal.convolve(x, window / window.sum(), mode="same", method="direct")
    k = np.arange(first, last + 1, step)
    return np.sum(x[k] * np.sin(np.pi * (k - first) / (last - first)) ** 2 * np.exp(-2j * np.pi * hz * k * sample_time_s))


def test_excerpts_are_numpy_s_and_near_the_truth(scipy_joint):
    chirp = frfid.Chirp(low_hz=1.0, high_hz=60.0, duration_s=20.0, amplitude=150.0)
    u = chirp.sample(sample_time_s=1e-3)
    y = scipy_joint.simulate(u[0, 0], 1e-3)[None, None]
    hz = np.geomspace(1.3, 55.0, 200)
    frf = frfid.estimate_chirp(u, y, chirp=chirp, sample_time_s=1e-3, frequencies_hz=hz)
    by_hand = [numpy_excerpt(y[0, 0], chirp, f, 1e-3) / numpy_excerpt(u[0, 0], chirp, f, 1e-3) for f in hz]
    np.testing.assert_allclose(frf.response[:, 0, 0], by_hand, rtol=1e-9)
    assert frf.noise_variance is None
    error_db = 20 * np.abs(np.log10(np.abs(frf.response[:, 0, 0] / scipy_joint.frf(hz, 1e-3))))
    assert np.median(error_db) < 0.05 and error_db.max() < 2.0


def test_repeats_late_starts_and_frequencies_outside():
    chirp = frfid.Chirp(low_hz=2.0, high_hz=50.0, duration_s=4.0)
    u = np.concatenate([np.zeros((1, 1, 100)), chirp.sample(sample_time_s=1e-3)], axis=-1)
    both = np.stack([u, u])
    frf = frfid.estimate_chirp(both, 3 * both, chirp=chirp, sample_time_s=1e-3, frequencies_hz=[5.0, 9.0], start_s=0.1)
    np.testing.assert_allclose(frf.response, 3.0, rtol=1e-12)
    assert frf.noise_variance.max() < 1e-20
    with pytest.raises(ValueError, match="60 Hz: the chirp never has this frequency"):
        frfid.estimate_chirp(u, u, chirp=chirp, sample_time_s=1e-3, frequencies_hz=[60.0])
    with pytest.raises(ValueError, match="method: unknown variant `lpm`"):
        frfid.estimate_chirp(u, u, chirp=chirp, sample_time_s=1e-3, frequencies_hz=[5.0], method="lpm")


def test_silverbox(shared_data):
    """Ten realizations of one period each: total variance, but no noise variance; resonance of the electronic Duffing oscillator."""
    with np.load(shared_data / "silverbox" / "snls80mv.npz") as data:
        fs = float(data["fs"])
        blocks = [slice(start, start + 8192) for start in 40985 + 8692 * np.arange(10)]
        u, y = (np.array([data[name].ravel()[block] for block in blocks])[:, None, None, None] for name in "uy")
    harmonics = np.arange(1, 2684, 2)
    frf = frfid.estimate_bla(u, y, sample_time_s=1 / fs, harmonics=harmonics)
    assert len(frf.frequency_hz) == 1342 and frf.frequency_hz[-1] == pytest.approx(199.9, abs=0.05)
    assert frf.noise_variance is None and frf.total_variance.shape == (1342, 1, 1)
    assert frf.total_degrees_of_freedom == 9
    per_realization = np.fft.rfft(y)[:, 0, 0, 0, harmonics] / np.fft.rfft(u)[:, 0, 0, 0, harmonics]
    np.testing.assert_allclose(frf.response[:, 0, 0], per_realization.mean(axis=0), rtol=1e-9)
    np.testing.assert_allclose(frf.total_variance[:, 0, 0], per_realization.var(axis=0, ddof=1) / 10, rtol=1e-9)
    assert 55.0 < frf.frequency_hz[np.abs(frf.response[:, 0, 0]).argmax()] < 80.0


def same_frf(a, b):
    np.testing.assert_array_equal(a.response, b.response)
    np.testing.assert_array_equal(a.noise_variance, b.noise_variance)
    np.testing.assert_array_equal(a.total_variance, b.total_variance)


def test_a_method_is_asked_for_by_name_and_says_what_it_lacks():
    u, y, r = (rng.normal(size=(2, 2, 3, c, 64)) for rng, c in ((np.random.default_rng(k), 2) for k in range(3)))
    u, r = (np.repeat(x[:, :, :1], 3, axis=2) for x in (u, r))
    options = {"sample_time_s": 1e-3, "harmonics": [1, 5, 9]}
    for method, average in (("mean-of-frfs", "frfs"), ("mean-of-spectra", "spectra")):
        same_frf(frfid.estimate(u, y, method=method, **options), frfid.estimate_bla(u, y, average=average, **options))
    indirect = frfid.estimate_bla(u, y, r=r, **options)
    same_frf(frfid.estimate(u, y, r=r, **options), indirect)
    same_frf(frfid.estimate(u, y, r=r, method="joint-input-output", **options), indirect)
    with pytest.raises(ValueError, match="reference r"):
        frfid.estimate(u, y, method="joint-input-output", **options)
    with pytest.raises(ValueError, match="the method does without"):
        frfid.estimate(u, y, r=r, method="mean-of-frfs", **options)
    with pytest.raises(ValueError, match="method: unknown variant `best`"):
        frfid.estimate(u, y, method="best", **options)


def failed(frf):
    """What failed checks found, by their names."""
    return {check["name"]: check["found"] for check in frf.checks if not check["passed"]}


def multisine_periods(phases, n_periods, lines=np.arange(5, 100, 2), n=400):
    """A period for each row of phases, repeated: (realization, experiment, period, channel, sample)."""
    spectrum = np.zeros((len(phases), n // 2 + 1), complex)
    spectrum[:, lines] = 0.5 * n * np.exp(1j * phases)
    return np.repeat(np.fft.irfft(spectrum, n)[:, None, None, None], n_periods, axis=2)


def test_lines_that_are_not_excited_are_nan_and_named():
    u = multisine_periods(np.random.default_rng(1).uniform(0, 7, (2, 48)), 3)
    y = 2 * u + 1e-3 * np.random.default_rng(2).standard_normal(u.shape)
    for noise in (0, 0.1):
        noisy = u + noise * np.random.default_rng(3).standard_normal(u.shape)
        frf = frfid.estimate_bla(noisy, y, sample_time_s=1 / 1000, harmonics=np.arange(5, 100))
        assert "47 of 95 lines are left out (NaN): 15 Hz, 20 Hz, 25 Hz, ...; 15 Hz: input 0" in failed(frf)["excited lines"]
        assert np.isnan(frf.response[1::2]).all() and np.isnan(frf.total_variance[1::2]).all()
        sound = frfid.estimate(noisy, y, sample_time_s=1 / 1000, harmonics=np.arange(5, 100, 2))
        np.testing.assert_array_equal(frf.response[0::2], sound.response)
    with pytest.raises(frfid.NumericalError, match="input 0 is not excited there"):
        frfid.estimate_bla(0 * u, y, sample_time_s=1 / 1000, harmonics=[5, 7])


def test_one_draw_four_times_has_no_total_variance():
    phases = np.random.default_rng(1).uniform(0, 7, 48)
    u = multisine_periods(np.array([phases, phases - 0.3 * np.arange(48), phases + np.pi, phases]), 3)
    y = u + 1e-2 * np.random.default_rng(2).standard_normal(u.shape)
    for estimate in (frfid.estimate, frfid.estimate_bla):
        frf = estimate(u, y, sample_time_s=1e-3, harmonics=np.arange(5, 100, 2))
        assert "realizations 0, 1, 2, 3 are the same draw of phases (residual 0.00 rad): counted as" in failed(frf)["draws of phases"]
        assert frf.total_variance is None and frf.noise_degrees_of_freedom == 11
        assert np.abs(frf.response - 1).max() < 1e-3


def test_distortion_that_one_draw_hides_is_told():
    u = multisine_periods(np.random.default_rng(1).uniform(0, 7, (1, 48)), 3)
    y = u + 0.1 * u**3 / u.var() + 1e-3 * np.random.default_rng(2).standard_normal(u.shape)
    frf = frfid.estimate_bla(u, y, sample_time_s=1e-3, harmonics=np.arange(5, 100, 2))
    assert "distortion not measured: from line to line the response scatters by" in failed(frf)["distortion"]
