"""What is asked of every call, whatever was done to it: it ends by itself, with a code of its own, and no number is silently another."""

import contextlib
import itertools
import json
import pathlib
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

CODES = (0, 1, 2, 3)  # docs/command-line.md; 130 only after a signal
NUMBERS = ("frequency_hz", "response", "noise", "total", "condition")


def misbehaviour(said, codes=CODES):
    """Why a call is not one that ended well; None where it is."""
    if said.hung:
        return f"was not done after {said.seconds:.0f} s"
    if "panicked at" in said.text:
        return f"panicked: {said.text.strip()[:300]}"
    if said.code < 0:
        return f"was ended by signal {-said.code}: {said.text.strip()[-300:]}"
    if said.code not in codes:
        return f"exit code {said.code}: {said.first_line}"
    return None


def numbers(path):
    """What a result says of the machine."""
    result = json.loads(pathlib.Path(path).read_text())
    return {key: result.get(key) for key in NUMBERS}


def half_files(place):
    """What a reader might take for an output, a file or those below a folder: every JSON and every MCAP is whole or not there."""
    place = pathlib.Path(place)
    files = [path for path in [place, *place.rglob("*")] if path.is_file() and path.suffix in (".json", ".mcap")]
    return [path.name for path in files if not is_whole(path)]


def is_whole(path):
    if path.suffix == ".mcap":
        return path.read_bytes().endswith(b"\x89MCAP0\r\n")
    with contextlib.suppress(ValueError):
        return bool(json.loads(path.read_text()))
    return False


def contents(folder, parts=False):
    """Every file below a folder, by its path there; with or without those that are not done yet."""
    folder = pathlib.Path(folder)
    files = [path for path in sorted(folder.rglob("*")) if path.is_file() and (parts or path.suffix != ".part")]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


@dataclass
class Tally:
    """How many cases of a loop ended how, and each that should not have."""

    name: str
    counts: Counter = field(default_factory=Counter)
    faults: list = field(default_factory=list)

    def add(self, outcome, fault=None):
        self.counts[outcome] += 1
        if fault:
            self.faults.append(f"{self.name}: {fault}")

    @property
    def cases(self):
        return sum(self.counts.values())

    def __str__(self):
        parts = ", ".join(f"{count} {outcome}" for outcome, count in sorted(self.counts.items()))
        return f"{self.name}: {self.cases} cases: {parts}; {len(self.faults)} faults"


def tallied(name, cases, n_workers=2):
    """Does every case, a function that gives a list of (outcome, fault or None), side by side."""
    tally, cases = Tally(name), iter(cases)
    with ThreadPoolExecutor(n_workers) as pool:
        while some := list(itertools.islice(cases, 100)):  # not all at once: each case may hold its file
            for outcome, fault in itertools.chain(*pool.map(lambda case: case(), some)):
                tally.add(outcome, fault)
    return tally
