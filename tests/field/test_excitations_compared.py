"""Multisine against shaped chirp, the comparison of the paper, on the shipped arms: no stiffness where they are linear, found where a gear stiffens."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

FRFID = shutil.which("frfid")
EXAMPLES = Path(__file__).parents[2] / "examples"
CHALLENGES = ["gear_load_limit", "coulomb_friction", "stiffening", "position_dependence", "torque_ripple", "sensing", "gravity"]


def frfid(folder, *arguments):
    done = subprocess.run([FRFID, *map(str, arguments), "--quiet"], cwd=folder, capture_output=True, text=True)
    assert done.returncode in (0, 3), done.stderr  # a shaping may end above its aim
    return done.stdout


def linear(name, folder, posed=()):
    """A description of the examples with all challenges off but those named, fewer runs, and its robot beside it."""
    text = (EXAMPLES / "experiments" / f"{name}.toml").read_text().replace("../robots/", "")
    switches = "\n".join(f"{key} = {str(key in posed).lower()}" for key in CHALLENGES)
    text = re.sub(r"\n\[(controller|multisine|chirp)\]", rf"\n[robot.challenges]\n{switches}\n\n[\1]", text, count=1)
    for key, value in [("realizations", 2), ("repetitions", 2), ("resolution_hz", 0.25), ("glides", 2)]:
        text = re.sub(rf"^{key} = \S+", f"{key} = {value}", text, flags=re.MULTILINE)
    (folder / f"{name}.toml").write_text(text)


def verdict(folder, arm, posed=()):
    for file in (EXAMPLES / "robots").iterdir():
        if not (folder / file.name).exists():
            shutil.copy(file, folder)
    for kind in ("multisine", "chirp"):
        linear(f"{arm}_{kind}", folder, posed)
    frfid(folder, "design", f"{arm}_multisine.toml", "-o", "plan.mcap")
    frfid(folder, "run", "plan.mcap", "-o", "logs")
    frfid(folder, "estimate", "logs", "-o", "multisine.json")
    frfid(folder, "shape", f"{arm}_chirp.toml", "-o", "shaped")
    return json.loads(frfid(folder, "compare", "multisine.json", "shaped/frf.json", "--json"))["verdict"]


pytestmark = pytest.mark.skipif(FRFID is None, reason="needs the command frfid: pip install .")


@pytest.mark.parametrize("arm", ["r3", "six_axis"])
def test_a_linear_arm_has_no_verdict_on_its_stiffness(arm, tmp_path):
    assert "stiffness" not in str(verdict(tmp_path, arm))


def test_gears_that_stiffen_are_found(tmp_path):
    robot = (EXAMPLES / "robots" / "manutec_r3.toml").read_text()
    beyond = lambda found: f"{found[0]}\nstiffness_beyond_nm_per_rad = {1.7 * float(found[1])}\nknee_rad = 2e-4"
    (tmp_path / "manutec_r3.toml").write_text(re.sub(r"stiffness_nm_per_rad = (\S+)", beyond, robot))
    assert verdict(tmp_path, "r3", ["stiffening"]).startswith("stiffness grows with deflection")
