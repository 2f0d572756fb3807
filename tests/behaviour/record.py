"""Behaviour of the binary, recorded and compared: every file, every word on stdout and stderr, every exit code.

    python tests/behaviour/record.py BINARY FOLDER [--small] [--demo]   record
    python tests/behaviour/record.py --compare FOLDER OTHER              byte by byte; exit 1 where they differ

Two recordings on one machine are equal to the last bit unless behaviour has changed. Across machines floating-point
functions may round differently, so that the test of the small set compares numbers instead (test_behaviour.py).
"""

import argparse
import difflib
import hashlib
import json
import re
import subprocess
import sys
from pathlib import Path

from cases import CASES, REFUSED, REFUSED_SMALL, Case


class Recorder:
    """Runs the binary in a folder and notes what it says."""

    def __init__(self, binary: Path, folder: Path):
        self.binary, self.folder = binary, folder
        self.said: list[dict] = []

    def __call__(self, *arguments: str) -> str:
        done = subprocess.run([self.binary, *arguments], cwd=self.folder, capture_output=True, text=True, check=False)
        told = re.sub(r"^.*: \d+ of \d+ .*, \d+ s\n", "", done.stderr, flags=re.MULTILINE)  # progress
        told = re.sub(r"\b\d+ s$", "N s", told, flags=re.MULTILINE)  # how long it took
        said = {"command": arguments, "exit": done.returncode, "stdout": done.stdout, "stderr": told}
        self.said.append(said)
        return done.stdout

    def close(self):
        """Writes what was said, and shortens the logs to their hashes: they are large."""
        (self.folder / "said.json").write_text(json.dumps(self.said, indent=1) + "\n")
        hashes = {}
        for path in sorted(self.folder.rglob("*.mcap")):
            hashes[str(path.relative_to(self.folder))] = hashlib.sha256(path.read_bytes()).hexdigest()
        (self.folder / "hashes.json").write_text(json.dumps(hashes, indent=1) + "\n")


def replaced(text: str, replacements: list[tuple[str, str]]) -> str:
    for before, after in replacements:
        if before not in text:
            raise SystemExit(f"{before!r} is not in the template")
        text = text.replace(before, after)
    return text


def case(frfid: Recorder, case: Case):
    """One description from `init` to `export`, with one and with four jobs."""
    text = frfid("init", case.template)
    text = replaced(text, [("seed = 1\n", f"seed = {case.seed}\n"), *case.replacements])
    (frfid.folder / "x.toml").write_text(text)
    frfid("check", "x.toml")
    frfid("check", "x.toml", "--json")
    frfid("design", "x.toml", "--dry-run", "--json")
    frfid("design", "x.toml", "-o", "plan.mcap")
    frfid("run", "x.toml", "-o", "logs", "--jobs", "1")
    frfid("run", "x.toml", "-o", "logs4", "--jobs", "4", "--json")
    frfid("run", "plan.mcap", "-o", "logs", "--index", "0")
    frfid("estimate", "logs", "-o", "frf.json", "--report", "frf.html", "--jobs", "1")
    frfid("estimate", "logs4", "-o", "frf4.json", "--jobs", "4", "--json")
    for number, options in enumerate(case.estimates):
        frfid("estimate", "logs", "-o", f"other{number}.json", *options)
        frfid("compare", "frf.json", f"other{number}.json", "--json")
        frfid("compare", "frf.json", f"other{number}.json", "--stronger", "b")
    frfid("export", "frf.json", "--to", "csv", "-o", "frf.csv")
    frfid("export", "frf.json", "--to", "npz", "-o", "frf.npz")
    if case.shape:
        frfid("shape", "x.toml", "-o", "shaped", "--jobs", "1")
        frfid("shape", "x.toml", "-o", "shaped4", "--jobs", "4", "--json")
    first = sorted((frfid.folder / "logs").glob("*.mcap"))[0]
    cut = first.read_bytes()
    (frfid.folder / "cut.mcap").write_bytes(cut[: len(cut) // 2])
    frfid("recover", "cut.mcap", "-o", "whole.mcap")


def general(frfid: Recorder, small: bool):
    """Help, manual, completions, schema, and what is refused."""
    commands = "demo init check schema design run shape estimate compare export recover completions man".split()
    for command in commands:
        frfid(command, "--help")
    frfid("man")
    frfid("schema")
    frfid("completions", "bash")
    for name, (template, before, after) in REFUSED.items():
        if small and name not in REFUSED_SMALL:
            continue
        (frfid.folder / f"{name}.toml").write_text(replaced(frfid("init", template), [(before, after)]))
        frfid("check", f"{name}.toml")
        frfid("design", f"{name}.toml", "-o", f"{name}.mcap", "--jobs", "1")
        if template == "r3-chirp":
            frfid("shape", f"{name}.toml", "-o", name)


def record(binary: Path, folder: Path, small: bool, demo: bool):
    for one in CASES:
        if small and not one.small:
            continue
        print(one.name, flush=True)
        (folder / one.name).mkdir(parents=True)
        recorder = Recorder(binary, folder / one.name)
        case(recorder, one)
        recorder.close()
    (folder / "general").mkdir()
    recorder = Recorder(binary, folder / "general")
    general(recorder, small)
    recorder.close()
    if demo:
        (folder / "demo").mkdir()
        recorder = Recorder(binary, folder / "demo")
        recorder("demo", "-o", "demo")
        recorder.close()


def compare(folder: Path, other: Path) -> int:
    """Tells every file that differs, of texts the first lines; returns the number of files."""
    names = sorted({p.relative_to(f) for f in (folder, other) for p in f.rglob("*") if p.is_file()})
    different = 0
    for name in names:
        a, b = folder / name, other / name
        if not (a.exists() and b.exists()):
            print(f"{name}: only in {folder if a.exists() else other}")
        elif a.read_bytes() == b.read_bytes():
            continue
        else:
            print(f"{name}: differs")
            if name.suffix in (".json", ".csv", ".toml"):
                lines = difflib.unified_diff(a.read_text().splitlines(), b.read_text().splitlines(), lineterm="", n=0)
                for line in list(lines)[:12]:
                    print(f"    {line[:240]}")
        different += 1
    print(f"{len(names)} files, {different} differ")
    return different


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binary", type=Path, help="the binary, or with --compare a recording")
    parser.add_argument("folder", type=Path, help="a new folder, or another recording")
    parser.add_argument("--small", action="store_true", help="the cases of the test alone")
    parser.add_argument("--demo", action="store_true", help="the demo too")
    parser.add_argument("--compare", action="store_true")
    arguments = parser.parse_args()
    if arguments.compare:
        sys.exit(compare(arguments.binary, arguments.folder) > 0)
    record(arguments.binary.resolve(), arguments.folder, arguments.small, arguments.demo)


if __name__ == "__main__":
    main()
