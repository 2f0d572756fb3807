"""Every recording against the others: what differs is not used or refused, and never mixed in."""

import shutil

import numpy as np
from joint import MAP, ODD, SAMPLE_TIME_S, estimate, instants, joint, steady, write_csv


def record(path, seed, periods=4, **how):
    t, torque, speed = steady(seed, periods, **how)
    write_csv(path, t=t, torque=torque, speed=speed)


def right(outcome):
    return np.median(outcome.error()) < 1e-3 and outcome.error().max() < 2e-2


def test_the_one_of_another_sample_time_is_not_used(tmp_path):
    for seed in (1, 2):
        record(tmp_path / f"{seed}.csv", seed)
    record(tmp_path / "slow.csv", 3, t=instants(4, 2 * SAMPLE_TIME_S))
    outcome = estimate(tmp_path, ["slow.csv", "1.csv", "2.csv"], *MAP)
    assert outcome.code == 3 and right(outcome)
    assert outcome.said("slow.csv", "not used", "0.004 s", "0.002 s")


def test_two_of_different_sample_times_are_refused_with_both(tmp_path):
    record(tmp_path / "a.csv", 1)
    record(tmp_path / "b.csv", 2, t=instants(4, 1.25 * SAMPLE_TIME_S))
    for files in (["a.csv", "b.csv"], ["b.csv", "a.csv"]):
        outcome = estimate(tmp_path, files, *MAP)
        assert outcome.result is None and outcome.said("0.002 s", "0.0025 s")


def test_another_period_is_not_used(tmp_path):
    for seed in (1, 2):
        record(tmp_path / f"{seed}.csv", seed)
    t = instants(5)
    stretched = steady(3, 5, t=t * 0.9)
    write_csv(tmp_path / "other.csv", t=t, torque=stretched[1], speed=stretched[2])
    outcome = estimate(tmp_path, ["1.csv", "2.csv", "other.csv"], *MAP)
    assert outcome.code == 3 and right(outcome) and outcome.said("other.csv", "not used", "period")


def test_other_lines_are_not_used_and_two_alone_are_refused(tmp_path):
    for seed in (1, 2):
        record(tmp_path / f"{seed}.csv", seed)
    record(tmp_path / "even.csv", 3, lines=np.r_[5, ODD + 1])
    outcome = estimate(tmp_path, ["1.csv", "even.csv", "2.csv"], *MAP)
    assert outcome.code == 3 and right(outcome) and outcome.said("even.csv", "not used", "lines")
    outcome = estimate(tmp_path, ["1.csv", "even.csv"], *MAP)
    assert outcome.result is None and outcome.said("lines")


def test_a_few_lines_less_cost_these_lines_only(tmp_path):
    record(tmp_path / "all.csv", 1)
    record(tmp_path / "fewer.csv", 2, lines=np.delete(ODD, [10, 30]))
    outcome = estimate(tmp_path, ["all.csv", "fewer.csv"], *MAP)
    sound = np.isfinite(outcome.frf[:, 0, 0])
    assert sound.sum() == len(ODD) - 2 and np.nanmedian(outcome.error()) < 1e-3
    assert np.allclose(outcome.hz[sound] * 2.4, np.delete(ODD, [10, 30]))


def test_an_unreadable_one_stops_nothing(tmp_path):
    for seed in (1, 2):
        record(tmp_path / f"{seed}.csv", seed)
    t, torque, _ = steady(3, 4)
    write_csv(tmp_path / "no_speed.csv", t=t, torque=torque)
    outcome = estimate(tmp_path, ["1.csv", "no_speed.csv", "2.csv"], *MAP)
    assert outcome.code == 3 and right(outcome) and outcome.said("no_speed.csv", "not used")


def test_the_same_bytes_twice_are_refused(tmp_path):
    record(tmp_path / "a.csv", 1)
    shutil.copy(tmp_path / "a.csv", tmp_path / "copy.csv")
    outcome = estimate(tmp_path, ["a.csv", "copy.csv"], *MAP)
    assert outcome.result is None and outcome.said("a.csv", "copy.csv", "same")


def test_other_levels_are_told(tmp_path):
    record(tmp_path / "a.csv", 1)
    record(tmp_path / "b.csv", 2)
    record(tmp_path / "strong.csv", 3, size=6.0)
    outcome = estimate(tmp_path, ["a.csv", "b.csv", "strong.csv"], *MAP)
    assert right(outcome) and outcome.said("strong.csv", "another FRF at each level")


def test_a_joint_that_stood_in_one_recording(tmp_path):
    for seed in (1, 2):
        record(tmp_path / f"{seed}.csv", seed)
    t, torque, speed = steady(3, 4)
    write_csv(tmp_path / "stood.csv", t=t, torque=torque, speed=0 * speed)
    outcome = estimate(tmp_path, ["1.csv", "2.csv", "stood.csv"], *MAP)
    assert outcome.code == 3 and right(outcome) and outcome.said("stood.csv", "not used")
    assert joint(outcome.hz).shape == (len(ODD),)
