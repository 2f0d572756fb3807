"""Folders of rosbag2, written by rosbags: split into parts, compressed whole, a part missing, and folders of such folders."""

import shutil
import subprocess

import numpy as np
import pytest
from bench import FRFID, MARKS, estimate, from_csv, samples

pytest.importorskip("rosbags", reason="needs rosbags: pip install .[test]")
yaml = pytest.importorskip("ruamel.yaml", reason="comes with rosbags")
from rosbags.rosbag2 import CompressionFormat, CompressionMode, Reader, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from test_db3_clients import joint_states

TYPE = "sensor_msgs/msg/JointState"
STORE = get_typestore(Stores.ROS2_HUMBLE)

pytestmark = MARKS


def write(folder, messages, plugin, is_compressed=False):
    writer = Writer(folder, version=9, storage_plugin=plugin)
    if is_compressed:
        writer.set_compression(CompressionMode.FILE, CompressionFormat.ZSTD)
    with writer:
        topic = writer.add_connection("/states", TYPE, typestore=STORE)
        for stamp_ns, message in messages:
            writer.write(topic, stamp_ns, STORE.serialize_cdr(message, TYPE))
    return folder


def split(folder, plugin, n_parts=3, is_compressed=False):
    """One recording in parts as rosbag2 splits it: parts of whole bags put together under one metadata file."""
    messages = list(joint_states(STORE))
    folder.mkdir()
    information, files = None, []
    for k in range(n_parts):
        messages_of_part = messages[k * len(messages) // n_parts : (k + 1) * len(messages) // n_parts]
        part = write(folder.parent / f"{folder.name}_part_{k}", messages_of_part, plugin, is_compressed)
        metadata = yaml.YAML(typ="safe").load(part / "metadata.yaml")["rosbag2_bagfile_information"]
        (name,) = metadata["relative_file_paths"]
        files.append(f"{folder.name}_{k}{''.join((part / name).suffixes)}")
        shutil.move(part / name, folder / files[-1])
        shutil.rmtree(part)
        if information is None:
            information = metadata
        else:
            information["message_count"] += metadata["message_count"]
            for topic, other in zip(information["topics_with_message_count"], metadata["topics_with_message_count"]):
                topic["message_count"] += other["message_count"]
    information["relative_file_paths"] = files
    information["files"] = []
    yaml.YAML(typ="safe").dump({"rosbag2_bagfile_information": information}, folder / "metadata.yaml")
    return folder


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    return from_csv(tmp_path_factory.mktemp("csv"))


def estimated(path):
    return estimate(path, "/states:effort[motor]", "/states:velocity[motor]")


@pytest.mark.parametrize("plugin", [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
@pytest.mark.parametrize("is_compressed", [False, True])
def test_a_split_bag_is_one_recording(plugin, is_compressed, plain, tmp_path):
    folder = split(tmp_path / "bag", plugin, is_compressed=is_compressed)
    with Reader(folder) as reader:
        assert reader.message_count == len(samples())
    np.testing.assert_allclose(estimated(folder), plain, rtol=1e-9)


def test_a_missing_part_is_told_and_the_others_are_used(tmp_path):
    folder = split(tmp_path / "bag", StoragePlugin.MCAP, n_parts=6)
    (folder / "bag_5.mcap").unlink()
    arguments = ["--u", "/states:effort[motor]=A", "--y", "/states:velocity[motor]=rad/s"]
    done = subprocess.run([FRFID, "estimate", str(folder), "-o", str(tmp_path / "x.json"), *arguments], capture_output=True, text=True)
    assert "bag_5.mcap" in done.stderr, done.stderr
    assert done.returncode == 3, done.stderr


def test_a_folder_of_bags_is_a_recording_each_and_files_one_by_one_are_one(plain, tmp_path):
    (tmp_path / "session").mkdir()
    folder = split(tmp_path / "session" / "bag", StoragePlugin.MCAP)
    np.testing.assert_allclose(estimated(tmp_path / "session"), plain, rtol=1e-9)
    arguments = ["--u", "/states:effort[motor]=A", "--y", "/states:velocity[motor]=rad/s", "-o", str(tmp_path / "x.json")]
    parts = [str(folder / f"bag_{k}.mcap") for k in range(3)]
    done = subprocess.run([FRFID, "estimate", *parts[:2], *arguments], capture_output=True, text=True)
    assert done.returncode != 0 and "2 of the 3 files of one recording" in done.stderr, done.stderr
    done = subprocess.run([FRFID, "estimate", *parts, *arguments], capture_output=True, text=True)
    assert done.returncode in (0, 3), done.stderr
