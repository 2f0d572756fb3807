"""A chirp shaped on the foreign r3 by its player, until the torque is as desired: the FRF is the truth but where excerpts blur it."""

import numpy as np
import pytest
from foreign import changed, log_map, off_db, player, robot
from workshop import MARKS, ROOT, done

import frfid as library

pytest.importorskip("tomllib", reason="robot files are read with Python 3.11's tomllib")
pytest.importorskip("mujoco", reason="the foreign robot needs MuJoCo: pip install mujoco")
pytestmark = MARKS
# without friction of its own the arm can start with more than would make it stick; from 3 Hz on its way is short enough
BOLD = {"low_hz": 3.0, "amplitude_rad_s": [0.3, 0.12, 0.25], "n_iterations": 5}
LOUD_DB = 1.5


@pytest.fixture(scope="module")
def shaped(tmp_path_factory):
    """The folder of a shaping by commands alone, and what it told."""
    folder = tmp_path_factory.mktemp("shaped")
    done(folder, "init r3-chirp -o template.toml")
    (folder / "chirp.toml").write_text(changed((folder / "template.toml").read_text(), **BOLD))
    (folder / "map.toml").write_text(log_map())
    told = done(folder, "shape chirp.toml -o shaped --map map.toml --player", player("--friction", "off"))
    return folder, told["shape"]


def test_it_ends_with_the_torque_as_desired(shaped):
    _, told = shaped
    for iteration in told["iterations"]:
        print(iteration["number"], np.round(100 * np.array(iteration["axis_error"]), 1), "%")
    assert told["stop"] == "good-enough" and all(check["passed"] for check in told["checks"])


def test_the_diagonal_is_the_truth_where_excerpts_do_not_blur_it(shaped):
    """Around the light antiresonance of the first axis an excerpt blurs by more: docs/theory.md, bias of chirp excerpts."""
    folder, _ = shaped
    frf = library.load(folder / "shaped" / "frf.json")
    true = robot(ROOT / "examples" / "experiments" / "r3_chirp.toml").truth(frf.frequency_hz)
    off = off_db(frf.response, true)
    near = (off < LOUD_DB).mean(axis=0)
    print(f"median {np.median(off, axis=0).round(3)} dB; share of lines within {LOUD_DB} dB: {near.round(3)}")
    assert np.median(off, axis=0).max() < 0.2
    assert near[0] > 0.85 and near[1:].min() > 0.98
    valley = (frf.frequency_hz > 29.0) & (frf.frequency_hz < 44.0)
    edge = frf.frequency_hz > 58.0  # where the sweep fades out
    assert off[~valley & ~edge].max() < LOUD_DB
