"""Certificates of linear systems are accepted by the checker, and refused when they are spoiled."""

from __future__ import annotations

import json

import pytest
import sympy as sp

from navsym import checker
from navsym.models.certificates import exponential_certificate, rank_certificate
from navsym.prove.certificates import identity_certificate

t, w, a, b = sp.symbols("t w a b", real=True)
OSCILLATOR = sp.Matrix([[0, 1], [-(w**2), 0]])
TURNING = sp.Matrix([[sp.cos(w * t), sp.sin(w * t) / w], [-w * sp.sin(w * t), sp.cos(w * t)]])


def judged(item) -> str:
    return checker.check(checker.load(json.dumps(item)))


def test_the_transition_matrix_of_an_oscillator_is_accepted():
    assert judged(exponential_certificate(OSCILLATOR, TURNING, t)) == "exponential"


def test_the_transition_matrix_of_another_oscillator_is_refused():
    with pytest.raises(checker.Refused, match="differs"):
        judged(exponential_certificate(OSCILLATOR, TURNING.T, t))


@pytest.mark.parametrize(
    "matrix",
    [
        sp.Matrix([[a, b], [2 * a, 2 * b]]),
        sp.Matrix([[1, 0], [0, 1]]),
        sp.Matrix([[a, b, a + b], [b, a, a + b]]),
        sp.Matrix([[0, 0]]),
        sp.Matrix([[1 / a, 1], [1, a], [b, a * b]]),
    ],
)
def test_the_rank_of_a_matrix_with_parameters_is_accepted_and_another_rank_is_not(matrix):
    item = rank_certificate(matrix)
    assert judged(item) == "rank" and item["rank"] == matrix.rank()
    with pytest.raises(checker.Refused):
        judged(item | {"rank": item["rank"] + 1})


def test_what_the_checker_could_not_multiply_out_has_no_certificate():
    """Of eleven sums that something is divided by, each of eleven terms, 11**11 terms would come."""
    sums = [sum(sp.symbols(f"x{k}_:11")) for k in range(11)]
    assert identity_certificate(sums[0] / sums[1], sums[0] / sums[1]) is not None
    assert identity_certificate(sum(1 / s for s in sums), sum(1 / s for s in sums)) is None
