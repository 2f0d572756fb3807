"""The motor bench for tests of formats: five periods of it, and its FRF from a plain CSV."""

import gzip
import json
import pathlib
import shutil
import subprocess

import numpy as np
import pytest

FRFID = shutil.which("frfid")
BENCH = pathlib.Path(__file__).parents[3] / "shared" / "data" / "motor_bench" / "multisine_type_a.csv.gz"
MARKS = [
    pytest.mark.skipif(FRFID is None, reason="needs the command frfid: pip install ."),
    pytest.mark.skipif(not BENCH.exists(), reason=f"{BENCH} is missing"),
]


def samples():
    """Rows of time in s, reference, current in A, motor velocity in rad/s, ..."""
    with gzip.open(BENCH, "rt") as file:
        table = np.loadtxt(file, delimiter=",", skiprows=1)
    return table[:12_500]


def estimate(file, u, y, *options):
    """The response, and what was said."""
    result = file.parent / "frf.json"
    arguments = [FRFID, "estimate", str(file), "-o", str(result), "--u", f"{u}=A", "--y", f"{y}=rad/s", "--force", "--quiet", *options]
    done = subprocess.run(arguments, capture_output=True, text=True)
    assert done.returncode in (0, 3), done.stderr
    response = json.loads(result.read_text())["response"]
    return np.array(response["re"], float) + 1j * np.array(response["im"], float)


def from_csv(folder):
    rows = samples()
    np.savetxt(folder / "bench.csv", rows[:, [0, 2, 3]], delimiter=",", header="t,u,y", comments="", fmt="%.17g")
    return estimate(folder / "bench.csv", "u", "y", "--time", "t=s")
