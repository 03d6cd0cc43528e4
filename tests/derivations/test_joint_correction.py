"""What holds the 1979 paper together beyond its single rows."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from navsym.claims import OPEN, PROVED, REFUTED, claims_of, compare_equations
from navsym.prove.ladder import decide
from navsym_papers import joint_correction
from navsym_papers.joint_correction import section1_any_size, section1_systems, section3_gains
from navsym_papers.joint_correction.inertial import ORDERS, lowest_order
from navsym_papers.joint_correction.section2_groups import VELOCITY_ROWS, mu, position, same, v1, velocity

CLAIMS = claims_of(joint_correction)


def test_every_numbered_equation_is_claimed_or_a_definition():
    found = compare_equations(joint_correction.PAPER, CLAIMS)
    assert found.missing == ()
    assert set(found.definitions) == {"1.1", "1.2", "1.12", "2.5"}


def test_refuted_rows_have_a_class_a_reason_and_a_correction():
    corrected = {claim.corrects for claim in CLAIMS}
    refuted = [claim for claim in CLAIMS if claim.expect is REFUTED]
    assert {claim.number for claim in refuted} == corrected - {None}
    assert all(claim.slip in ("paper", "scan", "undecidable") and len(claim.reason) > 40 for claim in refuted)


def test_titles_are_sentences_and_numbers_are_unique():
    assert len({claim.number for claim in CLAIMS}) == len(CLAIMS) > 135
    assert not [claim.number for claim in CLAIMS if not claim.title.endswith(".")]


def test_the_example_systems_have_the_sizes_that_they_promise():
    sizes = [(s.n, s.m) for s in section1_systems.systems()]
    assert sizes == [(2, 1), (3, 2), (4, 2), (5, 3)]
    assert section1_systems.free("x", 3).det() == section1_systems.c[0]


def test_the_true_decay_rate_is_that_of_the_numerical_eigenvalues():
    A = section3_gains.coupled_velocity_block().subs({section3_gains.kappa: sp.Rational(1, 20), section3_gains.lam: 1})
    numeric = -np.linalg.eigvals(np.array(A, dtype=float)).real.max()
    exact = float(section3_gains.decay_rate(sp.Integer(1), sp.Rational(1, 20)))
    assert abs(numeric - exact) < 1e-4


def test_balls_count_the_poles_that_numpy_finds():
    for lam, kappa in ((1, 0), (1, sp.Rational(1, 2)), (1, 2), (2, sp.Rational(9, 10)), (sp.Rational(1, 2), 3)):
        A = section3_gains.coupled_velocity_block().subs({section3_gains.kappa: kappa, section3_gains.lam: lam})
        right = int((np.linalg.eigvals(np.array(A, dtype=float)).real > 1e-9).sum())
        assert section3_gains.poles_on_the_right(sp.sympify(lam), sp.sympify(kappa)) == right


def test_a_row_is_compared_up_to_the_order_that_it_neglects():
    """A printed term of the order mu^2 rho is no slip; one of the order mu rho is."""
    status = {
        term: decide(same(VELOCITY_ROWS[1] + term, lambda: velocity().rates[1])()).status
        for term in (mu**2 * v1, mu * v1)
    }
    assert status == {mu**2 * v1: PROVED, mu * v1: REFUTED}


def test_every_dropped_term_is_on_record_with_its_order():
    for group in (velocity(), position()):
        for dropped in group.dropped:
            for term in dropped:
                assert term.order == lowest_order(term.term, ORDERS) >= 2


@pytest.mark.parametrize("number", [one[0] for one in section1_any_size.STATEMENTS])
def test_twice_the_right_side_is_not_proved_for_matrices_of_any_size(number):
    _, _, left, right, *given = next(one for one in section1_any_size.STATEMENTS if one[0] == number)
    assert section1_any_size.of_every_size(left, right, *given)().derived.value is True
    spoiled = section1_any_size.of_every_size(left, f"2*({right})", *given)().derived
    assert spoiled.value is False or spoiled.status == OPEN
