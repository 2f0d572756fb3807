"""Excitation tested on every line: what is not excited is NaN and named, what cannot be met is refused."""

import numpy as np
import pytest
from joint import MAP, ODD, PERIOD, SAMPLE_TIME_S, Multisine, estimate, instants, joint, noise, steady, write_csv


def arrays(signal, periods):
    return signal.reshape(1, 1, periods, 1, PERIOD)


def test_lines_that_are_stated_but_not_excited(tmp_path):
    t, torque, speed = steady(1, 5)
    torque = torque + noise(9, len(t), 1e-4)
    write_csv(tmp_path / "a.csv", t=t, torque=torque, speed=speed)
    outcome = estimate(tmp_path, ["a.csv"], *MAP, "--lines", "5:119")
    odd = np.round(outcome.hz * 2.4).astype(int) % 2 == 1
    assert outcome.code == 3 and np.isnan(outcome.frf[~odd]).all() and outcome.said("not excited")
    assert np.median(outcome.error()[odd]) < 1e-3 and odd.sum() == len(ODD)


@pytest.mark.parametrize("level", [0.0, 1e-6, 1e-3])
def test_arrays_with_lines_that_are_not_excited(level):
    frfid = pytest.importorskip("frfid")
    t, torque, speed = steady(1, 5)
    u = arrays(torque + noise(3, len(t), level), 5)
    frf = frfid.estimate_bla(u, arrays(speed, 5), sample_time_s=SAMPLE_TIME_S, harmonics=np.arange(5, 120))
    assert any("not excited" in check["found"] for check in frf.checks if not check["passed"])
    assert np.isnan(frf.response[1::2]).all() and np.isfinite(frf.response[0::2]).all()
    assert np.isnan(frf.noise_variance[1::2]).all()


def test_one_weak_line_costs_one_line(tmp_path):
    torque = Multisine.draw(1)
    torque.amplitude[20] *= 1e-7
    t = instants(5)
    u = torque.at(t) + noise(1, len(t), 1e-3)
    write_csv(tmp_path / "a.csv", t=t, torque=u, speed=torque.through(joint).at(t) + noise(2, len(t), 1e-3))
    outcome = estimate(tmp_path, ["a.csv"], *MAP, "--lines", "5:119:2")
    assert outcome.code == 3 and np.isnan(outcome.frf[20, 0, 0]) and np.isnan(outcome.frf).sum() == 1
    assert np.nanmax(outcome.error()) < 0.05


def test_two_inputs_of_which_one_lacks_lines(tmp_path):
    mix = np.array([[1.0, 0.4], [0.3, -0.8]])
    t = instants(4)
    for e in (0, 1):
        draws = [Multisine.draw(10 * e + k) for k in (0, 1)]
        draws[1].amplitude[10:13] = 0
        u = [draw.at(t) for draw in draws]
        through = [draw.through(joint).at(t) for draw in draws]
        y = [row @ through + noise(10 * e + k, len(t), 1e-3) for k, row in enumerate(mix)]
        write_csv(tmp_path / f"{e}.csv", t=t, u1=u[0], u2=u[1], y1=y[0], y2=y[1])
    names = ["--u", "u1=N m", "--u", "u2=N m", "--y", "y1=rad/s", "--y", "y2=rad/s", "--time", "t=s"]
    outcome = estimate(tmp_path, ["0.csv", "1.csv"], *names)
    bad = np.isnan(outcome.frf).all(axis=(1, 2))
    assert outcome.code == 3 and bad.sum() == 3
    truth = joint(outcome.hz)[:, None, None] * mix
    assert np.median(np.abs(outcome.frf / truth - 1)[~bad]) < 1e-2


def test_indirect_without_a_reference_is_refused(tmp_path):
    t, torque, speed = steady(1, 5)
    write_csv(tmp_path / "a.csv", t=t, torque=torque, speed=speed)
    for options in (["--indirect"], ["--method", "joint-input-output"]):
        outcome = estimate(tmp_path, ["a.csv"], *MAP, *options)
        assert outcome.result is None and outcome.said("reference", "--r")


def test_a_result_with_lines_left_out_can_be_used(tmp_path):
    frfid = pytest.importorskip("frfid")
    t, torque, speed = steady(1, 5)
    write_csv(tmp_path / "a.csv", t=t, torque=torque, speed=speed)
    estimate(tmp_path, ["a.csv"], *MAP, "--lines", "5:119")
    frf = frfid.load(tmp_path / "result.json")
    assert np.isnan(frf.response).any() and np.isfinite(frf.response).any()
