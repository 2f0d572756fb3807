"""The paper's joint over one period of the multisine, 12288 samples of held torque, from rest.

Linear: exact in scipy by one matrix exponential; lsim and dlsim step through the samples in Python, lfilter in C, but for one
input and one output of a linear plant only. frfid takes the same general steps for every plant, ten of them per sample.
With friction or two slopes: solve_ivp from sample to sample, since the torque jumps there. Its event functions find where the
motor stops or breaks loose, its step control finds the knee of the spring. Tolerances are set for answers that agree to 1e-6 of
the peak. frfid returns a record of torques, velocities and positions whose samples are checked, scipy the motor velocity.
"""

import numpy as np
import scipy.signal
from case import MULTISINE, SAMPLE_TIME_S, Case
from scipy.integrate import solve_ivp

import frfid

NUDGE = 1e-12  # rad/s with which a motor breaks loose, so that the event function does not begin at its own zero
MOTOR, LINK, DAMPING, STIFFNESS = 35.0, 150.0, 400.0, 1.5e5
# states motor velocity, deflection, link velocity
A = np.array(
    [[-DAMPING / MOTOR, -STIFFNESS / MOTOR, DAMPING / MOTOR], [1, 0, -1], [DAMPING / LINK, STIFFNESS / LINK, -DAMPING / LINK]]
)
B, C, D = np.array([[1 / MOTOR], [0], [0]]), np.array([[1.0, 0, 0]]), np.zeros((1, 1))


def by_lsim(u):
    time = SAMPLE_TIME_S * np.arange(u.shape[1])
    return scipy.signal.lsim((A, B, C, D), u[0], time, interp=False)[1][None]


def by_dlsim(u):
    discrete = scipy.signal.cont2discrete((A, B, C, D), SAMPLE_TIME_S, "zoh")
    return scipy.signal.dlsim(discrete, u[0])[1].T


def by_lfilter(u):
    a, b, c, d, _ = scipy.signal.cont2discrete((A, B, C, D), SAMPLE_TIME_S, "zoh")
    numerator, denominator = scipy.signal.ss2tf(a, b, c, d)
    return scipy.signal.lfilter(numerator[0], denominator, u)


def spring(k2, knee, deflection):
    within = min(max(deflection, -knee), knee)
    return STIFFNESS * within + k2 * (deflection - within)


def by_solve_ivp(u, coulomb=0.0, k2=STIFFNESS, knee=1e-3, rtol=1e-8, atol=1e-11):
    """Stick and slip as modes: a stuck motor stays until the net torque exceeds F_c, a slipping one until its velocity is 0."""

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
            span, args = (time, SAMPLE_TIME_S), (torque, slip)
            run = solve_ivp(derivative, span, x, events=events, args=args, rtol=rtol, atol=atol)
            time, x = run.t[-1], run.y[:, -1]
            if run.status == 1:
                slip = at_rest(x, torque) if slip else np.sign(net(x, torque))
                x[0] = slip * NUDGE
    return y


def cases():
    u = MULTISINE.realize(seed=1, peak=150.0)[0]

    def simulate(**joint):
        plant = frfid.Plant.single_joint(**joint)
        return lambda: plant.simulate(u, sample_time_s=SAMPLE_TIME_S).y

    # a transfer function with a pole at z = 1 costs lfilter two digits
    for peer, name, tolerance in ((by_lsim, "lsim", 1e-9), (by_dlsim, "dlsim", 1e-9), (by_lfilter, "lfilter", 1e-8)):
        yield Case("simulation, linear", f"scipy.signal.{name}", simulate(), lambda peer=peer: peer(u), tolerance)
    yield Case(
        "simulation, friction F_c = 50 N m",
        "scipy solve_ivp with events",
        simulate(coulomb_nm=50.0),
        lambda: by_solve_ivp(u, coulomb=50.0),
        tolerance=1e-6,
    )
    yield Case(
        "simulation, stiffness k2 = 1.7 k1",
        "scipy solve_ivp, step control",
        simulate(stiffness_beyond_nm_per_rad=1.7 * STIFFNESS),
        lambda: by_solve_ivp(u, k2=1.7 * STIFFNESS),
        tolerance=1e-6,
    )
