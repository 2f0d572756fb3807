"""Best linear approximation of a 3x3 campaign, 10 realizations x 5 periods x 12288 samples, on 71 lines.

The same work on both sides: spectra, the condition number of U, FRFs of all 50 blocks, their mean, and the full covariances of
noise and total. frfid also checks shapes and samples, and uses as many threads as there are cores; numpy's FFT uses one.
"""

import numpy as np
from case import MULTISINE, SAMPLE_TIME_S, Case

import frfid

N_REALIZATIONS, N_PERIODS, N_AXES = 10, 5, 3


def campaign():
    """Input, and an output of mixed gains and delays with noise: (realization, experiment, period, channel, sample)."""
    drawn = [MULTISINE.realize(seed=1, realization=p, n_inputs=N_AXES, peak=150.0) for p in range(N_REALIZATIONS)]
    u = np.repeat(np.array(drawn)[:, :, None], N_PERIODS, axis=2)
    gain = np.array([[1.0, 0.2, -0.1], [0.3, 0.8, 0.1], [-0.2, 0.4, 0.5]])
    y = np.einsum("ij,pmqjk->pmqik", gain, np.roll(u, 3, axis=-1), optimize=True)
    return u, y + np.random.default_rng(1).normal(0, 1.0, y.shape)


def by_numpy(u, y):
    lines = MULTISINE.harmonics
    # (line, realization, period, channel, experiment)
    spectra_u, spectra_y = (np.fft.rfft(x)[..., lines].transpose(4, 0, 2, 3, 1) for x in (u, y))
    blocks = spectra_y @ np.linalg.pinv(spectra_u)
    condition = np.linalg.cond(spectra_u).max(axis=(1, 2))
    per_realization = blocks.mean(axis=2)
    response = per_realization.mean(axis=1)

    def vec(matrix):
        return matrix.swapaxes(-1, -2).reshape(*matrix.shape[:-2], -1)

    noise = vec(blocks - per_realization[:, :, None])
    total = vec(per_realization - response[:, None])
    noise = np.einsum("fpqi,fpqj->fij", noise, noise.conj(), optimize=True) / (N_REALIZATIONS**2 * N_PERIODS * (N_PERIODS - 1))
    total = np.einsum("fpi,fpj->fij", total, total.conj(), optimize=True) / (N_REALIZATIONS * (N_REALIZATIONS - 1))
    return response, condition, noise, total


def by_frfid(u, y):
    frf = frfid.estimate_bla(u, y, sample_time_s=SAMPLE_TIME_S, harmonics=MULTISINE.harmonics)
    return frf.response, frf.condition, frf.noise_covariance, frf.total_covariance


def cases():
    u, y = campaign()
    yield Case(
        "BLA 3x3, 10 x 5 periods", "np.fft.rfft and pinv", lambda: by_frfid(u, y), lambda: by_numpy(u, y), tolerance=1e-11
    )
