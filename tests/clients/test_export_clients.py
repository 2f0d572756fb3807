"""Exports of a result, opened by those they are for: pyuff, pandas, numpy, scipy and Octave find response, names, units and variances."""

import json
import shutil
import subprocess

import numpy as np
import pytest

FRFID = shutil.which("frfid")
pytestmark = pytest.mark.skipif(FRFID is None, reason="needs the command frfid: pip install .")
HZ = [0.5, 1.25, 2.5, 5.0, 9.75, 20.0]
INPUTS, OUTPUTS = [("elbow torque", "N m"), ("shoulder torque", "N m")], [("elbow velocity", "rad/s"), ("tip", "m/s^2"), ("current", "A")]


def complex_json(array):
    number = lambda value: None if np.isnan(value) else value  # noqa: E731
    return {"shape": list(array.shape), "re": [number(x) for x in array.real.ravel()], "im": [number(x) for x in array.imag.ravel()]}


def result(hz, unknown=()):
    """A result in the JSON of docs/formats.md, its response and its noise variance; these lines of the first entry are not known."""
    rng = np.random.default_rng(1)
    lines, outputs, inputs = len(hz), len(OUTPUTS), len(INPUTS)
    root = rng.normal(size=(lines, 6, 6)) + 1j * rng.normal(size=(lines, 6, 6))
    covariance = root @ root.conj().swapaxes(1, 2)
    response = rng.normal(size=(lines, outputs, inputs)) + 1j * rng.normal(size=(lines, outputs, inputs)) * 1e-7
    response[list(unknown), 0, 0] = np.nan * (1 + 1j)
    # row and column `input n_out + output` of the covariance
    variance = np.diagonal(covariance, axis1=1, axis2=2).real.reshape(lines, inputs, outputs).swapaxes(1, 2)
    names = {"input_names": INPUTS, "output_names": OUTPUTS}
    content = {"format": "frfid-result", "version": 1} | {key: [name for name, _ in pairs] for key, pairs in names.items()}
    content |= {key.replace("names", "units"): [unit for _, unit in pairs] for key, pairs in names.items()}
    content |= {"frequency_hz": {"shape": [lines], "data": hz}, "response": complex_json(response)}
    content |= {"noise": {"degrees_of_freedom": 12.5, "covariance": complex_json(covariance)}, "checks": [], "provenance": {}}
    return content, response, variance


def exported(folder, content, name):
    (folder / "frf.json").write_text(json.dumps(content))
    done = subprocess.run([FRFID, "export", folder / "frf.json", "-o", folder / name], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder / name


@pytest.mark.parametrize("even", [True, False])
def test_pyuff(even, tmp_path):
    pyuff = pytest.importorskip("pyuff", reason="needs pyuff: pip install .[test] (Python 3.11 or newer)")
    hz = [0.1 * k for k in range(1, 41)] if even else HZ
    content, response, variance = result(hz)
    sets = pyuff.UFF(str(exported(tmp_path, content, "frf.uff"))).read_sets()
    assert [each["type"] for each in sets] == [164] + 12 * [58]
    assert sets[0]["units_code"] == 1
    pairs = [(o, i) for o in range(3) for i in range(2)]
    for (o, i), g, noise in zip(pairs, sets[1::2], sets[2::2]):
        assert (g["func_type"], g["ord_data_type"], g["abscissa_spacing"]) == (4, 6, int(even))
        np.testing.assert_allclose(g["x"], hz, rtol=5e-6)  # six digits
        for part in ("real", "imag"):
            np.testing.assert_allclose(getattr(g["data"], part), getattr(response[:, o, i], part), rtol=5e-13)  # thirteen
        assert g["id1"] == f"{OUTPUTS[o][0]} / {INPUTS[i][0]}" and g["id2"] == "frequency response" and g["id4"] == f"all {len(hz)} lines"
        assert (g["ordinate_axis_lab"], g["ordinate_axis_units_lab"]) == OUTPUTS[o]
        assert (g["orddenom_axis_lab"], g["orddenom_axis_units_lab"]) == INPUTS[i]
        assert (g["abscissa_spec_data_type"], g["abscissa_axis_units_lab"]) == (18, "Hz")
        assert (g["rsp_node"], g["ref_node"]) == (o + 1, i + 1)
        assert (g["rsp_dir"], g["ordinate_spec_data_type"]) == [(6, 11), (3, 12), (0, 0)][o]  # about z, along z, neither
        assert (g["ref_dir"], g["orddenom_spec_data_type"]) == (6, 13)
        assert noise["func_type"] == 0 and noise["id1"] == g["id1"]
        assert noise["id2"] == "noise variance of the response, E|dG|^2; 12.5 degrees of freedom"
        assert noise["ordinate_axis_units_lab"] == f"({OUTPUTS[o][1]})^2"
        np.testing.assert_allclose(noise["data"], variance[:, o, i], rtol=5e-13)
        np.testing.assert_allclose(noise["x"], hz, rtol=5e-6)


def test_pyuff_finds_no_line_that_is_not_known(tmp_path):
    pyuff = pytest.importorskip("pyuff", reason="needs pyuff: pip install .[test] (Python 3.11 or newer)")
    content, response, _ = result(HZ, unknown=[1, 4])
    sets = pyuff.UFF(str(exported(tmp_path, content, "frf.uff"))).read_sets()
    known = [0, 2, 3, 5]
    np.testing.assert_allclose(sets[1]["x"], np.array(HZ)[known], rtol=5e-6)
    np.testing.assert_allclose(sets[1]["data"], response[known, 0, 0], rtol=1e-12)
    assert sets[1]["id4"] == "2 of 6 lines are not known and left out"
    assert len(sets[2]["x"]) == len(sets[3]["x"]) == 6 and sets[3]["id4"] == "all 6 lines"


def test_pandas(tmp_path):
    pandas = pytest.importorskip("pandas", reason="needs pandas: pip install .[test]")
    content, response, variance = result(HZ, unknown=[1])
    table = pandas.read_csv(exported(tmp_path, content, "frf.csv"))
    np.testing.assert_array_equal(table["frequency [Hz]"], HZ)
    for o, (output, output_unit) in enumerate(OUTPUTS):
        for i, (name, input_unit) in enumerate(INPUTS):
            column = f"{output} / {name} [{output_unit} per {input_unit}]"
            found = table[f"re {column}"] + 1j * table[f"im {column}"]
            np.testing.assert_allclose(found, response[:, o, i], rtol=1e-15)
            np.testing.assert_allclose(table[f"noise standard deviation {column}"] ** 2, variance[:, o, i], rtol=1e-14)


def test_numpy_and_scipy(tmp_path):
    io = pytest.importorskip("scipy.io", reason="needs scipy: pip install .[test]")
    content, response, variance = result(HZ, unknown=[1])
    npz, mat = np.load(exported(tmp_path, content, "frf.npz")), io.loadmat(exported(tmp_path, content, "frf.mat"))
    for arrays in (npz, mat):
        np.testing.assert_array_equal(arrays["response"], response)
        np.testing.assert_array_equal(arrays["noise_variance"], variance)
        np.testing.assert_array_equal(np.ravel(arrays["frequency_hz"]), HZ)
        assert float(np.squeeze(arrays["noise_degrees_of_freedom"])) == 12.5
    for key in ("input_names", "output_names", "input_units", "output_units"):
        assert list(npz[key]) == ["".join(cell[0]) for cell in mat[key]] == content[key]


OCTAVE = """
load('{file}');
printf('%.17g ', size(response)); printf('\\n');
printf('%.17g ', real(response)(:)); printf('\\n');
printf('%.17g ', imag(response)(:)); printf('\\n');
printf('%.17g ', noise_variance(:)); printf('\\n');
printf('%s|', output_names{{:}}, input_names{{:}}, output_units{{:}}, input_units{{:}}); printf('\\n');
"""


def test_octave(tmp_path):
    octave = shutil.which("octave-cli") or shutil.which("octave")
    if octave is None:
        print("SKIPPED: Octave is not installed")
        pytest.skip("needs Octave: apt-get install octave")
    content, response, variance = result(HZ)
    script = OCTAVE.format(file=exported(tmp_path, content, "frf.mat"))
    done = subprocess.run([octave, "--no-gui", "--quiet", "--norc", "--eval", script], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    size, re, im, noise, texts = done.stdout.splitlines()
    assert size.split() == ["6", "3", "2"]
    numbers = lambda line: np.array(line.split(), float)  # noqa: E731
    np.testing.assert_array_equal(numbers(re) + 1j * numbers(im), response.ravel(order="F"))
    np.testing.assert_array_equal(numbers(noise), variance.ravel(order="F"))
    keys = ("output_names", "input_names", "output_units", "input_units")
    assert texts.split("|")[:-1] == [text for key in keys for text in content[key]]
