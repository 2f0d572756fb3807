"""Realizations are measured: equal draws are repetitions, whatever files they came in, and know nothing of distortion."""

import numpy as np
import pytest
from joint import MAP, ODD, PERIOD, PERIOD_S, SAMPLE_TIME_S, Multisine, estimate, instants, joint, noise, write_csv


def bent(speed, share=0.2):
    """An odd distortion, of this share of the rms at the rms."""
    return speed + share * speed * (speed / speed.std()) ** 2


def record(path, seed, number, periods=3, start_s=0.0, share=0.2):
    t = instants(periods)
    torque = Multisine.draw(seed)
    speed = bent(torque.through(joint).at(t + start_s), share)
    write_csv(path, t=t, torque=torque.at(t + start_s), speed=speed + noise(number, len(t), 1e-3 * speed.std()))


def median_deviation(outcome, kind):
    return np.median(np.sqrt(outcome.variance(kind)[:, 0]) / np.abs(outcome.frf[:, 0, 0]))


def test_one_draw_in_four_files(tmp_path):
    for number in range(4):
        record(tmp_path / f"{number}.csv", 1, number)
    outcome = estimate(tmp_path, [f"{number}.csv" for number in range(4)], *MAP)
    assert outcome.variance("total") is None and outcome.said("same draw")
    assert outcome.result["noise"]["degrees_of_freedom"] == 11
    assert outcome.said("distortion", "other phases")


def test_one_draw_started_anywhere_in_its_period(tmp_path):
    for number, start_s in enumerate((0.0, 0.7132, 1.9)):
        record(tmp_path / f"{number}.csv", 1, number, start_s=start_s)
    for average in ("frfs", "spectra"):
        outcome = estimate(tmp_path, ["0.csv", "1.csv", "2.csv"], *MAP, "--average", average)
        assert outcome.variance("total") is None and outcome.said("same draw")
        assert outcome.result["noise"]["degrees_of_freedom"] == 8
        assert median_deviation(outcome, "noise") < 3e-3


def test_two_draws_in_four_files(tmp_path):
    for number, seed in enumerate((1, 1, 2, 2)):
        record(tmp_path / f"{number}.csv", seed, number)
    outcome = estimate(tmp_path, [f"{number}.csv" for number in range(4)], *MAP)
    assert outcome.result["total"]["degrees_of_freedom"] == 1 and outcome.said("same draw")
    assert 0.02 < median_deviation(outcome, "total") < 0.6


def test_five_draws_are_five(tmp_path):
    for seed in range(5):
        record(tmp_path / f"{seed}.csv", seed, seed)
    outcome = estimate(tmp_path, [f"{seed}.csv" for seed in range(5)], *MAP)
    assert outcome.result["total"]["degrees_of_freedom"] == 4 and not outcome.said("same draw")
    assert 0.02 < median_deviation(outcome, "total") < 0.6 and outcome.code == 0


def test_one_draw_halved_into_two_files(tmp_path):
    t = instants(8)
    torque = Multisine.draw(3)
    speed = bent(torque.through(joint).at(t))
    speed = speed + noise(1, len(t), 1e-3 * speed.std())
    for number, part in enumerate((slice(0, 4 * PERIOD + 300), slice(4 * PERIOD + 300, None))):
        write_csv(tmp_path / f"{number}.csv", t=t[part], torque=torque.at(t)[part], speed=speed[part])
    outcome = estimate(tmp_path, ["0.csv", "1.csv"], *MAP)
    assert outcome.variance("total") is None and outcome.said("same draw")


def test_two_inputs_each_experiment_twice(tmp_path):
    mix = np.array([[1.0, 0.4], [0.3, -0.8]])
    draws = [[Multisine.draw(10 * e + k) for k in (0, 1)] for e in (0, 1)]
    t = instants(3)
    for e, channels in enumerate(draws):
        for again in (0, 1):
            u = [channel.at(t) for channel in channels]
            through = [channel.through(joint).at(t) for channel in channels]
            y = [row @ through + noise(10 * e + again, len(t), 1e-3) for row in mix]
            write_csv(tmp_path / f"{e}{again}.csv", t=t, u1=u[0], u2=u[1], y1=y[0], y2=y[1])
    names = ["--u", "u1=N m", "--u", "u2=N m", "--y", "y1=rad/s", "--y", "y2=rad/s", "--time", "t=s"]
    for files in (["00.csv", "10.csv", "01.csv", "11.csv"], ["00.csv", "01.csv", "10.csv", "11.csv"]):
        outcome = estimate(tmp_path, files, *names)
        truth = joint(outcome.hz)[:, None, None] * mix
        assert np.median(np.abs(outcome.frf / truth - 1)) < 5e-3
        assert outcome.variance("total") is None and outcome.result["noise"]["degrees_of_freedom"] == 5


def test_who_knows_better_can_say_so(tmp_path):
    for number in range(2):
        record(tmp_path / f"{number}.csv", number, number)
    outcome = estimate(tmp_path, ["0.csv", "1.csv"], *MAP, "--realization-of", "0,0")
    assert outcome.variance("total") is None
    outcome = estimate(tmp_path, ["0.csv", "1.csv"], *MAP, "--realization-of", "0,1,2")
    assert outcome.result is None and outcome.said("realization")


def test_arrays_of_one_draw(tmp_path):
    frfid = pytest.importorskip("frfid")
    t = instants(4)
    torque = Multisine.draw(1)
    u = np.broadcast_to(torque.at(t).reshape(1, 1, 4, 1, PERIOD), (3, 1, 4, 1, PERIOD)).copy()
    speed = bent(torque.through(joint).at(t)).reshape(1, 1, 4, 1, PERIOD)
    y = speed + np.stack([noise(k, 4 * PERIOD, 1e-3).reshape(1, 4, 1, PERIOD) for k in range(3)])
    frf = frfid.estimate_bla(u, y, sample_time_s=SAMPLE_TIME_S, harmonics=ODD)
    assert any("same draw" in check["found"] for check in frf.checks if not check["passed"])
    assert frf.total_variance is None and frf.noise_variance is not None
    assert np.allclose(frf.frequency_hz * PERIOD_S, ODD)
