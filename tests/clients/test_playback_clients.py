"""Plans as players take them, read by programs that are not ours: pandas, scipy, Octave, rosbags, mcap + mcap-ros2-support; and what a
joint_trajectory_controller makes of the points, by the quintic splines of its documentation.

Needs ``pip install pandas scipy rosbags mcap mcap-ros2-support pytest``, and the command frfid.
"""

import json
import os
import pathlib
import shutil
import subprocess

import numpy as np
import pytest

FRFID = os.environ.get("FRFID") or shutil.which("frfid")
pytestmark = pytest.mark.skipif(FRFID is None, reason="needs the command frfid: pip install .")
pandas = pytest.importorskip("pandas")
scipy_io = pytest.importorskip("scipy.io")

ROOT = pathlib.Path(__file__).parents[2]
JOINTS = ["joint_1", "joint_2", "joint_3"]
RATE_HZ = 500.0
DESCRIPTION = """
seed = 7
sample_time_s = 0.001
[robot]
file = "{robots}/manutec_r3.toml"
{controller}
[multisine]
low_hz = 2.0
high_hz = 60.0
resolution_hz = 1.0
{peak}
[averaging]
realizations = 1
repetitions = 2
lead_in_s = 0.5
{more}
"""
CONTROLLER = "[controller]\ngain_nms_per_rad = [1500.0, 1500.0, 400.0]\nintegral_gain_nm_per_rad = [12000.0, 12000.0, 3200.0]"
GLIDING = "[constant_velocity]\nvelocity_rad_s = [0.02, -0.03, 0.04]\nglides = 1\n[limits]\nmax_travel = [0.3, 0.3, 0.3]"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Plans of velocities and of torques."""
    here = tmp_path_factory.mktemp("playback")
    robots = ROOT / "examples" / "robots"
    velocity = DESCRIPTION.format(robots=robots, controller=CONTROLLER, peak="peak_rad_s = [0.05, 0.05, 0.05]", more=GLIDING)
    torque = DESCRIPTION.format(robots=robots, controller="", peak="peak_nm = [200.0, 200.0, 60.0]", more="")
    (here / "velocity.toml").write_text(velocity)
    (here / "torque.toml").write_text(torque)
    (here / "tight.toml").write_text(velocity + "max_velocity = [1.0, 1.0, 0.05]\n")
    done = frfid(here, "design", "velocity.toml", "-o", "plan.mcap")
    assert done.returncode == 3 and "changes its sign" in done.stderr, "which does not matter to what is played"
    return here


def frfid(here, *arguments):
    return subprocess.run([FRFID, *map(str, arguments)], cwd=here, capture_output=True, text=True)


def exported(here, *arguments):
    """What `frfid export --json` tells."""
    done = frfid(here, "export", *arguments, "--json", "--force")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def plain(folder):
    """Every run by its name as CSV with the defaults, at 500 Hz."""
    exported(folder, "plan.mcap", "--to", "csv", "--rate", RATE_HZ, "-o", "plain")
    return {path.stem: pandas.read_csv(path) for path in (folder / "plain").glob("[pg]*.csv")}


def columns(quantity):
    return [column for joint in JOINTS for column in [f"{joint} {quantity}"]]


MOTION = ["position [rad]", "velocity [rad/s]", "acceleration [rad/s^2]"]


def test_the_list_of_runs_says_what_is_played(folder, plain):
    runs = pandas.read_csv(folder / "plain" / "runs.csv")
    assert list(runs.run) == ["glide-q0", "p000-m0-q0", "p000-m1-q0", "p000-m2-q0"]
    assert list(runs.repetitions) == [1, 2, 2, 2] and set(plain) == set(runs.run)
    assert [name.removesuffix(".csv") for name in runs.file] == list(runs.run)
    for row in runs.itertuples():
        table = plain[row.run]
        assert len(table) == row.samples and row.first_k == 0
        assert row.duration_s == pytest.approx(row.samples / RATE_HZ)
        assert (table.plan_id == row.plan_id).all() and 0 < row.plan_id < 2**32
        assert (table.k == np.arange(row.samples)).all() and (table.time_s == table.k / RATE_HZ).all()
    assert len(list((folder / "plain").glob("*.csv"))) == 5


def test_a_run_holds_its_reference_and_rests_at_both_ends(folder, plain):
    frfid_module = pytest.importorskip("frfid")
    plan = frfid_module.Plan.load(folder / "plan.mcap")
    runs = pandas.read_csv(folder / "plain" / "runs.csv").set_index("run")
    for name, table in plain.items():
        velocity = table[columns(MOTION[1])].to_numpy().T
        begin, n = runs.run_first_k[name], runs.run_samples[name]
        reference = plan.reference(plan.names.index(name))[:, ::2]
        assert np.abs(velocity[:, begin : begin + n] - reference[:, :n]).max() < 1e-12
        for quantity in MOTION[1:]:
            assert not table[columns(quantity)].to_numpy()[[0, -1]].any()
        position = table[columns(MOTION[0])].to_numpy()
        assert np.abs(position[0] - position[-1]).max() < 1e-12


SEPARATORS = {"comma": ",", "semicolon": ";", "tab": "\t"}


@pytest.mark.parametrize("separator", SEPARATORS)
@pytest.mark.parametrize("decimal", ["point", "comma"])
def test_every_form_is_the_same_table(folder, plain, separator, decimal):
    output = folder / f"{separator}-{decimal}.csv"
    options = ["--rate", RATE_HZ, "--campaign", "--separator", separator, "--decimal", decimal, "-o", output]
    if separator == decimal == "comma":
        refused = frfid(folder, "export", "plan.mcap", *options)
        assert refused.returncode == 2 and "a semicolon or a tab" in refused.stderr and not output.exists()
        return
    exported(folder, "plan.mcap", *options)
    found = pandas.read_csv(output, sep=SEPARATORS[separator], decimal={"point": ".", "comma": ","}[decimal])
    again = [plain[name] for name in ["glide-q0", *np.repeat(["p000-m0-q0", "p000-m1-q0", "p000-m2-q0"], 2)]]
    expected = pandas.concat(again, ignore_index=True)
    assert list(found.columns) == list(expected.columns)
    signals = list(expected.columns[3:])
    assert (found[signals].to_numpy() == expected[signals].to_numpy()).all(), "all digits"
    assert (found.k == np.arange(len(expected))).all() and (found.plan_id == expected.plan_id).all()


def test_a_campaign_is_one_motion(folder):
    exported(folder, "plan.mcap", "--rate", RATE_HZ, "--campaign", "-o", "all.csv")
    table = pandas.read_csv(folder / "all.csv")
    for joint in JOINTS:
        position, velocity, acceleration = (table[f"{joint} {quantity}"].to_numpy() for quantity in MOTION)
        h = 1 / RATE_HZ
        # the trapezium with its correction, whose error is of order 5 in the step
        step = h * (velocity[1:] + velocity[:-1]) / 2 - h * h * (acceleration[1:] - acceleration[:-1]) / 12
        assert np.abs(np.diff(position) - step).max() < 1e-6
        assert np.abs(np.diff(velocity)).max() < 1.01 * np.abs(acceleration).max() * h
    listed = exported(folder, "plan.mcap", "--to", "csv", "--campaign", "-o", "campaign")
    runs = pandas.read_csv(folder / "campaign" / "runs.csv")
    assert list(runs.first_k) == [0, *np.cumsum(runs.repetitions * runs.samples)[:-1]]
    assert listed["n_runs"] == 7 and set(runs.file) == {"campaign.csv"}


@pytest.mark.parametrize(
    "angle, names, factors",
    [
        ("rad", ["rad", "rad/s", "rad/s^2"], [1.0, 1.0, 1.0]),
        ("deg", ["deg", "deg/s", "deg/s^2"], [180 / np.pi] * 3),
        ("turn", ["turn", "turn/s", "turn/s^2"], [1 / (2 * np.pi)] * 3),
        ("rpm", ["turn", "rpm", "rpm/s"], [1 / (2 * np.pi), 60 / (2 * np.pi), 60 / (2 * np.pi)]),
    ],
)
@pytest.mark.parametrize("ratios", [None, [-105.0, 210.0, 60.0]])
def test_units_and_side(folder, plain, angle, names, factors, ratios):
    side = [] if ratios is None else ["--gear-ratio", ",".join(map(str, ratios))]
    exported(folder, "plan.mcap", "--to", "csv", "--rate", RATE_HZ, "--angle", angle, *side, "-o", "units")
    found = pandas.read_csv(folder / "units" / "p000-m1-q0.csv")
    motor = "" if ratios is None else "motor "
    for place, joint in enumerate(JOINTS):
        for quantity, name, factor in zip(MOTION, names, factors):
            expected = plain["p000-m1-q0"][f"{joint} {quantity}"] * factor * (ratios[place] if ratios else 1.0)
            turned = found[f"{joint} {motor}{quantity.split()[0]} [{name}]"]
            np.testing.assert_allclose(turned, expected, rtol=1e-14, atol=1e-300)


def test_torques_have_one_column_and_shrink_with_the_ratio(folder):
    exported(folder, "torque.toml", "--to", "csv", "-o", "torque")
    exported(folder, "torque.toml", "--to", "csv", "--gear-ratio", "-105,210,60", "-o", "motor")
    joint, motor = (pandas.read_csv(folder / name / "p000-m0-q0.csv") for name in ["torque", "motor"])
    assert list(joint.columns[3:]) == columns("effort [N m]")
    for name, ratio in zip(JOINTS, [-105, 210, 60]):
        np.testing.assert_allclose(motor[f"{name} motor effort [N m]"], joint[f"{name} effort [N m]"] / ratio, rtol=1e-14)


def test_mat_by_scipy(folder, plain):
    exported(folder, "plan.mcap", "--to", "mat", "--rate", RATE_HZ, "-o", "mat")
    table = plain["p000-m0-q0"]
    path = folder / "mat" / "p000-m0-q0.mat"
    found = scipy_io.loadmat(path)
    expected = table[["time_s", *table.columns[3:]]].to_numpy()
    assert scipy_io.whosmat(path)[0][0] == "from_file", "Simulink's From File wants it first"
    assert (found["table"] == expected).all() and (found["from_file"] == expected.T).all()
    assert [name[0][0] for name in found["columns"]] == ["time_s", *table.columns[3:]]
    for quantity in MOTION:
        assert (found[quantity.split()[0]] == table[columns(quantity)].to_numpy()).all()
    assert (found["k"][:, 0] == table.k).all() and (found["time"][:, 0] == table.time_s).all()
    assert (found["plan_id"], found["rate_hz"], found["run"][0]) == (table.plan_id[0], RATE_HZ, "p000-m0-q0")


@pytest.mark.skipif(shutil.which("octave") is None, reason="needs octave")
def test_mat_by_octave(folder):
    exported(folder, "plan.mcap", "--to", "mat", "-o", "octave", "--rate", RATE_HZ)
    code = "load('octave/p000-m0-q0.mat'); printf('%d %d %.17g %s', size(table), plan_id, run); assert(from_file', table)"
    done = subprocess.run(["octave", "--no-gui", "--norc", "--eval", code], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    rows, width, plan_id, run = done.stdout.split()
    assert (int(width), run) == (10, "p000-m0-q0") and int(plan_id) == scipy_io.loadmat(folder / "octave" / "p000-m0-q0.mat")["plan_id"]


def by_rosbags(path):
    highlevel = pytest.importorskip("rosbags.highlevel")
    topics = {}
    with highlevel.AnyReader([path]) as source:
        for connection, time, raw in source.messages():
            topics.setdefault(connection.topic, []).append((time, source.deserialize(raw, connection.msgtype)))
    return topics


def by_mcap_ros2(path):
    reader, decoder = pytest.importorskip("mcap.reader"), pytest.importorskip("mcap_ros2.decoder")
    topics = {}
    with open(path, "rb") as file:
        source = reader.make_reader(file, validate_crcs=True, decoder_factories=[decoder.DecoderFactory()])
        assert source.get_header().profile == "ros2"
        for _, channel, message, decoded in source.iter_decoded_messages():
            topics.setdefault(channel.topic, []).append((message.log_time, decoded))
    return topics


TRAJECTORY = "/joint_trajectory_controller/joint_trajectory"
READERS = {"rosbags": by_rosbags, "mcap_ros2": by_mcap_ros2}


def duration_ns(duration):
    return duration.sec * 10**9 + getattr(duration, "nanosec", 0)


@pytest.fixture(scope="module")
def trajectories(folder):
    exported(folder, "plan.mcap", "--to", "joint-trajectory", "--rate", RATE_HZ, "-o", "ros")
    exported(folder, "torque.toml", "--to", "joint-trajectory", "-o", "ros_torque")
    return folder / "ros"


def test_the_node_goes_with_trajectories_alone(trajectories, folder):
    node = ROOT / "crates" / "files" / "src" / "playback" / "play.py"
    assert (trajectories / "play.py").read_text() == node.read_text()
    exported(folder, "plan.mcap", "--to", "float64-array", "-o", "no_node")
    assert not list((folder / "no_node").glob("*.py")) and (folder / "no_node" / "plan.html").exists()


@pytest.mark.parametrize("read", READERS.values(), ids=READERS)
def test_a_trajectory_has_every_sample_behind_the_rest(trajectories, plain, read):
    topics = read(trajectories / "p000-m1-q0.mcap")
    [(_, message)] = topics[TRAJECTORY]
    table = plain["p000-m1-q0"]
    plan_id = table.plan_id[0]
    assert list(message.joint_names) == JOINTS
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (0, 0)
    assert message.header.frame_id == f"frfid p000-m1-q0 {plan_id}"
    times = np.array([duration_ns(point.time_from_start) for point in message.points])
    first = len(table) - len(times)
    assert times[0] == round((first + 1) / RATE_HZ * 1e9) and times[0] == pytest.approx(0.5e9, abs=5e6)
    assert (np.diff(times) == round(1e9 / RATE_HZ)).all()
    for field, quantity in zip(["positions", "velocities", "accelerations"], MOTION):
        found = np.array([getattr(point, field) for point in message.points])
        assert (found == table[columns(quantity)].to_numpy()[first:]).all(), field
    assert not any(len(point.effort) for point in message.points)
    assert not np.any(message.points[-1].velocities) and not np.any(message.points[-1].accelerations)
    [(_, event)] = topics["/frfid/events"]
    assert json.loads(event.data) == {"event": "playback-start", "run": "p000-m1-q0", "plan_id": plan_id, "k": 0}


@pytest.mark.parametrize("read", READERS.values(), ids=READERS)
def test_a_trajectory_of_torques_holds_the_pose(trajectories, folder, read):
    [(_, message)] = read(folder / "ros_torque" / "p000-m0-q0.mcap")[TRAJECTORY]
    positions = np.array([point.positions for point in message.points])
    efforts = np.array([point.effort for point in message.points])
    assert (positions == positions[0]).all() and efforts.any() and not efforts[-1].any()
    assert not any(len(point.velocities) + len(point.accelerations) for point in message.points)


@pytest.mark.parametrize("read", READERS.values(), ids=READERS)
def test_a_message_for_each_sample_with_the_events_of_every_run(folder, plain, read):
    exported(folder, "plan.mcap", "--to", "float64-array", "--rate", RATE_HZ, "--campaign", "-o", "arrays")
    topics = read(folder / "arrays" / "campaign.mcap")
    order = ["glide-q0", "p000-m0-q0", "p000-m0-q0", "p000-m1-q0", "p000-m1-q0", "p000-m2-q0", "p000-m2-q0"]
    expected = np.concatenate([plain[name][columns(MOTION[1])].to_numpy() for name in order])
    times, messages = zip(*topics["/commands"])
    assert (np.array([message.data for message in messages]) == expected).all()
    assert (np.diff(times) == round(1e9 / RATE_HZ)).all()
    events = [json.loads(event.data) for _, event in topics["/frfid/events"]]
    names = ["glide-q0", *(f"p000-m{m}-q{q}" for m in range(3) for q in range(2))]
    assert [event["run"] for event in events] == names
    assert [time for time, _ in topics["/frfid/events"]] == [times[event["k"]] for event in events]


def quintic(points, times_s, at_s):
    """Velocities between points of position, velocity and acceleration: the spline of fifth order that has all of them at both ends."""
    place = np.clip(np.searchsorted(times_s, at_s, side="right") - 1, 0, len(times_s) - 2)
    [p0, v0, a0], [p1, v1, a1] = points[:, place], points[:, place + 1]
    h, t = times_s[place + 1] - times_s[place], at_s - times_s[place]
    c3 = (20 * (p1 - p0) - (8 * v1 + 12 * v0) * h - (3 * a0 - a1) * h**2) / (2 * h**3)
    c4 = (30 * (p0 - p1) + (14 * v1 + 16 * v0) * h + (3 * a0 - 2 * a1) * h**2) / (2 * h**4)
    c5 = (12 * (p1 - p0) - 6 * (v1 + v0) * h - (a0 - a1) * h**2) / (2 * h**5)
    return v0 + a0 * t + 3 * c3 * t**2 + 4 * c4 * t**3 + 5 * c5 * t**4


def test_what_the_controller_interpolates_has_the_lines_of_the_reference(trajectories, folder):
    frfid_module = pytest.importorskip("frfid")
    [(_, message)] = by_rosbags(trajectories / "p000-m1-q0.mcap")[TRAJECTORY]
    times_s = np.array([duration_ns(point.time_from_start) for point in message.points]) / 1e9
    points = np.array([[getattr(point, field) for point in message.points] for field in ["positions", "velocities", "accelerations"]])
    runs = pandas.read_csv(trajectories / "runs.csv").set_index("run")
    plan = frfid_module.Plan.load(folder / "plan.mcap")
    reference = plan.reference(plan.names.index("p000-m1-q0"))
    lead_in, period = 500, reference.shape[1] - 500
    begin_s = (runs.run_first_k["p000-m1-q0"] + 1) / RATE_HZ + lead_in * 1e-3
    n = 4 * period
    at_s = begin_s + np.arange(n) / 4000
    worst_db = 0.0
    for joint in range(len(JOINTS)):
        played = np.fft.rfft(quintic(points[:, :, joint], times_s, at_s)) / n
        meant = np.fft.rfft(reference[joint, lead_in:]) / period
        lines = np.abs(meant) > 0.01 * np.abs(meant[1:]).max()
        lines[0] = False
        lines[np.arange(lines.size) / (period * 1e-3) > 60.5] = False
        assert lines.sum() > 30
        worst_db = max(worst_db, np.abs(20 * np.log10(np.abs(played[: lines.size][lines] / meant[lines]))).max())
        assert np.abs(np.angle(played[: lines.size][lines] / meant[lines], deg=True)).max() < 0.05
    print(f"worst line: {worst_db:.2g} dB")
    assert worst_db < 0.005


def test_a_limit_that_is_exceeded_is_named(folder):
    done = frfid(folder, "export", "tight.toml", "--to", "csv", "-o", "tight")
    assert done.returncode == 2 and not (folder / "tight").exists()
    assert "the reference of joint_3 reaches 0.0" in done.stderr and "max_velocity is 0.05" in done.stderr


@pytest.mark.parametrize(
    "arguments, told",
    [
        (["plan.mcap", "--to", "npz", "-o", "x"], "csv, mat, joint-trajectory, float64-array"),
        (["plan.mcap", "-o", "x"], "csv, mat, joint-trajectory, float64-array"),
        (["plan.mcap", "-o", "x.csv"], "--campaign"),
        (["plan.mcap", "--to", "csv", "-o", "x.mat", "--campaign"], "contradict each other"),
        (["plan.mcap", "--to", "csv", "-o", "x", "--gear-ratio", "1,2"], "one number for each of 3 joints"),
        (["plan.mcap", "--to", "csv", "-o", "x", "--rate", "100"], "at least 148.1"),
        (["plan.mcap", "--to", "csv", "-o", "x", "--rate", "0"], "rate_hz"),
        (["plan.mcap", "--to", "joint-trajectory", "-o", "x", "--angle", "deg"], "rad and N m on the joint side"),
    ],
)
def test_what_cannot_be_exported_is_refused_before_anything_is_written(folder, arguments, told):
    done = frfid(folder, "export", *arguments)
    assert done.returncode == 2 and told in done.stderr, done.stderr
    assert not list(folder.glob("x*"))


def test_python_writes_the_same_bytes(folder):
    frfid_module = pytest.importorskip("frfid")
    plan = frfid_module.Plan.load(folder / "plan.mcap")
    form = {"separator": "semicolon", "decimal": "comma", "angle": "rpm", "gear_ratio": [-105.0, 210.0, 60.0]}
    told = plan.export(folder / "python", "csv", rate_hz=250, **form)
    options = ["--separator", "semicolon", "--decimal", "comma", "--angle", "rpm", "--gear-ratio", "-105,210,60"]
    by_command = exported(folder, "plan.mcap", "--to", "csv", "--rate", 250, *options, "-o", "command")
    assert {key: told[key] for key in ["plan_id", "rate_hz", "n_runs", "duration_s"]} == {
        key: by_command[key] for key in ["plan_id", "rate_hz", "n_runs", "duration_s"]
    }
    names = [path.name for path in sorted((folder / "command").iterdir())]
    assert names == [path.name for path in sorted((folder / "python").iterdir())] and "plan.html" in names
    for name in names:
        assert (folder / "python" / name).read_bytes() == (folder / "command" / name).read_bytes(), name
    with pytest.raises(FileExistsError):
        plan.export(folder / "python")
    with pytest.raises(ValueError, match="one of csv, mat, joint-trajectory, float64-array"):
        plan.export(folder / "x", "npz")
    with pytest.raises(ValueError, match="at least 148.1"):
        plan.export(folder / "x", rate_hz=100)
    with pytest.raises(ValueError, match="the reference of joint_3 reaches"):
        frfid_module.Experiment.load(folder / "tight.toml").design().export(folder / "x")
    assert not (folder / "x").exists()
