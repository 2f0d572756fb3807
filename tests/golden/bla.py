"""Golden numbers for the best linear approximation, by numpy: writes bla.json beside this file.

Run: python tests/golden/bla.py   (numpy only). tests/bla.rs makes the same signals from the same formula.
"""

import json
import pathlib

import numpy as np

PRIME = 1_000_003

# name: n_p, n_ex, n_q, n_u, n_y, samples per period, lines
CASES = {
    "three_by_two": (3, 3, 2, 3, 2, 2500, [1, 11, 250, 1249]),
    "more_experiments_than_inputs": (2, 4, 3, 2, 3, 19838, [3, 1000, 9918]),
    "one_realization": (1, 1, 5, 1, 1, 8192, [41, 307, 4095]),
    "one_period": (4, 2, 1, 2, 2, 12288, [13, 737, 6143]),
}


def noise(*indices):
    """Numbers in [-0.5, 0.5) out of integer arithmetic alone: a hash of the flat index, the same in every language."""
    k = np.asarray(indices[0], dtype=np.int64)
    for index in indices[1:]:
        k = (k * 31 + np.asarray(index, dtype=np.int64) * 7919 + 17) % PRIME
        k = (k * k + 12345) % PRIME
    k = (k * k * 3 + 5 * k + 1) % PRIME
    return k / PRIME - 0.5


def signal(kind, shape):
    """(realization, experiment, period, channel, sample): what repeats every period plus a tenth of what does not."""
    p, m, q, c, k = np.ogrid[tuple(slice(n) for n in shape)]
    return noise(kind, p, m, c, k) + 0.1 * noise(kind + 10, p, m, q, c, k) + 3.0


def vec(matrix):
    return matrix.T.reshape(-1)


def covariance_of_mean(samples):
    samples = np.array(samples)
    n = len(samples)
    deviation = samples - samples.mean(axis=0)
    return np.einsum("qi,qj->ij", deviation, deviation.conj()) / (n * (n - 1))


def block_average(blocks):
    """Mean and covariances of the FRFs blocks[p][q]."""
    per_realization = [np.mean(periods, axis=0) for periods in blocks]
    n_p, n_q = len(blocks), len(blocks[0])
    noise_covariance = total = None
    if n_q > 1:
        noise_covariance = sum(covariance_of_mean([vec(g) for g in periods]) for periods in blocks) / n_p**2
    if n_p > 1:
        total = covariance_of_mean([vec(g) for g in per_realization])
    return np.mean(per_realization, axis=0), noise_covariance, total


def mean_of_frfs(u, y):
    n_p, n_q = u.shape[:2]
    g = [[y[p, q] @ np.linalg.pinv(u[p, q]) for q in range(n_q)] for p in range(n_p)]
    condition = max(np.linalg.cond(u[p, q]) for p in range(n_p) for q in range(n_q))
    return *block_average(g), condition


def mean_of_spectra(u, y):
    n_p, n_q = u.shape[:2]
    mean_u, mean_y = u.mean(axis=1), y.mean(axis=1)
    g = [mean_y[p] @ np.linalg.pinv(mean_u[p]) for p in range(n_p)]
    terms = [[g[p] + (y[p, q] - g[p] @ u[p, q]) @ np.linalg.pinv(mean_u[p]) for q in range(n_q)] for p in range(n_p)]
    mean, noise_covariance, total = block_average(terms)
    return np.mean(g, axis=0), noise_covariance, total, max(np.linalg.cond(mean_u[p]) for p in range(n_p))


def logarithmic_mean(u, y):
    """Means of log magnitude and of the phase around that of the arithmetic mean."""
    n_p, n_q = u.shape[:2]
    g = np.array([[y[p, q] @ np.linalg.pinv(u[p, q]) for q in range(n_q)] for p in range(n_p)])
    centre = np.angle(g.mean(axis=(0, 1)))
    magnitude, phase = np.log(np.abs(g)), np.angle(g * np.exp(-1j * centre))
    mean = np.exp(magnitude.mean(axis=(0, 1)) + 1j * (centre + phase.mean(axis=(0, 1))))
    spread = magnitude - magnitude.mean(axis=(0, 1)) + 1j * (phase - phase.mean(axis=(0, 1)))
    _, noise_covariance, total = block_average(mean * (1 + spread))
    return mean, noise_covariance, total, np.linalg.cond(u).max()


def joint_input_output(u, y, r):
    n_p, n_q = u.shape[:2]
    r_h = r.conj().swapaxes(-1, -2)
    s_u, s_y = (u @ r_h).sum(axis=(0, 1)), (y @ r_h).sum(axis=(0, 1))
    inverse = np.linalg.inv(s_u)
    g = s_y @ inverse
    d = np.array([[vec((y[p, q] - g @ u[p, q]) @ r_h[p, q] @ inverse) for q in range(n_q)] for p in range(n_p)])
    noise_covariance = total = None
    if n_q > 1:
        e = d - d.mean(axis=1, keepdims=True)
        noise_covariance = n_q / (n_q - 1) * np.einsum("pqi,pqj->ij", e, e.conj())
    if n_p > 1:
        # residuals freed of the leverage that a realization has by its reference
        z = r.mean(axis=1)
        z_h = z.conj().swapaxes(-1, -2)
        leverage = n_q * z_h @ np.linalg.inv(n_q * (z @ z_h).sum(axis=0)) @ z
        residual = (y - g @ u).mean(axis=1)
        weight = r_h.sum(axis=1) @ inverse
        errors = [vec(residual[p] @ inverse_root(np.eye(len(leverage[p])) - leverage[p]) @ weight[p]) for p in range(n_p)]
        total = np.einsum("pi,pj->ij", errors, np.conj(errors))
    scale = np.sqrt((np.abs(r) ** 2).sum(axis=(0, 1, 3)))
    return g, noise_covariance, total, np.linalg.cond(s_u / scale)


def inverse_root(matrix):
    """(matrix)^-1/2 of a Hermitian matrix, by its eigenvalues."""
    values, vectors = np.linalg.eigh(matrix)
    return vectors / np.sqrt(values) @ vectors.conj().T


def least_squares(u, y):
    """One division by the mean inputs of all realizations; the total covariance from residuals freed of their leverage."""
    n_p = len(u)
    mean_u, mean_y = u.mean(axis=1), y.mean(axis=1)
    inverse = np.linalg.pinv(np.hstack(mean_u))
    g, weights = np.hstack(mean_y) @ inverse, np.split(inverse, n_p)
    _, noise_covariance, _ = block_average([[n_p * (y_pq - g @ u_pq) @ w for y_pq, u_pq in zip(y[p], u[p])] for p, w in enumerate(weights)])
    total = None
    if n_p > 1:
        leverage = [inverse_root(np.eye(w.shape[0]) - w @ mean_u[p]) for p, w in enumerate(weights)]
        errors = [vec((mean_y[p] - g @ mean_u[p]) @ leverage[p] @ w) for p, w in enumerate(weights)]
        total = np.einsum("pi,pj->ij", errors, np.conj(errors))
    return g, noise_covariance, total, np.linalg.cond(np.hstack(mean_u))


def weights_of(method, u, r):
    """What the noise of a realization is multiplied by, (realization, experiment, input)."""
    mean_u = u.mean(axis=1)
    if method == "least squares":
        return np.split(np.linalg.pinv(np.hstack(mean_u)), len(u))
    if method == "indirect":
        r_h = r.conj().swapaxes(-1, -2)
        return r_h.sum(axis=1) @ np.linalg.inv((u @ r_h).sum(axis=(0, 1)))
    return np.linalg.pinv(mean_u)


def noise_freedom(method, u, r):
    """Degrees of freedom by Welch and Satterthwaite, over all lines; realizations that are nearly alike count as alike."""
    n_p, n_q = u.shape[1:3]
    parts = np.array([np.square(np.abs(weights_of(method, u[k], r[k]))).sum(axis=-2) for k in range(len(u))])
    freedom = (n_q - 1) / np.mean(np.square(parts).sum(axis=1) / np.square(parts.sum(axis=1)))
    return float(freedom) if freedom < 0.95 * n_p * (n_q - 1) else float(n_p * (n_q - 1))


def numbers(array):
    """Row-major list re, im, re, im, ...; None stays None."""
    if array is None or array[0] is None:
        return None
    array = np.ascontiguousarray(array, dtype=complex)
    return array.view(float).ravel().tolist()


def main():
    golden = []
    for name, (n_p, n_ex, n_q, n_u, n_y, n, lines) in CASES.items():
        u, y, r = (signal(kind, (n_p, n_ex, n_q, c, n)) for kind, c in ((1, n_u), (2, n_y), (3, n_u)))
        # (line, realization, period, channel, experiment)
        u, y, r = (np.fft.fft(x)[..., lines].transpose(4, 0, 2, 3, 1) for x in (u, y, r))
        methods = {
            "frfs": [mean_of_frfs(u[k], y[k]) for k in range(len(lines))],
            "spectra": [mean_of_spectra(u[k], y[k]) for k in range(len(lines))],
            "logarithmic": [logarithmic_mean(u[k], y[k]) for k in range(len(lines))],
            "least squares": [least_squares(u[k], y[k]) for k in range(len(lines))],
            "indirect": [joint_input_output(u[k], y[k], r[k]) for k in range(len(lines))],
        }
        for method, results in methods.items():
            response, noise_covariance, total, condition = zip(*results)
            golden.append({
                "case": name, "method": method,
                "n_p": n_p, "n_ex": n_ex, "n_q": n_q, "n_u": n_u, "n_y": n_y, "n_samples": n, "lines": lines,
                "response": numbers(response), "noise": numbers(noise_covariance), "total": numbers(total),
                "noise_freedom": noise_freedom(method, u, r), "condition": [float(c) for c in condition],
            })  # fmt: skip
    rows = ",\n".join(json.dumps(entry) for entry in golden)
    pathlib.Path(__file__).with_suffix(".json").write_text(f"[\n{rows}\n]\n")


if __name__ == "__main__":
    main()
