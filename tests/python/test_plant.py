"""The simulated joint against scipy's linear one, and what friction, stiffness, sensors and controller do to it."""

import copy
import pathlib
import pickle

import numpy as np
import pytest
import scipy.signal

import frfid

ROBOTS = pathlib.Path(__file__).parents[2] / "examples" / "robots"
T = 1e-3


def multisine(peak=150.0, n_inputs=1):
    ms = frfid.Multisine.design(low_hz=1.0, high_hz=60.0, sample_time_s=T, resolution_hz=0.5, n_lines=80)
    return ms, ms.realize(seed=1, n_inputs=n_inputs, peak=peak)[0]


@pytest.mark.parametrize("hold", ["zoh", "linear", "continuous"])
def test_the_linear_truth_is_scipy_s(scipy_joint, hold):
    hz = np.geomspace(0.5, 400.0, 60)
    truth = frfid.Plant.single_joint().frf(hz, hold=hold, sample_time_s=T)
    assert truth.shape == (60, 1, 1) and truth.noise_variance is None
    np.testing.assert_allclose(truth.response.ravel(), scipy_joint.frf(hz, T, hold), rtol=1e-9)
    assert np.asarray(truth) is truth.response and truth[3, 0, 0] == truth.response[3, 0, 0]


def test_notch_and_peak_of_the_paper_s_joint():
    hz = np.linspace(4.0, 13.0, 90_001)
    db = 20 * np.log10(np.abs(frfid.Plant.single_joint().frf(hz, hold="continuous")[:, 0, 0]))
    assert (hz[db.argmin()], hz[db.argmax()]) == (pytest.approx(5.0289, abs=2e-4), pytest.approx(11.6211, abs=2e-4))
    assert (db.min(), db.max()) == (pytest.approx(-95.0507, abs=1e-3), pytest.approx(-55.6669, abs=1e-4))


def test_differencing_in_the_sensor_turns_the_phase():
    plant = frfid.Plant.single_joint(velocity_by_differencing=True)
    ratio = plant.frf([60.0], hold="continuous", sample_time_s=T, sensor=True)[0, 0, 0] / plant.frf([60.0], hold="continuous")[0, 0, 0]
    assert np.degrees(np.angle(ratio)) == pytest.approx(-10.8, abs=1e-3)
    record = plant.simulate(multisine()[1], sample_time_s=T)
    np.testing.assert_allclose(record.y[0, 1:], np.diff(record.position_rad[0]) / T, atol=1e-12)


@pytest.mark.parametrize("hold", ["zoh", "linear"])
def test_the_linear_joint_moves_as_scipy_s(scipy_joint, hold):
    u = np.tile(multisine()[1], 2)
    record = frfid.Plant.single_joint().simulate(u, sample_time_s=T, hold=hold)
    expected = scipy_joint.simulate(u[0], T, hold)
    if hold == "linear":  # scipy's first-order hold is the same but for the state at rest before the first sample
        expected = scipy.signal.dlsim(
            (*scipy_joint.discrete(T, hold)[:4], T), u.T, x0=-first_order_feedthrough(scipy_joint) * u[0, 0]
        )[1][:, 0]
    np.testing.assert_allclose(record.y[0], expected, atol=1e-9 * np.abs(expected).max())
    assert record.u.tobytes() == u.tobytes() and record.sample_time_s == T


def first_order_feedthrough(joint):
    """Gamma_2 of the linear hold: scipy's state is x - Gamma_2 u."""
    n = 4
    block = np.zeros((n + 2, n + 2))
    block[:n, :n], block[:n, n:-1], block[n, n + 1] = joint.a * T, joint.b * T, 1.0
    return scipy.linalg.expm(block)[:n, -1]


def test_a_batch_is_the_runs_one_by_one():
    plant = frfid.Plant.single_joint(coulomb_nm=50.0, velocity_noise_rad_s=1e-4)
    u = np.stack([multisine(peak)[1] for peak in (80.0, 150.0, 300.0)])
    batch = plant.simulate(u, sample_time_s=T, seed=4)
    assert batch.y.shape == batch.position_rad.shape == (3, 1, u.shape[-1])
    again = plant.simulate(np.asfortranarray(u), sample_time_s=T, seed=4)
    assert again.y.tobytes() == batch.y.tobytes()
    alone = plant.simulate(u[0], sample_time_s=T, seed=4)
    assert alone.y.shape == (1, u.shape[-1]) and alone.y.tobytes() == batch.y[0].tobytes()
    assert plant.simulate(u[0], sample_time_s=T, seed=5).y.tobytes() != alone.y.tobytes()


def test_friction_sticks_and_a_constant_velocity_cures_it():
    plant, free = frfid.Plant.single_joint(coulomb_nm=50.0), frfid.Plant.single_joint()
    stuck = plant.simulate(np.full((1, 500), 49.0), sample_time_s=T)
    assert not stuck.y.any() and not stuck.position_rad.any()
    ms, u = multisine()
    u = np.tile(u, 2)
    riding = plant.simulate(u, sample_time_s=T, velocity_rad_s=0.25)
    np.testing.assert_allclose(riding.y - 0.25, free.simulate(u, sample_time_s=T).y, atol=1e-9)
    np.testing.assert_allclose(riding.u - 50.0, riding.r, atol=1e-12)
    assert u.std() < 50.0 and np.mean(plant.simulate(u, sample_time_s=T).y == 0.0) > 0.3, "it mostly sticks without"


def test_the_bla_of_the_linear_joint_is_the_truth():
    ms, u = multisine()
    plant = frfid.Plant.single_joint(damping_nms_per_rad=800.0, viscous_nms_per_rad=3000.0)
    record = plant.simulate(np.tile(u, 3), sample_time_s=T)
    steady = lambda x: x[:, -2 * ms.n_samples :].reshape(1, 1, 1, 2, -1).swapaxes(2, 3)
    frf = frfid.estimate_bla(steady(record.u), steady(record.y), sample_time_s=T, harmonics=ms.harmonics)
    truth = plant.frf(frf.frequency_hz, sample_time_s=T)
    np.testing.assert_allclose(frf.response, truth, rtol=1e-9)
    assert frf.total_variance is None and frf.noise_variance.max() < 1e-20
    late = frfid.estimate_bla(steady(record.u), steady(np.roll(record.y, 1)), sample_time_s=T, harmonics=ms.harmonics)
    assert np.abs(late.response / truth - 1).max() > 0.3, "one sample late is seen"


def numpy_closed_loop(joint, r, gain, integral_gain, limit=np.inf):
    phi, gamma, c, *_ = joint.discrete(T)
    x, integral, u, y = np.zeros(4), 0.0, [], []
    for reference in r:
        y.append(c[0] @ x)
        error = reference - y[-1]
        asked = gain * error + integral
        u.append(np.clip(asked, -limit, limit))
        if u[-1] == asked or error * asked <= 0:
            integral += integral_gain * T * error
        x = phi @ x + gamma[:, 0] * u[-1]
    return np.array(u), np.array(y)


@pytest.mark.parametrize("limit", [None, 60.0])
def test_the_closed_loop_is_numpy_s(scipy_joint, limit):
    controller = frfid.PiController(gain=[1500.0], integral_gain=12000.0, sample_time_s=T, max_torque_nm=limit)
    r = multisine(peak=0.05)[1]
    record = frfid.run_closed_loop(frfid.Plant.single_joint(), controller, r)
    u, y = numpy_closed_loop(scipy_joint, r[0], 1500.0, 12000.0, limit or np.inf)
    np.testing.assert_allclose(record.u[0], u, atol=1e-7 * np.abs(u).max())
    np.testing.assert_allclose(record.y[0], y, atol=1e-7 * np.abs(y).max())
    assert record.r.tobytes() == r.tobytes()
    events = {(event["event"], event["quantity"], event["limit"]) for event in record.events}
    assert events == ({("limit", "effort_nm", 60.0)} if limit else set())
    batch = frfid.run_closed_loop(frfid.Plant.single_joint(), controller, np.stack([r, r]))
    assert batch.y[1].tobytes() == record.y.tobytes() and len(batch.events) == 2


@pytest.mark.parametrize(
    "call, says",
    [
        (lambda: frfid.Plant.single_joint(coulomb_nm=-1.0), "coulomb_nm is -1"),
        (lambda: frfid.Plant.single_joint(torque_quantum_nm=float("nan")), "torque_quantum_nm is NaN"),
        (lambda: frfid.Plant.single_joint(ripple=[{"cycles": 1.0}]), r"ripple\[0\].cycles: unknown field"),
        (lambda: frfid.Plant.single_joint(stifness=1.0), "unknown field `stifness`"),
        (lambda: frfid.Plant.single_joint().frf([0.0], sample_time_s=T), "hz is 0"),
        (lambda: frfid.Plant.single_joint().frf([1.0]), "sample_time_s is needed"),
        (lambda: frfid.Plant.single_joint().frf([1.0], hold="zoo", sample_time_s=T), "hold: unknown variant `zoo`"),
        (lambda: frfid.Plant.single_joint().simulate(np.zeros(5), sample_time_s=T), r"u has dtype float64 and shape \(5,\)"),
        (lambda: frfid.Plant.single_joint().simulate(np.zeros((2, 5)), sample_time_s=T), r"u has shape \[1, 2, 5\]"),
        (lambda: frfid.Plant.single_joint().simulate(np.zeros((1, 0)), sample_time_s=T), "at least one sample"),
        (lambda: frfid.Plant.single_joint().simulate([[1.0, np.nan]], sample_time_s=T), "u: 1 samples are NaN"),
        (lambda: frfid.Plant.single_joint().simulate([[1.0]], sample_time_s=-T), "sample_time_s is -0.001"),
        (lambda: frfid.Plant.single_joint().simulate([[1.0]], sample_time_s=T, hold="continuous"), "hold"),
        (lambda: frfid.Plant.single_joint().simulate([[1.0]], sample_time_s=T, velocity_rad_s=[1.0, 2.0]), "velocity_rad_s"),
        (lambda: frfid.PiController(gain=-1.0, integral_gain=0.0, sample_time_s=T), "gain_nms_per_rad is -1"),
    ],
)
def test_bad_input_is_named(call, says):
    with pytest.raises(ValueError, match=says):
        call()


def test_an_unstable_loop_is_a_numerical_error():
    wild = frfid.PiController(gain=1e9, integral_gain=0.0, sample_time_s=T)
    with pytest.raises(frfid.NumericalError, match="no longer finite"):
        frfid.run_closed_loop(frfid.Plant.single_joint(), wild, np.ones((1, 5000)))


def test_a_robot_file_is_a_plant(tmp_path):
    assert frfid.Plant.load(ROBOTS / "paper_joint.toml") == frfid.Plant.single_joint(coulomb_nm=50.0)
    path = tmp_path / "robot.toml"
    path.write_text("[single_joint]\nmotor_inertia = 35.0\n")
    with pytest.raises(ValueError, match=r"robot\.toml:2:1: unknown field `motor_inertia`(.|\n)*\^\^\^"):
        frfid.Plant.load(path)
    path.write_text("")
    with pytest.raises(ValueError, match=r"robot\.toml: no robot: .* \[single_joint\], \[\[body\]\] or \[urdf\] is needed"):
        frfid.Plant.load(path)
    with pytest.raises(FileNotFoundError):
        frfid.Plant.load(tmp_path / "nowhere.toml")


def test_pickles_are_equal():
    plant = frfid.Plant.single_joint(
        coulomb_nm=50.0,
        stiffness_beyond_nm_per_rad=2.55e5,
        ripple=[{"cycles_per_turn": 12.0, "amplitude_nm": 3.0, "phase_rad": 0.1}],
        velocity_by_differencing=True,
        torque_noise_nm=0.5,
    )
    controller = frfid.PiController(gain=1.0, integral_gain=[2.0], sample_time_s=T, delay_samples=1, max_torque_nm=5.0)
    for thing in (plant, controller):
        assert pickle.loads(pickle.dumps(thing)) == thing == copy.copy(thing)
    assert frfid.Plant.single_joint(**plant.parameters) == plant != frfid.Plant.single_joint()
