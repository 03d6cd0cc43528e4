"""An explanation shows the arithmetic, and the arithmetic is right."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from navsym.core.numbers import Number
from navsym.report.citation import bibtex
from navsym.report.explain import arithmetic, entries_of, number_words, steps
from tests.report import hostile


def test_the_counterexample_is_worked_out_on_both_sides(records):
    (line,) = arithmetic(records[1])
    assert line.differs
    assert all(Fraction(end) == pytest.approx(Fraction(-1, 2)) for end in (line.printed.lower, line.printed.upper))
    words = " ".join(step.words for step in steps(records[1]))
    assert "At T = pi/6" in words and "One point is enough" in words and "the sign is lost" in words


@given(st.fractions(-5, 5, max_denominator=50), st.fractions(1, 5, max_denominator=50))
def test_the_enclosing_decimals_hold_the_exact_value(a, b):
    lines = arithmetic(
        hostile.record("1", "", printed="a/b + 1", derived="a*b", counterexample={"a": str(a), "b": str(b)})
    )
    for line in lines:
        for ends, exact in ((line.printed, a / b + 1), (line.derived, a * b)):
            assert Fraction(ends.lower) <= exact <= Fraction(ends.upper)
            assert Fraction(ends.upper) - Fraction(ends.lower) < Fraction(1, 10**15)
    assert lines


@pytest.mark.parametrize("status", ["PROVED", "CERTIFIED", "CONFIRMED", "OPEN", "REFUTED"])
def test_every_explanation_ends_in_its_verdict(records, status):
    record = next(r for r in records if r.status == status)
    decided = [step.words for step in steps(record) if step.heading == "How it was decided"]
    assert len(decided) == 1 and decided[0].endswith(f"Hence {status}.")


def test_what_is_not_a_number_at_the_point_is_left_out():
    record = hostile.record("1", "", printed="(x, y)", derived="(2*x, 2*y)", counterexample={"x": "1"})
    assert [line.entry for line in arithmetic(record)] == [1]
    wild = hostile.record("1", "", printed="__import__('os')", derived="x", counterexample={"x": "1"})
    assert arithmetic(wild) == []


def test_an_entry_that_agrees_to_the_last_digit_is_not_shown_as_the_one_that_differs():
    record = hostile.record(
        "1", "", printed="(-3*x, 1)", derived="(-3*x*sin(y)**2 - 3*x*cos(y)**2, 2)", counterexample={"x": "1", "y": "1"}
    )
    assert [(line.entry, line.differs) for line in arithmetic(record)] == [(1, False), (2, True)]


def test_entries_of_tuples_and_matrices():
    assert entries_of("((a, f(b, c)), d)") == ["a", " f(b, c)".strip(), "d"]
    assert entries_of("[[1, 2], [3, 4]]") == ["1", "2", "3", "4"]
    assert entries_of("(a + b)*(c + d)") == ["(a + b)*(c + d)"]


def test_digits_are_cut_where_the_ends_part():
    for lower, upper, words in (
        ("0.0411961001461", "0.0411961001462", "0.041196100146…"),
        ("3.000", "3.000", "3"),
        ("25.847165715993691099", "25.847165715993691100", "25.84716571599…"),
        ("0.15639246697984", "0.15639246697985", "0.156392466979…"),
        ("0.99499999999999999999", "0.99500000000000000001", "0.995"),
        ("1.9999", "2.0001", "between 1.9999 and 2.0001"),
        ("-1", "2", "between -1 and 2"),
    ):
        assert number_words(Number(lower, upper)) == words


def test_a_citation_names_paper_and_verdict(records, card):
    text = bibtex(card, records[1], "1.2.3")
    assert text.count("@misc{") == 2 and "A. Author" in text and "1984" in text
    assert "Verdict on sample:2: REFUTED" in text and "Counterexample: T = pi/6." in text
    assert text.count("{") == text.count("}")
