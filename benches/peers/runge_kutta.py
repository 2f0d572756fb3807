"""Runge-Kutta steps of the joint with friction for many runs at once, by numba, whose compiler puts the runs into lanes."""

import numba
import numpy as np


@numba.njit(inline="always")
def slope(motor, deflection, link, torque, moves, parameters):
    inertia, link_inertia, damping, stiffness, _ = parameters
    transmitted = stiffness * deflection + damping * (motor - link)
    return moves * (torque - transmitted) / inertia, motor - link, transmitted / link_inertia


@numba.njit(inline="always")
def step(motor, deflection, link, torque, h, parameters):
    """One step; friction keeps its sign within it, and a motor whose velocity would change its sign stands at its end."""
    _, _, damping, stiffness, coulomb = parameters
    net = torque - stiffness * deflection - damping * (motor - link)
    sense = np.sign(motor) if motor != 0.0 else (np.sign(net) if abs(net) > coulomb else 0.0)
    moves, torque = abs(sense), torque - sense * coulomb
    a, b, c = slope(motor, deflection, link, torque, moves, parameters)
    k, m, n = slope(motor + 0.5 * h * a, deflection + 0.5 * h * b, link + 0.5 * h * c, torque, moves, parameters)
    a, b, c = a + 2 * k, b + 2 * m, c + 2 * n
    k, m, n = slope(motor + 0.5 * h * k, deflection + 0.5 * h * m, link + 0.5 * h * n, torque, moves, parameters)
    a, b, c = a + 2 * k, b + 2 * m, c + 2 * n
    k, m, n = slope(motor + h * k, deflection + h * m, link + h * n, torque, moves, parameters)
    after = motor + h / 6 * (a + k)
    after = 0.0 if after * sense < 0.0 else after
    return after, deflection + h / 6 * (b + m), link + h / 6 * (c + n)


@numba.njit
def side_by_side(u, sample_time_s, n_steps, parameters):
    """Motor velocity, (run, sample), of runs from rest under torques that are held, (run, sample)."""
    n_runs, n_samples = u.shape
    torques, y = u.T.copy(), np.empty((n_samples, n_runs))
    motor, deflection, link = np.zeros(n_runs), np.zeros(n_runs), np.zeros(n_runs)
    h = sample_time_s / n_steps
    for k in range(n_samples):
        y[k] = motor
        torque = torques[k]
        for _ in range(n_steps):
            for run in range(n_runs):
                motor[run], deflection[run], link[run] = step(motor[run], deflection[run], link[run], torque[run], h, parameters)
    return y.T.copy()
