"""Timing of ours and theirs in alternation, round by round, so that a busy machine slows both."""

import statistics
import time
from dataclasses import dataclass


@dataclass
class Row:
    """Times of a case in ns per unit, medians of the rounds; ratios are of one round each."""

    case: object
    difference: float
    ours_ns: float
    peer_ns: float
    ratios: list[float]

    @property
    def ratio(self):
        return statistics.median(self.ratios)


def measure(case, seconds):
    """Compares the answers, then times both sides for so long, three rounds at least."""
    difference = case.agreed()
    sides = [(enough(case.ours), case.n_ours), (enough(case.peer), case.n_peer)]
    rounds, end = [], time.perf_counter() + seconds
    while len(rounds) < 3 or (time.perf_counter() < end and len(rounds) < 99):
        order = (0, 1) if len(rounds) % 2 else (1, 0)
        took = {side: 1e9 * sides[side][0]() / sides[side][1] for side in order}
        rounds.append((took[0], took[1]))
    ours, peer = zip(*rounds, strict=True)
    return Row(case, difference, statistics.median(ours), statistics.median(peer), [b / a for a, b in rounds])


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
