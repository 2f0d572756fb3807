"""Endurance: eight threads call whatever computes, over and over, and the memory of the process stays where it is.

``FRFID_CALLS=100000 pytest tests/python/test_endurance.py -s`` is the whole of it; the suite does a few thousand calls. The forks
after use are in ``test_processes.py``.
"""

import gc
import os
import pickle
import subprocess
import sys
import threading

import numpy as np

import frfid

CALLS = int(os.environ.get("FRFID_CALLS", "4000"))
THREADS = 8
T = 1e-3
GROWTH = 12e6  # bytes: 120 for each of 100 000 calls
RNG = np.random.default_rng(1)
U = np.repeat(RNG.standard_normal((2, 1, 1, 1, 128)), 2, axis=2)
RECORD = RNG.standard_normal((1, 400))
JOINT = frfid.Plant.single_joint(coulomb_nm=50.0)
CHIRP = frfid.Chirp(low_hz=2.0, high_hz=60.0, duration_s=0.5)
MULTISINE = frfid.Multisine.design(low_hz=2, high_hz=60, sample_time_s=T, resolution_hz=4.0)
FRF = frfid.estimate_bla(U, U + 0.1 * U**2, sample_time_s=T, harmonics=[1, 2, 3, 5, 8])


def refused():
    try:
        frfid.estimate_bla(U[0], U, sample_time_s=T, harmonics=[1])
    except ValueError as error:
        return str(error)
    raise AssertionError("nothing was raised")


def told():
    seen = []
    JOINT.simulate(np.stack([100 * RECORD[:, :50]] * 3), sample_time_s=T, progress=lambda *of: seen.append(of))
    assert seen[-1] == (3, 3)


WORK = [
    lambda: frfid.estimate_bla(U, U, sample_time_s=T, harmonics=[1, 2, 3]).total_covariance,
    lambda: frfid.estimate(U, U, sample_time_s=T, harmonics=[1, 2], method="h1").response,
    lambda: frfid.coherence(U, U, sample_time_s=T, harmonics=[1, 2]),
    lambda: frfid.compare(FRF, FRF).agreement,
    lambda: frfid.spectrogram(RECORD, sample_time_s=T, window_s=0.1),
    lambda: CHIRP.sample(sample_time_s=T),
    lambda: MULTISINE.realize(seed=1),
    lambda: JOINT.frf([1.0, 2.0, 3.0], sample_time_s=T).response,
    lambda: pickle.loads(pickle.dumps(FRF)).noise_variance,
    lambda: (repr(FRF), FRF.checks, FRF.provenance, FRF.to_svg()),
    refused,
    told,
]


def used():
    """Bytes of memory that the process has."""
    gc.collect()
    with open("/proc/self/statm") as statm:
        return int(statm.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def work(calls, failed):
    try:
        for call in range(calls):
            WORK[call % len(WORK)]()
    except BaseException as error:  # noqa: BLE001: told by the main thread
        failed.append(error)


def in_threads(calls):
    failed = []
    threads = [threading.Thread(target=work, args=(calls // THREADS, failed)) for _ in range(THREADS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failed == []


def endured():
    in_threads(max(CALLS // 4, 1000))  # pools, caches and arenas find their size
    before = used()
    in_threads(CALLS)
    growth = used() - before
    print(f"{CALLS} calls in {THREADS} threads: {growth / 1e6:+.2f} MB, {growth / CALLS:+.1f} bytes a call")
    assert growth < GROWTH, f"{growth} bytes more after {CALLS} calls"


def test_threads_that_call_do_not_grow():
    if sys.platform != "linux":
        return
    done = subprocess.run([sys.executable, __file__], capture_output=True, text=True, timeout=3000)
    print(done.stdout)
    assert done.returncode == 0, done.stderr


if __name__ == "__main__":
    endured()
