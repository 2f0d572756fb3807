"""Campaigns with a known answer: a plant line by line, noise and distortion of known covariance, played in time.

Signals are (realization, experiment, period, channel, sample), matrices of a line (line, row, column). Everything is drawn in the
frequency domain, so that the plant and every covariance are known exactly and not simulated.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np

N_SAMPLES = 32  # of a period: 15 lines, all excited
N_PERIODS = 8
LINES = np.arange(1, N_SAMPLES // 2)
SAMPLE_TIME_S = 1e-3
GROUPS = ("known input", "noisy input", "closed loop")
LAYOUTS = ((1, 1, True), (3, 2, True), (3, 2, False))  # outputs, inputs, orthogonal
DISTURBANCES = ("noise", "distortion", "both")
AMPLITUDE = 30.0  # of the excitation, where noise and distortion are about 1


@dataclass
class Truth:
    """The plant and covariances behind a campaign; those of spectra in squared units of the DFT."""

    response: np.ndarray  # (line, output, input)
    noise: np.ndarray  # of [u; y] in one period
    distortion: np.ndarray  # of y in one realization, the input being what it is
    input_distortion: np.ndarray  # of u in one realization, the reference being what it is
    weight: np.ndarray  # W: a covariance C of Y - G U gives vec(G) the covariance W x C

    @property
    def equation_noise(self):
        """Noise of Y - G U in one period."""
        turn = residual(self.response)
        return turn @ self.noise @ adjoint(turn)

    def of_response(self, covariance):
        """W x C, Kronecker product line by line."""
        product = self.weight[:, :, None, :, None] * covariance[:, None, :, None, :]
        size = self.weight.shape[1] * covariance.shape[1]
        return product.reshape(-1, size, size)


@dataclass
class Scenario:
    group: str
    name: str
    u: np.ndarray
    y: np.ndarray
    r: np.ndarray | None
    disturbance: str
    truth: Truth


def adjoint(matrix):
    return matrix.conj().swapaxes(-1, -2)


def residual(response):
    """[-G, I], which takes [u; y] to Y - G U."""
    n_lines, n_outputs, _ = response.shape
    return np.concatenate([-response, np.broadcast_to(np.eye(n_outputs), (n_lines, n_outputs, n_outputs))], axis=2)


def all_scenarios(n_realizations):
    """The 54: three groups, three layouts, three disturbances, two seeds."""
    for group, layout, disturbance, seed in product(GROUPS, LAYOUTS, DISTURBANCES, (1, 2)):
        yield scenario(group, layout, disturbance, seed, n_realizations)


def scenario(group, layout, disturbance, seed, n_realizations, n_periods=N_PERIODS, input_noise=1.0, loop_gain=0.3):
    n_outputs, n_inputs, is_orthogonal = layout
    rng = np.random.default_rng([seed, GROUPS.index(group), LAYOUTS.index(layout), DISTURBANCES.index(disturbance)])
    plant = normal(rng, len(LINES), n_outputs, n_inputs)
    drive = AMPLITUDE * mixed_phases(rng, n_realizations, n_inputs, is_orthogonal)
    distortion = covariance(rng, n_outputs) * (disturbance != "noise")
    noise = covariance(rng, n_inputs + n_outputs) * (disturbance != "distortion")
    noise[:, :n_inputs] *= input_noise * (group != "known input")
    noise[:, :, :n_inputs] *= input_noise * (group != "known input")

    distorted = draw(rng, distortion, (n_realizations, n_inputs))
    loop = loop_gain * normal(rng, len(LINES), n_inputs, n_outputs) * (group == "closed loop")
    sensitivity = np.linalg.inv(np.eye(n_inputs) + loop @ plant)
    control = sensitivity @ loop  # from distortion to -u
    u = sensitivity @ drive - control @ distorted
    y = plant @ u + distorted
    clean = np.concatenate([u, y], axis=-2)[:, None]  # (realization, period, line, channel, experiment)
    measured = in_time(clean + draw(rng, noise, (n_realizations, n_periods, n_inputs)))
    r = None
    if group == "closed loop":
        r = in_time(np.broadcast_to(drive[:, None], (n_realizations, n_periods, *drive.shape[1:])))
        weight = weight_through_reference(drive, sensitivity)
    else:
        weight = np.linalg.inv(drive @ adjoint(drive)).conj().mean(axis=0) / n_realizations
    form = "" if n_inputs == 1 else ", orthogonal" if is_orthogonal else ", not orthogonal"
    return Scenario(
        group,
        f"{n_outputs} x {n_inputs}{form}, {disturbance}, seed {seed}",
        measured[..., :n_inputs, :],
        measured[..., n_inputs:, :],
        r,
        disturbance,
        Truth(plant, noise, distortion, control @ distortion @ adjoint(control), weight),
    )


def weight_through_reference(drive, sensitivity):
    """W of G = (sum Y R^H) (sum U R^H)^-1."""
    power = (drive @ adjoint(drive)).mean(axis=0)
    inverse = np.linalg.inv(sensitivity @ power)
    return inverse.swapaxes(1, 2) @ power.conj() @ inverse.conj() / len(drive)


def normal(rng, *shape):
    """Circular complex normal numbers of power 1."""
    return (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2)


def covariance(rng, size):
    """A well-conditioned covariance for every line, of trace `size`."""
    factor = np.eye(size) + 0.3 * normal(rng, len(LINES), size, size)
    found = factor @ adjoint(factor)
    return found * (size / np.trace(found, axis1=1, axis2=2).real)[:, None, None]


def mixed_phases(rng, n_realizations, n_inputs, is_orthogonal):
    """(realization, line, input, experiment): random phases of every input and experiment around one matrix that mixes them."""
    index = np.arange(n_inputs)
    mixing = np.exp(2j * np.pi * np.outer(index, index) / n_inputs) / np.sqrt(n_inputs)
    if not is_orthogonal:
        mixing = mixing @ (np.eye(n_inputs) + 0.4 * np.triu(np.ones((n_inputs, n_inputs)), 1))
    phases = np.exp(2j * np.pi * rng.random((2, n_realizations, len(LINES), n_inputs)))
    return phases[0][..., :, None] * mixing * phases[1][..., None, :]


def draw(rng, covariance, shape):
    """Columns of this covariance: (*shape without its last, line, channel, last of shape)."""
    values, vectors = np.linalg.eigh(covariance)
    factor = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    return factor @ normal(rng, *shape[:-1], *covariance.shape[:2], shape[-1])


def in_time(spectra):
    """(realization, period, line, channel, experiment) to (realization, experiment, period, channel, sample)."""
    whole = np.zeros((*spectra.shape[:2], N_SAMPLES // 2 + 1, *spectra.shape[3:]), complex)
    whole[:, :, LINES] = spectra
    return np.ascontiguousarray(np.fft.irfft(whole, axis=2).transpose(0, 4, 1, 3, 2))
