"""The workloads, in the order of the table."""

import importlib

NAMES = ("side_by_side", "simulation", "arm", "accelerations", "poses", "synthesis", "bla", "excerpts", "reading")


def cases(name, small=False):
    """Cases of a workload whose peer is installed; what is not is said."""
    try:
        for case in importlib.import_module(name).cases(small):
            if case.peer_version:
                yield case
            else:
                print(f"LEFT OUT, {case.package} is not installed: {case.work}, {case.how}", flush=True)
    except ModuleNotFoundError as missing:
        print(f"LEFT OUT, {missing.name} is not installed: {name}", flush=True)
