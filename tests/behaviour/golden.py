"""Golden behaviour of the small set: what every command said, and samples of every result; written to small.json beside this file.

Run: python tests/behaviour/golden.py BINARY     after a change of behaviour that is meant, and look at the difference
"""

import json
import sys
import tempfile
from pathlib import Path

from record import record

GOLDEN = Path(__file__).with_name("small.json")
SAMPLES = 9


def summary(folder):
    """What was said in each case but for help and refusals, and samples of the results' numbers."""
    cases = {}
    for said in sorted(folder.glob("*/said.json")):
        if said.parent.name == "general":
            continue
        results = {}
        for path in sorted(said.parent.rglob("*.json")):
            result = json.loads(path.read_text())
            if isinstance(result, dict) and result.get("format") == "frfid-result":
                results[str(path.relative_to(said.parent))] = samples(result)
        cases[said.parent.name] = {"said": json.loads(said.read_text()), "results": results}
    return cases


def samples(result):
    """Some numbers of each array, from its first to its last."""
    arrays = {"frequency_hz": result["frequency_hz"]["data"], "re": result["response"]["re"], "im": result["response"]["im"]}
    for kind in ("noise", "total"):
        arrays[kind] = result[kind]["covariance"]["re"] if kind in result else []
    places = {name: [round(k * (len(data) - 1) / (SAMPLES - 1)) for k in range(SAMPLES)] if data else [] for name, data in arrays.items()}
    return {name: [arrays[name][place] for place in places[name]] for name in arrays}


def main():
    with tempfile.TemporaryDirectory() as folder:
        record(Path(sys.argv[1]).resolve(), Path(folder) / "small", small=True, demo=False)
        GOLDEN.write_text(json.dumps(summary(Path(folder) / "small"), indent=1) + "\n")


if __name__ == "__main__":
    main()
