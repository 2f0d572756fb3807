"""First uses: what the first call needs is there since the import, for threads that fork meanwhile and for Ctrl-C."""

import os
import pathlib
import signal
import subprocess
import sys
import textwrap

import pytest

ROUNDS = int(os.environ.get("FRFID_ROUNDS", "8"))  # 200 for the whole of it

FIRST_USE = """
import os, random, sys, threading, time
import frfid

def estimate():
    u = [[[[[float((k * k) % 17 - 8) for k in range(64)]]] * 2]] * 2
    frfid.estimate_bla(u, u, sample_time_s=1e-3, harmonics=[1, 2, 3])

threads = [threading.Thread(target=estimate) for _ in range(4)]
for thread in threads:
    thread.start()
time.sleep(random.Random(int(sys.argv[1])).uniform(0, 0.02))
child = os.fork()
if child == 0:
    estimate()
    os._exit(0)
ended = time.monotonic() + 10
while os.waitpid(child, os.WNOHANG) == (0, 0):
    if time.monotonic() > ended:
        os.kill(child, 9)
        sys.exit("the child hangs")
    time.sleep(0.005)
for thread in threads:
    thread.join()
"""

INTERRUPTED = """
import _thread, builtins, sys

found = builtins.__import__
def interrupting(name, *rest):
    # Ctrl-C arrives while a call of frfid looks into numpy
    if name.startswith("numpy."):
        _thread.interrupt_main()
    return found(name, *rest)

import numpy, numpy.ma, frfid
builtins.__import__ = interrupting
try:
    frfid.spectrogram([[float(k % 7) for k in range(100)]], sample_time_s=1e-2, window_s=0.5)
except KeyboardInterrupt:
    pass
"""


def fresh(code, *arguments):
    command = [sys.executable, "-W", "ignore", "-c", code, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_child_forked_while_threads_estimate_for_the_first_time_finishes():
    for seed in range(ROUNDS):
        done = fresh(FIRST_USE, seed)
        assert done.returncode == 0, done.stderr


def test_ctrl_c_in_the_first_call_is_a_keyboard_interrupt():
    done = fresh(INTERRUPTED)
    assert "panicked" not in done.stderr and done.returncode == 0, done.stderr


def test_no_call_imports_what_the_import_of_the_package_did_not():
    code = textwrap.dedent(
        """
        import sys, frfid
        before = set(sys.modules)
        signal = [[float((k * k) % 17) for k in range(400)]]
        try:
            frfid.load("/nowhere/at/all")
        except FileNotFoundError as error:
            assert error.filename is not None
        frfid.spectrogram(signal, sample_time_s=1e-2, window_s=0.5)
        record = frfid.Plant.single_joint().simulate(signal, sample_time_s=1e-3)
        record.events, record.input_kind, repr(record)
        frf = frfid.Plant.single_joint().frf([1.0, 2.0, 3.0, 4.0, 5.0], sample_time_s=1e-3)
        frf._repr_html_(), frf.to_svg(), frf.checks, frf.provenance, frfid.compare(frf, frf).agreement
        print(sorted(set(sys.modules) - before))
        """
    )
    done = fresh(code)
    assert (done.returncode, done.stdout) == (0, "[]\n"), done.stderr
