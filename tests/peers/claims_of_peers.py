"""What is said of the other packages, done: every function is true. They are imported where they are needed."""

import functools
import warnings

import numpy as np

import vibration
from scenarios import LAYOUTS, scenario


@functools.cache
def bla():
    import bla_package

    return bla_package.estimate(scenario("closed loop", LAYOUTS[1], "both", 7, 10))


def bla_response():
    return bla().G.value.shape == (15, 3, 2)


def bla_covariances():
    return bla().G.noise.cov.shape == bla().G.total.cov.shape == (15, 6, 6)


def bla_distortion():
    return np.linalg.eigvalsh(bla().G.nonlinear.cov).min() > -1e-12


def bla_spectra():
    return bla().spectra.U.total.cov.shape == (15, 2, 2) and bla().spectra.Y.total_equation_error.cov.shape == (15, 3, 3)


def bla_noise_between():
    return bla().spectra.Y.noise.cov.shape == (17, 3, 3)


def bla_through_reference():
    return bla().spectra.R is not None


def bla_unsettled():
    from best_linear_approximation import robust

    one = scenario("known input", LAYOUTS[0], "noise", 7, 2)
    u, y = (signal.transpose(4, 3, 1, 0, 2) for signal in (one.u, one.y))
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        robust.known_input(u[..., 0], y * np.linspace(1, 2, y.shape[-1]), 1e3, np.arange(1, 16))
    return any("spectral mismatch" in str(one.message) for one in said)


def bla_benchmarks():
    """There, but not fetched here."""
    import best_linear_approximation

    return callable(best_linear_approximation.load_silverbox)


@functools.cache
def pyfrf(window="none", n_inputs=1):
    import pyfrf_package

    test = vibration.hammer(5, motion_noise=0.05) if n_inputs == 1 else vibration.shaker(3, motion_noise=0.1)
    return pyfrf_package.analyse(test, window)


def pyfrf_response():
    return pyfrf("hann", 2).get_FRF("H1").shape == (3, 2, 1001)


def pyfrf_h1_h2():
    h1, h2 = (np.abs(pyfrf().get_FRF(name)[0, 0, 1:]) for name in ("H1", "H2"))
    return (h1 < h2).all()


def pyfrf_hv():
    h1, hv, h2 = (np.abs(pyfrf().get_FRF(name)[0, 0, 1:]) for name in ("H1", "Hv", "H2"))
    return ((h1 <= hv) & (hv <= h2)).all()


def pyfrf_coherence():
    return pyfrf("hann", 2).get_coherence().shape == (3, 1001)


def pyfrf_ordinary():
    return pyfrf().get_coherence().shape == (1, 2049)


def pyfrf_segments():
    return pyfrf("hann", 2).noverlap == 1000


def pyfrf_windows():
    return pyfrf(("force:0.01", "exponential:0.1")).exc_window_data[100] == 0.0


def pyfrf_overload():
    force = vibration.hammer(1).force
    return bool(pyfrf()._is_overflow(np.clip(force, None, 0.5 * force.max()), overflow_samples=2)[0, 0])


def pyfrf_double_impact():
    """With a limit between its ratios of this blow, 0.004, and of two, 0.24; its own limit is 0.001."""
    force = vibration.hammer(1).force
    found = [bool(pyfrf()._is_double_impact(one, limit=0.03)[0, 0]) for one in (force, force + np.roll(force, 300))]
    return found == [False, True]


def pyfrf_forms():
    receptance, mobility = (pyfrf().get_FRF("H1", form)[0, 0, 1:] for form in ("receptance", "mobility"))
    return np.allclose(mobility, receptance * 1j * pyfrf().get_w_axis()[1:])


def pyfrf_exponential():
    from pyFRF import FRF

    found = FRF(1000, fft_len=4096, resp_type="d", weighting="exponential:3")
    test = vibration.hammer(5, motion_noise=0.05)
    return all(found.add_data(force, motion) for force, motion in zip(test.force, test.motion))
