"""Golden numbers for graded matrices, by mpmath with 60 digits: writes pinv.json beside this file.

Run: python tests/golden/pinv.py   (needs mpmath). For every case U (n_u x n_ex), Y (n_y x n_ex), G = Y U^+ and the singular
values of U. Entries of U and Y are the doubles written; G and the singular values are right to the last digit.
"""

import json
import pathlib
import random

import mpmath as mp

mp.mp.dps = 60
random.seed(1)


def gauss(rows, columns):
    return mp.matrix([[mp.mpc(random.gauss(0, 1), random.gauss(0, 1)) for _ in range(columns)] for _ in range(rows)])


def rounded(matrix):
    """What is left in doubles: the case is defined by these."""
    return mp.matrix([[mp.mpc(complex(matrix[i, j])) for j in range(matrix.cols)] for i in range(matrix.rows)])


def diagonal(*values):
    return mp.diag([mp.mpf(v) for v in values])


def mixed():
    """Singular values 1, 1e-3, 1e-6 between two unitary matrices."""
    left, right = mp.qr(gauss(3, 3))[0], mp.qr(gauss(3, 3))[0]
    return left * diagonal(1, "1e-3", "1e-6") * right


CASES = {
    "inputs_graded": lambda: diagonal(1, "1e-3", "1e-6") * gauss(3, 3),
    "experiments_graded": lambda: gauss(3, 3) * diagonal("1e-6", "1e-3", 1),
    "both_graded": lambda: diagonal(1, "1e-3", "1e-6") * gauss(3, 3) * diagonal("1e-4", 1, "1e-2"),
    "more_experiments": lambda: diagonal("1e-6", "1e-3", 1) * gauss(3, 5) * diagonal("1e-3", 1, 1, "1e-2", 1),
    "mixed": mixed,
    "six_inputs": lambda: diagonal(1, 1, "1e-2", "1e-3", "1e-5", "1e-6") * gauss(6, 6),
}


def flat(matrix):
    return [part for i in range(matrix.rows) for j in range(matrix.cols) for part in (float(matrix[i, j].real), float(matrix[i, j].imag))]  # fmt: skip


def main():
    golden = []
    for name, make in CASES.items():
        u = rounded(make())
        # the FRF is graded against the inputs, as in life: every entry is then a number worth having
        size = [mp.sqrt(sum(abs(u[i, j]) ** 2 for j in range(u.cols))) for i in range(u.rows)]
        y = rounded(gauss(2, u.rows) * diagonal(*[1 / s for s in size]) * u)
        gram = u * u.H
        g = y * u.H * mp.inverse(gram)
        values = sorted((mp.sqrt(value) for value in mp.eigh(gram, eigvals_only=True)), reverse=True)
        golden.append({
            "case": name, "n_u": u.rows, "n_ex": u.cols, "u": flat(u), "y": flat(y), "g": flat(g),
            "singular_values": [float(value) for value in values],
        })  # fmt: skip
    rows = ",\n".join(json.dumps(entry) for entry in golden)
    pathlib.Path(__file__).with_suffix(".json").write_text(f"[\n{rows}\n]\n")


if __name__ == "__main__":
    main()
