"""The paper's joint over one period of the multisine, 12 288 samples of held torque, from rest: linear, with friction, with two slopes.

Linear: exact in scipy by one matrix exponential; lsim and dlsim step through the samples in Python, lfilter in C, but for one
input and one output of a linear plant only. frfid takes the same general steps for every plant, ten of them per sample.
frfid returns a record of torques, velocities and positions whose samples are checked, the peers the motor velocity.
"""

import scipy.signal
from case import MULTISINE, PEAK, SAMPLE_TIME_S, Case
from joint import A, B, C, D, STIFFNESS, by_solve_ivp

import frfid


def by_lsim(u):
    time = [SAMPLE_TIME_S * k for k in range(u.shape[1])]
    return scipy.signal.lsim((A, B, C, D), u[0], time, interp=False)[1][None]


def by_dlsim(u):
    discrete = scipy.signal.cont2discrete((A, B, C, D), SAMPLE_TIME_S, "zoh")
    return scipy.signal.dlsim(discrete, u[0])[1].T


def by_lfilter(u):
    a, b, c, d, _ = scipy.signal.cont2discrete((A, B, C, D), SAMPLE_TIME_S, "zoh")
    numerator, denominator = scipy.signal.ss2tf(a, b, c, d)
    return scipy.signal.lfilter(numerator[0], denominator, u)


def cases(small=False):
    u = MULTISINE.realize(seed=1, peak=PEAK)[0][:, : 500 if small else None]
    few = u[:, : 200 if small else 2048]

    def joint(name, **parameters):
        plant = frfid.Plant.single_joint(**parameters)
        return f"single joint, {name}", "sample", u.size, lambda: plant.simulate(u, sample_time_s=SAMPLE_TIME_S).y

    here = joint("linear")
    # a transfer function with a pole at z = 1 costs lfilter two digits
    for peer, name, tolerance in ((by_lsim, "lsim", 1e-9), (by_dlsim, "dlsim", 1e-9), (by_lfilter, "lfilter", 1e-8)):
        remark = "good for a linear joint only" if peer is by_lfilter else ""
        yield Case(*here, "scipy", f"scipy.signal.{name}", lambda peer=peer: peer(u), tolerance, remark=remark)
    ours = joint("friction 50 N m, one run", coulomb_nm=50.0)
    for method in ("RK45", "LSODA"):
        peer = lambda method=method: by_solve_ivp(few, method, coulomb=50.0)
        headline = method == "LSODA"
        yield Case(*ours, "scipy", f"solve_ivp with events, {method}", peer, tolerance=2e-6, n_peer=few.size, headline=headline)
    ours = joint("stiffness k2 = 1.7 k1", stiffness_beyond_nm_per_rad=1.7 * STIFFNESS)
    yield Case(*ours, "scipy", "solve_ivp, step control", lambda: by_solve_ivp(few, k2=1.7 * STIFFNESS), tolerance=1e-6, n_peer=few.size)
