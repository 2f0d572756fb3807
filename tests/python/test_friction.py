"""Coulomb friction taken off a chirp without a constant velocity: neither inertia, spring nor friction is told."""

import re
import shutil
import subprocess
from pathlib import Path

import frfid
import numpy as np
import pytest

EXAMPLES = Path(__file__).parents[2] / "examples/experiments"
FRFID = shutil.which("frfid")
FREE = ["--method", "local-rational", "--subtract-friction"]


def frfid_says(*arguments):
    done = subprocess.run([FRFID, *map(str, arguments)], capture_output=True, text=True, timeout=120)
    return done.returncode, done.stdout + done.stderr


def recorded(tmp_path, name, **changes):
    """The logs of a template."""
    text = (EXAMPLES / f"{name}.toml").read_text().replace("../robots", str(EXAMPLES.parent / "robots"))
    for old, new in changes.items():
        text = re.sub(rf"^{old} = .*", new, text, flags=re.MULTILINE)
    (tmp_path / "x.toml").write_text(text)
    frfid_says("design", tmp_path / "x.toml", "-o", tmp_path / "plan.mcap")
    frfid_says("run", tmp_path / "plan.mcap", "-o", tmp_path / "logs")
    return tmp_path / "logs"


def decibels(path):
    """Errors from 1.3 to 55 Hz against the joint without friction."""
    frf = frfid.load(path)
    hz = np.asarray(frf.frequency_hz)
    truth = np.asarray(frfid.Plant.single_joint(coulomb_nm=0.0).frf(hz, sample_time_s=0.001).response)[:, 0, 0]
    inside = (hz > 1.3) & (hz < 55)
    return np.abs(20 * np.log10(np.abs(np.asarray(frf.response)[:, 0, 0] / truth)))[inside]


NOISE_RAD_S = 3.8e-4  # 1 % of the velocity's rms


@pytest.mark.parametrize("noise_rad_s", [0.0, NOISE_RAD_S])
def test_a_chirp_with_friction_is_right_without_a_constant_velocity(tmp_path, noise_rad_s):
    robot = (EXAMPLES.parent / "robots/paper_joint.toml").read_text()
    (tmp_path / "robot.toml").write_text(f"{robot}\n[sensor]\nvelocity_noise_rad_s = {noise_rad_s}\n" if noise_rad_s else robot)
    logs = recorded(tmp_path, "chirp", amplitude_nm="amplitude_nm = [150.0]\ntail_s = 2.0", file='file = "robot.toml"')
    with_friction, without = tmp_path / "with.json", tmp_path / "without.json"
    assert "friction of" not in frfid_says("estimate", logs, "-o", with_friction)[1]
    code, said = frfid_says("estimate", logs, "-o", without, *FREE)
    before, after = decibels(with_friction), decibels(without)
    print(f"with friction {np.median(before):.2f}, {before.max():.2f} dB, without {np.median(after):.3f}, {after.max():.3f} dB")
    found = re.search(r"Coulomb friction of ([0-9.]+) N m was taken off the torque, its standard error ([0-9.]+) N m;", said)
    coulomb_nm, error_nm = map(float, found.groups())
    print(f"F_c {coulomb_nm} +- {error_nm} N m")
    assert abs(coulomb_nm - 50.0) < 0.05 + 3 * error_nm < 0.2, said
    assert np.median(after) < 0.05 and after.max() < (0.5 if noise_rad_s else 0.15) < 4 < before.max()


def peaks(path):
    """Errors in dB where the truth of the diagonal is largest."""
    frf = frfid.load(path)
    hz = np.asarray(frf.frequency_hz)
    truth = frfid.Plant.load(EXAMPLES.parent / "robots/manutec_r3.toml").frf(hz, sample_time_s=0.001, sensor=True)
    found, truth = (np.abs(np.einsum("fii->if", np.asarray(of.response))) for of in (frf, truth))
    is_peak = np.pad((truth[:, 1:-1] > truth[:, :-2]) & (truth[:, 1:-1] > truth[:, 2:]), ((0, 0), (1, 1)))
    return 20 * np.log10(found / truth)[is_peak & (hz > 3)]


def test_the_friction_of_three_axes_is_told_in_the_loop(tmp_path):
    """All challenges on; the chirp shaped until no axis stands."""
    text = (EXAMPLES / "r3_chirp.toml").read_text().replace("../robots", str(EXAMPLES.parent / "robots"))
    (tmp_path / "x.toml").write_text(text)
    frfid_says("shape", tmp_path / "x.toml", "-o", tmp_path / "shaped")
    logs = tmp_path / "shaped/iteration_06"
    frfid_says("estimate", logs, "-o", tmp_path / "with.json")
    code, said = frfid_says("estimate", logs, "-o", tmp_path / "without.json", *FREE)
    assert code == 0, said
    found = re.findall(r"Coulomb friction of ([0-9.]+) N m was taken off the torque, its standard error ([0-9.]+)", said)
    coulomb_nm, error_nm = np.array(found, float).T
    before, after = peaks(tmp_path / "with.json"), peaks(tmp_path / "without.json")
    print(f"F_c {coulomb_nm} +- {error_nm} N m; peaks {before.round(2)} dB with friction, {after.round(2)} dB without")
    assert np.abs(coulomb_nm / [42.0, 105.0, 42.0] - 1).max() < 0.05
    assert np.abs(after).max() < 0.5 < 2.5 < np.abs(before).min()


def test_where_it_cannot_be_told_it_is_said(tmp_path):
    standing = recorded(tmp_path, "r3_chirp", duration_s="duration_s = 5.0")  # the first reference of a shaping
    code, said = frfid_says("estimate", standing, "-o", tmp_path / "a.json", *FREE)
    assert code != 0 or "nothing was taken off" in said or "for that to be trusted" in said, said
    (tmp_path / "b").mkdir()
    moving = recorded(tmp_path / "b", "constant_velocity", realizations="realizations = 2")
    code, said = frfid_says("estimate", moving, "-o", tmp_path / "b.json", *FREE)
    assert code == 1 and "a constant velocity keeps friction constant" in said
    t = 0.001 * np.arange(4000)
    np.savetxt(tmp_path / "foreign.csv", np.column_stack([t, np.sin(9 * t**2), np.cos(9 * t**2)]), header="t,u,y", comments="", delimiter=",")
    asked = ["--time", "t=s", "--u", "u=N m", "--y", "y=rad/s", *FREE]
    code, said = frfid_says("estimate", tmp_path / "foreign.csv", "-o", tmp_path / "c.json", *asked)
    assert code == 2 and "not runs of a plan" in said
