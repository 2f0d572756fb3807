"""Multisines and chirps against numpy and scipy."""

import copy
import pickle

import numpy as np
import pytest
import scipy.signal

import frfid

PAPER = dict(low_hz=1.0, high_hz=60.0, sample_time_s=1e-3, resolution_hz=0.1, n_lines=80, grid="odd")


def test_the_paper_s_design_numbers():
    ms = frfid.Multisine.design(**PAPER)
    assert (ms.n_samples, ms.sample_time_s, len(ms.lines_hz), ms.harmonics[0]) == (12288, 1e-3, 71, 13)
    assert ms.period_s == pytest.approx(12.288)
    assert ms.fundamental_hz == pytest.approx(0.08138, abs=5e-6)
    np.testing.assert_allclose(ms.lines_hz, ms.harmonics / ms.period_s, rtol=1e-15)
    assert ms.lines_hz[-1] == pytest.approx(59.977, abs=5e-4)


def test_power_only_on_the_excited_lines_with_equal_amplitudes():
    ms = frfid.Multisine.design(**PAPER)
    spectrum = 2 * np.fft.rfft(ms.realize(seed=1, n_inputs=3, peak=[150.0, 100.0, 50.0])) / ms.n_samples
    excited = np.zeros(spectrum.shape[-1], bool)
    excited[ms.harmonics] = True
    amplitude = np.abs(spectrum[..., excited])
    assert np.abs(spectrum[..., ~excited]).max() < 1e-12 * amplitude.max()
    np.testing.assert_allclose(amplitude / amplitude[0, :, :1], np.ones((3, 3, 71)), rtol=1e-11)
    # (9): between experiments a channel turns by multiples of 2 pi / 3
    turn = spectrum[1, 1, excited] / spectrum[0, 1, excited]
    np.testing.assert_allclose(turn, np.exp(2j * np.pi / 3), rtol=1e-10)


def test_the_peak_holds_between_the_samples_and_is_reached():
    ms = frfid.Multisine.design(**PAPER)
    signal = ms.realize(seed=3, n_inputs=2, peak=[150.0, 75.0])
    dense = 32 * ms.n_samples
    between = np.fft.irfft(np.fft.rfft(signal), n=dense) * dense / ms.n_samples
    reached = np.abs(between).max(axis=(0, 2)) / [150.0, 75.0]
    below = 1 - np.cos(np.pi * 60.0 * 1e-3 / 32)  # by which a 60 Hz sine can peak between two of these points
    assert 1 - below < reached.max() < 1 + 1e-12


def test_same_seed_same_bytes():
    ms = frfid.Multisine.design(**PAPER)
    draw = lambda **change: ms.realize(**{"seed": 1, "n_inputs": 3, "peak": 150.0, **change}).tobytes()
    assert draw() == draw()
    assert len({draw(), draw(seed=2), draw(realization=1), draw(mimo="sign-flip"), draw(mimo="independent")}) == 5


def test_shape_grid_and_phases():
    shaped = frfid.Multisine.design(**PAPER, shape=[(39.0, 2.0), (41.0, 1.0)])
    amplitude = np.abs(np.fft.rfft(shaped.realize(seed=1)[0, 0]))[shaped.harmonics]
    assert amplitude[0] / amplitude[-1] == pytest.approx(2.0)
    random = frfid.Multisine.design(**{**PAPER, "n_lines": None, "grid": "odd-random"}, seed=5)
    assert len(random.detection) == 363 // 4 and not set(random.detection) & set(random.harmonics)
    crest = lambda x: np.abs(x).max() / np.sqrt(np.mean(x**2))
    low = frfid.Multisine.design(**PAPER, phases="low-crest").realize(seed=1)[0, 0]
    assert crest(low) < 0.75 * crest(frfid.Multisine.design(**PAPER).realize(seed=1)[0, 0])


def test_a_foreign_grid():
    ms = frfid.Multisine(sample_time_s=0.5, n_samples=19, harmonics=[1, 4], shape=2.0)
    assert ms.lines_hz.tolist() == [1 / 9.5, 4 / 9.5]
    with pytest.raises(ValueError, match="line 10 is not between 1 and 9"):
        frfid.Multisine(sample_time_s=0.5, n_samples=19, harmonics=[1, 10])


@pytest.mark.parametrize("low_hz, high_hz, duration_s", [(1.0, 60.0, 20.0), (2.0, 60.0, 20.0), (0.3, 400.0, 7.0)])
def test_chirp_is_scipy_s_logarithmic_chirp(low_hz, high_hz, duration_s):
    chirp = frfid.Chirp(low_hz=low_hz, high_hz=high_hz, duration_s=duration_s, amplitude=150.0)
    sampled = chirp.sample(sample_time_s=1e-3)
    t = np.arange(round(duration_s / 1e-3)) * 1e-3
    expected = 150.0 * scipy.signal.chirp(t, low_hz, duration_s, high_hz, method="logarithmic", phi=-90)
    np.testing.assert_allclose(sampled[0, 0], expected, atol=150.0 * 1e-9)
    assert chirp.frequency_at(chirp.instant_of(13.0)) == pytest.approx(13.0)


def test_chirp_channels_flip_signs_and_follow_their_profiles():
    table = [[(36.0, 100.0), (44.0, 50.0)], 150.0]
    chirp = frfid.Chirp(low_hz=2.0, high_hz=60.0, duration_s=20.0, amplitude=table, tail_s=1.0, fade_s=0.1)
    c = chirp.sample(sample_time_s=1e-3, n_inputs=2)
    assert c.shape == (2, 2, 21_000) and c.flags.c_contiguous
    np.testing.assert_allclose(c[1, 1], -c[0, 1], atol=1e-9)
    np.testing.assert_array_equal(c[1, 0], c[0, 0])
    late = slice(19_500, 19_800)
    assert np.abs(c[0, 0, late]).max() == pytest.approx(50.0, rel=1e-2)
    assert np.abs(c[0, 1, late]).max() == pytest.approx(150.0, rel=1e-2)
    assert not c[..., 20_001:].any()


@pytest.mark.parametrize(
    "make, says",
    [
        (lambda: frfid.Multisine.design(**{**PAPER, "high_hz": 500.0}), "not below the Nyquist frequency 500 Hz"),
        (lambda: frfid.Multisine.design(**{**PAPER, "low_hz": float("nan")}), "low_hz is NaN"),
        (lambda: frfid.Multisine.design(**{**PAPER, "low_hz": 10.0, "high_hz": 10.01, "n_lines": None}), "no odd line"),
        (lambda: frfid.Multisine.design(**{**PAPER, "grid": "ood"}), "grid: unknown variant `ood`"),
        (lambda: frfid.Multisine.design(**PAPER).realize(seed=1, n_inputs=2, peak=[1.0]), "each of the 2 channels"),
        (lambda: frfid.Multisine.design(**PAPER).realize(seed=1, peak=-1.0), "peak is -1"),
        (lambda: frfid.Chirp(low_hz=1.0, high_hz=60.0, duration_s=20.0, amplitude="loud"), "amplitude is 'loud'"),
        (lambda: frfid.Chirp(low_hz=1.0, high_hz=1.0, duration_s=20.0), "high_hz is 1"),
    ],
)
def test_bad_parameters_are_named(make, says):
    with pytest.raises(ValueError, match=says):
        make()


def test_parameters_are_keywords_and_misspelt_ones_are_refused():
    with pytest.raises(TypeError):
        frfid.Chirp(1.0, 60.0, 20.0)
    with pytest.raises(TypeError, match="low_Hz"):
        frfid.Chirp(low_Hz=1.0, high_hz=60.0, duration_s=20.0)


@pytest.mark.parametrize("protocol", [2, 5])
def test_pickles_and_copies_are_equal(protocol):
    chirp = frfid.Chirp(low_hz=1.0, high_hz=60.0, duration_s=20.0, amplitude=[[(36.0, 100.0), (44.0, 50.0)], 1.0], fade_s=0.1)
    random = {**PAPER, "grid": "odd-random", "n_lines": None}
    for thing in (frfid.Multisine.design(**random, shape=[(3.0, 1.0), (4.0, 2.0)], phases="low-crest"), chirp):
        assert pickle.loads(pickle.dumps(thing, protocol)) == thing == copy.deepcopy(thing)
    assert chirp != frfid.Chirp(low_hz=1.0, high_hz=60.0, duration_s=20.0)
