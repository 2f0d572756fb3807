"""The paper's joint over one period of the multisine, 12 288 samples of held torque, from rest: linear, with friction, with two slopes.

Linear: exact in scipy by one matrix exponential; lsim and dlsim step through the samples in Python, lfilter in C, but for one
input and one output of a linear plant only. frfid takes the same general steps for every plant, ten of them per sample.
frfid returns a record of torques, velocities and positions whose samples are checked, the peers the motor velocity.
"""

from case import MULTISINE, PEAK, SAMPLE_TIME_S, Case
from joint import A, B, C, D, STIFFNESS, by_solve_ivp

import frfid


def by_lsim(u):
    from scipy import signal

    time = [SAMPLE_TIME_S * k for k in range(u.shape[1])]
    return signal.lsim((A, B, C, D), u[0], time, interp=False)[1][None]


def by_dlsim(u):
    from scipy import signal

    discrete = signal.cont2discrete((A, B, C, D), SAMPLE_TIME_S, "zoh")
    return signal.dlsim(discrete, u[0])[1].T


def by_lfilter(u):
    from scipy import signal

    a, b, c, d, _ = signal.cont2discrete((A, B, C, D), SAMPLE_TIME_S, "zoh")
    numerator, denominator = signal.ss2tf(a, 1e3 * b, c, d)  # of kN m: ss2tf subtracts polynomials that differ by b
    return signal.lfilter(numerator[0] / 1e3, denominator, u)


def cases(small=False):
    u = MULTISINE.realize(seed=1, peak=PEAK)[0][:, : 500 if small else None]
    few = u[:, : 200 if small else 2048]

    def joint(name, **parameters):
        plant = frfid.Plant.single_joint(**parameters)
        return f"single joint, {name}", "sample", u.size, lambda: plant.simulate(u, sample_time_s=SAMPLE_TIME_S).y

    here = joint("linear")
    for peer, name in ((by_lsim, "lsim"), (by_dlsim, "dlsim"), (by_lfilter, "lfilter")):
        remark = "good for a linear joint only" if peer is by_lfilter else ""
        yield Case(*here, "scipy", f"scipy.signal.{name}", lambda peer=peer: peer(u), 1e-9, remark=remark)
    ours = joint("friction 50 N m, one run", coulomb_nm=50.0)
    for method in ("RK45", "LSODA"):
        peer = lambda method=method: by_solve_ivp(few, method, coulomb=50.0)
        headline = method == "LSODA"
        yield Case(*ours, "scipy", f"solve_ivp with events, {method}", peer, tolerance=2e-6, n_peer=few.size, headline=headline)
    ours = joint("stiffness k2 = 1.7 k1", stiffness_beyond_nm_per_rad=1.7 * STIFFNESS)
    yield Case(*ours, "scipy", "solve_ivp, step control", lambda: by_solve_ivp(few, k2=1.7 * STIFFNESS), tolerance=1e-6, n_peer=few.size)
