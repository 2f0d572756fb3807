"""Hammer and shaker tests through frfid and pyFRF: H1, H2 and coherence, and whether both are right."""

from dataclasses import replace

import numpy as np

import answers
import frfid
import pyfrf_package
import vibration
from table import MOST_SIGMA, Row

ALLOWED = 1e-10
# E|e|^2 over a variance with 9 degrees of freedom is 9/8; leakage between the lines of a segment adds to it
MOST_RATIO = 1.5


def rows():
    yield exact_row(vibration.hammer(1))
    for test, window, estimator, group in (
        (vibration.hammer(10, motion_noise=0.05), "none", "H1", "hammer, 10 blows, noise on y"),
        (vibration.hammer(10, force_noise=0.05), "none", "H2", "hammer, 10 blows, noise on u"),
        (vibration.shaker(3, motion_noise=0.1), "hann", "H1", "shaker, 2 in 3 out, noise on y"),
        (vibration.shaker(2, force_noise=0.1), "hann", "H2", "shaker, 2 in 2 out, noise on u"),
    ):
        yield response_row(test, window, estimator, group)
        yield coherence_row(test, window, group)
    yield one_input_row()
    yield unequal_row()


def signals(test, window):
    """Force and motion as campaigns: every test a realization, its segments experiments of one period; windows by hand."""
    if window == "none":
        return [signal[:, None, None] for signal in (test.force, test.motion)]
    return [vibration.segments(signal, test.segment)[:, :, None] for signal in (test.force, test.motion)]


def grid(test):
    return {"sample_time_s": 1 / vibration.SAMPLE_RATE_HZ, "harmonics": test.lines}


def estimate(test, window, estimator):
    u, y = signals(test, window)
    return frfid.estimate(u, y, method=estimator.lower(), **grid(test))


def exact_row(test):
    ours, theirs = estimate(test, "none", "H1").response, pyfrf_package.response(test, "none", "H1")
    errors = [np.abs(found / test.truth - 1).max() for found in (ours, theirs)]
    difference = answers.relative_difference(ours, theirs, ours)
    return Row("hammer, one blow, no noise", 1, "G by H1", difference, ALLOWED, f"{errors[0]:.0e}", f"{errors[1]:.0e}", errors[0] < 1e-10)


def response_row(test, window, estimator, group):
    """Errors in frfid's standard deviations: the other package has none."""
    frf, theirs = estimate(test, window, estimator), pyfrf_package.response(test, window, estimator)
    variance = frf.noise_variance if frf.total_variance is None else frf.total_variance
    ours, of_peer = (np.abs(found - test.truth) ** 2 / variance for found in (frf.response, theirs))
    is_right = 0.8 < ours.mean() < MOST_RATIO and np.sqrt(ours.max()) < MOST_SIGMA
    difference = answers.relative_difference(frf.response, theirs, theirs)
    worst = [f"{np.sqrt(found.max()):.1f} s" for found in (ours, of_peer)]
    return Row(group, 1, f"G by {estimator}", difference, ALLOWED, *worst, bool(is_right))


def coherence_row(test, window, group):
    """The other package has no interval; frfid's must hold the true coherence where noise on y alone makes it."""
    u, y = signals(test, window)
    value, low, high = frfid.coherence(u, y, **grid(test))
    difference = np.abs(value - pyfrf_package.coherence(test, window)).max()
    what = "multiple coherence" if test.force.shape[1] > 1 else "coherence"
    if not test.noise_power:
        return Row(group, 1, what, difference, ALLOWED, "", "", bool(((low <= value) & (value <= high)).all()))
    force = np.fft.rfft(test.force)[..., test.lines]
    power = np.mean(np.abs(test.truth[:, 0, 0] * force[:, 0]) ** 2, axis=0)
    true = power / (power + test.noise_power)
    inside = np.mean((low[:, 0] <= true) & (true <= high[:, 0]))
    return Row(group, 1, f"{what}, 95 % interval", difference, ALLOWED, f"{100 * inside:.0f} %", "none", bool(0.9 < inside < 0.99))


def one_input_row():
    """Ordinary coherence: one input at a time."""
    test = vibration.shaker(3, motion_noise=0.1)
    differences = []
    for channel in range(2):
        one = replace(test, force=test.force[:, [channel]])
        u, y = signals(one, "hann")
        ours = frfid.coherence(u, y, **grid(one))[0]
        differences.append(np.abs(ours - pyfrf_package.coherence(one, "hann")).max())
    return Row("shaker, one input at a time", 2, "ordinary coherence", max(differences), ALLOWED, "", "", True)


def unequal_row():
    """More outputs than inputs leave H2 overdetermined: frfid weighs outputs by their power, pyFRF by their units. No unique answer."""
    test = vibration.shaker(3, motion_noise=0.1)
    ours = estimate(test, "hann", "H2").response
    theirs = pyfrf_package.response(test, "hann", "H2")
    units = np.array([[1.0], [1e3], [1.0]])
    in_other_units = replace(test, motion=test.motion * units)
    moved = [
        answers.relative_difference(found / units, before, before)
        for found, before in (
            (estimate(in_other_units, "hann", "H2").response, ours),
            (pyfrf_package.response(in_other_units, "hann", "H2"), theirs),
        )
    ]
    texts = [f"{change:.0e}" for change in moved]
    return Row("shaker, 2 in 3 out", 1, "H2 with one output in mm", None, None, *texts, moved[0] < 1e-9, "no unique H2; frfid keeps it")
