"""Parts with a hole at zero: which are found, what their polynomials leave, and what their code may lose.

The bounds are proved when code is made; here they are held against values of many digits, the code's own operations
in doubles and floats, and a list of formulas that divide by zero at an argument where they have a value.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
import sympy as sp
from flint import arb, arb_series, ctx

from navsym.claims import Equation
from navsym.core.balls import enclose, precision
from navsym.export.accuracy.continuation import MARGIN, SWITCHES, analyse, continuation, filled_bounds, zones
from navsym.export.accuracy.rounding import ARITHMETICS, DOUBLE, Bounded, literals_of
from navsym.export.accuracy.vectors import vectors
from navsym.export.atoms import expm1, filled, plain
from navsym.export.expression_graph import Graph, build
from navsym.export.forms import safe
from navsym.export.functions import function_of
from navsym.export.holes import Part, T
from tests.attacks.points.sweep import sweep_c
from tests.export import samples

x, a, b, tau = sp.symbols("x a b tau", real=True)
REALS = ("double", "float")
KINDS = {"double": np.float64, "float": np.float32}
PARTS = [
    Part(sp.sin(T), 1),
    Part(expm1(T), 1),
    Part(sp.sinh(T), 1),
    Part(T - sp.sin(T), 3),
    Part(T - sp.sin(T), 0),
    Part(expm1(T) - T, 2),
    Part(sp.log(1 + T), 1),
    Part(sp.sqrt(1 + T) - 1, 1),
    Part(sp.atan(T), 1),
    Part(sp.asin(T), 1),
    Part(sp.tanh(T), 1),
    Part(T * sp.cosh(T) - sp.sinh(T), 3),
]
ids = pytest.mark.parametrize("part", PARTS, ids=lambda p: f"{p.formula} over {p.divided}")
#: Formula -> value at the hole (x = 0 unless a place is given).
FORMULAS = {
    sp.log(1 + x) / x: 1,
    (sp.sqrt(1 + x) - 1) / x: sp.Rational(1, 2),
    sp.atan(x) / x: 1,
    sp.tan(x) / x: 1,
    sp.asin(x / 4) / x: sp.Rational(1, 4),
    sp.tanh(x) / x: 1,
    (1 - sp.cos(x)) / x: 0,
    x / sp.sin(x): 1,
    (sp.exp(x) - 1 - x) / x**2: sp.Rational(1, 2),
    1 / x - 1 / (sp.exp(x) - 1): sp.Rational(1, 2),
    sp.cosh(x) / sp.sinh(x) - 1 / x: 0,
    sp.cot(x) - 1 / x: 0,
    (x - sp.sin(x)) / x**3: sp.Rational(1, 6),
    1 / x**2 - (1 + sp.cos(x)) / (2 * x * sp.sin(x)): sp.Rational(1, 12),
    ((1 + x) ** sp.Rational(2, 3) - 1) / x: sp.Rational(2, 3),
}


def value(part: Part, t: arb) -> arb:
    return enclose(part.plain / T**part.divided, {T: t}, 2000)


def analyse_at(graph: Graph, at: arb) -> Bounded:
    return analyse(graph, [at], DOUBLE, literals_of(graph, DOUBLE))[graph.roots[0]]


# -- what is found ---------------------------------------


@pytest.mark.parametrize("formula", list(FORMULAS), ids=str)
def test_a_quotient_that_has_a_value_at_zero_is_written_with_one(formula: sp.Expr) -> None:
    form = safe(formula, {x: (sp.Rational(-1, 2), 2)})
    assert form.has(filled) and enclose(plain(form) - formula, {x: arb("0.7")}, 300).contains(0)
    found = analyse_at(build([form], [x]), arb(0))
    with precision(100):
        assert (found.value - enclose(sp.sympify(FORMULAS[formula]), {}, 100)).contains(0)
    assert found.absolute.is_finite() and found.absolute < arb(2) ** -40


@pytest.mark.parametrize(
    ("formula", "ranges"),
    [
        (sp.log(x) / x, {}),
        (sp.exp(x) / x, {}),
        (abs(x) / x, {}),
        ((sp.exp(1 + x) - sp.E) / x, {}),
        (sp.sqrt(x) / x, {}),
        (sp.sin(x) / x, {x: (1, 2)}),
        (sp.sin(x) + x**2, {}),
        ((x + 1) ** 2 / (x + 2), {}),
        (sp.sin(x + a) / x, {}),
    ],
    ids=str,
)
def test_what_has_no_such_hole_is_left_as_it_is(formula: sp.Expr, ranges: dict) -> None:
    assert safe(formula, ranges) == formula


@pytest.mark.parametrize(
    ("formula", "place", "limit"),
    [
        (sp.log(x) / (x - 1), {x: 1}, 1),
        (sp.sin(x) / (x - sp.pi), {x: sp.pi}, -1),
        ((sp.sqrt(x) - 1) / (2 * x - 2), {x: 1}, sp.Rational(1, 4)),
        ((1 - sp.exp(-a * tau)) / a, {a: 0, tau: 3}, 3),
        (sp.sin(a * x) * sp.sin(b * x) / x**2, {x: 0, a: 2, b: 3}, 6),
        ((sp.exp(-a * tau) - 1 + a * tau) / a**2, {a: 0, tau: 3}, sp.Rational(9, 2)),
    ],
    ids=str,
)
def test_holes_elsewhere_and_along_a_product_of_symbols(formula: sp.Expr, place: dict, limit: sp.Expr) -> None:
    form = safe(formula, {})
    symbols = sorted(formula.free_symbols, key=str)
    graph = build([form], symbols)
    with precision(200):
        at = [enclose(sp.sympify(place[s]), {}, 200) for s in symbols]
        found = analyse(graph, at, DOUBLE, literals_of(graph, DOUBLE))
        assert (found[graph.roots[0]].value - enclose(sp.sympify(limit), {}, 200)).contains(0)
        assert found[graph.roots[0]].value.rad() < arb("1e-10")


# -- what the polynomial leaves ---------------------------------------


@ids
@pytest.mark.parametrize("real", REALS)
def test_the_remainder_holds_up_to_the_margin_beyond_the_switch(part: Part, real: str) -> None:
    known = continuation(part, real)
    with precision(400):
        assert known.remainder < known.least * ARITHMETICS[real].unit() / 32 and known.switch in SWITCHES
        for k in range(1, 65):
            for sign in (-1, 1):
                t = arb(known.switch) * MARGIN * sign * k / 64
                exact = value(Part(part.formula, part.order), t)
                total = sum((c * t**j for j, c in enumerate(known.polynomial)), arb(0))
                assert abs(exact - total) <= known.remainder and known.least <= abs(exact) <= known.most


def test_the_polynomials_of_sine_are_those_of_the_textbook() -> None:
    for part, first in ((Part(sp.sin(T), 1), 1), (Part(T - sp.sin(T), 3), 3)):
        found = continuation(part, "double").polynomial
        sign = 1 if first == 1 else -1
        expected = [
            sp.Rational(sign * (-1) ** ((j + first - 1) // 2), sp.factorial(j + first)) if j % 2 == 0 else 0
            for j in range(len(found))
        ]
        assert [sp.Rational(int(c.p), int(c.q)) for c in found] == expected


# -- what the code loses ---------------------------------------


def computed(graph: Graph, t: float, real: str) -> float:
    """The operations of a branch in numbers of the type."""
    kind, done = KINDS[real], []
    functions = {
        "expm1": np.expm1,
        "sin": np.sin,
        "cos": np.cos,
        "log": np.log,
        "sqrt": np.sqrt,
        "atan": np.arctan,
        "asin": np.arcsin,
        "tanh": np.tanh,
        "sinh": np.sinh,
        "cosh": np.cosh,
        "neg": np.negative,
        "add": np.add,
        "sub": np.subtract,
        "mul": np.multiply,
        "div": np.divide,
    }
    for node, literal in zip(graph.nodes, literals_of(graph, ARITHMETICS[real]), strict=True):
        given = {"input": t, "const": literal}
        done.append(kind(given[node.op]) if node.op in given else functions[node.op](*(done[k] for k in node.args)))
    return float(done[graph.roots[0]])


@ids
@pytest.mark.parametrize("real", REALS)
def test_the_code_of_either_branch_stays_within_its_bound(part: Part, real: str) -> None:
    known, arithmetic, generator = continuation(part, real), ARITHMETICS[real], np.random.default_rng(1)
    sizes = [*generator.uniform(0.01, 0.999, 60), *(10.0 ** generator.uniform(-8, 0, 40)), 1.0, np.nextafter(1.0, 0.0)]
    top = 0.9 if part.formula.has(sp.log, sp.asin) or part.formula.has(sp.sqrt(1 + T)) else 4.0
    outer = [known.switch + (top - known.switch) * float(g) for g in generator.uniform(0, 1, 60)]
    with np.errstate(all="ignore"):
        for size in (*(known.switch * float(s) for s in sizes), *outer):
            t = float(KINDS[real](size * generator.choice((-1, 1))))
            graph = known.below if abs(t) < known.switch else known.above
            with precision(200):
                found = filled_bounds(part, Bounded(arb(t), arb(0), arb(0), arb(0)), arithmetic)
            got, exact = computed(graph, t, real), value(part, arb(t))
            room = found.absolute + 4 * arithmetic.unit() * abs(exact) * (real == "float" and abs(t) >= known.switch)
            assert abs(exact - got) <= room, (t, got)
            assert found.value.overlaps(exact)


@ids
def test_an_argument_with_an_error_carries_it_within_the_bound(part: Part) -> None:
    """At t, at the switch, across zero: the exact part at any argument within the error, and both branches count."""
    known = continuation(part, "double")
    with precision(300):
        places = (known.switch, -known.switch, 0.9 * known.switch, 1e-5, 1e-12, 0.0)
        for t, error in itertools.product(places, (1e-16, 1e-9)):
            error = error * abs(t) if t else error
            given = Bounded(arb(t), arb(error), arb("inf") if t == 0 else arb(error) / abs(t), arb("inf"))
            found = filled_bounds(part, given, DOUBLE)
            exact = known.value(arb(t)) if abs(t) < known.switch else value(part, arb(t))
            for share in (-1.0, -0.3, 0.7, 1.0):
                moved = arb(t) + arb(error) * share
                there = known.value(moved) if abs(moved) < known.switch else value(part, moved)
                assert abs(there - exact) <= found.absolute * (1 + arb("1e-9")) + 2 * known.remainder


def test_a_ball_across_the_switch_is_covered_by_both_branches() -> None:
    known = continuation(PARTS[0], "double")
    with precision(200):
        found = zones(known, arb(-3).union(arb(2)))
        assert [len(parts) for parts in found] == [1, 2]
        for t in ("-3", "-1", "-0.99", "0", "0.5", "1", "2"):
            assert any(part.contains(arb(t)) for parts in found for part in parts)
        assert not zones(known, arb("0.5").union(arb("0.75")))[1]
        assert not zones(known, arb("1.1").union(arb(2)))[0]


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-3, 0.7, 3.0])
def test_one_minus_cosine_is_a_square_without_a_switch(angle: float) -> None:
    """1 - cos x is written as 2 sin(x/2)^2: the same series, and no cancellation at any argument."""
    before, cap = ctx.prec, ctx.cap
    ctx.prec, ctx.cap = 200, 12
    try:
        at = arb_series([arb(angle), arb(1)])
        left, right = 1 - at.cos(), 2 * (at / 2).sin() * (at / 2).sin()
        difference = left - right
        assert all(difference[k].contains(0) and difference[k].rad() < arb("1e-40") for k in range(12))
    finally:
        ctx.prec, ctx.cap = before, cap
    graph = build([2 * sp.sin(x / 2) ** 2], [x])
    literals = [float(n.value) if n.op == "const" else None for n in graph.nodes]
    with precision(160):
        ball = arb(angle).union(arb(angle) * arb("1.001")) if angle else (arb(2) ** -60).union(arb(2) ** -50)
        done = analyse(graph, [ball], DOUBLE, literals)[graph.roots[0]]
    assert done.relative / DOUBLE.unit() < 12


def test_a_hole_that_is_none_has_vectors_at_zero_and_in_its_neighbourhood() -> None:
    for real, tiny in (("double", 1e-30), ("float", None)):
        found = {v.inputs[0]: v for v in vectors(samples.by_name("holes", real), 60) if v.status == 0}
        for at in (0.0, *([tiny] if tiny else [])):
            limits = [1, 0.5, 1 / 6, 1, 1]
            assert all(abs(n - y) < 1e-15 for n, y in zip(found[at].nearest, limits, strict=True))
            assert all(low < y < high for low, y, high in zip(found[at].lower, limits, found[at].upper, strict=True))


@pytest.mark.parametrize("real", REALS)
def test_compiled_quotients_hold_their_enclosures_across_zero(real: str) -> None:
    """All of FORMULAS at points that crowd around zero, and a vector at zero itself; none comes without a status."""
    made = []
    for k, formula in enumerate(FORMULAS):
        statement = Equation(formula, formula, {x: (sp.Rational(-1, 2), sp.Rational(3, 4))})
        made.append(function_of([samples.of_statement(f"quotient{k}", statement)], real=real))
    for found in sweep_c(made, 64).values():
        assert (found.wrong, found.undefined) == (0, 0) and found.worst < 300
    for function, limit in zip(made, FORMULAS.values(), strict=True):
        zero = next(v for v in vectors(function, 60) if v.inputs == (0.0,))
        assert zero.status == 0 and math.isclose(zero.nearest[0], float(limit), abs_tol=1e-300, rel_tol=1e-15)
