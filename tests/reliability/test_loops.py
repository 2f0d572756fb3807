"""A seeded share of every loop over faults: what `python tests/reliability` does whole, with the same functions."""

import hashlib

import damage
import kills
import pytest
import recovered
import syscalls
from command import FRFID, NEEDS
from conformance import upstream_sums, variations
from materials import materials

pytestmark = pytest.mark.skipif(FRFID is None, reason=NEEDS)


def clean(tally):
    assert tally.cases and not tally.faults, "\n".join([str(tally), *tally.faults])


@pytest.fixture(scope="module")
def sound():
    return {material.name: material for material in materials()}


NAMES = ["run", "run, chunks zstd", "run, chunks lz4", "run, chunks none", "plan", "result", "foreign MCAP", "NPZ", "CSV.gz", "CSV.zst"]
NAMES += ["MAT, packed", "MAT", "MAT v7.3", "rosbag2 .db3", "CSV", "description"]


@pytest.mark.parametrize("name", NAMES)
def test_cut_and_flipped_files_are_read_refused_or_told(sound, name):
    assert set(sound) == set(NAMES)
    clean(damage.loop(sound[name], damage.cuts(sound[name].content, 12)))
    clean(damage.loop(sound[name], damage.flips(sound[name].content, 24)))


@pytest.mark.skipif(not syscalls.has_compiler(), reason="needs a C compiler, cc, for the library between frfid and libc")
@pytest.mark.parametrize("name", syscalls.COMMANDS)
def test_a_call_that_fails_leaves_nothing_wrong(name):
    clean(syscalls.loop(name, most=2))


@pytest.mark.parametrize("name", kills.COMMANDS)
def test_killed_twice_the_end_is_the_same(name):
    clean(kills.loop(name, 3))


def test_the_conformance_files_are_those_of_upstream():
    made = {name: hashlib.sha256(content).hexdigest() for name, content in variations()}
    assert len(made) == 416 and made == upstream_sums()


def test_conformance_files_are_recovered_with_all_that_is_in_them():
    clean(recovered.loop(40))
