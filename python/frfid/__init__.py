"""Frequency response functions of flexible-joint robots and positioning machines, by experiment.

Time series are ``(channel, sample)``, responses ``(frequency, output, input)``, campaigns ``(realization, experiment, period,
channel, sample)``. Frequencies are in Hz, everything else in SI units on the joint side of the gear.
"""

from ._core import (
    Chirp,
    Comparison,
    Experiment,
    Frf,
    Multisine,
    NumericalError,
    PiController,
    Plan,
    Plant,
    Record,
    Shaped,
    __version__,
    compare,
    estimate_bla,
    estimate_chirp,
    load,
    loop_frf,
    run_closed_loop,
    shape,
    spectrogram,
    subtract_glide,
)

__all__ = [
    "Chirp",
    "Comparison",
    "Experiment",
    "Frf",
    "Multisine",
    "NumericalError",
    "PiController",
    "Plan",
    "Plant",
    "Record",
    "Shaped",
    "__version__",
    "compare",
    "estimate_bla",
    "estimate_chirp",
    "load",
    "loop_frf",
    "run_closed_loop",
    "shape",
    "spectrogram",
    "subtract_glide",
]
