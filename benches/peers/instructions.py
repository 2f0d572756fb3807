"""Instructions that frfid executes per unit of each workload, counted by valgrind: python benches/peers --instructions

They hardly depend on the machine and not on what else it does, so that a change can be told by less than a percent. The work is done
twice and so many times more, each in a process of its own: the difference leaves out the interpreter, imports and what is made before. The sizes are
those of the tests, and valgrind's processor has AVX2 but not AVX-512.
"""

import os
import pathlib
import re
import subprocess
import sys
import time

import report
import workloads

FIRST = 2
LONG_S = 0.1  # of work without valgrind, beside which what differs from process to process counts for little
COUNTING = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
REPEAT = pathlib.Path(__file__).parent / "repeat.py"


def main(only):
    """Counts all workloads or some, prints them, and writes docs/performance.md when it was all."""
    table = ["| work | instructions |", "|---|---|"]
    for name in only or workloads.NAMES:
        seen = set()
        for index, case in enumerate(workloads.cases(name, small=True)):
            if case.work not in seen:
                seen.add(case.work)
                more = enough(case.ours)
                count = (counted(name, index, FIRST + more) - counted(name, index, FIRST)) / more / case.n_ours
                table.append(f"| {case.work} | {report.digits(count, 4)} per {case.unit} |")
                print(f"{case.work:80} {report.digits(count, 4):>9} per {case.unit}", flush=True)
    if not only:
        version = subprocess.run(["valgrind", "--version"], capture_output=True, text=True, check=True).stdout.strip()
        text = [f"`python benches/peers --instructions`, {report.where()}, {version}:", "", *table]
        report.put(report.PERFORMANCE, "instructions", "\n".join(text))


def enough(work):
    """How often work is done in LONG_S; the first time does not count."""
    work()
    start = time.perf_counter()
    work()
    return max(2, round(LONG_S / (time.perf_counter() - start)))


def counted(name, index, times):
    """Instructions of a process that does a case's work so many times."""
    command = [*COUNTING, sys.executable, "-B", str(REPEAT), name, str(index), str(times)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, env=os.environ | {"PYTHONHASHSEED": "0"})
    except FileNotFoundError:
        sys.exit("valgrind is not installed")
    found = re.search(r"Collected : (\d+)", done.stderr)
    if done.returncode or not found:
        sys.exit(f"{' '.join(command)}:\n{done.stderr}")
    return int(found[1])
