"""Long calls and the interpreter: other threads go on, Ctrl-C works, progress is told and may stop the work."""

import os
import pathlib
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import frfid

T = 1e-3
PLANT = frfid.Plant.single_joint(coulomb_nm=50.0)
RUN = 100 * np.random.default_rng(1).standard_normal((1, 20_000))


def test_other_threads_go_on_meanwhile():
    batch = np.broadcast_to(RUN, (20, *RUN.shape))
    ticks, done = 0, threading.Event()

    def work():
        PLANT.simulate(batch, sample_time_s=T)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    started = time.perf_counter()
    while not done.is_set():
        ticks += 1
        time.sleep(1e-3)
    took = time.perf_counter() - started
    thread.join()
    assert took > 0.05, "the work is long enough to tell"
    assert ticks > 0.2 * took / 1e-3, f"{ticks} ticks of a millisecond in {took} s"


def test_two_threads_estimate_at_the_same_time():
    u = np.repeat(np.random.default_rng(2).standard_normal((2, 2, 1, 2, 512)), 2, axis=2)
    expected = frfid.estimate_bla(u, u, sample_time_s=T, harmonics=[1, 2]).response.tobytes()
    found = []
    threads = [
        threading.Thread(target=lambda: found.append(frfid.estimate_bla(u, u, sample_time_s=T, harmonics=[1, 2]).response.tobytes()))
        for _ in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == 8 * [expected]


def test_progress_counts_to_the_total():
    told = []
    PLANT.simulate(np.broadcast_to(RUN[:, :500], (7, 1, 500)), sample_time_s=T, progress=lambda *of: told.append(of))
    assert (told[0], told[-1]) == ((0, 7), (7, 7)) and told == sorted(set(told))


def test_an_exception_from_progress_stops_the_work_and_comes_back():
    told = []

    def progress(done, total):
        told.append(done)
        if done >= 2:
            raise RuntimeError("enough")

    batch = np.broadcast_to(RUN, (200, *RUN.shape))
    started = time.perf_counter()
    PLANT.simulate(batch[:4], sample_time_s=T)
    four = time.perf_counter() - started
    started = time.perf_counter()
    with pytest.raises(RuntimeError, match="enough"):
        PLANT.simulate(batch, sample_time_s=T, progress=progress)
    assert told[-1] < 10 and told == sorted(told)
    assert time.perf_counter() - started < 10 * four, "the other 198 runs were not done"


@pytest.mark.skipif(os.name == "nt", reason="no SIGINT for one child process")
def test_ctrl_c_interrupts():
    code = """
import sys, time, numpy as np, frfid
batch = np.broadcast_to(100 * np.random.default_rng(1).standard_normal((1, 20_000)), (500, 1, 20_000))
told = lambda done, total: done == 0 and print("started", flush=True)
try:
    frfid.Plant.single_joint(coulomb_nm=50.0).simulate(batch, sample_time_s=1e-3, progress=told)
except KeyboardInterrupt:
    print("interrupted", flush=True)
    sys.exit(130)
"""
    child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "started\n"
    child.send_signal(signal.SIGINT)
    sent = time.perf_counter()
    assert child.wait(timeout=20) == 130
    assert child.stdout.read() == "interrupted\n"
    assert time.perf_counter() - sent < 5.0


LONG = {
    "phases for a low crest factor": "multisine.realize(seed=1)",
    "one long run": "joint.simulate(100 * np.random.default_rng(1).standard_normal((1, 30_000_000)), sample_time_s=1e-3)",
    "reference of a run": "plan.reference(0)",
    "a run of a plan": "plan[0]",
    "all runs of a plan": "plan.run()",
    "runs on a testbed": "plan.run(machine)",
    "a plan to a file": "plan.save(folder / 'plan.mcap')",
    "a prediction": "plan.predict()",
}


@pytest.mark.skipif(os.name == "nt", reason="no SIGINT for one child process")
@pytest.mark.parametrize("what", LONG)
def test_ctrl_c_is_heard_in_the_middle_of_one_step(what):
    code = f"""
import pathlib, sys, tempfile, time, numpy as np, frfid
from test_processes import EXPERIMENT
folder = pathlib.Path(tempfile.mkdtemp())
low_crest = "phases = 'low-crest'\\nn_lines = 2000\\n"
path = folder / "experiment.toml"
path.write_text(EXPERIMENT.replace("resolution_hz = 1.0\\nn_lines = 20\\n", "resolution_hz = 0.001\\n" + low_crest))
class Machine:
    def run(self, run):
        raise RuntimeError("played")
multisine = frfid.Multisine.design(low_hz=1, high_hz=400, sample_time_s=1e-3, resolution_hz=0.002, phases="low-crest")
joint, machine = frfid.Plant.single_joint(coulomb_nm=50.0), Machine()
plan = frfid.Experiment.load(path).design()
try:
    print("started", flush=True)
    {LONG[what]}
except KeyboardInterrupt:
    print("interrupted", flush=True)
    sys.exit(130)
"""
    folder = str(pathlib.Path(__file__).parent)
    child = subprocess.Popen(
        [sys.executable, "-W", "ignore", "-c", code], stdout=subprocess.PIPE, text=True, env={**os.environ, "PYTHONPATH": folder}
    )
    assert child.stdout.readline() == "started\n"
    time.sleep(1.5)
    child.send_signal(signal.SIGINT)
    sent = time.perf_counter()
    assert child.wait(timeout=60) == 130, "the call is too short to be interrupted, or deaf"
    took = time.perf_counter() - sent
    assert child.stdout.read() == "interrupted\n"
    assert took < 1.0, f"heard after {took:.2f} s"
