"""Tests of structures with a known answer: a hammer on two modes, and noise into two inputs of a structure with three outputs.

Signals are (test, channel, sample). The structure is a sampled one, so that its response between samples is no matter of opinion.
"""

from dataclasses import dataclass

import numpy as np
from scipy.signal import cont2discrete, lfilter

SAMPLE_RATE_HZ = 1000
MODES = ((18.0, 0.08), (47.0, 0.05), (110.0, 0.04))  # Hz, damping ratio


@dataclass
class Test:
    force: np.ndarray
    motion: np.ndarray
    lines: np.ndarray  # of the DFT of a segment, where the force has power
    segment: int
    truth: np.ndarray  # (line, output, input)
    noise_power: float | None = None  # of the motion on a line of the DFT, where it is known


def hammer(n_hits, motion_noise=0.0, force_noise=0.0, seed=5, n_samples=4096):
    """Half-sine blows of 4 ms and changing strength; the motion has died out at the end of each record."""
    rng = np.random.default_rng(seed)
    force = np.zeros((n_hits, 1, n_samples))
    force[..., 20:24] = np.sin(np.pi * np.array([0.2, 0.4, 0.6, 0.8]))
    force *= 1 + 0.3 * rng.random((n_hits, 1, 1))
    shapes = np.array([[1.0, -0.7, 0.4]])
    motion = structure(force, shapes, shapes)
    lines = np.arange(10, 600)
    truth = response(lines, n_samples, shapes, shapes)
    power = n_samples * motion_noise**2 * np.mean(motion**2)
    return Test(noisy(rng, force, force_noise), noisy(rng, motion, motion_noise), lines, n_samples, truth, power)


def shaker(n_outputs, motion_noise=0.0, force_noise=0.0, seed=6, n_tests=10, seconds=10, segment=2000):
    """Independent white forces at two points, motion at some points."""
    rng = np.random.default_rng(seed)
    lead_in = 4 * SAMPLE_RATE_HZ
    force = rng.standard_normal((n_tests, 2, lead_in + seconds * SAMPLE_RATE_HZ))
    at_force = np.array([[1.0, 0.6, -0.5], [0.4, -0.8, 0.9]])
    at_motion = np.array([[1.0, 0.6, -0.5], [0.4, -0.8, 0.9], [0.7, 0.5, 0.8]])[:n_outputs]
    motion = structure(force, at_motion, at_force)[..., lead_in:]
    lines = np.arange(10, 260)
    truth = response(lines, segment, at_motion, at_force)
    return Test(noisy(rng, force[..., lead_in:], force_noise), noisy(rng, motion, motion_noise), lines, segment, truth)


def noisy(rng, signal, level):
    """With white noise of a share of each channel's rms."""
    rms = np.sqrt(np.mean(signal**2, axis=(0, 2), keepdims=True))
    return signal + level * rms * rng.standard_normal(signal.shape)


def modes():
    """Every mode as numerator and denominator in z^-1, for a force that is held between samples."""
    for hertz, damping in MODES:
        omega = 2 * np.pi * hertz
        continuous = ([1.0], [1.0, 2 * damping * omega, omega**2])
        numerator, denominator, _ = cont2discrete(continuous, 1 / SAMPLE_RATE_HZ)
        yield numerator[0] * omega**2, denominator


def structure(force, at_motion, at_force):
    """Motion by a sum of modes with their shapes at the points of motion and force, (point, mode)."""
    motion = np.zeros((force.shape[0], len(at_motion), force.shape[2]))
    for mode, (numerator, denominator) in enumerate(modes()):
        moved = lfilter(numerator, denominator, np.einsum("i,tin->tn", at_force[:, mode], force))
        motion += at_motion[:, mode, None] * moved[:, None]
    return motion


def response(lines, n_samples, at_motion, at_force):
    angle = 2 * np.pi * lines / n_samples
    found = np.zeros((len(lines), len(at_motion), len(at_force)), complex)
    for mode, (numerator, denominator) in enumerate(modes()):
        delay = np.exp(-1j * angle)
        of_mode = np.polyval(numerator[::-1], delay) / np.polyval(denominator[::-1], delay)
        found += of_mode[:, None, None] * np.outer(at_motion[:, mode], at_force[:, mode])
    return found


def segments(signal, length):
    """Hann segments that overlap by half, without their means: (test, segment, channel, sample)."""
    cut = np.lib.stride_tricks.sliding_window_view(signal, length, axis=-1)[:, :, :: length // 2]
    return ((cut - cut.mean(axis=-1, keepdims=True)) * np.hanning(length)).transpose(0, 2, 1, 3)
