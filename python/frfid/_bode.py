"""Bode diagram of an FRF in matplotlib, with the look of the figures and pages that frfid makes itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.cbook import normalize_kwargs
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator, NullLocator

from ._ticks import DegreeLocator, FrequencyLocator, plain, rounded

if TYPE_CHECKING:
    from ._core import Frf

# The palette of crates/report, on paper and on a dark ground, and the dashes by which curves differ without colours.
COLORS = ("#d55e00", "#0072b2", "#009e73", "#aa3377", "#8c6d00")
ON_DARK = ("#ff8b3d", "#5ab4f0", "#2fcf9f", "#e07fb8", "#d8b13c")
DASHES: tuple[Any, ...] = ("-", (0, (4, 1.7)), (0, (4, 1.2, 1.2, 1.2)), (0, (1.2, 1.2)))
DENSE = 150  # more frequencies than this make a line without dots
DEEPEST_DB = 140.0  # what lies further below the highest magnitude is rounding, not response
MOST_WITH_PHASE = 3  # inputs or outputs beyond which magnitudes alone are shown
OURS, TICKS = "frfid", "frfid flagged"  # mark what an earlier call drew
UNNAMED = "G"


def bode(frf: Frf, ax: Any, phase: bool | None, line: dict[str, Any]) -> Any:
    axes, with_phase, is_own = _axes(frf, ax, phase)
    step = 2 if with_phase else 1
    for panel in axes.flat:
        panel.set_autoscale_on(False)  # slow where many panels share an axis, and the ranges are ours
    curve = _Curve.of(frf, axes[0, 0], line)
    for output in range(frf.n_outputs):
        magnitudes, phases = axes[step * output], axes[step * output + 1] if with_phase else ()
        curve.draw_magnitudes(magnitudes, output)
        curve.draw_phases(phases, output)
    _dress(frf, axes, step)
    _legend(axes, is_own)
    return axes


def _axes(frf: Frf, ax: Any, phase: bool | None) -> tuple[Any, bool, bool]:
    """The panels, whether every other row of them holds phases, and whether the figure is ours."""
    outputs, inputs = frf.n_outputs, frf.n_inputs
    if ax is not None:
        given = np.asarray(ax, dtype=object)
        for rows, with_phase in ((2 * outputs, True), (outputs, False)):
            if given.size == rows * inputs and phase in (None, with_phase):
                axes = given.reshape(rows, inputs)
                return axes, with_phase, axes[0, 0].figure.get_gid() == OURS
        needed = " or ".join(
            f"{rows * inputs} ({kind})"
            for rows, kind, with_phase in ((2 * outputs, "with phase", True), (outputs, "magnitudes only", False))
            if phase in (None, with_phase)
        )
        raise ValueError(f"ax: found {given.size} axes, needed: {needed}; without ax, a figure is made")
    with_phase = max(outputs, inputs) <= MOST_WITH_PHASE if phase is None else phase
    heights = ([3, 2] if with_phase else [1]) * outputs
    size = (max(6.4, min(3.4 * inputs + 1.0, 13.0)), 1.0 + outputs * (3.6 if outputs == 1 else 3.0 if with_phase else 1.5))
    figure, axes = plt.subplots(
        len(heights), inputs, sharex=True, sharey="row", squeeze=False, figsize=size, layout="constrained", height_ratios=heights
    )
    figure.set_gid(OURS)
    return axes, with_phase, True


@dataclass
class _Curve:
    """One FRF with the ink it is drawn in."""

    hz: Any
    response: Any
    radius: Any  # of the 95 % region, None where no variance was measured
    region: str
    flagged: Any
    shade: float  # opacity of the region
    style: dict[str, Any]

    @classmethod
    def of(cls, frf: Frf, panel: Any, line: dict[str, Any]) -> _Curve:
        hz, (radius, region) = frf.frequency_hz, _radius(frf)
        nth = sum(curve.get_gid() == OURS for curve in panel.lines)
        dark = np.dot(to_rgb(panel.get_facecolor()), (0.299, 0.587, 0.114)) < 0.5
        style = {"color": (ON_DARK if dark else COLORS)[nth % 5], "linewidth": 1.6, "linestyle": DASHES[nth % 4], "label": UNNAMED}
        if len(hz) <= DENSE:
            style |= {"linewidth": 1.2, "marker": "o", "markersize": 3.0}
        elif max(frf.n_outputs, frf.n_inputs) > MOST_WITH_PHASE:
            style["linewidth"] = 1.0
        known = hz > 0  # a logarithmic axis has no room for 0 Hz
        flagged = np.asarray(frf.flagged or np.zeros(len(hz)), dtype=bool)[known]
        style |= normalize_kwargs(line, Line2D) | {"gid": OURS}
        return cls(hz[known], frf.response[known], None if radius is None else radius[known], region, flagged, 0.35 if dark else 0.22, style)

    def draw_magnitudes(self, panels: Any, output: int) -> None:
        """Magnitudes of one output; the range of the row is that of the responses, not of their regions."""
        values = _db(np.abs(self.response[:, output]))
        low, high = _row_range(panels, values, DEEPEST_DB)
        room = max(0.05 * (high - low), 0.5)
        _limit_y(panels, low - room, high + room)
        for column, panel in enumerate(panels):
            panel.plot(self.hz, values[:, column], **self.style)
            if self.radius is not None:
                size, radius = np.abs(self.response[:, output, column]), self.radius[:, output, column]
                lower = np.fmax(_db(np.fmax(size - radius, 0.0)), low - 2 * (high - low) - 10.0)
                self._shade(panel, self.hz, np.where(np.isfinite(values[:, column]), lower, np.nan), _db(size + radius))
            self._flag(panel)

    def draw_phases(self, panels: Any, output: int) -> None:
        """Phases of one output, with gaps where they wrap."""
        if not len(panels):
            return
        values = np.angle(self.response[:, output], deg=True)
        low, high = _row_range(panels, values)
        _limit_y(panels, max(np.floor((low - 3) / 45) * 45, -180), min(np.ceil((high + 3) / 45) * 45, 180))
        for column, panel in enumerate(panels):
            lines, degrees = _unwrapped(values[:, column])
            style = {"markevery": _first_of_each(lines)} | self.style
            panel.plot(self.hz[lines], degrees, **style)
            if self.radius is not None:
                size, radius = np.abs(self.response[:, output, column]), self.radius[:, output, column]
                with np.errstate(divide="ignore", invalid="ignore"):
                    half = np.where(radius < size, np.degrees(np.arcsin(np.fmin(radius / size, 1.0))), 180.0)[lines]
                self._shade(panel, self.hz[lines], degrees - half, degrees + half)
            self._flag(panel)

    def _shade(self, panel: Any, hz: Any, low: Any, high: Any) -> None:
        shade = {"color": self.style["color"], "alpha": self.shade, "linewidth": 0, "label": self.region, "zorder": 1}
        panel.fill_between(hz, low, high, **shade)

    def _flag(self, panel: Any) -> None:
        """Ticks below the upper edge, where they hide no curve."""
        if self.flagged.any():
            hz, where = self.hz[self.flagged], panel.get_xaxis_transform()
            color, height = self.style["color"], np.full(len(hz), 0.97)
            panel.plot(hz, height, "|", color=color, markersize=6, label="flagged line", gid=TICKS, transform=where)


def _radius(frf: Frf) -> tuple[Any, str]:
    """Radius of the 95 % region |dG| of every entry, of the largest variance that was measured, and its name."""
    kinds = (
        (frf.total_variance, frf.total_degrees_of_freedom, "95 % region of noise and nonlinear distortion"),
        (frf.noise_variance, frf.noise_degrees_of_freedom, "95 % region of the measurement noise"),
    )
    for variance, freedom, name in kinds:
        if variance is not None:
            if not freedom:
                return None, ""
            quantile = freedom * np.expm1(-np.log(0.05) / freedom)  # of F(2, 2 dof)
            return np.sqrt(quantile * np.fmax(variance, 0.0)), name
    return None, ""


def _row_range(panels: Any, values: Any, deepest: float = np.inf) -> tuple[float, float]:
    """The range of values, and of what an earlier call drew into these panels; without what lies `deepest` below the highest."""
    earlier = [curve.get_ydata() for panel in panels for curve in panel.lines if curve.get_gid() == OURS]
    found = np.concatenate([np.ravel(values), *earlier])
    found = found[np.isfinite(found)]
    if not len(found):
        return 0.0, 0.0
    return float(found[found >= found.max() - deepest].min()), float(found.max())


def _limit_y(panels: Any, low: float, high: float) -> None:
    """The same range for all panels of a row; those that share an axis get it once."""
    for k, panel in enumerate(panels):
        if not k or not panel.get_shared_y_axes().joined(panel, panels[0]):
            panel.set_ylim(low, high)


def _unwrapped(degrees: Any) -> tuple[Any, Any]:
    """Numbers of lines and degrees with a gap at every wrap; each run goes on by one point beyond the edge."""
    step = np.diff(degrees)
    turns = np.round(np.where(np.isfinite(step), step, 0.0) / 360.0)
    last = np.flatnonzero(turns)
    over = 360.0 * turns[last]
    where = np.repeat(last + 1, 3)
    lines = np.insert(np.arange(len(degrees)), where, np.stack([last + 1, last, last], axis=1).ravel())
    gaps = np.stack([degrees[last + 1] - over, np.full(len(last), np.nan), degrees[last] + over], axis=1)
    return lines, np.insert(degrees, where, gaps.ravel())


def _first_of_each(lines: Any) -> list[int]:
    """Where the points stand that are no continuation beyond an edge."""
    added = np.zeros(len(lines), dtype=bool)
    gaps = np.flatnonzero(np.diff(lines) < 0)  # the run beyond the edge jumps back by a line
    for shift in (0, 1, 2):
        added[gaps + shift] = True
    return [int(k) for k in np.flatnonzero(~added)]


def _dress(frf: Frf, axes: Any, step: int) -> None:
    """Ticks, grid, names and units."""
    is_large = max(frf.n_outputs, frf.n_inputs) > MOST_WITH_PHASE
    size = 8 if is_large else 9
    band = _band(axes)
    for (row, column), panel in np.ndenumerate(axes):
        is_phase = row % step == 1
        if (row, column) == (0, 0) or not panel.get_shared_x_axes().joined(panel, axes[0, 0]):
            panel.set_xscale("log")
            panel.set_xlim(band)
            panel.xaxis.set_major_locator(FrequencyLocator())
            panel.xaxis.set_major_formatter(plain)
            panel.xaxis.set_minor_locator(NullLocator())
        if column == 0 or not panel.get_shared_y_axes().joined(panel, axes[row, 0]):
            panel.yaxis.set_major_locator(DegreeLocator() if is_phase else MaxNLocator("auto", steps=[1, 2, 5, 10]))
        panel.grid(True, alpha=0.35, linewidth=0.6)
        panel.tick_params(labelsize=size)
        panel.set_axisbelow(True)
        if row == len(axes) - 1:
            panel.set_xlabel("Frequency in Hz", fontsize=size)
        if not is_phase and (not is_large or row == 0):
            panel.set_title(_title(frf, row // step, column, is_large), fontsize=size + 1)
    for row, panel in enumerate(axes[:, 0]):
        panel.set_ylabel(_y_label(frf, row // step, row % step == 1, is_large), fontsize=size)


def _title(frf: Frf, output: int, column: int, is_large: bool) -> str:
    """The entry, or in a large matrix the input above its column; with the unit where the inputs of a row differ in it."""
    name = frf.input_names[column]
    title = f"from {name}" if is_large else f"{name} \u2192 {frf.output_names[output]}"
    unit = _unit(frf.output_units[output], frf.input_units[column])
    return title if is_large or not unit or _share_unit(frf) else f"{title}, dB re 1 {unit}"


def _y_label(frf: Frf, output: int, is_phase: bool, is_large: bool) -> str:
    """What is drawn and its unit, in a large matrix below the output of the row."""
    unit = _unit(frf.output_units[output], frf.input_units[0]) if _share_unit(frf) else ""
    reference = f"dB re 1 {unit}" if unit else "dB"
    if is_large:
        return f"to {frf.output_names[output]}\n" + ("deg" if is_phase else reference)
    return "Phase in deg" if is_phase else "Magnitude in dB" + (f"\nre 1 {unit}" if unit else "")


def _share_unit(frf: Frf) -> bool:
    """Whether all inputs, hence the entries of each row, have one unit."""
    return len(set(frf.input_units)) == 1


def _unit(output: str, given: str) -> str:
    return f"{output} per {given}" if output and given else ""


def _band(axes: Any) -> tuple[float, float]:
    """The frequencies of every curve, from and to round numbers."""
    drawn = [curve.get_xdata() for curve in axes[0, 0].lines if curve.get_gid() == OURS]
    hz = np.concatenate(drawn) if drawn else np.empty(0)
    return rounded(hz.min(), hz.max()) if len(hz) else (1.0, 10.0)


def _legend(axes: Any, is_own: bool) -> None:
    """Every curve, and what is shaded and ticked once; none where that is a plain curve without a name."""
    panel = axes[0, 0]
    names: dict[tuple[str, int | None], Any] = {}
    for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
        is_curve = isinstance(handle, Line2D) and handle.get_gid() != TICKS
        names.setdefault((label, id(handle) if is_curve else None), handle)
    if [label for label, _ in names] == [UNNAMED]:
        return
    names = dict(sorted(names.items(), key=lambda entry: isinstance(entry[1], PolyCollection)))  # regions last
    found = {"handles": list(names.values()), "labels": [label for label, _ in names], "fontsize": 9}
    if not is_own:
        panel.legend(**found)
        return
    figure = panel.figure
    for earlier in figure.legends:
        if earlier.get_gid() == OURS:
            earlier.remove()
    letters = sum(len(label) + 8 for label, _ in names)
    columns = len(names) if letters < 13 * figure.get_figwidth() else 2
    figure.legend(**found, loc="outside upper center", ncols=columns, frameon=False).set_gid(OURS)


def _db(amplitude: Any) -> Any:
    with np.errstate(divide="ignore"):  # an exact zero is a gap in the curve
        return 20 * np.log10(amplitude)
