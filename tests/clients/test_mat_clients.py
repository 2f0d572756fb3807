"""MAT recordings: level 5 by scipy, v7.3 by h5py as MATLAB lays them out; vectors, matrices, structs as Simulink writes them, packed or not."""

import subprocess

import numpy as np
import pytest
from bench import FRFID, MARKS, estimate, from_csv, samples

io = pytest.importorskip("scipy.io", reason="needs scipy: pip install .[test]")
pytestmark = MARKS


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    return from_csv(tmp_path_factory.mktemp("csv"))


def check_sources(file, plain):
    """Every layout gives the FRF of the bench, and single precision one that is close to it."""
    for source_u, source_y, time in [
        ("u", "y", "t=s"), ("rows[0]", "rows[1]", "t=s"), ("columns[0]", "columns[1]", "stamp=ns"),
        ("out.signals(1).values", "out.signals(2).values", "out.time=s"), ("u", "out.inner.y", "stamp=ns"),
    ]:
        np.testing.assert_allclose(estimate(file, source_u, source_y, "--time", time), plain, rtol=1e-9, err_msg=source_u)
    coarse = estimate(file, "u", "single", "--time", "t=s")
    assert 1e-12 < np.max(np.abs(coarse / plain - 1)) < 1e-2


def check_refusals(file, refusals):
    """What holds no numbers is named, with what helps."""
    for source, said in refusals:
        arguments = ["estimate", file, "-o", file.parent / "x.json", "--u", f"{source}=A", "--y", "y=rad/s", "--time", "t=s"]
        done = subprocess.run([FRFID, *map(str, arguments)], capture_output=True, text=True)
        assert done.returncode in (1, 2) and said in done.stderr, (source, done.stderr)


@pytest.mark.parametrize("packed", [True, False])
def test_layouts(packed, plain, tmp_path):
    t, _, u, y, *_ = samples().T
    ns = np.round(t * 1e9).astype(np.int64) + 1_700_000_000_000_000_000
    signals = np.zeros(2, dtype=[("label", object), ("values", object)])
    signals["label"], signals["values"] = ["u", "y"], [u[:, None], y.reshape(1, 1, -1)]
    file = tmp_path / "log.mat"
    content = {
        "t": t, "u": u[:, None], "y": y[None, :], "single": y.astype(np.float32), "note": "bench 3", "rows": np.stack([u, y]), "columns": np.stack([u, y]).T,
        "stamp": ns, "out": {"time": t[:, None], "signals": signals, "inner": {"y": y}}, "cells": np.array([1, "a"], dtype=object),
    }
    io.savemat(file, content, do_compression=packed)
    check_sources(file, plain)
    check_refusals(file, [("note", "a text"), ("cells", "a cell array"), ("out", "out.signals(1).values"), ("nothing", "one of"), ("rows", "channel")])


@pytest.mark.parametrize("packed", [True, False])
def test_layouts_of_73(packed, plain, tmp_path):
    pytest.importorskip("h5py", reason="needs h5py: pip install .[test]")
    from matlab73 import MatFile

    t, _, u, y, *_ = samples().T
    ns = np.round(t * 1e9).astype(np.int64) + 1_700_000_000_000_000_000
    path = tmp_path / "log.mat"
    with MatFile(path, packed) as file:
        file.put("t", t[:, None])
        file.put("u", u[:, None])
        file.put("y", y[None, :])
        file.put("single", y.astype(np.float32))
        file.put("on", u > 0)
        file.put("rows", np.stack([u, y]))
        file.put("columns", np.stack([u, y]).T)
        file.put("stamp", ns[:, None])
        signals = [{"label": "u", "values": u[:, None]}, {"label": "y", "values": y}]
        file.put("out", {"time": t[:, None], "signals": signals, "inner": {"y": y}})
        file.put("cells", (u, "a"))
        file.opaque("logsout", "Simulink.SimulationData.Dataset")
        file.opaque("series", "timeseries")
    check_sources(path, plain)
    check_refusals(path, [("cells", "a cell array"), ("out", "out.signals(1).values"), ("nothing", "one of"), ("rows", "channel"),
                         ("logsout", "x = logsout{1}.Values"), ("series", "save('log.mat', 't', 'v', '-v7')")])
