"""The work that is timed beside other packages: answers agree at small sizes, and the documents have a place for its tables."""

import importlib.util
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BENCH = ROOT / "benches" / "peers"


def names():
    spec = importlib.util.spec_from_file_location("workloads_of_the_bench", BENCH / "workloads.py")
    spec.loader.exec_module(module := importlib.util.module_from_spec(spec))
    return module.NAMES


@pytest.mark.parametrize("name", names())
def test_answers_agree(name):
    done = subprocess.run([sys.executable, BENCH, "--here", "--check", "--only", name], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    left_out = "; ".join(line for line in lines if line.startswith("LEFT OUT"))
    if not any(line.startswith("  ") for line in lines[2:]):
        pytest.skip(left_out)
    if left_out:
        warnings.warn(left_out)


def test_an_answer_that_differs_ends_the_bench():
    differs = "from case import Case; Case('work', 'unit', 1, lambda: 1.0, 'numpy', 'peer', lambda: 1.1, 0.05).agreed()"
    done = subprocess.run([sys.executable, "-c", differs], cwd=BENCH, capture_output=True, text=True)
    assert done.returncode == 1 and "work, peer: answers differ by 9.1e-02, allowed are 5e-02" in done.stderr


@pytest.mark.parametrize("document, name", [("README.md", "peers"), ("docs/performance.md", "peers"), ("docs/performance.md", "instructions")])
def test_the_documents_have_a_place_for_the_tables(document, name):
    text = (ROOT / document).read_text()
    begin, end = text.index(f"<!-- {name}: begin -->\n"), text.index(f"<!-- {name}: end -->")
    assert begin < end and text.count(f"<!-- {name}: ") == 2
