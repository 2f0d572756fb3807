"""Every lesson runs and prints its numbers."""

import pathlib
import subprocess
import sys

import pytest

LESSONS = sorted((pathlib.Path(__file__).parents[2] / "examples").glob("*.py"))


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda path: path.stem)
def test_the_lesson_runs(lesson, tmp_path):
    if lesson.stem == "10_foreign_simulator":
        pytest.importorskip("mujoco", reason="lesson 10 needs MuJoCo: pip install mujoco")
    told = subprocess.run([sys.executable, "-W", "error", lesson], capture_output=True, text=True, timeout=120, cwd=tmp_path)
    assert (told.returncode, told.stderr) == (0, "")
    assert SAYS[lesson.stem] in told.stdout


SAYS = {
    "01_excitations": "71 lines",
    "02_friction": "chirp: the peak at the resonance lies 4.8 dB below the truth",
    "03_constant_velocity": "the joint sticks",
    "04_stiffness": "stiffness grows with deflection",
    "05_uncertainty": "with one period the noise variance is None",
    "06_closed_loop": "indirect: median error",
    "07_own_testbed": "to the last bit: True",
    "08_arm": "lag by 10.8 deg at 60 Hz",
    "09_shaping": "axis 2 sticks",
    "10_foreign_simulator": "median error 0.0",
}
