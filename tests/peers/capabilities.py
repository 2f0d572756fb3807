"""What each package gives. A yes of frfid is done here, one of the others too where the package is installed; nothing is claimed."""

import importlib.util
from dataclasses import dataclass

import claims_of_frfid as ours
import claims_of_peers as theirs

NO = "no"
NOT_HERE = "(not here)"


@dataclass
class Capability:
    """What it is, and for each package a function that shows it, a word and a function, or a word alone."""

    what: str
    frfid: object
    bla: object
    pyfrf: object


CAPABILITIES = [
    Capability("G of several inputs and outputs", ours.response, theirs.bla_response, theirs.pyfrf_response),
    Capability("covariance of vec(G) by noise, and total", ours.covariances, theirs.bla_covariances, NO),
    Capability("degrees of freedom of both", ours.degrees_of_freedom, NO, NO),
    Capability("distortion: total less noise, signed", ours.signed_distortion, "by hand", NO),
    Capability("distortion, nearest positive semidefinite", "by hand", theirs.bla_distortion, NO),
    Capability("covariances of the spectra of U and Y", ours.spectra, theirs.bla_spectra, NO),
    Capability("noise of the spectra where nothing is excited", ours.noise_between, theirs.bla_noise_between, NO),
    Capability("G through a reference", ours.through_reference, theirs.bla_through_reference, NO),
    Capability("sensitivity, T, open loop, with covariances", ours.loop, NO, NO),
    Capability("more experiments than inputs in one division", ours.least_squares, "through r", theirs.pyfrf_response),
    Capability("mean of logarithms against noise on u", ours.logarithmic_mean, NO, NO),
    Capability("H1 and H2", ours.h1_h2, NO, theirs.pyfrf_h1_h2),
    Capability("Hv", (NO, ours.refuses_hv), NO, ("yes, one input", theirs.pyfrf_hv)),
    Capability("multiple coherence", ours.coherence, NO, theirs.pyfrf_coherence),
    Capability("ordinary coherence", ("one input at a time", ours.ordinary_coherence), NO, ("one input at a time", theirs.pyfrf_ordinary)),
    Capability("interval of the coherence", ours.coherence_interval, NO, NO),
    Capability("Hann segments of random signals", "by hand", NO, theirs.pyfrf_segments),
    Capability("force and exponential windows of a hammer test", NO, NO, theirs.pyfrf_windows),
    Capability("overload", ours.saturated, NO, theirs.pyfrf_overload),
    Capability("double impact", NO, NO, theirs.pyfrf_double_impact),
    Capability("receptance, mobility, accelerance", "by hand", "by hand", theirs.pyfrf_forms),
    Capability("exponential averaging", NO, NO, theirs.pyfrf_exponential),
    Capability("period, lines and transient found in a recording", ours.recording, "lines only", NO),
    Capability("uneven time stamps", ours.uneven_stamps, NO, NO),
    Capability("lost rows", ours.lost_rows, NO, NO),
    Capability("excerpts of chirps", ours.chirp, NO, NO),
    Capability("the same draw of phases counts as repetition", ours.same_draw, NO, NO),
    Capability("lines without excitation are unknown, and said", ours.unexcited, NO, NO),
    Capability("bias by noise on the input, said", ours.noise_on_input, NO, NO),
    Capability("change from period to period, said", ours.unsettled, theirs.bla_unsettled, NO),
    Capability("two responses compared within their covariances", ours.compared, NO, NO),
    Capability("design of excitations", ours.design, NO, NO),
    Capability("python-control", ours.control, NO, NO),
    Capability("data of benchmarks from the net", NO, theirs.bla_benchmarks, NO),
]


def rows():
    packages = (("frfid", "frfid"), ("bla", "best_linear_approximation"), ("pyfrf", "pyFRF"))
    for one in CAPABILITIES:
        yield (one.what, *(cell(getattr(one, column), module) for column, module in packages))


def cell(claim, module):
    """The word of a claim, once it has been shown."""
    word, show = claim if isinstance(claim, tuple) else ("yes", claim) if callable(claim) else (claim, None)
    if show is None:
        return word
    if importlib.util.find_spec(module) is None:
        return NOT_HERE
    try:
        is_so = show()
    except ModuleNotFoundError:  # an extra
        return NOT_HERE
    assert is_so, f"{module} does not do what is said of it: {show.__name__}"
    return word
