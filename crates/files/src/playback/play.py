#!/usr/bin/env python3
"""Plays the trajectories of this folder on a joint_trajectory_controller, one goal and one bag for each run.

    ros2 run is not needed: source ROS 2, start the controller, move the robot to the pose, then
    python3 play.py --controller joint_trajectory_controller

Written by frfid export. It has not been run on a robot: try it with mock_components first, and keep a hand on the stop. It refuses to
start where a joint is off the first point, stops at the first goal that does not succeed, and goes on from there when called again:
runs whose bag is in bags/ are skipped. `frfid estimate bags` needs a log map.
"""

import argparse
import csv
import json
import signal
import subprocess
import sys
from pathlib import Path

import rclpy
import rosbag2_py
from control_msgs.action import FollowJointTrajectory
from control_msgs.msg import JointTolerance
from rclpy.action import ActionClient
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectory

HERE = Path(__file__).resolve().parent
BAGS = HERE / "bags"
EVENTS = "/frfid/events"
MOST_OFF_RAD = 0.05


def plays(rows):
    """Name, file and plan of everything that is played, in order; a file with all runs is played once."""
    whole = Path(rows[0]["file"]).stem
    if whole != rows[0]["run"]:
        return [(whole, rows[0]["file"], rows[0]["plan_id"])]
    found = []
    for row in rows:
        name, first = row["run"].rsplit("-q", 1)
        for repetition in range(int(row["repetitions"])):
            found.append((f"{name}-q{int(first) + repetition}", row["file"], row["plan_id"]))
    return found


def left(all_plays, bags):
    """Those without a bag."""
    return [play for play in all_plays if not (bags / play[0]).exists()]


def joints_off(names, positions, state, most_rad=MOST_OFF_RAD):
    """What is wrong with where the joints are, in words; nothing if they are at the positions."""
    wrong = []
    for name, needed in zip(names, positions):
        if name not in state:
            wrong.append(f"{name} is not in /joint_states")
        elif not abs(state[name] - needed) <= most_rad:
            wrong.append(f"{name} is at {state[name]:.4f} rad, needed {needed:.4f}")
    return wrong


def read_trajectory(path):
    """The trajectory of a file."""
    reader = rosbag2_py.SequentialReader()
    reader.open(rosbag2_py.StorageOptions(uri=str(path), storage_id="mcap"), rosbag2_py.ConverterOptions("", ""))
    types = {topic.name: topic.type for topic in reader.get_all_topics_and_types()}
    while reader.has_next():
        topic, data, _ = reader.read_next()
        if types[topic] == "trajectory_msgs/msg/JointTrajectory":
            return deserialize_message(data, JointTrajectory)
    sys.exit(f"{path} holds no trajectory: export the plan again")


class Player:
    """The node with what it talks to."""

    def __init__(self, controller, tolerance_rad):
        self.node = rclpy.create_node("frfid_player")
        self.controller, self.tolerance_rad = controller, tolerance_rad
        self.state = {}
        self.node.create_subscription(JointState, "/joint_states", self.take_state, 10)
        self.events = self.node.create_publisher(String, EVENTS, 10)
        self.action = ActionClient(self.node, FollowJointTrajectory, f"/{controller}/follow_joint_trajectory")

    def take_state(self, message):
        self.state = dict(zip(message.name, message.position))

    def wait(self, is_done, seconds, what):
        """Waits for something to happen."""
        end = self.node.get_clock().now().nanoseconds + seconds * 1e9
        while not is_done():
            if self.node.get_clock().now().nanoseconds > end:
                sys.exit(f"nothing of {what} within {seconds} s")
            rclpy.spin_once(self.node, timeout_sec=0.05)

    def check_start(self, trajectory):
        """Refuses to start from anywhere but the first point."""
        self.state = {}
        self.wait(lambda: self.state, 5, "/joint_states")
        wrong = joints_off(trajectory.joint_names, trajectory.points[0].positions, self.state)
        if wrong:
            sys.exit("the robot is not at the start; move it there slowly: " + "; ".join(wrong))

    def record(self, bag):
        """Starts the recorder, and waits until it listens."""
        own = [f"/{self.controller}/controller_state", f"/{self.controller}/state"]
        topics = [EVENTS, "/joint_states", "/dynamic_joint_states", *own]
        recorder = subprocess.Popen(["ros2", "bag", "record", "--storage", "mcap", "--output", str(bag), *topics])
        self.wait(lambda: self.node.count_subscribers(EVENTS) > 0, 15, "the recorder")
        return recorder

    def play(self, name, plan_id, trajectory):
        """Sends a run and waits for its end; what went wrong, in words, or nothing."""
        goal = FollowJointTrajectory.Goal(trajectory=trajectory)
        if self.tolerance_rad > 0:
            goal.path_tolerance = [JointTolerance(name=joint, position=self.tolerance_rad) for joint in trajectory.joint_names]
        told = {"event": "playback-start", "run": name, "plan_id": int(plan_id), "stamp_ns": self.node.get_clock().now().nanoseconds}
        self.events.publish(String(data=json.dumps(told)))
        sent = self.action.send_goal_async(goal)
        rclpy.spin_until_future_complete(self.node, sent)
        handle = sent.result()
        if not handle.accepted:
            return "the controller rejected the goal; its log says why"
        ended = handle.get_result_async()
        try:
            rclpy.spin_until_future_complete(self.node, ended)
        except KeyboardInterrupt:
            rclpy.spin_until_future_complete(self.node, handle.cancel_goal_async(), timeout_sec=2.0)
            return "stopped by Ctrl-C"
        result = ended.result().result
        if result.error_code != FollowJointTrajectory.Result.SUCCESSFUL:
            return f"error {result.error_code}: {result.error_string}"
        return None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--controller", default="joint_trajectory_controller", help="its name")
    parser.add_argument("--tolerance", type=float, default=0.0, help="path tolerance in rad; 0: the controller's own")
    arguments = parser.parse_args()
    with open(HERE / "runs.csv", newline="") as file:
        everything = plays(list(csv.DictReader(file)))
    todo = left(everything, BAGS)
    BAGS.mkdir(exist_ok=True)
    rclpy.init()
    player = Player(arguments.controller, arguments.tolerance)
    if not player.action.wait_for_server(timeout_sec=5.0):
        sys.exit(f"no action of {arguments.controller}: is it active?")
    input(f"{len(todo)} of {len(everything)} runs are left. Read plan.html, hand on the stop, then Enter. ")
    for name, file, plan_id in todo:
        trajectory = read_trajectory(HERE / file)
        player.check_start(trajectory)
        bag = BAGS / f"{name}.part-{player.node.get_clock().now().nanoseconds}"
        recorder = player.record(bag)
        wrong = player.play(name, plan_id, trajectory)
        recorder.send_signal(signal.SIGINT)
        recorder.wait()
        if wrong:
            sys.exit(f"{name}: {wrong}; nothing more is sent, {bag} is what was recorded")
        bag.rename(BAGS / name)
        print(f"{name} done")


if __name__ == "__main__":
    main()
