"""Bags of others with a chunk that cannot be read: what is whole is used, what is lost is counted and told."""

import numpy as np
import pytest
from joint import estimate, steady

Writer = pytest.importorskip("mcap_ros2.writer").Writer

JOINT_STATE = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
ELBOW = ["--u", "/joint_states:effort[elbow]=N m", "--y", "/joint_states:velocity[elbow]=rad/s"]
CHUNK = b"\x06"  # opcode of a chunk; its CRC stands 28 bytes behind the opcode and the length
CRC = 1 + 8 + 8 + 8 + 8


def bag(path, t, torque, speed):
    with open(path, "wb") as file:
        writer = Writer(file, chunk_size=64 * 1024)
        schema = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
        for time, effort, velocity in zip(t, torque, speed):
            stamp = 1_000_000_000 + round(time * 1e9)
            header = {"stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}, "frame_id": ""}
            message = {"header": header, "name": ["elbow"], "position": [0.0], "velocity": [velocity], "effort": [effort]}
            writer.write_message("/joint_states", schema, message, log_time=stamp, publish_time=stamp)
        writer.finish()


def chunks(content):
    """Places of the chunks: records are an opcode, a length and so many bytes."""
    places, at = [], 8
    while at < len(content) - 8:
        if content[at : at + 1] == CHUNK:
            places.append(at)
        at += 9 + int.from_bytes(content[at + 1 : at + 9], "little")
    return places


@pytest.mark.parametrize("which", [1, 4])
@pytest.mark.parametrize("periods", [4, 8])
def test_one_lost_chunk_costs_its_periods(tmp_path, periods, which):
    t, torque, speed = steady(1, periods)
    path = tmp_path / "a.mcap"
    bag(path, t, torque, speed)
    content = bytearray(path.read_bytes())
    content[chunks(content)[which] + CRC] ^= 0xFF
    path.write_bytes(content)
    outcome = estimate(tmp_path, ["a.mcap"], *ELBOW)
    assert outcome.code == 3 and outcome.said("a.mcap", "chunk"), outcome.text
    assert np.median(outcome.error()) < 1e-3 and outcome.inside() > 0.8
    used, lost = (int(outcome.result["provenance"][f"periods_{what}"]) for what in ("used", "lost"))
    assert used + lost <= periods and used == outcome.result["noise"]["degrees_of_freedom"] + 1
    assert str(used) in outcome.check("periods")["found"]


def test_a_chunk_without_which_nothing_repeats_is_named(tmp_path):
    t, torque, speed = steady(1, 1.5)
    path = tmp_path / "a.mcap"
    bag(path, t, torque, speed)
    content = bytearray(path.read_bytes())
    content[chunks(content)[1] + CRC] ^= 0xFF
    path.write_bytes(content)
    outcome = estimate(tmp_path, ["a.mcap"], *ELBOW)
    assert outcome.code == 3 and outcome.said("nothing repeats", "chunk"), outcome.text
