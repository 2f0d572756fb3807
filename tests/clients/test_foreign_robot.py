"""The robot in MuJoCo behind a player that is no friend: the arm is frfid's, and each unkindness does what it says."""

import functools
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import frfid

pytest.importorskip("tomllib", reason="robot files are read with Python 3.11's tomllib")
pytest.importorskip("mujoco", reason="the foreign robot needs MuJoCo: pip install mujoco")
pytest.importorskip("scipy", reason="the foreign robot needs scipy: pip install scipy")

EXAMPLES = pathlib.Path(__file__).parents[2] / "examples"
sys.path.insert(0, str(EXAMPLES / "players"))
import mujoco_player
import reference
from mujoco_robot import Robot

R3, SIX = ("r3_multisine.toml", "manutec_r3.toml"), ("six_axis_multisine.toml", "six_axis.toml")
BOTH = pytest.mark.parametrize("experiment, file", [R3, SIX], ids=["r3", "six_axis"])
LINEAR = {"coulomb_friction": False, "torque_ripple": False, "sensing": False}
LEAD_S, OFFSET_S, PPM = 1.3, 3.7, 120.0  # the player's defaults
LINES_HZ = np.arange(3.0, 60.0, 2.0)
DURATION_S = 8.0
RATIO = np.array([-105.0, 210.0, 60.0])
CSV_SIGNALS = ("reference velocity", "position", "velocity", "torque")


def robot_of(experiment, **options):
    return Robot.of_experiment(EXAMPLES / "experiments" / experiment, **options)


def plant_of(file, **options):
    return frfid.Plant.load(EXAMPLES / "robots" / file, **options)


def step(t, start_s):
    """A raised cosine of 1 s from 0 to 1: its integral, itself, its derivative."""
    way = np.clip(t - start_s, 0.0, 1.0)
    integral = (way - np.sin(np.pi * way) / np.pi) / 2 + np.maximum(t - start_s - 1, 0.0)
    return np.array([integral, (1 - np.cos(np.pi * way)) / 2, np.pi / 2 * np.sin(np.pi * way)])


def multisine(pose_rad, rate_hz=1000.0, rms_rad_s=0.005, duration_s=DURATION_S, ride_rad_s=0.04):
    """A faded multisine of 1 s on a ride away from the pose and back at constant velocity; exact derivatives."""
    t = np.arange(round(duration_s * rate_hz) + 1) / rate_hz
    ride = ride_rad_s * (step(t, 0.0) - 2 * step(t, duration_s / 2 - 0.5) + step(t, duration_s - 1))
    _, fade, slope = step(t, 0.0) - step(t, duration_s - 1)
    bend = np.pi**2 / 2 * (np.cos(np.pi * t) * (t < 1) - np.cos(np.pi * (t - duration_s + 1)) * (t > duration_s - 1))
    arrays = []
    for axis, pose in enumerate(pose_rad):
        phase = np.random.default_rng(axis).uniform(0, 2 * np.pi, LINES_HZ.size)[:, None]
        turns = 2j * np.pi * LINES_HZ[:, None]
        waves = [(turns**order * np.exp(turns * t + 1j * phase)).real.sum(axis=0) for order in (-1, 0, 1)]
        x, v, a = rms_rad_s * np.sqrt(2 / LINES_HZ.size) * np.array(waves)
        faded = (fade * x, slope * x + fade * v, bend * x + 2 * slope * v + fade * a)
        arrays.append(ride + faded + np.outer([1, 0, 0], np.full(t.size, pose)))
    return reference.Motion(t, *np.array(arrays).transpose(1, 0, 2))


def write(path, motion, names, units=("rad", "rad/s", "rad/s^2"), factors=(1.0, 1.0, 1.0), side=""):
    """A reference as the exporter writes it, in other units if asked."""
    n = motion.time_s.size
    header, columns = ["k", "time_s", "plan_id"], [np.arange(n), motion.time_s, np.full(n, 4711)]
    for axis, name in enumerate(names):
        for quantity, unit, factor in zip(reference.QUANTITIES, units, factors):
            header.append(f"{name} {side}{quantity} [{unit}]")
            columns.append(getattr(motion, quantity)[axis] * factor)
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=",".join(header), comments="", fmt="%.15g")
    return path


@pytest.fixture(scope="module")
def r3():
    return robot_of(R3[0])


@pytest.fixture(scope="module")
def planned(r3, tmp_path_factory):
    """The motion and its file."""
    motion = multisine(r3.pose_rad)
    return motion, write(tmp_path_factory.mktemp("reference") / "reference.csv", motion, r3.names)


@pytest.fixture(scope="module")
def play(planned, tmp_path_factory):
    """Plays the reference under options: stamps in s, signals (joint, row) of the CSV, samples of the controller."""
    folder = tmp_path_factory.mktemp("logs")

    @functools.cache
    def played(*options):
        arguments = [planned[1], folder / "log.csv", "--ideal", folder / "ideal.npz", *options]
        assert mujoco_player.main([str(argument) for argument in arguments]) == 0
        return *read_csv(folder / "log.csv"), dict(np.load(folder / "ideal.npz"))

    return played


def read_csv(path):
    stamps_ms, *columns = np.loadtxt(path, delimiter=",", skiprows=1).T
    return stamps_ms / 1e3, dict(zip(CSV_SIGNALS, np.array(columns).reshape(3, 4, -1).swapaxes(0, 1)))


def plan_time(stamps):
    return (stamps - OFFSET_S) / (1 + 1e-6 * PPM) - LEAD_S


def spectrum(time_s, x, start_s=1.5):
    """Lines of 2 s before the ride turns round, (joint, line), by least squares at true times.

    What friction and the way make of the excitation, harmonics of its 1 Hz and a trend, is fitted with them.
    """
    settled = (time_s >= start_s) & (time_s < start_s + 2)
    t = time_s[settled] - start_s - 1
    turns = np.exp(2j * np.pi * np.arange(1, 121) * t[:, None])
    basis = np.column_stack([turns.real, -turns.imag, np.vander(t, 4)])
    found = np.linalg.lstsq(basis, x[:, settled].T, rcond=None)[0]
    lines = LINES_HZ.astype(int) - 1
    return (found[lines] + 1j * found[lines + 120]).T


@BOTH
def test_masses_and_gravity_are_frfid_s(experiment, file):
    robot, plant = robot_of(experiment), plant_of(file)
    for q in np.random.default_rng(1).uniform(-np.pi, np.pi, (50, robot.n)):
        np.testing.assert_allclose(robot.mass_matrix(q), plant.mass_matrix(q), atol=1e-11)
    torque = robot.stand_at(robot.pose_rad)
    np.testing.assert_allclose(torque, plant.gravity_torque(robot.data.qpos[robot.n :]), rtol=1e-9, atol=1e-9)


@BOTH
def test_its_linearisation_is_the_frf_of_frfid(experiment, file):
    robot, plant, hz = robot_of(experiment), plant_of(file), np.geomspace(2.0, 60.0, 80)
    links_at_pose = robot.pose_rad + plant.gravity_torque(robot.pose_rad) / robot.model.tendon_stiffness
    found, expected = robot.truth(hz, links_at_pose), plant.frf(hz, sample_time_s=1e-3).response
    error = np.linalg.norm(found - expected, axis=(1, 2)) / np.linalg.norm(expected, axis=(1, 2))
    print(f"{experiment}: worst line differs by {error.max():.1e}")
    assert error.max() < 1e-5


@BOTH
def test_it_moves_as_frfid_says(experiment, file):
    robot, plant = robot_of(experiment, friction=False, ripple=False), plant_of(file, challenges=LINEAR)
    velocity = multisine(robot.pose_rad).velocity
    links_at_pose = robot.pose_rad + plant.gravity_torque(robot.pose_rad) / robot.model.tendon_stiffness
    position = links_at_pose[:, None] + 1e-3 * (np.cumsum(velocity, axis=1) - velocity)
    loop = robot.loop
    gains = {"gain": loop.gain_nms_per_rad, "integral_gain": loop.integral_gain_nm_per_rad, "sample_time_s": 1e-3}
    outer = {"position_gain": loop.position_gain_per_s} if loop.position_gain_per_s.any() else {}
    expected = frfid.run_closed_loop(plant, frfid.PiController(**gains, **outer), velocity)
    torque, y, _ = robot.play(position, velocity)
    assert np.abs(y - expected.y).max() < 1e-5 * np.abs(y).max()
    assert np.abs(torque - expected.u).max() < 1e-5 * np.ptp(torque)


def test_friction_is_coulomb_s_in_slow_motion():
    robot = robot_of(R3[0], ripple=False)
    velocity = 0.008 * np.minimum(np.arange(3000) / 500, 1.0) * np.ones((3, 1))
    torque, y, position = robot.play(robot.pose_rad[:, None] + 1e-3 * np.cumsum(velocity, axis=1), velocity)
    torque, y, position = (x[:, 2500:].mean(axis=1) for x in (torque, y, position))
    friction = torque - robot.stand_at(position) - robot.model.dof_damping[:3] * y
    np.testing.assert_allclose(friction, [42.0, 105.0, 42.0], rtol=1e-3)


DEGREES = ("deg", "deg/s", "deg/s^2"), np.degrees(np.ones(3))
TURNS = ("turn", "rpm", "rpm/s"), np.array([1, 60, 60]) / (2 * np.pi)


@pytest.mark.parametrize("units, factors", [DEGREES, TURNS], ids=["degrees", "turns"])
@pytest.mark.parametrize("side", ["", "motor "])
def test_references_in_other_units_are_the_same(planned, r3, tmp_path, units, factors, side):
    motion, _ = planned
    ratio = RATIO[:, None] if side else 1.0
    there = reference.Motion(motion.time_s, *(motion.arrays() * ratio))
    found = reference.read(write(tmp_path / "r.csv", there, r3.names, units, factors, side), r3.names, r3.gear_ratio)
    np.testing.assert_allclose(found.arrays(), motion.arrays(), rtol=1e-12, atol=1e-12)


def test_the_spline_meets_the_motion_between_its_samples(r3):
    fine, coarse = multisine(r3.pose_rad, rate_hz=4000.0), multisine(r3.pose_rad, rate_hz=500.0)
    found = reference.sample(coarse, fine.time_s)
    assert np.abs(found.position - fine.position).max() < 1e-8
    assert np.abs(found.velocity - fine.velocity).max() < 1e-7
    outside = reference.sample(coarse, np.array([-1.0, DURATION_S + 1.0]))
    np.testing.assert_allclose(outside.velocity, 0.0, atol=1e-12)
    np.testing.assert_allclose(outside.position, np.column_stack([r3.pose_rad] * 2), atol=1e-12)


def test_a_played_reference_comes_back(play, planned):
    stamps, log, ideal = play("--rate-hz", "800")
    expected = reference.sample(planned[0], plan_time(stamps))
    assert np.median(np.diff(stamps)) == pytest.approx(1 / 800, abs=1e-9)
    np.testing.assert_allclose(log["reference velocity"], expected.velocity, atol=1e-6)  # cubic between samples of 59 Hz
    lag = np.abs(log["position"] - expected.position).max()
    assert lag < 0.02, "friction, and the change of gravity, over the integral gain"
    at_plan = np.isin(np.round(ideal["time_s"], 9), np.round(planned[0].time_s, 9))
    np.testing.assert_allclose(ideal["r"][:, at_plan], planned[0].velocity, atol=1e-12)


def test_six_axes_are_played_as_well(tmp_path):
    robot, options = robot_of(SIX[0]), ["--experiment", str(EXAMPLES / "experiments" / SIX[0]), "--clock-ppm", "0"]
    motion = multisine(robot.pose_rad, duration_s=4.0)
    files = [str(write(tmp_path / "reference.csv", motion, robot.names)), str(tmp_path / "log.csv")]
    assert mujoco_player.main([*files, *options]) == 0
    _, *columns = np.loadtxt(files[1], delimiter=",", skiprows=1).T
    followed = np.array(columns[1::4])
    ways = np.ptp(followed, axis=1) / np.ptp(motion.position, axis=1)
    assert ways.min() > 0.8 and ways.max() < 1.2


HOSTILE = "--rate-hz 800 --degrees --motor-side --flip joint_2 --low-pass-hz 100 --drop 0.01 --double 0.01".split()


@pytest.mark.parametrize("friction", ["on", "off"])
def test_lines_survive_every_unkindness(r3, tmp_path, friction):
    motion = multisine(r3.pose_rad, duration_s=20.0, ride_rad_s=0.02)
    ideal, settled_s = tmp_path / "ideal.npz", 7.4  # the lightest mode decays by a factor e in 3 s
    plan = write(tmp_path / "reference.csv", motion, r3.names)
    options = [*HOSTILE, "--friction", friction, "--ripple", "off", "--ideal", str(ideal)]
    assert mujoco_player.main([str(plan), str(tmp_path / "log.csv"), *options]) == 0
    stamps, log = read_csv(tmp_path / "log.csv")
    side = (RATIO * [1, -1, 1])[:, None]
    y = spectrum(plan_time(stamps), log["velocity"] / np.degrees(side), settled_s)
    u = spectrum(plan_time(stamps), log["torque"] * side, settled_s)
    ideal = np.load(ideal)
    expected_y, expected_u = (spectrum(ideal["time_s"], ideal[name], settled_s) for name in ("y", "u"))
    error = np.linalg.norm(y / u - expected_y / expected_u, axis=1) / np.linalg.norm(expected_y / expected_u, axis=1)
    print(f"friction {friction}: Y/U of one motion differs by {error} from joint to joint")
    assert error.max() < 1e-3


def test_units_sides_and_signs(play):
    _, plain, _ = play()
    _, told, _ = play("--degrees", "--motor-side", "--flip", "joint_2", "--flip", "joint_3:torque")
    for signal in CSV_SIGNALS[:3]:
        expected = plain[signal] * (np.degrees(RATIO) * [1, -1, 1])[:, None]
        np.testing.assert_allclose(told[signal], expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
    np.testing.assert_allclose(told["torque"], plain["torque"] / (RATIO * [1, -1, -1])[:, None], rtol=1e-9, atol=1e-9)


def test_rows_are_lost_and_doubled(play):
    stamps, _, _ = play("--drop", "0.02", "--double", "0.01")
    gaps = np.diff(stamps)
    assert (gaps == 0).sum() / stamps.size == pytest.approx(0.01, abs=0.005)
    lost = np.round(gaps[gaps > 0] * 1000).astype(int) - 1
    assert lost.sum() / stamps.size == pytest.approx(0.02, abs=0.007)


def test_the_clock_reads_the_last_cycle_if_told(play):
    cycle_stamps, cycle, ideal = play("--reads", "cycle", "--rate-hz", "500")
    late_stamps, late, _ = play("--reads", "late", "--rate-hz", "500")
    np.testing.assert_array_equal(cycle["velocity"], late["velocity"])
    age = late_stamps - cycle_stamps
    assert 0 <= age.min() and 1e-4 < np.ptp(age) < age.max() < 1.001e-3
    places = np.round((plan_time(cycle_stamps) - ideal["time_s"][0]) * 1000).astype(int)
    np.testing.assert_allclose(cycle["velocity"], ideal["y"][:, places], rtol=1e-9, atol=1e-12)


def test_the_low_pass_is_in_the_reference_and_in_its_log(play):
    stamps, log, ideal = play("--low-pass-hz", "100")
    _, _, unfiltered = play()
    gain = spectrum(ideal["time_s"], ideal["r"]) / spectrum(unfiltered["time_s"], unfiltered["r"])
    butterworth = 1 / np.sqrt(1 + (np.tan(np.pi * LINES_HZ / 1000) / np.tan(np.pi * 100 / 1000)) ** 4)
    np.testing.assert_allclose(np.abs(gain), np.broadcast_to(butterworth, gain.shape), rtol=1e-4)
    logged = spectrum(plan_time(stamps), log["reference velocity"]) / spectrum(ideal["time_s"], ideal["r"])
    assert np.abs(logged - 1).max() < 1e-3


def test_torque_has_a_resolution_and_noise(play):
    _, plain, _ = play()
    _, told, _ = play("--torque-quantum-nm", "0.5", "--torque-noise-nm", "0.4")
    assert not np.any(told["torque"] % 0.5)
    assert (told["torque"] - plain["torque"]).std() == pytest.approx(np.hypot(0.4, 0.5 / np.sqrt(12)), rel=0.03)


def test_chance_is_the_run_s(play):
    names = ("p000-m0-q0", "p000-m0-q0", "p000-m1-q0")
    first, again, other = (play.__wrapped__("--run", name, "--jitter-us", "20")[0] for name in names)
    np.testing.assert_array_equal(first, again)
    assert first[0] != other[0]


def test_a_stopped_run_has_a_log_and_another_exit_code(planned, tmp_path):
    command = [sys.executable, mujoco_player.__file__, planned[1], tmp_path / "log.csv"]
    command += ["--abort-at", "0.6", "--run", "p003-m1-q0"]
    stopped = subprocess.run(command, capture_output=True, text=True)
    assert (stopped.returncode, stopped.stderr) == (3, "mujoco_player: protective stop at 0.6 of the way\n")
    stamps, log = read_csv(tmp_path / "log.csv")
    assert plan_time(stamps[-1]) == pytest.approx(0.6 * DURATION_S + 0.2, abs=0.01)
    assert np.abs(log["reference velocity"][:, -1]).max() < 1e-3
    whole = subprocess.run([*command, "--abort-run", "glide-q0"], capture_output=True, text=True)
    assert (whole.returncode, whole.stderr) == (0, "")


@pytest.mark.parametrize(
    "options, says",
    [
        (["--start-offset-rad", "0.06"], "joint_1 stands 0.06 rad off the start of the reference, allowed are 0.05 rad"),
        (["--reference-hz", "500"], "the reference has 1000 samples per second, FRFID_RATE_HZ is 500"),
        (["--flip", "elbow"], "cannot flip elbow: joints are joint_1, joint_2, joint_3"),
    ],
)
def test_what_is_refused_is_said(planned, tmp_path, capsys, options, says):
    assert mujoco_player.main([str(planned[1]), str(tmp_path / "log.csv"), *options]) == 2
    assert says in capsys.readouterr().err
    assert not (tmp_path / "log.csv").exists(), "nothing moved"


def test_unsound_references_are_refused(planned, r3, tmp_path, capsys):
    motion, _ = planned
    start = motion.arrays()[..., 2000:]
    cases = {
        "at rest": reference.Motion(motion.time_s[2000:] - 2.0, *start),
        "joint_2 would move": multisine(r3.pose_rad, rms_rad_s=0.5),
    }
    for says, unsound in cases.items():
        unsound.position += (r3.pose_rad - unsound.position[:, 0])[:, None]
        assert mujoco_player.main([str(write(tmp_path / "r.csv", unsound, r3.names)), str(tmp_path / "log.csv")]) == 2
        assert says in capsys.readouterr().err
    write(tmp_path / "r.csv", motion, ["joint_1", "elbow", "joint_3"])
    assert mujoco_player.main([str(tmp_path / "r.csv"), str(tmp_path / "log.csv")]) == 2
    assert "no column of joint_2 position" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["log.mcap", "bag"])
def test_bags_hold_what_the_csv_holds(planned, play, tmp_path, name):
    highlevel = pytest.importorskip("rosbags.highlevel", reason="bags are written with rosbags: pip install frfid[ros]")
    stamps, log, _ = play("--rate-hz", "500")
    assert mujoco_player.main([str(planned[1]), str(tmp_path / name), "--rate-hz", "500"]) == 0
    topics = {}
    with highlevel.AnyReader([tmp_path / name]) as bag:
        for connection, _, raw in bag.messages():
            topics.setdefault(connection.topic, []).append(bag.deserialize(raw, connection.msgtype))
    states, controller = topics["/joint_states"], topics["/arm_controller/controller_state"]
    stamp = lambda message: message.header.stamp.sec - 1_760_000_000 + 1e-9 * message.header.stamp.nanosec
    for messages in (states, controller):
        np.testing.assert_allclose([stamp(message) for message in messages], stamps, atol=1e-8)
    assert list(states[0].name) == ["joint_3", "joint_2", "joint_1"]
    found = {
        "torque": [message.effort[::-1] for message in states],
        "velocity": [message.feedback.velocities for message in controller],
        "position": [message.position[::-1] for message in states],
        "reference velocity": [message.reference.velocities for message in controller],
    }
    for signal, rows in found.items():
        np.testing.assert_allclose(np.array(rows).T, log[signal], rtol=1e-9, atol=1e-11)
    np.testing.assert_array_equal([message.output.effort for message in controller], np.array(found["torque"]))
