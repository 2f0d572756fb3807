"""The work of the benches done by numpy and scipy, and how many times longer that takes: python benches/peers/compare.py

Needs the wheel, numpy, scipy, pandas and mcap-ros2-support. Both sides run in the same process, one after the other and in changing order, several
rounds; the ratios are of one round each, so a busy machine slows both. First the answers must agree.
"""

import argparse
import os
import statistics
import sys
import time


def main():
    options = arguments()
    if options.threads:
        for library in ("RAYON", "OPENBLAS", "OMP"):  # before they are loaded
            os.environ[f"{library}_NUM_THREADS"] = str(options.threads)
    import numpy
    import scipy

    import accelerations
    import bla
    import excerpts
    import frfid
    import multisine
    import reading
    import simulation

    threads = options.threads or f"up to {os.cpu_count()}"
    print(f"{threads} threads, frfid {frfid.__version__}, numpy {numpy.__version__}, scipy {scipy.__version__}")
    print(f"{'work':34} {'instead':37} {'agree to':>8} {'times longer':>13} {'min':>7} {'max':>7}")
    for part in (multisine, simulation, accelerations, bla, excerpts, reading):
        for case in part.cases():
            difference = case.difference()
            if not difference < case.tolerance:
                sys.exit(f"{case.name}, {case.peer_name}: answers differ by {difference:.1e}, allowed are {case.tolerance:.0e}")
            found = ratios(case, options.seconds)
            row = f"{statistics.median(found):13.3g} {min(found):7.3g} {max(found):7.3g}"
            print(f"{case.name:34} {case.peer_name:37} {difference:8.0e} {row}", flush=True)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--threads", type=int, help="threads of either side; without it what a user gets")
    parser.add_argument("--seconds", type=float, default=3.0, help="time for each row (at least three rounds)")
    return parser.parse_args()


def ratios(case, seconds):
    """Time of the peer over ours, round by round."""
    ours, peer = enough(case.ours), enough(case.peer)
    found, end = [], time.perf_counter() + seconds
    while len(found) < 3 or (time.perf_counter() < end and len(found) < 99):
        first, second = (ours, peer) if len(found) % 2 else (peer, ours)
        took = {first: first(), second: second()}
        found.append(took[peer] / took[ours])
    return found


def enough(work):
    """A function that does `work` as often as fills 20 ms, so that the clock counts for nothing, and returns seconds of one."""
    start = time.perf_counter()
    work()
    repeats = max(1, round(0.02 / (time.perf_counter() - start)))

    def seconds_of_one():
        start = time.perf_counter()
        for _ in range(repeats):
            work()
        return (time.perf_counter() - start) / repeats

    return seconds_of_one


if __name__ == "__main__":
    main()
