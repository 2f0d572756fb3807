"""Time as it was: true sample times with holes, clocks of recorders and players, and what cannot be known."""

import numpy as np
import pytest
from joint import MAP, ODD, PERIOD_S, SAMPLE_TIME_S, Multisine, estimate, instants, joint, noise, steady, write_csv


def write(path, t, torque, speed, **how):
    write_csv(path, t=t, torque=torque, speed=speed, **how)


@pytest.mark.parametrize(("lost", "cost"), [(0.075, 1.04), (0.41, 1.30)])
def test_scattered_losses_cost_what_they_must(tmp_path, lost, cost):
    deviations, inside = [], []
    for seed in range(12):
        t, torque, speed = steady(seed, 6, level=1e-2)
        keep = np.random.default_rng(seed).random(len(t)) > lost
        keep[[0, -1]] = True
        write(tmp_path / "whole.csv", t, torque, speed)
        write(tmp_path / "holes.csv", t[keep], torque[keep], speed[keep])
        whole, holes = (estimate(tmp_path, [f"{name}.csv"], *MAP) for name in ("whole", "holes"))
        assert len(holes.hz) == len(ODD)
        inside.append(holes.inside())
        deviations.append([np.mean(outcome.error() ** 2 * np.abs(joint(outcome.hz)) ** 2) for outcome in (whole, holes)])
    ratio = np.sqrt(np.divide(*np.mean(deviations, axis=0)[::-1]))
    assert ratio == pytest.approx(cost, rel=0.12) and np.mean(inside) > 0.92


@pytest.mark.parametrize("ppm", [30, 200, -450])
def test_two_clocks(tmp_path, ppm):
    t, torque, speed = steady(1, 8, t=instants(8) * (1 + 1e-6 * ppm))
    write(tmp_path / "a.csv", instants(8), torque, speed)
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    true_hz = ODD / PERIOD_S * (1 + 1e-6 * ppm)
    # on the recorder's clock everything is faster by this much
    assert np.abs(outcome.hz / true_hz - 1).max() < 3e-6
    assert np.median(np.abs(outcome.frf[:, 0, 0] / joint(ODD / PERIOD_S) - 1)) < 2e-3 and outcome.said("ppm")


def test_jitter_of_the_samples_themselves(tmp_path):
    t = instants(6)
    t = t + 0.2 * SAMPLE_TIME_S * np.random.default_rng(1).uniform(-1, 1, len(t))
    _, torque, speed = steady(1, 6, t=t)
    write(tmp_path / "a.csv", t, torque, speed, digits=15)
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert np.median(outcome.error()) < 1e-3 and outcome.inside() > 0.85


def test_jitter_of_the_stamps_only(tmp_path):
    t, torque, speed = steady(1, 6)
    late = 0.3 * SAMPLE_TIME_S * np.random.default_rng(1).exponential(0.4, len(t))
    write(tmp_path / "a.csv", t + late, torque, speed, digits=15)
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    # two stamps lie before their predecessors: late by more than a sample, or a clock that was set back
    assert outcome.result is None and outcome.said("2 stamps before their predecessor")
    write(tmp_path / "a.csv", t + np.minimum(late, 0.9 * SAMPLE_TIME_S), torque, speed, digits=15)
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert np.median(outcome.error()) < 1e-3


def test_one_late_stamp(tmp_path):
    t, torque, speed = steady(1, 6)
    stamps = t.copy()
    stamps[3333] += 1.7 * SAMPLE_TIME_S
    write(tmp_path / "a.csv", stamps, torque, speed)
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert outcome.result is None or np.median(outcome.error()) < 1e-3


def test_a_recorder_that_polls(tmp_path):
    """Seven of a hundred samples missing, some twice, time in microseconds from some start."""
    t, torque, speed = steady(1, 6)
    generator = np.random.default_rng(3)
    taken = np.flatnonzero(generator.random(len(t)) > 0.07)
    taken = np.sort(np.concatenate([taken, generator.choice(taken, 40)]))
    write_csv(tmp_path / "a.csv", us=np.round(1e6 * (t[taken] + 12_345.678)), torque=torque[taken], speed=speed[taken])
    outcome = estimate(tmp_path, ["a.csv"], *MAP[:4], "--time", "us=us")
    assert np.median(outcome.error()) < 1e-3 and outcome.said("missing")


def test_whole_milliseconds_at_another_rate(tmp_path):
    step = 1 / 400
    t = np.arange(round(4 * PERIOD_S / step)) * step
    _, torque, speed = steady(1, 4, t=t)
    write_csv(tmp_path / "a.csv", ms=np.floor(1000 * t + 1e-9), torque=torque, speed=speed)
    outcome = estimate(tmp_path, ["a.csv"], *MAP[:4], "--time", "ms=ms")
    assert np.median(outcome.error()) < 1e-3


def test_a_table_of_two_topics(tmp_path):
    t, torque, speed = steady(1, 4)
    rows = sorted([(a, f"{b:.12g}", "") for a, b in zip(t, torque)] + [(a + 3e-4, "", f"{c:.12g}") for a, c in zip(t, speed)])
    text = "".join(f"{a:.6f},{b},{c}\n" for a, b, c in rows)
    (tmp_path / "a.csv").write_text("t,torque,speed\n" + text)
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert np.median(outcome.error()) < 1e-3


def test_a_slow_column_is_refused_with_both_rates(tmp_path):
    t, torque, speed = steady(1, 4)
    slow = torque.copy()
    slow[np.arange(len(t)) % 5 != 0] = np.nan
    write(tmp_path / "a.csv", t, slow, speed)
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert outcome.result is None and outcome.said("torque", "10 ms", "2 ms")


def test_holes_in_one_column_only(tmp_path):
    t, torque, speed = steady(1, 6)
    speed[np.random.default_rng(5).random(len(t)) < 0.1] = np.nan
    write(tmp_path / "a.csv", t, torque, speed)
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert np.median(outcome.error()) < 1e-3 and len(outcome.hz) == len(ODD)


def test_a_lost_block_costs_its_periods_only(tmp_path):
    t, torque, speed = steady(1, 6)
    keep = (t < 6.0) | (t > 6.9)
    write(tmp_path / "a.csv", t[keep], torque[keep], speed[keep])
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert np.median(outcome.error()) < 1e-3 and outcome.inside() > 0.8
    assert outcome.result["noise"]["degrees_of_freedom"] >= 4


def test_a_stamp_far_away_takes_no_memory(tmp_path):
    t, torque, speed = steady(1, 3)
    stamps = t.copy()
    stamps[-1] += 36 * 3600
    write(tmp_path / "a.csv", stamps, torque, speed)
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert outcome.result is None or np.median(outcome.error()) < 1e-3
    assert outcome.said("a.csv")
    assert Multisine.draw(1).lines[0] == ODD[0] and noise(1, 3, 0).sum() == 0
