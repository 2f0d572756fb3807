"""Behaviour of the command line on a small set of descriptions: the same bytes on any number of jobs, and what small.json has."""

import json
import math
import re
import shutil
from pathlib import Path

import pytest
from golden import GOLDEN, summary
from record import record

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+\.?\d*(?:e[-+]?\d+)?(?![\w.])")


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    binary = shutil.which("frfid")
    if binary is None:
        pytest.skip("the command frfid is not installed: pip install .")
    folder = tmp_path_factory.mktemp("behaviour") / "small"
    record(Path(binary), folder, small=True, demo=False)
    return folder


def test_runs_are_the_same_bytes_on_one_and_on_four_jobs(recorded):
    for hashes in recorded.glob("*/hashes.json"):
        logs = json.loads(hashes.read_text())
        for name in (name for name in logs if name.startswith("logs/")):
            assert logs[name] == logs[name.replace("logs/", "logs4/")], f"{hashes.parent.name}: {name}"


def test_what_is_said_and_found_is_what_it_was(recorded):
    golden, found = json.loads(GOLDEN.read_text()), summary(recorded)
    assert golden.keys() == found.keys()
    for name, case in golden.items():
        assert len(case["said"]) == len(found[name]["said"])
        for was, now in zip(case["said"], found[name]["said"]):
            assert was["command"] == list(now["command"]) and was["exit"] == now["exit"], f"{name}: {now}"
            for stream in ("stdout", "stderr"):
                same_text(was[stream], now[stream], f"{name}: {' '.join(was['command'])}")
        assert case["results"].keys() == found[name]["results"].keys()
        for file, arrays in case["results"].items():
            for array, numbers in arrays.items():
                same_numbers(numbers, found[name]["results"][file][array], f"{name}/{file} {array}")


def same_text(was, now, where):
    """The same words; numbers to 1e-3, since the last digit that is printed may round either way; hashes differ with versions."""
    hashes = re.compile(r"\b[0-9a-f]{64}\b")
    was, now = hashes.sub("HASH", was), hashes.sub("HASH", now)
    assert NUMBER.sub("#", was) == NUMBER.sub("#", now), f"{where}\n{was}\n--- is now\n{now}"
    same_numbers([float(x) for x in NUMBER.findall(was)], [float(x) for x in NUMBER.findall(now)], where, 1e-3)


def same_numbers(was, now, where, relative=1e-7):
    """Equal but for rounding, measured by the largest of the array where some are tiny."""
    assert len(was) == len(now), where
    known = [number for number in was if isinstance(number, float) and math.isfinite(number)]
    floor = relative * 1e-6 * max(map(abs, known), default=0.0)
    for a, b in zip(was, now):
        is_same = a == b or (None not in (a, b) and abs(float(a) - float(b)) <= max(relative * abs(float(a)), floor))
        assert is_same, f"{where}: {a} is now {b}"
