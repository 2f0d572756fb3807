"""Hostile sizes: a seeded share of those in MCAP, every shape of NPZ, every bomb, within the memory and time of docs/reliability.md."""

import functools

import hostile
import pytest
from command import FRFID, NEEDS
from judges import tallied

pytestmark = pytest.mark.skipif(FRFID is None, reason=NEEDS)


def clean(tally):
    assert tally.cases and not tally.faults, "\n".join([str(tally), *tally.faults])


def test_sizes_in_mcap_are_not_believed():
    clean(tallied("sizes in MCAP", hostile.sizes_in_mcap(60)))


def test_shapes_of_npz_are_not_believed():
    clean(tallied("shapes of NPZ", hostile.shapes_of_npz()))


@pytest.mark.parametrize("name", list(hostile.BOMBS))
def test_what_unpacks_to_much_takes_little(name):
    clean(tallied(name, [functools.partial(hostile.bomb, name)]))
