"""Lesson 1: the two excitations of the paper, and why one of them is stronger (SK15 sections 4.2, 5.1 and 6.1).

Run: python examples/01_excitations.py
"""

import matplotlib.pyplot as plt
import numpy as np

import frfid

# An odd random-phase multisine: about 80 frequencies between 1 Hz and 60 Hz, each moved to an odd multiple of f0.
ms = frfid.Multisine.design(low_hz=1.0, high_hz=60.0, sample_time_s=1e-3, resolution_hz=0.1, n_lines=80, grid="odd")
print(f"period {ms.period_s} s, f0 = {ms.fundamental_hz:.5f} Hz, {len(ms.lines_hz)} lines")
print(f"first line {ms.harmonics[0]} f0 = {ms.lines_hz[0]:.3f} Hz, last line {ms.lines_hz[-1]:.3f} Hz")

# One realization is one draw of the phases, scaled so that the torque never exceeds 150 N m, not even between samples.
chirp = frfid.Chirp(low_hz=1.0, high_hz=60.0, duration_s=20.0, amplitude=150.0)
chirp_power = np.mean(chirp.sample(sample_time_s=1e-3) ** 2)
share = [np.mean(ms.realize(seed=1, realization=p, peak=150.0) ** 2) / chirp_power for p in range(200)]
low, median, high = 100 * np.percentile(share, [5, 50, 95])
print(f"mean power over that of the chirp: {median:.1f} % in the median, {low:.0f} % to {high:.0f} % (the paper saw 11 % to 20 %)")

# Three inputs need three experiments. Their phases decide how well the inputs can be told apart.
r = ms.realize(seed=1, n_inputs=3, peak=[150.0, 150.0, 150.0], mimo="orthogonal")
flipped = chirp.sample(sample_time_s=1e-3, n_inputs=3, mimo="sign-flip")
for name, signal, bins in (("multisine, orthogonal", r, ms.harmonics), ("chirp, sign flip", flipped, [200])):
    matrix = np.moveaxis(np.fft.rfft(signal)[..., bins], -1, 0)
    print(f"condition number of U, {name}: {np.linalg.cond(matrix).max():.3f}")

# The chirp reaches 150 N m in every cycle, the multisine once in a period.
figure, panels = plt.subplots(2, sharex=True, sharey=True, layout="constrained")
for panel, name, torque in zip(panels, ("chirp", "multisine"), (chirp.sample(sample_time_s=1e-3), ms.realize(seed=1, peak=150.0))):
    panel.plot(1e-3 * np.arange(torque.size), torque[0, 0], linewidth=0.5)
    panel.set(title=f"{name}: {torque.std():.0f} N m rms", ylabel="Torque in N m")
panels[-1].set_xlabel("Time in s")
figure.savefig("01_excitations.svg")
print("01_excitations.svg: the torque of both over time")
