"""Reading of recordings: 50 000 JointState messages of three joints from an MCAP in zstd chunks, 100 000 rows of ten columns from a CSV.

frfid puts the samples on one clock and looks for losses besides, and verifies every checksum of the MCAP.
"""

import pathlib
import tempfile

import numpy as np
from case import Case

import frfid

N_COLUMNS = 10
FOLDER = tempfile.TemporaryDirectory()
SIGNAL = {"unit": "1"}


def table(n_rows):
    path = pathlib.Path(FOLDER.name) / "log.csv"
    t = np.arange(n_rows) * 1e-3
    columns = np.sin(t[:, None] * np.arange(1, N_COLUMNS))
    names = ["t", *(f"c{k}" for k in range(1, N_COLUMNS))]
    np.savetxt(path, np.c_[t, columns], delimiter=",", header=",".join(names), comments="", fmt=["%.3f"] + ["%.9f"] * (N_COLUMNS - 1))
    signals = [SIGNAL | {"source": name} for name in names[1:]]
    return path, {"time": {"source": "t", "unit": "s"}, "u": signals[:1], "y": signals[1:]}


def bag(n_messages):
    """Written by the Python package of MCAP for ROS 2."""
    from mcap_ros2.writer import Writer

    path = pathlib.Path(FOLDER.name) / "log.mcap"
    definition = (
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n" + "=" * 80 + "\nMSG: std_msgs/Header\n"
        "builtin_interfaces/Time stamp\nstring frame_id\n" + "=" * 80 + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
    )
    with open(path, "wb") as file:
        writer = Writer(file)
        schema = writer.register_msgdef("sensor_msgs/msg/JointState", definition)
        for k in range(n_messages):
            stamp_ns = 10**18 + k * 10**6
            values = np.sin(1e-3 * k * np.arange(1, 4)).tolist()
            header = {"stamp": {"sec": stamp_ns // 10**9, "nanosec": stamp_ns % 10**9}, "frame_id": ""}
            message = {"header": header, "name": ["a", "b", "c"], "position": [], "velocity": values, "effort": values[::-1]}
            writer.write_message("/joint_states", schema, message, log_time=stamp_ns, publish_time=stamp_ns)
        writer.finish()
    signals = lambda field: [SIGNAL | {"source": f"/joint_states:{field}[{joint}]"} for joint in "abc"]
    return path, {"u": signals("effort"), "y": signals("velocity")}


def by_frfid(path, log_map):
    record = frfid.read(path, map=log_map)
    return record.u, record.y


def by_numpy(path):
    columns = np.loadtxt(path, delimiter=",", skiprows=1).T
    return columns[1:2], columns[2:]


def by_pandas(path):
    import pandas

    columns = pandas.read_csv(path).to_numpy().T
    return columns[1:2], columns[2:]


def by_mcap(path):
    from mcap_ros2.reader import read_ros2_messages

    messages = [message.ros_msg for message in read_ros2_messages(str(path))]
    return np.array([message.effort for message in messages]).T, np.array([message.velocity for message in messages]).T


def by_rosbags(path):
    from rosbags.highlevel import AnyReader

    with AnyReader([path]) as source:
        messages = [source.deserialize(raw, connection.msgtype) for connection, _, raw in source.messages()]
    return np.array([message.effort for message in messages]).T, np.array([message.velocity for message in messages]).T


def cases(small=False):
    n_messages, n_rows = (500, 1000) if small else (50_000, 100_000)
    path, log_map = bag(n_messages)
    here = (f"{n_messages} JointState messages from MCAP, zstd", "message", n_messages, lambda: by_frfid(path, log_map))
    yield Case(*here, "mcap-ros2-support", "read_ros2_messages", lambda: by_mcap(path), tolerance=1e-15, headline=True)
    yield Case(*here, "rosbags", "AnyReader", lambda: by_rosbags(path), tolerance=1e-15, headline=True)
    csv, csv_map = table(n_rows)
    here = (f"CSV, {n_rows} x {N_COLUMNS}", "number", n_rows * N_COLUMNS, lambda: by_frfid(csv, csv_map))
    yield Case(*here, "numpy", "np.loadtxt", lambda: by_numpy(csv), tolerance=1e-15)
    yield Case(*here, "pandas", "pandas.read_csv", lambda: by_pandas(csv), tolerance=1e-12)
