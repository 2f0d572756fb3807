"""Lesson 4: a stiffness that grows with deflection moves the resonance, the more the stronger the excitation (SK15 section 6.3,
figure 5).

Run: python examples/04_stiffness.py
"""

import numpy as np

import frfid

T = 1e-3
hz = np.geomspace(1.3, 55.0, 400)
soft = frfid.Plant.single_joint()
stiffening = frfid.Plant.single_joint(stiffness_beyond_nm_per_rad=1.7 * 1.5e5, knee_rad=1e-3)
stiff = frfid.Plant.single_joint(stiffness_nm_per_rad=1.7 * 1.5e5)
for name, plant in (("k1", soft), ("1.7 k1", stiff)):
    truth = plant.frf(hz, sample_time_s=T)
    print(f"linear truth with {name}: resonance at {hz[np.abs(truth[:, 0, 0]).argmax()]:.1f} Hz")

chirp = frfid.Chirp(low_hz=1.0, high_hz=60.0, duration_s=20.0, amplitude=150.0)
rec = stiffening.simulate(chirp.sample(sample_time_s=T)[0], sample_time_s=T)
excerpts = frfid.estimate_chirp(rec.u[None], rec.y[None], chirp=chirp, sample_time_s=T, frequencies_hz=hz)
print(f"chirp of 150 N m: resonance at {hz[np.abs(excerpts[:, 0, 0]).argmax()]:.1f} Hz")

ms = frfid.Multisine.design(low_hz=1.0, high_hz=60.0, sample_time_s=T, resolution_hz=0.1, n_lines=80, grid="odd")
u = np.concatenate([ms.realize(seed=1, realization=p, peak=150.0) for p in range(10)])
rec = stiffening.simulate(np.tile(u, 4), sample_time_s=T)
last = np.s_[:, None, None, :, -ms.n_samples :]
bla = frfid.estimate_bla(rec.u[last], rec.y[last], sample_time_s=T, harmonics=ms.harmonics)
away = 20 * np.abs(np.log10(np.abs(bla.response / soft.frf(bla.frequency_hz, sample_time_s=T))))
print(f"multisine of 150 N m peak: within {away.max():.2f} dB of the truth with k1, it hardly reaches the knee")

print(frfid.compare(bla, excerpts, stronger="b"))

axes = bla.plot.bode(label="multisine", linestyle="none")
excerpts.plot.bode(ax=axes, label="chirp", linestyle="-")
for name, plant, line in (("k1", soft, "-"), ("1.7 k1", stiff, ":")):
    plant.frf(hz, sample_time_s=T).plot.bode(ax=axes, label=f"linear, {name}", color="black", linestyle=line, linewidth=0.8)
axes[0, 0].set(title="motor torque → motor velocity", ylabel="Magnitude in dB\nre 1 rad/s per N m")
axes[0, 0].figure.savefig("04_stiffness.svg")
print("04_stiffness.svg: the multisine lies on k1, the resonance of the chirp close to that of 1.7 k1")
