"""README, tutorial, how-to and the pages of machines and of measured records do what they say: their commands are run and what they print is compared."""

import os

import pytest
from documents import ROOT, Reader, equal, needs_frfid, same, set_keys


def test_numbers_are_compared_to_the_digits_given():
    assert equal("0.05", "0.0476") and not equal("0.05", "0.056") and equal("3e-11", "2.9e-11")
    assert same("axis 1 travel  3.395 rad", "  axis 1 travel   3.3952 rad      -")
    assert not same("axis 1 travel  3.395 rad", "  axis 1 travel   3.3962 rad")
    assert same("no numbers", "here are no  numbers") and not same("no numbers", "here is none")


def test_keys_are_set_in_their_tables():
    base = "seed = 1\n[a]\nx = 1\ny = 2\n[b]\nx = 3\n"
    assert set_keys(base, "[b]\nx = 4 # more\n[c]\nz = 5") == "seed = 1\n[a]\nx = 1\ny = 2\n[b]\nx = 4 # more\n\n[c]\nz = 5\n"
    assert set_keys(base, "[a]\nz = 0") == "seed = 1\n[a]\nx = 1\ny = 2\nz = 0\n[b]\nx = 3\n"


def test_the_readme(tmp_path):
    needs_frfid()
    Reader(tmp_path / "work").follow(ROOT / "README.md")


def test_tutorial_and_how_to(tmp_path):
    needs_frfid()
    reader = Reader(tmp_path / "work")
    reader.follow(ROOT / "docs" / "tutorial.md")
    reader.follow(ROOT / "docs" / "how-to.md")


def test_machines(tmp_path):
    needs_frfid()
    pytest.importorskip("tomllib", reason="the arm in MuJoCo is read with Python 3.11's tomllib")
    for module in ("mujoco", "scipy", "mcap", "rosbags"):
        pytest.importorskip(module, reason="the arm in MuJoCo records bags: pip install mujoco scipy mcap rosbags")
    Reader(tmp_path / "work").follow(ROOT / "docs" / "machines.md")


def test_measured_records(tmp_path):
    needs_frfid()
    reader = Reader(tmp_path / "work")
    data = ROOT.parent / "shared" / "data"
    if not data.exists():
        print(f"SKIPPED: {data} is missing")
        pytest.skip(f"{data} is missing")
    os.symlink(data, reader.folder / "records")
    reader.follow(ROOT / "docs" / "records.md")
