"""Attacks on the ladder: random statements whose truth is sampled independently must never be PROVED wrongly.

The independent route is mpmath at 50 digits on a dense grid: a violation that it sees refutes any
claim of proof. That it sees none proves nothing, and is not asserted.
"""

from __future__ import annotations

import random

import mpmath
import pytest
import sympy as sp

from navsym.claims import CERTIFIED, PROVED, REFUTED, Bound, Equation
from navsym.proof.bounds import Sign, prove_sign
from navsym.proof.ladder import decide

x = sp.Symbol("x", real=True)
T = sp.Symbol("T", positive=True)


def random_expression(source: random.Random, symbols: list[sp.Symbol], depth: int) -> sp.Expr:
    if depth == 0:
        return source.choice([*symbols, *symbols, sp.Rational(source.randint(-3, 3), source.randint(1, 3)), sp.pi])
    make = source.choice("add sub mul mul div sin cos square sqrt exp tan abs log".split())
    one = random_expression(source, symbols, depth - 1)
    if make in ("add", "sub", "mul", "div"):
        two = random_expression(source, symbols, depth - 1)
        return {"add": one + two, "sub": one - two, "mul": one * two, "div": one / two if two != 0 else one}[make]
    functions = {"sin": sp.sin, "cos": sp.cos, "square": lambda e: e**2, "sqrt": sp.sqrt, "exp": sp.exp}
    functions |= {"tan": sp.tan, "abs": sp.Abs, "log": sp.log}
    return functions[make](one)


def usable(expression: sp.Expr) -> bool:
    bad = (sp.nan, sp.zoo, sp.oo, -sp.oo, sp.I)
    return bool(expression.free_symbols) and not expression.has(*bad) and expression.count_ops() < 40


def least_on_grid(expression: sp.Expr, box: dict, count: int) -> mpmath.mpf | None:
    """Smallest real value on a grid inside the box; None when nothing real was met."""
    symbols = sorted(expression.free_symbols, key=str)
    function = sp.lambdify(symbols, expression, "mpmath")
    least = None
    with mpmath.workdps(50):
        axes = [[lo + (hi - lo) * (k + 0.37) / count for k in range(count)] for lo, hi in (box[s] for s in symbols)]
        grid = [(v,) for v in axes[0]] if len(axes) == 1 else [(u, v) for u in axes[0][::4] for v in axes[1][::4]]
        for point in grid:
            try:
                value = function(*(mpmath.mpf(v) for v in point))
            except (ZeroDivisionError, ValueError, OverflowError):
                continue
            if isinstance(value, mpmath.mpc):
                if abs(value.imag) > mpmath.mpf(10) ** -30:
                    continue
                value = value.real
            if mpmath.isfinite(value):
                least = value if least is None else min(least, value)
    return least


def attack(seed: int, rounds: int) -> list[str]:
    source = random.Random(seed)
    wrong = []
    for _ in range(rounds):
        symbols = [x] if source.random() < 0.6 else [x, T]
        expression = random_expression(source, symbols, source.randint(1, 3))
        if not usable(expression):
            continue
        box = {x: (-1, 2), T: (0, 3)} if source.random() < 0.5 else {x: (0, 4), T: (1, 2)}
        proof = prove_sign(expression, box, Sign.NONNEGATIVE, budget=300)
        if proof.sign == Sign.UNKNOWN:
            continue
        least = least_on_grid(expression, box, 60)
        if least is not None and least < -mpmath.mpf(10) ** -25:
            wrong.append(f"{expression} on {box}: {proof}, but {least}")
    return wrong


def test_no_proved_sign_is_contradicted_by_a_grid():
    assert not attack(seed=7, rounds=250)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_no_proved_sign_is_contradicted_by_a_grid_in_a_long_run(seed):
    assert not attack(seed, rounds=2500)


# -- cases that once could go wrong, or that engines get wrong -----------------------------------


def test_a_tangent_is_not_monotone_through_its_pole():
    assert prove_sign(sp.tan(x) - x, {x: (0, 3)}).sign == Sign.UNKNOWN


def test_an_even_power_of_what_does_not_exist_proves_nothing():
    assert prove_sign(sp.tan(x) ** 2, {x: (0, 3)}).sign == Sign.UNKNOWN


def test_a_jump_is_not_seen_by_a_derivative():
    assert prove_sign(2 - sp.atan2(x, -1), {x: (-1, 1)}).sign == Sign.UNKNOWN


def test_equal_derivatives_do_not_make_equal_functions_across_a_pole():
    verdict = decide(Equation(sp.atan(x) + sp.atan(1 / x), sp.pi / 2))
    assert verdict.status == REFUTED


def test_the_root_of_a_square_is_not_the_number():
    assert decide(Equation(sp.sqrt((x - 1) ** 2), x - 1)).status == REFUTED
    assert decide(Equation(sp.sqrt((x - 1) ** 2), x - 1, {x: (1, 3)})).status == PROVED


def test_dependent_roots_are_not_a_nonzero_determinant():
    y = sp.Symbol("y", positive=True)
    assert decide(Bound(sp.sqrt(y**2) - y, "!=", 0)).status not in (PROVED, CERTIFIED)


def test_a_coupling_of_one_part_in_a_thousand_billion_is_not_zero():
    tiny = sp.Rational(1, 10**15)
    assert decide(Equation(tiny * x, sp.Integer(0))).status == REFUTED


def test_a_formula_that_divides_by_an_identical_zero_is_not_proved():
    zero = sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1
    assert decide(Equation(x / zero, x / zero + 0 * x)).status not in (PROVED, CERTIFIED)


@pytest.mark.parametrize(
    ("left", "right"),
    [
        (180 * sp.acos(sp.Rational(7823207, 7823209)) / sp.pi, sp.Integer(0)),
        (sp.sqrt(sp.Rational(10**30 + 1)), sp.Integer(10**15)),
        (sp.cos(sp.Rational(1, 10**20)), sp.Integer(1)),
        (sp.exp(sp.pi * sp.sqrt(163)), sp.Integer(262537412640768744)),
    ],
)
def test_what_is_nearly_equal_is_not_proved_equal(left, right):
    assert decide(Equation(left, right)).status not in (PROVED, CERTIFIED)


def test_conditions_inside_arguments_are_assumptions_too():
    verdict = decide(Equation(sp.sin(2 * sp.sqrt(x)), 2 * sp.sin(sp.sqrt(x)) * sp.cos(sp.sqrt(x))))
    assert verdict.status == PROVED and "x >= 0" in verdict.assumptions
    verdict = decide(Equation(sp.cos(1 / x) ** 2 + sp.sin(1 / x) ** 2, sp.Integer(1)))
    assert verdict.status == PROVED and "x != 0" in verdict.assumptions
