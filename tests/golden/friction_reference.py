"""Reference motion of the paper's joint with Coulomb friction, by a method that is not frfid's (SK15 section 6).

J_m qm'' = u - tau_f - tau_s(dq) - d dq',  J_o qo'' = tau_s(dq) + d dq',  dq = qm - qo; tau_f = F_c sgn(qm') in slip, |tau_f| <= F_c at rest;
tau_s = k1 dq up to the knee b, k1 b sgn(dq) + k2 (dq - b sgn(dq)) beyond.

Between samples u is held, and within a mode (stuck, slipping forward or backward; within, above or below the knee) the equations are
linear with constant coefficients: the state moves along an exact matrix exponential, here from the eigenvectors of the mode's
matrix. The instants at which a mode ends (velocity 0, net torque +-F_c, deflection +-b) are found on a grid of 200 points per sample
and refined by Brent's method. `--check` does it all again on a grid twice as fine, and by scipy's DOP853 with event functions and
tolerances of 1e-12, and prints the differences: 1e-13 of the peak at most.

Run:  python tests/golden/friction_reference.py [--check]    (numpy, scipy; writes friction_phases.txt and friction_*.f64)

friction_phases.txt: the line numbers (multiples of f0 = 1/12.288 Hz) and phases of the multisine sum_s sin(2 pi s t/T + phi_s),
which is scaled so that its largest sample is 150 N m. friction_*.f64: motor velocity in rad/s at t_k = k ms, k = 0..12287, just
before u[k] acts, little-endian doubles; all states 0 at t = 0. friction_50, friction_120: F_c in N m, linear spring.
friction_knee: F_c = 20 N m, k2 = 1.7 k1 beyond b = 2e-4 rad.
"""

import pathlib
import sys

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

HERE = pathlib.Path(__file__).parent
J_M, J_O, D, K1 = 35.0, 150.0, 400.0, 1.5e5
T_S, N = 1e-3, 12288
VELOCITY, DEFLECTION, LINK = 0, 1, 2  # the state: qm', dq, qo'


def multisine():
    """71 odd lines nearest to 80 log-spaced frequencies from 1 to 60 Hz, random phases, largest sample 150 N m."""
    f0 = 1 / (N * T_S)
    wanted = np.geomspace(1.0, 60.0, 80)
    lines = np.unique(2 * np.round((wanted / f0 - 1) / 2).astype(int) + 1)
    assert (len(lines), lines[0]) == (71, 13)
    phases = np.random.default_rng(2015).uniform(0, 2 * np.pi, len(lines))
    u = np.sin(2 * np.pi * (np.outer(np.arange(N), lines) % N) / N + phases).sum(axis=1)
    return lines, phases, u * (150 / np.abs(u).max())


class Mode:
    """One smooth piece of the dynamics: slip in (-1, 0 = stuck, 1), branch of the spring in (-1, 0, 1)."""

    def __init__(self, joint, slip, branch):
        self.slip, self.branch, self.coulomb, self.knee = slip, branch, joint.coulomb, joint.knee
        self.k = joint.k2 if branch else K1
        self.offset = branch * (K1 - joint.k2) * joint.knee  # tau_s = k dq + offset
        k = self.k
        self.a = np.array([[-D / J_M, -k / J_M, D / J_M], [1, 0, -1], [D / J_O, k / J_O, -D / J_O]])
        self.keep = [VELOCITY, DEFLECTION, LINK]
        if slip == 0:
            self.a[VELOCITY] = 0
            self.keep = [DEFLECTION, LINK]
        self.values, self.vectors = np.linalg.eig(self.a[np.ix_(self.keep, self.keep)])
        self.inverse = np.linalg.inv(self.vectors)

    def force(self, u):
        motor = (u - self.slip * self.coulomb - self.offset) / J_M if self.slip else 0.0
        return np.array([motor, 0.0, self.offset / J_O])

    def flow(self, x, u, t):
        """States after the times t (an array) of constant torque: exact but for rounding. (time, state)"""
        modal, drive = self.inverse @ x[self.keep], self.inverse @ self.force(u)[self.keep]
        z = np.multiply.outer(t, self.values)
        small = np.abs(z) < 1e-6  # phi1(z) = (e^z - 1)/z; the rigid body's eigenvalue is 0
        safe = np.where(small, 1, z)
        phi1 = np.where(small, 1 + z / 2 + z * z / 6, np.expm1(safe) / safe)
        out = np.zeros((len(t), 3))
        out[:, self.keep] = ((np.exp(z) * modal + phi1 * t[:, None] * drive) @ self.vectors.T).real
        return out

    def net(self, x, u):
        """Torque on the motor besides friction."""
        stretch = self.k * x[..., DEFLECTION] + self.offset
        return u - stretch - D * (x[..., VELOCITY] - x[..., LINK])

    def margins(self, u):
        """Functions of the state that are above 0 while the mode holds, each with the mode that follows."""
        out = []
        if self.slip:
            out.append((lambda x: self.slip * x[..., VELOCITY], ("rest", self.branch)))
        elif self.coulomb:
            out.append((lambda x: self.coulomb - self.net(x, u), (1, self.branch)))
            out.append((lambda x: self.coulomb + self.net(x, u), (-1, self.branch)))
        if self.knee and self.branch:
            out.append((lambda x: self.branch * x[..., DEFLECTION] - self.knee, (self.slip, 0)))
        elif self.knee:
            out.append((lambda x: self.knee - x[..., DEFLECTION], (self.slip, 1)))
            out.append((lambda x: self.knee + x[..., DEFLECTION], (self.slip, -1)))
        return out


class Joint:
    def __init__(self, coulomb, k2=K1, knee=0.0):
        self.coulomb, self.k2, self.knee = coulomb, k2, knee
        branches = (-1, 0, 1) if knee else (0,)
        self.modes = {(s, b): Mode(self, s, b) for s in (-1, 0, 1) for b in branches}

    def at_rest(self, x, u, branch):
        torque = self.modes[0, branch].net(x, u)
        slip = 0 if abs(torque) <= self.coulomb else int(np.sign(torque))
        return self.modes[slip, branch]

    def next(self, key, x, u):
        if key[0] == "rest":
            x[VELOCITY] = 0.0
            return self.at_rest(x, u, key[1])
        return self.modes[key]

    def run(self, u, advance):
        """Velocity at every sample, share of the time stuck, number of mode changes. `advance` moves to the end of a mode."""
        x, mode, y, stuck, changes = np.zeros(3), self.modes[0, 0], np.zeros(len(u)), 0.0, 0
        for k, torque in enumerate(u):
            y[k] = x[VELOCITY]
            if mode.slip == 0:
                mode = self.at_rest(x, torque, mode.branch)
            left = T_S
            while left > 0:
                duration, x, key = advance(mode, x, torque, left)
                stuck += duration * (mode.slip == 0)
                if key is None:
                    break
                changes, left = changes + 1, left - duration
                mode = self.next(key, x, torque)
        return y, stuck / (len(u) * T_S), changes


def exact(points):
    """Along the matrix exponential to the first zero of a margin on a grid, refined."""

    def advance(mode, x, u, left):
        grid = np.linspace(0, left, points + 1)
        states = mode.flow(x, u, grid)
        first, key = left, None
        for margin, follower in mode.margins(u):
            values = margin(states)
            below = np.flatnonzero(values[1:] < 0)
            if not len(below):
                continue
            k = below[0]
            t = grid[k]  # if the mode begins on its bound it leaves it at once
            if values[k] > 0:
                t = brentq(lambda t: margin(mode.flow(x, u, np.array([t]))[0]), grid[k], grid[k + 1], xtol=1e-17)
            if t < first:
                first, key = t, follower
        return first, mode.flow(x, u, np.array([first]))[0], key

    return advance


def runge_kutta(mode, x, u, left):
    """By DOP853 and its event functions."""
    force, margins = mode.force(u), mode.margins(u)
    events = [lambda _, x, margin=margin: margin(x) for margin, _ in margins]
    for event in events:
        event.terminal, event.direction = True, -1
    tolerances = dict(rtol=1e-12, atol=1e-15, max_step=T_S / 20)
    s = solve_ivp(lambda _, x: mode.a @ x + force, (0, left), x, method="DOP853", events=events, **tolerances)
    hit = [key for (_, key), times in zip(margins, s.t_events) if len(times)]
    return s.t[-1], s.y[:, -1].copy(), hit[0] if hit else None


def main():
    lines, phases, u = multisine()
    table = np.column_stack([lines, phases])
    np.savetxt(HERE / "friction_phases.txt", table, fmt=["%d", "%.17g"], header="line phase_rad")
    cases = {"50": Joint(50.0), "120": Joint(120.0), "knee": Joint(20.0, 1.7 * K1, 2e-4)}
    for name, joint in cases.items():
        y, stuck, changes = joint.run(u, exact(200))
        peak = np.abs(y).max()
        print(f"{name}: peak {peak:.6g} rad/s, stuck {100 * stuck:.4f} %, {changes} mode changes")
        y.astype("<f8").tofile(HERE / f"friction_{name}.f64")
        if "--check" in sys.argv:
            finer = np.abs(joint.run(u, exact(400))[0] - y).max() / peak
            other = np.abs(joint.run(u, runge_kutta)[0] - y).max() / peak
            print(f"  relative to the peak: grid twice as fine {finer:.2g}, DOP853 {other:.2g}")


if __name__ == "__main__":
    main()
