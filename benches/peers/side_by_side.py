"""The paper's joint with friction of 50 N m, 16 runs of 12 288 samples side by side, each with another multiple of the torque.

frfid and solve_ivp locate where the motor stops and breaks loose. numba takes ten Runge-Kutta steps a sample for all runs at once and ends a
slip at the end of the step in which the velocity changes its sign. MuJoCo's friction is a soft constraint.
"""

from functools import cache

import numpy as np
from case import MULTISINE, PEAK, SAMPLE_TIME_S, Case
from joint import DAMPING, LINK, MOTOR, STIFFNESS, by_solve_ivp
from of_mujoco import open_loop, robot

import frfid

N_RUNS, COULOMB = 16, 50.0


@cache
def mujoco_joint():
    joint = {"motor_inertia_kg_m2": MOTOR, "stiffness_nm_per_rad": STIFFNESS, "damping_nms_per_rad": DAMPING, "coulomb_nm": COULOMB}
    body = {"name": "link", "axis": [0.0, 0.0, 1.0], "mass_kg": 1.0, "joint": joint}
    inertia = {"ixx": LINK, "iyy": LINK, "izz": LINK}
    return robot({"gravity_m_s2": [0.0, 0.0, 0.0], "body": [body | {"inertia_kg_m2": inertia}]})


def by_mujoco(u):
    return np.array([open_loop(mujoco_joint(), run) for run in u])


def by_numba(u):
    from runge_kutta import side_by_side

    return side_by_side(u[:, 0], SAMPLE_TIME_S, 10, (MOTOR, LINK, DAMPING, STIFFNESS, COULOMB))[:, None]


def cases(small=False):
    torque = MULTISINE.realize(seed=1, peak=PEAK)[0][:, : 500 if small else None]
    u = np.array([(1.0 - 0.02 * k) * torque for k in range(N_RUNS)])
    plants = [frfid.Plant.single_joint(coulomb_nm=COULOMB) for _ in u]
    ours = lambda: frfid.simulate(plants, u, sample_time_s=SAMPLE_TIME_S).y
    here = (f"single joint, friction 50 N m, {N_RUNS} runs side by side", "sample", u.size, ours)
    few = u[:1, :, : 200 if small else 2048]
    lsoda = lambda: by_solve_ivp(few[0], "LSODA", coulomb=COULOMB)[None]
    yield Case(*here, "scipy", "solve_ivp with events, LSODA", lsoda, 2e-6, n_peer=few.size, headline=True)
    soft = "soft friction: the motor creeps where it should stick"
    alone = u[:1]
    yield Case(*here, "mujoco", "mj_step, RK4 of 1 ms", lambda: by_mujoco(alone), 0.2, n_peer=alone.size, remark=soft, headline=True)
    late = "sticks at the end of the step, not where the velocity is 0"
    yield Case(*here, "numba", "Runge-Kutta of 0.1 ms for all runs", lambda: by_numba(u), 1e-2, remark=late, headline=True)
