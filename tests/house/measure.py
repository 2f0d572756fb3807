"""Figures of the house: how long functions and files are, how full folders, which rooms import each other.

    python tests/house/measure.py        the table, the longest functions and files, every circle

Test modules are cut off, as are `tests.rs` and files that only tests use; a token is a word, a number, a text or a mark.
"""

import re
import statistics
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TOKEN = re.compile(
    r"""(?P<comment>//[^\n]*|/\*.*?\*/)
    |(?P<text>b?r(?P<hash>\#*)".*?"(?P=hash)|b?"(?:\\.|[^"\\])*"|b?'(?:\\.[^']*|[^'\\])')
    |(?P<word>'?[A-Za-z_]\w*|\d[\w.]*)
    |(?P<mark>::|->|=>|\.\.=?|&&|\|\||[-+*/%^&|=!<>]=|[^\s\w])""",
    re.VERBOSE | re.DOTALL,
)


@dataclass
class Function:
    file: Path
    name: str
    first_line: int
    n_lines: int
    n_tokens: int
    has_reason: bool  # a comment above says why it is longer than 40 lines


def without_tests(text: str) -> str:
    """The text up to its test module."""
    return re.split(r"^#\[cfg\(test\)\]\nmod \w+ \{", text, maxsplit=1, flags=re.MULTILINE)[0]


def sources(folder: Path) -> list[Path]:
    """Files of code below a folder, without those of tests."""
    files = sorted(folder.rglob("*.rs"))
    return [file for file in files if file.stem not in ("tests", "testing") and "tests" not in file.parts[len(folder.parts) :]]


def tokens(text: str) -> list[tuple[str, int]]:
    """Every token but comments, with its place."""
    return [(match.group(), match.start()) for match in TOKEN.finditer(text) if match.lastgroup != "comment" and not match.group("comment")]


def functions(file: Path) -> list[Function]:
    """Every function with a body; nested ones count for themselves and for what holds them."""
    text = without_tests(file.read_text())
    all_tokens = tokens(text)
    found = []
    for index, (word, start) in enumerate(all_tokens):
        if word != "fn" or index + 1 == len(all_tokens) or not re.match(r"[a-z_]\w*$", all_tokens[index + 1][0]):
            continue
        depth, brackets = 0, 0
        for end in range(index, len(all_tokens)):
            mark = all_tokens[end][0]
            brackets += (mark in "([") - (mark in ")]") if len(mark) == 1 else 0
            if mark == ";" and depth == 0 and brackets == 0:
                break  # a declaration
            depth += (mark == "{") - (mark == "}")
            if mark == "}" and depth == 0:
                first, last = text.count("\n", 0, start) + 1, text.count("\n", 0, all_tokens[end][1]) + 1
                above = re.split(r"^ *}$|^$", text[:start], flags=re.MULTILINE)[-1]
                has_reason = "// longer than 40 lines: " in above
                found.append(Function(file, all_tokens[index + 1][0], first, last - first + 1, end - index + 1, has_reason))
                break
    return found


def n_lines(file: Path) -> int:
    return without_tests(file.read_text()).rstrip().count("\n") + 1


def room(file: Path, source: Path) -> str:
    """The room of a file: its folder in `src`, the file itself at the top."""
    parts = file.relative_to(source).with_suffix("").parts
    return parts[0]


def imports(file: Path, source: Path) -> set[str]:
    """Rooms that a file imports by path, from its crate's root."""
    text = without_tests(file.read_text())
    found = set(re.findall(r"\bcrate::(\w+)", text))
    for group in re.findall(r"\buse crate::\{(.*?)\};", text, flags=re.DOTALL):
        found |= set(re.findall(r"(?:^|,)\s*(\w+)", group))
    return {name for name in found if name[0].islower()} - {room(file, source)}


def circles(source: Path) -> list[list[str]]:
    """Groups of rooms of a crate that reach each other."""
    graph: dict[str, set[str]] = {}
    for file in sources(source):
        if file.stem not in ("lib", "main"):
            graph.setdefault(room(file, source), set()).update(imports(file, source))

    def reached(start: str) -> set[str]:
        seen, open_rooms = set(), [start]
        while open_rooms:
            for following in graph.get(open_rooms.pop(), set()) & graph.keys():
                if following not in seen:
                    seen.add(following)
                    open_rooms.append(following)
        return seen

    reach = {name: reached(name) for name in graph}
    groups = {frozenset(other for other in reach[name] if name in reach[other]) for name in graph if name in reach[name]}
    return sorted(sorted(group) for group in groups)


def crate_sources() -> list[Path]:
    return [*sorted(ROOT.glob("crates/*/src")), ROOT / "python/src"]


def full_folders() -> list[tuple[Path, int]]:
    """Folders with their number of source files, fullest first."""
    counts: dict[Path, int] = {}
    for source in crate_sources():
        for file in sources(source):
            counts[file.parent] = counts.get(file.parent, 0) + 1
    return sorted(counts.items(), key=lambda item: -item[1])


def main():
    all_functions = []
    print("crate        files  lines  longest | functions  median  p90 tokens | > 40 lines")
    for source in crate_sources():
        files = sources(source)
        ours = [function for file in files for function in functions(file)]
        all_functions += ours
        lengths = [n_lines(file) for file in files]
        sizes = sorted(function.n_tokens for function in ours)
        long = sum(function.n_lines > 40 for function in ours)
        print(
            f"{source.parent.name:12} {len(files):5} {sum(lengths):6} {max(lengths):8} | {len(ours):9} "
            f"{statistics.median(sizes):7.0f} {sizes[int(0.9 * len(sizes))]:11} | {long:5}"
        )
        for circle in circles(source):
            print(f"    circle: {', '.join(circle)}")
    sizes = sorted(function.n_tokens for function in all_functions)
    print(f"all: {len(sizes)} functions, median {statistics.median(sizes):.0f}, 90th percentile {sizes[int(0.9 * len(sizes))]} tokens")
    for function in sorted(all_functions, key=lambda function: -function.n_lines):
        if function.n_lines > 40:
            print(f"    {function.n_lines:4} lines {function.file.relative_to(ROOT)}:{function.first_line} {function.name}")
    for source in crate_sources():
        for file in sources(source):
            if n_lines(file) > 300:
                print(f"    {n_lines(file)} lines in {file.relative_to(ROOT)}")
    for folder, count in full_folders():
        if count > 15:
            print(f"    {count} files in {folder.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
