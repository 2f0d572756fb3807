"""A machine that goes beyond a limit is not sent another run: by run, by shape, by Python, and not by the same call again."""

import pathlib

import pytest
import small_player
from workshop import MARKS, done, fill, player, refused

import frfid as library

pytestmark = MARKS
WILD = "p000-m1-q0"
SAID = "axis 1 reached torque 650 N m"


@pytest.fixture
def folder(tmp_path):
    return fill(tmp_path)


def wild(run):
    return player("--calls", "calls", "--fault", "wild", "--fault-run", run)


def sent(folder):
    return (folder / "calls").read_text().split()


def test_run(folder):
    line = "run multisine.toml -o logs --map map.toml --player"
    said = refused(folder, line, wild(WILD), code=1)
    for part in (f"run p001-m0-q0: not sent to the machine: in run {WILD} {SAID}", "max_effort is 600", "(--force)"):
        assert part in said, said
    assert sent(folder) == ["p000-m0-q0", WILD]
    assert SAID in refused(folder, line, wild(WILD), code=1), "the same command sends nothing"
    assert len(sent(folder)) == 2
    (folder / "logs" / f"{WILD}.mcap").unlink()
    done(folder, line, player("--calls", "calls"))
    assert sent(folder)[2:] == [WILD, "p001-m0-q0", "p001-m1-q0"]


@pytest.mark.parametrize("run, next_run", [("p001-m0-q0", "p001-m1-q0"), ("p002-m1-q0", "p003-m0-q0")])
def test_shape(folder, run, next_run):
    line = "shape chirp.toml -o shaped --map map.toml --player"
    said = refused(folder, line, wild(run), code=1)
    assert f"run {next_run}: not sent to the machine: in run {run} {SAID}" in said, said
    assert sent(folder)[-1] == run
    played = len(sent(folder))
    assert SAID in refused(folder, line, wild(run), code=1)
    assert len(sent(folder)) == played


def test_import_says_so(folder):
    done(folder, "run multisine.toml -o logs --map map.toml --player", player())
    path = folder / "logs" / "player" / "recordings" / f"{WILD}.csv"
    header, *rows = path.read_text().splitlines()
    place = header.split(",").index("shoulder.torque")
    values = [row.split(",") for row in rows]
    for row in values[1500:1505]:
        row[place] = "650"
    path.write_text("\n".join([header, *(",".join(row) for row in values)]) + "\n")
    told = done(folder, f"import {path.parent} --plan multisine.toml --map map.toml -o imported", code=3)
    [excess] = told["excesses"]
    assert (excess["axis"], excess["allowed"]) == (0, 600.0) and excess["found"] > 640
    flaws = {run["run"]: run["flaws"] for run in told["imported"] if run["flaws"]}
    assert list(flaws) == [WILD] and flaws[WILD][0].startswith(SAID)


class Wild:
    """The small arm behind Python, which goes beyond a limit in its second run."""

    def __init__(self):
        self.sent = []

    def run(self, run):
        self.sent.append(run.name)
        loop = library.PiController(gain=[600.0, 300.0], integral_gain=[4800.0, 2400.0], sample_time_s=run.sample_time_s)
        measured = library.run_closed_loop(library.Plant.load(str(small_player.ARM)), loop, run.reference)
        torque = measured.u.copy()
        torque[0, 700:705] = 650.0 if run.name == WILD else torque[0, 700:705]
        parts = {"u": torque, "y": measured.y, "r": run.reference, "position_rad": measured.position_rad}
        return library.Record(sample_time_s=run.sample_time_s, **parts)


@pytest.mark.parametrize("kept", [True, False], ids=["kept", "in memory"])
def test_python(folder, kept):
    plan, machine = library.Experiment.load(str(folder / "multisine.toml")).design(), Wild()
    options = {"folder": str(folder / "python")} if kept else {}
    with pytest.raises(Exception, match=f"not sent to the machine: in run {WILD} {SAID}"):
        plan.run(machine, **options)
    assert machine.sent == ["p000-m0-q0", WILD]
    if kept:
        with pytest.raises(Exception, match="not sent to the machine"):
            plan.run(machine, **options)
        assert machine.sent == ["p000-m0-q0", WILD], "what was done is kept, the next run is not sent"
        assert sorted(path.name for path in (folder / "python").glob("*.mcap")) == ["p000-m0-q0.mcap", f"{WILD}.mcap"]


def test_a_reference_beyond_a_limit_is_not_sent_at_all(folder):
    text = pathlib.Path(folder / "multisine.toml").read_text()
    (folder / "tight.toml").write_text(text.replace("max_velocity = [0.5, 0.5]", "max_velocity = [0.05, 0.5]"))
    said = refused(folder, "run tight.toml -o logs --map map.toml --player", player("--calls", "calls"), code=2)
    assert "max_velocity is 0.05" in said or "max_velocity is 0.0500" in said, said
    assert not (folder / "calls").exists()
