"""FRF of a 3x3 machine from chirps of 20 s by excerpts at 80 frequencies, SK15 section 5.1, at 1 and 10 kHz.

Four periods around each instant, mean removed, anti-alias filter and decimation to ten samples per period, Hann window, DFT, division. frfid
folds all of that into one weighted sum per frequency. scipy.signal.upfirdn does the same with the same filter, decimate with one of its own,
and numpy the sum over all samples without filter.
"""

import numpy as np
from case import PEAK, Case

import frfid

CHIRP = frfid.Chirp(low_hz=1.0, high_hz=60.0, duration_s=20.0, amplitude=PEAK)


def recording(sample_time_s):
    """Chirps with flipped signs, and their coupled means with what was 5 ms before, (experiment, channel, sample)."""
    u = CHIRP.sample(sample_time_s=sample_time_s, n_inputs=3, mimo="sign-flip")
    motion = 0.5 * (u + np.roll(u, round(5e-3 / sample_time_s), axis=-1))
    gain = np.array([[1.0, 0.2, -0.1], [0.3, 0.8, 0.1], [-0.2, 0.4, 0.5]])
    return u, gain @ motion


def ends(hz, sample_time_s, n_samples):
    """First and last sample of the excerpt at `hz`."""
    centre = CHIRP.instant_of(hz)
    low, high = max(centre - 2 / hz, 0.0), min(centre + 2 / hz, CHIRP.duration_s)
    return int(np.ceil(low / sample_time_s)), int(min(np.floor(high / sample_time_s), n_samples - 1))


def correlated(piece, hz, sample_time_s, step, length):
    """Hann-weighted DFT at `hz` of every `step`-th sample of so many."""
    place = step * np.arange(piece.shape[1])
    window = np.sin(np.pi * place / length) ** 2
    return piece @ (window * np.exp(-2j * np.pi * hz * sample_time_s * place))


def by_upfirdn(x, hz, sample_time_s):
    """Value of every channel at `hz`, x (channel, sample): the filter reaches beyond the excerpt where there are samples."""
    from scipy import signal

    first, last = ends(hz, sample_time_s, x.shape[1])
    step = max(int(1 / (10 * hz * sample_time_s)), 1)
    taps = signal.windows.hann(4 * step + 1)[1:-1] if step > 1 else np.ones(1)
    reach = len(taps) // 2
    before, after = min(reach, first), min(reach, x.shape[1] - 1 - last)
    piece = x[:, first - before : last + after + 1] - x[:, first : last + 1].mean(axis=1, keepdims=True)
    lead = -2 * reach % step  # zeros in front, so that the filter is centred on the samples that are kept
    piece = np.pad(piece, ((0, 0), (reach - before + lead, reach - after)))
    start, count = (2 * reach + lead) // step, 1 + (last - first) // step
    coarse = signal.upfirdn(taps / taps.sum(), piece, down=step, axis=1)[:, start : start + count]
    return correlated(coarse, hz, sample_time_s, step, last - first)


def by_decimate(x, hz, sample_time_s):
    from scipy import signal

    first, last = ends(hz, sample_time_s, x.shape[1])
    step = max(int(1 / (10 * hz * sample_time_s)), 1)
    piece = x[:, first : last + 1] - x[:, first : last + 1].mean(axis=1, keepdims=True)
    if step > 1:
        piece = signal.decimate(piece, step, ftype="fir", axis=1)
    return correlated(piece, hz, sample_time_s, step, last - first)


def by_sum(x, hz, sample_time_s):
    first, last = ends(hz, sample_time_s, x.shape[1])
    piece = x[:, first : last + 1]
    return correlated(piece - piece.mean(axis=1, keepdims=True), hz, sample_time_s, 1, last - first)


def by_peer(excerpt, u, y, frequencies_hz, sample_time_s):
    n_experiments, n_channels, _ = u.shape
    both = np.concatenate([u, y], axis=1).reshape(2 * n_experiments * n_channels, -1)
    values = np.array([excerpt(both, hz, sample_time_s) for hz in frequencies_hz]).reshape(-1, n_experiments, 2, n_channels)
    values = values.transpose(2, 0, 3, 1)  # (u or y, frequency, channel, experiment)
    return values[1] @ np.linalg.pinv(values[0])


def by_frfid(u, y, frequencies_hz, sample_time_s):
    return frfid.estimate_chirp(u, y, chirp=CHIRP, sample_time_s=sample_time_s, frequencies_hz=frequencies_hz).response


def cases(small=False):
    frequencies_hz = np.geomspace(1.3, 55.0, 8 if small else 80)
    for rate, sample_time_s in (("1 kHz", 1e-3), ("10 kHz", 1e-4)):
        recorded = (*recording(sample_time_s), frequencies_hz, sample_time_s)
        lengths = [1 + last - first for first, last in (ends(hz, sample_time_s, recorded[0].shape[-1]) for hz in frequencies_hz)]
        name = f"chirp excerpts 3x3, {len(lengths)} frequencies, {rate}"
        here = (name, "excerpt sample", 18 * sum(lengths), lambda recorded=recorded: by_frfid(*recorded))
        filters = "has another filter"
        for package, how, excerpt, tolerance, remark in (
            ("scipy", "scipy.signal.decimate", by_decimate, 0.02, filters), ("scipy", "scipy.signal.upfirdn", by_upfirdn, 1e-9, ""), ("numpy", "sum over all samples", by_sum, 0.02, filters)
        ):
            peer = lambda excerpt=excerpt, recorded=recorded: by_peer(excerpt, *recorded)
            yield Case(*here, package, how, peer, tolerance, remark=remark, headline=excerpt is by_decimate)
