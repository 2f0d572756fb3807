"""The answers of pyFRF to a test of a structure."""

import numpy as np
from pyFRF import FRF

from vibration import SAMPLE_RATE_HZ


def analyse(test, window):
    """Displacement over force."""
    options = {"window": window, "fft_len": test.segment, "nperseg": test.segment, "resp_type": "d"}
    return FRF(SAMPLE_RATE_HZ, test.force, test.motion, **options)


def response(test, window, estimator):
    """(line, output, input)."""
    return np.moveaxis(analyse(test, window).get_FRF(estimator, "receptance"), 2, 0)[test.lines]


def coherence(test, window):
    """(line, output)."""
    return analyse(test, window).get_coherence().T[test.lines].real
