"""A shaping that is killed at any moment, or done by files call by call, ends with the bytes of one in peace."""

import hashlib
import json
import os
import random
import shlex
import shutil
import signal
import subprocess
import time

import pytest
from workshop import FRFID, MARKS, done, fill, frfid, player

pytestmark = MARKS
SHAPE = "shape chirp.toml -o shaped --map map.toml"


@pytest.fixture(scope="module")
def peaceful(tmp_path_factory):
    """The folder of a shaping in peace, its time in s, and what its files hold."""
    folder = fill(tmp_path_factory.mktemp("peaceful"))
    begin = time.monotonic()
    output = frfid(folder, SHAPE, "--player", player("--calls", "calls"))
    assert output.returncode in (0, 3), output.stderr
    assert len((folder / "calls").read_text().split()) == 6, "three iterations of two runs"
    return folder, time.monotonic() - begin, contents(folder / "shaped")


def contents(folder):
    """Every file of a shaping, without what was told to the machine and came back."""
    files = [path for path in folder.rglob("*") if path.is_file()]
    kept = {str(path.relative_to(folder)): path for path in files}
    ours = {name: path for name, path in kept.items() if name.split("/")[0] not in ("player", "references", "measured")}
    assert not [name for name in ours if name.endswith(".part")], sorted(ours)
    return {name: hashlib.sha256(path.read_bytes()).hexdigest() for name, path in ours.items()}


def same(found, expected):
    assert sorted(found) == sorted(expected)
    assert [name for name in found if found[name] != expected[name]] == []


def started(folder):
    command = [FRFID, *shlex.split(SHAPE), "--player", player()]
    silent = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    return subprocess.Popen(command, cwd=folder, start_new_session=True, **silent)


def players(folder):
    """The players whose references lie in a folder."""
    found = []
    for process in filter(str.isdigit, os.listdir("/proc")):
        try:
            where, command = os.readlink(f"/proc/{process}/cwd"), open(f"/proc/{process}/cmdline").read()
        except OSError:
            continue
        found += [int(process)] if where == str(folder) and "small_player" in command and FRFID not in command else []
    return found


def killed(process, folder, victim):
    """Kills frfid, its player, or both; a player that is left plays to its end, as one should let it."""
    victims = {"frfid": [process.pid], "player": players(folder), "both": [process.pid, *players(folder)]}[victim]
    for each in victims:
        try:
            os.kill(each, signal.SIGKILL)
        except ProcessLookupError:
            pass  # it was done
    process.wait(timeout=60)
    while players(folder):
        time.sleep(0.02)


@pytest.mark.parametrize("victim", ["frfid", "player", "both"])
def test_killed_at_any_moment(peaceful, tmp_path, victim):
    _, length_s, expected = peaceful
    folder, chance = fill(tmp_path), random.Random(victim)
    n_killed, code = 0, None
    for _ in range(8):
        process = started(folder)
        time.sleep(chance.uniform(0.02, 0.2 * length_s))
        n_killed += process.poll() is None
        killed(process, folder, victim)
    for _ in range(2):  # a player that was killed last may have left an error to be tried again
        code = frfid(folder, SHAPE, "--player", player()).returncode
    print(f"{victim}: killed {n_killed} times")
    assert n_killed >= 1 and code in (0, 3)  # how often it is caught depends on the machine
    same(contents(folder / "shaped"), expected)


def play(folder, told):
    """Plays what a call has written, into where it looks for recordings; the number of runs."""
    references = sorted((folder / told["references"]).glob("*.csv"))
    for place, reference in enumerate(reversed(references)):
        log = folder / told["recordings"] / f"{place} as the recorder likes it.csv"
        subprocess.run([*shlex.split(player()), reference, log], check=True)
    return len(references)


def test_by_files(peaceful, tmp_path):
    _, _, expected = peaceful
    folder, played = fill(tmp_path), 0
    told = done(folder, SHAPE)
    while "references" in told:
        again = done(folder, SHAPE)
        assert again == told, "nothing is new without recordings"
        played += play(folder, told)
        output = frfid(folder, SHAPE, "--json", "--quiet")
        assert output.returncode in (0, 3), output.stderr
        told = json.loads(output.stdout)
    assert played == 6 and told["shape"]["best"] == 3
    same(contents(folder / "shaped"), expected)


def test_by_files_it_says_what_to_play(tmp_path):
    folder = fill(tmp_path)
    output = frfid(folder, SHAPE)
    assert output.returncode == 0
    assert "to be played: the references in shaped/references/iteration_01" in output.stdout
    assert "into shaped/measured/iteration_01" in output.stdout and "then the same command again" in output.stdout


def test_by_files_a_wrong_recording_is_not_used(peaceful, tmp_path):
    other, _, _ = peaceful
    folder = fill(tmp_path)
    told = done(folder, SHAPE)
    for run in ("p002-m0-q0", "p003-m1-q0"):
        shutil.copy(other / "shaped" / "player" / "recordings" / f"{run}.csv", folder / told["recordings"])
    (folder / told["recordings"] / "cut.csv").write_text("t,shoulder.torque\n0,1\n")
    output = frfid(folder, SHAPE)
    assert output.returncode == 0 and output.stderr.count("not used: ") >= 3, output.stderr
    assert "iteration_01" in output.stdout and not list((folder / "shaped").rglob("*.mcap"))


def test_a_player_may_take_over_from_files(peaceful, tmp_path):
    _, _, expected = peaceful
    folder = fill(tmp_path)
    play(folder, done(folder, SHAPE))
    done(folder, SHAPE)
    assert frfid(folder, SHAPE, "--player", player()).returncode in (0, 3)
    same(contents(folder / "shaped"), expected)
