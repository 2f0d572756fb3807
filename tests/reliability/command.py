"""The command frfid as a child: how it ended, what it said, how long it took and how much memory."""

import contextlib
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import tempfile
import threading
import time
from dataclasses import dataclass

ROOT = pathlib.Path(__file__).resolve().parents[2]


def program():
    """The command as Rust builds it: FRFID, else the newest in target/, else the installed one; not the wheel's, which starts a Python."""
    built = [ROOT / "target" / profile / "frfid" for profile in ("debug", "release")]
    built = sorted((path for path in built if path.exists()), key=lambda path: path.stat().st_mtime, reverse=True)
    for path in [os.environ.get("FRFID"), *built, shutil.which("frfid")]:
        if path and pathlib.Path(path).read_bytes()[:2] != b"#!":
            return str(path)
    return None


FRFID = program()
# a command that takes longer hangs; one that is built for debugging takes some times as long as that of a release
LONGEST_S = 40 if "/debug/" in (FRFID or "") else 10
NEEDS = "needs the command frfid as Rust builds it: cargo build, or its path in FRFID"


@dataclass
class Said:
    """How a call ended; a negative code is the signal that ended it."""

    code: int
    text: str
    seconds: float
    peak_bytes: int  # at least what Python took when it started the child
    hung: bool

    @property
    def first_line(self):
        return self.text.strip().partition("\n")[0][:200]


def call(folder, *arguments, env=None, memory=None, seconds=LONGEST_S, kill=None):
    """`frfid ARGUMENTS` in a folder; `memory` bounds its address space, `kill` is (signal, seconds) after the start."""
    limit = (lambda: resource.setrlimit(resource.RLIMIT_AS, (memory, memory))) if memory else None
    with tempfile.TemporaryFile() as told:
        begin = time.monotonic()
        child = subprocess.Popen(
            [FRFID, *map(str, arguments)],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=told,
            stderr=told,
            env={**os.environ, **(env or {})},
            preexec_fn=limit,
        )
        hung = threading.Event()
        timers = [threading.Timer(seconds, end_hung, [child, hung])]
        timers += [threading.Timer(kill[1], send, [child, kill[0]])] if kill else []
        for timer in timers:
            timer.start()
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        for timer in timers:
            timer.cancel()
        took = time.monotonic() - begin
        told.seek(0)
        text = told.read().decode(errors="replace")
    return Said(child.returncode, text, took, 1024 * usage.ru_maxrss, hung.is_set())


def send(child, number):
    with contextlib.suppress(ProcessLookupError):
        if child.returncode is None:
            os.kill(child.pid, number)


def end_hung(child, hung):
    hung.set()
    send(child, signal.SIGKILL)


def scratch():
    """A temporary folder, in memory where there is one: outputs are synced."""
    shared = pathlib.Path("/dev/shm")
    return tempfile.TemporaryDirectory(dir=shared if os.access(shared, os.W_OK) else None)
