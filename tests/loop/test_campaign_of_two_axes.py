"""A campaign of two axes from its description to a result, played by a command or by hand: both are the same."""

import pathlib
import shutil

import numpy as np
import pytest
from workshop import MARKS, done, fill, frfid, player

import frfid as library

pytestmark = MARKS
PLAYED = "run plan.mcap -o logs --map map.toml --player"


@pytest.fixture(scope="module")
def campaign(tmp_path_factory):
    """Designed, played and estimated by commands alone."""
    folder = fill(tmp_path_factory.mktemp("campaign"))
    done(folder, "design multisine.toml -o plan.mcap")
    done(folder, PLAYED, player())
    done(folder, "estimate logs -o frf.json --report report.html")
    return folder


def response(folder, name):
    return library.load(folder / name).response


def recordings(folder):
    return sorted((folder / "logs" / "player" / "recordings").glob("*.csv"))


def test_it_meets_the_arm(campaign):
    measured = library.load(campaign / "frf.json")
    arm = library.Plant.load(str(campaign / "small_arm.toml"))
    true = arm.frf(measured.frequency_hz, sample_time_s=0.002).response
    worst = np.abs(20 * np.log10(np.abs(measured.response / true)))[:, [0, 1], [0, 1]].max(axis=0)
    print(f"worst line: {worst} dB")
    assert worst.max() < 0.1
    assert "<html" in (campaign / "report.html").read_text()


def test_references_and_recordings_stay(campaign):
    runs = [f"p00{p}-m{m}-q0.csv" for p in range(2) for m in range(2)]
    for kind in ("references", "recordings"):
        assert sorted(path.name for path in (campaign / "logs" / "player" / kind).iterdir()) == runs


def test_the_same_command_has_nothing_left_to_play(campaign, tmp_path):
    told = done(campaign, PLAYED, player("--calls", str(tmp_path / "calls")))
    assert (told["written"], told["n_skipped"]) == ([], 4)
    assert not (tmp_path / "calls").exists()


@pytest.mark.parametrize("rate", ["250", "1000"])
def test_a_player_of_another_rate_leads_to_the_same(campaign, tmp_path, rate):
    shutil.copy(campaign / "small_arm.toml", tmp_path)
    done(campaign, f"run plan.mcap --map map.toml --rate {rate} -o", tmp_path / "logs", "--player", player())
    done(campaign, "estimate", tmp_path / "logs", "-o", tmp_path / "frf.json")
    expected = response(campaign, "frf.json")
    off = np.linalg.norm(response(tmp_path, "frf.json") - expected) / np.linalg.norm(expected)
    print(f"at {rate} Hz: {off:.1e}")
    assert off < 1e-3


def by_hand(campaign, tmp_path):
    """Recordings of the exported plan, as if somebody had played it file by file."""
    done(campaign, "export plan.mcap --to csv -o", tmp_path / "played")
    for path in sorted((tmp_path / "played").glob("p*-q0.csv")):
        twin = campaign / "logs" / "player" / "references" / path.name
        assert np.array_equal(table(path), table(twin)), "a run of an export is the run that a player is given"
    return recordings(campaign)


def table(path):
    return np.genfromtxt(path, delimiter=",", skip_header=1)


def test_recordings_in_disorder_are_told_apart(campaign, tmp_path):
    folder = tmp_path / "measured"
    folder.mkdir()
    for place, path in enumerate(reversed(by_hand(campaign, tmp_path))):
        shutil.copy(path, folder / f"recording {place}.csv")
    told = done(campaign, "import", folder, "--plan", "plan.mcap", "--map", "map.toml", "-o", tmp_path / "logs")
    assert sorted(run["run"] for run in told["imported"]) == [path.name.split(".")[0] for path in recordings(campaign)]
    same_as_by_command(campaign, tmp_path)


def same_as_by_command(campaign, tmp_path):
    done(campaign, "estimate", tmp_path / "logs", "-o", tmp_path / "frf.json")
    expected = response(campaign, "frf.json")
    off = np.linalg.norm(response(tmp_path, "frf.json") - expected) / np.linalg.norm(expected)
    print(f"imported: {off:.1e}")
    assert off < 1e-5


def test_one_recording_of_all_runs_is_cut(campaign, tmp_path):
    one = tmp_path / "all.csv"
    one.write_text(joined(recordings(campaign)))
    told = done(campaign, "import", one, "--plan", "plan.mcap", "--map", "map.toml", "-o", tmp_path / "logs")
    assert [run["run"] for run in told["imported"]] == [path.name.split(".")[0] for path in recordings(campaign)]
    assert all(abs(run["clock_ppm"] - 80.0) < 1.0 for run in told["imported"])
    same_as_by_command(campaign, tmp_path)


def joined(paths, rest_s=1.7):
    """The rows of several recordings by one clock, with time between them."""
    lines, end_s = [], 0.0
    for path in paths:
        header, *rows = pathlib.Path(path).read_text().splitlines()
        begin_s = float(rows[0].split(",")[0])
        lines += [header] if not lines else []
        moved = [row.split(",", 1) for row in rows]
        lines += [f"{float(time) - begin_s + end_s:.12g},{rest}" for time, rest in moved]
        end_s = float(lines[-1].split(",")[0]) + rest_s
    return "\n".join(lines) + "\n"


def test_what_is_there_already_is_not_imported_again(campaign, tmp_path):
    line = ["import", *recordings(campaign)[:2], "--plan", "plan.mcap", "--map", "map.toml", "-o", tmp_path / "logs"]
    told = done(campaign, *line, code=3)
    assert (len(told["imported"]), told["missing"]) == (2, ["p001-m0-q0", "p001-m1-q0"])
    line[1:3] = recordings(campaign)
    told = done(campaign, *line)
    assert (len(told["imported"]), told["n_skipped"], told["missing"]) == (2, 2, [])
    same_as_by_command(campaign, tmp_path)


def test_a_description_is_as_good_as_its_plan(campaign, tmp_path):
    output = frfid(campaign, "import --plan multisine.toml --map map.toml -o", tmp_path / "logs", *recordings(campaign))
    assert output.returncode == 0, output.stderr
    same_as_by_command(campaign, tmp_path)
