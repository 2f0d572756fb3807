"""Documents as programs: the fenced blocks of a Markdown file, done one after the other in one folder.

    sh        every command must end with 0, or with what its comment says: `# ... exit code 3 ...`
    toml      written where a comment above the block says so: `<!-- file: joint.toml -->`; with `from multisine.toml` as a copy
              of that file in which these keys are set
    python    run, or only written where a comment names a file; a line that shows what it prints or is, `# (71, 1, 1)`, must
    text      every line must have been printed by a command before it, as must `every  inline code` with two spaces in a row

A block below `<!-- not run: REASON -->` is skipped. Numbers are compared to the digits that the document gives.
"""

import ast
import contextlib
import io
import os
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


@dataclass
class Block:
    language: str
    text: str
    line: int
    directive: str


def blocks(path):
    """The fenced blocks of a document, with the comment `<!-- ... -->` right above each; inline outputs as blocks of text."""
    found, directive, fence = [], "", None
    for number, line in enumerate(path.read_text().splitlines(), 1):
        start = re.match(r"( *)```(\w*)", line)
        if fence is not None and line.strip() == "```":
            found.append(Block(fence.language, "\n".join(inside), fence.line, fence.directive))
            fence, directive = None, ""
        elif fence is not None:
            inside.append(line.removeprefix(indent))
        elif start:
            indent, fence, inside = start[1], Block(start[2], "", number, directive), []
        elif comment := re.fullmatch(r"\s*<!-- (.*) -->", line):
            directive = comment[1]
        elif line.strip():
            directive = ""
            found += [Block("text", code, number, "") for code in re.findall(r"`([^`]*\S  +\S[^`]*)`", line)]
    assert fence is None, f"{path}: the block of line {fence.line} does not end"
    return found


def same(expected, printed):
    """Whether a line holds the expected text, numbers to the digits that are expected."""
    words = [re.split(NUMBER, " ".join(text.split())) for text in (expected, printed)]
    numbers = [NUMBER.findall(text) for text in (expected, printed)]
    for start in range(len(numbers[1]) - len(numbers[0]) + 1):
        inside = numbers[1][start : start + len(numbers[0])]
        between = words[1][start : start + len(numbers[0]) + 1]
        ends = between[0].endswith(words[0][0]) and between[-1].startswith(words[0][-1])
        if len(words[0]) == 1:
            ends = words[0][0] in " ".join(printed.split())
        if ends and between[1:-1] == words[0][1:-1] and all(map(equal, numbers[0], inside)):
            return True
    return False


def equal(expected, found):
    """Whether a number is the expected one to the digits that are given."""
    mantissa, _, exponent = expected.lower().partition("e")
    digits = len(mantissa.partition(".")[2])
    half_a_digit = 0.5000001 * 10.0 ** (int(exponent or 0) - digits)
    return abs(float(expected) - float(found)) <= half_a_digit


def set_keys(base, changes):
    """The text of a TOML file with the keys of another one set in their tables."""
    lines, table = base.splitlines(), ""
    for change in changes.splitlines():
        if header := re.match(r"\[.*?\]", change):
            table = header[0]
        elif key := re.match(r"\w+ *=", change):
            at = next((k for k, line in enumerate(lines) if line.startswith(table)), None)
            if at is None:
                lines += ["", table]
                at = len(lines) - 1
            end = next((k for k in range(at + 1, len(lines)) if lines[k].startswith("[")), len(lines))
            while not lines[end - 1].strip():
                end -= 1
            name = key[0].split("=")[0].strip()
            old = [k for k in range(at + 1, end) if re.match(rf"{name} *=", lines[k])]
            lines[old[0] if old else end : old[0] + 1 if old else end] = [change]
    return "\n".join(lines) + "\n"


class Reader:
    """Does what a document says, in one folder."""

    def __init__(self, folder):
        self.folder, self.printed = folder, []
        folder.mkdir()
        os.symlink(ROOT / "examples", folder / "examples")
        if (shared := ROOT.parent / "shared").exists():
            os.symlink(shared, folder.parent / "shared")

    def follow(self, path):
        self.names = {"__name__": "__main__"}  # what a document has defined, it may use again
        for block in blocks(path):
            where = f"{path.name}:{block.line}"
            if block.directive.startswith("not run: "):
                continue
            if "../shared" in block.text and not (self.folder.parent / "shared").exists():
                print(f"SKIPPED: {where}, ../shared is not here")
                continue
            file = re.fullmatch(r"file: (\S+?)(?:, from (\S+))?", block.directive)
            if file:
                base = file[2] and (self.folder / file[2]).read_text()
                (self.folder / file[1]).write_text(set_keys(base, block.text) if base else block.text + "\n")
            elif block.language in ("sh", "python", "text"):
                getattr(self, block.language)(block.text, where)
            else:
                assert block.language in ("toml", "matlab", "rust"), f"{where}: what is a block of `{block.language}`?"

    def sh(self, text, where):
        for command in re.sub(r"\\\n\s*", "", text).splitlines():
            done = subprocess.run(command, shell=True, cwd=self.folder, capture_output=True, text=True, timeout=600)
            code = re.search(r"#.*exit code (\d+)", command)
            assert done.returncode == int(code[1] if code else 0), f"{where}: {command}\n{done.stdout}{done.stderr}"
            self.printed += (done.stdout + done.stderr).splitlines()
            if shown := re.search(r"[|].*# +(\d+)$", command):
                assert done.stdout.strip() == shown[1], f"{where}: {done.stdout}"

    def python(self, text, where):
        lines = text.splitlines()
        with inside(self.folder):
            for statement in ast.parse(text).body:
                printed = io.StringIO()
                code = "\n" * (statement.lineno - 1) + "\n".join(lines[statement.lineno - 1 : statement.end_lineno])
                with contextlib.redirect_stdout(printed):
                    if isinstance(statement, ast.Expr):
                        value = eval(compile(ast.Expression(statement.value), where, "eval"), self.names)
                        shown = printed.getvalue() if value is None else repr(value)
                    else:
                        exec(compile(code, where, "exec"), self.names)
                        shown = printed.getvalue()
                self.printed += shown.splitlines()
                self.compare(lines[statement.lineno - 1 : statement.end_lineno], shown, where)

    def compare(self, lines, shown, where):
        """A comment behind what prints, or is, something says what: up to a colon and words."""
        comment = re.search(r"  # (.*)", lines[-1].strip())
        if comment and re.match(r"[-\d\[('\"]|True|False|None", comment[1]) and shown:
            expected = re.sub(r"(?<=[\w\])]): [a-z(].*", "", comment[1]).rstrip(":")
            assert same(expected, " ".join(shown.split())), f"{where}: {comment[1]}\nis {shown}"

    def text(self, text, where):
        for line in text.splitlines():
            if line.strip():
                is_there = any(same(line, printed) for printed in self.printed)
                near = [printed for printed in self.printed if printed.split()[:1] == line.split()[:1]]
                assert is_there, f"{where}: nothing printed\n{line}\nbut\n" + "\n".join(near[-5:])


@contextlib.contextmanager
def inside(folder):
    before = os.getcwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def needs_frfid():
    if shutil.which("frfid") is None:
        pytest.skip("the command frfid is not installed: pip install .")
