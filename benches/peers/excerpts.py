"""FRF of a 3x3 machine from chirps of 20 s by excerpts at 80 frequencies, SK15 section 5.1.

The same work on both sides: four periods around each instant, mean removed, anti-alias filter and decimation to ten samples per
period, Hann window, DFT, division. frfid folds all of that into one weighted sum per frequency.
"""

import numpy as np
import scipy.signal
from case import SAMPLE_TIME_S, Case

import frfid

CHIRP = frfid.Chirp(low_hz=1.0, high_hz=60.0, duration_s=20.0, amplitude=150.0)
FREQUENCIES_HZ = np.geomspace(1.3, 55.0, 80)


def recording():
    """Chirps with flipped signs and the output of three equal joints that are coupled, (experiment, channel, sample)."""
    u = CHIRP.sample(sample_time_s=SAMPLE_TIME_S, n_inputs=3, mimo="sign-flip")
    joint = frfid.Plant.single_joint()
    motion = np.array([joint.simulate(channels[:, None], sample_time_s=SAMPLE_TIME_S).y[:, 0] for channels in u])
    gain = np.array([[1.0, 0.2, -0.1], [0.3, 0.8, 0.1], [-0.2, 0.4, 0.5]])
    return u, gain @ motion


def excerpt(x, hz):
    """Value of every channel at `hz`, x (channel, sample)."""
    centre = CHIRP.instant_of(hz)
    low, high = max(centre - 2 / hz, 0.0), min(centre + 2 / hz, CHIRP.duration_s)
    first, last = int(np.ceil(low / SAMPLE_TIME_S)), int(min(np.floor(high / SAMPLE_TIME_S), x.shape[1] - 1))
    step = max(int(1 / (10 * hz * SAMPLE_TIME_S)), 1)
    taps = scipy.signal.windows.hann(4 * step + 1)[1:-1] if step > 1 else np.ones(1)
    reach = len(taps) // 2
    before, after = min(reach, first), min(reach, x.shape[1] - 1 - last)
    piece = x[:, first - before : last + after + 1] - x[:, first : last + 1].mean(axis=1, keepdims=True)
    lead = -2 * reach % step  # zeros in front, so that the filter is centred on the samples that are kept
    piece = np.pad(piece, ((0, 0), (reach - before + lead, reach - after)))
    start, count = (2 * reach + lead) // step, 1 + (last - first) // step
    coarse = scipy.signal.upfirdn(taps / taps.sum(), piece, down=step, axis=1)[:, start : start + count]
    place = step * np.arange(coarse.shape[1])
    window = np.sin(np.pi * place / (last - first)) ** 2
    return coarse @ (window * np.exp(-2j * np.pi * hz * SAMPLE_TIME_S * place))


def by_scipy(u, y):
    n_experiments, n_channels, _ = u.shape
    both = np.concatenate([u, y], axis=1).reshape(2 * n_experiments * n_channels, -1)
    values = np.array([excerpt(both, hz) for hz in FREQUENCIES_HZ]).reshape(-1, n_experiments, 2, n_channels)
    values = values.transpose(2, 0, 3, 1)  # (u or y, frequency, channel, experiment)
    return values[1] @ np.linalg.pinv(values[0])


def by_frfid(u, y):
    return frfid.estimate_chirp(u, y, chirp=CHIRP, sample_time_s=SAMPLE_TIME_S, frequencies_hz=FREQUENCIES_HZ).response


def cases():
    u, y = recording()
    yield Case(
        "excerpts 3x3, 80 frequencies",
        "scipy.signal, frequency by frequency",
        lambda: by_frfid(u, y),
        lambda: by_scipy(u, y),
        tolerance=1e-9,
    )
