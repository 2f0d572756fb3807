"""The runs of a plan as joblib's jobs, one each, and the FRF of them all.

Needs joblib: pip install joblib
Run: frfid design experiment.toml -o plan.mcap && python examples/jobs/with_joblib.py plan.mcap logs
"""

import sys

import joblib

import frfid


def main(plan, folder):
    n_runs = len(frfid.Plan.load(plan).names)
    job = joblib.delayed(frfid.run_experiment)
    files = joblib.Parallel(n_jobs=2)(job(plan, index, folder) for index in range(n_runs))
    frf = frfid.estimate_logs(folder)
    print(f"{len(files)} runs, {len(frf.frequency_hz)} lines")


if __name__ == "__main__":
    main(*sys.argv[1:])
