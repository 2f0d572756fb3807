"""Sound files of every kind that frfid reads, each as small as it goes, and what is done with them.

One joint, two short runs of it in the layout of frfid and in others; the same recording as every format takes it.
"""

import gzip
import io
import pathlib
import sqlite3
import struct
import sys
from dataclasses import dataclass

import numpy as np
import scipy.io
import zstandard
from command import call, scratch
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

sys.path.append(str(pathlib.Path(__file__).parents[1] / "clients"))
import matlab73  # noqa: E402

DESCRIPTION = """seed = 1
sample_time_s = 0.005

[robot.single_joint]
motor_inertia_kg_m2 = 35.0
link_inertia_kg_m2 = 150.0
damping_nms_per_rad = 400.0
stiffness_nm_per_rad = 1.5e5
viscous_nms_per_rad = 2000.0

[multisine]
low_hz = 4.0
high_hz = 40.0
resolution_hz = 4.0
peak_nm = [150.0]

[averaging]
realizations = 2
periods = 3

[limits]
max_effort = [150.0]
"""
SHAPED = """seed = 1
sample_time_s = 0.002

[robot.single_joint]
motor_inertia_kg_m2 = 35.0
link_inertia_kg_m2 = 150.0
damping_nms_per_rad = 400.0
stiffness_nm_per_rad = 1.5e5
coulomb_nm = 5.0

[controller]
gain_nms_per_rad = [600.0]
integral_gain_nm_per_rad = [4800.0]

[chirp]
low_hz = 4.0
high_hz = 40.0
duration_s = 2.0
amplitude_rad_s = [0.05]
fade_s = 0.05
tail_s = 0.5

[shape]
desired_nm = [60.0]
n_iterations = 3
"""
RUN = "p000-m0-q0.mcap"
CHUNK = 4096  # bytes before they are packed: several chunks even in these files
SIGNALS = ["--u", "u=N m", "--y", "y=rad/s", "--time", "t=s"]
TOPIC = "/joint_states"
FIELDS = ["--u", f"{TOPIC}:effort[0]=N m", "--y", f"{TOPIC}:velocity[0]=rad/s"]
JOINT_STATE = "\n".join(
    [
        *["std_msgs/Header header", "string[] name", "float64[] position", "float64[] velocity", "float64[] effort"],
        *["=" * 80, "MSG: std_msgs/Header", "builtin_interfaces/Time stamp", "string frame_id"],
        *["=" * 80, "MSG: builtin_interfaces/Time", "int32 sec", "uint32 nanosec", ""],
    ]
)


@dataclass
class Material:
    """A sound file, the commands that read it from the folder it lies in, and whether its bytes are under a checksum."""

    name: str
    file: str
    content: bytes
    commands: list
    is_checked: bool = True
    beside: tuple = ()  # (name, bytes) of files that are there, too

    def lay(self, folder, content=None):
        """Puts the file there, or other bytes in its place, and what is beside it."""
        for name, others in [*self.beside, (self.file, self.content if content is None else content)]:
            path = pathlib.Path(folder) / name
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(others)


def joint(hz):
    """Motor torque to motor velocity of two masses with a spring."""
    s = 2j * np.pi * np.asarray(hz, float)
    link_side = 0.06 * s**2 + 0.09 * s + 75.0
    return link_side / ((0.02 * s + 0.05) * link_side + 0.06 * s * (0.09 * s + 75.0))


def recording():
    """t, u, y: four periods of 100 samples in the steady state, with some noise."""
    draw, n, dt = np.random.default_rng(1), 100, 0.005
    t, lines = dt * np.arange(4 * n), np.arange(3, 40, 4)
    phase = draw.uniform(0, 2 * np.pi, len(lines))
    turn = 2 * np.pi * np.outer(t, lines) / (n * dt) + phase
    through = joint(lines / (n * dt))
    u, y = np.cos(turn).sum(1), (np.abs(through) * np.cos(turn + np.angle(through))).sum(1)
    return t, u, y + 1e-3 * draw.standard_normal(len(t))


def cdr(stamp_ns, velocity, effort):
    """A JointState of one joint as CDR."""
    body = struct.pack("<iI", stamp_ns // 10**9, stamp_ns % 10**9) + struct.pack("<I1sxxx", 1, b"\0")
    body += struct.pack("<II6sxx", 1, 6, b"elbow\0")
    for value in (None, velocity, effort):
        if value is None:
            body += struct.pack("<I", 0)
            continue
        body += struct.pack("<I", 1)
        body += bytes(-len(body) % 8) + struct.pack("<d", value)
    return b"\0\1\0\0" + body


def foreign_mcap(packing=CompressionType.ZSTD):
    file = io.BytesIO()
    writer = Writer(file, chunk_size=CHUNK, compression=packing, enable_data_crcs=True)
    writer.start("ros2", "")
    schema = writer.register_schema("sensor_msgs/msg/JointState", "ros2msg", JOINT_STATE.encode())
    channel = writer.register_channel(TOPIC, "cdr", schema)
    for k, (t, u, y) in enumerate(zip(*recording())):
        stamp = 10**9 + round(t * 1e9)
        writer.add_message(channel, stamp, cdr(stamp, y, u), stamp, k)
    writer.finish()
    return file.getvalue()


def packed_otherwise(content, packing):
    """An MCAP with all that is in it in small chunks of another packing."""
    reader, file = make_reader(io.BytesIO(content)), io.BytesIO()
    writer = Writer(file, chunk_size=CHUNK, compression=packing, enable_data_crcs=True)
    writer.start(reader.get_header().profile, reader.get_header().library)
    for entry in reader.iter_attachments():
        writer.add_attachment(entry.create_time, entry.log_time, entry.name, entry.media_type, entry.data)
    for entry in reader.iter_metadata():
        writer.add_metadata(entry.name, entry.metadata)
    channels = {}
    for schema, channel, message in reader.iter_messages(log_time_order=False):
        if channel.id not in channels:
            of = writer.register_schema(schema.name, schema.encoding, schema.data)
            channels[channel.id] = writer.register_channel(channel.topic, channel.message_encoding, of, channel.metadata)
        writer.add_message(channels[channel.id], message.log_time, message.data, message.publish_time, message.sequence)
    writer.finish()
    return file.getvalue()


def csv():
    rows = [f"{t:.3f},{u:.9g},{y:.9g}" for t, u, y in zip(*recording())]
    return ("\n".join(["t,u,y", *rows]) + "\n").encode()


def npz(packed=True):
    file = io.BytesIO()
    t, u, y = recording()
    (np.savez_compressed if packed else np.savez)(file, t=t, u=u, y=y)
    return file.getvalue()


def mat5(packed):
    file = io.BytesIO()
    t, u, y = recording()
    scipy.io.savemat(file, {"t": t, "u": u, "y": y}, do_compression=packed)
    return file.getvalue()


def mat73(folder):
    path = pathlib.Path(folder) / "of_matlab.mat"
    with matlab73.MatFile(path, packed=True) as file:
        for name, values in zip("tuy", recording()):
            file.put(name, values)
    return path.read_bytes()


def db3(folder):
    path = pathlib.Path(folder) / "bag.db3"
    with sqlite3.connect(path) as bag:
        bag.execute("PRAGMA page_size = 1024")
        bag.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT)")
        bag.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")
        bag.execute("INSERT INTO topics VALUES(1, ?, 'sensor_msgs/msg/JointState', 'cdr')", [TOPIC])
        for t, u, y in zip(*recording()):
            stamp = 10**9 + round(t * 1e9)
            bag.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(1, ?, ?)", [stamp, cdr(stamp, y, u)])
    bag.close()
    return path.read_bytes()


def made(folder, *arguments):
    said = call(folder, *arguments)
    assert said.code in (0, 3), said.text


def own_files(folder):
    """Description, plan, runs and result in a folder."""
    folder = pathlib.Path(folder)
    (folder / "x.toml").write_text(DESCRIPTION)
    made(folder, "design", "x.toml", "-o", "plan.mcap")
    made(folder, "run", "plan.mcap", "-o", "logs")
    made(folder, "estimate", "logs", "-o", "frf.json")
    return folder


ESTIMATE = ["estimate", "-o", "frf.json"]


def materials():
    """Every material, in the order of the table in docs/reliability.md."""
    with scratch() as folder:
        own = own_files(folder)
        runs = {path.name: path.read_bytes() for path in sorted((own / "logs").iterdir())}
        other = tuple((f"{place}/{name}", content) for name, content in runs.items() if name != RUN for place in ("logs", "again"))
        kept = {name: (own / name).read_bytes() for name in ("plan.mcap", "frf.json")}
        hdf5, database = mat73(folder), db3(folder)
    of_run = [[*ESTIMATE, "logs"], ["recover", f"logs/{RUN}", "-o", f"again/{RUN}"]]
    for packing in (None, CompressionType.ZSTD, CompressionType.LZ4, CompressionType.NONE):
        content = runs[RUN] if packing is None else packed_otherwise(runs[RUN], packing)
        name = "run" if packing is None else f"run, chunks {packing.name.lower()}"
        yield Material(name, f"logs/{RUN}", content, of_run, beside=other)
    yield Material("plan", "plan.mcap", kept["plan.mcap"], [["run", "plan.mcap", "-o", "played"]])
    yield Material("result", "frf.json", kept["frf.json"], [["export", "frf.json", "-o", "frf.csv"]])
    of_mcap = [[*ESTIMATE, "a.mcap", *FIELDS], ["recover", "a.mcap", "-o", "again.mcap"]]
    yield Material("foreign MCAP", "a.mcap", foreign_mcap(), of_mcap)

    def foreign(name, file, content, is_checked=False, signals=SIGNALS):
        return Material(name, file, content, [[*ESTIMATE, file, *signals]], is_checked)

    yield foreign("NPZ", "a.npz", npz(), True)
    yield foreign("CSV.gz", "a.csv.gz", gzip.compress(csv(), mtime=0), True)
    yield foreign("CSV.zst", "a.csv.zst", zstandard.ZstdCompressor(write_checksum=True).compress(csv()), True)
    yield foreign("MAT, packed", "a.mat", mat5(True), True)
    yield foreign("MAT", "a.mat", mat5(False))
    yield foreign("MAT v7.3", "a.mat", hdf5)
    yield foreign("rosbag2 .db3", "a.db3", database, signals=FIELDS)
    yield foreign("CSV", "a.csv", csv())
    toml = [["design", "x.toml", "-o", "plan.mcap"]]
    yield Material("description", "x.toml", DESCRIPTION.encode(), toml, False)
