"""The loops over faults, whole: `python tests/reliability`, from the root of the project, with the command that cargo built.

    python tests/reliability                  everything, half an hour or more on two cores
    python tests/reliability --share 0.1      a tenth of the damages, calls and kills
    python tests/reliability damage kills     these loops alone: damage, syscalls, kills, conformance, hostile

Prints a line for each loop and each fault; ends with 1 where there was a fault.
"""

import argparse
import time

import damage
import hostile
import kills
import recovered
import syscalls
from command import FRFID, NEEDS
from materials import materials

MOST_FLIPS = 1500  # of each material
MOST_CUTS = 1000  # but of a run, which is cut at every byte
MOST_CALLS = 200  # of a call with more, as reads and allocations
KILLS = 40


def all_damage(share):
    for material in materials():
        most_cuts = len(material.content) if material.name == "run" else MOST_CUTS
        cuts = damage.cuts(material.content, int(share * min(most_cuts, len(material.content))))
        yield damage.loop(material, cuts, what="cuts")
        flips = damage.flips(material.content, int(share * min(MOST_FLIPS, len(material.content))))
        yield damage.loop(material, flips, what="flips")


def all_syscalls(share):
    return (syscalls.loop(name, most=max(1, int(share * MOST_CALLS))) for name in syscalls.COMMANDS)


def all_kills(share):
    return (kills.loop(name, max(1, int(share * KILLS))) for name in kills.COMMANDS)


def all_conformance(share):
    yield recovered.loop(None if share == 1 else int(share * 416))


def all_hostile(share):
    return hostile.loop(int(share * 3000))


LOOPS = {"damage": all_damage, "syscalls": all_syscalls, "kills": all_kills, "conformance": all_conformance, "hostile": all_hostile}


def main():
    if FRFID is None:
        raise SystemExit(NEEDS)
    parser = argparse.ArgumentParser(description="The loops over faults, whole.")
    parser.add_argument("loops", nargs="*", metavar="LOOP", help="which ones; all without")
    parser.add_argument("--share", type=float, default=1.0, help="of the cases")
    arguments = parser.parse_args()
    if unknown := set(arguments.loops) - set(LOOPS):
        parser.error(f"{', '.join(sorted(unknown))}: needed some of {', '.join(LOOPS)}")
    n_faults = 0
    for name in arguments.loops or LOOPS:
        begin = time.monotonic()
        for tally in LOOPS[name](arguments.share):
            print(f"{tally} ({time.monotonic() - begin:.0f} s)", *tally.faults, sep="\n  ", flush=True)
            n_faults, begin = n_faults + len(tally.faults), time.monotonic()
    raise SystemExit(1 if n_faults else 0)


if __name__ == "__main__":
    main()
