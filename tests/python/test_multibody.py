"""The arm against MuJoCo, a multibody code that shares nothing with ours: accelerations at random states, and trajectories of
the elastic arm, which scipy integrates over MuJoCo's link accelerations."""

import pathlib
import sys
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import frfid

tomllib = pytest.importorskip("tomllib", reason="robot files are read with Python 3.11's tomllib")
mujoco = pytest.importorskip("mujoco", reason="the independent check of the arm needs MuJoCo: pip install mujoco")

EXAMPLES = pathlib.Path(__file__).parents[2] / "examples"
sys.path.insert(0, str(EXAMPLES / "players"))
import mujoco_robot

ROBOTS = EXAMPLES / "robots"
T = 1e-3
LINEAR = {"coulomb_friction": False, "stiffening": False, "torque_ripple": False, "sensing": False}


class Multibody:
    """Rigid links in MuJoCo, without anything that is not inertia or gravity."""

    def __init__(self, model, gravity):
        mujoco.mj_setConst(model, mujoco.MjData(model))
        model.opt.gravity = gravity
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        model.dof_damping[:] = 0.0
        self.model, self.data = model, mujoco.MjData(model)

    @classmethod
    def of_tables(cls, robot):
        """From the tables of a robot file: bodies in a chain, locked joints turned once and for all."""
        spec = mujoco.MjSpec()
        mujoco_robot.add_links(spec, robot)
        model = spec.compile()
        mujoco_robot.set_inertias(model, robot)
        return cls(model, robot["gravity_m_s2"])

    @classmethod
    def of_urdf(cls, path):
        """From URDF as MuJoCo itself reads it, but for the inertias: its compiler would balance those of simplified bodies."""
        spec = mujoco.MjSpec.from_file(str(path))
        spec.compiler.fusestatic, spec.compiler.balanceinertia, spec.compiler.boundinertia = False, True, 1e-6
        model = spec.compile()
        for link in ElementTree.parse(path).iter("link"):
            of = lambda part: {} if link.find("inertial") is None else link.find("inertial").find(part).attrib
            inertia = {entry: float(value) for entry, value in of("inertia").items()}
            center = [float(x) for x in of("origin").get("xyz", "0 0 0").split()]
            mujoco_robot.set_inertia(model, link.get("name"), float(of("mass").get("value", 0.0)), center, inertia)
        return cls(model, (0.0, 0.0, -9.81))

    def acceleration(self, q, qd, torque):
        self.data.qpos[:], self.data.qvel[:], self.data.qfrc_applied[:] = q, qd, torque
        mujoco.mj_forward(self.model, self.data)
        return self.data.qacc.copy()


class Elastic:
    """Rotors and gears in front of rigid links: the reduced model, its right-hand side in numpy."""

    def __init__(self, links, joints):
        of = lambda name: np.array([joint.get(name, 0.0) for joint in joints])
        self.links, self.motor, self.viscous = links, of("motor_inertia_kg_m2"), of("viscous_nms_per_rad")
        self.stiffness, self.damping = of("stiffness_nm_per_rad"), of("damping_nms_per_rad")

    def slope(self, x, u):
        qm, qo, vm, vo = x.reshape(4, -1)
        transmitted = self.stiffness * (qm - qo) + self.damping * (vm - vo)
        motor = (u - self.viscous * vm - transmitted) / self.motor
        return np.concatenate([vm, vo, motor, self.links.acceleration(qo, vo, transmitted)])

    def held_at(self, q):
        """At rest with the links at q, the gears deflected by gravity; and the torque that holds it."""
        still = np.zeros_like(q)
        self.links.acceleration(q, still, still)
        torque = self.links.data.qfrc_bias.copy()
        return np.concatenate([q + torque / self.stiffness, q, still, still]), torque

    def simulate(self, x, u, n_held):
        """States at the samples, (state, sample), under torques held for n_held samples each."""
        states = [x]
        for k in range(0, u.shape[1], n_held):
            at = T * np.arange(1, n_held + 1)
            step = solve_ivp(lambda _, x: self.slope(x, u[:, k]), (0.0, at[-1]), states[-1], "DOP853", at, rtol=1e-12, atol=1e-14)
            states += list(step.y.T)
        return np.array(states[: u.shape[1]]).T


def r3():
    tables = tomllib.loads((ROBOTS / "manutec_r3.toml").read_text())
    return Multibody.of_tables(tables), [body["joint"] for body in tables["body"] if "joint" in body]


def six_axis():
    joints = tomllib.loads((ROBOTS / "six_axis_flexibility.toml").read_text())["urdf"]["joint"]
    return Multibody.of_urdf(ROBOTS / "six_axis.urdf"), [joints[f"joint_{axis}"] for axis in range(1, 7)]


BOTH = pytest.mark.parametrize("file, of", [("manutec_r3.toml", r3), ("six_axis_flexibility.toml", six_axis)])


@BOTH
def test_accelerations_at_random_states_are_mujoco_s(file, of):
    plant, (links, joints) = frfid.Plant.load(ROBOTS / file), of()
    rng, shape = np.random.default_rng(1), (1000, len(joints))
    q, qd = rng.uniform(-np.pi, np.pi, shape), rng.uniform(-3.0, 3.0, shape)
    torque = rng.normal(0.0, 500.0, shape)
    expected = np.array([links.acceleration(*state) for state in zip(q, qd, torque)])
    found = plant.link_acceleration(q, qd, torque)
    error = np.abs(found - expected).max(axis=1) / np.abs(expected).max(axis=1)
    print(f"{file}: worst of 1000 states {error.max():.1e} of the largest acceleration")
    assert error.max() < 1e-9
    np.testing.assert_allclose(plant.link_acceleration(q[0], qd[0], torque[0]), found[0], rtol=1e-12)


@BOTH
def test_mass_matrix_and_gravity_are_mujoco_s(file, of):
    plant, (links, joints) = frfid.Plant.load(ROBOTS / file), of()
    q, still, torques = np.array(plant.pose_rad), np.zeros(len(joints)), np.eye(len(joints))
    mobility = np.array([links.acceleration(q, still, t) - links.acceleration(q, still, still) for t in torques]).T
    np.testing.assert_allclose(plant.mass_matrix(q) @ mobility, torques, atol=1e-9)
    np.testing.assert_allclose(plant.gravity_torque(q), links.data.qfrc_bias, rtol=1e-9, atol=1e-9)
    assert plant.mass_matrix([q, q]).shape == (2, len(joints), len(joints))


@BOTH
def test_the_elastic_arm_moves_as_mujoco_and_scipy_say(file, of):
    plant, (links, joints) = frfid.Plant.load(ROBOTS / file, challenges=LINEAR), of()
    elastic, n_held = Elastic(links, joints), 25
    x, holding = elastic.held_at(np.array(plant.pose_rad))
    pushes = 10.0 * elastic.motor[:, None] * np.random.default_rng(2).normal(size=(len(joints), 20))
    record = plant.simulate(np.repeat(pushes, n_held, axis=1), sample_time_s=T)
    np.testing.assert_allclose(record.u - record.r, holding[:, None] + 0.0 * record.r, atol=1e-9)
    position, _, velocity, _ = np.split(elastic.simulate(x, record.u, n_held), 4)
    position -= position[:, :1] - record.position_rad[:, :1]  # robots count positions from the pose or from zero
    for found, expected in ((record.position_rad, position), (record.y, velocity)):
        travel = np.ptp(expected, axis=1, keepdims=True)
        error = np.abs(found - expected) / travel
        print(f"{file}: worst {error.max():.1e} of a travel of {travel.ravel()}")
        assert error.max() < 1e-6
    frozen = frfid.Plant.load(ROBOTS / file, challenges={**LINEAR, "position_dependence": False})
    difference = frozen.simulate(record.r, sample_time_s=T).y - record.y
    assert np.abs(difference).max() > 1e-2, "the arm goes far enough for its mass matrix to change"
