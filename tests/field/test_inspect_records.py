"""`frfid inspect` on every measured record: what a person would say who looked for ten minutes."""

import json
import pathlib
import shutil
import subprocess

import pytest

FRFID = shutil.which("frfid")
DATA = pathlib.Path(__file__).parents[3] / "shared" / "data"
pytestmark = [
    pytest.mark.skipif(FRFID is None, reason="needs the command frfid: pip install ."),
    pytest.mark.skipif(not DATA.is_dir(), reason=f"{DATA} is missing"),
]

BENCH = ["2500 Hz", "an estimate would find", "period               1 s", "240, 11 to 250 Hz", "passed"]
SAID = {
    "motor_bench/multisine_type_a.csv.gz": [*BENCH, "current_reference_A"],
    "rosbags/motor_bench_a.mcap": [*BENCH, "/joint_commands:effort[motor_joint]", "by the definition of JointState"],
    "rosbags/emps.mcap": ["1000 Hz", 'unit = "N"', "sliding joints", "would refuse"],
    "rosbags/talker.mcap": ["std_msgs/msg/String", "/rosout", "2 Hz"],
    "rosbags/wbag_0.mcap": ["8 groups", "no signal in it"],
    "rosbags/array_msgs_0.mcap": ["MCAP"],
    "rosbags/base_msgs_0.mcap": ["MCAP"],
    "rosbags/cdr_test_0.mcap": ["test_msgs/msg/Arrays"],
    "rosbags/only_topics.mcap": ["MCAP"],
    "emps/data_emps.npz": ["1000 Hz", "qm", "vir", "--u SIGNAL=UNIT"],
    "f16/F16Data_FullMSine_Level1.npz": ['source = "force", unit = "N"', 'unit = "m/s^2"', "sample_time_s", "would refuse"],
    "silverbox/snls80mv.npz": ['source = "u"', "unknown: state it"],
    "slfr_swept/step.npz": ["500 Hz", "theta[2]", "takes 2 values only", "inputs are alike"],
    "daisy_robot_arm/robot_arm.dat": ["separator tab; no header", "1024"],
}


@pytest.mark.parametrize("file", SAID)
def test_it_says_what_is_there(file):
    done = subprocess.run([FRFID, "inspect", str(DATA / file)], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    for words in SAID[file]:
        assert words in done.stdout + done.stderr, done.stdout


def test_a_stated_map_takes_the_place_of_the_guess(tmp_path):
    """The sample time that the wing's record does not have, and its own names."""
    map_ = tmp_path / "wing.toml"
    map_.write_text('sample_time_s = 0.0025\nu = [{ source = "force", unit = "N" }]\ny = [{ source = "acceleration[1]", unit = "m/s^2" }]\n')
    arguments = [FRFID, "inspect", str(DATA / "f16" / "F16Data_FullMSine_Level1.npz"), "--map", str(map_), "--json"]
    found = json.loads(subprocess.run(arguments, capture_output=True, text=True, check=True).stdout)
    assert found["map"] is None and found["estimate"]["provenance"]["period_samples"] == "8192"
