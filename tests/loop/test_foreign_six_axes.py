"""The six axes of MuJoCo: one short run forth and back, through units, sides, signs, clock and losses, to 0.1 %."""

import numpy as np
import pytest
from foreign import SCALE_OF_SIX, changed, log_map, player
from workshop import MARKS, ROOT, done

import frfid as library

pytest.importorskip("tomllib", reason="robot files are read with Python 3.11's tomllib")
pytest.importorskip("mujoco", reason="the foreign robot needs MuJoCo: pip install mujoco")
pytestmark = MARKS
SHORT = {"realizations": 1, "repetitions": 1, "glides": 1, "lead_in_s": 1.0, "resolution_hz": 0.5, "peak_of_velocity": 0.4, "travel_rad": [0.1] * 6}
SIX = ROOT / "examples" / "experiments" / "six_axis_multisine.toml"
RUN = "p000-m2-q0"


@pytest.fixture(scope="module")
def six(tmp_path_factory):
    """One run of a plan, played, and what the controller saw of it."""
    folder = tmp_path_factory.mktemp("six")
    done(folder, "init six-axis-multisine -o template.toml")
    (folder / "six.toml").write_text(changed((folder / "template.toml").read_text(), **SHORT))
    (folder / "map.toml").write_text(log_map(SCALE_OF_SIX))
    command = player("--experiment", str(SIX), "--low-pass-hz", "0", folder=folder)
    done(folder, "run six.toml -o logs --index 3 --map map.toml --player", command)
    return folder, np.load(folder / f"{RUN}.npz")


def test_it_comes_back_as_it_was(six):
    folder, ideal = six
    record = library.read(folder / "logs" / f"{RUN}.mcap")
    begin = first_sample(record.r, ideal["r"])
    for name in ("u", "y", "r", "position_rad"):
        found, expected = getattr(record, name), ideal[name][:, begin : begin + record.u.shape[1]]
        error = (found - expected).std(axis=1) / expected.std(axis=1)
        print(f"{name}: rms of the difference over rms of the signal {error.max():.1e} at worst")
        assert error.max() < 1e-3


def first_sample(reference, played):
    """The sample of what was played from which on it is the reference."""
    places = range(played.shape[1] - reference.shape[1])
    return min(places, key=lambda place: np.abs(played[:, place : place + 200] - reference[:, :200]).sum())


def test_it_goes_back_to_where_it_began(six):
    _, ideal = six
    ways = np.ptp(ideal["position_rad"], axis=1)
    assert np.all((ways > 0.09) & (ways < 0.14)), ways
    assert np.abs(ideal["position_rad"][:, -1] - ideal["position_rad"][:, 0]).max() < 0.02, "gravity and friction over the integral gain"
