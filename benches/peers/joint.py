"""The paper's joint as a peer's user writes it down: matrices for scipy.signal, modes of stick and slip for solve_ivp."""

import numpy as np
from case import SAMPLE_TIME_S

NUDGE = 1e-12  # rad/s with which a motor breaks loose, so that the event function does not begin at its own zero
MOTOR, LINK, DAMPING, STIFFNESS = 35.0, 150.0, 400.0, 1.5e5
# states motor velocity, deflection, link velocity
A = np.array(
    [[-DAMPING / MOTOR, -STIFFNESS / MOTOR, DAMPING / MOTOR], [1, 0, -1], [DAMPING / LINK, STIFFNESS / LINK, -DAMPING / LINK]]
)
B, C, D = np.array([[1 / MOTOR], [0], [0]]), np.array([[1.0, 0, 0]]), np.zeros((1, 1))


def spring(k2, knee, deflection):
    within = min(max(deflection, -knee), knee)
    return STIFFNESS * within + k2 * (deflection - within)


def by_solve_ivp(u, method="RK45", coulomb=0.0, k2=STIFFNESS, knee=1e-3, rtol=1e-8, atol=1e-11):
    """Stick and slip as modes: a stuck motor stays until the net torque exceeds F_c, a slipping one until its velocity is 0.

    From sample to sample, since the torque jumps there. Event functions find where the motor stops or breaks loose, step control
    finds the knee of the spring. Tolerances are set for answers that agree to 1e-6 of the peak.
    """
    from scipy.integrate import solve_ivp

    def net(x, torque):
        return torque - spring(k2, knee, x[1]) - DAMPING * (x[0] - x[2])

    def derivative(_, x, torque, slip):
        transmitted = spring(k2, knee, x[1]) + DAMPING * (x[0] - x[2])
        motor = 0.0 if slip == 0 else (torque - transmitted - slip * coulomb) / MOTOR
        return [motor, x[0] - x[2], transmitted / LINK]

    def at_rest(x, torque):
        return 0 if abs(net(x, torque)) <= coulomb else np.sign(net(x, torque))

    def stops(_, x, torque, slip):
        return slip * x[0]

    def breaks_loose(_, x, torque, slip):
        return coulomb - abs(net(x, torque))

    stops.terminal = breaks_loose.terminal = True
    stops.direction = breaks_loose.direction = -1
    x, y, slip = np.zeros(3), np.empty_like(u), 1
    for k, torque in enumerate(u[0]):
        y[0, k] = x[0]
        if coulomb and x[0] == 0:
            slip = at_rest(x, torque)
            x[0] = slip * NUDGE
        time = 0.0
        while time < SAMPLE_TIME_S:
            events = (stops if slip else breaks_loose) if coulomb else None
            options = {"method": method, "events": events, "args": (torque, slip), "rtol": rtol, "atol": atol}
            run = solve_ivp(derivative, (time, SAMPLE_TIME_S), x, **options)
            time, x = run.t[-1], run.y[:, -1]
            if run.status == 1:
                slip = at_rest(x, torque) if slip else np.sign(net(x, torque))
                x[0] = slip * NUDGE
    return y
