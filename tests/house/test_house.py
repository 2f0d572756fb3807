"""The house stays one to add to: lengths, rooms without circles, and documents whose paths exist."""

import re
import statistics
from pathlib import Path

import pytest
from measure import ROOT, circles, crate_sources, full_folders, functions, n_lines, sources

FILES = [file for source in crate_sources() for file in sources(source)]
NAMES = [str(file.relative_to(ROOT)) for file in FILES]


def test_functions_read_at_a_glance():
    ours = [function for file in FILES for function in functions(file)]
    long = [f"{function.file.relative_to(ROOT)}: {function.name}, {function.n_lines} lines" for function in ours if function.n_lines > 40 and not function.has_reason]
    assert not long, "above 40 lines without a reason beside them"
    assert sum(function.n_lines > 40 for function in ours) <= 4, "a reason is an exception"
    sizes = sorted(function.n_tokens for function in ours)
    assert sizes[int(0.9 * len(sizes))] <= 220 and statistics.median(sizes) <= 70


def test_files_and_folders_are_short():
    assert not [name for name, file in zip(NAMES, FILES) if n_lines(file) > 300]
    assert not [str(folder) for folder, count in full_folders() if count > 15]


@pytest.mark.parametrize("source", crate_sources(), ids=lambda source: source.parent.name)
def test_rooms_form_no_circle(source):
    assert circles(source) == []


@pytest.mark.parametrize("file", FILES, ids=NAMES)
def test_a_file_says_what_it_is(file):
    first = file.read_text().splitlines()[0]
    assert first.startswith("//! ") and not re.match(r"//! (What|How|Where|Which|Puts|Does|Makes|Takes) ", first), first


def documents():
    return [ROOT / name for name in ("ARCHITECTURE.md", "CONTRIBUTING.md", "README.md", "docs/theory.md", "docs/how-to.md", "docs/formats.md")]


@pytest.mark.parametrize("document", documents(), ids=lambda document: document.name)
def test_every_path_named_exists(document):
    """Paths from the root; in theory.md below a heading that names a crate, from its src."""
    base = ROOT
    for line in document.read_text().splitlines():
        if heading := re.match(r"## .*`(crates/\w+)`", line):
            base = ROOT / heading[1] / "src"
        for path in re.findall(r"`([\w./-]+\.(?:rs|py|pyi|sh|toml|md))`", line):
            if path.startswith(("crates/", "python/", "tests/", "benches/", "examples/", "docs/")) or path.endswith(".rs"):
                assert (base / path).exists() or (ROOT / path).exists(), f"{document.name}: {path}"


def test_the_map_names_rooms_that_exist():
    """In the map of ARCHITECTURE.md: crates at the margin, below each its rooms and files."""
    blocks = (ROOT / "ARCHITECTURE.md").read_text().split("```")
    source = None
    for line in blocks[1].splitlines():
        if crate := re.match(r"(crates/\w+|python/src)", line):
            source = ROOT / crate[1] / ("src" if crate[1].startswith("crates") else "")
        for name in re.findall(r"\b(\w+/|\w+\.rs)(?=[\s;]|$)", line.partition("   ")[0] if line.startswith("  ") else ""):
            assert (source / name).exists(), f"{source.relative_to(ROOT)} has no {name}"
