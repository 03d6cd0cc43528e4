"""The helpers against cancellation keep their bounds: proved by balls over the whole of their switch intervals.

Each helper uses a series below a switch and the plain form above it. Two things are proved for every x: the
series differs from the function by less than the share of the bound that is left to it, and the rounding of the
nested product, by the same analysis as for any exported graph, together with it stays below the bound in use.
"""

from __future__ import annotations

import itertools
from fractions import Fraction

import pytest
import sympy as sp
from flint import arb, arb_series, ctx

from navsym.export.accuracy.rounding import ARITHMETIC_VALUES, DOUBLE, FLOAT, LIBRARY, SLOPES, analyse, up
from navsym.export.accuracy.vectors import vectors
from navsym.export.expression_graph import FUNCTION_OF, build
from navsym.export.forms import MEANING, plain
from navsym.export.languages.helpers import HELPERS, SINC_STEPS, X_MINUS_SIN_STEPS
from navsym.proof.balls import precision

x = sp.Symbol("x", real=True)
ARITHMETICS = [DOUBLE, FLOAT]
SWITCH = HELPERS["x_minus_sin"].switch
assert HELPERS["sinc_defect"].switch == SWITCH


def coefficients(steps: tuple[int, ...]) -> list[Fraction]:
    """Coefficients of the nested product in y."""
    found, size = [Fraction(1)], Fraction(1)
    for step in steps:
        size /= -step
        found.append(size)
    return found


@pytest.mark.parametrize(("steps", "first"), [(SINC_STEPS, 1), (X_MINUS_SIN_STEPS, 3)])
def test_the_series_are_those_of_sine(steps: tuple[int, ...], first: int) -> None:
    """sin x / x and 6 (x - sin x)/x^3 have exactly these coefficients, so that the rest is the first one left out."""
    scale = Fraction(1 if first == 1 else 6)
    for k, coefficient in enumerate(coefficients(steps)):
        n = 2 * k + first
        expected = scale * Fraction((-1) ** k, int(sp.factorial(n)))
        assert coefficient == expected


@pytest.mark.parametrize("arithmetic", ARITHMETICS, ids=lambda a: a.name)
@pytest.mark.parametrize(("name", "first"), [("sinc", 1), ("x_minus_sin", 3), ("sinc_defect", 3)])
def test_series_and_rounding_stay_below_the_bound_in_use(arithmetic, name, first) -> None:
    """On every cell of [0, switch]: truncation (alternating series) + rounding <= the bound, relative to the value."""
    steps, switch = HELPERS[name].steps, HELPERS[name].switch
    nodes = nested_graph(name)
    literals = [float(node.value) if node.op == "const" else None for node in nodes.nodes]
    scale, quotient = (1, 6) if first == 1 else (6, 20)
    for low, high in halving_cells(switch, 300 if arithmetic is DOUBLE else 30):
        with precision(160):
            done = analyse(nodes, [low.union(high)], arithmetic, literals)[nodes.roots[0]]
            n = 2 * len(steps) + first + 2
            rest = high ** (2 * len(steps) + 2) * scale / arb(int(sp.factorial(n)))
            least = 1 - high**2 / quotient  # the alternating series from below
            used = (done.relative + rest / least) / arithmetic.unit()
            assert used < LIBRARY[name], (str(low), str(high), str(used))


def halving_cells(switch: float, halvings: int) -> list[tuple[arb, arb]]:
    """(0, switch] down to switch/2^halvings, where results are still far above underflow: eight cells an octave."""
    ends = [arb(switch) * arb(2) ** (arb(-k) / 8) for k in range(8 * halvings + 1)]
    return [(arb(b.lower()), arb(a.upper())) for a, b in itertools.pairwise(ends)]


def nested_graph(name: str):
    """The graph of the helper's code below the switch, operation by operation."""
    from navsym.export.expression_graph import Builder, Graph

    builder, steps = Builder((x,)), HELPERS[name].steps
    at = builder.put("input", value=0)
    y = builder.put("mul", at, at)
    one, six = (builder.put("const", value=sp.Integer(k)) for k in (1, 6))
    text = builder.put("sub", one, builder.put("div", y, builder.put("const", value=sp.Integer(steps[-1]))))
    for step in reversed(steps[:-1]):
        share = builder.put("div", y, builder.put("const", value=sp.Integer(step)))
        text = builder.put("sub", one, builder.put("mul", share, text))
    if name == "x_minus_sin":
        text = builder.put("mul", builder.put("div", builder.put("mul", at, y), six), text)
    if name == "sinc_defect":
        text = builder.put("div", text, six)
    return Graph((x,), tuple(builder.nodes), (text,))


@pytest.mark.parametrize("arithmetic", ARITHMETICS, ids=lambda a: a.name)
def test_above_the_switch_the_plain_forms_keep_the_bound(arithmetic) -> None:
    """sin(x)/x is one library call and one division; x - sin x loses less than the bound from the switch on.

    The error is 2 u |sin x| of the call and u |x - sin x| of the difference: cells up to 8, and beyond them
    |sin x| <= 1 and x - sin x >= x - 1. The three quotients of sinc_defect add 3 u.
    """
    assert LIBRARY["sinc"] >= 2 + 1
    before = ctx.prec
    ctx.prec = 160
    try:
        cells = [(arb(SWITCH) + arb(7) * k / 512).union(arb(SWITCH) + arb(7) * (k + 1) / 512)
                 for k in range(512)]  # fmt: skip
        for ball in cells:
            sine = ball.sin()
            share = 3 + 1 + 2 * abs(sine) / (ball - sine)  # one rounding, and 2 u of the sine over the difference
            assert share * (1 + arithmetic.unit() * 8) < min(LIBRARY["x_minus_sin"], LIBRARY["sinc_defect"]), str(ball)
        assert 3 + 1 + 2 / (arb(8) - 1) < LIBRARY["x_minus_sin"]
    finally:
        ctx.prec = before


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


@pytest.mark.parametrize(("name", "called"), [("exprel", 2), ("sinhc", 4)])
def test_a_helper_that_is_one_at_zero_keeps_its_bound_on_both_sides(name: str, called: int) -> None:
    """Below the switch |f - 1| is less than u/16 of either type; above it, one call of the library and one quotient."""
    with precision(160):
        switch = arb(HELPERS[name].switch)
        for x_ in (switch, -switch):
            assert abs(ARITHMETIC_VALUES[name](x_) - 1) < DOUBLE.unit() / 16  # f grows with |x|, or with x
    assert called + 1 < LIBRARY[name]


@pytest.mark.parametrize("name", ["sinc", "sinc_defect", "exprel", "sinhc"])
def test_slopes_and_values_of_the_helpers_are_those_of_their_meaning(name: str) -> None:
    """By automatic differentiation in balls at many points; at zero the value is the limit."""
    form = {
        "sinc": lambda t: t.sin() / t, "sinc_defect": lambda t: (t - t.sin()) / (t * t * t),
        "exprel": lambda t: (t.exp() - 1) / t, "sinhc": lambda t: ((t.exp() - (-t).exp()) / 2) / t,
    }[name]  # fmt: skip
    kind = FUNCTION_OF[name]
    assert sp.limit(plain(kind(x)), x, 0) == sp.Rational(1, 6 if name == "sinc_defect" else 1)
    with precision(400):
        zero = ARITHMETIC_VALUES[name](arb(0))
        assert zero.contains(arb(1) / (6 if name == "sinc_defect" else 1)) and zero.rad() < arb("1e-40")
        for at in ("-9.5", "-2", "-0.75", "-1e-9", "1e-20", "0.01", "0.9", "1.1", "3", "7.25"):
            series = form(arb_series([arb(at), arb(1)], 2))
            assert ARITHMETIC_VALUES[name](arb(at)).overlaps(series[0])
            assert abs(series[1]) <= up(SLOPES[name](arb(at))), at
            assert kind in MEANING


def test_a_hole_that_is_none_has_vectors_at_zero_and_in_its_neighbourhood(samples) -> None:
    for real, tiny in (("double", 1e-30), ("float", None)):
        found = {v.inputs[0]: v for v in vectors(samples.by_name("holes", real), 60) if v.status == 0}
        for at in (0.0, *([tiny] if tiny else [])):
            limits = [1, 0.5, 1 / 6, 1, 1]
            assert all(abs(n - y) < 1e-15 for n, y in zip(found[at].nearest, limits, strict=True))
            assert all(low < y < high for low, y, high in zip(found[at].lower, limits, found[at].upper, strict=True))
