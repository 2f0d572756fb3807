"""Synthesis of the paper's multisine of 71 lines and 12288 samples, scaled so that no channel exceeds 150 N m between samples.

The same work on both sides: amplitudes and phases of the lines, all experiments and channels, the true peak, one common factor.
The phases are given to numpy, since it cannot draw those of frfid; frfid draws them.
"""

import numpy as np
from case import MULTISINE, N_SAMPLES, Case

PEAK = 150.0
LINES = MULTISINE.harmonics


def phases_of(signal):
    """Phases of the sines that a signal consists of."""
    return np.angle(1j * np.fft.rfft(signal)[LINES])


def turns(n_inputs):
    """SK15 (9): phase of channel l in experiment m, (experiment, channel, 1)."""
    index = np.arange(n_inputs)
    return (2 * np.pi / n_inputs * (index[:, None] * index[None, :] % n_inputs))[:, :, None]


def true_peak(phases):
    """Largest value of every sum of sines between its samples: a fine grid by FFT, then Newton's method on the slope."""
    n = 2 ** int(np.ceil(np.log2(16 * LINES[-1])))
    spectrum = np.zeros((*phases.shape[:-1], n // 2 + 1), complex)
    spectrum[..., LINES] = -0.5j * n * np.exp(1j * phases)
    fine = np.abs(np.fft.irfft(spectrum, n))
    peak = fine.max(axis=-1)
    highest = (fine >= np.cos(np.pi / 16) * peak[..., None]) & (fine >= np.roll(fine, 1, -1)) & (fine >= np.roll(fine, -1, -1))
    *sums, place = np.nonzero(highest)
    omega, phase, time = 2 * np.pi * LINES, phases[tuple(sums)], place[:, None] / n
    for _ in range(4):
        z = np.exp(1j * (omega * time + phase))
        np.maximum.at(peak, tuple(sums), np.abs(z.imag.sum(axis=-1)))
        step = (omega * z.real).sum(axis=-1) / -(omega**2 * z.imag).sum(axis=-1)
        time = time - np.clip(step, -0.5 / n, 0.5 / n)[:, None]
    return peak


def by_irfft(first_phases, n_inputs):
    phases = first_phases + turns(n_inputs)
    spectrum = np.zeros((n_inputs, n_inputs, N_SAMPLES // 2 + 1), complex)
    spectrum[..., LINES] = -0.5j * N_SAMPLES * np.exp(1j * phases)
    return np.fft.irfft(spectrum, N_SAMPLES) * (PEAK / true_peak(phases).max())


def by_sines(first_phases, n_inputs):
    """As it stands in the textbook."""
    phases = first_phases + turns(n_inputs)
    angle = 2 * np.pi * LINES[:, None] / N_SAMPLES * np.arange(N_SAMPLES)
    signal = np.array([[np.sin(angle + phase[:, None]).sum(axis=0) for phase in row] for row in phases])
    return signal * (PEAK / true_peak(phases).max())


def cases():
    for n_inputs in (1, 3):
        peak = [PEAK] * n_inputs
        phases = phases_of(MULTISINE.realize(seed=1, n_inputs=n_inputs, peak=peak)[0, 0])
        for peer, how in ((by_irfft, "np.fft.irfft"), (by_sines, "sum of np.sin")):
            yield Case(
                f"multisine, {n_inputs} input{'s' * (n_inputs > 1)}",
                how,
                lambda n=n_inputs, peak=peak: MULTISINE.realize(seed=1, n_inputs=n, peak=peak),
                lambda peer=peer, phases=phases, n=n_inputs: peer(phases, n),
                tolerance=1e-9,
            )
