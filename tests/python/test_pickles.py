"""Pickles and copies of everything that is public: by every protocol the same object."""

import copy
import pickle

import numpy as np
import pytest

import frfid
from test_processes import EXPERIMENT

T = 1e-3
PROTOCOLS = range(pickle.HIGHEST_PROTOCOL + 1)
JOINT = frfid.Plant.single_joint(coulomb_nm=50.0)


@pytest.fixture(scope="module")
def experiment(tmp_path_factory):
    path = tmp_path_factory.mktemp("pickles") / "experiment.toml"
    path.write_text(EXPERIMENT)
    return frfid.Experiment.load(path)


@pytest.fixture(scope="module")
def frf():
    u = np.repeat(np.random.default_rng(2).standard_normal((3, 1, 1, 1, 64)), 2, axis=2)
    return frfid.estimate_bla(u, u + 1e-3 * np.random.default_rng(3).standard_normal(u.shape), sample_time_s=T, harmonics=[1, 2, 3, 5])


def made(name, experiment, frf):
    return {
        "Chirp": lambda: frfid.Chirp(low_hz=1, high_hz=60, duration_s=10, amplitude=[[(1, 2)], [(3, 4)]], tail_s=0.5),
        "Multisine": lambda: frfid.Multisine.design(low_hz=1, high_hz=60, sample_time_s=T, resolution_hz=1.0, grid="odd-random"),
        "PiController": lambda: frfid.PiController(gain=[1.0, 2.0], integral_gain=1.0, sample_time_s=T, position_gain=3.0),
        "Plant": lambda: JOINT,
        "Record": lambda: JOINT.simulate(100 * np.random.default_rng(1).standard_normal((2, 1, 50)), sample_time_s=T),
        "Frf": lambda: frf,
        "Experiment": lambda: experiment,
        "Plan": experiment.design,
        "Run": lambda: experiment.design()[1],
        "Comparison": lambda: frfid.compare(frf, frf, stronger="b", prominence_db=2.0),
    }[name]()


def said(thing):
    """What an object shows of itself: arrays as bytes, whatever else by its words."""
    names = [name for name in dir(thing) if not name.startswith("_") and not callable(getattr(thing, name))]
    shown = {name: getattr(thing, name) for name in names if name != "plot"}
    words = thing.to_toml() if isinstance(thing, frfid.Experiment) else repr(thing)  # whose file is not that of its text
    return words, {name: value.tobytes() if isinstance(value, np.ndarray) else repr(value) for name, value in shown.items()}


KINDS = ["Chirp", "Multisine", "PiController", "Plant", "Record", "Frf", "Experiment", "Plan", "Run", "Comparison"]


@pytest.mark.parametrize("kind", KINDS)
def test_what_comes_back_is_the_same(kind, experiment, frf):
    thing = made(kind, experiment, frf)
    ways = [lambda thing, protocol=protocol: pickle.loads(pickle.dumps(thing, protocol)) for protocol in PROTOCOLS]
    for way in [*ways, copy.copy, copy.deepcopy]:
        back = way(thing)
        assert type(back) is type(thing) and said(back) == said(thing)
        if type(thing).__eq__ is not object.__eq__:
            assert back == thing


def test_a_plan_that_came_back_injects_the_same_bytes(experiment):
    plan = experiment.design()
    back = pickle.loads(pickle.dumps(plan))
    assert [run.reference.tobytes() for run in back] == [run.reference.tobytes() for run in plan]


def test_a_plan_of_a_file_is_copied_and_not_pickled(experiment, tmp_path):
    path = tmp_path / "plan.mcap"
    experiment.design().save(path)
    plan = frfid.Plan.load(path)
    assert copy.copy(plan).names == copy.deepcopy(plan).names == plan.names
    with pytest.raises(TypeError, match=r"plan\.mcap.*send the path"):
        pickle.dumps(plan)


def test_a_shaped_excitation_says_what_to_pickle():
    chirp = frfid.Chirp(low_hz=2.0, high_hz=40.0, duration_s=4.0, amplitude=200.0, fade_s=0.3, tail_s=1.0).sample(sample_time_s=T)
    controller = frfid.PiController(gain=2000.0, integral_gain=16000.0, sample_time_s=T)
    shaped = frfid.shape((JOINT, controller), desired=chirp, start=chirp * 5e-5, sample_time_s=T, high_hz=40.0, n_iterations=1)
    assert copy.copy(shaped).number == copy.deepcopy(shaped).number == shaped.number
    with pytest.raises(TypeError, match="reference, records"):
        pickle.dumps(shaped)


def test_experiments_go_through_text(experiment, tmp_path):
    assert frfid.Experiment.from_toml(experiment.to_toml()) == experiment
    with pytest.raises(ValueError, match="names another file"):
        frfid.Experiment.from_toml(EXPERIMENT.split("[robot")[0] + "[robot]\nfile = 'robot.toml'\n")
