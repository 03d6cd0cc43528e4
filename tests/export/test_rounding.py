"""Derived bounds hold: computed values stay inside them, and are not absurdly far inside."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
import sympy as sp
from flint import arb

from navsym.core.balls import enclose
from navsym.export.accuracy.continuation import analyse
from navsym.export.accuracy.rounding import DOUBLE, FLOAT
from navsym.export.accuracy.uniform import uniform_bound
from navsym.export.accuracy.vectors import vectors
from navsym.export.expression_graph import build
from navsym.export.forms import safe
from tests.export import samples

x, y = sp.symbols("x y", real=True)

OPERATIONS = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "abs": abs,
    "sqrt": np.sqrt,
    "sin": np.sin,
    "cos": np.cos,
    "exp": np.exp,
    "log": np.log,
    "atan": np.arctan,
    "asin": np.arcsin,
    "acos": np.arccos,
    "sinh": np.sinh,
    "cosh": np.cosh,
    "tanh": np.tanh,
    "atan2": np.arctan2,
    "max": max,
    "min": min,
    "expm1": np.expm1,
    "pow": np.power,
}


def computed(graph, point, literals, kind):
    done = []
    for node, literal in zip(graph.nodes, literals, strict=True):
        args = [done[a] for a in node.args]
        if node.op == "input":
            done.append(kind(point[node.value]))
        else:
            done.append(kind(literal) if node.op == "const" else kind(OPERATIONS[node.op](*args)))
    return float(done[graph.roots[0]])


FORMULAS = [
    x**3 - x * y + sp.Rational(1, 3),
    sp.sin(3 * x) * sp.cos(y) - sp.exp(x - y),
    sp.sqrt(x**2 + y**2 + 1) / (2 + sp.sin(x)),
    sp.atan2(y, x + 5) + sp.log(x**2 + 1),
    sp.asin(x / 4) * sp.acos(y / 4) + sp.tanh(x) * sp.cosh(y) - sp.sinh(x),
    (x + 3) ** sp.Rational(2, 3) - sp.pi * sp.atan(y) + sp.Abs(x - y),
    (x - 1) ** 7 - sp.expand((x - 1) ** 7) + y,
]


@pytest.mark.parametrize("formula", FORMULAS)
@pytest.mark.parametrize(("arithmetic", "kind"), [(DOUBLE, np.float64), (FLOAT, np.float32)])
def test_every_computed_value_lies_within_its_bound(formula, arithmetic, kind) -> None:
    symbols = sorted(formula.free_symbols, key=str)
    graph = build([safe(formula, {})], symbols)
    literals = [float(kind(sp.N(n.value, 30))) if n.op == "const" else None for n in graph.nodes]
    generator = random.Random(1)
    worst = 0.0
    for _ in range(150):
        point = [float(kind(generator.uniform(-2, 2))) for _ in symbols]
        balls = [arb(p) for p in point]
        bound = analyse(graph, balls, arithmetic, literals)[graph.roots[0]].absolute
        exact = enclose(formula, dict(zip(symbols, balls, strict=True)), 160)
        error = abs(arb(computed(graph, point, literals, kind)) - exact)
        assert error <= bound
        worst = max(worst, float((error / bound).mid()))
    assert worst > 0.01, "a bound that nothing comes near explains nothing"


def test_relative_bounds_survive_a_singularity() -> None:
    T = sp.Symbol("T", positive=True)
    graph = build([1 / sp.sin(T / 4) ** 2], [T])
    literals = [float(n.value) if n.op == "const" else None for n in graph.nodes]
    bound = uniform_bound(graph, [(2.0**-60, 1.5)], DOUBLE, literals)
    assert bound.relative[0] < 12


def test_terms_are_kept_apart_where_the_sum_cancels() -> None:
    graph = build([x * sp.sin(y) - y], [x, y])
    bound = uniform_bound(graph, [(-1.0, 1.0), (-1.0, 1.0)], DOUBLE, [None] * len(graph.nodes))
    assert math.isinf(bound.relative[0]) and bound.scaled[0] < 6


def test_vectors_do_not_move_from_run_to_run() -> None:
    function = samples.by_name("rotation")
    assert vectors(function, 20) == vectors(function, 20)


def test_every_vector_holds_the_exact_value_of_the_claim() -> None:
    function = samples.by_name("Phi33")
    formula = function.pieces[0].formulas[0]
    for vector in vectors(function, 30):
        if vector.status == 0:
            exact = enclose(formula, {function.inputs[0].symbol: arb(vector.inputs[0])}, 200)
            assert arb(vector.lower[0]) < exact < arb(vector.upper[0])


def test_arguments_outside_the_proved_domain_have_vectors_too() -> None:
    statuses = [v.status for v in vectors(samples.by_name("Phi33"), 10)]
    assert statuses.count(1) == 5
