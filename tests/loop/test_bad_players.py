"""Players and recordings with a fault: exit code, what was found and needed and what to do, and that the next run is not sent."""

import os
import signal
import subprocess
import time

import pytest
from workshop import FRFID, MARKS, done, fill, frfid, player, refused

pytestmark = MARKS
FAULTY = "p000-m1-q0"
NOT_SENT = "the next run is not sent; once the cause is removed, the same command goes on from here"
RECORDING = f"logs/player/recordings/{FAULTY}.csv"
RUN = "run multisine.toml -o logs --map map.toml --player"


@pytest.fixture
def folder(tmp_path):
    return fill(tmp_path)


def faulty(fault):
    return player("--calls", "calls", "--fault-run", FAULTY, "--fault", fault)


def sent(folder):
    return (folder / "calls").read_text().split()


@pytest.mark.parametrize(
    "fault, told",
    [
        ("fails", ["player: found exit status: 7", "needed exit code 0", NOT_SENT]),
        ("dies", ["player: found exit status: 137", "needed exit code 0", NOT_SENT]),
        ("nothing", [f"recording of the player: found none at {RECORDING}", "needed one at the path", NOT_SENT]),
        ("flips", [f"nothing like {FAULTY} in {RECORDING}", "a sign"]),
        ("degrees", ["found 57.3 times that of the plan on shoulder", "see unit, sign and gear ratio"]),
        ("swaps", ["found shoulder at 0.5980 rad", "needed 0.3000 rad, within 0.05", "see joint, sign, unit and zero"]),
        ("nan", ["found 1022 of 2048 samples of y of elbow without a value", "see whether the sensor or the recorder failed"]),
    ],
)
def test_a_faulty_player_ends_the_campaign(folder, fault, told):
    said = refused(folder, RUN, faulty(fault), code=1)
    for part in [f"error: run {FAULTY}: ", *told]:
        assert part in said, f"{part} is not said in\n{said}"
    assert sent(folder) == ["p000-m0-q0", FAULTY]


@pytest.mark.parametrize("fault, at_s", [("half", "2.000"), ("stops", "2.500")])
def test_a_run_that_was_stopped_is_kept_and_the_next_one_not_sent(folder, fault, at_s):
    said = refused(folder, RUN, faulty(fault), code=1)
    assert f"error: run p001-m0-q0: not sent to the machine: run {FAULTY} was stopped at {at_s} s; find out why" in said, said
    assert sent(folder) == ["p000-m0-q0", FAULTY]
    assert f"{FAULTY} was stopped" in refused(folder, RUN, player("--calls", "calls"), code=1), "the same command asks again"
    assert len(sent(folder)) == 2
    (folder / "logs" / f"{FAULTY}.mcap").unlink()
    assert len(done(folder, RUN, player())["written"]) == 3


def test_once_it_is_mended_the_same_command_goes_on(folder):
    refused(folder, RUN, faulty("fails"), code=1)
    told = done(folder, RUN, player("--calls", "calls"))
    assert (len(told["written"]), told["n_skipped"]) == (3, 1)
    assert sent(folder) == ["p000-m0-q0", FAULTY, FAULTY, "p001-m0-q0", "p001-m1-q0"]


def alive(marker):
    """Processes whose environment holds a marker."""
    found = []
    for process in os.listdir("/proc"):
        try:
            environment = open(f"/proc/{process}/environ", "rb").read() if process.isdigit() else b""
        except OSError:
            continue
        found += [int(process)] if marker.encode() in environment else []
    return found


def test_a_player_that_hangs_is_stopped(folder, monkeypatch):
    monkeypatch.setenv("MARKER", str(folder))
    said = refused(folder, f"{RUN}", faulty("hangs"), "--player-timeout", "3", code=1)
    for part in ("still at it after 3 s, stopped", "--player-timeout", NOT_SENT):
        assert part in said, said
    left = alive(f"MARKER={folder}")
    for process in set(left) - {os.getpid()}:
        os.kill(process, signal.SIGKILL)
    assert set(left) <= {os.getpid()}, "it moves on"


def playing(folder, fault):
    """A campaign whose player has just been called."""
    command = [FRFID, "run", "multisine.toml", "-o", "logs", "--map", "map.toml", "--player", player("--calls", "calls", "--fault", fault)]
    process = subprocess.Popen(command, cwd=folder, start_new_session=True, stderr=subprocess.PIPE, text=True)
    while not (folder / "calls").exists():
        time.sleep(0.05)
    return process


def test_ctrl_c_lets_the_run_end(folder):
    campaign = playing(folder, "slow")
    os.killpg(campaign.pid, signal.SIGINT)  # as a terminal sends it, to all in the foreground
    _, said = campaign.communicate(timeout=60)
    assert campaign.returncode == 130, said
    assert (folder / "logs" / "p000-m0-q0.mcap").exists() and len(sent(folder)) == 1, said


def test_ctrl_c_twice_ends_the_player(folder, monkeypatch):
    monkeypatch.setenv("MARKER", str(folder))
    campaign = playing(folder, "hangs")
    for _ in range(2):
        os.killpg(campaign.pid, signal.SIGINT)
        time.sleep(0.3)
    campaign.wait(timeout=20)
    left = set(alive(f"MARKER={folder}")) - {os.getpid()}
    for process in left:
        os.kill(process, signal.SIGKILL)
    assert campaign.returncode == 130 and not left


@pytest.mark.parametrize("is_killed", [False, True], ids=["both at work", "the first was killed"])
def test_two_at_once_do_not_both_move_the_machine(folder, is_killed):
    first = playing(folder, "slow")
    if is_killed:
        first.kill()
    output = frfid(folder, RUN, faulty("slow"))
    first.communicate(timeout=60)
    assert output.returncode == 1 and "still at work" in output.stderr, output.stderr
    assert sent(folder).count("p000-m0-q0") == 1


@pytest.mark.parametrize("option", ["--map map.toml", "--map none.toml", "--map map.toml --rate 250"])
def test_what_is_said_of_a_machine_needs_its_player(folder, option):
    assert "--player" in refused(folder, f"run multisine.toml -o logs {option}", code=2)


def test_a_map_that_does_not_fit_is_told_before_anything_moves(folder):
    text = (folder / "map.toml").read_text()
    (folder / "one_joint.toml").write_text(text.replace('{ source = "shoulder.torque", unit = "N m" }, ', ""))
    said = refused(folder, "run multisine.toml -o logs --map one_joint.toml --player", player("--calls", "calls"), code=2)
    assert "found 1 input" in said and "needed 2" in said and "name one u and one y for each joint" in said, said
    assert not (folder / "calls").exists()


def test_position_is_needed_where_ripple_is_taken_off_by_it(folder):
    text = (folder / "multisine.toml").read_text().replace("peak_rad_s = [0.1, 0.1]", "peak_of_velocity = 0.5")
    text += '\n[constant_velocity]\ntravel_rad = [0.1, 0.1]\nglides = 1\n\n[estimate]\nglide_subtraction = "position"\n'
    (folder / "ripple.toml").write_text(text.replace("periods = 3", "repetitions = 1"))
    lines = (folder / "map.toml").read_text().splitlines()
    (folder / "without.toml").write_text("\n".join(line for line in lines if not line.startswith("position")))
    for line in ("run ripple.toml -o logs --map without.toml --player", "import map.toml --plan ripple.toml --map without.toml -o logs"):
        said = refused(folder, line, *([player("--calls", "calls")] if "--player" in line else []), code=2)
        assert "found no position, needed one for each joint" in said or line.startswith("import"), said
    assert not (folder / "calls").exists()
