"""JSON Schemas of `frfid schema`, checked by jsonschema: valid drafts 2020-12, and what is shipped validates."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

FRFID = shutil.which("frfid")
ROOT = Path(__file__).parents[2]
pytestmark = [
    pytest.mark.skipif(FRFID is None, reason="needs the command frfid: pip install ."),
    pytest.mark.skipif(sys.version_info < (3, 11), reason="needs tomllib: Python 3.11"),
]


def validator(name):
    jsonschema = pytest.importorskip("jsonschema", reason="needs jsonschema: pip install .[test]")
    schema = json.loads(subprocess.run([FRFID, "schema", name], check=True, capture_output=True).stdout)
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def toml(text):
    import tomllib

    return tomllib.loads(text)


def maps():
    """The log maps of the documents, by their place."""
    found = {}
    for page in sorted((ROOT / "docs").glob("*.md")):
        for number, block in enumerate(re.findall(r"```toml\n(.*?)```", page.read_text(), re.DOTALL)):
            if re.search(r"^u = \[", block, re.MULTILINE):
                found[f"{page.name}, block {number}"] = block
    return found


@pytest.mark.parametrize(("name", "folder"), [("experiment", "experiments"), ("robot", "robots")])
def test_examples(name, folder):
    check, files = validator(name), sorted((ROOT / "examples" / folder).glob("*.toml"))
    assert files
    for file in files:
        errors = [error.message for error in check.iter_errors(toml(file.read_text()))]
        assert not errors, f"{file.name}: {errors}"


def test_maps_of_the_documents():
    check, found = validator("map"), maps()
    assert found
    for place, text in found.items():
        errors = [error.message for error in check.iter_errors(toml(text))]
        assert not errors, f"{place}: {errors}"


@pytest.mark.parametrize(
    ("name", "text"),
    [("experiment", "sead = 1"), ("robot", 'file = "other.toml"'), ("robot", "[single_joint]\nmotor = 1"), ("map", "u = []"), ("map", "u = []\ny = []\nz = []")],
)
def test_what_is_not_read_does_not_validate(name, text):
    assert not validator(name).is_valid(toml(text))
