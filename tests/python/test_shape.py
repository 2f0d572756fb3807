"""Iterative shaping: simulated robots, testbeds of somebody's own, limits, and what is refused."""

import signal

import numpy as np
import pytest

import frfid

T = 1e-3
PLANT = frfid.Plant.single_joint(coulomb_nm=50.0)
CONTROLLER = frfid.PiController(gain=2000.0, integral_gain=16000.0, sample_time_s=T)
CHIRP = frfid.Chirp(low_hz=2.0, high_hz=40.0, duration_s=8.0, amplitude=200.0, fade_s=0.3, tail_s=1.0)
DESIRED = CHIRP.sample(sample_time_s=T)
START = DESIRED * 5e-5
OPTIONS = {"desired": DESIRED, "start": START, "sample_time_s": T, "high_hz": 40.0}


class Machine:
    """A testbed of somebody's own, around the same plant."""

    runs = 0

    def run(self, run):
        self.runs += 1
        assert run.reference_unit == "rad/s" and run.sample_time_s == T
        measured = frfid.run_closed_loop(PLANT, CONTROLLER, run.reference)
        return frfid.Record(sample_time_s=T, u=measured.u, y=measured.y, r=run.reference, position_rad=measured.position_rad)


def test_from_sticking_to_the_desired_torque():
    told = []
    shaped = frfid.shape((PLANT, CONTROLLER), progress=lambda *of: told.append(of), **OPTIONS)
    assert shaped.iterations[0]["stuck_share"] == [1.0], "it starts stuck"
    assert shaped.error < 0.15 and shaped.errors[0] > 0.5 and shaped.error == min(shaped.errors)
    assert shaped.stuck_share[0] < 0.2
    assert told[0] == (0, 6) and told == sorted(told) and len(told) == len(shaped.iterations) + 1
    assert shaped.reference.shape == START.shape and len(shaped.records) == 1
    again = frfid.run_closed_loop(PLANT, CONTROLLER, shaped.reference[0])
    np.testing.assert_array_equal(again.u, shaped.records[0].u)
    assert shaped.error_per_frequency.shape == shaped.r_to_u.response.shape[:2] and len(shaped.condition) == len(shaped.r_to_y.frequency_hz)
    assert "iteration  error %" in str(shaped) and shaped.stop in str(shaped)
    assert all(note.startswith("iteration ") for note in shaped.notes)


def test_any_object_with_run_is_shaped_alike():
    machine, told = Machine(), []
    foreign = frfid.shape(machine, progress=lambda *of: told.append(of), **OPTIONS)
    simulated = frfid.shape((PLANT, CONTROLLER), **OPTIONS)
    assert machine.runs == len(foreign.iterations) == told[-1][0]
    assert foreign.reference.tobytes() == simulated.reference.tobytes()


class Tripping(Machine):
    """A machine that breaks down in its third run, once."""

    is_broken = False

    def run(self, run):
        if self.runs == 2 and not self.is_broken:
            self.is_broken = True
            raise RuntimeError("the drive tripped")
        return super().run(run)


def test_what_was_measured_outlives_an_exception(tmp_path):
    machine, folder = Tripping(), tmp_path / "shaped"
    with pytest.raises(RuntimeError, match="the drive tripped"):
        frfid.shape(machine, folder=folder, **OPTIONS)
    assert sorted(path.parent.name for path in folder.glob("*/*.mcap")) == ["iteration_01", "iteration_02"]
    resumed = frfid.shape(machine, folder=folder, **OPTIONS)
    assert machine.runs == len(resumed.iterations), "no run is done twice"
    whole = frfid.shape(Machine(), **OPTIONS)
    np.testing.assert_array_equal(resumed.reference, whole.reference)
    np.testing.assert_array_equal(resumed.r_to_u.response, whole.r_to_u.response)


def test_another_shaping_in_the_way_is_refused_and_stays(tmp_path):
    one = {**OPTIONS, "n_iterations": 1}
    frfid.shape(Machine(), folder=tmp_path, **one)
    before = (tmp_path / "iteration_01" / "p001-m0-q0.mcap").read_bytes()
    with pytest.raises((OSError, ValueError), match="exists"):
        frfid.shape(Machine(), folder=tmp_path, **{**one, "start": 2 * START})
    assert (tmp_path / "iteration_01" / "p001-m0-q0.mcap").read_bytes() == before
    frfid.shape(Machine(), folder=tmp_path, overwrite=True, **{**one, "start": 2 * START})


def test_no_reference_exceeds_a_limit():
    class Watched(Machine):
        fastest = 0.0

        def run(self, run):
            assert run.limits == {"max_velocity": [0.05]}
            record = super().run(run)
            self.fastest = max(self.fastest, np.abs(record.y).max(), np.abs(run.reference).max())
            return record

    machine = Watched()
    shaped = frfid.shape(machine, max_velocity_rad_s=0.05, **OPTIONS)
    assert machine.fastest <= 0.05 and shaped.iterations[-1]["within_limits"]
    assert any("velocity" in note for note in shaped.notes)


def test_exceptions_and_ctrl_c_of_a_testbed_come_back():
    class Broken(Machine):
        def run(self, run):
            if self.runs == 1:
                signal.raise_signal(signal.SIGINT)
            return super().run(run)

    with pytest.raises(KeyboardInterrupt):
        frfid.shape(Broken(), **OPTIONS)

    def stop(done, total):
        if done == 2:
            raise ConnectionError("enough")

    for testbed in (Machine(), (PLANT, CONTROLLER)):
        with pytest.raises(ConnectionError, match="enough"):
            frfid.shape(testbed, progress=stop, **OPTIONS)


@pytest.mark.parametrize(
    "testbed, options, error, says",
    [
        (5, {}, TypeError, "testbed is a int"),
        (None, {"desired": DESIRED[..., :-1]}, ValueError, "desired has shape"),
        (None, {"desired": DESIRED[0]}, ValueError, r"desired has dtype float64 and shape"),
        (None, {"step": "giant"}, ValueError, "step: unknown variant `giant`, expected `damped` or `paper`"),
        (None, {"target": "fame"}, ValueError, "target: unknown variant `fame`"),
        (None, {"high_hz": 600.0}, ValueError, "high_hz"),
        (None, {"max_velocity_rad_s": 1e-3}, ValueError, "start with a smaller amplitude"),
        (None, {"max_velocity_rad_s": [1.0, 2.0]}, ValueError, "max_velocity_rad_s is"),
        (None, {"sample_time_s": 2e-3}, ValueError, "sample_time_s"),
    ],
)
def test_bad_input_is_named(testbed, options, error, says):
    with pytest.raises(error, match=says):
        frfid.shape(testbed or (PLANT, CONTROLLER), **{**OPTIONS, **options})
