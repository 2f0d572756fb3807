"""The workflow of the command line, in Python and on testbeds written in Python."""

import pathlib
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import frfid

EXAMPLES = pathlib.Path(__file__).parents[2] / "examples" / "experiments"

SMALL = """
seed = 1
sample_time_s = 0.001

[robot.single_joint]
motor_inertia_kg_m2 = 35.0
link_inertia_kg_m2 = 150.0
damping_nms_per_rad = 800.0
stiffness_nm_per_rad = 1.5e5
viscous_nms_per_rad = 3000.0

[multisine]
low_hz = 2.0
high_hz = 60.0
resolution_hz = 0.5
n_lines = 20
peak_nm = [150.0]

[averaging]
realizations = 3
periods = 2
"""


@pytest.fixture
def experiment(tmp_path):
    path = tmp_path / "experiment.toml"
    path.write_text(SMALL)
    return frfid.Experiment.load(path)


class Machine:
    """A testbed of somebody's own: a plant and a counter."""

    def __init__(self):
        self.plant = frfid.Plant.single_joint(damping_nms_per_rad=800.0, viscous_nms_per_rad=3000.0)
        self.runs = 0

    def run(self, run):
        self.runs += 1
        measured = self.plant.simulate(run.reference, sample_time_s=run.sample_time_s)
        return frfid.Record(sample_time_s=run.sample_time_s, u=measured.u, y=measured.y, r=run.reference)


def test_from_description_to_frf(experiment):
    plan = experiment.design()
    assert len(plan) == 3 and plan.names == ["p000-m0-q0", "p001-m0-q0", "p002-m0-q0"]
    assert plan.robot_time_s == pytest.approx(sum(plan.reference(k).shape[-1] for k in range(3)) * 1e-3)
    told = []
    records = plan.run(progress=lambda *of: told.append(of))
    assert told[-1] == (3, 3) and told == sorted(told)
    frf = plan.estimate(records)
    truth = frfid.Plant.single_joint(damping_nms_per_rad=800.0, viscous_nms_per_rad=3000.0)
    np.testing.assert_allclose(frf.response, truth.frf(frf.frequency_hz, sample_time_s=1e-3), rtol=1e-6)
    assert frf.noise_degrees_of_freedom == 3 and frf.total_degrees_of_freedom == 2
    assert (frf.input_names, frf.output_units) == (["joint_1 torque"], ["rad/s"])
    assert frf.provenance["seed"] == "1" and len(frf.provenance["config_sha256"]) == 64
    assert frf.provenance["effort_peak_nm"] == str([float(max(np.abs(record.u).max() for record in records))])
    assert 149.0 < plan.predict()["peaks"]["effort_nm"][0] <= 150.0 + 1e-9


def test_the_same_seed_gives_the_same_bytes_whatever_the_number_of_jobs(experiment):
    bytes_of = lambda records: [record.y.tobytes() for record in records]
    one, many = (bytes_of(experiment.design().run(jobs=jobs)) for jobs in (1, 4))
    assert one == many


def test_any_object_with_run_is_a_testbed(experiment):
    machine, plan, told = Machine(), experiment.design(), []
    records = plan.run(machine, progress=lambda *of: told.append(of))
    assert machine.runs == 3 and told == [(0, 3), (1, 3), (2, 3), (3, 3)]
    simulated = plan.run()
    assert [record.y.tobytes() for record in records] == [record.y.tobytes() for record in simulated]
    assert plan.estimate(records).response.tobytes() == plan.estimate(simulated).response.tobytes()


@pytest.fixture
def on_constant_velocity(tmp_path):
    """The plan of section 7, but for fewer and shorter runs, with its plant and controller."""
    text = (EXAMPLES / "r3_multisine.toml").read_text()
    for old, new in [
        ("../robots", str(EXAMPLES.parent / "robots")), ("resolution_hz = 0.1", "resolution_hz = 0.5"), ("n_lines = 80", "n_lines = 9"),
        ("glides = 5", "glides = 1"), ("realizations = 10", "realizations = 1"), ("repetitions = 5", "repetitions = 1"),
    ]:  # fmt: skip
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "r3.toml").write_text(text)
    plant = frfid.Plant.load(EXAMPLES.parent / "robots" / "manutec_r3.toml")
    controller = frfid.PiController(
        gain=[1500.0, 1500.0, 400.0], integral_gain=[12000.0, 12000.0, 3200.0], sample_time_s=1e-3
    )
    return frfid.Experiment.load(tmp_path / "r3.toml").design(), plant, controller


def test_a_testbed_learns_start_velocity_and_limits(on_constant_velocity):
    plan, plant, controller = on_constant_velocity
    assert [run.name for run in plan] == plan.names and plan[-1].name == plan.names[-1]
    with pytest.raises(IndexError, match=f"the plan has {len(plan)} runs"):
        plan[len(plan)]
    share_of_travel = []

    class Bench:
        def run(self, run):
            assert run.reference_unit == "rad/s" and run.reference.shape[0] == 3
            assert np.all(run.start_rad * run.velocity_rad_s < 0.0), "it starts half its way before the pose"
            record = frfid.run_closed_loop(
                plant, controller, run.reference, velocity_rad_s=list(run.velocity_rad_s), start_rad=list(run.start_rad)
            )
            from_pose = record.position_rad - record.position_rad[:, :1] + run.start_rad[:, None]
            share_of_travel.append(np.abs(from_pose).max(axis=1) / run.limits["max_travel"])
            return record

    plan.run(Bench())
    assert len(share_of_travel) == len(plan) == 4 and 0.9 < np.max(share_of_travel) < 1.0


def test_a_testbed_for_the_bare_reference_is_refused_on_a_constant_velocity(on_constant_velocity, experiment):
    class FromRest:
        asked = 0

        def run(self, reference):
            self.asked += 1
            return record(1e-3, reference)

    machine = FromRest()
    assert len(experiment.design().run(machine)) == machine.asked == 3
    with pytest.raises(TypeError, match=r"run glide-q0 starts .* needed run\(run: frfid.Run\)"):
        on_constant_velocity[0].run(machine)
    assert machine.asked == 3


def test_an_exception_of_the_testbed_comes_back_as_it_was(experiment):
    class Broken(Machine):
        def run(self, run):
            raise ConnectionError("the robot does not answer")

    with pytest.raises(ConnectionError, match="does not answer"):
        experiment.design().run(Broken())


def test_ctrl_c_reaches_the_testbed_in_the_middle_of_its_run(experiment):
    class Robot(Machine):
        stopped = False

        def run(self, run):
            try:
                signal.raise_signal(signal.SIGINT)
                time.sleep(10.0)
            except KeyboardInterrupt:
                self.stopped = True
                raise

    robot = Robot()
    with pytest.raises(KeyboardInterrupt):
        experiment.design().run(robot)
    assert robot.stopped


def record(sample_time_s, signal):
    return frfid.Record(sample_time_s=sample_time_s, u=signal, y=signal)


@pytest.mark.parametrize(
    "run, error, says",
    [
        (None, TypeError, "testbed is a Odd, needed an object with run"),
        (lambda self, run: 5, TypeError, "returned a int"),
        (lambda self, reference: record(1e-3, [reference] * 2), ValueError, "a batch of 2 runs"),
        (lambda self, run: record(2e-3, run.reference), ValueError, "sample_time_s of the record is 0.002"),
        (lambda self, r: record(1e-3, r), ValueError, "u has dtype object"),
    ],
)
def test_testbeds_that_do_not_fit_are_refused(experiment, run, error, says):
    odd = type("Odd", (), {"run": run} if run else {})()
    with pytest.raises(error, match=says):
        experiment.design().run(odd)


def test_a_missing_run_is_named_and_left_out(experiment):
    plan = experiment.design()
    records = plan.run()
    with pytest.raises(ValueError, match="2 records were given, needed one for each of 3 runs"):
        plan.estimate(records[:2])
    frf = plan.estimate([records[0], None, records[2]])  # with one experiment per realization nothing else is lost
    assert frf.total_degrees_of_freedom == 1


def test_what_is_wrong_in_a_description_is_pointed_at(tmp_path):
    path = tmp_path / "experiment.toml"
    path.write_text(SMALL.replace("peak_nm", "peak_Nm"))
    with pytest.raises(ValueError, match=r"experiment\.toml:1\d:1: unknown field `peak_Nm`(.|\n)*\^\^\^"):
        frfid.Experiment.load(path)
    with pytest.raises(FileNotFoundError):
        frfid.Experiment.load(tmp_path / "nowhere.toml")


@pytest.mark.parametrize("name", sorted(path.name for path in EXAMPLES.glob("*.toml")))
def test_the_examples_load(name):
    plan = frfid.Experiment.load(EXAMPLES / name).design()
    assert len(plan) >= 1 and plan.reference(0).flags.c_contiguous


def frfid_command(*arguments, **options):
    return subprocess.run([sys.executable, "-c", "import sys; from frfid._cli import main; sys.exit(main())", *arguments],
                          capture_output=True, text=True, timeout=60, **options)


def test_the_command_is_in_the_wheel(tmp_path):
    shown = frfid_command("--version")
    assert (shown.returncode, shown.stderr) == (0, "") and frfid.__version__ in shown.stdout
    assert frfid_command("nonsense").returncode == 2
    (tmp_path / "experiment.toml").write_text(SMALL)
    assert frfid_command("check", "experiment.toml", cwd=tmp_path).returncode == 0
