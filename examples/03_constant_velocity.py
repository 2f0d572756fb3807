"""Lesson 3: riding on a constant velocity, the joint never sticks and friction is a constant torque (SK15 section 6.2).

Run: python examples/03_constant_velocity.py
"""

import matplotlib.pyplot as plt
import numpy as np

import frfid

T = 1e-3
plant = frfid.Plant.single_joint(coulomb_nm=50.0)
ms = frfid.Multisine.design(low_hz=1.0, high_hz=60.0, sample_time_s=T, resolution_hz=0.1, n_lines=80, grid="odd")
u = np.tile(ms.realize(seed=1, peak=150.0)[0], 4)
last = np.s_[None, None, None, :, -ms.n_samples :]  # the last period, once the start has died out

figure, panel = plt.subplots(layout="constrained")
for velocity in (0.25, 0.011):
    rec = plant.simulate(u, sample_time_s=T, velocity_rad_s=velocity)
    frf = frfid.estimate_bla(rec.u[last], rec.y[last], sample_time_s=T, harmonics=ms.harmonics)
    error = np.abs(frf.response / plant.frf(frf.frequency_hz, sample_time_s=T) - 1)[:, 0, 0]
    print(f"v = {velocity} rad/s: slowest {rec.y.min():+.3f} rad/s, largest error of the FRF {error.max():.1e}")
    panel.loglog(frf.frequency_hz, error, ".-", label=f"v = {velocity} rad/s")
print("the smallest velocity decides: once it changes sign, the joint sticks and the FRF is wrong")

panel.set(xticks=(1, 2, 5, 10, 20, 50), xticklabels=(1, 2, 5, 10, 20, 50), xlabel="Frequency in Hz", ylabel="Relative error of the FRF")
panel.legend()
figure.savefig("03_constant_velocity.svg")
print("03_constant_velocity.svg: the error of both over frequency")
