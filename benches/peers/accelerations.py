"""Accelerations of an arm's links at 1000 random states: M(q)^-1 (torque - C qd - g).

Pinocchio's articulated-body algorithm takes one state per call and is called from Python, as a user would; the loop itself costs
less than a microsecond of each call. frfid takes all states in one call. Both read the same URDF; the three base axes are the
arm with its wrist locked. Left out where Pinocchio is not installed (pip install pin).
"""

import pathlib

import numpy as np
from case import Case

import frfid

try:
    import pinocchio
except ImportError:
    pinocchio = None

ROBOTS = pathlib.Path(__file__).parents[2] / "examples" / "robots"


def states(n_axes):
    rng = np.random.default_rng(1)
    return rng.uniform(-np.pi, np.pi, (1000, n_axes)), rng.normal(0, 2.0, (1000, n_axes)), rng.normal(0, 500.0, (1000, n_axes))


def by_pinocchio(model, q, qd, torque):
    data = model.createData()
    return np.array([pinocchio.aba(model, data, *state) for state in zip(q, qd, torque, strict=True)])


def cases():
    if pinocchio is None:
        print("accelerations: left out, pinocchio is not installed")
        return
    urdf = (ROBOTS / "six_axis.urdf").read_text()
    arm = pinocchio.buildModelFromXML(urdf.replace("continuous", "revolute"))  # angles, not their cosines and sines
    wrist = np.array(frfid.Plant.load(ROBOTS / "six_axis.toml").pose_rad)
    base = pinocchio.buildReducedModel(arm, [4, 5, 6], wrist)
    for file, model in (("manutec_r3.toml", base), ("six_axis_flexibility.toml", arm)):
        plant, (q, qd, torque) = frfid.Plant.load(ROBOTS / file), states(model.nv)
        yield Case(
            f"accelerations, {model.nv} axes",
            "pinocchio.aba, state by state",
            lambda plant=plant, s=(q, qd, torque): plant.link_acceleration(*s),
            lambda model=model, s=(q, qd, torque): by_pinocchio(model, *s),
            tolerance=1e-9,
        )
