"""Processes: what was used in the parent works in its children, however they are started, and none hangs.

``python test_processes.py`` alone needs nothing but the package and numpy, for any version of Python.
"""

import multiprocessing
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import pytest

import frfid

T = 1e-3
CHILDREN = 100
EXPERIMENT = """
seed = 1
sample_time_s = 0.001
[robot.single_joint]
motor_inertia_kg_m2 = 35.0
link_inertia_kg_m2 = 150.0
damping_nms_per_rad = 400.0
stiffness_nm_per_rad = 1.5e5
coulomb_nm = 50.0
[multisine]
low_hz = 2.0
high_hz = 60.0
resolution_hz = 1.0
n_lines = 20
peak_nm = [150.0]
[averaging]
realizations = 3
periods = 2
"""
SPECTRUM = dict(sample_time_s=T, harmonics=[1, 2, 3, 5])


def experiment():
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "experiment.toml"
        path.write_text(EXPERIMENT)
        return frfid.Experiment.load(path)


def multisine_periods():
    return np.repeat(np.random.default_rng(2).standard_normal((2, 2, 1, 2, 512)), 2, axis=2)


def answers():
    """What every call that computes gives, in few numbers."""
    u = multisine_periods()
    frf = frfid.estimate_bla(u, u + 0.1 * u**2, **SPECTRUM)
    yield frf.response
    yield frfid.compare(frf, frf).agreement["n_lines"]
    record = np.random.default_rng(3).standard_normal((1, 3000))
    yield frfid.estimate_local(record, record, sample_time_s=T, frequencies_hz=np.arange(10, 60.0)).response
    yield frfid.spectrogram(record, sample_time_s=T, window_s=0.5, step_s=0.25)[2]
    joint = frfid.Plant.single_joint(coulomb_nm=50.0)
    yield joint.simulate(np.stack([100 * record] * 3), sample_time_s=T).y
    plan = experiment().design()
    yield plan.predict()["crest_factor"]
    records = plan.run()
    yield plan.estimate(records).response


def digest():
    return [np.abs(np.nan_to_num(np.asarray(answer, complex))).sum() for answer in answers()]


def child(_):
    return digest()


def forked():
    """In a process of its own: all of it in the parent, then in a hundred forked children."""
    mine = digest()
    with multiprocessing.get_context("fork").Pool(4, maxtasksperchild=1) as pool:
        theirs = pool.map_async(child, range(CHILDREN), chunksize=1).get(timeout=240)
    assert theirs == [mine] * CHILDREN, "children compute something else"
    print(f"Python {sys.version.split()[0]}: {len(theirs)} forked children computed what their parent did")


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_hundred_forked_children_compute_what_the_parent_did():
    subprocess.run([sys.executable, __file__], check=True, timeout=300)


@pytest.mark.parametrize("way", ["spawn", "forkserver"])
def test_children_started_otherwise(way):
    if way not in multiprocessing.get_all_start_methods():
        pytest.skip(f"no {way} on this system")
    code = f"import test_processes as t, multiprocessing as m\nif __name__ == '__main__':\n    with m.get_context({way!r}).Pool(1) as pool:\n        assert pool.map(t.child, [0]) == [t.digest()]"
    folder = pathlib.Path(__file__).parent
    subprocess.run([sys.executable, "-c", code], check=True, timeout=120, cwd=folder, env={**os.environ, "PYTHONPATH": str(folder)})


if __name__ == "__main__":
    forked()
