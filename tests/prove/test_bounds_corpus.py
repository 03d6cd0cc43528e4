"""Inequalities of textbooks and of the field: proved, their reverses refuted, certificates accepted by the checker."""

from __future__ import annotations

import pytest

from navsym import checker
from navsym.claims import REFUTED
from navsym.prove.claimfile import claims_from, decide_claim
from navsym.prove.grant import is_granted
from tests.prove.bounds_corpus import FIELD, FIELD_SYMBOLS, TEXTBOOK, TEXTBOOK_SYMBOLS

ROWS = [(TEXTBOOK_SYMBOLS, row) for row in TEXTBOOK] + [(FIELD_SYMBOLS, row) for row in FIELD]
REVERSE = {"<": ">", "<=": ">", ">": "<", ">=": "<"}

#: Minutes rather than seconds on a busy machine: left to the slow tests.
SLOW = ("sqrt(a**2 + n**2 - 2*a*n*cos(x))", "atan((1 - q)*tan(t/2))", "(x**2 + y**2 + z**2)*(u**2 + v**2 + w**2)")


def marks_of(place, row):
    """Every third one is decided in every run, the others in the long ones."""
    return [pytest.mark.slow] * (row[0] in SLOW) + [pytest.mark.long] * (place % 3 > 0)


def decided(symbols, left, relation, right):
    document = {"symbols": symbols, "claim": [{"id": "one", "left": left, "relation": relation, "right": right}]}
    return decide_claim(claims_from(document).claims[0])


def test_there_are_more_than_a_hundred_and_thirty_of_them():
    assert len(ROWS) > 130


@pytest.mark.parametrize(
    ("symbols", "row"),
    [
        pytest.param(symbols, row, id=" ".join(row), marks=marks_of(place, row))
        for place, (symbols, row) in enumerate(ROWS)
    ],
)
def test_the_inequality_is_proved(symbols, row):
    verdict = decided(symbols, *row)
    assert verdict.status.holds and is_granted(verdict), verdict
    assert checker.check(verdict.certificate) == "proof"


@pytest.mark.parametrize(("symbols", "row"), ROWS[::3])
def test_its_reverse_is_refuted(symbols, row):
    left, relation, right = row
    assert decided(symbols, left, REVERSE[relation], right).status == REFUTED
