"""Ticks of Bode diagrams: frequencies at 1, 2, 5, 10 and phases at 45 or 90 degrees, as many as have room."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.ticker import FuncFormatter, Locator, MaxNLocator, MultipleLocator

# Digits of a decade that are labelled, the densest first, and the least ratio of neighbours among them.
DIGITS = (((1, 2, 3, 4, 5, 6, 7, 8, 9), 10 / 9), ((1, 2, 5), 2.0), ((1,), 10.0))
LETTER, GAP = 0.65, 0.9  # width of a digit and least distance of labels, of the size of the letters

plain = FuncFormatter(lambda value, _: f"{value:.6g}")


class FrequencyLocator(Locator):
    """Ticks of a logarithmic axis whose labels never meet, at whatever size and zoom."""

    def __call__(self) -> Any:
        axis: Any = self.axis
        return self.tick_values(*axis.get_view_interval())

    def tick_values(self, vmin: float, vmax: float) -> Any:
        low, high = sorted((vmin, vmax))
        if not 0 < low < high:
            return []
        length, letter = _sizes(self.axis, 0)
        per_decade = length / np.log10(high / low)
        widest = max(len(plain(10.0 ** np.floor(np.log10(end)))) for end in (low, high))
        room = letter * (LETTER * widest + GAP)
        for digits, ratio in DIGITS:
            if per_decade * np.log10(ratio) > room:
                return self._sparse_or_linear(low, high, digits, 1, room, length)
        return self._sparse_or_linear(low, high, (1,), int(np.ceil(room / per_decade)), room, length)

    def _sparse_or_linear(self, low: float, high: float, digits: Any, every: int, room: float, length: float) -> Any:
        """Those digits of every n-th decade; evenly spaced where that leaves less than three on a short axis."""
        powers = np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1)
        values = np.multiply.outer(10.0 ** powers[powers % every == 0], digits).ravel()
        ticks = values[(values >= low * (1 - 1e-9)) & (values <= high * (1 + 1e-9))]
        if len(ticks) >= 3 or high / low >= 10:
            return ticks
        spacing = high * np.log(high / low) / (high - low)  # of the closest labels over the mean one
        bins = max(1, int(length / (room * max(spacing, 1.0) * 1.3)))
        found: Any = MaxNLocator(bins, steps=[1, 2, 5, 10]).tick_values(low, high)
        return found[(found >= low) & (found <= high)]


class DegreeLocator(Locator):
    """Multiples of 45, 90 or 180 degrees, the first of them that has room."""

    def __call__(self) -> Any:
        axis: Any = self.axis
        return self.tick_values(*axis.get_view_interval())

    def tick_values(self, vmin: float, vmax: float) -> Any:
        low, high = sorted((vmin, vmax))
        length, letter = _sizes(self.axis, 1)
        if high - low < 60:
            return MaxNLocator("auto", steps=[1, 2, 5, 10]).tick_values(low, high)
        step = next((step for step in (45, 90, 180) if (high - low) / step * 1.7 * letter <= length), 360)
        return MultipleLocator(step).tick_values(low, high)


def rounded(low: float, high: float) -> tuple[float, float]:
    """Both ends rounded outward to as few digits as widen the range by at most a tenth of its decades."""
    if high / low < 1.02:
        low, high = low / 1.1, high * 1.1
    for digits in range(4):
        units = [10.0 ** (np.floor(np.log10(end)) - digits) for end in (low, high)]
        ends = (np.floor(low / units[0] + 1e-9) * units[0], np.ceil(high / units[1] - 1e-9) * units[1])
        if np.log(ends[1] / ends[0]) <= 1.1 * np.log(high / low):
            return float(ends[0]), float(ends[1])
    return low, high


def _sizes(axis: Any, dimension: int) -> tuple[float, float]:
    """Length of an axis and size of its letters, in points."""
    panel = axis.axes
    length = panel.get_position().size[dimension] * panel.figure.get_size_inches()[dimension] * 72
    ticks = axis.majorTicks  # get_major_ticks() would ask for the ticks that are being found
    return length, float(ticks[0].label1.get_size()) if ticks else 10.0
