"""Lesson 2: Coulomb friction hides a resonance when the excitation is weak (SK15 section 6.2, figure 4).

The joint sticks while the torque is too small; the chirp is stronger than the multisine and sees more of the resonance.

Run: python examples/02_friction.py
"""

import numpy as np

import frfid

T = 1e-3
plant = frfid.Plant.single_joint(coulomb_nm=50.0)
ms = frfid.Multisine.design(low_hz=1.0, high_hz=60.0, sample_time_s=T, resolution_hz=0.1, n_lines=80, grid="odd")
chirp = frfid.Chirp(low_hz=1.0, high_hz=60.0, duration_s=20.0, amplitude=150.0)


def db(response):
    return 20 * np.log10(np.abs(response))


# Ten realizations; the first period is the transient, the second one is used.
u = np.concatenate([ms.realize(seed=1, realization=p, peak=150.0) for p in range(10)])
rec = plant.simulate(np.tile(u, 2), sample_time_s=T)
print(f"multisine: rms torque {rec.u.std():.0f} N m against 50 N m of friction, stuck {np.mean(rec.y == 0):.0%} of the time")
second = np.s_[:, None, None, :, ms.n_samples :]  # (realization, experiment, period, channel, sample)
multisine = frfid.estimate_bla(rec.u[second], rec.y[second], sample_time_s=T, harmonics=ms.harmonics)

rec = plant.simulate(chirp.sample(sample_time_s=T)[0], sample_time_s=T)
print(f"chirp: rms torque {rec.u.std():.0f} N m, stuck {np.mean(rec.y == 0):.0%} of the time")
hz = np.geomspace(1.3, 55.0, 200)
excerpts = frfid.estimate_chirp(rec.u[None], rec.y[None], chirp=chirp, sample_time_s=T, frequencies_hz=hz)

for name, frf in (("multisine", multisine), ("chirp", excerpts)):
    band = (frf.frequency_hz > 8.0) & (frf.frequency_hz < 16.0)
    truth = plant.frf(frf.frequency_hz, sample_time_s=T)
    lost = db(truth[band]).max() - db(frf[band]).max()
    print(f"{name}: the peak at the resonance lies {lost:.1f} dB below the truth")
print("the multisine's total variance says that something nonlinear is at work:", multisine.total_variance is not None)

axes = multisine.plot.bode(label="multisine")
excerpts.plot.bode(ax=axes, label="chirp")
plant.frf(hz, sample_time_s=T).plot.bode(ax=axes, label="without friction", color="black", linestyle="-")
axes[0, 0].set(title="motor torque → motor velocity", ylabel="Magnitude in dB\nre 1 rad/s per N m")
axes[0, 0].figure.savefig("02_friction.svg")
print("02_friction.svg: of the resonance the chirp shows most, the multisine nothing")
