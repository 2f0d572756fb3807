"""Lesson 6: a robot moves under its controller; the reference is a velocity, the torque is what the controller makes of it.

Run: python examples/06_closed_loop.py
"""

import numpy as np

import frfid

T = 1e-3
plant = frfid.Plant.single_joint(torque_noise_nm=200.0)
controller = frfid.PiController(gain=[1500.0], integral_gain=[12000.0], sample_time_s=T)
ms = frfid.Multisine.design(low_hz=2.0, high_hz=60.0, sample_time_s=T, resolution_hz=0.5, n_lines=40, grid="odd")
n_periods = 50

r = np.tile(ms.realize(seed=1, peak=0.05)[0], n_periods + 2)
rec = frfid.run_closed_loop(plant, controller, r, seed=3)
print(f"torque {rec.u.std():.0f} N m rms, most of it noise on its reading: nearly as strong as the signal on each line")


def periods(signal):
    """(channel, sample) to (realization, experiment, period, channel, sample), without the first two periods."""
    return signal[:, 2 * ms.n_samples :].reshape(1, 1, -1, n_periods, ms.n_samples).swapaxes(2, 3)


u, y, reference = periods(rec.u), periods(rec.y), periods(rec.r)
truth = plant.frf(ms.lines_hz, sample_time_s=T)
estimates = {
    "mean of FRFs": frfid.estimate_bla(u, y, sample_time_s=T, harmonics=ms.harmonics, average="frfs"),
    "mean of spectra": frfid.estimate_bla(u, y, sample_time_s=T, harmonics=ms.harmonics),
    "indirect": frfid.estimate_bla(u, y, r=reference, sample_time_s=T, harmonics=ms.harmonics),
}
for name, frf in estimates.items():
    error = np.abs(frf.response / truth - 1)
    print(f"{name}: median error {100 * np.median(error):.1f} %, worst {100 * error.max():.0f} %")
print("noise on the measured torque biases a mean of FRFs however many periods there are; averaged before the division, over")
print("periods or against the known reference, it disappears")

axes = None
for name in ("mean of FRFs", "indirect"):
    axes = estimates[name].plot.bode(ax=axes, label=name)
exact = plant.frf(np.geomspace(2.0, 60.0, 300), sample_time_s=T)
exact.plot.bode(ax=axes, label="exact", color="black", linestyle="-")
axes[0, 0].set(title="motor torque → motor velocity", ylabel="Magnitude in dB\nre 1 rad/s per N m")
axes[0, 0].figure.savefig("06_closed_loop.svg")
print("06_closed_loop.svg: the mean of FRFs lies far below the truth, the indirect estimate around it")
