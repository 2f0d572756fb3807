"""Arrays of float32, of integers and with gaps, through every door that takes signals: the numbers are those of their float64 copy."""

import numpy as np
import pytest

import frfid

T = 1e-3
RNG = np.random.default_rng(5)
ONE = np.round(1000 * RNG.standard_normal((2, 1, 1, 1, 400)))
U = np.repeat(ONE, 2, axis=2)  # two periods
Y = np.cumsum(U, axis=-1)  # other numbers than U, float64 whatever U is
RECORD = np.round(1000 * RNG.standard_normal((1, 1000)))
ANSWER = np.cumsum(RECORD, axis=-1)
JOINT = frfid.Plant.single_joint(coulomb_nm=20.0)
LOOP = frfid.PiController(gain=2000.0, integral_gain=16_000.0, sample_time_s=T)
CHIRP = frfid.Chirp(low_hz=5.0, high_hz=60.0, duration_s=2.0, amplitude=1000.0)
SWEEP = np.round(CHIRP.sample(sample_time_s=T))
SWEPT = np.cumsum(SWEEP, axis=-1)
LINES = dict(sample_time_s=T, harmonics=[1, 4, 7])


def signals(record):
    return np.concatenate([record.u, record.y])


def local(u, y):
    return frfid.estimate_local(u, y, sample_time_s=T, frequencies_hz=[50.0, 100.0]).response


def swept(u, y):
    return frfid.estimate_chirp(u, y, chirp=CHIRP, sample_time_s=T, frequencies_hz=[10.0, 30.0]).response


DOORS = {
    "estimate, input": (U, lambda u: frfid.estimate(u, Y, **LINES).response),
    "estimate, output": (U, lambda y: frfid.estimate(Y, y, **LINES).response),
    "estimate_bla, reference": (U, lambda r: frfid.estimate_bla(Y, U, r=r, **LINES).response),
    "estimate_loop": (U, lambda r: frfid.estimate_loop(Y, U, r, loop="set-point", **LINES)["sensitivity"].response),
    "coherence": (U, lambda u: frfid.coherence(u, Y, **LINES)),
    "spectra_covariance": (U, lambda u: frfid.spectra_covariance(u, Y, **LINES)["noise"]),
    "estimate_local, input": (RECORD, lambda u: local(u, ANSWER)),
    "estimate_local, output": (RECORD, lambda y: local(ANSWER, y)),
    "estimate_chirp, input": (SWEEP, lambda u: swept(u, SWEPT)),
    "estimate_chirp, output": (SWEEP, lambda y: swept(SWEPT, y)),
    "spectrogram": (RECORD, lambda u: frfid.spectrogram(u, sample_time_s=T, window_s=0.1)[2]),
    "simulate": (RECORD, lambda u: signals(JOINT.simulate(u, sample_time_s=T))),
    "simulate many": (U[:, 0, 0], lambda u: frfid.simulate(JOINT, u, sample_time_s=T).y),
    "run_closed_loop": (RECORD, lambda r: signals(frfid.run_closed_loop(JOINT, LOOP, r))),
    "Record": (RECORD, lambda u: signals(frfid.Record(sample_time_s=T, u=u, y=u))),
}
KINDS = {
    "float32": lambda x: x.astype(np.float32),
    "int16": lambda x: x.astype(np.int16),
    "int32": lambda x: x.astype(np.int32),
    "every second of float64": lambda x: np.repeat(x, 2, axis=-1)[..., ::2],
    "every second of float32": lambda x: np.repeat(x.astype(np.float32), 2, axis=-1)[..., ::2],
    "samples before channels": lambda x: np.ascontiguousarray(x.T).T,
    "backwards": lambda x: x[..., ::-1].copy()[..., ::-1],
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("door", DOORS)
def test_numbers_are_those_of_the_float64_copy(door, kind):
    values, of = DOORS[door]
    given = KINDS[kind](values)
    copy = np.array(given, dtype=np.float64, order="C")
    np.testing.assert_array_equal(copy, values)
    assert np.asarray(of(given)).tobytes() == np.asarray(of(copy)).tobytes()
