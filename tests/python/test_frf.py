"""The FRF in other packages: values, units and axes must arrive unchanged."""

import copy
import json
import pickle
import xml.etree.ElementTree

import numpy as np
import pytest

import frfid

RNG = np.random.default_rng(3)


@pytest.fixture
def frf():
    """Two outputs, three inputs, with both variances."""
    u, y = RNG.standard_normal((4, 3, 1, 3, 64)), RNG.standard_normal((4, 3, 2, 2, 64))
    u = np.repeat(u, 2, axis=2)
    return frfid.estimate_bla(u, y, sample_time_s=1e-2, harmonics=[2, 3, 5, 8, 13])


def test_shapes_and_covariances(frf):
    assert (frf.response.shape, frf.response.dtype) == ((5, 2, 3), np.complex128)
    assert (frf.n_outputs, frf.n_inputs, frf.total_degrees_of_freedom) == (2, 3, 3)
    assert 1 < frf.noise_degrees_of_freedom < 4  # of 4: the realizations are excited unlike
    for output, k in np.ndindex(2, 3):
        entry = k * 2 + output
        np.testing.assert_array_equal(frf.noise_variance[:, output, k], frf.noise_covariance[:, entry, entry].real)
        np.testing.assert_array_equal(frf.total_variance[:, output, k], frf.total_covariance[:, entry, entry].real)
    assert frf.covariance is frf.total_covariance
    np.testing.assert_array_equal(frf.nonlinear_variance, 4 * (frf.total_variance - frf.noise_variance))


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
    assert converted.input_labels == frf.input_names
    for line, hz in enumerate(frf.frequency_hz):
        np.testing.assert_array_equal(converted.eval(2 * np.pi * hz), frf.response[line])


def test_lines_without_an_estimate_stay_unknown(frf, tmp_path):
    response = np.array(frf.response)
    response[1] = np.nan
    gapped = frfid.Frf(
        frequency_hz=frf.frequency_hz,
        response=response,
        noise_covariance=np.where(np.arange(5)[:, None, None] == 1, np.nan, frf.noise_covariance),
        noise_degrees_of_freedom=4,
        condition=np.where(np.arange(5) == 1, np.nan, frf.condition),
    )
    gapped.save(tmp_path / "gapped.json")
    back = frfid.load(tmp_path / "gapped.json")
    np.testing.assert_array_equal(back.response, response)
    assert np.isnan(back.noise_variance[1]).all() and np.isfinite(back.noise_variance[2]).all()
    assert "nan" not in back.to_svg().lower()
    assert "lines without an estimate" in back._repr_html_() and "nan" not in back._repr_html_().split("base64")[0]
    compared = frfid.compare(frf, gapped)
    assert compared.unknown_lines == (0, 1)
    pytest.importorskip("control")
    assert len(back.to_control().omega) == 4


def test_xarray_knows_dimensions_units_and_only_what_was_measured(frf):
    pytest.importorskip("xarray")
    dataset = frf.to_xarray()
    assert dataset.attrs == frf.provenance and list(dataset.input.values) == ["input 1", "input 2", "input 3"]
    assert dataset.response.dims == ("frequency", "output", "input")
    assert dataset.frequency.attrs["units"] == "Hz"
    np.testing.assert_array_equal(dataset.noise_variance.values, frf.noise_variance)
    assert dataset.response.sel(frequency=3.0, method="nearest").values[1, 2] == frf.response[0, 1, 2]
    bare = frfid.Frf(frequency_hz=[1.0], response=np.ones((1, 1, 1))).to_xarray()
    assert list(bare.data_vars) == ["response"]


def test_a_notebook_shows_a_table_and_a_picture(frf):
    html = frf._repr_html_()
    assert "2 x 3" in html and 'src="data:image/svg+xml;base64,' in html
    picture = xml.etree.ElementTree.fromstring(frf.to_svg())
    assert picture.tag.endswith("svg") and "output 2" in "".join(picture.itertext())
    assert "noise variance measured" in repr(frf)
    for hz in ([], [0.0, 1.0]):  # nothing a logarithmic axis could show
        assert "<img" not in frfid.Frf(frequency_hz=hz, response=np.ones((len(hz), 1, 1)))._repr_html_()


def test_a_saved_result_comes_back(frf, tmp_path):
    path = tmp_path / "result.json"
    frf.save(path)
    back = frfid.load(str(path))
    for name in ("frequency_hz", "response", "noise_covariance", "total_covariance", "condition"):
        np.testing.assert_array_equal(getattr(back, name), getattr(frf, name))
    assert back.provenance == frf.provenance and back.provenance["frfid_version"] == frfid.__version__
    with pytest.raises(FileExistsError, match="result.json exists"):
        frf.save(path)
    frf.save(path, overwrite=True)
    assert [entry.name for entry in tmp_path.iterdir()] == ["result.json"]


def test_files_that_are_no_results_are_refused(tmp_path):
    with pytest.raises(FileNotFoundError):
        frfid.load(tmp_path / "nowhere.json")
    (tmp_path / "other.json").write_text('{"format": "else"}')
    with pytest.raises(ValueError, match="other.json: found .*needed a result written by frfid"):
        frfid.load(tmp_path / "other.json")
    with pytest.raises(OSError):
        frfid.Frf(frequency_hz=[1.0], response=np.ones((1, 1, 1))).save(tmp_path / "no" / "folder.json")


def test_names_units_checks_and_provenance_travel(tmp_path):
    check = {"name": "periods", "passed": False, "found": "1", "needed": "2", "advice": "measure longer"}
    belongings = dict(input_names=["torque"], input_units=["N m"], checks=[check], provenance={"seed": "5"},
                      torque_rms_nm=[41.5], flagged=[True])
    frf = frfid.Frf(frequency_hz=[1.0], response=np.ones((1, 2, 1)), **belongings)
    frf.save(tmp_path / "result.json")
    for other in (frf, frfid.load(tmp_path / "result.json"), copy.copy(frf)):
        assert {name: getattr(other, name) for name in belongings} == belongings
        assert (other.output_names, other.output_units) == (["output 1", "output 2"], ["", ""])
    with pytest.raises(ValueError, match="flagged has 2 entries, needed 1"):
        frfid.Frf(frequency_hz=[1.0], response=np.ones((1, 2, 1)), flagged=[True, False])
    with pytest.raises(ValueError, match="output_names has 1 entries, needed 2"):
        frfid.Frf(frequency_hz=[1.0], response=np.ones((1, 2, 1)), output_names=["only one"])


def test_two_frfs_are_compared():
    hz = np.geomspace(2.0, 50.0, 400)
    soft, stiff = (frfid.Plant.single_joint(stiffness_nm_per_rad=k).frf(hz, hold="continuous") for k in (1.5e5, 2.55e5))
    verdict = frfid.compare(soft, stiff, stronger="b")
    assert str(verdict).startswith("stiffness grows with deflection: the stronger excitation finds the resonance at 15.1")
    assert verdict.band_hz == (2.0, 50.0)
    notch, peak = verdict.entries[0]["changes"]
    assert (notch["a"]["kind"], peak["a"]["kind"]) == ("antiresonance", "resonance")
    for change, shift in ((notch, 6.5590 - 5.0289), (peak, 15.1254 - 11.6211)):
        assert change["has_moved"] and change["shift_hz"] == pytest.approx(shift, abs=0.02)
    assert (verdict.verdict, verdict.verdict_entry) == (str(verdict), (0, 0))
    same = frfid.compare(soft, soft)
    assert str(same) == "nothing stands out" and same.verdict is None
    assert same.agrees is None and same.agreement == {"kind": "unknown", "reason": "no-covariance"}
    assert notch["a"]["frequency_std_hz"] is None and notch["shift_std_percent"] is None
    with pytest.raises(ValueError, match="stronger: unknown variant `c`"):
        frfid.compare(soft, stiff, stronger="c")
    with pytest.raises(ValueError, match="60"):
        frfid.compare(soft, frfid.Plant.single_joint().frf(np.linspace(60.0, 70.0, 9), hold="continuous"))


@pytest.mark.parametrize(
    "change, says",
    [
        ({"frequency_hz": [-1.0, 1.0, 2.0]}, "line 0 is at -1 Hz; needed: 0 or more"),
        ({"frequency_hz": [1.0, np.nan, 2.0]}, "line 1 is at NaN Hz"),
        ({"frequency_hz": [2.0, 1.0, 3.0]}, "rising from line to line"),
        ({"condition": [-1.0, 0.0, np.nan]}, "condition holds -1; needed: 1 or more, NaN where it is not known"),
        ({"condition": [1.0, 2.0, 0.99]}, "condition holds 0.99"),
        ({"relative_resolution": -0.1}, "relative_resolution is -0.1"),
    ],
)
def test_numbers_that_cannot_be_are_refused(change, says):
    sound = {"frequency_hz": [1.0, 2.0, 3.0], "response": np.ones((3, 1, 1)), "condition": [1.0, np.nan, np.inf]}
    frfid.Frf(**sound)
    with pytest.raises(ValueError, match=says):
        frfid.Frf(**{**sound, **change})


@pytest.mark.parametrize("lines", ["[null, 2.0, 3.0]", "[-1.0, 2.0, 3.0]", "[3.0, 2.0, 1.0]"])
def test_files_with_such_frequencies_are_refused(tmp_path, lines):
    path = tmp_path / "frf.json"
    frfid.Frf(frequency_hz=[1.0, 2.0, 3.0], response=np.ones((3, 1, 1))).save(path)
    content = json.loads(path.read_text())
    content["frequency_hz"]["data"] = json.loads(lines)
    content.pop("sha256", None)
    path.write_text(json.dumps(content))
    with pytest.raises(ValueError, match="Hz; needed: 0 or more"):
        frfid.load(path)


def test_frfs_from_zero_on_are_compared():
    frf = frfid.Frf(frequency_hz=[0.0, 1.0, 2.0, 3.0], response=np.ones((4, 1, 1)))
    assert frfid.compare(frf, frf).band_hz[1] == 3.0
