"""Plays the runs of an exported plan on a Franka robot, and records them: k, r, u (N m) and y per cycle, as NPZ.

    frfid export plan.mcap --to csv --rate 1000 -o played
    pip install pylibfranka numpy
    python libfranka.py played 172.16.0.2
    frfid estimate played/recorded/*.npz -o frf.json --u 'u[0]=N m' --y 'y[0]=rad/s' --r 'r[0]=rad/s' --sample-time-s 0.001    # and so on

Not run: there was no robot here; names and arguments are those of pylibfranka 0.21.3, and a test plays it on a stub. A command of FCI must keep |acceleration| < 10 rad/s^2 and |jerk| < 5000 rad/s^3, from rest to rest: give both as
[limits], frfid then refuses what the robot would. The command passes a low-pass of 100 Hz unless it is switched off (-2.0 dB and -28 degrees at
60 Hz): where r is used, use dq_d, which is recorded as r. u is tau_J, the torque behind the gear, with gravity.
"""

import csv
import sys
from pathlib import Path

import numpy as np

MOST_OFF_RAD = 0.05
LEAST_ARRIVED = 0.95  # share of packets that must arrive


def read_table(path):
    """Positions and velocities (sample, joint) of a run in rad on the joint side."""
    with open(path, newline="") as file:
        header, *rows = csv.reader(file)
    values = np.array(rows, float)
    return tuple(values[:, [name.endswith(unit) for name in header]] for unit in (" position [rad]", " velocity [rad/s]"))


def off_start(position, start):
    """How far the robot is from where the run begins, in rad."""
    return float(np.abs(np.asarray(position) - start).max())


def play(robot, velocity, start):
    """One run, a row of k, r, u and y for each packet; the library stops the robot where a limit or a packet is missed, and raises."""
    from pylibfranka import ControllerMode, JointVelocities

    off = off_start(robot.read_once().q, start)
    if off > MOST_OFF_RAD:
        sys.exit(f"off the start by {off:.3f} rad: move there first")
    control = robot.start_joint_velocity_control(ControllerMode.JointImpedance)
    rows, k = [], 0
    while k < len(velocity):
        state, period = control.readOnce()
        if k > 1000 and state.control_command_success_rate < LEAST_ARRIVED:
            sys.exit("packets are lost: the network, or the kernel")
        command = JointVelocities(list(velocity[k]))
        rows.append([k, *state.dq_d, *state.tau_J, *state.dq])
        k += max(1, round(period.to_sec() * 1000))  # behind a lost packet, the sample whose time it is
        command.motion_finished = k >= len(velocity)
        control.writeOnce(command)
    return np.array(rows)


def main():
    from pylibfranka import Robot

    folder, robot = Path(sys.argv[1]), Robot(sys.argv[2])
    (folder / "recorded").mkdir(exist_ok=True)
    with open(folder / "runs.csv", newline="") as file:
        order = list(csv.DictReader(file))
    input("Read plan.html, bring the robot to the pose, hand on the stop, then Enter. ")
    for run in order:
        position, velocity = read_table(folder / run["file"])
        for repetition in range(int(run["repetitions"])):
            target = folder / "recorded" / f"{run['run'].rsplit('-q', 1)[0]}-q{repetition}.npz"
            if not target.exists():
                rows = play(robot, velocity, position[0]).T
                np.savez(target, k=rows[0], r=rows[1:8], u=rows[8:15], y=rows[15:22])
                print(target)


if __name__ == "__main__":
    main()
