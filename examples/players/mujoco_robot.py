"""The arm of a robot file in MuJoCo: links in a chain, rotors on stands of their own, tendons as elastic gears, a velocity loop.

    robot = Robot.of_experiment("examples/experiments/r3_multisine.toml")
    torque, velocity, position = robot.play(position_rad, velocity_rad_s)  # of the motors, (joint, sample)

SI units on the joint side of the gears. Not modelled: stiffness beyond a knee, and the sensors, which are the recorder's.
Needs Python 3.11 (tomllib) and: pip install mujoco scipy
"""

import pathlib
import tomllib
from dataclasses import dataclass

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

HINGE = mujoco.mjtJoint.mjJNT_HINGE
# Replaced after compilation: the compiler refuses simplified bodies and point masses, the equations of motion do not mind.
# Nothing about it is symmetric, lest the compiler takes shortcuts.
PLACEHOLDER = {"mass": 1.0, "ipos": (0.1, 0.2, 0.3), "inertia": (1.0, 1.1, 1.2), "explicitinertial": True}
LONGEST_STEP_S = 0.25e-3


@dataclass
class VelocityLoop:
    """A PI controller of the motors' velocity, a value for each joint, with a position loop around it where that has a gain."""

    gain_nms_per_rad: np.ndarray
    integral_gain_nm_per_rad: np.ndarray
    position_gain_per_s: np.ndarray
    sample_time_s: float

    @classmethod
    def of_table(cls, controller, sample_time_s):
        gain, integral = (np.array(controller[key]) for key in ("gain_nms_per_rad", "integral_gain_nm_per_rad"))
        return cls(gain, integral, np.array(controller.get("position_gain_per_s", np.zeros_like(gain))), sample_time_s)


class Robot:
    """Motors first, then links in every array of MuJoCo. Ripple acts as it is at the controller's samples."""

    def __init__(self, tables, loop, friction=True, ripple=True):
        self.joints = [{"name": body["name"], **body["joint"]} for body in tables["body"] if "joint" in body]
        self.names, self.n = [joint["name"] for joint in self.joints], len(self.joints)
        self.pose_rad = np.array(tables.get("pose_rad", np.zeros(self.n)), float)
        self.gear_ratio = self.of_joints("gear_ratio", 1.0)
        self.max_torque_nm, self.max_velocity_rad_s = self.of_joints("max_effort", np.inf), self.of_joints("max_velocity", np.inf)
        self.loop, self.n_steps = loop, int(np.ceil(loop.sample_time_s / LONGEST_STEP_S))
        self.model = self._model(tables, loop.sample_time_s / self.n_steps, friction)
        self.data = mujoco.MjData(self.model)
        self.ripple = self._ripple() if ripple else None

    @classmethod
    def of_experiment(cls, path, control_hz=None, **options):
        """Robot and gains of an experiment file; the controller's rate is its own."""
        path = pathlib.Path(path)
        experiment = tomllib.loads(path.read_text())
        tables = tomllib.loads((path.parent / experiment["robot"]["file"]).read_text())
        loop = VelocityLoop.of_table(experiment["controller"], 1 / control_hz if control_hz else experiment["sample_time_s"])
        return cls(tables, loop, **options)

    def of_joints(self, key, default):
        return np.array([joint.get(key, default) for joint in self.joints])

    def _model(self, tables, step_s, friction):
        spec = mujoco.MjSpec()
        for joint in self.joints:
            add_rotor(spec, joint["name"], joint["motor_inertia_kg_m2"], step_s)
        add_links(spec, tables)
        for name in self.names:
            gear = spec.add_tendon(name=name)  # as long as motor position - link position
            gear.wrap_joint(f"motor {name}", 1.0)
            gear.wrap_joint(name, -1.0)
            spec.add_actuator(name=name, target=f"motor {name}", trntype=mujoco.mjtTrn.mjTRN_JOINT)
        model = spec.compile()
        set_inertias(model, tables)
        model.tendon_stiffness[:] = self.of_joints("stiffness_nm_per_rad", 0.0)
        model.tendon_damping[:] = self.of_joints("damping_nms_per_rad", 0.0)
        model.dof_damping[: self.n] = self.of_joints("viscous_nms_per_rad", 0.0)
        model.dof_frictionloss[: self.n] = self.of_joints("coulomb_nm", 0.0) if friction else 0.0
        model.opt.gravity = tables.get("gravity_m_s2", (0.0, 0.0, -9.81))
        model.opt.timestep, model.opt.integrator = step_s, mujoco.mjtIntegrator.mjINT_RK4
        mujoco.mj_setConst(model, mujoco.MjData(model))
        return model

    def _ripple(self):
        """The torque that ripple takes from the motors, as a function of their position."""
        harmonics = [(axis, joint, part) for axis, joint in enumerate(self.joints) for part in joint.get("ripple", [])]
        axes = [axis for axis, _, _ in harmonics]
        cycles = np.array([abs(joint.get("gear_ratio", 1.0)) * part["cycles_per_motor_turn"] for _, joint, part in harmonics])
        phase = np.array([part.get("phase_rad", 0.0) for *_, part in harmonics])
        amplitudes = np.zeros((self.n, len(harmonics)))
        amplitudes[axes, np.arange(len(harmonics))] = [part["amplitude_nm"] for *_, part in harmonics]
        return lambda position: amplitudes @ np.sin(cycles * position[axes] + phase)

    def stand_at(self, position):
        """At rest with the motors there and the gears deflected by gravity; returns the torques that hold it."""
        mujoco.mj_resetData(self.model, self.data)
        torque = np.zeros(self.n)
        for _ in range(20):  # deflections are small: each round gains two digits
            self.data.qpos[:] = np.concatenate([position, position - torque / self.model.tendon_stiffness])
            mujoco.mj_forward(self.model, self.data)
            torque = self.data.qfrc_bias[self.n :].copy()
        return torque

    def play(self, position, velocity):
        """Follows a reference of the motors, (joint, sample) at the controller's rate, from rest at its first position.

        Returns torque, velocity and position of the motors: what the controller read and asked for at each of its samples.
        """
        loop, n, limit = self.loop, self.n, self.max_torque_nm
        integral, integral_step = self.stand_at(position[:, 0]), loop.integral_gain_nm_per_rad * loop.sample_time_s
        u, y, q = (np.empty((position.shape[1], n)) for _ in range(3))
        for k, (p, v) in enumerate(zip(position.T, velocity.T)):
            q[k], y[k] = self.data.qpos[:n], self.data.qvel[:n]
            error = v + loop.position_gain_per_s * (p - q[k]) - y[k]
            u[k] = loop.gain_nms_per_rad * error + integral
            is_free = abs(u[k]) < limit
            if not is_free.all():
                u[k] = np.clip(u[k], -limit, limit)
            integral = integral + integral_step * error * is_free
            self.data.ctrl[:] = u[k]
            if self.ripple:
                self.data.qfrc_applied[:n] = -self.ripple(q[k])
            mujoco.mj_step(self.model, self.data, self.n_steps)
        return u.T, y.T, q.T

    def truth(self, hz, position=None):
        """FRF from torque to velocity of the motors behind the controller's hold, (frequency, output, input).

        MuJoCo's own motion about rest at a position of the motors (the pose without it), without Coulomb friction and ripple.
        """
        phi, gamma = self._linear_step(self.pose_rad if position is None else position)
        z = np.exp(2j * np.pi * np.asarray(hz, float) * self.loop.sample_time_s)
        states = np.linalg.solve(z[:, None, None] * np.eye(len(phi)) - phi, gamma)
        return states[:, 2 * self.n : 3 * self.n]

    def _linear_step(self, position, small_state=1e-4, small_torque=1.0):
        """Matrices of x[k+1] = phi x[k] + gamma u[k] over a sample of the controller, by central differences."""
        friction = self.model.dof_frictionloss.copy()
        self.model.dof_frictionloss[:] = 0.0
        torque = self.stand_at(position)
        at = np.concatenate([self.data.qpos, self.data.qvel, torque])
        small = np.concatenate([np.full(4 * self.n, small_state), np.full(self.n, small_torque)])
        columns = [(self._step(at + dx) - self._step(at - dx)) / (2 * dx.max()) for dx in np.diag(small)]
        self.model.dof_frictionloss[:] = friction
        phi, gamma = np.split(np.array(columns).T, [4 * self.n], axis=1)
        return phi, gamma

    def _step(self, state_and_torque):
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:], self.data.qvel[:], self.data.ctrl[:] = np.split(state_and_torque, [2 * self.n, 4 * self.n])
        mujoco.mj_step(self.model, self.data, self.n_steps)
        return np.concatenate([self.data.qpos, self.data.qvel])

    def mass_matrix(self, link_position):
        """Of the links alone, as they are at a position."""
        self.data.qpos[self.n :] = link_position
        mujoco.mj_forward(self.model, self.data)
        rows = np.zeros((self.n, 2 * self.n))
        for row, unit in zip(rows, np.eye(2 * self.n)[self.n :]):
            mujoco.mj_mulM(self.model, self.data, row, unit)
        return rows[:, self.n :]


def add_rotor(spec, name, inertia_kg_m2, step_s):
    """A rotor on a stand; its friction is as abrupt as the step allows, or slow motion would feel it as viscous."""
    rotor = spec.worldbody.add_body(name=f"motor {name}", mass=1.0, inertia=[inertia_kg_m2] * 3, explicitinertial=True)
    abrupt = {"solref_friction": (2 * step_s, 1.0), "solimp_friction": (0.99, 0.999, 0.001, 0.5, 2.0)}
    rotor.add_joint(name=f"motor {name}", type=HINGE, axis=(0.0, 0.0, 1.0), **abrupt)


def add_links(spec, tables):
    """Bodies of a robot file in a chain, locked joints turned once and for all; their inertias are set_inertias'."""
    parent = spec.worldbody
    for body in tables["body"]:
        turned = Rotation.from_euler("xyz", body.get("rotation_rpy_rad", (0.0, 0.0, 0.0)))
        axis = np.array(body["axis"], float) / np.linalg.norm(body["axis"])
        turned *= Rotation.from_rotvec(body.get("locked_position_rad", 0.0) * axis)
        x, y, z, w = turned.as_quat()
        parent = parent.add_body(name=body["name"], pos=body.get("offset_m", (0.0, 0.0, 0.0)), quat=(w, x, y, z), **PLACEHOLDER)
        if "joint" in body:
            parent.add_joint(name=body["name"], type=HINGE, axis=axis)
    if "payload" in tables:
        parent.add_body(name="payload", **PLACEHOLDER)


def set_inertias(model, tables):
    """Inertias of a robot file for the bodies of its compiled chain."""
    for body in tables["body"]:
        set_inertia(model, **body)
    if "payload" in tables:
        set_inertia(model, "payload", **tables["payload"])


def set_inertia(model, name, mass_kg, center_of_mass_m=(0.0, 0.0, 0.0), inertia_kg_m2={}, **_):
    xx, yy, zz, xy, xz, yz = (inertia_kg_m2.get(entry, 0.0) for entry in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"))
    principal, axes = np.linalg.eigh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    axes[:, 0] *= np.linalg.det(axes)  # right-handed
    k = model.body(name).id
    x, y, z, w = Rotation.from_matrix(axes).as_quat()
    model.body_mass[k], model.body_ipos[k] = mass_kg, center_of_mass_m
    model.body_inertia[k], model.body_iquat[k] = principal, (w, x, y, z)
    model.body_sameframe[k] = model.body_simple[k] = 0  # shortcuts the compiler may have taken for its placeholder
