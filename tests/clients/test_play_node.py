"""The node that frfid export writes beside trajectories: its start check, order and resumption, and that it stops, with ROS stubbed."""

import json
import pathlib
import sys
import types

import pytest

NODE = pathlib.Path(__file__).parents[2] / "crates" / "files" / "src" / "playback" / "play.py"
STUBBED = [
    "rclpy",
    "rclpy.action",
    "rclpy.serialization",
    "rosbag2_py",
    "control_msgs.action",
    "control_msgs.msg",
    "sensor_msgs.msg",
    "std_msgs.msg",
    "trajectory_msgs.msg",
]


class Anything(types.ModuleType):
    """A module of which every name exists."""

    def __getattr__(self, name):
        return types.SimpleNamespace


@pytest.fixture
def node(monkeypatch):
    for name in STUBBED:
        monkeypatch.setitem(sys.modules, name, Anything(name))
    module = types.ModuleType("play")
    module.__file__ = str(NODE)
    exec(compile(NODE.read_text(), str(NODE), "exec"), module.__dict__)
    return module


def row(run, repetitions, file, plan_id="7"):
    return {"run": run, "repetitions": str(repetitions), "file": file, "plan_id": plan_id}


def test_every_repetition_is_played_in_order(node):
    rows = [row("glide-q0", 1, "glide-q0.mcap"), row("p000-m0-q0", 2, "p000-m0-q0.mcap"), row("p000-m1-q0", 1, "p000-m1-q0.mcap")]
    assert [play[:2] for play in node.plays(rows)] == [
        ("glide-q0", "glide-q0.mcap"),
        ("p000-m0-q0", "p000-m0-q0.mcap"),
        ("p000-m0-q1", "p000-m0-q0.mcap"),
        ("p000-m1-q0", "p000-m1-q0.mcap"),
    ]


def test_a_campaign_is_played_once_and_a_single_run_as_often_as_it_says(node):
    assert node.plays([row("p000-m0-q0", 2, "campaign.mcap"), row("p000-m1-q0", 2, "campaign.mcap")]) == [("campaign", "campaign.mcap", "7")]
    assert node.plays([row("p000-m0-q0", 3, "campaign.mcap")]) == [("campaign", "campaign.mcap", "7")]
    assert len(node.plays([row("p000-m0-q0", 3, "p000-m0-q0.mcap")])) == 3


def test_runs_with_a_bag_are_skipped_and_those_that_were_stopped_are_not(node, tmp_path):
    everything = node.plays([row("p000-m0-q0", 3, "p000-m0-q0.mcap")])
    (tmp_path / "p000-m0-q1").mkdir()
    (tmp_path / "p000-m0-q2.part-99").mkdir()
    assert [play[0] for play in node.left(everything, tmp_path)] == ["p000-m0-q0", "p000-m0-q2"]


def test_a_joint_that_is_off_or_unknown_is_named(node):
    names, first = ["a", "b"], [1.0, -1.0]
    assert node.joints_off(names, first, {"b": -1.04, "a": 0.96, "c": 0.0}) == []
    [wrong] = node.joints_off(names, first, {"a": 1.0, "b": -1.0501})
    assert wrong == "b is at -1.0501 rad, needed -1.0000"
    assert node.joints_off(names, first, {"a": 1.0}) == ["b is not in /joint_states"]
    assert node.joints_off(names, first, {"a": float("nan"), "b": -1.0}), "no number is no position"


class Goal:
    """A controller that ends a goal with a code."""

    def __init__(self, accepted, code):
        self.accepted = accepted
        result = types.SimpleNamespace(error_code=code, error_string="path tolerance")
        self.ended = types.SimpleNamespace(result=lambda: types.SimpleNamespace(result=result))

    def get_result_async(self):
        return self.ended


def player_of(node, goal, told):
    player = object.__new__(node.Player)
    clock = types.SimpleNamespace(now=lambda: types.SimpleNamespace(nanoseconds=12))
    player.node = types.SimpleNamespace(get_clock=lambda: clock)
    player.tolerance_rad = 0.0
    player.events = types.SimpleNamespace(publish=lambda message: told.append(json.loads(message.data)))
    sent = types.SimpleNamespace(result=lambda: goal)
    player.action = types.SimpleNamespace(send_goal_async=lambda goal: sent)
    return player


@pytest.mark.parametrize("accepted, code, wrong", [(True, 0, None), (True, -4, "error -4: path tolerance"), (False, 0, "rejected")])
def test_a_goal_that_does_not_succeed_is_told(node, monkeypatch, accepted, code, wrong):
    node.rclpy.spin_until_future_complete = lambda *_, **__: None
    action = types.SimpleNamespace(Goal=types.SimpleNamespace, Result=types.SimpleNamespace(SUCCESSFUL=0))
    node.FollowJointTrajectory, node.String = action, types.SimpleNamespace
    told = []
    found = player_of(node, Goal(accepted, code), told).play("p000-m0-q1", "7", types.SimpleNamespace(joint_names=["a"]))
    assert found == wrong if wrong is None else wrong in found
    assert told == [{"event": "playback-start", "run": "p000-m0-q1", "plan_id": 7, "stamp_ns": 12}]
