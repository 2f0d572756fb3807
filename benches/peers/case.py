"""One piece of work, done by frfid and by what a user would take instead."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import metadata
from typing import Any

import numpy as np

import frfid

SAMPLE_TIME_S = 1e-3
N_SAMPLES = 12288
PEAK = 150.0
MULTISINE = frfid.Multisine.design(
    low_hz=1.0, high_hz=60.0, sample_time_s=SAMPLE_TIME_S, resolution_hz=0.1, n_lines=80, grid="odd"
)


@dataclass
class Case:
    """`ours` and `peer` take nothing and return arrays that must agree to `tolerance`.

    Where the peer does less, because it is slow, its answer is the corner of ours where every axis begins.
    """

    work: str
    unit: str
    """What times are given per."""
    n_ours: int
    """Units that `ours` does."""
    ours: Callable[[], Any]
    package: str
    """Name of the peer on the package index."""
    how: str
    """What is taken of it."""
    peer: Callable[[], Any]
    tolerance: float
    """Largest difference allowed, relative to the largest entry of the peer's array."""
    n_peer: int = 0
    """Units that `peer` does; as many as ours where it is not given."""
    seen: Callable[[Any], Any] = lambda answer: answer
    """What of an answer is compared."""
    remark: str = ""
    """What a reader must know who compares the two."""
    headline: bool = False
    """Whether the README shows it."""

    def __post_init__(self):
        self.n_peer = self.n_peer or self.n_ours

    @property
    def peer_version(self) -> str | None:
        """Version of the peer, None where it is not installed."""
        try:
            return metadata.version(self.package)
        except metadata.PackageNotFoundError:
            return None

    def difference(self) -> float:
        """Largest difference between the answers: every array relative to the peer's largest entry."""
        ours, peer = (arrays(self.seen(answer)) for answer in (self.ours(), self.peer()))
        if self.n_peer < self.n_ours:
            ours = [all_of_it[tuple(map(slice, part.shape))] for all_of_it, part in zip(ours, peer, strict=True)]
        assert [part.shape for part in ours] == [part.shape for part in peer], f"{self.work}, {self.how}: other shapes"
        return max(float(np.abs(a - b).max() / np.abs(b).max()) for a, b in zip(ours, peer, strict=True))

    def agreed(self) -> float:
        """The difference; ends the program if it is larger than allowed."""
        if (difference := self.difference()) < self.tolerance:
            return difference
        raise SystemExit(f"{self.work}, {self.how}: answers differ by {difference:.1e}, allowed are {self.tolerance:.0e}")


def arrays(answer):
    """The arrays of an answer."""
    return [np.asarray(part) for part in (answer if isinstance(answer, tuple) else (answer,))]
