"""A MAT file v7.3 as MATLAB lays it out, written by h5py: 512 bytes of text before an HDF5 file, MATLAB's attributes.

`python tests/clients/matlab73.py` writes the files of the Rust tests, those of level 5 by scipy.
"""

import pathlib

import h5py
import numpy as np
import scipy.io


def ascii_attr(obj, name, text):
    """As MATLAB: exactly as wide as the text, without the zero behind it."""
    kind = h5py.h5t.C_S1.copy()
    kind.set_size(len(text))
    space = h5py.h5s.create(h5py.h5s.SCALAR)
    h5py.h5a.create(obj.id, name.encode(), kind, space).write(np.array(text.encode(), dtype=f"S{len(text)}"), mtype=kind)


class MatFile:
    """Variables go in by `put`; references lie in `#refs#`, as MATLAB has them."""

    def __init__(self, path, packed=True):
        self.path, self.packed, self.n_refs = path, packed, 0
        self.file = h5py.File(path, "w", userblock_size=512, libver="earliest")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.file.close()
        text = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Thu Nov 26 10:00:00 2026 HDF5 schema 1.00 ."
        block = text.ljust(116) + bytes(8) + b"\x00\x02IM"
        with open(self.path, "r+b") as file:
            file.write(block.ljust(512, b"\0"))

    def dataset(self, parent, name, values, kind, **more):
        """Of a MATLAB array, (row, column), which is stored transposed."""
        values = np.atleast_2d(values).T
        packed = {"compression": 3, "chunks": tuple(min(n, 2000) for n in values.shape)} if self.packed and values.size > 1 else {}
        made = parent.create_dataset(name, data=values, **packed)
        ascii_attr(made, "MATLAB_class", kind)
        for key, value in more.items():
            made.attrs.create(key, value, dtype=np.int32)
        return made

    def put(self, name, value, parent=None):
        """A struct is a dict, an array of structs a list of dicts, a cell array a tuple."""
        parent = self.file if parent is None else parent
        if isinstance(value, dict):
            group = parent.create_group(name)
            ascii_attr(group, "MATLAB_class", "struct")
            for field, inner in value.items():
                self.put(field, inner, group)
        elif isinstance(value, list):
            group = parent.create_group(name)
            ascii_attr(group, "MATLAB_class", "struct")
            for field in value[0]:
                references = [self.refer(element[field]) for element in value]
                group.create_dataset(field, data=np.array(references, dtype=h5py.ref_dtype)[:, None])
        elif isinstance(value, tuple):
            references = np.array([self.refer(element) for element in value], dtype=h5py.ref_dtype)[:, None]
            ascii_attr(parent.create_dataset(name, data=references), "MATLAB_class", "cell")
        elif isinstance(value, str):
            self.dataset(parent, name, np.frombuffer(value.encode("utf-16le"), np.uint16), "char", MATLAB_int_decode=2)
        else:
            self.numbers(name, np.asarray(value), parent)

    def numbers(self, name, value, parent):
        if value.dtype.kind == "c":
            pairs = np.zeros(value.shape, dtype=[("real", float), ("imag", float)])
            pairs["real"], pairs["imag"] = value.real, value.imag
            self.dataset(parent, name, pairs, "double")
        elif value.dtype == bool:
            self.dataset(parent, name, value.astype(np.uint8), "logical", MATLAB_int_decode=1)
        elif value.size == 0:
            empty = parent.create_dataset(name, data=np.zeros(2, np.uint64))
            ascii_attr(empty, "MATLAB_class", "double")
            empty.attrs.create("MATLAB_empty", 1, dtype=np.uint8)
        else:
            kinds = {"float64": "double", "float32": "single"}
            self.dataset(parent, name, value, kinds.get(value.dtype.name, value.dtype.name))

    def refer(self, value):
        refs = self.file.require_group("#refs#")
        self.n_refs += 1
        self.put(f"r{self.n_refs}", value, refs)
        return refs[f"r{self.n_refs}"].ref

    def opaque(self, name, kind):
        """An object, whose data are in `#subsystem#`."""
        self.dataset(self.file, name, np.array([[0xDD000000, 2, 1, 1, 1, 1]], np.uint32), kind, MATLAB_object_decode=3)
        if "#subsystem#" not in self.file:
            self.file.create_group("#subsystem#").create_dataset("MCOS", data=np.zeros(3, np.uint8))


def small(path, packed):
    k = np.arange(12)
    with MatFile(path, packed) as file:
        file.put("t", k[:, None] / 1000)
        file.put("n", k.astype(np.int32)[None, :])
        file.put("m", np.stack([k + 0.5, 10.0 * k]))
        file.put("out", {"time": k / 1000.0, "signals": [{"label": "u", "values": k - 3.0}, {"label": "y", "values": np.float32(k) / 4}]})
        file.put("note", "bench 3")
        file.put("c", (k, "a"))
        file.put("z", k * 1j)
        file.put("none", np.zeros(0))
        file.opaque("ts", "timeseries")
        file.put("loop", {"values": k})
        file.file["loop/loop"] = file.file["loop"]


def small_level5(path, packed):
    k = np.arange(12)
    signals = np.zeros(2, dtype=[("label", object), ("values", object)])
    signals["label"], signals["values"] = ["u", "y"], [k - 3.0, np.float32(k) / 4]
    content = {"t": k[:, None] / 1000, "m": np.stack([k + 0.5, 10.0 * k]), "out": {"time": k / 1000.0, "signals": signals}}
    scipy.io.savemat(path, content, do_compression=packed)
    with open(path, "r+b") as file:  # without the day of writing
        file.write(b"MATLAB 5.0 MAT-file, by scipy".ljust(116))


if __name__ == "__main__":
    golden = pathlib.Path(__file__).parents[1] / "golden"
    small(golden / "matlab73_packed.mat", True)
    small(golden / "matlab73_plain.mat", False)
    small_level5(golden / "matlab5_packed.mat", True)
    small_level5(golden / "matlab5_plain.mat", False)
