"""Synthesis of a 3x3 multisine of 65 536 samples on the odd lines from 1 to 60 Hz, experiments and channels by SK15 (9).

frfid draws the phases and scales all signals so that none exceeds 150 N m between its samples. The phases are given to the peers, since
they cannot draw those of frfid; numpy then does the same work, or less: a largest sample instead of a true peak. The package multisine
draws its own, on every line: there the powers of lines and channels are compared.
"""

import numpy as np
import scipy.fft
from case import PEAK, SAMPLE_TIME_S, Case

import frfid

LOW_HZ, HIGH_HZ, N_INPUTS = 1.0, 60.0, 3


class Grid:
    """Lines of a period: odd ones, or all."""

    def __init__(self, n_samples, step):
        first, last = (round(hz * n_samples * SAMPLE_TIME_S) for hz in (LOW_HZ, HIGH_HZ))  # as the package multisine
        self.n, self.lines = n_samples, np.arange(first + (step == 2 and first % 2 == 0), last + 1, step)
        self.signal = frfid.Multisine(sample_time_s=SAMPLE_TIME_S, n_samples=n_samples, harmonics=self.lines)

    def realize(self):
        return self.signal.realize(seed=1, n_inputs=N_INPUTS, peak=PEAK)

    def sines(self):
        """Amplitude and phases of the first signal's sines."""
        values = 2j * np.fft.rfft(self.realize()[0, 0])[self.lines] / self.n
        return np.abs(values).mean(), np.angle(values)


def turned(phases):
    """SK15 (9): phases of channel l in experiment m, (experiment, channel, line)."""
    index = np.arange(N_INPUTS)
    return phases + (2 * np.pi / N_INPUTS * (index[:, None] * index[None, :] % N_INPUTS))[:, :, None]


def true_peak(phases, lines):
    """Largest value of every sum of sines between its samples: a fine grid by FFT, then Newton's method on the slope."""
    n = 2 ** int(np.ceil(np.log2(16 * lines[-1])))
    spectrum = np.zeros((*phases.shape[:-1], n // 2 + 1), complex)
    spectrum[..., lines] = -0.5j * n * np.exp(1j * phases)
    fine = np.abs(np.fft.irfft(spectrum, n))
    peak = fine.max(axis=-1)
    highest = (fine >= np.cos(np.pi / 16) * peak[..., None]) & (fine >= np.roll(fine, 1, -1)) & (fine >= np.roll(fine, -1, -1))
    *sums, place = np.nonzero(highest)
    omega, phase, time = 2 * np.pi * lines, phases[tuple(sums)], place[:, None] / n
    for _ in range(4):
        z = np.exp(1j * (omega * time + phase))
        np.maximum.at(peak, tuple(sums), np.abs(z.imag.sum(axis=-1)))
        step = (omega * z.real).sum(axis=-1) / -(omega**2 * z.imag).sum(axis=-1)
        time = time - np.clip(step, -0.5 / n, 0.5 / n)[:, None]
    return peak.max()


def by_irfft(irfft, phases, grid):
    """All signals, unscaled."""
    phases = turned(phases)
    spectrum = np.zeros((N_INPUTS, N_INPUTS, grid.n // 2 + 1), complex)
    spectrum[..., grid.lines] = -0.5j * grid.n * np.exp(1j * phases)
    return irfft(spectrum, grid.n)


def by_irfft_and_peak(phases, grid):
    return by_irfft(np.fft.irfft, phases, grid) * (PEAK / true_peak(turned(phases), grid.lines))


def by_irfft_and_sample(irfft, phases, grid):
    signal = by_irfft(irfft, phases, grid)
    return signal * (PEAK / np.abs(signal).max())


def by_sines(amplitude, phases, grid, n_samples):
    """As it stands in the textbook, the first samples."""
    angle = 2 * np.pi / grid.n * (grid.lines[:, None] * np.arange(n_samples) % grid.n)
    return amplitude * np.array([[np.sin(angle + phase[:, None]).sum(axis=0) for phase in row] for row in turned(phases)])


def by_pyfftw(spectrum, n_samples):
    from pyfftw.interfaces import cache, scipy_fft

    cache.enable()
    return scipy_fft.irfft(spectrum, n_samples)


def by_multisine(n_samples):
    from multisine import random_phase_orthogonal_multisine

    made = random_phase_orthogonal_multisine(n_samples, 1 / SAMPLE_TIME_S, N_INPUTS, f_min=LOW_HZ, f_max=HIGH_HZ, seed=1)
    return made.u.transpose(2, 1, 0)


def to_largest_sample(signal):
    return signal / np.abs(signal).max()


def powers(signal):
    """U U^H of every line over its mean trace: a multiple of the identity on excited lines, 0 on others."""
    spectra = np.fft.rfft(signal)
    products = np.einsum("mif,mjf->fij", spectra, spectra.conj(), optimize=True)
    return products / np.trace(products, axis1=1, axis2=2).max().real


def cases(small=False):
    odd, every = (Grid(4096 if small else 65_536, step) for step in (2, 1))
    (amplitude, phases), n, few = odd.sines(), odd.n * N_INPUTS**2, 64 if small else 512
    here = (f"multisine 3x3, N = {odd.n}, odd lines, true peak", "sample", n, odd.realize)
    yield Case(*here, "numpy", "np.fft.irfft, Newton for the peak", lambda: by_irfft_and_peak(phases, odd), 1e-9, headline=True)
    sampled = {"tolerance": 1e-9, "seen": to_largest_sample, "remark": "scales to the largest sample, not to the true peak"}
    for package, how, irfft in (
        ("numpy", "np.fft.irfft", np.fft.irfft), ("scipy", "scipy.fft.irfft", scipy.fft.irfft), ("pyfftw", "irfft of FFTW, plan kept", by_pyfftw)
    ):
        yield Case(*here, package, how, lambda irfft=irfft: by_irfft_and_sample(irfft, phases, odd), **sampled)
    sines = lambda: by_sines(amplitude, phases, odd, few)
    yield Case(*here, "numpy", "sum of np.sin", sines, 1e-9, n_peer=few * N_INPUTS**2, remark="is given the amplitude")
    yield Case(
        f"multisine 3x3, N = {odd.n}, every line, true peak",
        "sample",
        n,
        every.realize,
        "multisine",
        "random_phase_orthogonal_multisine",
        lambda: by_multisine(odd.n),
        tolerance=1e-9,
        seen=powers,
        remark="has phases of its own and scales to a given rms; powers of lines and channels are compared",
        headline=True,
    )
