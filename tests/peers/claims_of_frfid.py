"""What is said of frfid, done: every function is true."""

import functools
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import frfid
from scenarios import LAYOUTS, SAMPLE_TIME_S, scenario

GRID = {"sample_time_s": SAMPLE_TIME_S, "harmonics": np.arange(1, 16)}
MULTISINE = frfid.Multisine(sample_time_s=1e-3, n_samples=1024, harmonics=np.arange(1, 100))


@functools.cache
def campaign(group="closed loop"):
    return scenario(group, LAYOUTS[1], "both", 7, 10)


@functools.cache
def frf():
    one = campaign()
    return frfid.estimate(one.u, one.y, r=one.r, **GRID)


def failed(found, name):
    return name in [check["name"] for check in found.checks if not check["passed"]]


def response():
    return frf().response.shape == (15, 3, 2) and np.isfinite(frf().response).all()


def covariances():
    return frf().noise_covariance.shape == frf().total_covariance.shape == (15, 6, 6)


def degrees_of_freedom():
    return frf().noise_degrees_of_freedom > frf().total_degrees_of_freedom > 0


def signed_distortion():
    """Without distortion the difference of both variances is negative as often as not."""
    linear = scenario("known input", LAYOUTS[0], "noise", 7, 10)
    signed = frfid.spectra_covariance(linear.u, linear.y, **GRID)["nonlinear"].real
    return signed.min() < 0 < signed.max()


def spectra():
    one = campaign()
    found = frfid.spectra_covariance(one.u, one.y, r=one.r, **GRID)
    return found["noise"].shape == (15, 5, 5) and found["equation_error"].shape == (15, 3, 3)


def noise_between():
    """Noise of power 1 a line at lines that are not excited."""
    u = multisine_campaign()
    y = u + np.random.default_rng(1).standard_normal(u.shape) / np.sqrt(MULTISINE.n_samples)
    found = frfid.spectra_covariance(u, y, sample_time_s=1e-3, harmonics=np.arange(1, 200))
    return 0.9 < found["noise"][99:, 1, 1].real.mean() < 1.1


def multisine_campaign(n_periods=3):
    """Five draws, each three times: (realization, 1, period, 1, sample)."""
    draws = np.stack([MULTISINE.realize(seed=1, realization=k) for k in range(5)])
    return np.repeat(draws[:, :, None], n_periods, axis=2)


def through_reference():
    return np.abs(frf().response - campaign().truth.response).max() < 0.1


def loop():
    one = campaign()
    found = frfid.estimate_loop(one.u, one.y[..., :2, :], one.r, loop="set-point", **GRID)
    names = ("sensitivity", "complementary_sensitivity", "open_loop")
    return all(found[name].total_covariance.shape == (15, 4, 4) for name in names)


def least_squares():
    one = campaign("known input")
    u, y = (signal.reshape(1, -1, *signal.shape[2:]) for signal in (one.u, one.y))
    return np.isfinite(frfid.estimate(u, y, method="least-squares", **GRID).response).all()


def logarithmic_mean():
    one = campaign("noisy input")
    return np.isfinite(frfid.estimate(one.u, one.y, method="logarithmic-mean", **GRID).response).all()


def h1_h2():
    one = scenario("noisy input", LAYOUTS[0], "both", 7, 10)
    h1, h2 = (np.abs(frfid.estimate(one.u, one.y, method=name, **GRID).response) for name in ("h1", "h2"))
    return (h1 < h2).all()


def refuses_hv():
    one = campaign("noisy input")
    try:
        frfid.estimate(one.u, one.y, method="hv", **GRID)
    except ValueError:
        return True
    return False


def coherence():
    one = campaign("noisy input")
    value = frfid.coherence(one.u, one.y, **GRID)[0]
    return value.shape == (15, 3) and (value > 0.9).all()


def ordinary_coherence():
    """Either input explains a part of the output, both together nearly all."""
    one = campaign("noisy input")
    return (frfid.coherence(one.u[..., :1, :], one.y, **GRID)[0] < frfid.coherence(one.u, one.y, **GRID)[0]).all()


def coherence_interval():
    one = campaign("noisy input")
    value, low, high = frfid.coherence(one.u, one.y, **GRID)
    return (low < value).all() and (value < high).all()


@functools.cache
def joint_record():
    """Six periods of a flexible joint with a noisy velocity reading."""
    joint = frfid.Plant.single_joint(velocity_noise_rad_s=1e-5)
    return joint.simulate(100 * np.tile(MULTISINE.realize(seed=1, peak=1.0)[0], 6), sample_time_s=1e-3)


def estimated(time_s, u, y):
    """What the command line finds in a CSV: exit code, what it said, the FRF."""
    with tempfile.TemporaryDirectory() as folder:
        file, result = Path(folder) / "log.csv", Path(folder) / "frf.json"
        np.savetxt(file, np.column_stack([time_s, u, y]), delimiter=",", header="t,u,y", comments="", fmt="%.12g")
        signals = ["--u", "u=N m", "--y", "y=rad/s", "--time", "t=s"]
        command = [sys.executable, "-c", "from frfid._cli import main; raise SystemExit(main())", "estimate", str(file), "-o", str(result)]
        code = subprocess.run([*command, *signals], capture_output=True).returncode
        return code, frfid.load(result)


def recording():
    record = joint_record()
    code, found = estimated(SAMPLE_TIME_S * np.arange(record.n_samples), record.u[0], record.y[0])
    return code == 0 and np.allclose(found.frequency_hz, MULTISINE.lines_hz)


def uneven_stamps():
    """Samples at uneven times of the settled, periodic signals."""
    record, rng = joint_record(), np.random.default_rng(2)
    time_s = np.sort(SAMPLE_TIME_S * (np.arange(record.n_samples) + rng.uniform(-0.3, 0.3, record.n_samples)))
    code, found = estimated(time_s, at(record.u[0], time_s), at(record.y[0], time_s))
    truth = at_lines(record)
    return code == 0 and np.median(np.abs(found.response[:, 0, 0] / truth - 1)) < 0.01


def at(signal, time_s):
    """The last period of a signal, at any time."""
    n = MULTISINE.n_samples
    turn = 2j * np.pi * np.outer(time_s / MULTISINE.period_s, np.arange(n // 2))
    spectrum = np.fft.rfft(signal[-n:])[: n // 2] * np.where(np.arange(n // 2), 2, 1) / n
    return (np.exp(turn) @ spectrum).real


def at_lines(record):
    n = MULTISINE.n_samples
    u, y = (np.fft.rfft(signal[0, -n:])[MULTISINE.harmonics] for signal in (record.u, record.y))
    return y / u


def lost_rows():
    record = joint_record()
    keep = np.delete(np.arange(record.n_samples), [2000, 2001, 2002])
    _, found = estimated(SAMPLE_TIME_S * keep, record.u[0, keep], record.y[0, keep])
    return np.median(np.abs(found.response[:, 0, 0] / at_lines(record) - 1)) < 0.01


def saturated():
    record = joint_record()
    level = 0.6 * np.abs(record.y).max()
    code, found = estimated(SAMPLE_TIME_S * np.arange(record.n_samples), record.u[0], np.clip(record.y[0], -level, level))
    return code == 3 and any("saturated" in check["found"] for check in found.checks if not check["passed"])


def chirp():
    sweep = frfid.Chirp(low_hz=1.0, high_hz=60.0, duration_s=30.0, amplitude=100.0)
    u = sweep.sample(sample_time_s=1e-3)[0]
    record = frfid.Plant.single_joint().simulate(u, sample_time_s=1e-3)
    hz = np.array([5.0, 20.0, 30.0])
    found = frfid.estimate_chirp(record.u[None], record.y[None], chirp=sweep, sample_time_s=1e-3, frequencies_hz=hz)
    truth = frfid.Plant.single_joint().frf(hz, sample_time_s=1e-3).response
    return (np.abs(found.response / truth - 1) < 0.1).all()


def same_draw():
    u = multisine_campaign()[[0, 0, 1]]
    y = u + 1e-3 * np.random.default_rng(3).standard_normal(u.shape)
    return frfid.estimate(u, y, sample_time_s=1e-3, harmonics=MULTISINE.harmonics).total_degrees_of_freedom == 1


def unexcited():
    u = multisine_campaign()
    u, y = (one + 1e-6 * np.random.default_rng(seed).standard_normal(u.shape) for seed, one in ((4, u), (5, u)))
    found = frfid.estimate(u, y, sample_time_s=1e-3, harmonics=np.arange(1, 120))
    is_nan = np.isnan(found.response[:, 0, 0])
    return is_nan[99:].all() and not is_nan[:99].any() and failed(found, "excited lines")


def noise_on_input():
    """At about 5 dB."""
    one = scenario("noisy input", LAYOUTS[0], "noise", 7, 10, input_noise=18.0)
    return failed(frfid.estimate(one.u, one.y, method="mean-of-frfs", **GRID), "noise on the input")


def unsettled():
    """A gain that grows from period to period."""
    record, time_s = joint_record(), SAMPLE_TIME_S * np.arange(joint_record().n_samples)
    code, found = estimated(time_s, record.u[0], record.y[0] * (1 + 0.05 * time_s))
    return code == 3 and failed(found, "settled")


def compared():
    found = []
    for seed in (1, 2):
        one = joint_record()
        y = np.tile(one.y[:, -1024:], 5) + 1e-5 * np.random.default_rng(seed).standard_normal((1, 5120))
        periods = [np.tile(one.u[0, -1024:], 5).reshape(1, 1, 5, 1, 1024), y.reshape(1, 1, 5, 1, 1024)]
        found.append(frfid.estimate(*periods, sample_time_s=1e-3, harmonics=MULTISINE.harmonics))
    return frfid.compare(*found).agrees


def design():
    made = frfid.Multisine.design(low_hz=1.0, high_hz=60.0, sample_time_s=1e-3, resolution_hz=0.5, phases="low-crest")
    signal = made.realize(seed=1)
    return np.abs(signal).max() / signal.std() < 2.0


def control():
    return frf().to_control().noutputs == 3
