"""Answers of a package to a campaign, by the same names, and how far two of them, or one and the truth, are apart."""

import numpy as np

from scenarios import adjoint

RESPONSE = "G"
NOISE = "noise covariance of G"
TOTAL = "total covariance of G"
DISTORTION = "distortion of G"
U_NOISE = "noise of U"
Y_NOISE = "noise of Y"
EQUATION_NOISE = "noise of Y - G U"
EQUATION = "total of Y - G U"
Y_DISTORTION = "distortion of Y"
Y_TOTAL = "total of Y"
U_TOTAL = "total of U"
OF_G = (RESPONSE, NOISE, TOTAL, DISTORTION)
OF_SPECTRA = (U_NOISE, Y_NOISE, EQUATION_NOISE)
BY_REALIZATIONS = (EQUATION, Y_DISTORTION, Y_TOTAL, U_TOTAL)


def positive_part(covariance):
    """The nearest positive semidefinite matrix: negative eigenvalues are 0."""
    values, vectors = np.linalg.eigh((covariance + adjoint(covariance)) / 2)
    return (vectors * np.maximum(values, 0.0)[:, None, :]) @ adjoint(vectors)


def relative_difference(ours, theirs, scale):
    """Largest difference over the largest value of `scale`."""
    return np.abs(ours - theirs).max() / np.abs(scale).max()


def response_error(found, truth, covariance):
    """Largest error of an entry of G in its true standard deviations."""
    variance = np.diagonal(covariance, axis1=1, axis2=2).real
    error = (found - truth).swapaxes(1, 2).reshape(variance.shape)  # columns stacked
    return (np.abs(error) / np.sqrt(variance)).max()


def covariance_error(found, truth, freedom, scale=None):
    """Largest error of an entry of a covariance in standard deviations of its scatter, sqrt(C_ii C_jj / freedom)."""
    power = np.diagonal(truth if scale is None else scale, axis1=1, axis2=2).real
    deviation = np.sqrt(power[:, :, None] * power[:, None, :] / freedom)
    return (np.abs(found - truth) / deviation).max()
