"""Each file of MCAP's conformance suite through the commands: looked at, estimated, recovered with everything that was in it."""

import functools
import io
import pathlib
import random

from command import call, scratch
from conformance import variations
from judges import misbehaviour, tallied
from materials import FIELDS
from mcap.records import Attachment, Channel, Message, Metadata, Schema
from mcap.stream_reader import StreamReader

COMMANDS = [["inspect", "a.mcap"], ["estimate", "a.mcap", *FIELDS, "-o", "frf.json"], ["recover", "a.mcap", "-o", "again.mcap"]]


def everything(content):
    """All that an MCAP holds, without the numbers by which its records refer to each other, as mcap's own reader gives it."""
    schemas, channels, found = {0: None}, {}, []
    for entry in StreamReader(io.BytesIO(content), validate_crcs=True).records:
        if isinstance(entry, Schema):
            schemas[entry.id] = (entry.name, entry.encoding, entry.data)
        elif isinstance(entry, Channel):
            channels[entry.id] = (entry.topic, entry.message_encoding, tuple(entry.metadata.items()), schemas[entry.schema_id])
        elif isinstance(entry, Message):
            found.append((channels[entry.channel_id], entry.sequence, entry.log_time, entry.publish_time, entry.data))
        elif isinstance(entry, Attachment):
            found.append((entry.name, entry.media_type, entry.log_time, entry.create_time, entry.data))
        elif isinstance(entry, Metadata):
            found.append((entry.name, tuple(entry.metadata.items())))
    return found


def judge(name, content):
    """One file through every command: a list of (outcome, fault or None)."""
    judged = []
    with scratch() as folder:
        folder = pathlib.Path(folder)
        (folder / "a.mcap").write_bytes(content)
        for command in COMMANDS:
            said = call(folder, *command)
            fault = misbehaviour(said)
            if command[0] == "recover" and not fault:
                fault = lost(said, folder / "again.mcap", content)
            judged.append((f"{command[0]} {'done' if said.code in (0, 3) else 'refused'}", fault and f"{name}, {command[0]}: {fault}"))
    return judged


def lost(said, recovered, content):
    if said.code != 0:
        return f"exit code {said.code} of a sound file: {said.first_line}"
    if everything(recovered.read_bytes()) != everything(content):
        return "what was recovered is not what was there"
    return None


def loop(count=None, seed=1, n_workers=2):
    files = list(variations())
    if count is not None:
        files = random.Random(seed).sample(files, count)
    return tallied("conformance files", [functools.partial(judge, name, content) for name, content in files], n_workers)
