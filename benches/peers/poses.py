"""FRFs of the Manutec r3 at many poses, from motor torques to motor velocities: what python-control says of the same linear models.

Both sides begin with the poses. The peer's state matrices are put together in numpy from mass matrices, gravity and the gears' tables; its
frequency response is one call for a pose, as a user would write it. frfid takes all poses in one call.
"""

import numpy as np
from case import Case
from of_mujoco import EXAMPLES, tables_of

import frfid

ROBOT = EXAMPLES / "robots" / "manutec_r3.toml"
STEP_RAD = 1e-4


def models(arm, q):
    """A and B about rest at every pose: states motor positions, link positions and their velocities."""
    joints = [body["joint"] for body in tables_of(ROBOT)["body"] if "joint" in body]
    of = lambda name: np.diag([joint.get(name, 0.0) for joint in joints])
    n, stiffness, damping = arm.n_axes, of("stiffness_nm_per_rad"), of("damping_nms_per_rad")
    motor, viscous = np.linalg.inv(of("motor_inertia_kg_m2")), of("viscous_nms_per_rad")
    steps = STEP_RAD * np.eye(n)
    up, down = (arm.gravity_torque((q[:, None] + sign * steps).reshape(-1, n)).reshape(-1, n, n) for sign in (1, -1))
    gradient = np.swapaxes(up - down, 1, 2) / (2 * STEP_RAD)
    a, b = np.zeros((len(q), 4 * n, 4 * n)), np.zeros((4 * n, n))
    a[:, : 2 * n, 2 * n :] = np.eye(2 * n)
    a[:, 2 * n : 3 * n] = motor @ np.hstack([-stiffness, stiffness, -damping - viscous, damping])
    rows = [np.broadcast_to(part, gradient.shape) for part in (stiffness, -stiffness - gradient, damping, -damping)]
    a[:, 3 * n :] = np.linalg.solve(arm.mass_matrix(q), np.concatenate(rows, axis=2))
    b[2 * n : 3 * n] = motor
    return a, b


def by_control(arm, q, hz):
    import control

    n = arm.n_axes
    a, b = models(arm, q)
    velocities = np.eye(4 * n)[2 * n : 3 * n]
    systems = (control.ss(each, b, velocities, np.zeros((n, n))) for each in a)
    return np.array([system(2j * np.pi * hz) for system in systems]).transpose(0, 3, 1, 2)


def cases(small=False):
    arm = frfid.Plant.load(ROBOT, challenges={"stiffening": False})
    q = np.random.default_rng(1).uniform(-np.pi, np.pi, (4 if small else 64, arm.n_axes))
    hz = np.linspace(0.5, 100.0, 20 if small else 200)
    yield Case(
        f"FRFs of a three-axis arm at {len(q)} poses",
        "matrix 3x3",
        len(q) * len(hz),
        lambda: arm.frf_at(q, hz, hold="continuous"),
        "control",
        "StateSpace at all frequencies, pose by pose",
        lambda: by_control(arm, q, hz),
        tolerance=1e-7,
    )
