"""One piece of work, done by frfid and by what a user would take instead."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import frfid

SAMPLE_TIME_S = 1e-3
N_SAMPLES = 12288
MULTISINE = frfid.Multisine.design(
    low_hz=1.0, high_hz=60.0, sample_time_s=SAMPLE_TIME_S, resolution_hz=0.1, n_lines=80, grid="odd"
)


@dataclass
class Case:
    """`ours` and `peer` take nothing and return arrays that must agree to `tolerance`."""

    name: str
    peer_name: str
    ours: Callable[[], Any]
    peer: Callable[[], Any]
    tolerance: float
    """Largest difference allowed, relative to the largest entry of the peer's array."""

    def difference(self) -> float:
        """Largest difference between the answers: every array relative to its own largest entry."""
        pairs = zip(arrays(self.ours()), arrays(self.peer()), strict=True)
        return max(float(np.abs(ours - peer).max() / np.abs(peer).max()) for ours, peer in pairs)


def arrays(answer):
    """The arrays of an answer; shapes must be the same on both sides, so nothing is broadcast."""
    return [np.asarray(part) for part in (answer if isinstance(answer, tuple) else (answer,))]
