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


def command_line(*arguments):
    command = [sys.executable, "-c", "import sys; from frfid._cli import main; sys.exit(main())"]
    subprocess.run([*command, *arguments], check=True, capture_output=True)


@pytest.mark.parametrize("name", ["csv", "npz", "mat", "uff"])
def test_methods_write_the_bytes_of_the_command_line(frf, name, tmp_path):
    frf.save(tmp_path / "frf.json")
    command_line("export", tmp_path / "frf.json", "-o", tmp_path / f"a.{name}")
    write = getattr(frf, f"to_{name}")
    write(tmp_path / f"b.{name}")
    assert (tmp_path / f"a.{name}").read_bytes() == (tmp_path / f"b.{name}").read_bytes()
    with pytest.raises(FileExistsError, match="overwrite=True"):
        write(tmp_path / f"b.{name}")
    write(str(tmp_path / f"b.{name}"), overwrite=True)


def test_a_page_is_that_of_the_command_line(frf, tmp_path):
    frf.save(tmp_path / "bench.json")
    command_line("report", tmp_path / "bench.json", "-o", tmp_path / "a.html")
    frf.report(tmp_path / "bench.html")
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "bench.html").read_bytes()
    frf.report(tmp_path / "b.html", "A <title>", "Gear 7")
    page = (tmp_path / "b.html").read_text(encoding="utf-8")
    assert "<title>A &lt;title&gt;</title>" in page and "<p>Gear 7</p>" in page
    with pytest.raises(FileExistsError):
        frf.report(tmp_path / "b.html")
    at_rest = frfid.Frf(frequency_hz=[0.0, 1.0], response=np.ones((2, 1, 1)))
    with pytest.raises(ValueError, match="frequency_hz"):
        at_rest.report(tmp_path / "c.html")


def test_what_a_universal_file_has_no_room_for_is_refused(tmp_path):
    close = frfid.Frf(frequency_hz=[1000.0, 1000.0001, 1001.0], response=np.ones((3, 1, 1)))
    with pytest.raises(ValueError, match="1000.0 and 1000.0001 Hz"):
        close.to_uff(tmp_path / "frf.uff")
    unknown = frfid.Frf(frequency_hz=[1.0, 2.0], response=np.full((2, 1, 1), np.nan))
    with pytest.raises(ValueError, match="nothing but NaN"):
        unknown.to_uff(tmp_path / "frf.uff")
    assert not list(tmp_path.iterdir())
