"""Coverage of local models over random machines:  python tests/peers/local_coverage.py [MACHINES] [JOBS]

Machines of one to three axes with two to five modes (damping 10 to 0.1 %) and a rigid body, excited from rest by noise, a binary sequence, a chirp or
one period of a multisine, 10 to 40 s at 1 kHz, in open loop or under velocity feedback with a disturbance at the input, with noise on the output. Printed is
the share of entries whose stated 95 % region holds the truth, kind by kind.
"""

import sys
from collections import defaultdict
from concurrent.futures import ProcessPoolExecutor

import numpy as np
from scipy.linalg import expm

import frfid

T = 1e-3


class Machine:
    """A rigid body and modes, seen by the velocities of the axes that are pushed: exact between samples of a held input."""

    def __init__(self, rng, n_axes):
        n_modes = int(rng.integers(2, 6))
        omega = np.concatenate([[0.0], 2 * np.pi * np.exp(rng.uniform(np.log(4), np.log(40), n_modes))])
        damping = np.concatenate([[0.0], 10 ** rng.uniform(-3, -1, n_modes)])
        self.dampings, shapes = damping[1:], rng.standard_normal((n_modes + 1, n_axes))
        blocks = [self.mode(*mode) for mode in zip(omega, damping)]
        n = 2 * len(blocks)
        self.a, self.b, self.c = np.zeros((n, n)), np.zeros((n, n_axes)), np.zeros((n_axes, n))
        for k, (a, b) in enumerate(blocks):
            part = slice(2 * k, 2 * k + 2)
            self.a[part, part], self.b[part], self.c[:, 2 * k + 1] = a, np.outer(b, shapes[k]), shapes[k]

    @staticmethod
    def mode(omega, damping):
        """Position and velocity of one mode over a sample."""
        whole = np.zeros((3, 3))
        whole[0, 1], whole[1, 0], whole[1, 1], whole[1, 2] = 1.0, -(omega**2), -2 * damping * omega - 0.2, 1.0
        step = expm(whole * T)
        return step[:2, :2], step[:2, 2]

    def frf(self, hz):
        eye = np.eye(len(self.a))
        return np.array([self.c @ np.linalg.solve(np.exp(2j * np.pi * f * T) * eye - self.a, self.b) for f in hz])

    def run(self, force, gain=0.0, disturbance=None):
        """Inputs and outputs of a run from rest; under feedback the force is what is asked for beyond it."""
        x, u, y = np.zeros(len(self.a)), np.empty_like(force), np.empty_like(force)
        for k in range(force.shape[1]):
            y[:, k] = self.c @ x
            u[:, k] = force[:, k] - gain * y[:, k]
            x = self.a @ x + self.b @ (u[:, k] + (0.0 if disturbance is None else disturbance[:, k]))
        return u, y


def excitation(rng, kind, n_axes, n_samples):
    time_s = np.arange(n_samples) * T
    if kind == "noise":
        return rng.standard_normal((n_axes, n_samples))
    if kind == "binary":
        return np.repeat(rng.choice([-1.0, 1.0], (n_axes, -(-n_samples // 8))), 8, axis=1)[:, :n_samples]
    if kind == "chirp":
        rate = np.log(60.0) / time_s[-1]
        sweep = np.sin(2 * np.pi * (np.exp(rate * time_s) - 1) / rate + rng.uniform(0, 2 * np.pi))
        return np.array([sweep])
    lines = np.zeros((n_axes, n_samples // 2 + 1), complex)
    band = slice(int(n_samples * T), int(60 * n_samples * T))
    lines[:, band] = np.exp(2j * np.pi * rng.random(lines[:, band].shape))
    return np.fft.irfft(lines, n_samples) * np.sqrt(n_samples)


def case(seed):
    """Kinds of one machine and, entry by entry, whether its region holds the truth."""
    rng = np.random.default_rng(seed)
    n_axes = int(rng.integers(1, 4))
    kinds = ["noise", "binary", "chirp", "period"]
    kind = str(rng.choice(kinds if n_axes == 1 else ["noise", "binary", "period"]))
    n_samples = int(rng.integers(10, 40)) * 1000
    machine, is_closed = Machine(rng, n_axes), bool(rng.integers(0, 2))
    force = excitation(rng, kind, n_axes, n_samples)
    level = 10 ** rng.uniform(-3, -1.5)
    disturbance = 2 * level * force.std() * rng.standard_normal(force.shape) if is_closed else None
    u, y = machine.run(force, gain=0.5 if is_closed else 0.0, disturbance=disturbance)
    y = y + level * y.std(axis=1, keepdims=True) * rng.standard_normal(y.shape)
    hz = np.geomspace(3.0, 45.0, 60)
    frf = frfid.estimate_local(u, y, r=force if is_closed else None, sample_time_s=T, frequencies_hz=hz)
    freedom = frf.total_degrees_of_freedom
    truth = machine.frf(hz)
    factor = freedom * (0.05 ** (-1 / freedom) - 1)
    holds = np.abs(frf.response - truth) ** 2 <= factor * frf.total_variance
    sharp = "sharp" if machine.dampings.min() < 0.005 else "damped"
    return [kind, f"{n_axes} axes", "closed" if is_closed else "open", sharp, "all"], holds.mean()


def main(n_machines=200, jobs=2):
    shares = defaultdict(list)
    if jobs > 1:
        with ProcessPoolExecutor(jobs) as pool:
            found = list(pool.map(case, range(n_machines)))
    else:
        found = map(case, range(n_machines))
    for kinds, share in found:
        for kind in kinds:
            shares[kind].append(share)
    for kind, found in shares.items():
        print(f"{kind:8}  {len(found):4} machines  region holds {100 * np.mean(found):.1f} %, of a tenth of them below {100 * np.quantile(found, 0.1):.0f} %")
    return {kind: float(np.mean(found)) for kind, found in shares.items()}


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
