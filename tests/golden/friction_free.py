"""Golden FRFs of the paper's joint without Coulomb friction, behind every hold, from scipy.signal.cont2discrete.

Columns of friction_free.txt: hold, viscous friction in N m s/rad, frequency in Hz, then real and imaginary part of the FRF from motor
torque to the motor velocity, and to the velocity by differencing positions, (q[k] - q[k-1])/T, at T = 1 ms.

Run:  python tests/golden/friction_free.py     (numpy, scipy)
"""

import pathlib

import numpy as np
from scipy.signal import cont2discrete

J_M, J_O, D, K, T = 35.0, 150.0, 400.0, 1.5e5, 1e-3
HZ = [0.5, 1.0, 5.0289, 11.6211, 20.0, 60.0, 123.4, 499.0]


def sampled(viscous, hold):
    """FRF of the velocity, and of the position times (1 - 1/z)/T."""
    a = np.array(
        [[0, 0, 1, 0], [0, 0, 1, -1], [0, -K / J_M, -(D + viscous) / J_M, D / J_M], [0, K / J_O, D / J_O, -D / J_O]]
    )
    b, c = np.array([[0], [0], [1 / J_M], [0]]), np.array([[0, 0, 1.0, 0], [1.0, 0, 0, 0]])
    z = np.exp(2j * np.pi * np.array(HZ) * T)
    if hold == "continuous":
        p, (a, b, c, d) = 2j * np.pi * np.array(HZ), (a, b, c, np.zeros((2, 1)))
    else:
        p, (a, b, c, d, _) = z, cont2discrete((a, b, c, np.zeros((2, 1))), T, hold)
    frf = np.array([(c @ np.linalg.solve(q * np.eye(4) - a, b) + d)[:, 0] for q in p])
    frf[:, 1] *= (1 - 1 / z) / T
    return frf


def main():
    lines = ["# hold viscous_nms_per_rad hz velocity_re velocity_im differenced_re differenced_im"]
    for hold, name in (("continuous", "continuous"), ("zoh", "zoh"), ("foh", "linear")):
        for viscous in (0.0, 30.0):
            for hz, (true, differenced) in zip(HZ, sampled(viscous, hold)):
                numbers = [viscous, hz, true.real, true.imag, differenced.real, differenced.imag]
                lines.append(" ".join([name] + [repr(float(x)) for x in numbers]))
    (pathlib.Path(__file__).parent / "friction_free.txt").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
