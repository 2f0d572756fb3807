"""The answers of best-linear-approximation to a campaign."""

import numpy as np
from best_linear_approximation import robust

import answers
from scenarios import LINES, SAMPLE_TIME_S


def estimate(scenario):
    """Its estimate: arrays are (sample, channel, experiment, realization, period) there."""
    u, y = turned(scenario.u), turned(scenario.y)
    options = {"fs": 1 / SAMPLE_TIME_S, "excited_bins": LINES, "show_warnings": False}
    if scenario.group == "known input":
        return robust.known_input(u[..., 0], y, **options)
    if scenario.group == "noisy input":
        return robust.noisy_input(u, y, **options)
    return robust.closed_loop(turned(scenario.r)[..., 0], u, y, **options)


def turned(signal):
    return np.ascontiguousarray(signal.transpose(4, 3, 1, 0, 2))


def solve(scenario):
    """What it knows, by our names; spectra at the excited lines."""
    found = estimate(scenario)
    u, y = found.spectra.U, found.spectra.Y
    every = {
        answers.RESPONSE: found.G.value,
        answers.NOISE: found.G.noise.cov,
        answers.TOTAL: found.G.total.cov,
        answers.DISTORTION: found.G.nonlinear.cov,
        answers.U_NOISE: None if u.noise.cov is None else u.noise.cov[LINES],
        answers.Y_NOISE: y.noise.cov[LINES],
        answers.EQUATION_NOISE: y.total_equation_error.cov - y.nonlinear.cov,
        answers.EQUATION: y.total_equation_error.cov,
        answers.Y_DISTORTION: y.nonlinear.cov,
        answers.Y_TOTAL: y.total.cov,
        answers.U_TOTAL: u.total.cov,
    }
    return {name: array for name, array in every.items() if array is not None}
