"""Lesson 9: in closed loop one asks for a velocity and wants a torque; iterative shaping finds the reference (SK15 section 5.3).

Run: python examples/09_shaping.py
"""

import pathlib

import matplotlib.pyplot as plt
import numpy as np

import frfid

T = 1e-3
arm = frfid.Plant.load(pathlib.Path(__file__).parent / "robots" / "manutec_r3.toml")
controller = frfid.PiController(
    gain=[1500.0, 1500.0, 400.0], integral_gain=[12000.0, 12000.0, 3200.0], sample_time_s=T
)


def chirps(amplitudes, duration_s=20.0):
    """Each experiment with other signs, half the amplitude above 40 Hz; (experiment, channel, sample)."""
    profiles = [[(2.0, a), (36.0, a), (44.0, a / 2), (60.0, a / 2)] for a in amplitudes]
    chirp = frfid.Chirp(
        low_hz=2.0, high_hz=60.0, duration_s=duration_s, amplitude=profiles, fade_s=0.5, tail_s=1.0
    )
    return chirp, chirp.sample(sample_time_s=T, n_inputs=3, mimo="sign-flip")


chirp, desired = chirps([200.0, 400.0, 200.0])  # N m
start = chirps([0.006, 0.006, 0.012])[1]  # rad/s: friction holds every axis
options = dict(start=start, sample_time_s=T, coulomb_nm=[42.0, 105.0, 42.0], max_travel_rad=0.07)
shaped = frfid.shape((arm, controller), desired=desired, **options)
print(shaped)

paper = frfid.shape((arm, controller), desired=desired, step="paper", **options)
print("the paper's step without damping:", ", ".join("-" if e is None else f"{100 * e:.0f} %" for e in paper.errors))

weak = frfid.shape((arm, controller), desired=chirps([100.0, 150.0, 120.0])[1], **options)
print("with table 1's torques instead:", *weak.sticking, sep="\n  ")

figure, panel = plt.subplots(layout="constrained")
for name, found in (("damped", shaped), ("the paper's step", paper), ("damped, table 1's torques", weak)):
    percent = [np.nan if error is None else 100 * error for error in found.errors]
    panel.semilogy(range(1, len(percent) + 1), percent, "o-", label=name)
panel.set(xlabel="Iteration", ylabel="Error of the torque in %", yticks=(10, 20, 50, 100), yticklabels=(10, 20, 50, 100))
panel.legend()
figure.savefig("09_shaping.svg")
print("09_shaping.svg: the error from iteration to iteration")
