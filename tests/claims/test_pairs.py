"""A claim that yields pairs of sides is one equation of all their entries, in their order."""

from __future__ import annotations

import inspect

import sympy as sp

from navsym.claims import Equation, claim
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
