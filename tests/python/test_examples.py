"""Every lesson runs, prints its numbers and draws its picture."""

import pathlib
import subprocess
import sys
import xml.etree.ElementTree

import pytest

SVG = "{http://www.w3.org/2000/svg}"
LESSONS = sorted((pathlib.Path(__file__).parents[2] / "examples").glob("*.py"))


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda path: path.stem)
def test_the_lesson_runs(lesson, tmp_path):
    pytest.importorskip("matplotlib", reason="the lessons draw with matplotlib: pip install frfid[plot]")
    if lesson.stem == "10_foreign_simulator":
        pytest.importorskip("mujoco", reason="lesson 10 needs MuJoCo: pip install mujoco")
    told = subprocess.run([sys.executable, "-W", "error", lesson], capture_output=True, text=True, timeout=120, cwd=tmp_path)
    assert (told.returncode, told.stderr) == (0, "")
    assert SAYS[lesson.stem] in told.stdout
    assert [path.name for path in tmp_path.iterdir()] == [f"{lesson.stem}.svg"]
    assert told.stdout.splitlines()[-1].startswith(f"{lesson.stem}.svg: ")
    picture = xml.etree.ElementTree.parse(tmp_path / f"{lesson.stem}.svg").getroot()
    assert picture.tag == f"{SVG}svg" and len(list(picture.iter(f"{SVG}path"))) > 10


SAYS = {
    "01_excitations": "71 lines",
    "02_friction": "chirp: the peak at the resonance lies 4.8 dB below the truth",
    "03_constant_velocity": "the joint sticks",
    "04_stiffness": "stiffness grows with deflection",
    "05_uncertainty": "with one period the noise variance is None",
    "06_closed_loop": "mean of FRFs: median error 72.9 %",
    "07_own_testbed": "to the last bit: True",
    "08_arm": "lag by 10.8 deg at 60 Hz",
    "09_shaping": "axis 2 sticks",
    "10_foreign_simulator": "median error 0.0",
}
