"""Certified numbers say no digit that they do not know."""

from __future__ import annotations

import pytest

from navsym.core.numbers import Number


@pytest.mark.parametrize(
    ("lower", "upper", "words"),
    [
        ("2.5000", "2.5000", "= 2.5"),
        ("200", "200", "= 200"),
        ("1.41421356", "1.41421357", "= 1.4142135…"),
        ("-2.00000000000001", "-1.99999999999999", "≈ -2"),
        ("-1", "2", "in [-1, 2]"),
    ],
)
def test_a_number_is_written_with_the_digits_that_both_ends_share(lower, upper, words):
    assert Number(lower, upper).words == words
