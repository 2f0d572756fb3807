"""Recordings with a fault, given to frfid import: what is refused, what is named, what is used all the same."""

import shlex
import shutil
import subprocess

import pytest
from workshop import MARKS, ROOT, done, fill, frfid, player, refused

pytestmark = MARKS
RUNS = ["p000-m0-q0", "p000-m1-q0", "p001-m0-q0", "p001-m1-q0"]
IMPORT = "import measured --plan multisine.toml --map map.toml -o imported"


@pytest.fixture(scope="module")
def played(tmp_path_factory):
    """A campaign that was played as it should be."""
    folder = fill(tmp_path_factory.mktemp("played"))
    done(folder, "run multisine.toml -o logs --map map.toml --player", player())
    return folder


@pytest.fixture
def folder(played, tmp_path):
    """The same with its recordings in a folder of their own, ready to be spoilt."""
    fill(tmp_path)
    (tmp_path / "measured").mkdir()
    for run in RUNS:
        shutil.copy(played / "logs" / "player" / "recordings" / f"{run}.csv", tmp_path / "measured" / f"{run}.csv")
    shutil.copytree(played / "logs", tmp_path / "logs")
    return tmp_path


def spoil(folder, run, fault):
    """A run played again by a player with a fault."""
    reference = folder / "logs" / "player" / "references" / f"{run}.csv"
    subprocess.run([*shlex.split(player("--fault", fault)), reference, folder / "measured" / f"{run}.csv"], check=True)


def test_a_missing_run_is_named(folder):
    (folder / "measured" / f"{RUNS[2]}.csv").unlink()
    told = done(folder, IMPORT, code=3)
    assert (told["missing"], len(told["imported"])) == ([RUNS[2]], 3)
    (folder / "imported" / f"{RUNS[1]}.mcap").unlink()
    assert f"in none of the recordings: {RUNS[2]}" in frfid(folder, IMPORT).stderr


def test_a_run_too_many_is_named(folder):
    shutil.copy(folder / "measured" / f"{RUNS[1]}.csv", folder / "measured" / "zz.csv")
    told = done(folder, IMPORT, code=3)
    assert (told["missing"], len(told["imported"])) == ([], 4)
    [unused] = told["unused"]
    assert unused.startswith("measured/zz.csv: at ") and f"{RUNS[1]} once more than the plan repeats it" in unused


def test_a_run_that_was_stopped_is_named_with_its_time(folder):
    spoil(folder, RUNS[3], "stops")
    told = done(folder, IMPORT, code=3)
    stopped = {run["run"]: run["stopped_s"] for run in told["imported"]}
    assert [run for run, at in stopped.items() if at is not None] == [RUNS[3]]
    assert stopped[RUNS[3]] == pytest.approx(0.6 * 6.098 - 1.0, abs=0.3), "0.6 of the way, which begins 1 s before the run"
    said = frfid(folder, IMPORT + " --force").stderr
    assert RUNS[3] in said and "stopped" in said, said


def test_a_recording_that_ends_too_early_is_named(folder):
    spoil(folder, RUNS[3], "half")
    told = done(folder, IMPORT, code=3)
    [half] = [run for run in told["imported"] if run["stopped_s"] is not None]
    assert half["run"] == RUNS[3] and half["stopped_s"] == pytest.approx(2.0, abs=0.3)


def test_samples_without_a_value_are_counted(folder):
    spoil(folder, RUNS[1], "nan")
    told = done(folder, IMPORT, code=3)
    lost = {run["run"]: run["n_lost"] for run in told["imported"]}
    assert lost[RUNS[1]] == pytest.approx(1000, abs=100) and sum(lost.values()) == lost[RUNS[1]]


def test_degrees_taken_for_radians_are_told(folder):
    for run in RUNS:
        spoil(folder, run, "degrees")
    said = refused(folder, IMPORT, code=2)
    assert "57.3 times that of the plan on shoulder" in said and "unit" in said, said


@pytest.mark.parametrize("fault, joint, found", [("swaps", "shoulder", "0.5999"), ("flips", "elbow", "-0.5995")])
def test_joints_that_are_swapped_or_turned_are_told_by_their_positions(folder, fault, joint, found):
    for run in RUNS:
        spoil(folder, run, fault)
    output = frfid(folder, IMPORT)
    assert output.returncode == 3
    said = f"position of the recording: found {joint} at {found} rad where run p000-m0-q0 begins"
    assert said in output.stderr and "see joint, sign, unit and zero of position" in output.stderr, output.stderr


def test_recordings_of_another_plan_are_told(folder):
    (folder / "other.toml").write_text((folder / "multisine.toml").read_text().replace("seed = 1", "seed = 2"))
    said = refused(folder, IMPORT.replace("multisine.toml", "other.toml"), code=2)
    assert "runs of the plan in the recordings: found" in said and "another plan" in said, said


def test_the_plan_of_another_robot_is_told(folder):
    six = ROOT / "examples" / "experiments" / "six_axis_multisine.toml"
    said = refused(folder, f"import measured --plan {six} --map map.toml -o imported", code=2)
    assert "found 2 inputs and 2 outputs, needed 6 of each" in said and "in the order of the plan's joints" in said, said


def test_a_folder_of_a_player_is_taken_as_it_is(folder):
    told = done(folder, "import logs/player/recordings --plan multisine.toml --map map.toml -o imported")
    assert ([run["run"] for run in told["imported"]], told["unused"]) == (RUNS, [])


def test_a_slower_clock_is_no_other_plan_but_a_speed_slider_is(folder):
    for run in RUNS:
        path = folder / "measured" / f"{run}.csv"
        header, *rows = path.read_text().splitlines()
        slow = [f"{2 * float(row.split(',')[0]):.9f},{row.split(',', 1)[1]}" for row in rows]
        path.write_text("\n".join([header, *slow]) + "\n")
    assert "speed slider below 100 %" in refused(folder, IMPORT, code=2)


def test_without_a_map_it_is_said_how_to_get_one(folder):
    said = refused(folder, IMPORT.replace(" --map map.toml", ""), code=2)
    assert "frfid init map RECORDING guesses one" in said
