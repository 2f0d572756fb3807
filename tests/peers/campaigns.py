"""The 54 campaigns through both packages: the same G and covariances, and both right."""

import numpy as np

import answers
import bla_package
import frfid_package
from scenarios import GROUPS, all_scenarios
from table import Row, sigma_row

ALLOWED_RESPONSE = 1e-12
# from covariances of products with the reference the other package takes off what they have in common, which costs digits
ALLOWED_COVARIANCE = 1e-10
CLASSES = {
    "G": (answers.RESPONSE,),
    "noise covariance of vec(G)": (answers.NOISE,),
    "total covariance of vec(G)": (answers.TOTAL,),
    "distortion of vec(G), >= 0": (answers.DISTORTION,),
    "noise of U, Y, Y - G U": answers.OF_SPECTRA,
    "total, distortion of spectra": answers.BY_REALIZATIONS,
}


def is_by_realizations(name, group):
    """Total covariances of spectra are another estimator: there the fit of G is counted in, here only their mean, a share of 1/M. Through
    the reference frfid frees residuals of the leverage of each realization, another share of 1/M."""
    return name in answers.BY_REALIZATIONS or (group == "closed loop" and name in (answers.TOTAL, answers.DISTORTION))


def allowed(name, group, n_realizations):
    if is_by_realizations(name, group):
        return 10 / n_realizations
    return ALLOWED_RESPONSE if name == answers.RESPONSE else ALLOWED_COVARIANCE


def rows(n_realizations):
    """A row for every group and kind of quantity, then one of what covariances must be and one of checks."""
    counts = {"scenarios": 0, "covariances": 0, "unfailed": 0}
    for group in GROUPS:
        found = []
        for scenario in (one for one in all_scenarios(n_realizations) if one.group == group):
            found.append(compare(scenario))
            frf = frfid_package.estimate(scenario)
            counts["scenarios"] += 1
            counts["covariances"] += frfid_package.is_covariance(frf)
            counts["unfailed"] += not frfid_package.failed_checks(frf)
        for title, names in CLASSES.items():
            difference, ours, theirs = np.max([one[name] for one in found for name in names if name in one], axis=0)
            n_cases = sum(any(name in one for name in names) for one in found)
            remark = "same but for 1/realizations" if is_by_realizations(names[0], group) else ""
            yield sigma_row(group, n_cases, title, difference, allowed(names[0], group, n_realizations), ours, theirs, remark)
    n = counts["scenarios"]
    for what, key in (("Hermitian, eigenvalues >= 0", "covariances"), ("every check passes", "unfailed")):
        yield Row("all of them", n, what, None, None, f"{counts[key]} of {n}", "", counts[key] == n)


def compare(scenario):
    """For every quantity: the relative difference, and the error of either in standard deviations."""
    ours, theirs, known = frfid_package.solve(scenario), bla_package.solve(scenario), truths(scenario)
    size = {name: scale(name, known) for name in ours}
    return {
        name: (
            answers.relative_difference(ours[name], theirs[name], size[name]),
            error(name, ours[name], known),
            error(name, theirs[name], known),
        )
        for name in ours
        if name in theirs
    }


def truths(scenario):
    """For every quantity its true value, the covariance that its scatter is measured by, and its degrees of freedom."""
    truth, (n_realizations, n_experiments, n_periods, n_inputs, _) = scenario.truth, scenario.u.shape
    equation_noise = truth.equation_noise
    total = truth.of_response(truth.distortion + equation_noise / n_periods)
    g_noise = truth.of_response(equation_noise / n_periods)
    g_freedom = (n_realizations * (n_periods - 1), n_realizations - 1)
    freedom = tuple(n_experiments * one for one in g_freedom)
    u_noise, y_noise = truth.noise[:, :n_inputs, :n_inputs], truth.noise[:, n_inputs:, n_inputs:]
    y_total, mean_total = truth.distortion + y_noise, truth.distortion + equation_noise / n_periods
    u_total = truth.input_distortion + u_noise
    one_period = truth.distortion + equation_noise
    has_noise = scenario.disturbance != "distortion"
    has_input_noise = has_noise and scenario.group != "known input"
    return {
        answers.RESPONSE: (truth.response, total, None),
        answers.NOISE: (g_noise, g_noise if has_noise else total, g_freedom[0]),
        answers.TOTAL: (total, total, g_freedom[1]),
        answers.DISTORTION: (truth.of_response(truth.distortion), total, g_freedom[1]),
        answers.U_NOISE: (u_noise, u_noise if has_input_noise else np.eye(n_inputs)[None], freedom[0]),
        answers.Y_NOISE: (y_noise, y_noise if has_noise else y_total, freedom[0]),
        answers.EQUATION_NOISE: (equation_noise, equation_noise if has_noise else one_period, freedom[0]),
        answers.EQUATION: (one_period, one_period, freedom[1]),
        answers.Y_DISTORTION: (truth.distortion, mean_total, freedom[1]),
        answers.Y_TOTAL: (y_total, y_total, freedom[1]),
        answers.U_TOTAL: (u_total, u_total, freedom[1]),
    }


def scale(name, known):
    """What a difference is relative to."""
    value, covariance, _ = known[name]
    return value if name == answers.RESPONSE else covariance


def error(name, found, known):
    value, covariance, freedom = known[name]
    if name == answers.RESPONSE:
        return answers.response_error(found, value, covariance)
    return answers.covariance_error(found, value, freedom, covariance)
