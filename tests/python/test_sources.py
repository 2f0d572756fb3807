"""Files: what an object was read from is not replaced by what is made of it, and what is missing is named."""

import errno
import os

import numpy as np
import pytest

import frfid
from test_processes import EXPERIMENT

T = 1e-3
JOINT = frfid.Plant.single_joint()


@pytest.fixture
def experiment(tmp_path):
    path = tmp_path / "experiment.toml"
    path.write_text(EXPERIMENT)
    return frfid.Experiment.load(path)


def test_an_estimate_does_not_replace_its_own_logs(experiment, tmp_path):
    folder = tmp_path / "runs"
    experiment.design().run(folder=folder)
    frf = frfid.estimate_logs(folder)
    log = sorted(folder.glob("*.mcap"))[0]
    before = log.read_bytes()
    for write in (frf.save, frf.to_csv, frf.to_npz, frf.to_mat, frf.to_uff, frf.report):
        with pytest.raises(FileExistsError, match="is what is read, and would be gone"):
            write(log, overwrite=True)
    assert log.read_bytes() == before
    frf.save(tmp_path / "frf.json")


def test_a_result_is_not_replaced_by_an_export_of_itself(tmp_path):
    path = tmp_path / "frf.json"
    JOINT.frf([1.0, 2.0], sample_time_s=T).save(path)
    frf = frfid.load(path)
    (tmp_path / "other.json").symlink_to(path)
    for name in ("frf.json", "other.json"):
        with pytest.raises(FileExistsError):
            frf.to_csv(tmp_path / name, overwrite=True)
    assert frfid.load(path).response.tobytes() == frf.response.tobytes()


def test_a_record_does_not_replace_the_log_that_it_was_read_from(tmp_path):
    path = tmp_path / "run.mcap"
    JOINT.simulate(np.ones((1, 50)), sample_time_s=T).save(path)
    for record in (frfid.Record.load(path), frfid.read(path)):
        with pytest.raises(FileExistsError, match="is what is read"):
            record.save(path, overwrite=True)
        record.save(tmp_path / "copy.mcap", overwrite=True)


def test_a_plan_replaces_neither_its_file_nor_its_description(experiment, tmp_path):
    path = tmp_path / "plan.mcap"
    experiment.design().save(path)
    plan = frfid.Plan.load(path)
    for place in (plan.save, lambda path, **how: plan.export(path, campaign=True, **how)):
        with pytest.raises((FileExistsError, ValueError)):
            place(path, overwrite=True)
    with pytest.raises(FileExistsError, match="is what is read"):
        experiment.design().save(tmp_path / "experiment.toml", overwrite=True)
    assert [run.reference.tobytes() for run in frfid.Plan.load(path)] == [run.reference.tobytes() for run in experiment.design()]


LOADERS = {
    "load": frfid.load,
    "read": frfid.read,
    "read with a map": lambda path: frfid.read(path, map={"u": [{"source": "u", "unit": "N m"}], "y": [{"source": "y", "unit": "rad/s"}]}),
    "inspect": frfid.inspect,
    "estimate_logs": frfid.estimate_logs,
    "estimate_logs of several": lambda path: frfid.estimate_logs([path]),
    "Record.load": frfid.Record.load,
    "Plan.load": frfid.Plan.load,
    "Experiment.load": frfid.Experiment.load,
    "Plant.load": frfid.Plant.load,
    "map of a log": lambda path: frfid.read(__file__, map=path),
    "map of logs": lambda path: frfid.estimate_logs(__file__, map=path),
}


@pytest.mark.parametrize("loader", LOADERS)
def test_a_missing_file_is_named_with_its_number(loader, tmp_path):
    path = tmp_path / "nowhere" / "missing.toml"
    with pytest.raises(FileNotFoundError) as raised:
        LOADERS[loader](path)
    assert (os.fspath(raised.value.filename), raised.value.errno) == (str(path), errno.ENOENT)


def test_missing_recordings_of_a_plan_and_folders_to_write_into_are_named(experiment, tmp_path):
    path = tmp_path / "nowhere" / "missing.mcap"
    plan, signals = experiment.design(), {"u": [{"source": "u", "unit": "N m"}], "y": [{"source": "y", "unit": "rad/s"}]}
    with pytest.raises(FileNotFoundError) as raised:
        plan.import_recordings(path, signals, tmp_path / "runs")
    assert (os.fspath(raised.value.filename), raised.value.errno) == (str(path), errno.ENOENT)
    for write in (plan.save, JOINT.frf([1.0], sample_time_s=T).save, JOINT.simulate(np.ones((1, 9)), sample_time_s=T).save):
        with pytest.raises(FileNotFoundError) as raised:
            write(path)
        assert raised.value.errno == errno.ENOENT and str(raised.value.filename).startswith(str(path.parent))
