"""A folder with two axes on the bench: description, map and player for tests of the loop, and the command line in it."""

import json
import pathlib
import shlex
import shutil
import subprocess
import sys

import pytest
import small_player

FRFID = shutil.which("frfid")
MARKS = [pytest.mark.skipif(FRFID is None, reason="needs the command frfid: pip install .")]
HERE = pathlib.Path(__file__).parent
ROOT = HERE.parents[1]

COMMON = """
seed = 1
sample_time_s = 0.002

[robot]
file = "small_arm.toml"

[controller]
gain_nms_per_rad = [600.0, 300.0]
integral_gain_nm_per_rad = [4800.0, 2400.0]

[limits]
max_velocity = [0.5, 0.5]
max_travel = [0.1, 0.1]
"""
MULTISINE = """
[multisine]
low_hz = 2.0
high_hz = 40.0
resolution_hz = 1.0
peak_rad_s = [0.1, 0.1]

[averaging]
realizations = 2
periods = 3
"""
CHIRP = """
[chirp]
low_hz = 4.0
high_hz = 40.0
duration_s = 4.0
amplitude_rad_s = [0.05, 0.05]
fade_s = 0.05
tail_s = 0.5
mimo = "sign-flip"

[shape]
desired_nm = [60.0, 30.0]
n_iterations = 3

[averaging]
lead_in_s = 0.5
"""


def fill(folder):
    """The files of a campaign and of a shaping."""
    shutil.copy(HERE / "small_arm.toml", folder)
    (folder / "multisine.toml").write_text(COMMON + MULTISINE)
    (folder / "chirp.toml").write_text(COMMON + CHIRP)
    (folder / "map.toml").write_text(small_player.MAP)
    return folder


def frfid(folder, line, *more):
    """A command, as typed in a folder."""
    command = [FRFID, *shlex.split(line), *(str(argument) for argument in more)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300)


def done(folder, line, *more, code=0):
    """What a command prints as JSON; it must end with this exit code."""
    output = frfid(folder, line, *more, "--json", "--quiet")
    assert output.returncode == code, f"{line}: exit code {output.returncode}\n{output.stdout[-2000:]}{output.stderr}"
    return json.loads(output.stdout)


def player(*options):
    """The command of the small player."""
    return shlex.join([sys.executable, small_player.__file__, *options])


def refused(folder, line, *more, code):
    """What a command says that ends with an exit code other than 0."""
    output = frfid(folder, line, *more)
    assert output.returncode == code, f"{line}: exit code {output.returncode}\n{output.stdout[-2000:]}{output.stderr}"
    assert "os error" not in output.stderr and "panicked" not in output.stderr
    return output.stderr
