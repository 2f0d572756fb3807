"""Files that claim sizes which are not theirs, and small ones that unpack to large: read or refused in little memory, and soon."""

import functools
import gzip
import io
import pathlib
import random
import struct
import zipfile
import zlib

import numpy as np
import zstandard
from command import call, scratch
from conformance import CHANNEL, CHUNK, FOOTER, HEADER, MAGIC, MESSAGE, SCHEMA, record, text, texts, u16, u32, u64
from judges import misbehaviour, tallied
from materials import FIELDS, JOINT_STATE, SIGNALS, TOPIC, cdr, recording

MOST_BYTES = 1 << 30  # of memory, whatever a file claims
GUARD = 6 << 30  # of address space, so that a bomb does not take the machine
SIZES = [2**31, 2**32 - 1, 2**63, 2**64 - 1]


def bounded(name, file, content, commands):
    """A hostile file through commands, up to the first fault: a list of (outcome, fault or None)."""
    judged = []
    with scratch() as folder:
        pathlib.Path(folder, file).write_bytes(content)
        for command in commands:
            said = call(folder, *command, memory=GUARD)
            fault = misbehaviour(said)
            if said.peak_bytes > MOST_BYTES:
                fault = fault or f"took {said.peak_bytes >> 20} MiB"
            judged.append((f"{command[0]} {'read' if said.code in (0, 3) else 'refused'}", fault and f"{name}, {command[0]}: {fault}"))
            if fault:
                break
    return judged


def commands_of(file, signals):
    recover = [["recover", file, "-o", "again.mcap", "--force"]] if file.endswith(".mcap") else []
    return [["estimate", file, *signals, "-o", "frf.json", "--force"], ["inspect", file], *recover]


def plain_mcap(messages=12):
    """A recording of others without any checksum and packing: every length in it is believed, as far as it goes."""
    schema = record(SCHEMA, u16(1) + text("sensor_msgs/msg/JointState") + text("ros2msg") + text(JOINT_STATE))
    channel = record(CHANNEL, u16(1) + u16(1) + text(TOPIC) + text("cdr") + texts({"a": "b"}))
    rows = zip(range(messages), *recording())
    records = [record(MESSAGE, u16(1) + u32(k) + u64(10**9 + k * 5_000_000) * 2 + cdr(10**9 + k * 5_000_000, y, u)) for k, _, u, y in rows]
    packed = schema + channel + b"".join(records)
    chunk = record(CHUNK, u64(10**9, 2 * 10**9) + u64(len(packed)) + u32(0) + text("") + u64(len(packed)) + packed)
    return mcap_of(chunk)


def mcap_of(*records):
    return MAGIC + record(HEADER, text("ros2") + text("")) + b"".join(records) + record(FOOTER, u64(0, 0) + u32(0)) + MAGIC


def sizes_in_mcap(count=None, seed=1):
    """Every place of an MCAP overwritten by every size, four and eight bytes wide: the lengths of records, texts, CDR are among them."""
    content = plain_mcap()
    places = [(at, size, width) for at in range(8, len(content) - 16) for size in SIZES for width in (4, 8) if size < 256**width]
    for at, size, width in places if count is None else random.Random(seed).sample(places, count):
        other = content[:at] + size.to_bytes(width, "little") + content[at + width :]
        yield functools.partial(bounded, f"{size} at byte {at}", "a.mcap", other, commands_of("a.mcap", FIELDS))


def npy(shape, data):
    """An array whose shape is claimed."""
    head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}"
    head += " " * (-(len(head) + 11) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode() + data


def npz_of(member):
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for name in ("t", "u", "y"):
            with archive.open(f"{name}.npy", "w", force_zip64=True) as entry:
                for part in member:
                    entry.write(part)
    return file.getvalue()


def shapes_of_npz():
    """Shapes beyond the data."""
    for size in [*SIZES, 2**40, 2**61]:
        for shape in (f"({size},)", f"({size}, {size})", f"(1, {size})"):
            content = npz_of([npy(shape, np.arange(8.0).tobytes())])
            yield functools.partial(bounded, f"NPZ of shape {shape}", "a.npz", content, commands_of("a.npz", SIGNALS))


def gz_of(head, part, count):
    """Text that is packed to next to nothing."""
    packer = zlib.compressobj(9, wbits=31)
    parts = [packer.compress(head), *(packer.compress(part) for _ in range(count)), packer.flush()]
    return b"".join(parts)


def late_stamp(hours):
    """3000 messages, the last one late: the time between them is not memory."""
    schema = record(SCHEMA, u16(1) + text("sensor_msgs/msg/JointState") + text("ros2msg") + text(JOINT_STATE))
    channel = record(CHANNEL, u16(1) + u16(1) + text(TOPIC) + text("cdr") + texts({}))
    _, u, y = recording()
    records = []
    for k in range(3000):
        stamp = 10**9 + 5_000_000 * k + (int(hours * 3600e9) if k == 2999 else 0)
        records.append(record(MESSAGE, u16(1) + u32(k) + u64(stamp, stamp) + cdr(stamp, y[k % 400], u[k % 400])))
    return mcap_of(schema, channel, *records)


def packed_chunks(count, size):
    """Chunks of zeros: each is unpacked to `size` bytes."""
    packed = zstandard.ZstdCompressor(19).compress(bytes(size))
    head = u64(0, 0) + u64(size) + u32(0) + text("zstd") + u64(len(packed))
    return mcap_of(*[record(CHUNK, head + packed)] * count)


def large_schema(size):
    line = b"bool a\n"
    return mcap_of(
        record(SCHEMA, u16(1) + text("a/msg/B") + text("ros2msg") + u32(size) + (line * (size // len(line) + 1))[:size]),
        record(CHANNEL, u16(1) + u16(1) + text(TOPIC) + text("cdr") + texts({})),
        record(MESSAGE, u16(1) + u32(0) + u64(1, 1) + b"\0\1\0\0" + bytes(64)),
    )


def rows_of_csv(count):
    return b"t,u,y\n" + b"".join(b"%d,0,0\n" % k for k in range(count))


def zst(content):
    return zstandard.ZstdCompressor(3).compress(content)


MIB = 1 << 20
# name: file, what makes it, signals
BOMBS = {
    "CSV of one line of 100 MB": ("a.csv", lambda: b"t,u,y\n" + b"1" * 10**8, SIGNALS),
    "CSV of 30 MB of commas": ("a.csv", lambda: b"t,u,y\n" + b"," * 3 * 10**7, SIGNALS),
    "CSV.gz of one line of 256 MiB": ("a.csv.gz", lambda: gz_of(b"t,u,y\n", b"1" * MIB, 256), SIGNALS),
    "CSV.gz of 2e8 rows": ("a.csv.gz", lambda: gz_of(b"t,u,y\n", b"0,0,0\n" * 10**5, 2000), SIGNALS),
    "CSV.zst of 256 MiB": ("a.csv.zst", lambda: zst(b"t,u,y\n" + b"1" * (256 * MIB)), SIGNALS),
    "NPZ of 1 GiB of zeros": ("a.npz", lambda: npz_of([npy(f"({44 * MIB},)", b""), *[bytes(MIB)] * 352]), SIGNALS),
    "MCAP with a stamp 11 h late": ("a.mcap", lambda: late_stamp(11), FIELDS),
    "MCAP with a stamp 36 h late": ("a.mcap", lambda: late_stamp(36), FIELDS),
    "MCAP of 4 chunks of 32 MiB": ("a.mcap", lambda: packed_chunks(4, 32 * MIB), FIELDS),
    "MCAP with a schema of 200 MB": ("a.mcap", lambda: large_schema(2 * 10**8), FIELDS),
    "MCAP.zst of 256 MiB": ("a.mcap.zst", lambda: zst(MAGIC + bytes(256 * MIB)), FIELDS),
    "result JSON of 10 MB of brackets": ("frf.json", lambda: b'{"format":"frfid-result","version":' + b"[" * 10**7, None),
    "description of 1 MB of brackets": ("x.toml", lambda: b"seed = " + b"[" * 10**6, None),
}
OTHER_COMMANDS = {"frf.json": [["export", "frf.json", "-o", "a.csv"]], "x.toml": [["check", "x.toml"]]}


def bomb(name):
    file, make, signals = BOMBS[name]
    return bounded(name, file, make(), OTHER_COMMANDS[file] if signals is None else commands_of(file, signals))


def loop(count=None, seed=1, n_workers=2):
    """Sizes in MCAP (`count` of them, or all) and shapes of NPZ; then the bombs, one at a time."""
    yield tallied("sizes in MCAP", sizes_in_mcap(count, seed), n_workers)
    yield tallied("shapes of NPZ", shapes_of_npz(), n_workers)
    yield tallied("bombs", [functools.partial(bomb, name) for name in BOMBS], 1)
