"""Runs of a plan in recordings of others, from Python; and a machine that went beyond a limit."""

import frfid
import numpy as np
import pytest

T = 0.002
PLAN = """
seed = 3
sample_time_s = 0.002

[robot.single_joint]
motor_inertia_kg_m2 = 35.0
link_inertia_kg_m2 = 150.0
stiffness_nm_per_rad = 150000.0
damping_nms_per_rad = 400.0
coulomb_nm = 0.0

[controller]
gain_nms_per_rad = [2000.0]
integral_gain_nm_per_rad = [16000.0]

[multisine]
low_hz = 2.0
high_hz = 40.0
resolution_hz = 1.0
peak_rad_s = [0.1]

[averaging]
realizations = 3
repetitions = 1
periods = 2
"""
MAP = {
    "time": {"source": "t", "unit": "s"},
    "u": [{"source": "u", "unit": "N m"}],
    "y": [{"source": "y", "unit": "deg/s"}],
    "r": [{"source": "r", "unit": "deg/s"}],
    "position": [{"source": "q", "unit": "deg"}],
}


@pytest.fixture
def plan(tmp_path):
    (tmp_path / "plan.toml").write_text(PLAN)
    return frfid.Experiment.load(tmp_path / "plan.toml").design()


def recording(plan, path, order):
    """A campaign in one CSV, in degrees, on a clock 80 ppm off, one sample of a hundred lost."""
    records = plan.run()
    rest = np.zeros((4, 500))
    signals = [np.vstack([records[k].u, *(np.degrees(s) for s in (records[k].y, records[k].r, records[k].position_rad))]) for k in order]
    table = np.hstack([rest, *(part for run in signals for part in (run, rest))])
    time_s = 1000.0 + T * np.arange(table.shape[1]) * (1 + 80e-6)
    keep = np.random.default_rng(1).random(table.shape[1]) > 0.01
    np.savetxt(path, np.vstack([time_s, table]).T[keep], delimiter=",", header="t,u,y,r,q", comments="", fmt="%.12g")
    return records


def test_the_runs_come_back_by_their_names(plan, tmp_path):
    records = recording(plan, tmp_path / "all.csv", [2, 0, 1])
    told = plan.import_recordings(tmp_path / "all.csv", MAP, tmp_path / "logs")
    assert [run["run"] for run in told["imported"]] == ["p002-m0-q0", "p000-m0-q0", "p001-m0-q0"]
    assert not told["missing"] and not told["unused"] and not told["warnings"]
    for run in told["imported"]:
        assert abs(run["clock_ppm"] - 80) < 3 and run["likeness"] > 0.99 and run["rival"] < 0.9
    imported, ideal = frfid.estimate_logs(tmp_path / "logs"), plan.estimate(records)
    off = np.abs(imported.response / ideal.response - 1)
    assert np.sqrt(np.mean(off**2)) < 1e-3
    again = plan.import_recordings([tmp_path / "all.csv"], MAP, tmp_path / "logs")
    assert again["n_skipped"] == 3 and not again["imported"]


def test_repetitions_may_come_one_by_one(tmp_path):
    twice = PLAN.replace("realizations = 3", "realizations = 1").replace("repetitions = 1", "repetitions = 2")
    (tmp_path / "plan.toml").write_text(twice)
    plan = frfid.Experiment.load(tmp_path / "plan.toml").design()
    for name, order in (("monday", [0]), ("tuesday", [1, 1])):
        recording(plan, tmp_path / f"{name}.csv", order)
    logs = tmp_path / "logs"
    with pytest.warns(UserWarning, match="in none of the recordings: p000-m0-q1"):
        plan.import_recordings(tmp_path / "monday.csv", MAP, logs)
    with pytest.warns(UserWarning, match="once more than the plan repeats it"):
        second = plan.import_recordings(tmp_path / "tuesday.csv", MAP, logs)
    assert [run["run"] for run in second["imported"]] == ["p000-m0-q1"] and not second["missing"]
    again = plan.import_recordings(tmp_path / "monday.csv", MAP, logs)
    assert again["n_skipped"] == 1 and not again["imported"] and not again["missing"]


def test_what_is_missing_or_too_many_is_said(plan, tmp_path):
    recording(plan, tmp_path / "some.csv", [1, 1])
    with pytest.warns(UserWarning) as said:
        told = plan.import_recordings(tmp_path / "some.csv", MAP, tmp_path / "logs")
    words = "\n".join(str(warning.message) for warning in said)
    assert "once more than the plan repeats it" in words and "in none of the recordings: p000-m0-q0, p002-m0-q0" in words
    assert told["missing"] == ["p000-m0-q0", "p002-m0-q0"] and len(told["imported"]) == 1


def test_recordings_of_another_plan_are_refused(plan, tmp_path):
    (tmp_path / "other.toml").write_text(PLAN.replace("seed = 3", "seed = 4"))
    other = frfid.Experiment.load(tmp_path / "other.toml").design()
    recording(other, tmp_path / "other.csv", [0, 1, 2])
    with pytest.raises(ValueError, match="runs of the plan in the recordings"):
        plan.import_recordings(tmp_path / "other.csv", MAP, tmp_path / "logs")


class Leaping:
    """A machine that goes beyond its limits in its first run."""

    def __init__(self):
        self.names = []

    def run(self, run):
        self.names.append(run.name)
        n = run.reference.shape[1]
        return frfid.Record(sample_time_s=T, u=np.zeros((1, n)), y=np.full((1, n), 9.0), r=run.reference)


@pytest.mark.parametrize("folder", [None, "logs"])
def test_a_machine_beyond_its_limits_is_not_sent_the_next_run(tmp_path, folder):
    (tmp_path / "plan.toml").write_text(PLAN + "\n[limits]\nmax_velocity = [0.5]\n")
    plan = frfid.Experiment.load(tmp_path / "plan.toml").design()
    machine, kept = Leaping(), folder and tmp_path / folder
    with pytest.raises(Exception, match="not sent to the machine: in run p000-m0-q0 axis 1 reached velocity 9 rad/s"):
        plan.run(machine, folder=kept)
    assert machine.names == ["p000-m0-q0"]
    if kept:
        with pytest.raises(Exception, match="not sent to the machine"):
            plan.run(machine, folder=kept)
        assert machine.names == ["p000-m0-q0"], "not when called again, either"
