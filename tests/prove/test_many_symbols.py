"""Bounds in many symbols: terms of single symbols are taken apart, and no long look comes before an easy proof."""

from __future__ import annotations

import pytest

import navsym as nav
from navsym.claims import PROVED, REFUTED

NAMES = [f"x{k}" for k in range(1, 14)]
SUM, SQUARES = " + ".join(NAMES), " + ".join(f"{name}**2" for name in NAMES)


@pytest.mark.parametrize(
    ("text", "spoiled", "box"),
    [
        (f"{SUM} <= 13", f"{SUM} <= 13 - 1e-9", ("0", "1")),
        (f"{SUM} <= 13*pi", f"{SUM} <= 13*pi - 1e-9", ("0", "pi")),
        (f"{SUM} < 13 + 1e-9", f"{SUM} < 13", ("0", "1")),
        (f"{SQUARES} <= {SUM}", f"{SQUARES} <= {SUM} - 1e-9", ("0", "1")),
        (f"{SQUARES} + 3e-8 > 0", f"{SQUARES} - 3e-8 > 0", "real"),
        (f"{SQUARES} >= 0", f"{SQUARES} > 0", "real"),
    ],
)
def test_a_bound_in_thirteen_symbols_is_decided_in_two_seconds(text, spoiled, box):
    given = dict.fromkeys(NAMES, box)
    verdict = nav.prove(text, seconds=2.0, **given)
    assert verdict.status == PROVED and verdict.check().accepted
    assert nav.prove(spoiled, seconds=2.0, **given).status == REFUTED


def test_a_sum_is_greatest_at_ends_that_are_roots():
    """Few symbols are looked at in the corners of their box, whose ends need not be rational."""
    given = dict.fromkeys("abcd", ("0", "sqrt(2)"))
    assert nav.prove("a + b + c + d <= 4*sqrt(2)", **given).status == PROVED
    assert nav.prove("a + b + c + d < 4*sqrt(2)", **given).status == REFUTED
