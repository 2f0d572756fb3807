"""frfid beside best-linear-approximation and pyFRF: answers agree and are right, and what is said of each is so."""

import pytest
from capabilities import CAPABILITIES, cell

N_REALIZATIONS = 64
KNOWN_DEFECT = "draws of few lines at S/N 1 are taken for repetitions of each other: the chance is one of a pair, and there are many pairs"


def assert_all(rows):
    found = list(rows)
    assert found and not [row for row in found if not row.passes]


def test_54_campaigns_through_best_linear_approximation():
    pytest.importorskip("best_linear_approximation", reason="needs best-linear-approximation, Python 3.12")
    import campaigns

    assert_all(campaigns.rows(N_REALIZATIONS))


def test_two_realizations_beside_best_linear_approximation():
    pytest.importorskip("best_linear_approximation", reason="needs best-linear-approximation, Python 3.12")
    import hard_cases

    assert_all(map(hard_cases.two_realizations, hard_cases.GROUPS))


@pytest.mark.xfail(strict=True, reason=KNOWN_DEFECT)
def test_noise_on_the_input_beside_best_linear_approximation():
    pytest.importorskip("best_linear_approximation", reason="needs best-linear-approximation, Python 3.12")
    import hard_cases

    assert_all(hard_cases.noisy_input_rows())


def test_structures_through_pyfrf():
    pytest.importorskip("pyFRF", reason="needs pyFRF")
    import structures

    assert_all(structures.rows())


@pytest.mark.parametrize("what", CAPABILITIES, ids=lambda one: one.what)
def test_what_each_gives(what):
    cells = [cell(claim, module) for claim, module in ((what.frfid, "frfid"), (what.bla, "best_linear_approximation"), (what.pyfrf, "pyFRF"))]
    left_out = cells.count("(not here)")
    if left_out:
        pytest.skip(f"frfid: {cells[0]}; {left_out} of the other packages is not installed")
