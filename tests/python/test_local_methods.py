"""Local models of our own plans and of arrays: whole chirps in place of excerpts, one experiment for all inputs."""

import json
import re
import shutil
import subprocess
import warnings
from pathlib import Path

import frfid
import numpy as np
import pytest
from scipy import signal

EXAMPLES = Path(__file__).parents[2] / "examples"
FRFID = shutil.which("frfid")


def chirp(method, duration_s=20.0, repetitions=1, extra="", damping=40.0, noise=""):
    """The paper's joint without friction, less damped; its chirp."""
    return f"""
seed = 1
sample_time_s = 0.001
[robot.single_joint]
motor_inertia_kg_m2 = 35.0
link_inertia_kg_m2 = 150.0
damping_nms_per_rad = {damping}
stiffness_nm_per_rad = 1.5e5
coulomb_nm = 0.0
{noise}
[chirp]
low_hz = 1.0
high_hz = 60.0
duration_s = {duration_s}
amplitude_nm = [150.0]
tail_s = 2.0
[averaging]
repetitions = {repetitions}
[estimate]
n_frequencies = 150
{method}
{extra}
"""


def estimated(tmp_path, text):
    path = tmp_path / "x.toml"
    path.write_text(text)
    plan = frfid.Experiment.load(path).design()
    return plan.estimate(plan.run())


def decibels(frf, damping=40.0, band_hz=(1.3, 55)):
    """Errors over a band."""
    hz = np.asarray(frf.frequency_hz)
    joint = {"motor_inertia_kg_m2": 35.0, "link_inertia_kg_m2": 150.0, "stiffness_nm_per_rad": 1.5e5}
    plant = frfid.Plant.single_joint(**joint, damping_nms_per_rad=damping, coulomb_nm=0.0)
    truth = np.asarray(plant.frf(hz, sample_time_s=0.001).response)[:, 0, 0]
    inside = (hz > band_hz[0]) & (hz < band_hz[1])
    return np.abs(20 * np.log10(np.abs(np.asarray(frf.response)[:, 0, 0] / truth)))[inside]


@pytest.mark.parametrize(("duration_s", "damping"), [(20.0, 400.0), (5.0, 400.0), (20.0, 40.0)])
def test_a_chirp_knows_a_sharp_resonance(tmp_path, duration_s, damping):
    text = lambda method: chirp(method, duration_s, damping=damping)
    excerpts = decibels(estimated(tmp_path, text("")), damping)
    local = decibels(estimated(tmp_path, text('method = "local-rational"')), damping)
    print(f"{duration_s:g} s: excerpts {excerpts.max():.2f} dB at worst, local models {local.max():.1e} dB")
    assert local.max() < 1e-3 < 1 < excerpts.max()


def test_repeats_give_the_noise(tmp_path):
    """What repeats differ by is the variance of the FRF over many campaigns; the total variance holds it."""
    path = tmp_path / "x.toml"
    path.write_text(chirp('method = "local-rational"', repetitions=8))
    plan = frfid.Experiment.load(path).design()
    records, rng = plan.run(), np.random.default_rng(1)
    frfs = []
    for _ in range(30):
        noisy = [
            frfid.Record(sample_time_s=0.001, u=record.u, y=record.y + 1e-3 * rng.standard_normal(record.y.shape))
            for record in records
        ]
        frfs.append(plan.estimate(noisy))
    spread = np.var([np.asarray(frf.response)[:, 0, 0] for frf in frfs], axis=0, ddof=1)
    noise, total = (
        np.mean([np.asarray(variance)[:, 0, 0].real for variance in variances], axis=0)
        for variances in ([frf.noise_variance for frf in frfs], [frf.total_variance for frf in frfs])
    )
    print(f"noise variance {np.median(noise / spread):.2f} of the spread, total {np.median(total / spread):.2f}")
    assert 0.85 < np.median(noise / spread) < 1.15 and np.median(total / noise) > 0.95
    assert plan.estimate(noisy[:1] + [None] * 7).noise_variance is None


def experiment(n_samples, n_inputs, rng):
    """One period of a 3x2 plant with a mode each, every input with phases of its own on all odd lines, from rest to
    rest: spectra (input, line), (output, line), harmonics and the truth."""
    harmonics = np.arange(1, n_samples // 4, 2)
    z = np.exp(2j * np.pi * harmonics / n_samples)
    modes = rng.standard_normal((2, 3, n_inputs))
    poles = [0.99 * np.exp(0.1j), 0.995 * np.exp(0.4j)]
    truth = sum(
        mode[..., None] * 0.01 / ((z - pole) * (z - np.conj(pole))) * z for mode, pole in zip(modes, poles, strict=True)
    )
    spectrum = np.exp(2j * np.pi * rng.uniform(size=(n_inputs, len(harmonics))))
    full = np.zeros((n_inputs, n_samples // 2 + 1), complex)
    full[:, harmonics] = spectrum
    answer = np.zeros((3, n_samples // 2 + 1), complex)
    answer[:, harmonics] = np.einsum("ijf,jf->if", truth, spectrum)
    return np.fft.irfft(full, axis=1), np.fft.irfft(answer, axis=1), harmonics, np.moveaxis(truth, 2, 0)


@pytest.mark.parametrize("method", ["local-rational", "local-polynomial"])
def test_one_experiment_for_all_inputs(method):
    u, y, harmonics, truth = experiment(8192, 2, np.random.default_rng(2))
    arrays = [signal[None, None, None] for signal in (u, y)]  # realization, experiment, period
    given = {"sample_time_s": 0.001, "harmonics": harmonics}
    frf = frfid.estimate(*arrays, **given, method=method)
    error = np.abs(np.asarray(frf.response) - truth).max(axis=(1, 2)) / np.abs(truth).max(axis=(1, 2))
    print(f"{method}: {np.median(error):.1e} in the median, {error.max():.1e} at worst")
    assert np.median(error) < 1e-4
    assert method == "local-polynomial" or error.max() < 1e-3
    with pytest.raises(ValueError, match="experiment"):
        frfid.estimate(*arrays, **given, method="mean-of-spectra")


def refused(tmp_path, text):
    path = tmp_path / "x.toml"
    path.write_text(text)
    done = subprocess.run([FRFID, "design", path, "-o", tmp_path / "plan.mcap"], capture_output=True, text=True)
    run = subprocess.run([FRFID, "run", tmp_path / "plan.mcap", "-o", tmp_path / "logs"], capture_output=True, text=True)
    asked = [FRFID, "estimate", tmp_path / "logs", "-o", tmp_path / "frf.json", "--method", "local-rational"]
    asked = subprocess.run(asked, capture_output=True, text=True)
    said = (done.stderr + run.stderr + asked.stderr).splitlines()
    return [line for line in said if not line.startswith(("wrote ", "next: "))]


def test_what_local_models_cannot_do_is_said(tmp_path):
    stepped = (EXAMPLES / "experiments/stepped_sine.toml").read_text().replace("../robots", f"{EXAMPLES}/robots")
    assert "a stepped sine has no lines between its frequencies" in str(refused(tmp_path, stepped))
    both = chirp('method = "local-rational"\nresponse = "sensitivity"')
    assert "local models give the plant alone" in str(refused(tmp_path, both))


def test_the_command_takes_them(tmp_path):
    text = chirp("").replace("duration_s = 20.0", "duration_s = 10.0")
    assert refused(tmp_path, text) == []
    result = json.loads((tmp_path / "frf.json").read_text())
    assert max(result["condition"]["data"]) == 1.0


def test_the_width_is_given_by_hand(tmp_path):
    """By file, command and Python alike; refused where it is not of local models, or leaves no freedom."""
    text = chirp("").replace("duration_s = 20.0", "duration_s = 10.0")
    assert refused(tmp_path, text) == []
    logs = tmp_path / "logs"
    table = {"method": "local-rational", "half_width": 20, "n_frequencies": 150}
    by_table = frfid.estimate_logs(logs, estimate=table)
    asked = [FRFID, "estimate", logs, "-o", tmp_path / "w.json", "--method", "local-rational"]
    asked += ["--half-width", "20", "--n-frequencies", "150"]
    assert subprocess.run(asked).returncode == 0
    by_command = frfid.load(tmp_path / "w.json")
    by_file = estimated(tmp_path, chirp('method = "local-rational"\nhalf_width = 20', duration_s=10.0))
    chosen = estimated(tmp_path, chirp('method = "local-rational"', duration_s=10.0))
    assert np.array_equal(by_table.response, by_command.response)
    assert np.allclose(by_table.response, by_file.response, rtol=1e-9)
    assert not np.array_equal(by_file.response, chosen.response)
    with pytest.raises(ValueError, match="half_width"):
        frfid.estimate_logs(logs, estimate={"half_width": 20})
    with pytest.raises(ValueError, match="2 lines to either side hold too few equations .* at least [0-9]+ are needed"):
        frfid.estimate_logs(logs, estimate={**table, "half_width": 2})


@pytest.mark.parametrize(("damping", "most_db"), [(40.0, 0.03), (4.0, 0.06)])
def test_a_sharp_resonance_behind_noise(tmp_path, damping, most_db):
    """1 % of noise on y, damping of 1 and 0.1 %, from 9 to 15 Hz: the worst line, in the median of eight draws."""
    path = tmp_path / "x.toml"
    worst = {}
    for width in ("", "half_width = 20"):
        path.write_text(chirp(f'method = "local-rational"\n{width}', damping=damping))
        plan = frfid.Experiment.load(path).design()
        record, rng = plan.run()[0], np.random.default_rng(3)
        size = 0.01 * np.sqrt(np.mean(record.y**2))
        worst[width] = []
        for _ in range(8):
            y = record.y + size * rng.standard_normal(record.y.shape)
            frf = plan.estimate([frfid.Record(sample_time_s=0.001, u=record.u, y=y)])
            worst[width].append(decibels(frf, damping, (9, 15)).max())
    chosen, by_hand = (np.median(errors) for errors in worst.values())
    print(f"damping {damping}: {chosen:.3f} dB with widths chosen, {by_hand:.3f} dB with 20 lines to either side")
    assert by_hand < most_db and chosen < 1.5 * most_db


ALL_AT_ONCE = f"""
seed = 1
sample_time_s = 0.001
[robot]
file = "{EXAMPLES}/robots/manutec_r3.toml"
[robot.challenges]
coulomb_friction = false
stiffening = false
position_dependence = false
torque_ripple = false
sensing = false
[controller]
gain_nms_per_rad = [1500.0, 1500.0, 400.0]
integral_gain_nm_per_rad = [12000.0, 12000.0, 3200.0]
[multisine]
low_hz = 2.0
high_hz = 60.0
resolution_hz = 0.1
peak_rad_s = [0.03, 0.03, 0.03]
mimo = "all-at-once"
[averaging]
realizations = 2
lead_in_s = 4.0
"""


@pytest.mark.parametrize("mimo", ["all-at-once", "zippered"])
def test_one_experiment_for_three_axes_in_closed_loop(tmp_path, mimo):
    """A third of the runs: 2 in place of 6; through the reference, by local models without being told."""
    path = tmp_path / "x.toml"
    path.write_text(ALL_AT_ONCE.replace("all-at-once", mimo))
    plan = frfid.Experiment.load(path).design()
    assert len(plan) == 2
    frf = plan.estimate(plan.run())
    challenges = ["coulomb_friction", "stiffening", "position_dependence", "torque_ripple", "sensing"]
    plant = frfid.Plant.load(EXAMPLES / "robots/manutec_r3.toml", challenges=dict.fromkeys(challenges, False))
    truth = np.asarray(plant.frf(frf.frequency_hz, sample_time_s=0.001).response)
    error = np.abs(np.asarray(frf.response) - truth) / np.abs(truth)
    print(f"{np.median(error):.1e} in the median, {np.quantile(error, 0.95):.1e} at 95 %, {error.max():.1e} at worst")
    assert np.median(error) < 1e-4 and np.quantile(error, 0.95) < 1e-3


def test_a_third_of_the_runs(tmp_path):
    """The campaign on a constant velocity of the r3 with everything on, one experiment for its three axes."""
    text = (EXAMPLES / "experiments/r3_multisine.toml").read_text().replace("../robots", f"{EXAMPLES}/robots")
    text = re.sub(r"^(n_lines|average) = .*$", "", text, flags=re.MULTILINE)
    text = re.sub(r"^mimo = .*$", 'mimo = "all-at-once"', text, flags=re.MULTILINE)
    assert not [line for line in refused(tmp_path, text) if line.startswith("error")]
    plant = frfid.Plant.load(EXAMPLES / "robots/manutec_r3.toml")

    def off(name, *options):
        asked = [FRFID, "estimate", tmp_path / "logs", "-o", tmp_path / name, *options]
        subprocess.run(asked, capture_output=True)
        frf = frfid.load(tmp_path / name)
        truth = plant.frf(frf.frequency_hz, sample_time_s=0.001, sensor=True).response
        return 100 * np.median(np.abs(np.einsum("fii->if", frf.response) / np.einsum("fii->if", truth) - 1), axis=1)

    chosen, polynomial = off("chosen.json"), off("polynomial.json", "--method", "local-polynomial")
    print(f"55 runs in place of 155 (2.1, 0.7, 1.9 %): {chosen.round(1)} %, by polynomials {polynomial.round(1)} %")
    assert (chosen < [2.1, 0.7, 3.5]).all() and (polynomial < [2.1, 0.7, 2.5]).all()


def test_one_zippered_experiment_of_two_inputs():
    """Two modes of 2 % damping in the steady state, 1 % noise at the outputs: a median of 0.84 % has been published for the like."""
    rng, n, step = np.random.default_rng(5), 2000, 5e-4
    turn, damping = 2 * np.pi * np.array([50.0, 120.0]), 0.02
    matrix = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.diag(turn**2), -np.diag(2 * damping * turn)]])
    inputs, outputs = np.r_[np.zeros((2, 2)), [[1.0, 0.5], [0.3, 1.0]]], np.c_[np.array([[1.0, 0.4], [0.2, 1.0]]) * turn[0] ** 2, np.zeros((2, 2))]
    discrete = signal.cont2discrete((matrix, inputs, outputs, np.zeros((2, 2))), step)
    lines = np.arange(10, 301)
    z = np.exp(2j * np.pi * lines / n)
    truth = np.array([outputs @ np.linalg.solve(z * np.eye(4) - discrete[0], discrete[1]) for z in z])
    median = {}
    for mimo in ("zippered", "all-at-once"):
        grid = frfid.Multisine(sample_time_s=step, n_samples=n, harmonics=lines)
        u = np.asarray(grid.realize(seed=1, n_inputs=2, peak=[1.0, 1.0], mimo=mimo)).reshape(2, n)
        spectrum = np.fft.rfft(u)
        excited = np.abs(spectrum[:, lines]) > 1e-9 * np.abs(spectrum).max()
        assert (excited.sum(axis=0) == (1 if mimo == "zippered" else 2)).all()
        answer = np.zeros((2, n // 2 + 1), complex)
        answer[:, lines] = np.einsum("kij,jk->ik", truth, spectrum[:, lines])
        y = np.fft.irfft(answer, n)[:, None] + 0.01 * np.fft.irfft(answer, n).std(axis=1)[:, None, None] * rng.standard_normal((2, 4, n))
        cut = lambda x: np.swapaxes(x, 0, 1)[None, None]
        frf = frfid.estimate(cut(np.repeat(u[:, None], 4, axis=1)), cut(y), sample_time_s=step, harmonics=lines, method="local-rational")
        error = np.linalg.norm(frf.response - truth, axis=(1, 2)) / np.linalg.norm(truth, axis=(1, 2))
        median[mimo] = np.median(error)
        print(f"{mimo}: {100 * median[mimo]:.2f} % in the median, {100 * np.quantile(error, 0.95):.1f} % at 95 %")
    assert median["zippered"] < 0.0084


def test_a_record_that_repeats_is_told_so():
    """Its lines between those of the period are not excited: the error is many times that of the periods' mean."""
    n, step, rng = 2000, 5e-4, np.random.default_rng(6)
    grid = frfid.Multisine(sample_time_s=step, n_samples=n, harmonics=np.arange(10, 301))
    u = np.tile(np.asarray(grid.realize(seed=1)).reshape(1, n), (1, 4))
    y = 2 * u + 0.01 * rng.standard_normal(u.shape)
    hz = np.arange(20, 280) / (n * step)
    with pytest.warns(UserWarning, match="repeats after 2000 samples, 4 times"):
        frf = frfid.estimate_local(u, y, sample_time_s=step, frequencies_hz=hz)
    assert [check["passed"] for check in frf.checks if check["name"] == "periods"] == [False]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        noise = frfid.estimate_local(rng.standard_normal(u.shape), y, sample_time_s=step, frequencies_hz=hz)
        once = frfid.estimate_local(u[:, :n], y[:, :n], sample_time_s=step, frequencies_hz=hz)
    assert not any(check["name"] == "periods" for frf in (noise, once) for check in frf.checks)


def test_low_crest_phases_are_alike(tmp_path):
    path = tmp_path / "x.toml"
    path.write_text(ALL_AT_ONCE.replace('mimo =', 'phases = "low-crest"\nmimo ='))
    with pytest.raises(ValueError, match="inputs excited all at once are alike"):
        frfid.Experiment.load(path).design()
