"""frfid's answers to a campaign."""

import numpy as np

import answers
import frfid
from scenarios import LINES, SAMPLE_TIME_S

METHODS = {"known input": "mean-of-frfs", "noisy input": "mean-of-spectra", "closed loop": "joint-input-output"}
GRID = {"sample_time_s": SAMPLE_TIME_S, "harmonics": LINES}


def estimate(scenario, method=None):
    return frfid.estimate(scenario.u, scenario.y, r=scenario.r, method=method or METHODS[scenario.group], **GRID)


def solve(scenario):
    """Every quantity that the other package knows, too; distortions as their nearest positive semidefinite matrix, as there."""
    frf = estimate(scenario)
    spectra = frfid.spectra_covariance(scenario.u, scenario.y, r=scenario.r, **GRID)
    n_inputs, n_periods = scenario.u.shape[3], scenario.u.shape[2]
    distortion, equation_noise = answers.positive_part(spectra["nonlinear"]), n_periods * spectra["equation_noise"]
    y_noise = spectra["noise"][:, n_inputs:, n_inputs:]
    found = {
        answers.RESPONSE: frf.response,
        answers.NOISE: frf.noise_covariance,
        answers.TOTAL: frf.total_covariance,
        answers.DISTORTION: answers.positive_part(frf.total_covariance - frf.noise_covariance),
        answers.U_NOISE: spectra["noise"][:, :n_inputs, :n_inputs],
        answers.Y_NOISE: y_noise,
        answers.EQUATION_NOISE: equation_noise,
        answers.EQUATION: distortion + equation_noise,
        answers.Y_DISTORTION: distortion,
        answers.Y_TOTAL: distortion + y_noise,
    }
    if scenario.r is not None:  # the input is an output of the reference
        of_input = frfid.spectra_covariance(scenario.r, scenario.u, r=scenario.r, **GRID)
        found[answers.U_TOTAL] = answers.positive_part(of_input["nonlinear"]) + found[answers.U_NOISE]
    return found


def failed_checks(frf):
    return [check["name"] for check in frf.checks if not check["passed"]]


def is_covariance(frf):
    """Whether both covariances are Hermitian, exactly, and positive semidefinite to rounding."""
    for covariance in (frf.noise_covariance, frf.total_covariance):
        lowest = np.linalg.eigvalsh(covariance)[:, 0]
        size = np.trace(covariance, axis1=1, axis2=2).real
        if not (np.array_equal(covariance, covariance.conj().swapaxes(1, 2)) and (lowest >= -1e-13 * size).all()):
            return False
    return True
