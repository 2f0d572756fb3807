"""frfid beside what a user would take instead: python3.12 benches/peers

Makes an environment of its own in target/peers with the packages of requirements.txt and the release wheel of this checkout, and
goes on there: answers are compared first, then both sides run in alternation, one thread each. Prints the table and writes it into
docs/performance.md and README.md, when all workloads were run. Times are medians, in ns per sample, message, ... of either side;
ratios are of one round each.
"""

import argparse
import os
import pathlib
import subprocess
import sys

import environment
import workloads

MODULES = ("RAYON", "OPENBLAS", "OMP", "MKL", "NUMBA")


def main():
    options = arguments()
    if not options.here and pathlib.Path(sys.prefix).resolve() != environment.FOLDER:
        environment.prepare(options.wheel)
        again = [environment.PYTHON, str(environment.HERE), *sys.argv[1:]]
        sys.exit(subprocess.run(again, env=pinned(options.threads)).returncode)
    os.environ.update(pinned(options.threads))  # before they are loaded
    if options.instructions:
        import instructions

        return instructions.main(options.only)
    compare(options)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--wheel", type=lambda path: pathlib.Path(path).resolve(strict=True), help="this wheel, none is built")
    parser.add_argument("--here", action="store_true", help="in this environment as it is: nothing is installed")
    parser.add_argument("--only", nargs="+", choices=workloads.NAMES, default=(), help="these workloads; nothing is written")
    parser.add_argument("--threads", type=int, default=1, help="threads of either side")
    parser.add_argument("--seconds", type=float, default=3.0, help="time for each row (at least three rounds)")
    parser.add_argument("--check", action="store_true", help="only compare answers, at small sizes; nothing is written")
    parser.add_argument("--instructions", action="store_true", help="instructions of frfid's side instead, counted by valgrind")
    return parser.parse_args()


def pinned(threads):
    """The environment with so many threads, and with the kernels that the packages choose themselves."""
    kept = {name: value for name, value in os.environ.items() if name not in ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE")}
    return kept | {f"{module}_NUM_THREADS": str(threads) for module in MODULES}


def compare(options):
    """Row by row on the screen, then into the documents."""
    import report
    import timing

    rows, work = [], None
    print(f"{report.where()}\n{report.HEADER}")
    for name in options.only or workloads.NAMES:
        for case in workloads.cases(name, small=options.check):
            if case.work != work:
                print(f"{case.work}, per {case.unit}", flush=True)
                work = case.work
            if options.check:
                print(report.agreement(case, case.agreed()), flush=True)
            else:
                rows.append(timing.measure(case, options.seconds))
                print(report.line(rows[-1]), flush=True)
    if not options.only and not options.check:
        report.write(rows, f"python benches/peers --threads {options.threads} --seconds {options.seconds:g}")


if __name__ == "__main__":
    main()
