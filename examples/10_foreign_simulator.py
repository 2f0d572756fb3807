"""Lesson 10: somebody else's simulator on the bench. A two-axis arm with elastic gears in MuJoCo, its controller in Python.

Needs MuJoCo: pip install mujoco
Run: python examples/10_foreign_simulator.py
"""

import mujoco
import numpy as np

import frfid

T = 1e-3

# Each rotor turns on a stand of its own; a tendon of length (motor position - link position) is the elastic gear.
ARM = """
<mujoco>
  <option timestep="0.0002" integrator="implicitfast" gravity="0 0 -9.81"/>
  <default><joint type="hinge" axis="0 1 0"/></default>
  <worldbody>
    <body><joint name="motor_1"/><inertial pos="0 0 0" mass="1" diaginertia="30 30 30"/></body>
    <body><joint name="motor_2"/><inertial pos="0 0 0" mass="1" diaginertia="10 10 10"/></body>
    <body><joint name="link_1"/><inertial pos="0 0 0.4" mass="60" diaginertia="4 4 1"/>
      <body pos="0 0 0.8"><joint name="link_2"/><inertial pos="0.4 0 0" mass="40" diaginertia="1 3 3"/></body>
    </body>
  </worldbody>
  <tendon>
    <fixed stiffness="3e5" damping="300"><joint joint="motor_1" coef="1"/><joint joint="link_1" coef="-1"/></fixed>
    <fixed stiffness="1e5" damping="100"><joint joint="motor_2" coef="1"/><joint joint="link_2" coef="-1"/></fixed>
  </tendon>
  <actuator><motor joint="motor_1"/><motor joint="motor_2"/></actuator>
</mujoco>
"""


class MujocoArm:
    """Anything with run(run) -> Record is a testbed: here a PI controller of the motors' velocity around mj_step."""

    gain = np.array([2000.0, 600.0])  # N m s/rad
    integral_gain = 8.0 * gain  # N m/rad

    def __init__(self):
        self.model = mujoco.MjModel.from_xml_string(ARM)
        self.data = mujoco.MjData(self.model)
        self.steps = round(T / self.model.opt.timestep)

    def hold_still(self):
        """At position 0 of the links with the gears deflected by gravity; returns the torques that hold it there."""
        mujoco.mj_resetData(self.model, self.data)
        mujoco.mj_forward(self.model, self.data)
        torque = self.data.qfrc_bias[2:].copy()
        self.data.qpos[:2] = torque / self.model.tendon_stiffness
        return torque

    def run(self, run):
        integral = self.hold_still()
        u, y, position = (np.empty(run.reference.shape) for _ in range(3))
        for k, r in enumerate(run.reference.T):
            y[:, k], position[:, k] = self.data.qvel[:2], self.data.qpos[:2]
            error = r - y[:, k]
            self.data.ctrl[:] = u[:, k] = self.gain * error + integral
            integral = integral + self.integral_gain * T * error
            mujoco.mj_step(self.model, self.data, self.steps)
        return frfid.Record(sample_time_s=T, u=u, y=y, r=run.reference, position_rad=position)

    def truth(self, hz):
        """MuJoCo's own linearisation: the FRF from torque to motor velocity behind a hold, (frequency, output, input)."""
        n = 2 * self.model.nv
        a, b = np.empty((n, n)), np.empty((n, 2))
        self.data.ctrl[:] = self.hold_still()
        mujoco.mjd_transitionFD(self.model, self.data, 1e-6, True, a, b, None, None)
        phi, gamma = np.eye(n), np.zeros((n, 2))
        for _ in range(self.steps):
            phi, gamma = a @ phi, a @ gamma + b
        z = np.exp(2j * np.pi * np.asarray(hz) * T)
        states = np.linalg.solve(z[:, None, None] * np.eye(n) - phi, gamma)
        return states[:, self.model.nv : self.model.nv + 2]


robot = MujocoArm()
chirp = frfid.Chirp(low_hz=2.0, high_hz=50.0, duration_s=8.0, amplitude=[120.0, 40.0], fade_s=0.3, tail_s=1.0)
desired = chirp.sample(sample_time_s=T, n_inputs=2, mimo="sign-flip")
start = desired * np.array([[1e-4], [3e-4]])  # rad/s per N m: a reference that is small enough to be safe

shaped = frfid.shape(
    robot, desired=desired, start=start, sample_time_s=T, high_hz=50.0, max_velocity_rad_s=0.5, max_travel_rad=0.07
)
print(shaped)

u, y = (np.stack([getattr(rec, signal) for rec in shaped.records]) for signal in ("u", "y"))
for axis, (asked, reached) in enumerate(zip(np.ptp(desired, axis=(0, 2)) / 2, np.ptp(u, axis=(0, 2)) / 2), 1):
    print(f"axis {axis}: torque amplitude {reached:.0f} N m, desired {asked:.0f} N m")
hz = np.geomspace(2.5, 45.0, 60)
frf = frfid.estimate_chirp(u, y, chirp=chirp, sample_time_s=T, frequencies_hz=hz)
error = 20 * np.log10(np.abs(frf.response / robot.truth(hz)))
print(f"FRF from the shaped chirps against MuJoCo's own linearisation: median error {np.median(np.abs(error)):.2f} dB")

axes = frf.plot.bode(label="from the shaped chirps")
names = {"input_names": ["motor_1 torque", "motor_2 torque"], "output_names": ["motor_1 velocity", "motor_2 velocity"]}
units = {"input_units": ["N m"] * 2, "output_units": ["rad/s"] * 2}
exact = frfid.Frf(frequency_hz=hz, response=robot.truth(hz), **names, **units)
exact.plot.bode(ax=axes, label="MuJoCo's linearisation", color="black", linestyle="-", marker="none")
axes[0, 0].figure.savefig("10_foreign_simulator.svg")
print("10_foreign_simulator.svg: both, entry by entry")
