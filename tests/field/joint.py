"""A flexible joint whose FRF is known, its recordings at any instants, and what the command line makes of them."""

import json
import shutil
import subprocess
from dataclasses import dataclass

import numpy as np
import pytest

FRFID = shutil.which("frfid")
SAMPLE_TIME_S = 2e-3
PERIOD = 1200  # samples: 2.4 s, lines 0.4167 Hz apart
PERIOD_S = PERIOD * SAMPLE_TIME_S
ODD = np.arange(5, 121, 2)  # 2.1 to 49.6 Hz
MAP = ["--u", "torque=N m", "--y", "speed=rad/s", "--time", "t=s"]
POSITION = ["--u", "torque=N m", "--y", "angle=rad", "--time", "t=s"]


def joint(hz):
    """Motor torque to motor velocity of two masses: notch 5.6 Hz, peak 11.3 Hz, and some viscous friction."""
    s = 2j * np.pi * np.asarray(hz, float)
    motor, link, stiffness, damping, viscous = 0.02, 0.06, 75.0, 0.09, 0.05
    link_side = link * s**2 + damping * s + stiffness
    return link_side / ((motor * s + viscous) * link_side + link * s * (damping * s + stiffness))


def position(hz):
    """Motor torque to motor position."""
    return joint(hz) / (2j * np.pi * np.asarray(hz, float))


def second_joint(hz):
    """Another machine of the same kind."""
    return 1.7 * joint(np.asarray(hz) * 0.8)


@dataclass
class Multisine:
    """Lines of a period with complex amplitudes: the value at t is the sum of Re(c exp(2 pi i h t / period))."""

    lines: np.ndarray
    amplitude: np.ndarray
    period_s: float = PERIOD_S

    @classmethod
    def draw(cls, seed, lines=ODD, size=1.0, period_s=PERIOD_S):
        phase = np.random.default_rng([seed, 77]).uniform(0, 2 * np.pi, len(lines))
        return cls(np.asarray(lines), size * np.exp(1j * phase), period_s)

    @property
    def hz(self):
        return self.lines / self.period_s

    def through(self, frf):
        return Multisine(self.lines, self.amplitude * frf(self.hz), self.period_s)

    def at(self, t):
        value = np.zeros(len(t))
        for line, amplitude in zip(self.lines, self.amplitude):
            turn = 2 * np.pi * line * t / self.period_s
            value += amplitude.real * np.cos(turn) - amplitude.imag * np.sin(turn)
        return value


def noise(seed, n, size):
    return size * np.random.default_rng([seed, 5]).standard_normal(n)


def instants(periods, sample_time_s=SAMPLE_TIME_S):
    return sample_time_s * np.arange(round(periods * PERIOD_S / sample_time_s))


def steady(seed, periods, level=1e-3, frf=joint, lines=ODD, t=None, size=1.0):
    """Time, torque and output in the steady state, with white noise on the output (share of its rms)."""
    t = instants(periods) if t is None else t
    torque = Multisine.draw(seed, lines, size)
    output = torque.through(frf).at(t)
    return t, torque.at(t), output + noise(seed, len(t), level * output.std())


def write_csv(path, digits=12, **columns):
    names = list(columns)
    rows = np.column_stack([columns[name] for name in names])
    text = [",".join(names)]
    text += [",".join("" if np.isnan(value) else f"{value:.{digits}g}" for value in row) for row in rows]
    path.write_text("\n".join(text) + "\n")


@dataclass
class Outcome:
    """What the command said, and the result it wrote."""

    code: int
    text: str
    result: dict | None

    def said(self, *words):
        return all(word in self.text for word in words)

    def check(self, name):
        return next(check for check in self.result["checks"] if check["name"] == name)

    @property
    def failed(self):
        return [check["name"] for check in self.result["checks"] if not check["passed"]]

    @property
    def hz(self):
        return np.array(self.result["frequency_hz"]["data"], float)

    @property
    def frf(self):
        response = self.result["response"]
        number = lambda part: np.array([np.nan if value is None else value for value in response[part]], float)
        return (number("re") + 1j * number("im")).reshape(response["shape"])

    def variance(self, kind="noise"):
        if kind not in self.result or self.result[kind] is None:
            return None
        covariance = self.result[kind]["covariance"]
        values = np.array([np.nan if value is None else value for value in covariance["re"]], float)
        return np.einsum("fii->fi", values.reshape(covariance["shape"]))

    def error(self, frf=joint):
        return np.abs(self.frf[:, 0, 0] / frf(self.hz) - 1)

    def inside(self, frf=joint, kind="noise"):
        """Share of the lines whose 95 % region holds the truth."""
        dof = self.result[kind]["degrees_of_freedom"]
        limit = self.variance(kind)[:, 0] * dof * (0.05 ** (-1 / dof) - 1)
        return np.mean(np.abs(self.frf[:, 0, 0] - frf(self.hz)) ** 2 <= limit)


def estimate(folder, files, *options):
    """`frfid estimate FILES OPTIONS` in a folder."""
    if FRFID is None:
        pytest.skip("the command frfid is not installed: pip install .")
    result = folder / "result.json"
    command = [FRFID, "estimate", *map(str, files), "-o", str(result), "--force", *options]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300)
    written = json.loads(result.read_text()) if done.returncode in (0, 3) else None
    return Outcome(done.returncode, done.stdout + done.stderr, written)
