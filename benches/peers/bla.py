"""Best linear approximation of a 3x3 campaign, 30 realizations x 5 periods x 16 384 samples, on 71 lines.

The same work on all sides: spectra, FRFs of all blocks, their mean, and the full covariances of noise and total. frfid also checks shapes and
samples, tells draws of phases apart and gives condition numbers; best-linear-approximation also gives covariances of the spectra.
"""

import numpy as np
import scipy.fft
from case import MULTISINE, PEAK, SAMPLE_TIME_S, Case

import frfid

N_AXES = 3
LINES = MULTISINE.harmonics


def campaign(n_realizations, n_periods, n_samples):
    """Input, and an output of mixed gains and delays with noise: (realization, experiment, period, channel, sample)."""
    signal = frfid.Multisine(sample_time_s=SAMPLE_TIME_S, n_samples=n_samples, harmonics=LINES)
    drawn = [signal.realize(seed=1, realization=p, n_inputs=N_AXES, peak=PEAK) for p in range(n_realizations)]
    u = np.repeat(np.array(drawn)[:, :, None], n_periods, axis=2)
    gain = np.array([[1.0, 0.2, -0.1], [0.3, 0.8, 0.1], [-0.2, 0.4, 0.5]])
    y = np.einsum("ij,pmqjk->pmqik", gain, np.roll(u, 3, axis=-1), optimize=True)
    return u, y + np.random.default_rng(1).normal(0, 1.0, y.shape)


def by_rfft(rfft, u, y):
    n_realizations, _, n_periods = u.shape[:3]
    # (line, realization, period, channel, experiment)
    spectra_u, spectra_y = (rfft(x)[..., LINES].transpose(4, 0, 2, 3, 1) for x in (u, y))
    blocks = spectra_y @ np.linalg.pinv(spectra_u)
    per_realization = blocks.mean(axis=2)
    response = per_realization.mean(axis=1)

    def vec(matrix):
        return matrix.swapaxes(-1, -2).reshape(*matrix.shape[:-2], -1)

    noise = vec(blocks - per_realization[:, :, None])
    total = vec(per_realization - response[:, None])
    noise = np.einsum("fpqi,fpqj->fij", noise, noise.conj(), optimize=True) / (n_realizations**2 * n_periods * (n_periods - 1))
    total = np.einsum("fpi,fpj->fij", total, total.conj(), optimize=True) / (n_realizations * (n_realizations - 1))
    return response, noise, total


def by_package(u, y):
    """Arrays are (sample, channel, experiment, realization, period) there."""
    from best_linear_approximation import robust

    found = robust.noisy_input(u, y, fs=1 / SAMPLE_TIME_S, excited_bins=LINES, show_warnings=False)
    return found.G.value, found.G.noise.cov, found.G.total.cov


def by_frfid(u, y):
    frf = frfid.estimate_bla(u, y, sample_time_s=SAMPLE_TIME_S, harmonics=LINES)
    return frf.response, frf.noise_covariance, frf.total_covariance


def cases(small=False):
    n_realizations, n_periods, n_samples = (3, 3, 2048) if small else (30, 5, 16_384)
    u, y = campaign(n_realizations, n_periods, n_samples)
    theirs = [np.ascontiguousarray(signal.transpose(4, 3, 1, 0, 2)) for signal in (u, y)]
    name = f"BLA 3x3, {n_realizations} x {n_periods} periods of {n_samples}, both covariances"
    here = (name, "sample of u and y", u.size + y.size, lambda: by_frfid(u, y))
    package = ("best-linear-approximation", "robust.noisy_input", lambda: by_package(*theirs))
    yield Case(*here, *package, tolerance=1e-9, headline=True)
    yield Case(*here, "numpy", "np.fft.rfft and pinv", lambda: by_rfft(np.fft.rfft, u, y), 1e-11, headline=True)
    yield Case(*here, "scipy", "scipy.fft.rfft and pinv", lambda: by_rfft(scipy.fft.rfft, u, y), 1e-11)
