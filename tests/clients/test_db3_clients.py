"""rosbag2 recordings in SQLite, written by rosbags: the motor bench as JointState and as every variant of the trajectory controller's state."""

import sqlite3
import subprocess

import numpy as np
import pytest
from bench import FRFID, MARKS, estimate, from_csv, samples

pytest.importorskip("rosbags", reason="needs rosbags: pip install .[test]")
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

STATE = "control_msgs/msg/JointTrajectoryControllerState"
POINTS = {"now": "reference feedback error output", "both": "reference feedback error output desired actual", "old": "desired actual error"}
VARIANTS = {"6.x": ("now", True, True), "5.0": ("now", True, False), "4.x": ("both", True, False), "3.x": ("old", True, False), "2.x": ("old", False, False)}

pytestmark = MARKS


def definition(points, has_dofs, has_scaling):
    lines = ["std_msgs/Header header", "string[] joint_names"]
    lines += [f"trajectory_msgs/JointTrajectoryPoint {name}" for name in POINTS[points].split()]
    if has_dofs:
        lines += ["string[] multi_dof_joint_names"]
        lines += [f"trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_{name}" for name in POINTS[points].split()]
    return "\n".join(lines + ["float64 speed_scaling_factor"] * has_scaling)


def header(store, t):
    stamp_ns = round(t * 1e9) + 1_700_000_000_000_000_000
    time = store.types["builtin_interfaces/msg/Time"](sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
    return store.types["std_msgs/msg/Header"](stamp=time, frame_id=""), stamp_ns


def joint_states(store):
    none, array = np.array([]), lambda *values: np.array(values)
    for t, _, current, motor, *_ in samples():
        head, stamp_ns = header(store, t)
        yield stamp_ns, store.types["sensor_msgs/msg/JointState"](head, ["motor"], none, array(motor), array(current))


def states(store, points, has_dofs, has_scaling):
    empty = np.array([])
    duration = store.types["builtin_interfaces/msg/Duration"](sec=0, nanosec=0)
    point = lambda velocity=empty, effort=empty: store.types["trajectory_msgs/msg/JointTrajectoryPoint"](empty, velocity, empty, effort, duration)
    dof = store.types["trajectory_msgs/msg/MultiDOFJointTrajectoryPoint"]([], [], [], duration)
    measured = {"now": "feedback", "both": "feedback", "old": "actual"}[points]
    for t, _, current, motor, *_ in samples():
        head, stamp_ns = header(store, t)
        values = [point(np.array([motor]), np.array([current])) if name == measured else point() for name in POINTS[points].split()]
        dofs = [[], *[dof] * len(values)] if has_dofs else []
        yield stamp_ns, store.types[STATE](head, ["motor"], *values, *dofs, *[1.0] * has_scaling)


def write(folder, type_name, store, messages, has_definitions=False):
    """A bag as newer recorders write it, or without definitions as those before Iron."""
    with Writer(folder, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        topic = writer.add_connection("/states", type_name, typestore=store)
        for stamp_ns, message in messages:
            writer.write(topic, stamp_ns, store.serialize_cdr(message, type_name))
    file = next(folder.glob("*.db3"))
    database = sqlite3.connect(file)
    n_definitions = database.execute("SELECT count(*) FROM message_definitions").fetchone()[0]
    assert n_definitions > 0
    if not has_definitions:
        database.execute("DROP TABLE message_definitions")
    database.commit()
    database.close()
    return file


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    return from_csv(tmp_path_factory.mktemp("csv"))


def estimated(file, u, y):
    return estimate(file, f"/states:{u}", f"/states:{y}")


@pytest.mark.parametrize("has_definitions", [True, False])
def test_joint_states_with_and_without_definitions(has_definitions, plain, tmp_path):
    store = get_typestore(Stores.ROS2_HUMBLE)
    file = write(tmp_path / "bag", "sensor_msgs/msg/JointState", store, joint_states(store), has_definitions)
    np.testing.assert_allclose(estimated(file, "effort[motor]", "velocity[motor]"), plain, rtol=1e-9)


@pytest.mark.parametrize("variant", VARIANTS)
def test_every_variant_of_the_controllers_state_is_told_by_its_bytes(variant, plain, tmp_path):
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(definition(*VARIANTS[variant]), STATE))
    file = write(tmp_path / "bag", STATE, store, states(store, *VARIANTS[variant]))
    measured = "actual" if VARIANTS[variant][0] == "old" else "feedback"
    np.testing.assert_allclose(estimated(file, f"{measured}.effort[0]", f"{measured}.velocities[0]"), plain, rtol=1e-9)


def test_a_type_without_definition_is_named_with_the_way_out(tmp_path):
    store = get_typestore(Stores.ROS2_HUMBLE)
    text = store.types["std_msgs/msg/String"]
    file = write(tmp_path / "bag", "std_msgs/msg/String", store, ((k, text(data="x")) for k in range(10)))
    done = subprocess.run([FRFID, "estimate", str(file), "-o", str(tmp_path / "x"), "--u", "/states:a=A", "--y", "/states:b=A"], capture_output=True, text=True)
    assert done.returncode == 2 and "std_msgs/msg/String" in done.stderr and "rosbags-convert" in done.stderr, done.stderr


def test_a_cut_bag_is_told_or_refused(tmp_path):
    store = get_typestore(Stores.ROS2_HUMBLE)
    file = write(tmp_path / "bag", "sensor_msgs/msg/JointState", store, joint_states(store))
    whole = file.read_bytes()
    for share in (0.02, 0.3, 0.7, 0.99):
        file.write_bytes(whole[: int(share * len(whole))])
        with pytest.raises(sqlite3.DatabaseError):
            sqlite3.connect(file).execute("SELECT count(data), sum(length(data)) FROM messages").fetchall()
        arguments = ["--u", "/states:effort[motor]=A", "--y", "/states:velocity[motor]=rad/s"]
        done = subprocess.run([FRFID, "estimate", str(file), "-o", str(tmp_path / "x.json"), "--force", *arguments], capture_output=True, text=True)
        assert done.returncode in (2, 3) and ("malformed" in done.stderr or "cannot read on" in done.stderr), done.stderr
