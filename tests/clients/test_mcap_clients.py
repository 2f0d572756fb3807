"""Runs and plans of frfid, read by programs that are not ours: mcap + mcap-ros2-support, and rosbags.

Needs ``pip install mcap mcap-ros2-support rosbags numpy pytest``, and cargo to write the files.
"""

import json
import os
import pathlib
import subprocess

import numpy as np
import pytest

reader = pytest.importorskip("mcap.reader")
mcap_ros2 = pytest.importorskip("mcap_ros2.decoder")
highlevel = pytest.importorskip("rosbags.highlevel")

ROOT = pathlib.Path(__file__).parents[2]
JOINTS = ["shoulder", "elbow"]
START_NS = 1_000_000_000
N = 3000
JOINT_STATE_HASH = "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"


def signal(which):
    """The example's formula: exact in binary, (joint, sample)."""
    joint, sample = np.arange(2)[:, None], np.arange(N)[None, :]
    return (37 * sample + 11 * joint + 5 * which) % 1000 / 64 - 5


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("mcap")
    # of the whole workspace: of one package alone its dependencies would be built once more, with fewer features
    subprocess.run(["cargo", "build", "-q", "--workspace", "--example", "write_sample_run"], cwd=ROOT, check=True)
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    subprocess.run([ROOT / target / "debug" / "examples" / "write_sample_run", path], check=True)
    return path


def by_mcap_ros2(path):
    """Topic to decoded messages with their log times; every checksum is verified."""
    topics = {}
    with open(path, "rb") as file:
        source = reader.make_reader(file, validate_crcs=True, decoder_factories=[mcap_ros2.DecoderFactory()])
        for schema, channel, message, decoded in source.iter_decoded_messages():
            assert message.publish_time == message.log_time
            topics.setdefault(channel.topic, []).append((message.log_time, decoded))
    return topics


def by_rosbags(path):
    topics = {}
    with highlevel.AnyReader([path]) as source:
        for connection, time, raw in source.messages():
            topics.setdefault(connection.topic, []).append((time, source.deserialize(raw, connection.msgtype)))
    return topics


def column(messages, field):
    return np.array([getattr(message, field) for _, message in messages]).T


CLIENTS = [by_mcap_ros2, by_rosbags]


@pytest.mark.parametrize("client", CLIENTS)
def test_a_run_has_every_value(folder, client):
    topics = client(folder / "run.mcap")
    assert set(topics) == {"/joint_states", "/joint_commands", "/frfid/excitation", "/frfid/events"}
    states, commands, excitation = (topics[t] for t in ("/joint_states", "/joint_commands", "/frfid/excitation"))
    for messages in (states, commands, excitation):
        assert len(messages) == N
        for k, (time, message) in enumerate(messages):
            stamp = message.header.stamp
            assert time == START_NS + 1_000_000 * k == stamp.sec * 10**9 + stamp.nanosec
            assert list(message.name) == JOINTS
            assert all(len(getattr(message, field)) in (0, 2) for field in ("position", "velocity", "effort"))
    np.testing.assert_array_equal(column(commands, "effort"), signal(0))
    np.testing.assert_array_equal(column(states, "velocity"), signal(1))
    np.testing.assert_array_equal(column(commands, "velocity"), signal(2))
    np.testing.assert_array_equal(column(excitation, "velocity"), signal(2))
    np.testing.assert_array_equal(column(states, "position"), signal(3))
    assert column(states, "effort").size == 0
    events = [json.loads(message.data) for _, message in topics["/frfid/events"]]
    assert events == [{"time_s": 1.5 * p, "event": "period-start", "period": p} for p in (0, 1)]


@pytest.mark.parametrize("client", CLIENTS)
def test_a_plan_can_be_replayed(folder, client):
    topics = client(folder / "plan.mcap")
    efforts = column(topics["/joint_commands"], "effort")
    np.testing.assert_array_equal(efforts, np.hstack([signal(10 + p) for p in range(3)]))
    times = [time for time, _ in topics["/joint_commands"]]
    for (start, message), first in zip(topics["/frfid/events"], times[::N], strict=True):
        event = json.loads(message.data)
        assert event["event"] == "run-start" and event["n_samples"] == N and event["n_repetitions"] == 4
        assert start == first == START_NS + 1_000_000 * event["start_sample"]


def test_what_describes_the_run_and_the_file(folder):
    with open(folder / "run.mcap", "rb") as file:
        source = reader.make_reader(file, validate_crcs=True)
        summary = source.get_summary()
        metadata = {record.name: record.metadata for record in source.iter_metadata()}
        attachments = {item.name: item.data for item in source.iter_attachments()}
        assert source.get_header().profile == "ros2"
    assert metadata["frfid"] == {"seed": "42"}
    assert json.loads(metadata["frfid.run"]["run"])["realization"] == 1
    assert attachments == {"experiment.toml": b'[experiment]\nname = "sample"\n'}
    assert summary.statistics.message_count == 3 * N + 2
    assert {chunk.compression for chunk in summary.chunk_indexes} == {"zstd"}
    for channel in summary.channels.values():
        schema = summary.schemas[channel.schema_id]
        assert (channel.message_encoding, schema.encoding) == ("cdr", "ros2msg")
        assert "offered_qos_profiles" in channel.metadata
        if schema.name == "sensor_msgs/msg/JointState":
            assert channel.metadata["topic_type_hash"] == JOINT_STATE_HASH
