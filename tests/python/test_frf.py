"""The FRF in other packages: values, units and axes must arrive unchanged."""

import copy
import pickle

import numpy as np
import pytest

import frfid

RNG = np.random.default_rng(3)


@pytest.fixture
def frf():
    """Two outputs, three inputs, with both variances."""
    u, y = RNG.standard_normal((4, 3, 2, 3, 64)), RNG.standard_normal((4, 3, 2, 2, 64))
    return frfid.estimate_bla(u, y, sample_time_s=1e-2, harmonics=[2, 3, 5, 8, 13])


def test_shapes_and_covariances(frf):
    assert (frf.response.shape, frf.response.dtype) == ((5, 2, 3), np.complex128)
    assert (frf.n_outputs, frf.n_inputs, frf.noise_degrees_of_freedom, frf.total_degrees_of_freedom) == (2, 3, 4, 3)
    for output, k in np.ndindex(2, 3):
        entry = k * 2 + output
        np.testing.assert_array_equal(frf.noise_variance[:, output, k], frf.noise_covariance[:, entry, entry].real)
        np.testing.assert_array_equal(frf.total_variance[:, output, k], frf.total_covariance[:, entry, entry].real)
    assert frf.covariance is frf.total_covariance
    np.testing.assert_array_equal(frf.nonlinear_variance, np.maximum(4 * (frf.total_variance - frf.noise_variance), 0))


def test_what_was_not_measured_is_none():
    frf = frfid.Frf(frequency_hz=[1.0, 2.0], response=np.ones((2, 1, 1)))
    for name in ("noise_variance", "total_variance", "nonlinear_variance", "covariance", "condition", "noise_degrees_of_freedom"):
        assert getattr(frf, name) is None


def test_a_covariance_needs_its_degrees_of_freedom(frf):
    with pytest.raises(ValueError, match="belong together"):
        frfid.Frf(frequency_hz=frf.frequency_hz, response=frf.response, noise_covariance=frf.noise_covariance)
    with pytest.raises(ValueError, match="response has shape"):
        frfid.Frf(frequency_hz=[1.0], response=np.ones((2, 1, 1)))


@pytest.mark.parametrize("clone", [lambda frf: pickle.loads(pickle.dumps(frf)), copy.deepcopy])
def test_pickles_are_equal(frf, clone):
    other = clone(frf)
    for name in ("frequency_hz", "response", "noise_covariance", "total_covariance", "condition", "nonlinear_variance"):
        np.testing.assert_array_equal(getattr(other, name), getattr(frf, name))
    assert other.noise_degrees_of_freedom == frf.noise_degrees_of_freedom


def test_python_control_evaluates_it_in_rad_per_s(frf):
    pytest.importorskip("control")
    converted = frf.to_control()
    assert (converted.noutputs, converted.ninputs) == (2, 3)
    for line, hz in enumerate(frf.frequency_hz):
        np.testing.assert_array_equal(converted.eval(2 * np.pi * hz), frf.response[line])


def test_xarray_knows_dimensions_units_and_only_what_was_measured(frf):
    pytest.importorskip("xarray")
    dataset = frf.to_xarray()
    assert dataset.response.dims == ("frequency", "output", "input")
    assert dataset.frequency.attrs["units"] == "Hz"
    np.testing.assert_array_equal(dataset.noise_variance.values, frf.noise_variance)
    assert dataset.response.sel(frequency=3.0, method="nearest").values[1, 2] == frf.response[0, 1, 2]
    bare = frfid.Frf(frequency_hz=[1.0], response=np.ones((1, 1, 1))).to_xarray()
    assert list(bare.data_vars) == ["response"]


def test_the_bode_plot_shows_the_numbers(frf):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = frf.plot.bode(label="first")
    assert axes.shape == (4, 3)
    curve = axes[2, 1].lines[0]
    np.testing.assert_array_equal(curve.get_xdata(), frf.frequency_hz)
    np.testing.assert_allclose(curve.get_ydata(), 20 * np.log10(np.abs(frf.response[:, 1, 1])))
    np.testing.assert_allclose(axes[3, 1].lines[0].get_ydata(), np.degrees(np.angle(frf.response[:, 1, 1])))
    assert len(axes[0, 0].lines) == 3, "response and two standard deviations"
    assert frf.plot.bode(ax=axes) is not None and len(axes[0, 0].lines) == 6


def test_a_notebook_shows_a_table(frf):
    assert "<table>" in frf._repr_html_() and "2 x 3" in frf._repr_html_()
    assert "noise variance measured" in repr(frf)
