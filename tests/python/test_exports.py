"""Exports of a result, opened by those they are for: numpy and scipy (which reads MAT files as MATLAB writes them)."""

import subprocess
import sys

import numpy as np
import pytest
import scipy.io

import frfid


def export(result, to, output):
    command = [sys.executable, "-c", "import sys; from frfid._cli import main; sys.exit(main())"]
    subprocess.run([*command, "export", result, "--to", to, "-o", output], check=True, capture_output=True)


@pytest.fixture
def frf():
    rng = np.random.default_rng(0)

    def complex_normal(*shape):
        return rng.normal(size=shape) + 1j * rng.normal(size=shape)

    root = complex_normal(5, 6, 6)
    return frfid.Frf(
        frequency_hz=[0.1, 0.2, 0.1 + 0.2, 1 / 3, 7.0],
        response=complex_normal(5, 2, 3),
        total_covariance=root @ root.conj().swapaxes(-1, -2),
        total_degrees_of_freedom=9,
        condition=[1.0, 2.0, np.inf, 1.5, 1.0],
        input_names=["axis 1 torque", "µ-Drehmoment", ""],
        output_names=["a", "bc"],
        input_units=["N m", "N m", "A"],
        output_units=["rad/s", "m/s^2"],
    )


def test_numpy_and_scipy_find_the_same_arrays_names_and_units(frf, tmp_path):
    frf.save(tmp_path / "frf.json")
    export(tmp_path / "frf.json", "npz", tmp_path / "frf.npz")
    export(tmp_path / "frf.json", "mat", tmp_path / "frf.mat")
    npz, mat = np.load(tmp_path / "frf.npz"), scipy.io.loadmat(tmp_path / "frf.mat")
    names = {name for name in mat if not name.startswith("__")}
    assert names == set(npz.files) and "noise_variance" not in names
    for name in ("response", "total_variance", "total_covariance"):
        np.testing.assert_array_equal(mat[name], npz[name])
        np.testing.assert_array_equal(npz[name], getattr(frf, name))
    for name in ("frequency_hz", "condition"):
        np.testing.assert_array_equal(mat[name], npz[name][:, None])
        np.testing.assert_array_equal(npz[name], getattr(frf, name))
    assert mat["total_degrees_of_freedom"] == npz["total_degrees_of_freedom"] == 9
    for name in ("input_names", "output_names", "input_units", "output_units"):
        texts = ["".join(cell[0]) for cell in mat[name]]
        assert texts == list(npz[name]) == getattr(frf, name)


def test_a_mat_file_has_the_variables_that_matlab_lists(frf, tmp_path):
    frf.save(tmp_path / "frf.json")
    export(tmp_path / "frf.json", "mat", tmp_path / "frf.mat")
    listed = {name: (shape, kind) for name, shape, kind in scipy.io.whosmat(tmp_path / "frf.mat")}
    assert listed["response"] == ((5, 2, 3), "double") and listed["input_names"] == ((3, 1), "cell")
    assert (tmp_path / "frf.mat").read_bytes()[:19] == b"MATLAB 5.0 MAT-file"
