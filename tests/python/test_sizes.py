"""Sizes that cannot be held: whatever is asked for is refused as ValueError or MemoryError, and the interpreter lives on.

All of it is tried in processes of their own, which may take four gigabytes each and no more.
"""

import subprocess
import sys
import textwrap

import numpy as np
import pytest

import frfid

PREPARED = """
import resource, sys, tempfile, numpy as np, frfid
resource.setrlimit(resource.RLIMIT_AS, (1 << 32, 1 << 32))
HUGE, T = 10**12, 1e-3
multisine = frfid.Multisine.design(low_hz=1, high_hz=60, sample_time_s=T, resolution_hz=1.0)
chirp = frfid.Chirp(low_hz=1, high_hz=60, duration_s=10)
joint = frfid.Plant.single_joint()
pi = dict(integral_gain=1.0, sample_time_s=T)
rng = np.random.default_rng(1)
u = rng.standard_normal((2, 1, 2, 1, 64))
view = lambda *shape: np.broadcast_to(1.0, shape)
spectrum = dict(sample_time_s=T, harmonics=[1, 2])
at = dict(sample_time_s=T, frequencies_hz=[10.0, 20.0])
"""

ASKED = {
    "inputs of a multisine": "multisine.realize(seed=1, n_inputs=10**9)",
    "more inputs than an integer": "multisine.realize(seed=1, n_inputs=2**63)",
    "experiments and inputs of a multisine": "multisine.realize(seed=1, n_inputs=999)",
    "peaks": "multisine.realize(seed=1, n_inputs=10**9, peak=view(10**9))",
    "peaks in a range": "multisine.realize(seed=1, n_inputs=2, peak=range(HUGE))",
    "samples of a period": "frfid.Multisine(sample_time_s=T, n_samples=2**34, harmonics=[1])",
    "samples of a period at the limit, many inputs": "frfid.Multisine(sample_time_s=T, n_samples=2**26, harmonics=[1]).realize(seed=1, n_inputs=7)",
    "points between the samples": "frfid.Multisine(sample_time_s=T, n_samples=2**26, harmonics=[2**24]).realize(seed=1)",
    "lines in a range": "frfid.Multisine(sample_time_s=T, n_samples=64, harmonics=range(1, HUGE))",
    "lines in a range without a length": "frfid.Multisine(sample_time_s=T, n_samples=64, harmonics=range(1, 10**30))",
    "detection lines": "frfid.Multisine(sample_time_s=T, n_samples=64, harmonics=[1], detection=view(HUGE))",
    "shape": "frfid.Multisine(sample_time_s=T, n_samples=64, harmonics=[1], shape=view(HUGE, 2))",
    "lines of a design": "frfid.Multisine.design(low_hz=1, high_hz=60, sample_time_s=T, resolution_hz=1e-12)",
    "number of lines": "frfid.Multisine.design(low_hz=1, high_hz=60, sample_time_s=T, resolution_hz=1, n_lines=2**63 - 1)",
    "inputs of a chirp": "chirp.sample(sample_time_s=T, n_inputs=10**9)",
    "experiments and inputs of a chirp": "chirp.sample(sample_time_s=T, n_inputs=999)",
    "samples of a chirp": "frfid.Chirp(low_hz=1, high_hz=60, duration_s=1e30).sample(sample_time_s=T)",
    "amplitudes of a chirp": "frfid.Chirp(low_hz=1, high_hz=60, duration_s=1, amplitude=view(HUGE))",
    "axes of a controller": "frfid.PiController(gain=range(HUGE), **pi)",
    "axes of a controller, one after the other": "frfid.PiController(gain=1.0, max_torque_nm=view(10**8), **pi)",
    "delay of a controller": "frfid.PiController(gain=1.0, delay_samples=2**62, **pi)",
    "runs of a simulation": "joint.simulate(view(HUGE, 1, 10), sample_time_s=T)",
    "samples of a simulation": "joint.simulate(view(1, HUGE), sample_time_s=T)",
    "reference of a simulation": "frfid.run_closed_loop(joint, frfid.PiController(gain=1.0, **pi), view(1, HUGE))",
    "frequencies of a plant": "joint.frf(view(HUGE), sample_time_s=T)",
    "frequencies of a plant in a range": "joint.frf(range(1, HUGE), sample_time_s=T)",
    "frequencies of a loop": "frfid.loop_frf(joint, frfid.PiController(gain=1.0, **pi), view(HUGE))",
    "record": "frfid.Record(sample_time_s=T, u=view(1, HUGE), y=view(1, HUGE))",
    "record without samples": "frfid.Record(sample_time_s=T, u=np.empty((2**40, 1, 0)), y=np.empty((2**40, 1, 0)))",
    "record without channels": "frfid.Record(sample_time_s=T, u=np.empty((2**40, 0, 1)), y=np.empty((2**40, 0, 1)))",
    "record of integers": "frfid.Record(sample_time_s=T, u=np.broadcast_to(1, (1, HUGE)), y=np.broadcast_to(1, (1, HUGE)))",
    "names of joints": "frfid.Record(sample_time_s=T, u=[[1.0]], y=[[1.0]]).save('/nowhere', joint_names=range(HUGE))",
    "periods of an estimate": "frfid.estimate_bla(view(1, 1, HUGE, 1, 64), view(1, 1, HUGE, 1, 64), **spectrum)",
    "lines of an estimate": "frfid.estimate_bla(u, u, sample_time_s=T, harmonics=range(1, HUGE))",
    "channels of an estimate": "frfid.estimate(*[rng.standard_normal((2, 300, 2, 300, 8))] * 2, **spectrum)",
    "channels of a loop": "frfid.estimate_loop(*[rng.standard_normal((2, 200, 2, 200, 8))] * 3, **spectrum)",
    "coherence": "frfid.coherence(view(1, 1, HUGE, 1, 64), view(1, 1, HUGE, 1, 64), **spectrum)",
    "covariances": "frfid.spectra_covariance(view(1, 1, HUGE, 1, 64), view(1, 1, HUGE, 1, 64), **spectrum)",
    "frequencies of local models": "frfid.estimate_local(u[0, 0, 0], u[0, 0, 0], sample_time_s=T, frequencies_hz=range(HUGE))",
    "channels of local models": "frfid.estimate_local(*[rng.standard_normal((300, 2000))] * 2, **at)",
    "records of local models": "frfid.estimate_local(view(HUGE, 1, 64), view(HUGE, 1, 64), **at)",
    "frequencies of a chirp": "frfid.estimate_chirp(u[0, 0], u[0, 0], chirp=chirp, sample_time_s=T, frequencies_hz=view(HUGE))",
    "recordings of a chirp": "frfid.estimate_chirp(view(HUGE, 1, 64), view(HUGE, 1, 64), chirp=chirp, **at)",
    "samples of a spectrogram": "frfid.spectrogram(view(1, HUGE), sample_time_s=T)",
    "channels of a spectrogram": "frfid.spectrogram(np.empty((2**40, 0)), sample_time_s=T)",
    "windows of a spectrogram": "frfid.spectrogram(rng.standard_normal((1, 2**20)), sample_time_s=T, window_s=500, step_s=1e-9)",
    "windows of a spectrogram of many channels": "frfid.spectrogram(rng.standard_normal((8, 2**15)), sample_time_s=T, window_s=16, step_s=1e-9)",
    "response": "frfid.Frf(frequency_hz=view(HUGE), response=view(HUGE, 1, 1))",
    "response without inputs": "frfid.Frf(frequency_hz=[1.0], response=np.empty((1, 2**40, 0)))",
    "covariance": "frfid.Frf(frequency_hz=[1.0], response=[[[1.0]]], noise_covariance=view(1, 10**6, 10**6), noise_degrees_of_freedom=1.0)",
    "names": "frfid.Frf(frequency_hz=[1.0], response=[[[1.0]]], input_names=range(HUGE))",
    "desired signals of a shaping": "frfid.shape(object(), desired=view(1, 1, HUGE), start=view(1, 1, HUGE), sample_time_s=T)",
    "iterations of a shaping": "frfid.shape((joint, frfid.PiController(gain=1.0, **pi)), desired=np.zeros((1, 1, 9)), start=np.zeros((1, 1, 9)), sample_time_s=T, n_iterations=2**63, smoothing_bins=2**63)",
    "positions of an arm": "joint.mass_matrix(view(HUGE, 1))",
    "logs": "frfid.estimate_logs(range(HUGE))",
}


def tried(asked):
    """What is raised by each of them, in one process."""
    code = PREPARED + textwrap.dedent(
        """
        for name, asked in eval(sys.stdin.read()).items():
            print(name, end=": ", flush=True)
            try:
                eval(asked)
                print("nothing was raised", flush=True)
            except Exception as error:
                print(*(kind.__name__ for kind in type(error).__mro__[:-3]), str(error)[:200], flush=True)
            except BaseException as error:
                print("BaseException", type(error).__name__, flush=True)
        """
    )
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code],
        input=repr(asked), capture_output=True, text=True, timeout=300,
        env={"OPENBLAS_NUM_THREADS": "1", "RAYON_NUM_THREADS": "2"},
    )
    return done


@pytest.mark.skipif(sys.platform != "linux", reason="limits the memory of a process as Linux does")
def test_what_cannot_be_held_is_an_error_of_python():
    done = tried(ASKED)
    assert done.returncode == 0, f"the interpreter died: {done.stdout.splitlines()[-1:]} {done.stderr[-2000:]}"
    kinds = ("ValueError", "MemoryError", "OverflowError", "TypeError")
    odd = [line for line in done.stdout.splitlines() if not any(kind in line for kind in kinds)]
    assert odd == [] and len(done.stdout.splitlines()) == len(ASKED)


@pytest.mark.skipif(sys.platform != "linux", reason="limits the memory of a process as Linux does")
def test_what_fits_the_bounds_and_not_the_memory_is_a_memory_error():
    asked = {
        "multisine": "frfid.Multisine(sample_time_s=T, n_samples=2**25, harmonics=[2**22]).realize(seed=1, n_inputs=2)",
        "chirp": "frfid.Chirp(low_hz=1, high_hz=60, duration_s=60000).sample(sample_time_s=T, n_inputs=2) is None",
    }
    limited = {name: f"(resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 32)), {call})" for name, call in asked.items()}
    done = tried(limited)
    assert done.returncode == 0, done.stderr[-2000:]
    assert all("MemoryError" in line for line in done.stdout.splitlines()), done.stdout


def test_a_width_beyond_the_record_takes_all_of_it():
    u = np.random.default_rng(1).standard_normal((1, 2000))
    whole = [frfid.estimate_local(u, u, sample_time_s=1e-3, frequencies_hz=[10.0], half_width=width) for width in (2000, 2**63)]
    assert whole[0].response.tobytes() == whole[1].response.tobytes()
