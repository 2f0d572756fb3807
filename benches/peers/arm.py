"""The base axes of the Manutec r3 in closed loop, on a constant velocity with a multisine, 16 payloads side by side.

Friction, ripple, gravity and elastic gears on both sides, sensors in frfid alone. MuJoCo takes one Runge-Kutta step a sample, with the
controller in Python around it; its friction is a soft constraint.
"""

from functools import cache

import numpy as np
from case import MULTISINE, SAMPLE_TIME_S, Case
from of_mujoco import EXAMPLES, robot, tables_of

import frfid

ROBOT = EXAMPLES / "robots" / "manutec_r3.toml"
TABLES = tables_of(ROBOT)
GAIN, INTEGRAL_GAIN = np.array([1500.0, 1500.0, 400.0]), np.array([12000.0, 12000.0, 3200.0])
VELOCITY_RAD_S = np.array([0.011, 0.01, 0.0105])
N_RUNS = 16


def reference(n_samples):
    """Constant velocity and three quarters of it as the peak of a multisine, (axis, sample)."""
    signal = MULTISINE.realize(seed=1, n_inputs=3, peak=0.75 * VELOCITY_RAD_S)[0, :, :n_samples]
    return VELOCITY_RAD_S[:, None] + signal


def plants():
    """The robot with its own payload and lighter ones."""
    text, kg = ROBOT.read_text(), TABLES["payload"]["mass_kg"]
    assert (line := f"mass_kg = {kg}\ncenter_of_mass_m") in text
    return [frfid.Plant.from_toml(text.replace(line, f"mass_kg = {kg - 0.5 * k}\ncenter_of_mass_m")) for k in range(N_RUNS)]


@cache
def mujoco_arm():
    return robot(TABLES, GAIN, INTEGRAL_GAIN, SAMPLE_TIME_S)


def by_mujoco(r):
    """From rest with the links at the pose, as frfid: the motors are ahead by what the gears give under gravity, which ripple feels."""
    arm = mujoco_arm()
    motors = arm.pose_rad + arm.stand_at(arm.pose_rad) / arm.model.tendon_stiffness
    return arm.play(np.repeat(motors[:, None], r.shape[1], axis=1), r)[1][None]


def cases(small=False):
    r = reference(300 if small else 2000)
    robots, loop = plants(), frfid.PiController(gain=GAIN, integral_gain=INTEGRAL_GAIN, sample_time_s=SAMPLE_TIME_S)
    yield Case(
        f"three-axis arm in closed loop, everything on, {N_RUNS} payloads side by side",
        "sample of 1 ms",
        N_RUNS * r.shape[1],
        lambda: frfid.run_closed_loop(robots, loop, r).y,
        "mujoco",
        "mj_step, RK4 of 1 ms, loop in Python",
        lambda: by_mujoco(r),
        tolerance=0.1,
        n_peer=r.shape[1],
        remark="soft friction, no sensors",
        headline=True,
    )
