"""The rules of proofs: what each accepts, and forgeries that lack one hypothesis of its theorem."""

from __future__ import annotations

import pytest

from navsym import checker

IDENTITY = {"rule": "identity"}
BALLS = {"rule": "balls", "bits": 60, "cells": 20}
LINE, UNIT, BELOW, TWO = [None, None, []], ["0", "1", []], ["-2", "-1", []], ["1", "2", []]
NOWHERE = "0*log(-1)"


def state(left, relation, limits, right="0"):
    symbols = {"x": limits} if limits else {}
    return {"left": left, "relation": relation, "right": right, "symbols": symbols, "exists": [], "tolerance": None}


def prove(statement, at, *proofs):
    witness = {"x": at} if at else {}
    return {"kind": "proof", "statement": statement, "bits": 128, "witness": witness, "proofs": list(proofs)}


def refute(statement, at, zero=None):
    return {"kind": "counterexample", "statement": statement, "bits": 128, "point": {"x": at}, "zero": zero}


def multiply(factor, positive):
    return {"rule": "multiply", "by": factor, "defined": [], "positive": positive, "proof": IDENTITY}


def slope(end):
    holes = {"continuous": [], "smooth": [], "slope": IDENTITY, "floor": BALLS}
    return {"rule": "slope", "symbol": "x", "end": end, "strict": 0, **holes}


def split(at, *proofs):
    return {"rule": "split", "symbol": "x", "at": at, "proofs": list(proofs)}


def derivative(at, value=IDENTITY):
    return {"rule": "derivative", "point": {"x": at}, "value": value, "slopes": [IDENTITY], "defined": []}


def span(end):
    return {"rule": "range", "symbol": "x", "end": end, "share": "1"}


def abstract(term, form, inside, premise, limits):
    body = {"rule": "abstract", "terms": {"u": term}, "ranges": {"u": limits}, "to": form}
    return body | {"inside": inside, "defined": [], "proof": premise}


def capture(sign, ends):
    given = {"rule": "given", "weights": ["1"]}
    return abstract(f"{sign}x", f"{sign}u", [span(k) for k in ends], given, ["-1", "1", []])


def rewrite(old, new):
    return {"rule": "rewrite", "from": old, "to": new, "defined": [], "equal": IDENTITY, "proof": BALLS}


SQUARE = state("-x**2", ">=", BELOW)
FALSE = state("0*x - 1", ">=", TWO)
ZERO_PART = state("exp_1(x - abs(x))*(x + abs(x)) + exp_2(x - abs(x))*(x*x - abs(x)*abs(x))", "=", ["0.1", "0.4", []])
CASES = {"rule": "cases", "of": "u + 0", "proofs": [capture("", (0, 1)), capture("-", (1, 0))]}
HOLES = [
    (state("0*x + 1", "=", LINE), "prove", "0", derivative("log(-1)", multiply(NOWHERE, BALLS)), "may not exist"),
    (FALSE, "prove", "1", split("log(-1)", slope(1), slope(0)), "may not exist"),
    (state("x", ">", TWO), "refute", "1.5**(1 + 0*log(-1))", multiply(NOWHERE, BALLS), "may not exist"),
    (state("x*x**0", "!=", UNIT), "refute", "0", None, "no value at the point"),
    (state("x", ">=", ["-1", "1", []]), "prove", "1", CASES, "a symbol without a range"),
    (SQUARE, "prove", "-1", rewrite("2", "2 + 0*x"), "another exponent"),
    (SQUARE, "prove", "-1", abstract("2", "-x**u", [BALLS] * 2, BALLS, ["1", "3", []]), "another exponent"),
    (ZERO_PART, "prove", "0.25", IDENTITY, "of a root"),
]


@pytest.mark.parametrize(("statement", "kind", "at", "proof", "why"), HOLES, ids=lambda x: str(x)[:24])
def test_a_proof_that_lacks_a_hypothesis_is_refused(statement, kind, at, proof, why):
    item = (prove if kind == "prove" else refute)(statement, at, proof)
    with pytest.raises(checker.Refused, match=why):
        checker.grant(statement, item)


@pytest.mark.parametrize(("end", "flags"), [("log(-1)", []), ("sqrt(-1)*0", [])])
def test_an_end_that_does_not_exist_is_no_range(end, flags):
    statement = state("x", "=", ["0", end, flags], "x")
    with pytest.raises(checker.Refused, match="may not exist"):
        checker.grant(statement, prove(statement, "1", IDENTITY))


EVEN = {"rule": "equal", "to": "x**2", "defined": [], "proof": {"rule": "product", "factors": [None]}}
POSITIVE = state("x**2 + 1", ">", TWO)
TRUE = [
    (state("sin(x)**2 + cos(x)**2 - 1", "=", LINE), "0", IDENTITY),
    (state("(x + 1)**2 - x**2 - 2*x - 1", "=", LINE), "0", derivative("0")),
    (POSITIVE, "1", BALLS),
    (state("x - 1", ">=", TWO), "1", span(0)),
    (state("x - 1", ">=", TWO), "1", split("3/2", span(0), BALLS)),
    (state("x**2", ">=", LINE), "0", EVEN),
    (POSITIVE, "1", {"rule": "roots", "from": "1", "to": "2"}),
    (state("x**2 + 1", "!=", TWO), "1", {"rule": "side", "sign": 1, "proof": BALLS}),
    (POSITIVE, "1", {"rule": "cones", "splits": [None]}),
    (state("2 + sin(x)", ">", LINE), "0", {"rule": "bounded", "proof": BALLS}),
    (POSITIVE, "1", {"rule": "exponential", "proof": BALLS}),
    (POSITIVE, "1", {"rule": "multiply", "by": "2", "defined": [], "positive": BALLS, "proof": BALLS}),
    (POSITIVE, "1", {"rule": "equal", "to": "1 + x*x", "defined": [], "proof": BALLS}),
    (state("x**2 + 1", ">=", TWO), "1", {"rule": "corners", "symbols": [], "proofs": [BALLS]}),
    (state("x + 2", ">=", TWO), "1", {"rule": "corners", "symbols": ["x"], "proofs": [BALLS, BALLS]}),
    (SQUARE | {"relation": "<="}, "-1", rewrite("2", "1 + 1")),
    (state("x**2 - 1/2", ">=", TWO), "1", abstract("x", "u**2 - 1/2", [span(0), span(1)], BALLS, TWO)),
]


@pytest.mark.parametrize(("statement", "at", "proof"), TRUE, ids=lambda x: str(x)[:30])
def test_a_true_statement_is_accepted_by_the_rule(statement, at, proof):
    assert checker.grant(statement, prove(statement, at, proof)) == "HOLDS"
