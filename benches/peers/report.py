"""Table of times, on the screen and between the marks of README.md and docs/performance.md."""

import datetime
import os
import pathlib
import platform
import re
from importlib import metadata

ROOT = pathlib.Path(__file__).resolve().parents[2]
PERFORMANCE, README = ROOT / "docs" / "performance.md", ROOT / "README.md"


def agreement(case, difference):
    """A peer and how far its answers are from ours, for the screen."""
    return f"  {case.package + ': ' + case.how:58} {difference:8.0e}"


def line(row):
    """A row for the screen."""
    ratios = f"{row.ratio:9.3g} {min(row.ratios):7.3g} {max(row.ratios):7.3g}"
    return f"{agreement(row.case, row.difference)} {row.ours_ns:9.4g} {row.peer_ns:9.4g} {ratios}"


HEADER = f"  {'':58} {'agree to':>8} {'frfid ns':>9} {'peer ns':>9} {'ratio':>9} {'min':>7} {'max':>7}"


def write(rows, command):
    """Puts the tables of a run into both documents."""
    put(PERFORMANCE, "peers", performance(rows, command))
    put(README, "peers", readme([row for row in rows if row.case.headline]))


def performance(rows, command):
    """The whole table, with what was measured, where and how."""
    packages = sorted({row.case.package for row in rows} | {"numpy"}, key=str.lower)
    versions = ", ".join(f"{name} {metadata.version(name)}" for name in ("frfid", *packages))
    table = ["| work | per | frfid, ns | instead | ns | times longer | agree to |", "|---|---|---|---|---|---|---|"]
    for row in rows:
        case, remark = row.case, f" ({row.case.remark})" if row.case.remark else ""
        ratio = f"{digits(row.ratio)} ({digits(min(row.ratios))} to {digits(max(row.ratios))})"
        instead = f"{case.package} {case.peer_version}: {case.how}{remark}"
        times = f"{case.unit} | {digits(row.ours_ns)} | {instead} | {digits(row.peer_ns)}"
        table.append(f"| {case.work} | {times} | {ratio} | {row.difference:.0e} |")
    return "\n".join([f"`{command}`, {where()}: {versions}.", "", *table])


def readme(rows):
    """A few ratios of the same run."""
    table = ["| work | instead | times longer |", "|---|---|---|"]
    table += [f"| {row.case.work} | {row.case.package}: {row.case.how} | {digits(row.ratio)} |" for row in rows]
    return "\n".join([f"Of one run, {where()}:", "", *table])


def digits(number, n=3):
    """So many digits, without an exponent."""
    return f"{number:.{n}g}" if abs(number) < 1000 else f"{float(f'{number:.{n}g}'):,.0f}".replace(",", " ")


def where():
    """Day, machine and interpreter."""
    today = datetime.date.today()
    day = f"{today.day} {today:%B %Y}"
    return f"{day}, {processor()}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}"


def processor():
    """Name of the processor where the system tells it."""
    cpuinfo = pathlib.Path("/proc/cpuinfo")
    named = re.search(r"model name\s*: (.*)", cpuinfo.read_text()) if cpuinfo.exists() else None
    return named[1] if named else platform.processor() or platform.machine()


def put(document, name, text):
    """Replaces what stands between the marks of this name."""
    begin, end = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->"
    before, found, rest = document.read_text().partition(begin)
    _, closed, after = rest.partition(end)
    if not (found and closed):
        raise SystemExit(f"{document.relative_to(ROOT)}: the marks {begin.strip()} and {end} are missing")
    document.write_text(f"{before}{begin}{text}\n{end}{after}")
