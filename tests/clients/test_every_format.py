"""Measured records of four machines in every format and dialect, read back: the same samples to the last digit, the same FRF to 1e-9."""

import csv
import gzip
import pathlib

import frfid
import numpy as np
import pytest

DATA = pathlib.Path(__file__).parents[3] / "shared" / "data"
pytestmark = pytest.mark.skipif(not DATA.is_dir(), reason=f"{DATA} is missing")


def motor_bench():
    """Five periods of 2500 samples: current, and the velocities of motor and load."""
    with gzip.open(DATA / "motor_bench" / "multisine_type_a.csv.gz", "rt") as file:
        table = np.loadtxt(file, delimiter=",", skiprows=1, max_rows=12500)
    return table[:, 0], table[:, [2]].T, table[:, [3, 4]].T, "A", "rad/s"


def wing(level):
    """Five periods of 8192 samples: force, and three accelerations."""
    data = np.load(DATA / "f16" / f"F16Data_FullMSine_Level{level}.npz")
    n = 5 * 8192
    force, accelerations = data["force"].ravel()[:n].astype(float), data["acceleration"][:, :n].astype(float)
    return np.arange(n) / 400, force[None, :], accelerations, "N", "m/s^2"


def silverbox():
    """Two realizations of 8192 samples, one period each: there is no FRF in them alone."""
    data = np.load(DATA / "silverbox" / "snls80mv.npz")
    part = slice(40985, 40985 + 2 * 8692)
    u, y = (data[name].ravel()[part].astype(float)[None, :] for name in "uy")
    return np.arange(u.size) / 610.35, u, y, "V", "V"


RECORDS = {"motor bench": motor_bench, "wing, level 1": lambda: wing(1), "wing, level 7": lambda: wing(7), "silverbox": silverbox}
IS_PERIODIC = {name: name != "silverbox" for name in RECORDS}


def table(t, u, y):
    names = ["t", *(f"u{k}" for k in range(len(u))), *(f"y{k}" for k in range(len(y)))]
    return names, np.c_[t, u.T, y.T]


def text(names, rows, separator=",", decimal=".", quote="", above=(), below=(), end="\n"):
    quoted = [f"{quote}{name}{quote}" for name in names]
    lines = [*above, separator.join(quoted), *below]
    for row in rows.tolist():
        cells = (repr(value).replace(".", decimal) for value in row)
        lines.append(separator.join(f"{quote}{cell}{quote}" for cell in cells))
    return end.join(lines) + end


CSV = {
    "comma": {},
    "tab": {"separator": "\t"},
    "blanks": {"separator": "  "},
    "bars, quoted": {"separator": "|", "quote": '"'},
    "german": {"separator": ";", "decimal": ","},
    "comma and decimal comma, quoted": {"decimal": ",", "quote": '"'},
    "preamble, CRLF": {"above": ["Machine;one", "Date;2026-11-26", ""], "end": "\r\n"},
    "commented": {"above": ["# a log"]},
    "sep=": {"separator": ";", "above": ["sep=;"]},
}
ENCODINGS = {"utf-8-sig": "utf-8-sig", "utf-16": "utf-16", "cp1252": "cp1252"}
PACKED = ["gz", "zst"]
PANDAS = {"en": (",", "."), "de": (";", ","), "fr": (";", ","), "ch": (";", "."), "index": (",", ".")}


def named(path, names):
    signal = lambda name: {"source": name, "unit": "1"}
    return path, {
        "time": {"source": names[0], "unit": "s"},
        "u": [signal(name) for name in names if name.startswith("u")],
        "y": [signal(name) for name in names if name.startswith("y")],
    }


def as_csv(kind, folder, t, u, y):
    names, rows = table(t, u, y)
    path = folder / "log.csv"
    if kind in CSV:
        path.write_text(text(names, rows, **CSV[kind]), newline="")
    elif kind in ENCODINGS:
        path.write_text(text(names, rows), encoding=ENCODINGS[kind], newline="")
    elif kind == "gz":
        path = folder / "log.csv.gz"
        path.write_bytes(gzip.compress(text(names, rows).encode(), 1))
    elif kind == "zst":
        zstandard = pytest.importorskip("zstandard", reason="comes with mcap")
        path = folder / "log.csv.zst"
        path.write_bytes(zstandard.ZstdCompressor().compress(text(names, rows).encode()))
    elif kind == "csv module":
        with open(path, "w", newline="") as file:
            csv.writer(file).writerows([names, *rows.tolist()])
    else:
        pandas = pytest.importorskip("pandas", reason="needs pandas: pip install .[test]")
        separator, decimal = PANDAS[kind]
        frame = pandas.DataFrame(rows, columns=names)
        frame.to_csv(path, sep=separator, decimal=decimal, index=kind == "index")
    return named(path, names)


def as_arrays(kind, folder, t, u, y):
    signal = lambda name: {"source": name, "unit": "1"}
    rows = lambda name, array: [signal(f"{name}[{k}]") for k in range(len(array))] if len(array) > 1 else [signal(name)]
    content = {"t": t, "u": np.squeeze(u), "y": np.squeeze(y)}
    path = folder / f"log.{'npz' if kind == 'npz' else 'mat'}"
    if kind == "npz":
        np.savez(path, **content)
    elif kind.startswith("mat 5"):
        io = pytest.importorskip("scipy.io", reason="needs scipy: pip install .[test]")
        io.savemat(path, content, do_compression=kind.endswith("packed"))
    else:
        pytest.importorskip("h5py", reason="needs h5py: pip install .[test]")
        from matlab73 import MatFile

        with MatFile(path, kind.endswith("packed")) as file:
            for name, array in content.items():
                file.put(name, array)
    return path, {"time": {"source": "t", "unit": "s"}, "u": rows("u", u), "y": rows("y", y)}


def as_bag(kind, folder, t, u, y):
    pytest.importorskip("rosbags", reason="needs rosbags: pip install .[test]")
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    type_name = "std_msgs/msg/Header", "sensor_msgs/msg/JointState"
    header, state, time = (store.types[name] for name in (*type_name, "builtin_interfaces/msg/Time"))
    names = [f"a{k}" for k in range(len(y))]
    writer = Writer(folder / "bag", version=9, storage_plugin=StoragePlugin[kind.split()[0]])
    if kind.endswith("zstd"):
        writer.set_compression(CompressionMode.FILE, CompressionFormat.ZSTD)
    none = np.array([])
    with writer:
        topic = writer.add_connection("/states", type_name[1], typestore=store)
        for stamp_ns, inputs, outputs in zip((np.round(t * 1e9).astype(int) + 10**18).tolist(), u.T, y.T):
            head = header(stamp=time(sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9), frame_id="")
            message = state(head, names, none, np.ascontiguousarray(outputs), np.ascontiguousarray(inputs))
            writer.write(topic, stamp_ns, store.serialize_cdr(message, type_name[1]))
    signal = lambda field, k: {"source": f"/states:{field}[{k}]", "unit": "1"}
    return folder / "bag", {"u": [signal("effort", k) for k in range(len(u))], "y": [signal("velocity", k) for k in range(len(y))]}


FORMATS = {
    **{f"CSV, {kind}": (as_csv, kind) for kind in [*CSV, *ENCODINGS, *PACKED, "csv module"]},
    **{f"pandas, {kind}": (as_csv, kind) for kind in PANDAS},
    **{kind: (as_arrays, kind) for kind in ["npz", "mat 5", "mat 5 packed", "mat 7.3", "mat 7.3 packed"]},
    **{kind: (as_bag, kind) for kind in ["MCAP", "SQLITE3", "MCAP zstd"]},
}


@pytest.fixture(scope="module")
def records(tmp_path_factory):
    """Every record with its FRF, by way of an NPZ."""
    made = {}
    for name, record in RECORDS.items():
        t, u, y, *_ = record()
        path, log_map = as_arrays("npz", tmp_path_factory.mktemp("npz"), t, u, y)
        response = frfid.estimate_logs(path, map=log_map).response if IS_PERIODIC[name] else None
        made[name] = (t, u, y, response)
    return made


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("record", RECORDS)
@pytest.mark.parametrize("kind", FORMATS)
def test_it_comes_back(kind, record, records, tmp_path):
    t, u, y, response = records[record]
    write, dialect = FORMATS[kind]
    path, log_map = write(dialect, tmp_path, t, u, y)
    read = frfid.read(path, map=log_map)
    np.testing.assert_array_equal(read.u, u)
    np.testing.assert_array_equal(read.y, y)
    assert read.sample_time_s == pytest.approx(t[1] - t[0], rel=1e-6)
    if response is not None:
        found = frfid.estimate_logs(path, map=log_map).response
        np.testing.assert_allclose(found, response, rtol=1e-9)
