"""The runs of a plan as Dask's tasks, one each, and the FRF of them all. On a cluster its workers share the folder.

Needs Dask: pip install "dask[distributed]"
Run: frfid design experiment.toml -o plan.mcap && python examples/jobs/with_dask.py plan.mcap logs
"""

import sys

from dask.distributed import Client

import frfid


def main(plan, folder):
    n_runs = len(frfid.Plan.load(plan).names)
    with Client(n_workers=2, threads_per_worker=1, dashboard_address=None) as client:  # a cluster on this machine
        tasks = [client.submit(frfid.run_experiment, plan, index, folder, pure=False) for index in range(n_runs)]
        files = client.gather(tasks)
    frf = frfid.estimate_logs(folder)
    print(f"{len(files)} runs, {len(frf.frequency_hz)} lines")


if __name__ == "__main__":
    main(*sys.argv[1:])
