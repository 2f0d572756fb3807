"""Every call to the system fails once, and for good: no half file, no other number, and the same command does it afterwards.

`failing_call.c` stands between the program and libc. A refused allocation ends a Rust program by design (SIGABRT with a
message), as does a thread without memory for its stack; what is asked for then is that nothing wrong was left behind.
"""

import errno
import functools
import pathlib
import random
import shutil
import subprocess

from command import call, scratch
from judges import contents, half_files, misbehaviour, tallied
from materials import RUN, own_files

SOURCE = pathlib.Path(__file__).with_name("failing_call.c")
SHORT = 0  # half of the bytes, without an error
ERRORS = {
    "write": [errno.ENOSPC, errno.EIO, errno.EINTR, SHORT],
    "read": [errno.EIO, errno.EINTR, SHORT],
    "open64": [errno.EMFILE, errno.EACCES],
    "fsync": [errno.EIO],
    "rename": [errno.EACCES, errno.ENOSPC],
    "ftruncate64": [errno.EIO],
    "flock": [errno.ENOLCK, errno.EINTR],
    "mkdir": [errno.EACCES, errno.ENOSPC],
    "unlink": [errno.EACCES],
    "lseek64": [errno.EIO],
    "statx": [errno.EIO, errno.EACCES],
    "opendir": [errno.EMFILE],
    "readdir64": [errno.EIO],
    "realpath": [errno.EACCES],
    "mmap64": [errno.ENOMEM],
    "pthread_create": [errno.EAGAIN],
    "alloc": [errno.ENOMEM],
}
# how Rust and libc end; the second is a thread's
NO_MEMORY = (
    "memory allocation of",
    "failed to allocate an alternative stack",
    "Fatal glibc error: failed to register TLS destructor",
    "returned null pointer when creating new context",  # the library of zstd
)
HARMLESS = (errno.EINTR, SHORT)  # the program goes on as if nothing had been: once, as no system does it for good
COMMANDS = {
    "design": ["design", "x.toml", "-o", "new.mcap"],
    "run": ["run", "plan.mcap", "-o", "new"],
    "estimate": ["estimate", "logs", "-o", "new.json"],
    "recover": ["recover", f"logs/{RUN}", "-o", "new.mcap"],
    "export": ["export", "frf.json", "-o", "new.csv"],
}


def has_compiler():
    return shutil.which("cc") is not None


def library(folder):
    """The compiled library, below a folder."""
    path = pathlib.Path(folder) / "failing_call.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", path, SOURCE, "-ldl"], check=True)
    return path


class Loop:
    """The sound files once, and every command with a failing call in a copy of them."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.library = library(folder)
        self.own = self.folder / "own"
        self.own.mkdir()
        own_files(self.own)
        self.sound = {name: self.after(command) for name, command in COMMANDS.items()}

    def after(self, command):
        """All files after a sound command."""
        with self.laid() as folder:
            said = call(folder, *command)
            assert said.code == 0, said.text
            return contents(folder)

    def laid(self):
        place = scratch()
        shutil.copytree(self.own, place.name, dirs_exist_ok=True)
        return place

    def preloaded(self, name, at, **more):
        return {"LD_PRELOAD": str(self.library), "FAILING_CALL": name, "FAILING_AT": str(at), "FRFID_JOBS": "2", **more}

    def count(self, command, name):
        """How often a command makes a call."""
        with self.laid() as folder:
            path = self.folder / f"{command[0]}-{name}"
            call(folder, *command, env=self.preloaded(name, 0, FAILING_COUNT=str(path)))
            return int(path.read_text())

    def cases(self, name, calls=ERRORS, most=None, seed=1):
        """Of a command: every call, at most `most` of each, with every error, once and for good."""
        for failing in calls:
            places = range(1, self.count(COMMANDS[name], failing) + 1)
            if most is not None and most < len(places):
                places = sorted(random.Random(f"{seed} {name} {failing}").sample(places, most))
            for error in calls[failing]:
                for for_good in (False,) if error in HARMLESS else (False, True):
                    for at in places:
                        yield functools.partial(self.judge, name, failing, at, error, for_good)

    def judge(self, name, failing, at, error, for_good):
        command = COMMANDS[name]
        more = {"FAILING_ERRNO": str(error), **({"FAILING_FOR_GOOD": "1"} if for_good else {})}
        with self.laid() as folder:
            said = call(folder, *command, env=self.preloaded(failing, at, **more))
            fault = self.aborted(failing, said) or half_files_in(folder) or self.other(name, said, folder)
            end, again = self.again(name, folder)
        outcome = {0: "done", 3: "told", 1: "refused", 2: "refused"}.get(said.code, "aborted")
        kind = errno.errorcode.get(error, "half of the bytes")
        where = f"{name}, {failing} number {at}{' and later' if for_good else ''}: {kind}"
        asked = "memory" if failing in ("alloc", "mmap64") else "call"
        return [(f"{asked} {outcome}, {end}", (fault or again) and f"{where}: {fault or again}")]

    def aborted(self, failing, said):
        """What is no good end; memory may be refused with the message of Rust."""
        if failing in ("alloc", "mmap64") and not said.hung and any(words in said.text for words in NO_MEMORY):
            return None
        return misbehaviour(said)

    def other(self, name, said, folder):
        is_other = said.code == 0 and contents(folder) != self.sound[name]
        return "exit code 0, and not the files of a sound run" if is_other else None

    def again(self, name, folder):
        """The same command without a fault: how it went, and what is wrong at the end."""
        said, end = call(folder, *COMMANDS[name]), "then done"
        if said.code in (1, 2) and "--force" in said.text:
            said, end = call(folder, *COMMANDS[name], "--force"), "then done with --force"
        if said.code != 0:
            return "then refused", f"the same command afterwards: {said.text.strip()[-300:]}"
        left = [name for name in contents(folder, parts=True) if name.endswith(".part")]
        if contents(folder) != self.sound[name] or left:
            return end, f"other files at the end; left: {left}"
        return end, None


def half_files_in(folder):
    halves = half_files(folder)
    return f"half files: {halves}" if halves else None


def loop(name, calls=ERRORS, most=None, seed=1, n_workers=2):
    """The loop over one command."""
    with scratch() as folder:
        return tallied(f"failing calls in {name}", Loop(folder).cases(name, calls, most, seed), n_workers)
