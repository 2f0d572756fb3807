"""frfid beside best-linear-approximation and pyFRF: answers agree and are right, and what is said of each is so."""

import frfid
import numpy as np
import pytest
from capabilities import CAPABILITIES, NOT_HERE, cell

N_REALIZATIONS = 64


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


def test_noise_on_the_input_beside_best_linear_approximation():
    pytest.importorskip("best_linear_approximation", reason="needs best-linear-approximation, Python 3.12")
    import hard_cases

    assert_all(hard_cases.noisy_input_rows())


def test_structures_through_pyfrf():
    pytest.importorskip("pyFRF", reason="needs pyFRF")
    import structures

    assert_all(structures.rows())


def test_blows_of_changing_strength_are_no_noise_on_the_input():
    strength = np.array([1.0, 1.1, 0.9, 1.2, 0.8])
    u = np.zeros((5, 1, 1, 1, 256))
    u[..., 10] = strength[:, None, None, None]  # exact
    y = 2 * u + 1e-3 * np.random.default_rng(0).standard_normal(u.shape)
    found = frfid.estimate(u, y, sample_time_s=1e-3, harmonics=np.arange(1, 60), method="h1")
    assert [check["name"] for check in found.checks if not check["passed"]] == ["draws of phases"]


@pytest.mark.parametrize("what", CAPABILITIES, ids=lambda one: one.what)
def test_what_each_gives(what):
    cells = [cell(claim, module) for claim, module in ((what.frfid, "frfid"), (what.bla, "best_linear_approximation"), (what.pyfrf, "pyFRF"))]
    if NOT_HERE in cells:
        pytest.skip(f"not all packages are installed: {', '.join(cells)}")
