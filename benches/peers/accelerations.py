"""Accelerations of an arm's links at 1000 random states: M(q)^-1 (torque - C qd - g).

Pinocchio's articulated-body algorithm takes one state per call and is called from Python, as a user would; the loop itself costs
less than a microsecond of each call. frfid takes all states in one call. Both read the same URDF; the three base axes are the
arm with its wrist locked.
"""

import pathlib
from functools import cache

import numpy as np
from case import Case

import frfid

ROBOTS = pathlib.Path(__file__).parents[2] / "examples" / "robots"


def states(n, n_axes):
    rng = np.random.default_rng(1)
    return rng.uniform(-np.pi, np.pi, (n, n_axes)), rng.normal(0, 2.0, (n, n_axes)), rng.normal(0, 500.0, (n, n_axes))


@cache
def model(axes):
    """The arm of the URDF, or its three base axes with the wrist of the robot file locked."""
    import pinocchio

    urdf = (ROBOTS / "six_axis.urdf").read_text()
    arm = pinocchio.buildModelFromXML(urdf.replace("continuous", "revolute"))  # angles, not their cosines and sines
    wrist = np.array(frfid.Plant.load(ROBOTS / "six_axis.toml").pose_rad)
    return arm if axes == arm.nv else pinocchio.buildReducedModel(arm, [4, 5, 6], wrist)


def by_pinocchio(q, qd, torque):
    import pinocchio

    arm = model(q.shape[1])
    data = arm.createData()
    return np.array([pinocchio.aba(arm, data, *state) for state in zip(q, qd, torque, strict=True)])


def cases(small=False):
    for file in ("manutec_r3.toml", "six_axis_flexibility.toml"):
        plant = frfid.Plant.load(ROBOTS / file)
        state = states(100 if small else 1000, plant.n_axes)
        yield Case(
            f"link accelerations, {plant.n_axes} axes",
            "state",
            len(state[0]),
            lambda plant=plant, state=state: plant.link_acceleration(*state),
            "pin",
            "pinocchio.aba, state by state",
            lambda state=state: by_pinocchio(*state),
            tolerance=1e-9,
            headline=plant.n_axes == 3,
        )
