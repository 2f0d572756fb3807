"""The host loops of examples/players on stubs of their robots: every sample is sent once, recorded, and a robot that is off is not moved."""

import csv
import datetime
import importlib.util
import pathlib
import sys
import types

import numpy as np
import pytest

PLAYERS = pathlib.Path(__file__).parents[2] / "examples" / "players"
N = 40


def loop(name):
    spec = importlib.util.spec_from_file_location(name, PLAYERS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def table(tmp_path):
    """A run of seven joints as frfid export writes it, with its positions and velocities."""
    position, velocity = np.random.default_rng(3).normal(size=(2, N, 7)) / 100
    names = [f"joint_{joint} {signal}" for joint in range(7) for signal in ("position [rad]", "velocity [rad/s]", "acceleration [rad/s^2]")]
    with open(tmp_path / "run.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["k", "time_s", "plan_id", *names])
        for k in range(N):
            writer.writerow([k, k / 500, 7, *np.stack([position[k], velocity[k], 0 * velocity[k]], axis=1).ravel()])
    return tmp_path / "run.csv", position, velocity


class Universal:
    """Control and receive of a robot that follows at once, a stop at a sample where one is asked for."""

    def __init__(self, start, stops_at=None):
        self.sent, self.start, self.stops_at = [], start, stops_at
        self.is_stopped = False

    def initPeriod(self):
        return datetime.timedelta()

    def waitPeriod(self, begin):
        assert isinstance(begin, datetime.timedelta)

    def speedJ(self, velocity, acceleration, time_s):
        assert isinstance(velocity, list) and acceleration == 40.0 and time_s == 0.002
        self.sent.append(velocity)

    def speedStop(self, deceleration):
        self.is_stopped = True

    def getActualQ(self):
        return list(self.start)

    def getActualQd(self):
        return self.sent[-1] if self.sent else [0.0] * 7

    def getActualCurrent(self):
        return [0.5] * 7

    def getTimestamp(self):
        return 0.002 * len(self.sent)

    def getSpeedScaling(self):
        return 1.0

    def isProtectiveStopped(self):
        return len(self.sent) == self.stops_at

    isEmergencyStopped = lambda self: False  # noqa: E731


def test_the_loop_for_universal_robots(table):
    path, position, velocity = table
    ur = loop("ur_rtde")
    k, *signals = ur.read_table(path)
    assert (k == np.arange(N)).all() and (signals[0] == position).all() and (signals[1] == velocity).all()
    robot = Universal(position[0])
    rows, wrong = ur.play(robot, robot, (k, *signals))
    assert wrong is None and robot.sent == velocity.tolist() and robot.is_stopped
    assert [row[1] for row in rows] == list(range(N)) and len(rows[0]) == 2 + 3 * 7
    stopped = Universal(position[0], stops_at=10)
    rows, wrong = ur.play(stopped, stopped, (k, *signals))
    assert len(rows) == 10 and "a stop" in wrong and stopped.is_stopped
    elsewhere = Universal(position[0] + 0.06)
    rows, wrong = ur.play(elsewhere, elsewhere, (k, *signals))
    assert not elsewhere.sent and "off the start by 0.060 rad" in wrong
    assert "velocity off" in ur.trouble(position[0], velocity[0] + 0.4, position[0], velocity[0], False)


class Franka:
    """A robot that loses a packet now and then."""

    def __init__(self, q, lost=()):
        self.q, self.lost, self.sent = q, lost, []

    def read_once(self):
        return types.SimpleNamespace(q=list(self.q))

    def start_joint_velocity_control(self, mode):
        assert mode == "impedance"
        return self

    def readOnce(self):
        period = 0.002 if len(self.sent) in self.lost else 0.001
        state = types.SimpleNamespace(dq_d=[0.0] * 7, tau_J=[1.0] * 7, dq=[2.0] * 7, control_command_success_rate=1.0)
        return state, types.SimpleNamespace(to_sec=lambda: period)

    def writeOnce(self, command):
        self.sent.append(command)


def test_the_loop_for_franka(table, monkeypatch):
    path, position, velocity = table
    commands = types.SimpleNamespace(JointImpedance="impedance")
    library = types.SimpleNamespace(ControllerMode=commands, JointVelocities=lambda dq: types.SimpleNamespace(dq=dq, motion_finished=False))
    monkeypatch.setitem(sys.modules, "pylibfranka", library)
    franka = loop("libfranka")
    found = franka.read_table(path)
    assert (found[0] == position).all() and (found[1] == velocity).all()
    robot = Franka(position[0], lost=[5])
    rows = franka.play(robot, found[1], found[0][0])
    assert list(rows[:, 0]) == [*range(6), *range(7, N)], "the sample whose time it is"
    assert [command.dq for command in robot.sent] == velocity[rows[:, 0].astype(int)].tolist()
    assert [command.motion_finished for command in robot.sent] == [False] * (N - 2) + [True]
    elsewhere = Franka(position[0] + 0.06)
    with pytest.raises(SystemExit, match="off the start by 0.060 rad"):
        franka.play(elsewhere, found[1], found[0][0])
    assert not elsewhere.sent
