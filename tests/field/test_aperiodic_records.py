"""Recordings in which nothing repeats: sweeps, noise, one record with a hole; estimated as they are, by the command line."""

import json
import pathlib
import shutil
import subprocess

import numpy as np
import pytest

import frfid

FRFID = shutil.which("frfid")
DATA = pathlib.Path(__file__).parents[3] / "shared" / "data"
pytestmark = pytest.mark.skipif(FRFID is None, reason="the command line frfid is not installed")


@pytest.fixture
def shared_data():
    """Folder with the measured records."""
    if not DATA.is_dir():
        print(f"SKIPPED: {DATA} is missing")
        pytest.skip(f"{DATA} is missing")
    return DATA


def run(folder, *arguments, code=0):
    done = subprocess.run([FRFID, *map(str, arguments), "--quiet"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout + done.stderr


def resonances(frf, output, near_hz):
    """Frequencies of the largest magnitude within 4 % of these, between the lines by a parabola."""
    found = []
    for hz in near_hz:
        near = np.flatnonzero(np.abs(frf.frequency_hz / hz - 1) < 0.04)
        size = np.log(np.abs(frf.response[near, output, 0]))
        k = int(np.clip(size.argmax(), 1, len(near) - 2))
        a, b, c = np.polyfit(frf.frequency_hz[near[k - 1 : k + 2]], size[k - 1 : k + 2], 2)
        found.append(-b / (2 * a))
    return np.array(found)


def test_a_sweep_of_the_f16_has_the_resonances_of_the_multisine(shared_data, tmp_path):
    signals = ["--u", "force=N", *(word for k in range(3) for word in ("--y", f"acceleration[{k}]=m/s^2")), "--sample-time-s", 0.0025]
    said = run(tmp_path, "estimate", shared_data / "f16" / "F16Data_SineSw_Level1.npz", *signals, "-o", "sweep.json", "--n-frequencies", 600)
    assert "nothing repeats" in said and "whole records by local models" in said
    run(tmp_path, "estimate", shared_data / "f16" / "F16Data_FullMSine_Level1.npz", *signals, "-o", "multisine.json")
    sweep, multisine = (frfid.load(tmp_path / f"{name}.json") for name in ("sweep", "multisine"))
    # the strong ones of the payload; levels of 4.8 and 12 N rms: a softening joint may move them, the sweep's level is the lower
    hz = [3.97, 5.19, 9.17]
    apart = resonances(sweep, 2, hz) - resonances(multisine, 2, hz)
    print(f"resonances of sweep and multisine are {apart} Hz apart")
    assert np.all(np.abs(apart) < 0.02)


def test_ten_sweeps_of_a_flexible_robot_agree_within_their_regions(shared_data):
    data = np.load(shared_data / "slfr_swept" / "swept_0_10hz.npz")
    hz = np.geomspace(1.5, 8.0, 30)
    each = [
        frfid.estimate_local(data["v"][k : k + 1], data["theta"][k : k + 1], r=data["u"][k : k + 1], sample_time_s=0.002, frequencies_hz=hz)
        for k in range(len(data["v"]))
    ]
    mean = np.mean([frf.response for frf in each], axis=0)
    freedom = each[0].total_degrees_of_freedom
    factor = freedom * (0.05 ** (-1 / freedom) - 1)
    held = np.mean([np.abs(frf.response - mean) ** 2 <= factor * frf.total_variance for frf in each])
    print(f"regions of single sweeps hold the mean of ten at {held:.3f} of the frequencies")
    assert held > 0.9


class Resonator:
    """A resonance at 30 Hz with 2 % damping, seen with a little noise, driven by noise from rest."""

    def __init__(self, n_samples=30_000, slow=False):
        rng = np.random.default_rng(1)
        self.time_s = 1e-3 * np.arange(n_samples)
        pole = np.exp(1e-3 * 2 * np.pi * 30 * (-0.02 + 1j * np.sqrt(1 - 0.02**2)))
        self.a = np.poly([pole, pole.conj()]).real
        self.u, self.y = rng.standard_normal(n_samples), np.zeros(n_samples)
        if slow:  # as a drive's reference is: samples that are lost can be bridged
            self.u = np.convolve(self.u, np.hanning(25), "same")
        for k in range(2, n_samples):
            self.y[k] = self.u[k - 1] - self.a[1] * self.y[k - 1] - self.a[2] * self.y[k - 2]
        self.y += 0.001 * self.y.std() * rng.standard_normal(n_samples)

    def truth(self, hz):
        z = np.exp(2j * np.pi * hz * 1e-3)
        return z / np.polyval(self.a, z)

    def write(self, path, kept=slice(None)):
        np.savetxt(path, np.column_stack([self.time_s, self.u, self.y])[kept], delimiter=",", header="t,u,y", comments="", fmt="%.9g")


SIGNALS = ["--u", "u=N m", "--y", "y=rad/s", "--time", "t=s"]


@pytest.mark.parametrize("loss", ["none", "scattered", "hole"])
def test_a_record_of_noise_with_what_it_lost(tmp_path, loss):
    plant = Resonator(slow=loss == "scattered")
    kept = np.ones(len(plant.u), bool)
    if loss == "scattered":
        kept = np.random.default_rng(2).random(len(kept)) > 0.02
    if loss == "hole":
        kept[12_000:12_700] = False
    plant.write(tmp_path / "noise.csv", kept)
    said = run(tmp_path, "estimate", "noise.csv", *SIGNALS, "-o", "frf.json", code=0 if loss == "none" else 3)
    assert "nothing repeats" in said
    frf = frfid.load(tmp_path / "frf.json")
    inside = (frf.frequency_hz > 2) & (frf.frequency_hz < 60)
    error = np.abs(frf.response[inside, 0, 0] / plant.truth(frf.frequency_hz[inside]) - 1)
    print(f"{loss}: error {np.median(error):.4f} in the median, {error.max():.3f} at worst; {frf.provenance['pieces']} pieces")
    assert np.median(error) < 0.01 and np.quantile(error, 0.95) < 0.1
    assert frf.provenance["method"] == "local-rational" and frf.provenance["pieces"] == ("2" if loss == "hole" else "1")
    assert frf.noise_variance is None and frf.total_variance is not None


def test_what_repeats_may_be_estimated_as_whole_records_too(shared_data, tmp_path):
    bench = ["--u", "current_A=A", "--y", "motor_velocity_rad_per_s=rad/s", "--time", "time_s=s"]
    record = shared_data / "motor_bench" / "multisine_type_a.csv.gz"
    names = run(tmp_path, "inspect", record)
    if "time_s" not in names:
        bench = bench[:-2] + ["--sample-time-s", 0.0004]
    run(tmp_path, "estimate", record, *bench, "-o", "periods.json")
    run(tmp_path, "estimate", record, *bench, "--aperiodic", "-o", "whole.json")
    periods, whole = (frfid.load(tmp_path / f"{name}.json") for name in ("periods", "whole"))
    at = np.interp(whole.frequency_hz, periods.frequency_hz, np.arange(len(periods.frequency_hz)), left=np.nan, right=np.nan)
    near = np.abs(at - np.round(at)) < 0.02  # the lines that are excited; not NaN
    off = np.abs(whole.response[near, 0, 0] / periods.response[np.round(at[near]).astype(int), 0, 0] - 1)
    print(f"transient period included: {np.median(off):.4f} off in the median at {near.sum()} frequencies")
    assert np.median(off) < 0.02


@pytest.mark.parametrize(
    ("options", "said"),
    [(["--period", "1"], "leave out aperiodic"), (["--average", "frfs"], "leave out aperiodic"), (["--realization-of", "0"], "leave out aperiodic")],
)
def test_what_takes_periods_is_refused(tmp_path, options, said):
    Resonator(3000).write(tmp_path / "noise.csv")
    assert said in run(tmp_path, "estimate", "noise.csv", *SIGNALS, "--aperiodic", *options, "-o", "frf.json", code=2)


def test_a_record_too_short_or_silent_is_refused(tmp_path):
    plant = Resonator(3000)
    plant.write(tmp_path / "short.csv", slice(100, 120))
    assert "too few" in run(tmp_path, "estimate", "short.csv", *SIGNALS, "--aperiodic", "-o", "frf.json", code=1)
    plant.u[:] = 0.0
    plant.write(tmp_path / "silent.csv")
    assert "moves" in run(tmp_path, "estimate", "silent.csv", *SIGNALS, "-o", "frf.json", code=2)


def test_what_is_lost_of_a_fast_signal_is_not_made_up(tmp_path):
    plant = Resonator()
    plant.write(tmp_path / "holes.csv", np.random.default_rng(2).random(30_000) > 0.02)
    said = run(tmp_path, "estimate", "holes.csv", *SIGNALS, "-o", "frf.json", code=3)
    frf = frfid.load(tmp_path / "frf.json")
    assert frf.provenance["pieces"] == "16" and "% of the samples unused" in said  # the longest between two holes
    truth = plant.truth(frf.frequency_hz)
    freedom = frf.total_degrees_of_freedom
    factor = freedom * (0.05 ** (-1 / freedom) - 1)
    held = np.mean(np.abs(frf.response[:, 0, 0] - truth) ** 2 <= factor * frf.total_variance[:, 0, 0])
    print(f"pieces between holes: region holds {held:.2f}")
    assert held > 0.9


def test_two_inputs_that_are_one_are_told(tmp_path):
    plant = Resonator(6000)
    table = np.column_stack([plant.time_s, plant.u, 2 * plant.u, plant.y, plant.y])
    np.savetxt(tmp_path / "twice.csv", table, delimiter=",", header="t,u1,u2,y1,y2", comments="", fmt="%.9g")
    signals = ["--u", "u1=N m", "--u", "u2=N m", "--y", "y1=rad/s", "--y", "y2=rad/s", "--time", "t=s"]
    assert "inputs are alike" in run(tmp_path, "estimate", "twice.csv", *signals, "-o", "frf.json", code=1)


def test_json_says_how_it_was_estimated(tmp_path):
    Resonator().write(tmp_path / "noise.csv")
    said = run(tmp_path, "estimate", "noise.csv", *SIGNALS, "-o", "frf.json", "--json")
    summary, _ = json.JSONDecoder().raw_decode(said)
    assert any(check["name"] == "signals" and check["passed"] for check in summary["checks"])
    assert "nothing repeats" in said
