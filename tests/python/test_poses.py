"""FRFs at arrays of poses: those of the arm loaded at each of them, and those of numpy and scipy from its mass matrix."""

import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest
import scipy.signal

import frfid

ROBOTS = pathlib.Path(__file__).parents[2] / "examples" / "robots"
R3, SIX = ROBOTS / "manutec_r3.toml", ROBOTS / "six_axis_flexibility.toml"
T = 1e-3
HZ = np.geomspace(0.5, 200.0, 40)
WAYS = [
    dict(sample_time_s=T),
    dict(hold="linear", sample_time_s=T),
    dict(hold="continuous"),
    dict(hold="continuous", sample_time_s=T, sensor=True),
    dict(sample_time_s=T, sensor=True),
]


def poses(n, n_axes):
    return np.random.default_rng(1).uniform(-np.pi, np.pi, (n, n_axes))


@pytest.fixture(scope="module")
def r3():
    return frfid.Plant.load(R3)


@pytest.mark.parametrize("file, challenges", [(R3, {}), (SIX, {}), (R3, {"position_dependence": False})])
@pytest.mark.parametrize("way", WAYS)
def test_every_pose_is_that_of_the_arm_loaded_there(file, challenges, way):
    arm = frfid.Plant.load(file, challenges=challenges)
    q = poses(5, arm.n_axes)
    found = arm.frf_at(q, HZ, **way)
    assert found.shape == (5, len(HZ), arm.n_axes, arm.n_axes) and found.dtype == complex and found.flags.c_contiguous
    for pose, response in zip(q, found, strict=True):
        alone = frfid.Plant.load(file, challenges=challenges, pose_rad=pose.tolist()).frf(HZ, **way).response
        assert alone.tobytes() == response.tobytes() == arm.frf_at(pose, HZ, **way).tobytes()
    assert not np.allclose(found[0], found[1])
    assert arm.frf_at(arm.pose_rad, HZ, **way).tobytes() == arm.frf(HZ, **way).response.tobytes()


def state_space(arm, joints, q):
    """States motor positions, link positions and their velocities; gears within their knees, gravity pulls at the links."""
    of = lambda name: np.diag([joint.get(name, 0.0) for joint in joints])
    n, stiffness, damping = len(q), of("stiffness_nm_per_rad"), of("damping_nms_per_rad")
    motor, links = np.linalg.inv(of("motor_inertia_kg_m2")), np.linalg.inv(arm.mass_matrix(q))
    h = 1e-4 * np.eye(n)
    gradient = ((arm.gravity_torque(q + h) - arm.gravity_torque(q - h)) / 2e-4).T
    a, b = np.zeros((4 * n, 4 * n)), np.zeros((4 * n, n))
    a[: 2 * n, 2 * n :] = np.eye(2 * n)
    a[2 * n : 3 * n] = motor @ np.hstack([-stiffness, stiffness, -damping - of("viscous_nms_per_rad"), damping])
    a[3 * n :] = links @ np.hstack([stiffness, -stiffness - gradient, damping, -damping])
    b[2 * n : 3 * n] = motor
    return a, b, np.eye(4 * n)[2 * n : 3 * n]


@pytest.mark.parametrize("hold, method", [("continuous", None), ("zoh", "zoh"), ("linear", "foh")])
def test_every_pose_is_that_of_scipy_from_mass_matrix_and_gears(hold, method):
    tomllib = pytest.importorskip("tomllib", reason="robot files are read with Python 3.11's tomllib")
    joints = [body["joint"] for body in tomllib.loads(R3.read_text())["body"] if "joint" in body]
    arm = frfid.Plant.load(R3, challenges={"stiffening": False})
    q, p = poses(20, 3), 2j * np.pi * HZ
    found = arm.frf_at(q, HZ, hold=hold, sample_time_s=T)
    for pose, response in zip(q, found, strict=True):
        a, b, c = state_space(arm, joints, pose)
        d = np.zeros((3, 3))
        if method:
            a, b, c, d, _ = scipy.signal.cont2discrete((a, b, c, d), T, method)
        at = p if method is None else np.exp(p * T)
        expected = c @ np.linalg.solve(at[:, None, None] * np.eye(12) - a, b[None]) + d
        np.testing.assert_allclose(response, expected, rtol=0, atol=1e-7 * np.abs(expected).max())


def test_shapes_and_arrays_of_any_kind(r3):
    q = poses(4, 3)
    expected = r3.frf_at(q, HZ, sample_time_s=T)
    for same in (q.tolist(), np.asfortranarray(q), np.repeat(q, 2, axis=0)[::2], q.astype(">f8")):
        np.testing.assert_array_equal(r3.frf_at(same, HZ, sample_time_s=T), expected)
    single = q.astype(np.float32)
    np.testing.assert_array_equal(
        r3.frf_at(single, HZ, sample_time_s=T), r3.frf_at(single.astype(float), HZ, sample_time_s=T)
    )
    assert r3.frf_at(np.zeros(3, dtype=int), HZ, sample_time_s=T).shape == (40, 3, 3)
    assert r3.frf_at(np.zeros((0, 3)), HZ, sample_time_s=T).shape == (0, 40, 3, 3)
    assert r3.frf_at(q[:1], [5.0], sample_time_s=T).shape == (1, 1, 3, 3)


@pytest.mark.parametrize(
    "call, says",
    [
        (lambda r3: frfid.Plant.single_joint().frf_at([0.0], HZ, sample_time_s=T), "a single joint is no arm"),
        (lambda r3: r3.frf_at([0.0, 0.0], HZ, sample_time_s=T), r"q has shape \[2\], needed \(3\) or \(batch, 3\)"),
        (lambda r3: r3.frf_at(np.zeros((2, 2, 3)), HZ, sample_time_s=T), r"q has .* shape \(2, 2, 3\)"),
        (lambda r3: r3.frf_at([[0, 0, 0], [0, np.nan, 0]], HZ, sample_time_s=T), r"q is NaN at \[1, 1\], needed finite"),
        (lambda r3: r3.frf_at([0, 0, -np.inf], HZ, sample_time_s=T), r"q is -inf at \[2\], needed finite"),
        (lambda r3: r3.frf_at(np.zeros(3, dtype=complex), HZ, sample_time_s=T), "q has dtype complex128"),
        (lambda r3: r3.frf_at([0, 0, 0], HZ), "sample_time_s is needed by a hold"),
        (lambda r3: r3.frf_at([0, 0, 0], HZ, sample_time_s=-T), "sample_time_s is -0.001"),
        (lambda r3: r3.frf_at([0, 0, 0], [1.0, -2.0], sample_time_s=T), "hz is -2"),
        (lambda r3: r3.frf_at([0, 0, 0], [[1.0]], sample_time_s=T), r"hz has .* shape \(1, 1\)"),
        (lambda r3: r3.frf_at([0, 0, 0], HZ, sample_time_s=T, hold="none"), "hold: unknown variant `none`"),
        (lambda r3: r3.mass_matrix([0.0, np.nan, 0.0]), r"q is NaN at \[1\], needed finite"),
    ],
)
def test_what_does_not_fit_is_refused(r3, call, says):
    with pytest.raises(ValueError, match=says):
        call(r3)


def test_more_than_can_be_held_is_refused(r3):
    with pytest.raises(MemoryError):
        r3.frf_at(np.zeros((10**6, 3)), np.arange(1, 10**6), sample_time_s=T)


THREADS = """
import hashlib, sys
sys.path.insert(0, {folder!r})
import frfid, test_poses as here
print(hashlib.sha256(frfid.Plant.load(here.SIX).frf_at(here.poses(40, 6), here.HZ, sample_time_s=1e-3).tobytes()).hexdigest())
"""


def test_threads_change_no_digit():
    script = THREADS.format(folder=str(pathlib.Path(__file__).parent))
    hash_on = lambda n: subprocess.run(
        [sys.executable, "-c", script], env={**os.environ, "RAYON_NUM_THREADS": n}, capture_output=True, text=True, check=True
    ).stdout
    assert len({hash_on(n) for n in "123"}) == 1


INTERRUPTED = """
import sys, threading, time
sys.path.insert(0, {folder!r})
import _thread, frfid, test_poses as here
six, q = frfid.Plant.load(here.SIX), here.poses(100_000, 6)
began = time.monotonic()
six.frf_at(q[:2_000], [5.0], sample_time_s=1e-3)
whole_s = 50 * (time.monotonic() - began)
threading.Timer(whole_s / 20, _thread.interrupt_main).start()
began = time.monotonic()
try:
    six.frf_at(q, [5.0], sample_time_s=1e-3)
except KeyboardInterrupt:
    print((time.monotonic() - began) / whole_s)
"""


def test_ctrl_c_ends_it():
    script = INTERRUPTED.format(folder=str(pathlib.Path(__file__).parent))
    environment = {**os.environ, "RAYON_NUM_THREADS": "1"}  # takes some seconds so
    done = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=True)
    assert float(done.stdout) < 0.5  # of the time of the whole
