"""A recorder that is no friend: a clock and a rate of its own, units of the motor side, signs, lost and doubled rows."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline


@dataclass
class Recorder:
    """What it does to the signals of a controller's samples."""

    rate_hz: float
    clock_ppm: float
    offset_s: float
    reads: str  # "between": signals at its own instants; "cycle": the last sample with its time; "late": with the recorder's
    jitter_us: float
    drop: float
    double: float
    torque_quantum_nm: float
    torque_noise_nm: float
    factors: dict  # of each signal, per joint: units, side of the gear, sign
    random: np.random.Generator

    def record(self, time_s, signals):
        """Stamps in s and signals (joint, row) of what the controller had, (joint, sample) at its times."""
        ticks, stamps = self._ticks(time_s)
        if self.reads == "between":
            read = {name: CubicSpline(time_s, values, axis=1)(ticks) for name, values in signals.items()}
        else:
            last = np.searchsorted(time_s, ticks, side="right") - 1
            read = {name: values[:, last] for name, values in signals.items()}
            stamps = self._stamp(time_s, time_s[last]) if self.reads == "cycle" else stamps
        stamps = stamps + 1e-6 * self.jitter_us * self.random.standard_normal(stamps.size)
        read["torque"] = self._measured(read["torque"])
        return stamps, {name: values * self.factors[name][:, None] for name, values in read.items()}

    def rows(self, n_rows):
        """Places of the rows that are written: some not at all, some twice."""
        kept = np.flatnonzero(self.random.random(n_rows) >= self.drop)
        return np.repeat(kept, np.where(self.random.random(kept.size) < self.double, 2, 1))

    def _ticks(self, time_s):
        """When it reads, on the controller's clock and on its own."""
        between = 1 / (self.rate_hz * (1 + 1e-6 * self.clock_ppm))
        first = time_s[0] + self.random.random() * between
        ticks = first + between * np.arange(int((time_s[-1] - first) / between) + 1)
        return ticks, self._stamp(time_s, ticks)

    def _stamp(self, time_s, instant):
        return self.offset_s + (1 + 1e-6 * self.clock_ppm) * (instant - time_s[0])

    def _measured(self, torque):
        torque = torque + self.torque_noise_nm * self.random.standard_normal(torque.shape)
        quantum = self.torque_quantum_nm
        return quantum * np.round(torque / quantum) if quantum else torque


def factors(names, gear_ratio, motor_side=False, degrees=False, flips=()):
    """Factors of each signal from SI units on the joint side to the recorder's.

    A flip is JOINT, every signal of an axis that counts the other way round, or JOINT:SIGNAL, a sensor that does.
    """
    side = np.array(gear_ratio, float) if motor_side else np.ones(len(names))
    motion = side * (180 / np.pi if degrees else 1.0)
    moved = ("reference position", "reference velocity", "reference acceleration", "position", "velocity")
    found = {"torque": 1 / side, **{name: motion.copy() for name in moved}}
    for flip in flips:
        joint, _, signal = flip.partition(":")
        if joint not in names or (signal and signal not in found):
            raise ValueError(f"cannot flip {flip}: joints are {', '.join(names)}, signals {', '.join(found)}")
        for name in [signal] if signal else found:
            found[name][names.index(joint)] *= -1.0
    return found
