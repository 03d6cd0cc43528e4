"""The helpers against cancellation keep their bounds: proved by balls over the whole of their switch intervals.

sinc and x - sin x use a series below a switch and the plain form above it. Two things are proved for every x: the
series differs from the function by less than the share of the bound that is left to it, and the rounding of the
nested product, by the same analysis as for any exported graph, together with it stays below the bound in use.
"""

from __future__ import annotations

import itertools
from fractions import Fraction

import pytest
import sympy as sp
from flint import arb, arb_series, ctx

from navsym.export.accuracy.rounding import DOUBLE, FLOAT, LIBRARY, analyse
from navsym.export.expression_graph import build
from navsym.export.languages.printing import SINC_STEPS, SINC_SWITCH, X_MINUS_SIN_STEPS, X_MINUS_SIN_SWITCH
from navsym.proof.balls import precision

x = sp.Symbol("x", real=True)
ARITHMETICS = [DOUBLE, FLOAT]


def coefficients(steps: tuple[int, ...]) -> list[Fraction]:
    """Coefficients of the nested product in y."""
    found, size = [Fraction(1)], Fraction(1)
    for step in steps:
        size /= -step
        found.append(size)
    return found


@pytest.mark.parametrize(
    ("steps", "first", "switch"), [(SINC_STEPS, 1, SINC_SWITCH), (X_MINUS_SIN_STEPS, 3, X_MINUS_SIN_SWITCH)]
)
def test_the_series_are_those_of_sine(steps: tuple[int, ...], first: int, switch: float) -> None:
    """sin x / x and 6 (x - sin x)/x^3 have exactly these coefficients, so that the rest is the first one left out."""
    scale = Fraction(1 if first == 1 else 6)
    for k, coefficient in enumerate(coefficients(steps)):
        n = 2 * k + first
        expected = scale * Fraction((-1) ** k, int(sp.factorial(n)))
        assert coefficient == expected


@pytest.mark.parametrize("arithmetic", ARITHMETICS, ids=lambda a: a.name)
@pytest.mark.parametrize(
    ("steps", "first", "switch", "name"),
    [(SINC_STEPS, 1, SINC_SWITCH, "sinc"), (X_MINUS_SIN_STEPS, 3, X_MINUS_SIN_SWITCH, "x_minus_sin")],
)
def test_series_and_rounding_stay_below_the_bound_in_use(arithmetic, steps, first, switch, name) -> None:
    """On every cell of [0, switch]: truncation (alternating series) + rounding <= the bound, relative to the value."""
    nodes = nested_graph(steps, cubed=name == "x_minus_sin")
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


def nested_graph(steps: tuple[int, ...], cubed: bool):
    """The graph of the helper's code below the switch, operation by operation."""
    from navsym.export.expression_graph import Builder, Graph

    builder = Builder((x,))
    at = builder.put("input", value=0)
    y = builder.put("mul", at, at)
    one = builder.put("const", value=sp.S.One)
    text = builder.put("sub", one, builder.put("div", y, builder.put("const", value=sp.Integer(steps[-1]))))
    for step in reversed(steps[:-1]):
        share = builder.put("div", y, builder.put("const", value=sp.Integer(step)))
        text = builder.put("sub", one, builder.put("mul", share, text))
    if cubed:
        sixth = builder.put("div", builder.put("mul", at, y), builder.put("const", value=sp.Integer(6)))
        text = builder.put("mul", sixth, text)
    return Graph((x,), tuple(builder.nodes), (text,))


@pytest.mark.parametrize("arithmetic", ARITHMETICS, ids=lambda a: a.name)
def test_above_the_switch_the_plain_forms_keep_the_bound(arithmetic) -> None:
    """sin(x)/x is one library call and one division; x - sin x loses less than the bound from the switch on.

    The error is 2 u |sin x| of the call and u |x - sin x| of the difference: cells up to 8, and beyond them
    |sin x| <= 1 and x - sin x >= x - 1.
    """
    assert LIBRARY["sinc"] >= 2 + 1
    before = ctx.prec
    ctx.prec = 160
    try:
        cells = [(arb(X_MINUS_SIN_SWITCH) + arb(7) * k / 512).union(arb(X_MINUS_SIN_SWITCH) + arb(7) * (k + 1) / 512)
                 for k in range(512)]  # fmt: skip
        for ball in cells:
            sine = ball.sin()
            share = 1 + 2 * abs(sine) / (ball - sine)  # one rounding, and 2 u of the sine over the difference
            assert share * (1 + arithmetic.unit() * 4) < LIBRARY["x_minus_sin"], str(ball)
        assert 1 + 2 / (arb(8) - 1) < LIBRARY["x_minus_sin"]
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
