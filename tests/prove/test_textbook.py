"""Textbook identities are proved and their near misses refuted: no wrong verdict, none left open."""

from __future__ import annotations

import pytest
import sympy as sp

from navsym.claims import PROVED, REFUTED, Bound, Equation
from navsym.language.expression import parse, symbol
from navsym.prove.ladder import decide
from tests.prove.textbook import EVERYTHING

SYMBOLS = {name: symbol(name) for name in "abcxyz"} | {name: symbol(name, positive=True) for name in "pqr"}


def read(text):
    return parse(text, SYMBOLS)


def test_there_are_a_hundred_of_them():
    assert len(EVERYTHING) >= 100


@pytest.mark.parametrize(
    ("left", "right", "wrong"), EVERYTHING, ids=[f"{k}: {row[0]}" for k, row in enumerate(EVERYTHING)]
)
def test_the_identity_is_proved_and_its_near_miss_refuted(left, right, wrong):
    assert decide(Equation(read(left), read(right))).status == PROVED
    verdict = decide(Equation(read(left), read(wrong)))
    assert verdict.status == REFUTED
    assert verdict.counterexample is not None and verdict.difference is not None


t, w = sp.Symbol("t", real=True), sp.Symbol("w", positive=True)
a, b, c, d = sp.symbols("a b c d", real=True)
M = sp.Matrix([[a, b], [c, d]])
K = sp.Matrix([[b, c], [d, a]])
ROTATION = sp.Matrix([[sp.cos(t), -sp.sin(t)], [sp.sin(t), sp.cos(t)]])
OSCILLATOR = sp.Matrix([[sp.cos(w * t), sp.sin(w * t) / w], [-w * sp.sin(w * t), sp.cos(w * t)]])
GENERATOR = sp.Matrix([[0, 1], [-(w**2), 0]])
MATRICES = {
    "transpose of a product": ((M * K).T, K.T * M.T, M.T * K.T),
    "adjugate": (M * M.adjugate(), M.det() * sp.eye(2), -M.det() * sp.eye(2)),
    "inverse of a product": ((M * K).inv(), K.inv() * M.inv(), M.inv() * K.inv()),
    "Cayley and Hamilton": (M**2 - M.trace() * M + M.det() * sp.eye(2), sp.zeros(2, 2), sp.eye(2)),
    "rotation is orthogonal": (ROTATION * ROTATION.T, sp.eye(2), ROTATION),
    "angles add": (ROTATION * ROTATION, ROTATION.subs(t, 2 * t), ROTATION.subs(t, 3 * t)),
    "oscillator solves its equation": (OSCILLATOR.diff(t), GENERATOR * OSCILLATOR, OSCILLATOR * GENERATOR.T),
    "oscillator starts at one": (OSCILLATOR.subs(t, 0), sp.eye(2), -sp.eye(2)),
    "determinants multiply": (sp.Matrix([(M * K).det()]), sp.Matrix([M.det() * K.det()]), sp.Matrix([M.det()])),
    "trace is cyclic": (sp.Matrix([(M * K).trace()]), sp.Matrix([(K * M).trace()]), sp.Matrix([M.trace() * K.trace()])),
}


@pytest.mark.parametrize("name", MATRICES)
def test_the_matrix_identity_is_proved_and_its_near_miss_refuted(name):
    left, right, wrong = MATRICES[name]
    assert decide(Equation(left, right)).status == PROVED
    assert decide(Equation(left, wrong)).status == REFUTED


x = sp.Symbol("x", real=True)
INEQUALITIES = {
    "sine below its argument": (sp.sin(x), "<=", x, {x: (0, None)}),
    "tangent above its argument": (sp.tan(x), ">=", x, {x: (0, sp.Rational(3, 2))}),
    "cosine above its parabola": (sp.cos(x), ">=", 1 - x**2 / 2, {x: (-3, 3)}),
    "exponential above its tangent": (sp.exp(x), ">=", 1 + x, {x: (-1, 1)}),
    "Huygens and Snell": (3 * sp.sin(x), "<=", (2 + sp.cos(x)) * x, {x: (0, 5)}),
    "Jordan": (sp.sin(x), ">=", 2 * x / sp.pi, {x: (0, sp.pi / 2)}),
    "arithmetic and geometric mean": (a**2 + b**2, ">=", 2 * a * b, {a: (-5, 5), b: (-5, 5)}),
}


@pytest.mark.parametrize("name", INEQUALITIES)
def test_the_inequality_is_never_refuted_and_its_reverse_never_proved(name):
    left, relation, right, box = INEQUALITIES[name]
    verdict = decide(Bound(left, relation, right, box))
    assert verdict.status != REFUTED
    if name not in ("arithmetic and geometric mean", "Huygens and Snell"):
        assert verdict.status.holds
    reverse = {"<=": ">", ">=": "<"}[relation]
    assert decide(Bound(left, reverse, right, box)).status == REFUTED


@pytest.mark.parametrize(
    ("left", "relation", "right", "box"),
    [
        (sp.tan(x), ">=", x, {x: (0, 3)}),
        (sp.sin(x), "<=", x * sp.Rational(999, 1000), {x: (0, 1)}),
        (sp.exp(x), ">=", 1 + x + x**2 / 2, {x: (-1, 1)}),
        (sp.cos(x), ">=", 1 - x**2 / 3, {x: (-3, 3)}),
        (1 / x, ">=", -10, {x: (-1, 1)}),
        (sp.atan2(x, -1), "<=", 2, {x: (-1, 1)}),
    ],
)
def test_a_false_inequality_is_refuted(left, relation, right, box):
    assert decide(Bound(left, relation, right, box)).status == REFUTED
