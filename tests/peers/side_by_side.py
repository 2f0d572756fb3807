"""frfid beside best-linear-approximation and pyFRF: the same answers where they are right, and what each gives.

    python tests/peers/side_by_side.py [--realizations 128]

Needs the wheel, numpy and scipy, `pip install pyFRF` and, on Python 3.12 or later, `pip install best-linear-approximation`; what is
not installed is left out, and said. Ends with 1 if an answer of frfid is wrong, or differs by more than is allowed. "Off" are the largest
errors against the known answer, `s` in standard deviations, of which an entry may err by 6.
"""

import argparse
import importlib.util
import itertools
import sys
import warnings

import capabilities
from table import print_capabilities, print_rows

PACKAGES = {"best_linear_approximation": "best-linear-approximation", "pyFRF": "pyFRF"}


def missing():
    return [name for module, name in PACKAGES.items() if importlib.util.find_spec(module) is None]


def all_rows(n_realizations):
    """Rows of the packages that are here; imported only then."""
    left_out = missing()
    parts = []
    if PACKAGES["best_linear_approximation"] not in left_out:
        import campaigns
        import hard_cases

        parts += [campaigns.rows(n_realizations), hard_cases.rows()]
    if PACKAGES["pyFRF"] not in left_out:
        import structures

        parts.append(structures.rows())
    return itertools.chain(*parts)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--realizations", type=int, default=128, help="of each of the 54 campaigns")
    options = parser.parse_args()
    for name in missing():
        print(f"{name} is not installed: its scenarios are left out")
    rows = list(print_rows(all_rows(options.realizations)))
    print()
    print_capabilities(capabilities.rows())
    failed = [row for row in rows if not row.passes]
    print(f"\n{len(rows)} rows, {sum(row.cases for row in rows)} comparisons, {len(failed)} rows failed")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    warnings.simplefilter("error", RuntimeWarning)
    main()
