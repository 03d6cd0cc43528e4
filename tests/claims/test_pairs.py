"""A claim that yields pairs of sides is one equation of all their entries, in their order."""

from __future__ import annotations

import inspect

import pytest
import sympy as sp

from navsym.claims import Equation, claim, claims
from navsym.prove.ladder import decide

a, b = sp.symbols("a b", real=True)


@claim("1")
def turns():
    """Powers of a turn, a number, a list and a row."""
    for n in (2, 3):
        turn = sp.Matrix([[sp.cos(a), -sp.sin(a)], [sp.sin(a), sp.cos(a)]])
        yield turn**n, sp.Matrix([[sp.cos(n * a), -sp.sin(n * a)], [sp.sin(n * a), sp.cos(n * a)]])
    yield (a + b) ** 2, a**2 + 2 * a * b + b**2
    yield [a, b], (a, b)
    yield sp.ImmutableMatrix([[a, b]]), [a, b]


@claim("2")
def wrong_in_one_case():
    """The cube is not three times the number."""
    for n in (1, 2, 3):
        yield a**n, a**n if n < 3 else n * a


def test_all_pairs_make_one_equation():
    statement = turns.derive()
    assert isinstance(statement, Equation) and len(statement.printed) == len(statement.derived) == 8 + 1 + 2 + 2
    assert statement.printed[8:] == [(a + b) ** 2, a, b, a, b] and statement.box == {}
    assert decide(statement).status == "PROVED" and statement.printed == turns.derive().printed
    assert turns.title == "Powers of a turn, a number, a list and a row."
    assert inspect.unwrap(turns.derive).__code__.co_filename == __file__


def test_one_wrong_case_refutes_all():
    verdict = decide(wrong_in_one_case.derive())
    assert verdict.status == "REFUTED" and verdict.counterexample["a"] not in ("0",)


TABLE = claims(
    "3 | A sign. | paper: the sign is lost",
    lambda: Equation(-a, a),
    "3* | The number. | CERTIFIED",
    lambda: Equation(a, a),
    "4 | Cases. | note: two | of them",
    lambda: ((a**n, a * a ** (n - 1)) for n in (2, 3)),
)


def test_a_heading_says_what_the_keywords_of_a_claim_say():
    wrong, right, cases = TABLE
    assert (wrong.number, wrong.title, wrong.slip, wrong.reason) == ("3", "A sign.", "paper", "the sign is lost")
    assert (wrong.expect, right.expect, right.corrects, cases.expect) == ("REFUTED", "CERTIFIED", "3", "PROVED")
    assert (cases.reason, cases.slip) == ("two | of them", None) and cases.derive().derived == [a * a, a * a**2]


@pytest.mark.parametrize("rows", [("5 | A title.",), (lambda: None, "5 | A title."), ("5 | A.", "6 | B.")])
def test_a_heading_without_its_statement_is_refused(rows):
    with pytest.raises(ValueError, match="a heading before each"):
        claims(*rows)


def test_an_unknown_verdict_in_a_heading_is_refused():
    with pytest.raises(ValueError, match="DOUBTFUL"):
        claims("5 | A title. | DOUBTFUL: why", lambda: Equation(a, a))
