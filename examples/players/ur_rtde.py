"""Plays the runs of an exported plan on a Universal Robot, and records them: k, r, u (A) and y per cycle, as CSV.

    frfid export plan.mcap --to csv --rate 500 -o played
    pip install ur-rtde numpy
    python ur_rtde.py played 192.168.1.10
    frfid estimate played/recorded/*.csv -o frf.json --u u_0=A --y y_0=rad/s --r r_0=rad/s --time time_s=s    # and so on

Not run: there was no robot and no URSim here; names and arguments are those of ur-rtde 1.6.5, and a test plays it on a stub. Speed slider at 100 %, hand on the stop, the first run at a tenth of the amplitudes; read plan.html.
u is the motor current in A, not a torque.
"""

import csv
import sys
from pathlib import Path

import numpy as np

RATE_HZ = 500  # 125 for CB3
ACCELERATION = 40.0  # rad/s^2: must exceed the plan's
MOST_OFF_RAD = 0.05
MOST_VELOCITY_ERROR = 0.3  # rad/s between what is asked for and what is measured


def read_table(path):
    """k, positions and velocities (sample, joint) of a run in rad on the joint side."""
    with open(path, newline="") as file:
        header, *rows = csv.reader(file)
    values = np.array(rows, float)
    column = {unit: [place for place, name in enumerate(header) if name.endswith(unit)] for unit in (" position [rad]", " velocity [rad/s]")}
    return values[:, 0].astype(int), *(values[:, places] for places in column.values())


def trouble(position, velocity, start, asked, is_first):
    """Why to stop, or nothing."""
    if is_first and np.abs(position - start).max() > MOST_OFF_RAD:
        return f"off the start by {np.abs(position - start).max():.3f} rad: move there first"
    if np.abs(velocity - asked).max() > MOST_VELOCITY_ERROR:
        return f"velocity off by {np.abs(velocity - asked).max():.3f} rad/s"
    return None


def play(control, receive, table):
    """One run; its rows, and why it was stopped, if it was."""
    k, position, velocity = table
    rows = []
    for place, asked in enumerate(velocity):
        begin = control.initPeriod()
        found, measured = np.array(receive.getActualQ()), np.array(receive.getActualQd())
        wrong = trouble(found, measured, position[0], asked, place == 0)
        if wrong or receive.isProtectiveStopped() or receive.isEmergencyStopped() or receive.getSpeedScaling() < 0.999:
            control.speedStop(2.0)
            return rows, wrong or "a stop, or the speed slider is not at 100 %"
        control.speedJ(list(asked), ACCELERATION, 1 / RATE_HZ)
        rows.append([receive.getTimestamp(), k[place], *asked, *receive.getActualCurrent(), *measured])
        control.waitPeriod(begin)
    control.speedStop(2.0)
    return rows, None


def main():
    import rtde_control
    import rtde_receive

    folder, host = Path(sys.argv[1]), sys.argv[2]
    control, receive = rtde_control.RTDEControlInterface(host, RATE_HZ), rtde_receive.RTDEReceiveInterface(host, RATE_HZ)
    (folder / "recorded").mkdir(exist_ok=True)
    with open(folder / "runs.csv", newline="") as file:
        order = list(csv.DictReader(file))
    input("Read plan.html. The robot moves to the pose with Enter, slowly. ")
    control.moveJ(list(read_table(folder / order[0]["file"])[1][0]), 0.2, 0.2)
    for run in order:
        table = read_table(folder / run["file"])
        for repetition in range(int(run["repetitions"])):
            target = folder / "recorded" / f"{run['run'].rsplit('-q', 1)[0]}-q{repetition}.csv"
            if target.exists():
                continue
            rows, wrong = play(control, receive, table)
            if wrong:
                sys.exit(f"{target.stem}: {wrong}; nothing more is played")
            names = [f"{signal}_{joint}" for signal in "ruy" for joint in range(6)]
            np.savetxt(target, rows, delimiter=",", header=",".join(["time_s", "k", *names]), comments="", fmt="%.17g")
            print(target)


if __name__ == "__main__":
    main()
