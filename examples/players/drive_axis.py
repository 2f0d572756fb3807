"""A drive with one axis on a bench, simulated: plays an injected current on top of its velocity loop, and records like an oscilloscope.

    python drive_axis.py REFERENCE.csv LOG.csv
    frfid calls it as a command: --player "python examples/players/drive_axis.py"

Two masses and a shaft. The velocity loop turns the motor at 20 rad/s, so that it does not stick; the injected current is added to
what the loop asks for. LOG has columns of its own, semicolons, decimal commas, rpm, and a clock that is fast by 60 ppm.
Needs: pip install numpy scipy
"""

import sys

import numpy as np
from scipy.linalg import expm

STEP_S = 0.00025
MOTOR_KG_M2, LOAD_KG_M2, SHAFT_NM_PER_RAD, SHAFT_NMS_PER_RAD = 1e-3, 3e-3, 300.0, 0.03
TORQUE_NM_PER_A, COULOMB_NM = 0.6, 0.2
GAIN_A_S, INTEGRAL_GAIN_A = 0.1, 2.0  # current over velocity, and over its integral
TURNING_RAD_S = 20.0
OFFSET_MS, CLOCK_PPM = 8123.4, 60.0
NOISE_A, NOISE_RAD_S = 0.005, 0.01


def model():
    """Motion of (motor, load, twist) over a cycle: matrices of the state and of the torque that is held."""
    a = np.array([[0, 0, -SHAFT_NM_PER_RAD / MOTOR_KG_M2], [0, 0, SHAFT_NM_PER_RAD / LOAD_KG_M2], [1, -1, 0]], float)
    damping = SHAFT_NMS_PER_RAD * np.array([[-1, 1], [1, -1]])
    a[:2, :2] = damping / np.array([[MOTOR_KG_M2], [LOAD_KG_M2]])
    whole = np.zeros((4, 4))
    whole[:3, :3], whole[0, 3] = a, 1 / MOTOR_KG_M2
    step = expm(whole * STEP_S)
    return step[:3, :3], step[:3, 3]


def truth(hz):
    """FRF from current in A to motor velocity in rad/s."""
    state, torque = model()
    z = np.exp(2j * np.pi * np.asarray(hz) * STEP_S)
    return np.linalg.solve(z[:, None, None] * np.eye(3) - state, TORQUE_NM_PER_A * torque[:, None])[:, 0, 0]


def play(injected):
    """Current in A and velocity in rad/s of every cycle."""
    state, torque = model()
    x, integral = np.array([TURNING_RAD_S, TURNING_RAD_S, 0.0]), COULOMB_NM / TORQUE_NM_PER_A
    current, velocity = np.empty_like(injected), np.empty_like(injected)
    for k, added in enumerate(injected):
        velocity[k] = x[0]
        error = TURNING_RAD_S - x[0]
        integral += INTEGRAL_GAIN_A * error * STEP_S
        current[k] = GAIN_A_S * error + integral + added
        x = state @ x + torque * (TORQUE_NM_PER_A * current[k] - COULOMB_NM * np.sign(x[0]))
    return current, velocity


def main():
    reference, log = sys.argv[1:]
    table = np.loadtxt(reference, delimiter=",", skiprows=1)
    if abs(table[1, 1] - table[0, 1] - STEP_S) > 1e-9:
        sys.exit(f"{reference}: found a sample time of {table[1, 1] - table[0, 1]:g} s, needed {STEP_S:g} s, the drive's cycle")
    current, velocity = play(table[:, 3])
    chance = np.random.default_rng(int(1e6 * abs(table[:, 3]).sum()))
    measured = current + NOISE_A * chance.standard_normal(current.size)
    turned = velocity + NOISE_RAD_S * chance.standard_normal(velocity.size)
    time_ms = OFFSET_MS + 1e3 * STEP_S * (1 + 1e-6 * CLOCK_PPM) * np.arange(current.size)
    columns = np.column_stack([time_ms, table[:, 3], measured, turned * 30 / np.pi])
    rows = [";".join(f"{value:.6f}" for value in row).replace(".", ",") for row in columns]
    with open(log, "w", encoding="utf-8") as file:
        file.write("\n".join(["t [ms];Iq_add [A];Iq_act [A];n_act [rpm]", *rows, ""]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
