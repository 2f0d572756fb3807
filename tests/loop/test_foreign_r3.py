"""The foreign r3 on a constant velocity, by commands alone from frfid init to the report: played once, judged in many ways."""

import csv

import numpy as np
import pytest
from foreign import changed, log_map, off_db, player, robot
from workshop import MARKS, ROOT, done

import frfid as library

pytest.importorskip("tomllib", reason="robot files are read with Python 3.11's tomllib")
pytest.importorskip("mujoco", reason="the foreign robot needs MuJoCo: pip install mujoco")
pytestmark = MARKS
SHORT = {"realizations": 3, "peak_of_velocity": 0.5, "repetitions": 2, "glides": 2, "lead_in_s": 3.5, "travel_rad": [0.128, 0.112, 0.12]}
DIAGONAL = ([0, 1, 2], [0, 1, 2])
LOW_PASS_SAMPLES = 2  # group delay of the player's low-pass, 2.25 ms, to which its recordings are aligned


@pytest.fixture(scope="module")
def r3(tmp_path_factory):
    """Designed, exported, played and estimated; the robot's truth stands beside."""
    folder = tmp_path_factory.mktemp("r3")
    done(folder, "init r3-multisine -o template.toml")
    (folder / "r3.toml").write_text(changed((folder / "template.toml").read_text(), **SHORT))
    (folder / "map.toml").write_text(log_map())
    (folder / "ideal").mkdir()
    done(folder, "design r3.toml -o plan.mcap")
    done(folder, "export plan.mcap --to csv -o played")
    done(folder, "run plan.mcap -o logs --map map.toml --player", player(folder=folder / "ideal"))
    done(folder, "estimate logs -o frf.json --report report.html")
    return folder


@pytest.fixture(scope="module")
def truth(r3):
    experiment = ROOT / "examples" / "experiments" / "r3_multisine.toml"
    return robot(experiment).truth(library.load(r3 / "frf.json").frequency_hz)


def test_the_diagonal_is_the_truth_to_one_and_a_half_decibels(r3, truth):
    worst = off_db(library.load(r3 / "frf.json").response, truth).max(axis=0)
    print(f"worst line of each axis: {worst.round(2)} dB")
    assert worst.max() < 1.5
    assert "<html" in (r3 / "report.html").read_text()


def test_the_stated_region_holds_the_truth(r3, truth):
    """That at the pose, while the arm changes along its way: docs/theory.md says how much that takes from the 95 %."""
    frf = library.load(r3 / "frf.json")
    freedom = frf.total_degrees_of_freedom
    quantile = freedom * np.expm1(-np.log(0.05) / freedom)  # of F(2, 2 freedom)
    holds = np.abs(frf.response - truth) <= np.sqrt(quantile * frf.total_variance)
    shares = holds.mean(axis=0)
    print(f"lines at which the 95 % region holds the truth:\n{shares.round(2)}")
    assert shares.min() >= 0.75 and shares.mean() >= 0.85 and shares[DIAGONAL].min() >= 0.8


def first_samples(r3):
    with open(r3 / "played" / "runs.csv", newline="") as file:
        return {row["run"]: int(row["run_first_k"]) for row in csv.DictReader(file)}


def ideal_record(r3, run, first):
    """A run as its controller saw it, cut by the plan alone: every sample, no clock, no units, no losses."""
    ideal = np.load(r3 / "ideal" / f"{run.name}.npz")
    begin = np.searchsorted(ideal["time_s"], -1e-9) + first[run.name.rsplit("-q", 1)[0] + "-q0"] + LOW_PASS_SAMPLES
    cut = slice(begin, begin + run.reference.shape[1])
    parts = {name: ideal[name][:, cut].copy() for name in ("u", "y", "r", "position_rad")}
    return library.Record(sample_time_s=run.sample_time_s, **parts)


@pytest.mark.filterwarnings("ignore:what remains of the torque ripple")
def test_hostile_logs_lead_to_the_same_as_ideal_ones(r3):
    plan, first = library.Plan.load(str(r3 / "plan.mcap")), first_samples(r3)
    expected = plan.estimate([ideal_record(r3, run, first) for run in plan]).response
    found = library.load(r3 / "frf.json").response
    error = np.sqrt((np.abs(found / expected - 1) ** 2).mean(axis=0))[DIAGONAL]
    print(f"rms over the lines: {error}")
    assert error.max() < 1e-3


def recordings(r3):
    """In the order in which they were played."""
    return [r3 / "logs" / "player" / "recordings" / f"{run.name}.csv" for run in library.Plan.load(str(r3 / "plan.mcap"))]


def imported(r3, folder, *files):
    told = done(folder, "import", *files, "--plan", r3 / "plan.mcap", "--map", r3 / "map.toml", "-o", "logs")
    assert (len(told["imported"]), told["missing"], told["unused"]) == (20, [], [])
    done(folder, "estimate logs -o frf.json")
    expected, found = (library.load(each / "frf.json").response for each in (r3, folder))
    error = np.sqrt((np.abs(found / expected - 1) ** 2).mean(axis=0))
    print(f"import against run by run:\n{error}")
    assert error.max() < 1e-4
    return told["imported"]


def test_recordings_in_disorder(r3, tmp_path):
    """Files by names that say nothing, in an order that says nothing."""
    (tmp_path / "measured").mkdir()
    files = recordings(r3)
    order = np.random.default_rng(1).permutation(len(files))
    for place, which in enumerate(order):
        (tmp_path / "measured" / f"Scope {place:02d}.csv").symlink_to(files[which])
    imported(r3, tmp_path, "measured")


def test_one_recording_of_the_whole_campaign(r3, tmp_path):
    """All runs by one clock, with time between them in which nothing was recorded."""
    lines, end_ms = [], 0.0
    for path in recordings(r3):
        header, *rows = path.read_text().splitlines()
        begin_ms = float(rows[0].split(",")[0])
        lines += [header] if not lines else []
        for row in rows:
            time_ms, rest = row.split(",", 1)
            lines.append(f"{float(time_ms) - begin_ms + end_ms:.12g},{rest}")
        end_ms = float(lines[-1].split(",")[0]) + 2341.25
    (tmp_path / "all.csv").write_text("\n".join(lines) + "\n")
    runs = imported(r3, tmp_path, "all.csv")
    assert [run["run"] for run in runs] == [path.stem for path in recordings(r3)]
    assert max(abs(run["clock_ppm"] - 137.0) for run in runs) < 1.0
