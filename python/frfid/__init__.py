"""Frequency response functions of flexible-joint robots and positioning machines, by experiment.

Time series are ``(channel, sample)``, responses ``(frequency, output, input)``, campaigns ``(realization, experiment, period,
channel, sample)``. Frequencies are in Hz, everything else in SI units on the joint side of the gear.
"""

from ._core import (
    Chirp,
    Frf,
    Multisine,
    NumericalError,
    PiController,
    Plant,
    Record,
    __version__,
    estimate_bla,
    estimate_chirp,
    run_closed_loop,
)

__all__ = [
    "Chirp",
    "Frf",
    "Multisine",
    "NumericalError",
    "PiController",
    "Plant",
    "Record",
    "__version__",
    "estimate_bla",
    "estimate_chirp",
    "run_closed_loop",
]
