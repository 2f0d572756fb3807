"""Lesson 7: the whole workflow from one description, on a machine of your own.

Run: python examples/07_own_testbed.py
"""

import pathlib
import warnings

import numpy as np

import frfid

experiment = frfid.Experiment.load(pathlib.Path(__file__).parent / "experiments" / "multisine.toml")
plan = experiment.design()
print(f"{plan!r}, the first of them {plan[0]!r}")
peaks = plan.predict()["peaks"]
print(f"predicted peaks: {peaks['effort_nm'][0]:.0f} N m, {peaks['velocity_rad_s'][0]:.3f} rad/s")


class MyRobot:
    """Anything with run(run) -> Record. Here it is a simulation; a driver of a real robot goes to run.start_rad, up to
    run.velocity_rad_s, plays run.reference, and stops where one of run.limits is reached."""

    def __init__(self):
        self.plant = frfid.Plant.load(pathlib.Path(__file__).parent / "robots" / "paper_joint.toml")

    def run(self, run):
        measured = self.plant.simulate(run.reference, sample_time_s=run.sample_time_s)
        return frfid.Record(sample_time_s=run.sample_time_s, u=measured.u, y=measured.y, r=run.reference)


records = plan.run(MyRobot())
with warnings.catch_warnings(record=True) as said:  # what looks wrong is a UserWarning; here it is the lesson
    warnings.simplefilter("always")
    frf = plan.estimate(records)
    same = plan.estimate(plan.run())  # without a testbed the described robot is simulated
print(f"{frf!r}")
print("\n".join(sorted({f"warned: {warning.message}" for warning in said})))
print("made with seed", frf.provenance["seed"], "from the description with the hash", frf.provenance["config_sha256"][:12])

print("the simulated robot gives the same FRF to the last bit:", np.array_equal(same.response, frf.response))

pathlib.Path("07_own_testbed.svg").write_text(frf.to_svg(), encoding="utf-8")
print("07_own_testbed.svg: its Bode diagram, with the 95 % region")
