"""Robots in MuJoCo with its Runge-Kutta steps: those of the example of a player, examples/players/mujoco_robot.py."""

import pathlib
import sys
import tomllib

import numpy as np

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
PLAYERS = EXAMPLES / "players"


def tables_of(file):
    """Tables of a robot file."""
    return tomllib.loads(file.read_text())


def module():
    """The example's module."""
    if str(PLAYERS) not in sys.path:
        sys.path.insert(0, str(PLAYERS))
    import mujoco_robot

    return mujoco_robot


def robot(tables, gain=0.0, integral_gain=0.0, sample_time_s=1e-3):
    """The robot of these tables under velocity control, stepped once a sample."""
    made = module().Robot(tables, module().VelocityLoop(gain, integral_gain, 0.0, sample_time_s))
    made.n_steps, made.model.opt.timestep = 1, sample_time_s
    return made


def open_loop(robot, torque):
    """Velocity of the motors, (joint, sample), from rest under torques that are held."""
    import mujoco

    model, data, n = robot.model, robot.data, robot.n
    mujoco.mj_resetData(model, data)
    y = np.empty((torque.shape[1], n))
    for k, each in enumerate(torque.T):
        y[k] = data.qvel[:n]
        data.ctrl[:] = each
        mujoco.mj_step(model, data)
    return y.T
