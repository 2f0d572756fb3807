"""The Bode diagram in matplotlib: numbers, ranges and labels as one can read them."""

import itertools
import time

import numpy as np
import pytest

import frfid

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")
plt = pytest.importorskip("matplotlib.pyplot")


@pytest.fixture(autouse=True)
def no_figure_stays():
    yield
    plt.close("all")


def arm(n, lines=60, **more):
    """A resonance and a delay in each entry, with a standard deviation of a thousandth of the highest magnitude."""
    hz = np.geomspace(1.0, 150.0, lines)
    entries = np.arange(n)[:, None] + 2 * np.arange(n)
    s = 2j * np.pi * hz[:, None, None]
    w = 2 * np.pi * (8.0 + 5.0 * entries)
    response = 1e-2 * np.exp(-0.01 * entries * s) / (1 + 0.04 * s / w + (s / w) ** 2)
    covariance = np.tile(np.eye(n * n) * 1e-4 * np.abs(response).max() ** 2, (lines, 1, 1))
    names = {"input_names": [f"joint_{k + 1}" for k in range(n)], "output_names": [f"joint_{k + 1}" for k in range(n)]}
    units = {"input_units": ["N m"] * n, "output_units": ["rad/s"] * n}
    known = {"noise_covariance": covariance, "noise_degrees_of_freedom": 10}
    return frfid.Frf(frequency_hz=hz, response=response, **known, **names, **units, **more)


def ours(panel):
    """Data of the curves of a panel."""
    return [curve.get_xydata() for curve in panel.lines if curve.get_gid() == "frfid"]


def test_the_curve_is_the_response():
    frf = arm(3)
    axes = frf.plot.bode(label="first")
    assert axes.shape == (6, 3)
    (magnitude,), (phase,) = ours(axes[2, 1]), ours(axes[3, 1])
    np.testing.assert_array_equal(magnitude[:, 0], frf.frequency_hz)
    np.testing.assert_allclose(magnitude[:, 1], 20 * np.log10(np.abs(frf.response[:, 1, 1])))
    degrees = np.angle(frf.response[:, 1, 1], deg=True)
    for hz, value in zip(frf.frequency_hz, degrees, strict=True):
        assert np.isclose(phase[phase[:, 0] == hz, 1], value).any()
    frf.plot.bode(ax=axes, label="second")
    assert len(ours(axes[0, 0])) == 2
    texts = [text.get_text() for text in axes[0, 0].figure.legends[0].get_texts()]
    assert texts == ["first", "second", "95 % region of the measurement noise"]
    colours = [curve.get_color() for curve in axes[0, 0].lines]
    assert colours == ["#d55e00", "#0072b2"]


def test_a_wrap_is_a_gap_that_reaches_both_edges():
    hz = np.linspace(1.0, 100.0, 400)
    frf = frfid.Frf(frequency_hz=hz, response=np.exp(-2j * np.pi * hz * 0.05)[:, None, None])
    axes = frf.plot.bode()
    (curve,) = ours(axes[1, 0])
    assert np.isnan(curve[:, 1]).sum() == 5, "5 turns, of which the last ends the band"
    step = np.abs(np.diff(curve[:, 1]))
    assert np.nanmax(step) < 5.0, "no stroke from edge to edge"
    assert axes[1, 0].get_ylim() == (-180, 180)
    ends = curve[:-1][np.isnan(curve[1:, 1]), 1]
    assert (ends <= -180).all(), "each run goes on beyond the edge, where it is clipped"


def test_the_range_is_that_of_the_response_and_shared_by_the_row():
    frf = arm(2)
    tiny = frfid.Frf(
        frequency_hz=frf.frequency_hz,
        response=frf.response,
        noise_covariance=np.array(frf.noise_covariance) * 1e-30,
        noise_degrees_of_freedom=10,
        total_covariance=np.array(frf.noise_covariance) * 1e6,
        total_degrees_of_freedom=4,
    )
    for curve in (frf, tiny):
        axes = curve.plot.bode()
        for row in (0, 2):
            db = 20 * np.log10(np.abs(curve.response[:, row // 2]))
            low, high = axes[row, 0].get_ylim()
            assert low <= db.min() and db.max() <= high and high - low < 1.2 * np.ptp(db) + 1
            assert axes[row, 1].get_ylim() == (low, high)


@pytest.mark.parametrize(("n", "panels"), [(1, (2, 1)), (2, (4, 2)), (3, (6, 3)), (6, (6, 6))])
@pytest.mark.parametrize("style", ["default", "dark_background"])
def test_labels_do_not_meet(n, panels, style):
    with plt.style.context(style):
        axes = arm(n).plot.bode()
        figure = axes[0, 0].figure
        figure.canvas.draw()
        assert axes.shape == panels
        for panel, axis in itertools.product(axes.flat, ("xaxis", "yaxis")):
            visible_low, visible_high = sorted(getattr(panel, axis).get_view_interval())
            boxes = [
                tick.label1.get_window_extent()
                for tick in getattr(panel, axis).get_major_ticks()
                if tick.label1.get_visible() and tick.label1.get_text() and visible_low <= tick.get_loc() <= visible_high
            ]
            assert not any(a.overlaps(b) for a, b in itertools.combinations(boxes, 2))
        assert all(len(ours(panel)) == 1 and len(panel.collections) == 1 for panel in axes.flat)
        labels = [text for panel in axes.flat for text in (panel.title, panel.xaxis.label, panel.yaxis.label) if text.get_text()]
        bounds = figure.bbox
        assert labels and all(bounds.contains(*corner) for text in labels for corner in text.get_window_extent().get_points())
        boxes = [text.get_window_extent() for text in labels]
        assert not any(a.overlaps(b) for a, b in itertools.combinations(boxes, 2))
        assert axes[0, 0].lines[0].get_color() == ("#d55e00" if style == "default" else "#ff8b3d")


def test_frequencies_and_degrees_are_round():
    axes = arm(1).plot.bode()
    axes[0, 0].figure.canvas.draw()
    shown = [text.get_text() for text in axes[1, 0].get_xticklabels()]
    assert shown == ["1", "2", "5", "10", "20", "50", "100", "200"]
    assert all(degrees % 45 == 0 for degrees in axes[1, 0].get_yticks())
    assert axes[0, 0].get_ylabel() == "Magnitude in dB\nre 1 rad/s per N m"
    assert axes[0, 0].get_title() == "joint_1 \u2192 joint_1" and axes[1, 0].get_xlabel() == "Frequency in Hz"


def test_the_region_is_the_widest_that_was_measured_and_none_if_none_was():
    frf = arm(1)
    bare = frfid.Frf(frequency_hz=frf.frequency_hz, response=frf.response)
    axes = bare.plot.bode()
    assert not axes[0, 0].collections and not axes[0, 0].figure.legends
    axes = frf.plot.bode()
    (shade,) = axes[0, 0].collections
    outline = shade.get_paths()[0].vertices
    size, k = np.abs(frf.response[:, 0, 0]), 7
    quantile = 10 * (0.05 ** (-1 / 10) - 1)  # F_95(2, 20) in closed form
    radius = np.sqrt(quantile * frf.noise_variance[k, 0, 0])
    found = sorted(outline[np.isclose(outline[:, 0], frf.frequency_hz[k]), 1])
    np.testing.assert_allclose([found[0], found[-1]], 20 * np.log10([size[k] - radius, size[k] + radius]))


def test_flagged_lines_have_ticks_at_the_upper_edge():
    flagged = [k % 9 == 0 for k in range(60)]
    axes = arm(1, flagged=flagged).plot.bode()
    ticks = axes[0, 0].lines[1]
    assert ticks.get_marker() == "|" and len(ticks.get_xdata()) == sum(flagged) and set(ticks.get_ydata()) == {0.97}


def test_large_matrices_are_magnitudes_drawn_soon():
    frf = arm(6, lines=2000)
    start = time.process_time()
    axes = frf.plot.bode()
    assert time.process_time() - start < 10  # 0.3 s alone; far more were the panels to be laid out anew for each
    assert axes.shape == (6, 6)
    assert axes[0, 2].get_title() == "from joint_3" and axes[4, 0].get_ylabel().startswith("to joint_5")
    assert frf.plot.bode(phase=True).shape == (12, 6)


def test_own_axes_are_drawn_into_or_refused():
    figure, own = plt.subplots(2, 1)
    axes = arm(1).plot.bode(ax=own, color="k", ls=":")
    assert axes[0, 0] is own[0] and own[0].lines[0].get_color() == "k" and not figure.legends
    assert len(arm(1).plot.bode(ax=plt.subplots()[1])) == 1, "one panel: magnitudes only"
    with pytest.raises(ValueError, match=r"found 3 axes, needed: 8 \(with phase\) or 4 \(magnitudes only\)"):
        arm(2).plot.bode(ax=plt.subplots(3)[1])


@pytest.mark.parametrize(
    ("hz", "response"), [([], []), ([0.0, 1.0], [1.0, 1.0]), ([1.0, 2.0], [np.nan] * 2), ([1.0, 2.0], [0.0] * 2), ([3.0], [1j])]
)
def test_nothing_to_draw_is_no_error(hz, response):
    frf = frfid.Frf(frequency_hz=hz, response=np.reshape(np.array(response, dtype=complex), (-1, 1, 1)))
    frf.plot.bode()[0, 0].figure.canvas.draw()
