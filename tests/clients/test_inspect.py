"""`frfid inspect` and `frfid init map`: the motor bench in every format estimates itself by the guessed map, without a further word."""

import json
import subprocess

import numpy as np
import pytest
from bench import FRFID, MARKS, from_csv, samples

scipy_io = pytest.importorskip("scipy.io")

pytestmark = MARKS
NAMES = ["time_s", "current_A", "motor_velocity_rad_per_s"]


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    return from_csv(tmp_path_factory.mktemp("csv"))


def rows():
    return samples()[:, [0, 2, 3]]


def csv(folder):
    np.savetxt(folder / "bench.csv", rows(), delimiter=",", header=",".join(NAMES), comments="", fmt="%.17g")
    return folder / "bench.csv"


def german_csv(folder):
    lines = ["Zeit [s];Strom [A];Drehzahl [rad/s]"]
    lines += [";".join(f"{value:.17g}".replace(".", ",") for value in row) for row in rows()]
    (folder / "bench.csv").write_text("\n".join(lines), encoding="cp1252")
    return folder / "bench.csv"


def mat(folder):
    scipy_io.savemat(folder / "bench.mat", dict(zip(NAMES, rows().T)))
    return folder / "bench.mat"


def npz(folder):
    np.savez(folder / "bench.npz", **dict(zip(NAMES, rows().T)))
    return folder / "bench.npz"


def bag(folder, plugin):
    pytest.importorskip("rosbags", reason="needs rosbags: pip install .[test]")
    from rosbags.rosbag2 import StoragePlugin
    from test_split_bags import STORE, joint_states, write

    return write(folder / "bag", joint_states(STORE), StoragePlugin[plugin])


FORMATS = {"csv": csv, "german csv": german_csv, "mat": mat, "npz": npz}
BAGS = {"mcap": "MCAP", "db3": "SQLITE3"}


def made(kind, folder):
    return FORMATS[kind](folder) if kind in FORMATS else bag(folder, BAGS[kind])


def run(*arguments):
    done = subprocess.run([FRFID, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode in (0, 3), done.stderr
    return done


@pytest.mark.parametrize("kind", [*FORMATS, *BAGS])
def test_the_guessed_map_estimates_without_a_further_word(kind, plain, tmp_path):
    file = made(kind, tmp_path)
    run("init", "map", file, "-o", tmp_path / "map.toml")
    run("estimate", file, "-o", tmp_path / "frf.json", "--map", tmp_path / "map.toml", "--quiet")
    response = json.loads((tmp_path / "frf.json").read_text())["response"]
    found = np.array(response["re"], float) + 1j * np.array(response["im"], float)
    np.testing.assert_allclose(found, plain, rtol=1e-9)


@pytest.mark.parametrize("kind", [*FORMATS, *BAGS])
def test_what_a_person_would_say_is_said(kind, tmp_path):
    file = made(kind, tmp_path)
    said = run("inspect", file).stdout
    assert "2500 Hz" in said and "an estimate would find" in said and "120 Hz" not in said
    assert "! " not in said.split("an estimate would find")[0] or kind == "german csv"
    found = json.loads(run("inspect", file, "--json").stdout)
    assert found["files"][0]["kind"] == "recording" and len(found["map"]["u"]) == 1
    assert found["estimate"]["provenance"]["period_s"] == "1"


def test_what_is_no_signal_is_not_made_one(tmp_path):
    (tmp_path / "log.csv").write_text("a,b\n" + "\n".join(f"{k},{k * k % 7}" for k in range(100)))
    said = run("inspect", tmp_path / "log.csv")
    assert "log map" not in said.stdout and "--u SIGNAL=UNIT" in said.stderr
    done = subprocess.run([FRFID, "init", "map", str(tmp_path / "log.csv")], capture_output=True, text=True)
    assert done.returncode == 2 and "write the map by hand" in done.stderr


def test_gaps_rests_and_odd_signals_are_told(tmp_path):
    t = np.arange(5000) * 1e-3
    u = np.where((t > 1) & (t < 4), np.sin(40 * t), 0.0)
    table = np.c_[t, u, np.clip(np.cumsum(u) * 1e-3, -0.01, 0.01), np.full_like(t, 3.0)]
    table = np.delete(table, slice(2000, 2100), axis=0)
    np.savetxt(tmp_path / "log.csv", table, delimiter=",", header="time_s,torque_Nm,velocity_rad_s,temperature", comments="")
    said = run("inspect", tmp_path / "log.csv").stdout
    assert " 100 " in said and "0.101 s" in said
    assert "temperature does not change: it is 3 throughout" in said
    assert "velocity_rad_s" in said and "stands" in said
