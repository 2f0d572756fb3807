"""A player that plays references on a robot in MuJoCo and records them as unkindly as it is told.

    python mujoco_player.py REFERENCE.csv LOG.mcap
    frfid calls it as a command: python examples/players/mujoco_player.py --rate-hz 800 --degrees --drop 0.01

REFERENCE: reference.py says how it looks. LOG: a CSV (`.csv`), an MCAP (`.mcap`), else a folder of rosbag2; log_files.py.
Without them they are taken from FRFID_REFERENCE and FRFID_LOG. FRFID_RATE_HZ, where given, must be the rate of the reference, and
FRFID_RUN names the run: chance differs from run to run, and is the same whenever a run is played again.

The controller starts with the reference, on its first sample, follows its quintic spline at a rate of its own, and asks for
torques. Exit code 0 when the motion was played to its end, 2 if it was refused (nothing moved, no log), 3 if it was stopped on
its way, where the log ends. What went wrong is a line on stderr.
"""

import argparse
import os
import pathlib
import sys
import zlib

import log_files
import numpy as np
import recorder
import reference
from mujoco_robot import Robot

R3 = pathlib.Path(__file__).parents[1] / "experiments" / "r3_multisine.toml"
RECORDER_OPTIONS = "rate_hz clock_ppm offset_s reads jitter_us drop double torque_quantum_nm torque_noise_nm".split()
MOST_START_OFFSET_RAD = 0.05


class Refused(Exception):
    """Why a reference is not played."""


def main(argv=None):
    options = arguments().parse_args(argv)
    try:
        is_whole = play(options)
    except (Refused, ValueError, OSError) as error:
        print(f"mujoco_player: {error}", file=sys.stderr)
        return 2
    if not is_whole:
        print(f"mujoco_player: protective stop at {options.abort_at:g} of the way", file=sys.stderr)
    return 0 if is_whole else 3


def play(options):
    """Plays and records a run; whether it was played to its end."""
    if options.reference is None or options.log is None:
        raise Refused("no reference or no log: give both, or FRFID_REFERENCE and FRFID_LOG")
    drives = {"friction": options.friction == "on", "ripple": options.ripple == "on"}
    robot = Robot.of_experiment(options.experiment, options.control_hz, **drives)
    random = np.random.default_rng([options.seed, zlib.crc32(options.run.encode())])
    factors = recorder.factors(robot.names, robot.gear_ratio, options.motor_side, options.degrees, options.flip)
    planned = reference.read(options.reference, robot.names, robot.gear_ratio, options.reference_side == "motor")
    check(planned, robot, options)
    motion, is_whole = commanded(planned, robot, options)
    torque, velocity, position = robot.play(motion.position, motion.velocity)
    signals = {f"reference {name}": getattr(motion, name) for name in reference.QUANTITIES}
    signals |= {"torque": torque, "velocity": velocity, "position": position}
    if options.ideal:
        ideal = {"u": torque, "y": velocity, "position_rad": position, "r": motion.velocity}
        np.savez(options.ideal, time_s=motion.time_s, sample_time_s=robot.loop.sample_time_s, **ideal)
    told = {name: getattr(options, name) for name in RECORDER_OPTIONS}
    unkind = recorder.Recorder(**told, factors=factors, random=random)
    stamps, recorded = unkind.record(motion.time_s, signals)
    log_files.write(pathlib.Path(options.log), robot.names, stamps, recorded, unkind.rows)
    return is_whole


def check(planned, robot, options):
    """Refuses what a robot refuses: another rate than told, motion at the ends, speed, another start than where it stands."""
    rate = (planned.time_s.size - 1) / planned.time_s[-1]
    if options.reference_hz and abs(rate / options.reference_hz - 1) > 1e-4:
        raise Refused(f"the reference has {rate:.6g} samples per second, FRFID_RATE_HZ is {options.reference_hz:g}")
    if np.abs(np.diff(planned.time_s) * rate - 1).max() > 1e-3:
        raise Refused("the samples of the reference are not evenly spaced")
    if np.abs(planned.velocity[:, [0, -1]]).max() > 1e-3:
        raise Refused("the reference does not begin and end at rest")
    for name, fastest, limit in zip(robot.names, np.abs(planned.velocity).max(axis=1), robot.max_velocity_rad_s):
        if fastest > limit:
            raise Refused(f"{name} would move at {fastest:.4g} rad/s, its limit is {limit:g} rad/s")
    for name, off in zip(robot.names, robot.pose_rad + options.start_offset_rad - planned.position[:, 0]):
        if abs(off) > MOST_START_OFFSET_RAD:
            allowed = f"allowed are {MOST_START_OFFSET_RAD} rad"
            raise Refused(f"{name} stands {off:.4g} rad off the start of the reference, {allowed}")


def commanded(planned, robot, options):
    """The motion at the controller's samples, with rests before and behind, from where the robot stands; whether it is whole."""
    step = robot.loop.sample_time_s
    before, behind = round(options.lead_s / step), round((planned.time_s[-1] + options.tail_s) / step)
    motion = reference.sample(planned, step * np.arange(-before, behind + 1))
    motion.position += (robot.pose_rad + options.start_offset_rad - planned.position[:, 0])[:, None]
    if options.low_pass_hz:
        motion = reference.low_passed(motion, options.low_pass_hz, 1 / step)
    is_whole = options.abort_at is None or (options.abort_run is not None and options.abort_run != options.run)
    return (motion, True) if is_whole else (reference.stopped(motion, options.abort_at * planned.time_s[-1]), False)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    environment = os.environ.get
    parser.add_argument("reference", nargs="?", default=environment("FRFID_REFERENCE"))
    parser.add_argument("log", nargs="?", default=environment("FRFID_LOG"))
    parser.add_argument("--ideal", metavar="NPZ", help="also every sample of the controller: time_s, u, y, r, position_rad")
    parser.add_argument("--run", default=environment("FRFID_RUN", ""), help="name of the run [FRFID_RUN]")
    rate = environment("FRFID_RATE_HZ")
    parser.add_argument("--reference-hz", type=float, default=rate, help="rate to be checked [FRFID_RATE_HZ]")
    side = "side of the gear of columns that do not say"
    parser.add_argument("--reference-side", choices=["joint", "motor"], default="joint", help=side)
    add_robot(parser.add_argument_group("robot"))
    add_recorder(parser.add_argument_group("recorder"))
    return parser


def add_robot(group):
    group.add_argument("--experiment", default=R3, help="experiment file: robot and gains [r3_multisine.toml]")
    group.add_argument("--control-hz", type=float, help="rate of the controller [of the experiment, 1000]")
    group.add_argument("--friction", choices=["on", "off"], default="on", help="Coulomb friction")
    group.add_argument("--ripple", choices=["on", "off"], default="on", help="torque ripple")
    group.add_argument("--low-pass-hz", type=float, default=0.0, help="low-pass between plan and controller, 0 for none")
    group.add_argument("--start-offset-rad", type=float, default=0.0, help="every joint stands off its pose by this")
    group.add_argument("--abort-at", type=float, metavar="SHARE", help="protective stop at this share of the way")
    group.add_argument("--abort-run", metavar="NAME", help="the only run that is stopped")
    group.add_argument("--lead-s", type=float, default=1.3, help="recorded rest before the motion")
    group.add_argument("--tail-s", type=float, default=0.7, help="recorded rest behind it")


def add_recorder(group):
    group.add_argument("--rate-hz", type=float, default=1000.0, help="rows per second of its own clock")
    group.add_argument("--clock-ppm", type=float, default=120.0, help="its clock is fast by this")
    group.add_argument("--offset-s", type=float, default=3.7, help="what its clock says when recording begins")
    group.add_argument(
        "--reads",
        choices=["between", "cycle", "late"],
        default="between",
        help="signals at its own instants; the last sample of the controller with its time; that with the recorder's",
    )
    group.add_argument("--jitter-us", type=float, default=0.0, help="standard deviation of the stamps")
    group.add_argument("--drop", type=float, default=0.0, metavar="SHARE", help="rows that are lost")
    group.add_argument("--double", type=float, default=0.0, metavar="SHARE", help="rows that are written twice")
    group.add_argument("--degrees", action="store_true", help="positions in deg, velocities in deg/s")
    group.add_argument("--motor-side", action="store_true", help="in front of the gears, with the sign of their ratio")
    group.add_argument("--flip", action="append", default=[], metavar="JOINT[:SIGNAL]", help="axis, or sensor, of the other sign")
    group.add_argument("--torque-quantum-nm", type=float, default=0.0, help="resolution of the torque on the joint side")
    group.add_argument("--torque-noise-nm", type=float, default=0.0, help="rms of white noise on it")
    group.add_argument("--seed", type=int, default=1, help="of everything by chance")


if __name__ == "__main__":
    sys.exit(main())
