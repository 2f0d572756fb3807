"""Whatever array comes in is handled right or refused, never scrambled."""

import numpy as np
import pytest

import frfid

RNG = np.random.default_rng(7)
U, Y = RNG.standard_normal((2, 2, 3, 4, 2, 50))
U = np.repeat(U[:, :, :1], 4, axis=2)  # periods repeat
LINES = [1, 4, 7]


def estimate(u=U, y=Y, **options):
    return frfid.estimate_bla(u, y, sample_time_s=1e-3, harmonics=LINES, **options)


def packed_field(x):
    """The array as a field of packed records: strides that are no multiple of 8 bytes."""
    records = np.zeros(x.shape, dtype=[("tag", "i4"), ("value", "f8")])
    records["value"] = x
    return records["value"]


def misaligned(x):
    raw = np.zeros(x.nbytes + 1, dtype=np.uint8)
    view = raw[1:].view(np.float64).reshape(x.shape)
    view[...] = x
    return view


@pytest.mark.parametrize(
    "layout",
    [
        np.asfortranarray,
        lambda x: np.ascontiguousarray(x.T).T,
        lambda x: np.repeat(x, 2, axis=-1)[..., ::2],
        lambda x: x[..., ::-1].copy()[..., ::-1],
        lambda x: x.astype(">f8"),
        lambda x: x.tolist(),
        packed_field,
        misaligned,
    ],
    ids=["fortran", "transposed", "strided", "reversed", "big endian", "lists", "packed field", "misaligned"],
)
def test_the_layout_of_the_input_does_not_matter(layout):
    expected = estimate()
    found = estimate(layout(U), layout(Y), r=layout(U))
    assert found.response.tobytes() == estimate(r=U).response.tobytes()
    assert estimate(layout(U), layout(Y)).noise_covariance.tobytes() == expected.noise_covariance.tobytes()


def test_float32_and_integers_are_converted():
    single = estimate(U.astype(np.float32), Y)
    np.testing.assert_array_equal(single.response, estimate(U.astype(np.float32).astype(float), Y).response)
    whole = (100 * U).astype(np.int16)
    np.testing.assert_array_equal(estimate(whole, Y).response, estimate(whole.astype(float), Y).response)


@pytest.mark.parametrize(
    "u, says",
    [
        (U[0], r"u has dtype float64 and shape \(3, 4, 2, 50\), needed real numbers of shape \(realization, experiment, "),
        (U[0, 0, 0, 0], r"shape \(50,\), needed real numbers of shape \(realization, experiment, period, channel, sample\)"),
        (U.astype(complex), "u has dtype complex128"),
        (U.astype(str), "u has dtype <U"),
        (U.astype(bool), "u has dtype bool"),
        ([[[[[1.0, 2.0], [3.0]]]]], "u is no regular array"),
        (None, "u has dtype object"),
        (np.empty((0, 3, 4, 2, 50)), r"y has shape \[2, 3, 4, 2, 50\], needed \(0, "),
        (np.empty((2, 3, 4, 0, 50)), r"u has shape \[0, 3\]"),
        (np.where(np.arange(50) == 7, np.nan, U), "NaN or infinite, the first in channel 0 at sample 7"),
        (np.where(np.arange(50) == 49, np.inf, U), "NaN or infinite"),
        (U[..., :49], r"y has shape \[2, 3, 4, 2, 50\], needed \(2, 3, 4, channel, 49\), as u"),
        (U[:, :1], r"needed \(2, 1, 4, channel, 50\), as u"),
    ],
)
def test_what_cannot_be_right_is_refused(u, says):
    with pytest.raises(ValueError, match=says):
        estimate(u)


def test_masked_entries_are_refused_and_a_mask_without_any_is_not():
    masked = np.ma.masked_greater(U, 2.0)
    for u in (masked, list(masked)):
        with pytest.raises(ValueError, match=r"u is a masked array with \d+ masked entries, .*u\.filled"):
            estimate(u)
    np.testing.assert_array_equal(estimate(np.ma.array(U)).response, estimate().response)


@pytest.mark.parametrize("shape", [(0, 3, 4, 2, 50), (2, 3, 0, 2, 50), (2, 3, 4, 0, 50), (2, 3, 4, 2, 0)])
def test_nothing_at_all_is_refused(shape):
    with pytest.raises(ValueError):
        estimate(np.empty(shape), np.empty(shape))


def test_a_missing_axis_is_pointed_out():
    with pytest.raises(ValueError, match=r"y has dtype float64 and shape \(5,\).*a single channel is y\[None, :\]"):
        frfid.Record(sample_time_s=1e-3, u=np.zeros((1, 5)), y=np.zeros(5))


def test_outputs_are_c_ordered_and_results_read_only():
    frf = estimate()
    for array in (frf.response, frf.noise_variance, frf.total_covariance, frf.frequency_hz, frf.condition):
        assert array.flags.c_contiguous and not array.flags.writeable
    assert frf.response is frf.response


def test_records_keep_the_arrays_they_are_given():
    u = np.zeros((3, 1, 5))
    record = frfid.Record(sample_time_s=1e-3, u=u, y=np.asfortranarray(RNG.standard_normal((3, 2, 5))))
    assert record.u is u and record.y.flags.c_contiguous and record.r is None and record.n_samples == 5


@pytest.mark.parametrize(
    "change, says",
    [
        ({"y": np.zeros((1, 4))}, r"y has shape \[1, 4\], needed \(channel, 5\)"),
        ({"y": np.zeros((2, 1, 5))}, "as many runs as u"),
        ({"r": np.full((1, 5), np.nan)}, "r: 5 samples are NaN"),
        ({"sample_time_s": 0.0}, "sample_time_s is 0"),
        ({"input_kind": "guessed"}, "input_kind: unknown variant"),
        ({"events": [{"time_s": 0.0, "event": "tea"}]}, r"events\[0\]: unknown variant `tea`"),
    ],
)
def test_records_that_do_not_fit_are_refused(change, says):
    with pytest.raises(ValueError, match=says):
        frfid.Record(**{"sample_time_s": 1e-3, "u": np.zeros((1, 5)), "y": np.zeros((1, 5)), **change})


class Wrapped:
    """An array behind ``__array__``, as other packages wrap theirs."""

    def __init__(self, array):
        self.array = array

    def __array__(self, dtype=None, copy=None):
        return self.array


def test_masks_behind_another_object_are_refused():
    masked = np.ma.masked_greater(U, 2.0)
    for u in (Wrapped(masked), [Wrapped(part) for part in masked], [[Wrapped(part) for part in parts] for parts in masked]):
        with pytest.raises(ValueError, match=r"u is a masked array with \d+ masked entries"):
            estimate(u)
    np.testing.assert_array_equal(estimate(Wrapped(U)).response, estimate().response)
    np.testing.assert_array_equal(estimate(Wrapped(np.ma.array(U))).response, estimate().response)
