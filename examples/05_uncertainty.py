"""Lesson 5: what is noise, what is nonlinear, and how sure one can be (SK15 section 4.3).

Run: python examples/05_uncertainty.py
"""

import matplotlib.pyplot as plt
import numpy as np

import frfid

T = 1e-3
plant = frfid.Plant.single_joint(coulomb_nm=20.0, velocity_noise_rad_s=1e-4)
ms = frfid.Multisine.design(low_hz=1.0, high_hz=60.0, sample_time_s=T, resolution_hz=0.5, n_lines=40, grid="odd")
n_realizations, n_periods = 8, 6

# One period more than is used: the first one is the transient.
u = np.concatenate([ms.realize(seed=1, realization=p, peak=300.0) for p in range(n_realizations)])
rec = plant.simulate(np.tile(u, n_periods + 1), sample_time_s=T, seed=1)


def campaign(signal):
    """(realization, channel, sample) to (realization, experiment, period, channel, sample)."""
    periods = signal[:, None, :, ms.n_samples :].reshape(n_realizations, 1, -1, n_periods, ms.n_samples)
    return np.moveaxis(periods, 3, 2)


frf = frfid.estimate_bla(campaign(rec.u), campaign(rec.y), sample_time_s=T, harmonics=ms.harmonics)
print(f"{frf!r}")
for name in ("noise_variance", "total_variance", "nonlinear_variance"):
    level = 10 * np.log10(np.median(getattr(frf, name) / np.abs(frf.response) ** 2))
    print(f"{name.replace('_', ' ')}: {level:.0f} dB of the response in the median")
print("friction is not noise: it repeats from period to period, but not from realization to realization")

single = frfid.estimate_bla(campaign(rec.u)[:, :, :1], campaign(rec.y)[:, :, :1], sample_time_s=T, harmonics=ms.harmonics)
print("with one period the noise variance is", single.noise_variance)

figure, panel = plt.subplots(layout="constrained")
frf.plot.bode(ax=panel, label="response")
for name, color in (("nonlinear", "tab:blue"), ("noise", "tab:gray")):
    level = 10 * np.log10(getattr(frf, f"{name}_variance")[:, 0, 0])
    panel.plot(frf.frequency_hz, level, ".:", color=color, label=f"standard deviation, {name}")
panel.set(title="motor torque → motor velocity", ylabel="Magnitude in dB re 1 rad/s per N m", ylim=(-210, -50))
panel.legend(loc="lower left")
figure.savefig("05_uncertainty.svg")
print("05_uncertainty.svg: the response, and what it is uncertain by, line by line")
