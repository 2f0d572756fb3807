"""Reference of a run: reading it from CSV, interpolating it, braking.

The CSV has one line of names, `k,time_s,plan_id,JOINT position [rad],JOINT velocity [rad/s],JOINT acceleration [rad/s^2],...`.
Every unit is one of angles and times, as deg, deg/s, turn, rpm; `JOINT motor position [..]` is in front of the gear.
"""

import re
from dataclasses import dataclass

import numpy as np
from scipy import signal

COLUMN = re.compile(r"(?P<joint>.+?)(?P<motor> motor)? (?P<quantity>position|velocity|acceleration) \[(?P<unit>[^\]]+)\]")
QUANTITIES = ("position", "velocity", "acceleration")
ANGLES = {"rad": 1.0, "deg": np.pi / 180, "°": np.pi / 180, "turn": 2 * np.pi, "rev": 2 * np.pi}
TIMES = {"s": 1.0, "s^2": 1.0, "s²": 1.0, "min": 60.0}


@dataclass
class Motion:
    """Of the motors on the joint side in SI units: positions, velocities, accelerations (joint, sample) at times from 0 on."""

    time_s: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray

    def arrays(self):
        return np.stack([self.position, self.velocity, self.acceleration])


def si_factor(unit):
    """What a unit of angles and times is in rad and s."""
    angle, *times = unit.replace("rpm", "turn/min").split("/")
    if angle not in ANGLES or not set(times) <= TIMES.keys():
        raise ValueError(f"unit [{unit}] is unknown; known are {', '.join(ANGLES)}, each over {', '.join(TIMES)}, and rpm")
    return ANGLES[angle] / np.prod([TIMES[time] for time in times])


def read(path, names, gear_ratio, is_motor_side=False):
    """The motion of these joints in a CSV; with is_motor_side every column is in front of the gear."""
    with open(path, encoding="utf-8") as file:
        header = file.readline().strip().split(",")
    found = {}
    for place, name in enumerate(header):
        if match := COLUMN.fullmatch(name):
            ratio = gear_ratio[names.index(match["joint"])] if match["joint"] in names else 1.0
            side = ratio if match["motor"] or is_motor_side else 1.0
            found[match["joint"], match["quantity"]] = place, si_factor(match["unit"]) / side
    wanted = [(joint, quantity) for quantity in QUANTITIES for joint in names]
    if missing := [f"{joint} {quantity}" for joint, quantity in wanted if (joint, quantity) not in found]:
        raise ValueError(f"{path} has no column of {', '.join(missing)}")
    places, factors = zip(*(found[column] for column in wanted))
    table = np.loadtxt(path, delimiter=",", skiprows=1, usecols=(header.index("time_s"), *places), encoding="utf-8").T
    return Motion(table[0] - table[0, 0], *(table[1:] * np.array(factors)[:, None]).reshape(3, len(names), -1))


def sample(motion, time_s):
    """The quintic spline through every position, velocity and acceleration, at other times; at rest outside."""
    k = np.clip(np.searchsorted(motion.time_s, time_s, side="right") - 1, 0, motion.time_s.size - 2)
    h = motion.time_s[k + 1] - motion.time_s[k]
    s = np.clip((time_s - motion.time_s[k]) / h, 0.0, 1.0)
    (p0, v0, a0), (p1, v1, a1) = motion.arrays()[:, :, k], motion.arrays()[:, :, k + 1]
    v0, v1, a0, a1 = v0 * h, v1 * h, a0 * h**2, a1 * h**2
    rest, rest_v, rest_a = p1 - p0 - v0 - a0 / 2, v1 - v0 - a0, a1 - a0
    c3, c4, c5 = 10 * rest - 4 * rest_v + rest_a / 2, -15 * rest + 7 * rest_v - rest_a, 6 * rest - 3 * rest_v + rest_a / 2
    position = p0 + s * (v0 + s * (a0 / 2 + s * (c3 + s * (c4 + s * c5))))
    velocity = (v0 + s * (a0 + s * (3 * c3 + s * (4 * c4 + s * 5 * c5)))) / h
    acceleration = (a0 + s * (6 * c3 + s * (12 * c4 + s * 20 * c5))) / h**2
    return Motion(time_s, position, velocity, acceleration)


def low_passed(motion, corner_hz, rate_hz):
    """Behind a Butterworth low-pass of second order, from rest."""
    b, a = signal.butter(2, corner_hz, fs=rate_hz)
    arrays = motion.arrays()
    memory = signal.lfilter_zi(b, a) * arrays[..., :1]
    return Motion(motion.time_s, *signal.lfilter(b, a, arrays, zi=memory)[0])


def stopped(motion, at_s, braking_s=0.2):
    """The motion up to a time, then brought to rest evenly; it ends there."""
    k = max(np.searchsorted(motion.time_s, at_s), 1)
    step = motion.time_s[1] - motion.time_s[0]
    n = round(braking_s / step)
    v = motion.velocity[:, k - 1 : k]
    velocity = v * np.linspace(1.0, 0.0, n + 1)[1:]
    position = motion.position[:, k - 1 : k] + step * np.cumsum(velocity, axis=1)
    acceleration = np.repeat(-v / braking_s, n, axis=1)
    time = motion.time_s[k - 1] + step * np.arange(1, n + 1)
    braking = Motion(time, position, velocity, acceleration)
    joined = np.concatenate([motion.arrays()[..., :k], braking.arrays()], axis=-1)
    return Motion(np.concatenate([motion.time_s[:k], time]), *joined)
