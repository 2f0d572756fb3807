"""Recordings as they lie around: a CSV with a controller's own names, a ROS 2 bag of joint states and a controller's state.

The bag is one MCAP file, or, for any name without `.mcap`, a folder of rosbag2 with SQLite.
Needs for bags: pip install mcap rosbags
"""

import numpy as np

EPOCH_S = 1_760_000_000  # the recorder's second 0 in a bag
STATES, STATE = "sensor_msgs/msg/JointState", "control_msgs/msg/JointTrajectoryControllerState"
TOPICS = {"/joint_states": STATES, "/arm_controller/controller_state": STATE}
POINTS = ("reference", "feedback", "error", "output")
DEFINITION = "\n".join(
    ["std_msgs/Header header", "string[] joint_names"]
    + [f"trajectory_msgs/JointTrajectoryPoint {point}" for point in POINTS]
    + ["string[] multi_dof_joint_names"]
    + [f"trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_{point}" for point in POINTS]
    + ["float64 speed_scaling_factor"]
)
CSV_SIGNALS = {"SetVel": "reference velocity", "ActPos": "position", "ActVel": "velocity", "ActTrq": "torque"}


def write(path, names, stamps, signals, rows):
    """By its ending; rows() draws which rows a stream of samples keeps, with repeats."""
    if path.suffix == ".csv":
        write_csv(path, names, stamps, signals, rows)
    else:
        write_bag(path, names, stamps, signals, rows)


def write_csv(path, names, stamps, signals, rows):
    """Time in ms; the axes are A1, A2, ..., units are left to those who know."""
    header = ["t_ms", *(f"A{axis}.{column}" for axis in range(1, len(names) + 1) for column in CSV_SIGNALS)]
    columns = [signals[signal][axis] for axis in range(len(names)) for signal in CSV_SIGNALS.values()]
    kept = rows(stamps.size)
    table = np.column_stack([1e3 * stamps, *columns])[kept]
    np.savetxt(path, table, delimiter=",", header=",".join(header), comments="", fmt="%.12g")


def write_bag(path, names, stamps, signals, rows):
    """Both topics are stamped alike and lose rows of their own; /joint_states has the joints in another order."""
    store = ros_types()
    kinds = {"/joint_states": joint_states, "/arm_controller/controller_state": controller_states}
    messages = []
    for topic, messages_of in kinds.items():
        kept = rows(stamps.size)
        stamps_ns = np.round(1e9 * stamps[kept]).astype(np.int64) + EPOCH_S * 10**9
        parts = messages_of(store, names, stamps_ns, {name: values[:, kept].T.copy() for name, values in signals.items()})
        data = (store.serialize_cdr(message, TOPICS[topic]) for message in parts)
        messages += [(stamp, topic, part) for stamp, part in zip(stamps_ns.tolist(), data)]
    messages.sort(key=lambda message: message[0])
    (write_mcap if path.suffix == ".mcap" else write_rosbag2)(path, store, messages)


def joint_states(store, names, stamps_ns, signals):
    """sensor_msgs/JointState of every row, the joints in reverse order."""
    of = store.types[STATES]
    columns = zip(*(np.ascontiguousarray(signals[name][:, ::-1]) for name in ("position", "velocity", "torque")))
    for stamp, (position, velocity, effort) in zip(stamps_ns.tolist(), columns):
        yield of(header=header(store, stamp), name=names[::-1], position=position, velocity=velocity, effort=effort)


def controller_states(store, names, stamps_ns, signals):
    """control_msgs/JointTrajectoryControllerState of every row: reference, feedback, their difference, torque as output."""
    of, point = store.types[STATE], store.types["trajectory_msgs/msg/JointTrajectoryPoint"]
    none, now = np.zeros(0), store.types["builtin_interfaces/msg/Duration"](sec=0, nanosec=0)
    multi = store.types["trajectory_msgs/msg/MultiDOFJointTrajectoryPoint"]([], [], [], now)
    no_multi = {f"multi_dof_{name}": multi for name in POINTS}
    references = ("reference position", "reference velocity", "reference acceleration")
    columns = zip(*(signals[name] for name in (*references, "position", "velocity", "torque")))
    for stamp, (r, rv, ra, q, v, effort) in zip(stamps_ns.tolist(), columns):
        points = {
            "reference": point(r, rv, ra, none, now),
            "feedback": point(q, v, none, none, now),
            "error": point(r - q, rv - v, none, none, now),
            "output": point(none, none, none, effort, now),
        }
        head = header(store, stamp)
        yield of(header=head, joint_names=names, **points, multi_dof_joint_names=[], **no_multi, speed_scaling_factor=1.0)


def header(store, stamp_ns):
    time = store.types["builtin_interfaces/msg/Time"](sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
    return store.types["std_msgs/msg/Header"](stamp=time, frame_id="")


def ros_types():
    """The messages of ROS 2 Jazzy and the state of its joint_trajectory_controller."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    store.register(get_types_from_msg(DEFINITION, STATE))
    return store


def write_mcap(path, store, messages):
    from mcap.writer import Writer

    with open(path, "wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2", library="mujoco_player")
        channels = {}
        for topic, kind in TOPICS.items():
            definition = store.generate_msgdef(kind, ros_version=2)[0].encode()
            channels[topic] = writer.register_channel(topic, "cdr", writer.register_schema(kind, "ros2msg", definition))
        for stamp_ns, topic, data in messages:
            writer.add_message(channels[topic], stamp_ns, bytes(data), stamp_ns)
        writer.finish()


def write_rosbag2(path, store, messages):
    from rosbags.rosbag2 import StoragePlugin, Writer

    with Writer(path, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connections = {topic: writer.add_connection(topic, kind, typestore=store) for topic, kind in TOPICS.items()}
        for stamp_ns, topic, data in messages:
            writer.write(connections[topic], stamp_ns, data)
