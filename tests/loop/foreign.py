"""Foreign arms: MuJoCo's r3 and six axes behind a player that is no friend, their log maps and the truth about them."""

import pathlib
import shlex
import sys

import numpy as np

ROOT = pathlib.Path(__file__).parents[2]
PLAYERS = ROOT / "examples" / "players"
sys.path.insert(0, str(PLAYERS))

HOSTILE = "--rate-hz 800 --clock-ppm 137 --offset-s 5.2 --degrees --motor-side --flip joint_2 --low-pass-hz 100 --drop 0.01 --double 0.01"
# joint over motor, with the axis that counts the other way round
SCALE = np.array([-105.0, -210.0, 60.0])
SCALE_OF_SIX = np.array([-105.0, -210.0, 60.0, 100.0, 80.0, 100.0])


def player(*options, folder=None):
    """The command of the player; with a folder it writes what its controller saw there, a file for each run."""
    command = shlex.join([sys.executable, str(PLAYERS / "mujoco_player.py"), *shlex.split(HOSTILE), *options])
    return f"{command} --ideal {shlex.quote(str(folder))}/$FRFID_RUN.npz" if folder else command


def log_map(scale=SCALE):
    """Which column is which, told as a user would: motor side, degrees, ms."""
    entry = '{{ source = "A{}.{}", unit = "{}", scale = {} }}'
    lines = []
    for role, name, unit, factors in [
        ("u", "ActTrq", "N m", scale),
        ("y", "ActVel", "deg/s", 1 / scale),
        ("r", "SetVel", "deg/s", 1 / scale),
        ("position", "ActPos", "deg", 1 / scale),
    ]:
        entries = (entry.format(axis, name, unit, factor) for axis, factor in enumerate(factors, 1))
        lines.append(f"{role} = [{', '.join(entries)}]")
    return "\n".join([*lines, 'time = { source = "t_ms", unit = "ms" }', ""])


def robot(experiment, **options):
    from mujoco_robot import Robot

    return Robot.of_experiment(experiment, **options)


def off_db(response, truth):
    """Deviation of the magnitude of the diagonal entries in dB, (frequency, axis)."""
    axes = range(response.shape[1])
    return np.abs(20 * np.log10(np.abs(response / truth)))[:, axes, axes]


def changed(text, **values):
    """A description with other values of keys that stand in it once."""
    lines = text.splitlines()
    for key, value in values.items():
        [place] = [k for k, line in enumerate(lines) if line.startswith(f"{key} =")]
        lines[place] = f"{key} = {value}"
    return "\n".join(lines) + "\n"
