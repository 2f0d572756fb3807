"""A player of two axes for tests: frfid's own simulation of small_arm.toml, and whatever may go wrong with a player.

    python small_player.py [--fault KIND] [--fault-run NAME] [--calls FILE] REFERENCE.csv LOG.csv

Every call adds a line to FILE: the run that was sent. It controls at 500 Hz whatever the rate of the reference; its log has a clock of its
own. Needs: pip install scipy
"""

import argparse
import os
import pathlib
import signal
import sys
import time

import numpy as np
from scipy.interpolate import CubicSpline

import frfid

ARM = pathlib.Path(__file__).with_name("small_arm.toml")
JOINTS = ("shoulder", "elbow")
SIGNALS = ("set_velocity", "velocity", "position", "torque")
STEP_S, OFFSET_S, PPM = 0.002, 12.5, 80.0
STOPPED_AT = 0.6  # of the way
ROLES = [("u", "torque", "N m"), ("y", "velocity", "rad/s"), ("r", "set_velocity", "rad/s"), ("position", "position", "rad")]
SOURCE = '{{ source = "{}.{}", unit = "{}" }}'
LINES = [f"{role} = [{', '.join(SOURCE.format(joint, name, unit) for joint in JOINTS)}]" for role, name, unit in ROLES]
MAP = "\n".join([*LINES, 'time = { source = "t", unit = "s" }', ""])


def main():
    options = arguments().parse_args()
    run = os.environ.get("FRFID_RUN", "")
    if options.calls:
        with open(options.calls, "a") as file:
            print(run, file=file)
    fault = options.fault if options.fault_run in (None, run) else None
    if fault == "dies":
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep({"hangs": 30, "slow": 2}.get(fault, 0))
    if fault != "nothing":
        write(options.log, *played(options.reference, fault), fault)
    return 7 if fault == "fails" else 0


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("reference")
    parser.add_argument("log")
    parser.add_argument("--fault")
    parser.add_argument("--fault-run")
    parser.add_argument("--calls")
    return parser


def played(reference, fault):
    """Stamps, and the signals (joint, row) of what was played."""
    table = np.genfromtxt(reference, delimiter=",", names=True, deletechars="", replace_space=" ")
    told = np.array([table[f"{joint} velocity [rad/s]"] for joint in JOINTS])
    time_s = STEP_S * np.arange(round(table["time_s"][-1] / STEP_S) + 1)
    velocity = CubicSpline(table["time_s"], told, axis=1)(time_s)
    if fault == "stops":
        velocity[:, int(STOPPED_AT * velocity.shape[1]) :] = 0.0
    loop = frfid.PiController(gain=[600.0, 300.0], integral_gain=[4800.0, 2400.0], sample_time_s=STEP_S)
    record = frfid.run_closed_loop(frfid.Plant.load(str(ARM)), loop, velocity)
    return OFFSET_S + (1 + 1e-6 * PPM) * time_s, np.array([velocity, record.y, record.position_rad, record.u])


def write(log, stamps, signals, fault):
    """A CSV, as the fault has it."""
    spoil = {"flips": flipped, "degrees": in_degrees, "swaps": swapped, "nan": with_nan, "wild": wild}.get(fault)
    signals = spoil(signals) if spoil else signals
    names = ["t", *(f"{joint}.{name}" for name in SIGNALS for joint in JOINTS)]
    rows = [",".join(names), *(",".join(f"{value:.12g}" for value in row) for row in np.vstack([stamps, *signals]).T)]
    text = "\n".join(rows) + "\n"
    pathlib.Path(log).write_text(text[: len(text) // 2] if fault == "half" else text)


def flipped(signals):
    """The elbow counts the other way round."""
    return signals * np.array([1.0, -1.0])[:, None]


def in_degrees(signals):
    return signals * np.array([180 / np.pi] * 3 + [1.0])[:, None, None]


def swapped(signals):
    return signals[:, ::-1]


def with_nan(signals):
    """An encoder that was lost for the second half."""
    signals = signals.copy()
    signals[1, 1, signals.shape[2] // 2 :] = np.nan
    return signals


def wild(signals):
    """A shoulder whose torque goes beyond its 600 N m for a moment."""
    signals = signals.copy()
    middle = signals.shape[2] // 2
    signals[3, 0, middle : middle + 5] = 650.0
    return signals


if __name__ == "__main__":
    sys.exit(main())
