"""`run_experiment`: a run by its number, whoever asks for it, in whatever order: the files are those of one command."""

import multiprocessing
import pathlib
import subprocess
import sys

import frfid
import pytest

EXAMPLES = pathlib.Path(__file__).parents[2] / "examples" / "jobs"
DESCRIPTION = """seed = 5
sample_time_s = 0.002

[robot.single_joint]
motor_inertia_kg_m2 = 35.0
link_inertia_kg_m2 = 150.0
damping_nms_per_rad = 400.0
stiffness_nm_per_rad = 1.5e5
coulomb_nm = 50.0

[robot.sensor]
velocity_noise_rad_s = 1e-4

[multisine]
low_hz = 2.0
high_hz = 60.0
resolution_hz = 1.0
peak_nm = [150.0]

[averaging]
realizations = 3
periods = 2
"""


@pytest.fixture
def plan(tmp_path):
    path = tmp_path / "plan.mcap"
    frfid.Experiment.from_toml(DESCRIPTION).design().save(path)
    return path


@pytest.fixture
def expected(plan, tmp_path):
    """The logs of all runs in one go."""
    frfid.Plan.load(plan).run(folder=tmp_path / "whole")
    return logs(tmp_path / "whole")


def logs(folder):
    return {path.name: path.read_bytes() for path in pathlib.Path(folder).glob("*.mcap")}


def test_runs_one_by_one_in_any_order_and_again_are_those_of_one_command(plan, expected, tmp_path):
    names = [pathlib.Path(frfid.run_experiment(plan, index, tmp_path / "logs")).name for index in (2, 0, 1)]
    assert sorted(names) == sorted(expected)
    stamps = {name: (tmp_path / "logs" / name).stat().st_mtime_ns for name in names}
    for index in range(3):
        frfid.run_experiment(str(plan), index, str(tmp_path / "logs"))
    assert logs(tmp_path / "logs") == expected
    assert {name: (tmp_path / "logs" / name).stat().st_mtime_ns for name in names} == stamps


@pytest.mark.parametrize("method", ["spawn", "fork"])
def test_processes_do_them_side_by_side(method, plan, expected, tmp_path):
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"no {method} here")
    with multiprocessing.get_context(method).Pool(3) as pool:
        pool.starmap(frfid.run_experiment, [(str(plan), index, str(tmp_path / "logs")) for index in range(3)])
    assert logs(tmp_path / "logs") == expected


@pytest.mark.parametrize(("example", "package"), [("with_joblib", "joblib"), ("with_dask", "distributed")])
def test_schedulers_do_them_as_their_examples_say(example, package, plan, expected, tmp_path):
    pytest.importorskip(package, reason=f"the example needs {package}")
    said = subprocess.run(
        [sys.executable, EXAMPLES / f"{example}.py", plan, tmp_path / "logs"], capture_output=True, text=True, timeout=120, cwd=tmp_path
    )
    assert said.returncode == 0, said.stderr
    assert "3 runs, " in said.stdout
    assert logs(tmp_path / "logs") == expected


def test_what_is_no_run_of_a_plan_is_refused(plan, tmp_path):
    with pytest.raises(IndexError, match="index is 3, the plan has 3 runs"):
        frfid.run_experiment(plan, 3, tmp_path / "logs")
    with pytest.raises(OverflowError):
        frfid.run_experiment(plan, -1, tmp_path / "logs")
    with pytest.raises(FileNotFoundError):
        frfid.run_experiment(tmp_path / "none.mcap", 0, tmp_path / "logs")
    (tmp_path / "broken.mcap").write_bytes(plan.read_bytes()[:-30])
    with pytest.raises((ValueError, OSError)):
        frfid.run_experiment(tmp_path / "broken.mcap", 0, tmp_path / "logs")
