"""Arms in Python: robot files, poses, challenges, the linear loop, and what is refused."""

import copy
import pathlib
import pickle

import numpy as np
import pytest
import scipy.signal

import frfid

ROBOTS = pathlib.Path(__file__).parents[2] / "examples" / "robots"
R3 = ROBOTS / "manutec_r3.toml"
T = 1e-3
LINEAR = {"coulomb_friction": False, "torque_ripple": False, "sensing": False}


def pi(**others):
    return frfid.PiController(gain=[1500.0, 1500.0, 400.0], integral_gain=[12e3, 12e3, 3200.0], sample_time_s=T, **others)


@pytest.fixture(scope="module")
def r3():
    return frfid.Plant.load(R3)


def test_a_robot_file_says_how_many_axes_there_are(r3):
    assert (r3.n_axes, r3.joint_names) == (3, ["joint_1", "joint_2", "joint_3"])
    np.testing.assert_allclose(np.degrees(r3.pose_rad), [-60.0, 20.0, 90.0])
    assert "3 axes (joint_1, joint_2, joint_3)" in repr(r3)
    six = frfid.Plant.load(ROBOTS / "six_axis_flexibility.toml")
    assert six.n_axes == len(six.pose_rad) == 6 and six.frf([5.0], sample_time_s=T).shape == (1, 6, 6)
    single = frfid.Plant.single_joint()
    assert (single.n_axes, single.pose_rad, single.joint_names) == (1, [0.0], ["joint_1"])


def test_gravity_and_modes_of_the_r3(r3):
    np.testing.assert_allclose(r3.gravity_torque(r3.pose_rad), [0.0, -460.57, -256.40], atol=0.005)
    mass = r3.mass_matrix(r3.pose_rad)
    mujoco = [[77.928, -4.740, -0.472], [-4.740, 74.855, 29.069], [-0.472, 29.069, 20.264]]  # and see test_multibody.py
    np.testing.assert_allclose(mass, mujoco, atol=0.0005)
    stiffness, motor = np.diag([474075.0, 352800.0, 208800.0]), np.diag([14.3325, 57.33, 4.68])
    locked = np.sqrt(scipy.linalg.eigh(stiffness, mass, eigvals_only=True)) / (2 * np.pi)
    np.testing.assert_allclose(r3.modes_hz(motors_locked=True), locked, rtol=1e-9)
    mobility = np.linalg.inv(mass) + np.linalg.inv(motor)
    elastic = np.sqrt(np.sort(np.linalg.eigvals(mobility @ stiffness).real)) / (2 * np.pi)
    np.testing.assert_allclose(r3.modes_hz(), elastic, rtol=1e-9)


def test_pose_and_challenges_make_another_plant(r3):
    assert frfid.Plant.load(R3) == r3 == frfid.Plant.load(R3, pose_rad=r3.pose_rad)
    upright = frfid.Plant.load(R3, pose_rad=[0.0, 0.0, 0.0])
    assert upright != r3 and upright.modes_hz() != r3.modes_hz()
    weightless = frfid.Plant.load(R3, challenges={"gravity": False})
    assert weightless != r3 and not weightless.gravity_torque(r3.pose_rad).any()
    held = r3.simulate(np.zeros((3, 3)), sample_time_s=T)
    np.testing.assert_allclose(held.u[:, 0], r3.gravity_torque(r3.pose_rad), atol=2.0)  # measured, with quanta and noise


def test_pickles_are_equal(r3):
    six = frfid.Plant.load(ROBOTS / "six_axis_flexibility.toml", challenges=LINEAR)
    controller = pi(position_gain=2.0, max_torque_rate_nm_per_s=[1e4, 2e4, 3e4], max_torque_nm=500.0)
    for thing in (r3, six, controller):
        assert pickle.loads(pickle.dumps(thing)) == thing == copy.copy(thing)
    assert frfid.Plant.from_toml(six.to_toml()) == six != r3
    assert controller.max_torque_nm == [500.0] * 3 and controller.position_gain == [2.0] * 3
    assert pi().position_gain is None and pi() != controller


def test_the_loop_is_made_of_plant_and_controller(r3):
    hz, controller = np.array([2.0, 12.0, 60.0]), pi(delay_samples=1)
    frfs = frfid.loop_frf(r3, controller, hz)
    plant = r3.frf(hz, sample_time_s=T, sensor=True).response
    z = np.exp(2j * np.pi * hz * T)[:, None, None]
    control = (np.diag(controller.gain) + np.diag(controller.integral_gain) * T / (z - 1)) / z
    sensitivity = np.linalg.inv(np.eye(3) + plant @ control)
    for name, expected in (
        ("u_to_y", plant),
        ("sensitivity", sensitivity),
        ("r_to_u", control @ sensitivity),
        ("r_to_y", plant @ control @ sensitivity),
    ):
        np.testing.assert_allclose(frfs[name].response, expected, rtol=1e-9, err_msg=name)


def test_a_small_experiment_in_closed_loop_finds_the_loop_and_the_plant():
    plant, controller = frfid.Plant.load(R3, challenges=LINEAR), pi()
    ms = frfid.Multisine.design(low_hz=2.0, high_hz=60.0, sample_time_s=T, resolution_hz=1.0, n_lines=20)
    r = np.tile(ms.realize(seed=1, n_inputs=3, peak=[1e-5, 1e-5, 2e-5]), 4)
    record = frfid.run_closed_loop(plant, controller, r)
    last = np.s_[None, :, None, :, -ms.n_samples :]
    truth = frfid.loop_frf(plant, controller, ms.lines_hz)
    for name, u, y in (("u_to_y", record.u, record.y), ("r_to_u", record.r, record.u), ("r_to_y", record.r, record.y)):
        found = frfid.estimate_bla(u[last], y[last], sample_time_s=T, harmonics=ms.harmonics).response
        error = np.abs(found - truth[name].response).max() / np.abs(truth[name].response).max()
        assert error < 1e-5, (name, error)


def test_a_glide_is_taken_off_a_run(r3):
    velocity, controller = [0.05, 0.05, 0.1], pi()
    ms = frfid.Multisine.design(low_hz=2.0, high_hz=60.0, sample_time_s=T, resolution_hz=1.0, n_lines=20)
    ride = np.repeat(np.array(velocity)[:, None], ms.n_samples, axis=1)
    glide = frfid.run_closed_loop(r3, controller, ride, velocity_rad_s=velocity)
    run = frfid.run_closed_loop(r3, controller, ride + ms.realize(seed=1, n_inputs=3, peak=0.01)[0], velocity_rad_s=velocity)
    rest = frfid.subtract_glide(run, glide)
    np.testing.assert_array_equal(rest.u, run.u - glide.u)
    assert abs(rest.y.mean()) < 1e-3 and abs(rest.u[1].mean()) < 0.1 * abs(run.u[1].mean())
    truth = r3.frf(ms.lines_hz, sample_time_s=T, sensor=True)
    by_position = frfid.subtract_glide(run, glide, by="position", plant=truth)
    np.testing.assert_array_equal(by_position.y, rest.y)
    assert 0.0 < np.abs(by_position.u - rest.u).max() < 20.0
    with pytest.raises(ValueError, match="plant is needed"):
        frfid.subtract_glide(run, glide, by="position")
    with pytest.raises(ValueError, match="by: unknown variant `place`"):
        frfid.subtract_glide(run, glide, by="place")
    with pytest.raises(ValueError, match="turn|direction|other way"):
        frfid.subtract_glide(run, frfid.run_closed_loop(r3, controller, -ride, velocity_rad_s=[-v for v in velocity]))


def test_the_spectrogram_is_scipy_s():
    x = np.random.default_rng(1).normal(size=(2, 3000))
    frequency, time, density = frfid.spectrogram(x, sample_time_s=T, window_s=0.5, step_s=0.1)
    f, t, expected = scipy.signal.spectrogram(x, 1 / T, "hann", nperseg=500, noverlap=400, detrend=False)
    np.testing.assert_allclose(frequency, f)
    np.testing.assert_allclose(time, t)
    np.testing.assert_allclose(density, expected, rtol=1e-9)


@pytest.mark.parametrize(
    "call, says",
    [
        (lambda r3: frfid.Plant.single_joint().modes_hz(), "a single joint is no arm"),
        (lambda r3: frfid.Plant.single_joint().mass_matrix([0.0]), "a single joint is no arm"),
        (lambda r3: frfid.Plant.load(ROBOTS / "paper_joint.toml", pose_rad=[0.0]), "a single joint has no pose"),
        (lambda r3: frfid.Plant.load(R3, pose_rad=[0.0]), "pose_rad"),
        (lambda r3: frfid.Plant.load(R3, pose_rad=[0.0, np.nan, 0.0]), "pose_rad"),
        (lambda r3: frfid.Plant.load(R3, challenges={"weather": True}), "challenges.weather: unknown field `weather`"),
        (lambda r3: frfid.Plant.from_toml("seed = 1"), "unknown field `seed`"),
        (lambda r3: frfid.Plant.from_toml(""), "no robot"),
        (lambda r3: r3.parameters, "to_toml"),
        (lambda r3: r3.mass_matrix([0.0, 0.0]), r"q has shape \[2\], needed \(3\)"),
        (lambda r3: r3.link_acceleration(np.zeros((2, 3)), np.zeros((2, 3)), np.zeros(3)), "torque has shape"),
        (lambda r3: r3.simulate(np.zeros((1, 5)), sample_time_s=T), r"u has shape \[1, 1, 5\], needed \(3, sample\)"),
        (lambda r3: frfid.PiController(gain=[1.0, 2.0], integral_gain=[1.0, 2.0, 3.0], sample_time_s=T), "gain is"),
        (lambda r3: frfid.loop_frf(r3, pi(), [500.0]), "hz is 500"),
        (
            lambda r3: frfid.run_closed_loop(
                r3, frfid.PiController(gain=1.0, integral_gain=0.0, sample_time_s=T), np.zeros((3, 5))
            ),
            "gain_nms_per_rad has shape",
        ),
    ],
)
def test_bad_input_is_named(r3, call, says):
    with pytest.raises(ValueError, match=says):
        call(r3)
