"""Lesson 8: an arm has a matrix for an FRF, and another one at every pose (SK15 section 2; the Manutec r3).

Run: python examples/08_arm.py
"""

import pathlib

import numpy as np

import frfid

T = 1e-3
R3 = pathlib.Path(__file__).parent / "robots" / "manutec_r3.toml"
arm = frfid.Plant.load(R3)
degrees = ", ".join(f"{angle:.0f}" for angle in np.degrees(arm.pose_rad))
gravity = ", ".join(f"{torque:.1f}" for torque in np.abs(arm.gravity_torque(arm.pose_rad)))
print(f"{arm.n_axes} axes at ({degrees}) deg; gravity asks for {gravity} N m")
print("elastic modes at", ", ".join(f"{hz:.2f}" for hz in arm.modes_hz()), "Hz,", end=" ")
print("with the motors locked at", ", ".join(f"{hz:.2f}" for hz in arm.modes_hz(motors_locked=True)), "Hz")

upright = frfid.Plant.load(R3, pose_rad=[0.0, 0.0, 0.0])
print("stretched upwards instead at", ", ".join(f"{hz:.2f}" for hz in upright.modes_hz()), "Hz: stay within a few degrees")

hz = np.array([2.0, 10.0, 60.0])
truth = arm.frf(hz, sample_time_s=T)
coupling = 20 * np.log10(np.abs(truth[:, 1, 2] / truth[:, 1, 1]))
print("a torque on axis 3 moves axis 2 by", ", ".join(f"{db:+.0f} dB" for db in coupling), "more than one on axis 2 does")
seen = arm.frf(hz, sample_time_s=T, sensor=True)
print(f"velocities by differencing lag by {-np.degrees(np.angle(seen[2, 0, 0] / truth[2, 0, 0])):.1f} deg at 60 Hz")

# A small excitation of an arm without friction, ripple and sensors under its controller finds this matrix.
linear = frfid.Plant.load(R3, challenges={"coulomb_friction": False, "torque_ripple": False, "sensing": False})
controller = frfid.PiController(
    gain=[1500.0, 1500.0, 400.0], integral_gain=[12000.0, 12000.0, 3200.0], sample_time_s=T
)
ms = frfid.Multisine.design(low_hz=2.0, high_hz=60.0, sample_time_s=T, resolution_hz=0.5, n_lines=40, grid="odd")
for peak in (1e-3, 1e-4):
    r = ms.realize(seed=1, n_inputs=3, peak=[peak, peak, 2 * peak], mimo="orthogonal")  # (experiment, input, sample), rad/s
    rec = frfid.run_closed_loop(linear, controller, np.tile(r, 3))
    last = np.s_[None, :, None, :, -ms.n_samples :]  # (realization, experiment, period, channel, sample)
    frf = frfid.estimate_bla(rec.u[last], rec.y[last], sample_time_s=T, harmonics=ms.harmonics)
    truth = linear.frf(frf.frequency_hz, sample_time_s=T)
    error = np.abs(frf.response - truth).max() / np.abs(truth).max()
    print(f"references up to {2 * peak:g} rad/s: the 3 x 3 FRF equals the truth to {error:.0e} of its peak")

hz = np.geomspace(2.0, 60.0, 300)
axes = upright.frf(hz, sample_time_s=T).plot.bode(label="stretched upwards, exact")
arm.frf(hz, sample_time_s=T).plot.bode(ax=axes, label="at its pose, exact", linestyle="-")
frf.plot.bode(ax=axes, label="at its pose, measured", linestyle="none")
for (row, column), panel in np.ndenumerate(axes[::2]):
    panel.set_title(f"torque {column + 1} → velocity {row + 1}")
    panel.set_ylabel("" if column else "Magnitude in dB\nre 1 rad/s per N m")
axes[0, 0].figure.savefig("08_arm.svg")
print("08_arm.svg: the matrix at both poses, nine Bode diagrams")
