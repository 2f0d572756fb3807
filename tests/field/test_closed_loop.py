"""Closed loop from one log: every response by the loop's equations, and what is wrong with y over u."""

import numpy as np
import pytest
from joint import ODD, PERIOD_S, SAMPLE_TIME_S, Multisine, estimate, instants, joint, write_csv

MAP = ["--r", "command=rad/s", "--u", "torque=N m", "--y", "speed=rad/s", "--time", "t=s"]
INJECTED = ["--r", "command=N m", "--u", "torque=N m", "--y", "speed=rad/s", "--time", "t=s"]


def controller(hz):
    """PI on the speed."""
    s = 2j * np.pi * np.asarray(hz, float)
    return 1.5 + 8.0 / s


def sensitivity(hz):
    return 1 / (1 + joint(hz) * controller(hz))


def disturbed(seed, periods, enters, level):
    """A disturbance torque of every line up to the Nyquist frequency in each period anew runs around the loop."""
    rng = np.random.default_rng(seed)
    t = instants(periods)
    command = Multisine.draw(seed)
    all_hz = np.fft.rfftfreq(len(t), SAMPLE_TIME_S)[1:]
    d = level * (rng.standard_normal(len(all_hz)) + 1j * rng.standard_normal(len(all_hz)))
    around = np.concatenate([[0], joint(all_hz) * sensitivity(all_hz) * d])
    to_y = joint if enters == "input" else lambda hz: joint(hz) * controller(hz)
    speed = command.through(lambda hz: to_y(hz) * sensitivity(hz)).at(t) + np.fft.irfft(around, len(t))
    back = np.concatenate([[0], -controller(all_hz) * around[1:]])
    to_u = (lambda hz: sensitivity(hz)) if enters == "input" else (lambda hz: controller(hz) * sensitivity(hz))
    torque = command.through(to_u).at(t) + np.fft.irfft(back, len(t))
    return t, command.at(t), torque, speed


def record(path, enters, level=20.0, periods=8, seed=1):
    t, command, torque, speed = disturbed(seed, periods, enters, level)
    write_csv(path, t=t, command=command, torque=torque, speed=speed)


def truth(response, enters):
    hz = ODD / PERIOD_S
    loop = joint(hz) * controller(hz)
    return {
        "plant": joint(hz),
        "r-to-u": sensitivity(hz) if enters == "input" else controller(hz) * sensitivity(hz),
        "r-to-y": joint(hz) * sensitivity(hz) if enters == "input" else loop * sensitivity(hz),
        "sensitivity": sensitivity(hz),
        "complementary-sensitivity": 1 - sensitivity(hz),
        "open-loop": loop,
    }[response]


@pytest.mark.parametrize("enters", ["set-point", "input"])
@pytest.mark.parametrize("response", ["plant", "r-to-u", "r-to-y", "sensitivity", "complementary-sensitivity", "open-loop"])
def test_every_response_of_the_loop(tmp_path, response, enters):
    record(tmp_path / "a.csv", enters)
    outcome = estimate(tmp_path, ["a.csv"], *(INJECTED if enters == "input" else MAP), "--response", response, "--loop", enters)
    assert outcome.result is not None, outcome.text
    error = np.abs(outcome.frf[:, 0, 0] - truth(response, enters))
    dof = outcome.result["noise"]["degrees_of_freedom"]
    limit = outcome.variance()[:, 0] * dof * (0.05 ** (-1 / dof) - 1)
    assert not outcome.said("noise runs around the loop")
    assert np.median(error / np.abs(truth(response, enters))) < 1e-2 and np.mean(error**2 <= limit) > 0.85
    units = (outcome.result["input_units"], outcome.result["output_units"])
    unit = "N m" if enters == "input" else "rad/s"
    ends = {"plant": ("N m", "rad/s"), "r-to-u": (unit, "N m"), "r-to-y": (unit, "rad/s")}
    assert units == tuple([end] for end in ends.get(response, (unit, unit)))


def test_where_the_reference_enters_must_be_known(tmp_path):
    record(tmp_path / "a.csv", "set-point")
    outcome = estimate(tmp_path, ["a.csv"], *MAP, "--response", "sensitivity")
    assert outcome.code == 1 and outcome.said("set point", "added to the input"), outcome.text
    outcome = estimate(tmp_path, ["a.csv"], *MAP[2:], "--response", "r-to-u")
    assert outcome.code == 2 and outcome.said("reference", "--r"), outcome.text


@pytest.mark.parametrize("level", [500.0, 800.0])
def test_the_default_goes_through_the_reference(tmp_path, level):
    """y over u finds -1/C where the disturbance rules; the estimate through the reference does not."""
    record(tmp_path / "a.csv", "set-point", level, periods=24)
    through = estimate(tmp_path, ["a.csv"], *MAP)
    naive = estimate(tmp_path, ["a.csv"], *MAP, "--method", "mean-of-frfs")
    assert through.inside() > 0.88, through.text
    assert np.nanmean(naive.error() ** 2) > 1.3 * np.nanmean(through.error() ** 2)
    assert through.said("noise runs around the loop"), through.text
    assert "noise on the input" in naive.failed and "noise on the input" not in through.failed
