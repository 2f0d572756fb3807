"""Runs of a machine kept in a folder: what was measured is on disk before the next run, and nothing is done twice."""

import frfid
import numpy as np
import pytest
from test_experiment import SMALL, Machine


class Failing(Machine):
    """A machine that breaks down in its third run, once."""

    def __init__(self):
        super().__init__()
        self.names, self.is_broken = [], False

    def run(self, run):
        if len(self.names) == 2 and not self.is_broken:
            self.is_broken = True
            raise RuntimeError("the drive tripped")
        self.names.append(run.name)
        return super().run(run)


@pytest.fixture
def plan(tmp_path):
    (tmp_path / "experiment.toml").write_text(SMALL)
    return frfid.Experiment.load(tmp_path / "experiment.toml").design()


def test_what_was_measured_outlives_an_exception(plan, tmp_path):
    machine = Failing()
    with pytest.raises(RuntimeError, match="the drive tripped"):
        plan.run(machine, folder=tmp_path / "logs")
    assert sorted(path.name for path in (tmp_path / "logs").iterdir()) == ["p000-m0-q0.mcap", "p001-m0-q0.mcap"]
    told = []
    records = plan.run(machine, folder=tmp_path / "logs", progress=lambda *of: told.append(of))
    assert machine.names == plan.names and told[-1] == (3, 3)
    for kept, fresh in zip(records, plan.run(Machine()), strict=True):
        for signal in ("u", "y", "r"):
            np.testing.assert_array_equal(getattr(kept, signal), getattr(fresh, signal))


def test_the_folder_is_that_of_the_command_line(plan, tmp_path):
    records = plan.run(Machine(), folder=tmp_path / "logs")
    of_files = frfid.estimate_logs(tmp_path / "logs")
    of_memory = plan.estimate(records)
    np.testing.assert_array_equal(of_files.response, of_memory.response)
    np.testing.assert_array_equal(of_files.total_variance, of_memory.total_variance)
    assert of_files.checks == of_memory.checks
    plan.run(folder=tmp_path / "simulated", jobs=2)
    assert len(list((tmp_path / "simulated").glob("*.mcap"))) == 3


def test_another_experiment_in_the_way_is_refused_and_stays(plan, tmp_path):
    plan.run(Machine(), folder=tmp_path / "logs")
    (tmp_path / "other.toml").write_text(SMALL.replace("seed = 1", "seed = 2"))
    other = frfid.Experiment.load(tmp_path / "other.toml").design()
    before = (tmp_path / "logs" / "p000-m0-q0.mcap").read_bytes()
    with pytest.raises((OSError, ValueError), match="exists"):
        other.run(Machine(), folder=tmp_path / "logs")
    assert (tmp_path / "logs" / "p000-m0-q0.mcap").read_bytes() == before


def test_a_stopped_run_is_done_again_only_if_asked(plan, tmp_path):
    class Stopping(Machine):
        def run(self, run):
            record = super().run(run)
            half = record.n_samples // 2
            stop = [{"time_s": half * 1e-3, "event": "stopped", "reason": "by hand"}]
            return frfid.Record(sample_time_s=1e-3, u=record.u[:, :half], y=record.y[:, :half], r=record.r[:, :half], events=stop)

    machine = Machine()
    for testbed in (Stopping(), machine):
        with pytest.raises(ValueError, match="run p000-m0-q0 was stopped at 4.608 s; find out why"):
            plan.run(testbed, folder=tmp_path / "logs")
    assert machine.runs == 0 and [path.name for path in (tmp_path / "logs").iterdir()] == ["p000-m0-q0.mcap"]
    again = plan.run(machine, folder=tmp_path / "logs", overwrite=True)
    assert machine.runs == 3 and again[0].n_samples == plan.reference(0).shape[1]
