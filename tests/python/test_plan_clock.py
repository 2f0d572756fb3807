"""A player that brings its count and the number of the plan back: runs are where its clock has them."""

import csv

import frfid
import numpy as np
import pytest
from test_import_recordings import MAP, PLAN

LOGGED = {
    **MAP,
    "position": [],
    "plan_clock": [{"source": "k", "unit": "1"}],
    "plan_id": {"source": "plan_id", "unit": "1"},
}
RATE_HZ, RECORDER_HZ, PPM, DELAY_S = 500.0, 800.0, -120.0, 0.013


@pytest.fixture
def plan(tmp_path):
    (tmp_path / "plan.toml").write_text(PLAN)
    return frfid.Experiment.load(tmp_path / "plan.toml").design()


def played(files, path, *, speed=1.0, delay_s=DELAY_S, plan_id=None, noise=2e-4):
    """What a recorder has of a player that plays these files: its own clock, one sample of a hundred lost, the machine late."""
    rng, begin_s, rows = np.random.default_rng(7), 1.0, []
    tables = [np.genfromtxt(file, delimiter=",", skip_header=1) for file in files]
    lengths_s = [len(table) / RATE_HZ / speed for table in tables]
    time_s = np.arange(0.0, sum(lengths_s) + 2.0 * len(tables) + 1.0, 1.0 / RECORDER_HZ)
    k, velocity, number = np.zeros(len(time_s)), np.zeros(len(time_s)), np.zeros(len(time_s))
    for table, length_s in zip(tables, lengths_s, strict=True):
        count = np.floor((time_s - begin_s) * RATE_HZ * speed)
        inside = (count >= 0) & (count < len(table))
        k[inside], number[inside] = count[inside], table[0, 2] if plan_id is None else plan_id
        k[time_s >= begin_s + length_s] = len(table) - 1
        late_s = (time_s - begin_s - delay_s) * speed
        velocity += np.interp(late_s, np.arange(len(table)) / RATE_HZ, table[:, 4], left=0.0, right=0.0)
        begin_s += length_s + 2.0
    velocity += noise * rng.standard_normal(len(time_s))
    rows = np.array([5.0 + time_s * (1 + PPM * 1e-6), k, number, 100 * velocity, np.degrees(velocity), np.degrees(velocity)]).T
    kept = rows[rng.random(len(rows)) > 0.01]
    np.savetxt(path, kept, delimiter=",", header="t,k,plan_id,u,y,r", comments="", fmt="%.12g")


def files_of(plan, folder, **options):
    plan.export(folder, "csv", rate_hz=RATE_HZ, **options)
    with open(folder / "runs.csv", newline="") as order:
        return list(dict.fromkeys(folder / row["file"] for row in csv.DictReader(order)))


@pytest.mark.parametrize("campaign", [False, True])
def test_runs_are_found_on_the_clock_of_the_player(plan, tmp_path, campaign):
    files = files_of(plan, tmp_path / "out", campaign=campaign)
    played(files if campaign else [files[2], files[0], files[1]], tmp_path / "all.csv")
    told = plan.import_recordings(tmp_path / "all.csv", LOGGED, tmp_path / "logs", rate_hz=RATE_HZ)
    order = [0, 1, 2] if campaign else [2, 0, 1]
    assert [run["run"] for run in told["imported"]] == [f"p00{k}-m0-q0" for k in order]
    assert not told["missing"] and not told["unused"]
    for run in told["imported"]:
        assert abs(run["clock_ppm"] - PPM) < 3
        # half a sample of the recorder: what is held by the player was written sometime before
        assert abs(run["delay_s"] - DELAY_S) < 1.0 / RECORDER_HZ
    by_content = plan.import_recordings(tmp_path / "all.csv", MAP | {"position": []}, tmp_path / "by-content", rate_hz=RATE_HZ)
    assert [run["delay_s"] for run in by_content["imported"]] == [None, None, None]
    starts = [[run["start_s"] for run in summary["imported"]] for summary in (told, by_content)]
    np.testing.assert_allclose(*starts, atol=46e-6)


def test_another_plan_is_told_by_its_number_alone(plan, tmp_path):
    files = files_of(plan, tmp_path / "out")
    played(files, tmp_path / "other.csv", plan_id=12345)
    with pytest.raises(ValueError, match=r"plan_id of the recording: found 12345"):
        plan.import_recordings(tmp_path / "other.csv", LOGGED, tmp_path / "logs", rate_hz=RATE_HZ)
    played(files, tmp_path / "none.csv", plan_id=0)
    with pytest.raises(ValueError, match=r"plan_id of the recording: found 0 all along"):
        plan.import_recordings(tmp_path / "none.csv", LOGGED, tmp_path / "logs", rate_hz=RATE_HZ)


def test_a_number_in_single_precision_is_enough(plan, tmp_path):
    files = files_of(plan, tmp_path / "out")
    number = np.genfromtxt(files[0], delimiter=",", skip_header=1)[0, 2]
    played(files, tmp_path / "plc.csv", plan_id=float(np.float32(number)))
    told = plan.import_recordings(tmp_path / "plc.csv", LOGGED, tmp_path / "logs", rate_hz=RATE_HZ)
    assert len(told["imported"]) == 3 and not told["unused"]


def test_a_slider_below_100_percent_is_measured_by_the_count(plan, tmp_path):
    played(files_of(plan, tmp_path / "out"), tmp_path / "slow.csv", speed=0.5)
    with pytest.raises(ValueError, match=r"player's clock runs at 50(\.0\d)? % of the recorder's"):
        plan.import_recordings(tmp_path / "slow.csv", LOGGED, tmp_path / "logs", rate_hz=RATE_HZ)


def test_a_run_far_from_its_place_is_doubtful(plan, tmp_path):
    played(files_of(plan, tmp_path / "out"), tmp_path / "late.csv", delay_s=0.15)
    with pytest.raises(ValueError, match=r"0\.1\d* s after the player's clock has it"):
        plan.import_recordings(tmp_path / "late.csv", LOGGED, tmp_path / "logs", rate_hz=RATE_HZ)


def test_a_count_that_stands_still_says_nothing(plan, tmp_path):
    played(files_of(plan, tmp_path / "out"), tmp_path / "all.csv")
    rows = np.genfromtxt(tmp_path / "all.csv", delimiter=",", skip_header=1)
    rows[:, 1] = 0.0
    np.savetxt(tmp_path / "still.csv", rows, delimiter=",", header="t,k,plan_id,u,y,r", comments="", fmt="%.12g")
    with pytest.warns(UserWarning, match="stands still"):
        told = plan.import_recordings(tmp_path / "still.csv", LOGGED, tmp_path / "logs", rate_hz=RATE_HZ)
    assert len(told["imported"]) == 3


@pytest.mark.parametrize("unit", ["rad", "N m"])
def test_a_clock_is_a_count_or_a_time(plan, tmp_path, unit):
    played(files_of(plan, tmp_path / "out"), tmp_path / "all.csv")
    wrong = LOGGED | {"plan_clock": [{"source": "k", "unit": unit}]}
    with pytest.raises(ValueError, match="plan_clock in the log map"):
        plan.import_recordings(tmp_path / "all.csv", wrong, tmp_path / "logs", rate_hz=RATE_HZ)


def test_the_parts_of_a_time_are_added_up(plan, tmp_path):
    played(files_of(plan, tmp_path / "out"), tmp_path / "all.csv")
    rows = np.genfromtxt(tmp_path / "all.csv", delimiter=",", skip_header=1)
    nanoseconds = np.round(rows[:, 1] / RATE_HZ * 1e9)
    parts = np.column_stack([rows[:, 0], nanoseconds // 1e9, nanoseconds % 1e9, rows[:, 2:]])
    np.savetxt(tmp_path / "ros.csv", parts, delimiter=",", header="t,sec,nanosec,plan_id,u,y,r", comments="", fmt="%.12g")
    clock = {"plan_clock": [{"source": "sec", "unit": "s"}, {"source": "nanosec", "unit": "ns"}]}
    told = plan.import_recordings(tmp_path / "ros.csv", LOGGED | clock, tmp_path / "logs", rate_hz=RATE_HZ)
    assert len(told["imported"]) == 3
    assert all(abs(run["delay_s"] - DELAY_S) < 1.0 / RECORDER_HZ for run in told["imported"])
