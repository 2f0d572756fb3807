"""Period, lines and rests: found wherever they are in a recording, or stated by whoever knows better."""

import numpy as np
import pytest
from joint import MAP, ODD, PERIOD, SAMPLE_TIME_S, Multisine, estimate, instants, joint, noise, steady, write_csv


def settled_run(seed, periods, lines=ODD):
    t, torque, speed = steady(seed, periods, lines=lines)
    return torque, speed


def rest(samples, seed=0, size=1e-3):
    return np.zeros(samples), noise(seed + 50, samples, size)


def write(path, *parts):
    torque, speed = (np.concatenate([part[k] for part in parts]) for k in (0, 1))
    write_csv(path, t=SAMPLE_TIME_S * np.arange(len(torque)), torque=torque, speed=speed)


def right(outcome, limit=1e-3, worst=2e-2):
    return np.median(outcome.error()) < limit and outcome.error().max() < worst


@pytest.mark.parametrize(("before", "after"), [(850, 0), (0, 1150), (3210, 777), (100, 40)])
def test_rests_around_the_excitation(tmp_path, before, after):
    write(tmp_path / "a.csv", rest(before), settled_run(1, 5), rest(after, 1))
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert right(outcome) and outcome.inside() > 0.8
    assert outcome.result["noise"]["degrees_of_freedom"] in (3, 4)


def test_a_session_of_three_runs_with_rests(tmp_path):
    parts = [part for seed in (1, 2, 3) for part in (settled_run(seed, 3), rest(700 + 90 * seed, seed))]
    write(tmp_path / "a.csv", *parts)
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert right(outcome) and outcome.result["total"]["degrees_of_freedom"] == 2


def test_a_session_without_rests(tmp_path):
    write(tmp_path / "a.csv", *(settled_run(seed, 3) for seed in (1, 2, 3)))
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert right(outcome) and outcome.result["total"]["degrees_of_freedom"] == 2


def test_rows_lost_without_times_shift_nothing(tmp_path):
    torque, speed = settled_run(1, 9)
    keep = np.ones(len(torque), bool)
    keep[[3000, 7777, 7778]] = False
    write_csv(tmp_path / "a.csv", torque=torque[keep], speed=speed[keep])
    outcome = estimate(tmp_path, ["a.csv"], *MAP[:4], "--sample-time-s", "0.002")
    assert right(outcome) and np.allclose(outcome.hz * 2.4, ODD)
    assert outcome.variance("total") is None


@pytest.mark.parametrize("step", [1e-2, 1e-3, None])
def test_a_command_that_was_rounded(tmp_path, step):
    t, torque, speed = steady(2, 4)
    step = step or 2 * np.abs(torque).max() / 4096
    write_csv(tmp_path / "a.csv", t=t, torque=step * np.round(torque / step), speed=speed)
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert right(outcome, 3e-3, 5e-2) and len(outcome.hz) == len(ODD)


def test_a_steep_spectrum_with_noise(tmp_path):
    torque = Multisine.draw(4, np.arange(1, 31))
    torque.amplitude *= torque.lines**-1.4
    t = instants(6)
    u, y = torque.at(t), torque.through(joint).at(t)
    u, y = u + noise(1, len(t), 0.03 * u.std()), y + noise(2, len(t), 1e-3 * y.std())
    write_csv(tmp_path / "a.csv", t=t, torque=u, speed=y)
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert len(outcome.hz) >= 25 and np.allclose(outcome.hz * 2.4, np.round(outcome.hz * 2.4))


def test_three_axes_one_after_the_other_with_quiet_noise(tmp_path):
    mix = np.array([[1, 0.2, 0.1], [-0.3, 0.7, 0.2], [0.1, 0.2, 1.4]])
    for axis in range(3):
        t, torque, _ = steady(axis, 4)
        speed = Multisine.draw(axis).through(joint).at(t)
        u = [torque if k == axis else noise(10 * axis + k, len(t), 2e-3) for k in range(3)]
        y = [row[axis] * speed + noise(100 + 10 * axis + k, len(t), 1e-3) for k, row in enumerate(mix)]
        write_csv(tmp_path / f"{axis}.csv", **{f"u{k}": u[k] for k in range(3)}, **{f"y{k}": y[k] for k in range(3)})
    names = [word for k in range(3) for word in ("--u", f"u{k}=N m", "--y", f"y{k}=rad/s")]
    outcome = estimate(tmp_path, ["0.csv", "1.csv", "2.csv"], *names, "--sample-time-s", "0.002")
    truth = joint(outcome.hz)[:, None, None] * mix
    assert np.median(np.abs(outcome.frf - truth) / np.abs(truth)) < 2e-2 and len(outcome.hz) == len(ODD)


def test_start_end_period_and_lines_can_be_stated(tmp_path):
    torque, speed = settled_run(1, 6)
    torque[: 2 * PERIOD] *= 1.7  # somebody played with the gain
    speed[: 2 * PERIOD] *= 1.3
    write_csv(tmp_path / "a.csv", t=SAMPLE_TIME_S * np.arange(len(torque)), torque=torque, speed=speed)
    stated = ["--start", "4.8", "--end", "14.4", "--period", "2.4", "--lines", "5:119:2"]
    outcome = estimate(tmp_path, ["a.csv"], *MAP, *stated)
    assert outcome.code == 0 and right(outcome) and outcome.result["noise"]["degrees_of_freedom"] == 3
    lines = estimate(tmp_path, ["a.csv"], *MAP, "--start", "4.8", "--lines", "5,7,9")
    assert np.allclose(lines.hz * 2.4, [5, 7, 9])
    for wrong in (["--start", "30"], ["--period", "0"], ["--lines", "5:9999"], ["--start", "5", "--end", "4"]):
        assert estimate(tmp_path, ["a.csv"], *MAP, *wrong).result is None


def test_the_same_keys_in_the_map(tmp_path):
    torque, speed = settled_run(1, 6)
    write_csv(tmp_path / "a.csv", torque=torque, speed=speed)
    (tmp_path / "map.toml").write_text(
        'sample_time_s = 0.002\nstart_s = 2.4\nperiod_s = 2.4\nlines = [5, 7, 9]\nrealization_of = [3]\n'
        '[[u]]\nsource = "torque"\nunit = "N m"\n[[y]]\nsource = "speed"\nunit = "rad/s"\n'
    )
    outcome = estimate(tmp_path, ["a.csv"], "--map", "map.toml")
    assert outcome.code == 0 and np.allclose(outcome.hz * 2.4, [5, 7, 9])


def test_what_does_not_repeat_is_told_as_what_it_is(tmp_path):
    t = SAMPLE_TIME_S * np.arange(10_000)
    sweep = np.sin(2 * np.pi * (1.0 * t + 0.9 * t**2))
    write_csv(tmp_path / "sweep.csv", t=t, torque=sweep, speed=np.gradient(sweep))
    outcome = estimate(tmp_path, ["sweep.csv"], *MAP)
    assert outcome.said("nothing repeats")
    hz, response = outcome.hz, outcome.frf[:, 0, 0]
    middle = (hz > 5) & (hz < 15)  # of a central difference
    assert middle.sum() > 20
    assert np.allclose(response[middle], 1j * np.sin(2 * np.pi * hz[middle] * SAMPLE_TIME_S), rtol=1e-3)
    write_csv(tmp_path / "noise.csv", t=t, torque=noise(1, len(t), 1), speed=noise(2, len(t), 1))
    outcome = estimate(tmp_path, ["noise.csv"], *MAP)
    assert outcome.code == 3 and outcome.said("nothing repeats", "noise")
