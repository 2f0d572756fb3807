"""The 416 files of the conformance suite of MCAP, made anew: six contents in every layout that the format leaves open.

What is in them, and in which order, is that of `tests/conformance` of github.com/foxglove/mcap at 95d0673; the writer is ours.
`conformance.sha256` holds the sums of upstream's files, as the pointers of its Git LFS state them.
"""

import itertools
import pathlib
import struct
import zlib

SUMS = pathlib.Path(__file__).with_name("conformance.sha256")
MAGIC = b"\x89MCAP0\r\n"
PADDING = b"\x01\xff\xff"  # what a later version might append to a record

SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = 3, 4, 5, 6, 7, 8
ATTACHMENT, ATTACHMENT_INDEX, STATISTICS, METADATA, METADATA_INDEX, SUMMARY_OFFSET = 9, 10, 11, 12, 13, 14
HEADER, FOOTER, DATA_END = 1, 2, 15
FIXED = (MESSAGE, CHUNK, FOOTER, DATA_END)  # never padded


def u16(value):
    return struct.pack("<H", value)


def u32(value):
    return struct.pack("<I", value)


def u64(*values):
    return struct.pack(f"<{len(values)}Q", *values)


def text(value):
    return u32(len(value)) + value.encode()


def table(pairs):
    """A list of pairs with its length in bytes."""
    body = b"".join(key + value for key, value in pairs)
    return u32(len(body)) + body


def texts(values):
    return table([(text(key), text(value)) for key, value in values.items()])


def record(opcode, body, pad=False):
    body += PADDING if pad and opcode not in FIXED else b""
    return bytes([opcode]) + u64(len(body)) + body


def schema(number, name, encoding, data):
    return SCHEMA, u16(number) + text(name) + text(encoding) + u32(len(data)) + data


def channel(number, of_schema, topic, encoding, metadata):
    return CHANNEL, u16(number) + u16(of_schema) + text(topic) + text(encoding) + texts(metadata)


def message(log_time, publish_time, sequence, data=b"\x01\x02\x03"):
    return MESSAGE, u16(1) + u32(sequence) + u64(log_time, publish_time) + data


def attachment(log_time, create_time, name, media_type, data):
    body = u64(log_time, create_time) + text(name) + text(media_type) + u64(len(data)) + data
    return ATTACHMENT, body + u32(zlib.crc32(body))


EXAMPLE = [schema(1, "Example", "c", b"\x04\x05\x06"), channel(1, 1, "example", "a", {"foo": "bar"})]
TEN = [message(time, time, sequence) for sequence, time in enumerate([0, 2, 1, 3, 3, 5, 4, 7, 8, 9])]
CONTENTS = {
    "NoData": [],
    "OneSchemalessMessage": [channel(1, 0, "example", "text", {}), message(2, 1, 10)],
    "OneMessage": [*EXAMPLE, message(2, 1, 10)],
    "OneAttachment": [attachment(2, 1, "myFile", "application/octet-stream", b"\x01\x02\x03")],
    "OneMetadata": [(METADATA, text("myMetadata") + texts({"foo": "bar"}))],
    "TenMessages": [*EXAMPLE, *TEN],
}
FEATURES = ["ax", "ch", "chx", "mdx", "mx", "pad", "rch", "rsh", "st", "sum"]
NEEDS = {"ax": ATTACHMENT, "mdx": METADATA, "rsh": SCHEMA, "rch": CHANNEL}  # of the content
IN_CHUNKS = (SCHEMA, CHANNEL, MESSAGE)


def makes_sense(features, content):
    """Whether a layout is one of the suite's: an index of what is there, offsets of groups that are there."""
    kinds = {kind for kind, _ in content}
    without = [feature for feature, kind in NEEDS.items() if feature in features and kind not in kinds]
    chunked = features & {"ch", "chx", "mx"}
    summary = features & {"chx", "rsh", "rch", "mdx", "ax", "st"}
    return not (
        without or (chunked and not kinds & set(IN_CHUNKS)) or (chunked and "ch" not in features) or ("sum" in features and not summary)
    )


def variations():
    """Name and bytes of each file."""
    for name, content in CONTENTS.items():
        for flags in itertools.product([False, True], repeat=len(FEATURES)):
            features = {feature for feature, flag in zip(FEATURES, flags) if flag}
            if makes_sense(features, content):
                yield "-".join([name, *sorted(features)]), whole_file(features, content)


def whole_file(features, content):
    pad = "pad" in features
    data = MAGIC + record(HEADER, text("") + text(""), pad)
    groups = {SCHEMA: b"", CHANNEL: b"", STATISTICS: b"", METADATA_INDEX: b"", ATTACHMENT_INDEX: b"", CHUNK_INDEX: b""}
    chunk = [entry for entry in content if "ch" in features and entry[0] in IN_CHUNKS]
    for kind, body in [entry for entry in content if entry not in chunk]:
        packed = record(kind, body, pad)
        if kind == ATTACHMENT and "ax" in features:
            times, names = body[:16], body[16:-15]
            groups[ATTACHMENT_INDEX] += record(ATTACHMENT_INDEX, u64(len(data), len(packed)) + times + u64(3) + names, pad)
        if kind == METADATA and "mdx" in features:
            groups[METADATA_INDEX] += record(METADATA_INDEX, u64(len(data), len(packed)) + text("myMetadata"), pad)
        data += packed
    if "ch" in features:
        packed, index = chunk_with_index(features, chunk, len(data), pad)
        data, groups[CHUNK_INDEX] = data + packed, index
    for feature, kind in (("rsh", SCHEMA), ("rch", CHANNEL)):
        groups[kind] = b"".join(record(*entry, pad) for entry in content if entry[0] == kind and feature in features)
    groups[STATISTICS] = record(STATISTICS, statistics(features, content), pad) if "st" in features else b""
    data += record(DATA_END, u32(zlib.crc32(data)))
    return data + summary(groups, len(data), "sum" in features, pad) + MAGIC


def chunk_with_index(features, content, offset, pad):
    """A chunk, its message index behind it, and its chunk index for the summary."""
    records, places = b"", []
    for kind, body in content:
        if kind == MESSAGE:
            places.append((struct.unpack_from("<Q", body, 6)[0], len(records)))
        records += record(kind, body)
    times = [time for time, _ in places]
    span = u64(min(times, default=0), max(times, default=0))
    packed = record(CHUNK, span + u64(len(records)) + u32(zlib.crc32(records)) + text("") + u64(len(records)) + records)
    index, offsets = b"", table([])
    if "mx" in features:
        index = record(MESSAGE_INDEX, u16(1) + table([(u64(time), u64(place)) for time, place in places]), pad)
        offsets = table([(u16(1), u64(offset + len(packed)))])
    body = span + u64(offset, len(packed)) + offsets + u64(len(index)) + text("") + u64(len(records), len(records))
    return packed + index, record(CHUNK_INDEX, body, pad) if "chx" in features else b""


def statistics(features, content):
    count = {kind: sum(entry[0] == kind for entry in content) for kind in (SCHEMA, CHANNEL, MESSAGE, ATTACHMENT, METADATA)}
    times = [struct.unpack_from("<Q", body, 6)[0] for kind, body in content if kind == MESSAGE]
    per_channel = table([(u16(1), u64(len(times)))] if times else [])
    numbers = struct.pack("<QHIIII", count[MESSAGE], count[SCHEMA], count[CHANNEL], count[ATTACHMENT], count[METADATA], "ch" in features)
    return numbers + u64(min(times, default=0), max(times, default=0)) + per_channel


def summary(groups, start, with_offsets, pad):
    """The summary section and the footer."""
    body, offsets = b"", b""
    for kind, group in groups.items():
        if group:
            offsets += record(SUMMARY_OFFSET, bytes([kind]) + u64(start + len(body), len(group)), pad)
        body += group
    offset_start = start + len(body) if with_offsets else 0
    body, start = body + (offsets if with_offsets else b""), start if body else 0
    footer = bytes([FOOTER]) + u64(20, start, offset_start)
    return body + footer + u32(zlib.crc32(body + footer))


def upstream_sums():
    """SHA-256 of every file, by its name."""
    lines = [line.split() for line in SUMS.read_text().splitlines() if not line.startswith("#")]
    return {name: total for total, name in lines}
