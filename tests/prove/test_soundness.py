"""Attacks on the ladder: random statements whose truth is sampled independently must never be PROVED wrongly.

The independent route is mpmath at 50 digits on a dense grid: a violation that it sees refutes any
claim of proof. That it sees none proves nothing, and is not asserted.
"""

from __future__ import annotations

import random

import mpmath
import pytest
import sympy as sp

from navsym.claims import CERTIFIED, OPEN, PROVED, REFUTED, Bound, Equation, Finding, Optimum, Property
from navsym.core.balls import UnsupportedError
from navsym.core.errors import DomainError
from navsym.prove.claimfile import claims_from, decide_claims
from navsym.prove.ladder import decide
from navsym.prove.search import EASY
from navsym.prove.signs import Sign, prove_sign

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
        proof = prove_sign(expression, box, Sign.NONNEGATIVE, rounds=EASY)
        if proof.sign == Sign.UNKNOWN:
            continue
        least = least_on_grid(expression, box, 60)
        if least is not None and least < -(mpmath.mpf(10) ** -25):
            wrong.append(f"{expression} on {box}: {proof}, but {least}")
    return wrong


@pytest.mark.parametrize("rounds", [50, pytest.param(125, marks=pytest.mark.long)])
def test_no_proved_sign_is_contradicted_by_a_grid(rounds):
    assert not attack(seed=7, rounds=rounds)


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


# -- holes found by reading, and what closed them ------------------------------------------------


def holds(statement) -> bool:
    return decide(statement).status in (PROVED, CERTIFIED)


def test_a_derivative_that_lost_its_pole_does_not_make_a_function_monotone():
    """The derivative of atan(tan(x)) is 1; all three looks at inner points lie left of pi/2."""
    assert prove_sign(sp.atan(sp.tan(x)), {x: (0, sp.Rational(8, 5))}).sign == Sign.UNKNOWN


@pytest.mark.parametrize(
    ("expression", "range_", "condition"),
    [
        (sp.tan(x) * sp.cos(x), (sp.Rational(1, 10), 3), "cos(x) != 0"),
        ((1 - sp.cos(x) ** 2) / sp.sin(x), (sp.Rational(1, 10), sp.pi), "sin(x) != 0"),
        ((x**2 + x) / x, (sp.Rational(-1, 2), 1), "x != 0"),
    ],
)
def test_a_pole_that_factoring_cancels_leaves_no_proved_sign(expression, range_, condition):
    """Real roots prove the bound wherever it exists, and the pole is among the assumptions."""
    assert prove_sign(expression, {x: range_}).sign == Sign.UNKNOWN
    assert decide(Bound(expression, ">=", sp.Integer(0), {x: range_})).assumptions == (condition,)


def test_bounds_list_what_their_sides_divide_by():
    assert "cos(x) != 0" in decide(Bound(sp.tan(x) * sp.cos(x), ">=", sp.sin(x))).assumptions
    assert "x != 0" in decide(Bound(x + 1 / x, ">=", 1 / x, {x: (0, 5)})).assumptions


def test_a_point_where_a_side_does_not_exist_refutes_no_bound():
    assert decide(Bound(sp.log(x) + x, ">=", sp.log(x), {x: (-1, 1)})).status != REFUTED
    assert decide(Bound(1 / x + x, "!=", 1 / x, {x: (-1, 1)})).status != REFUTED


def test_poles_and_powers_inside_arguments_are_assumptions():
    inside = sp.tan(x)
    verdict = decide(Equation(sp.sin(2 * inside), 2 * sp.sin(inside) * sp.cos(inside)))
    assert "cos(x) != 0" in verdict.assumptions
    y = sp.Symbol("y", real=True)
    verdict = decide(Equation(sp.sin(2 * x**y), 2 * sp.sin(x**y) * sp.cos(x**y)))
    assert "x > 0" in verdict.assumptions
    verdict = decide(Equation(sp.atan2(x, y) * (x + 1), x * sp.atan2(x, y) + sp.atan2(x, y)))
    assert "x**2 + y**2 != 0" in verdict.assumptions


def test_what_exists_nowhere_is_not_proved_equal():
    root = sp.sqrt(-1 - x**2)
    assert not holds(Equation((root + x) ** 2, -1 - x**2 + 2 * x * root + x**2))
    constant = sp.sqrt(1 - sp.sqrt(2))
    assert not holds(Equation((constant + 1) ** 2, 2 - sp.sqrt(2) + 2 * constant))


def test_dividing_by_a_hidden_zero_is_not_proved():
    zero = sp.sqrt(3 + 2 * sp.sqrt(2)) - 1 - sp.sqrt(2)
    assert not holds(Equation((zero**2 + x) / zero, zero + x / zero))


@pytest.mark.parametrize("range_", [(3, 1), (sp.pi, 3)])
def test_an_empty_range_is_refused_and_does_not_hang(range_):
    with pytest.raises(DomainError):
        decide(Bound(x, ">=", sp.Integer(0), {x: range_}))


def test_a_positive_symbol_in_a_negative_range_is_refused():
    with pytest.raises(DomainError):
        decide(Bound(T, "<=", sp.Integer(0), {T: (-2, -1)}))


def test_ranges_obey_what_the_symbol_was_declared_to_be():
    low, high = sp.Symbol("low", nonpositive=True), sp.Symbol("high", nonnegative=True)
    assert decide(Bound(low, "<=", sp.Integer(0))).status == PROVED
    assert decide(Bound(high, ">=", sp.Rational(-1, 2), {high: (-1, 1)})).status == PROVED


@pytest.mark.parametrize("declared", [{"even": True}, {"commutative": False}, {"imaginary": True}])
def test_declarations_that_a_range_cannot_hold_are_refused(declared):
    a, b = sp.symbols("a b", **declared)
    with pytest.raises(UnsupportedError):
        decide(Equation(a * b, b * a + a - b))


def test_values_inside_tuples_are_compared_like_values():
    assert decide(Property((True,), Finding((1,), "count", PROVED))).status == REFUTED


# -- formulas of files: what the algebra cancels while it reads ------------------------------------


def proved(left, relation, right, **symbols):
    """The record of one formula of a claim file."""
    claim = {"id": "one", "left": left, "relation": relation, "right": right}
    document = {"symbols": symbols or {"x": "real"}, "claim": [claim]}
    return decide_claims(claims_from(document, "f"))[0].document()


@pytest.mark.parametrize(
    ("left", "relation", "right"),
    [
        ("x**2/x", "!=", "0"),
        ("sqrt(x)**2", ">=", "0"),
        ("cos(acos(x))", "<=", "2"),
        ("exp(log(x))", ">", "0"),
        ("x**2/x", "<", "0.00001 + x**2/x + x**2*(x/x)"),
    ],
)
def test_a_point_where_the_text_has_no_value_refutes_nothing(left, relation, right):
    assert proved(left, relation, right)["status"] != REFUTED


def test_the_domain_of_an_inverse_sine_that_cancels_is_assumed():
    assert proved("sin(asin(x))", "=", "x")["assumptions"] == ["1 - x**2 >= 0"]
    assert proved("exp(log(x))", "=", "x")["assumptions"] == ["x > 0"]
    assert proved("x**y*x**(-y)", "=", "1", x="real", y="real")["assumptions"] == ["x > 0"]


@pytest.mark.parametrize("nowhere", ["log(-1 - x**2)", "asin(2 + x**2)", "1/(sin(x)**2 + cos(x)**2 - 1)"])
def test_a_text_that_has_a_value_nowhere_is_not_proved(nowhere):
    assert proved(f"{nowhere} - {nowhere}", "=", "0")["status"] == OPEN


def test_what_a_claim_takes_to_be_nonzero_is_no_counterexample():
    n = sp.Symbol("n", real=True)
    assert decide(Equation(sp.sign(n) ** 2, sp.Integer(1), nonzero=(n,))).status != REFUTED


@pytest.mark.parametrize(
    "text", ["sin(asin(-5/2))", "cos(acos(sqrt(3)))", "exp(log(1 - sqrt(2)))", "(-2)**x*(-2)**(-x)"]
)
def test_a_constant_outside_a_domain_is_refused_before_it_cancels(text):
    with pytest.raises(DomainError):
        proved(text, "<=", "5")


# -- ranges in which nothing lies, and ends that are left out -------------------------------------


@pytest.mark.parametrize(
    ("declared", "ends"),
    [
        ({"negative": True}, (0, 1)),
        ({"integer": True, "nonzero": True}, (sp.Rational(-1, 2), sp.Rational(1, 2))),
        ({"integer": True}, (sp.Rational(1, 3), sp.Rational(1, 2))),
    ],
)
def test_a_range_without_a_point_ends_the_search_and_proves_nothing(declared, ends):
    n = sp.Symbol("n", **declared)
    assert decide(Equation(n**2, n**2 + n - n, {n: ends})).status == OPEN


def test_a_numeral_near_to_what_exists_nowhere_is_not_certified():
    a = sp.Symbol("a", real=True)
    nowhere = sp.log(-1 - a**2)
    assert decide(Equation(nowhere, nowhere + sp.Rational(1, 4), tolerance=1)).status == OPEN


def test_a_numeral_lists_what_subtraction_cancels():
    a = sp.Symbol("a", real=True)
    verdict = decide(Equation(1 / a, 1 / a + sp.Rational(1, 3), {a: (-1, 1)}, tolerance=sp.Rational(1, 2)))
    assert verdict.assumptions == ("a != 0",)


def test_a_value_at_an_end_that_is_left_out_is_not_taken_for_the_limit():
    # x**(1/log(x)) is e for 0 < x < 1, and the algebra puts 0**0 = 1 at zero
    tiny, p = sp.Rational(1, 10**400), sp.Symbol("p", positive=True)
    verdict = decide(Bound(p + tiny * sp.Rational(3, 2) - tiny * p ** (1 / sp.log(p)), ">=", 0, {p: (0, sp.S.Half)}))
    assert not verdict.status.holds


def test_a_root_of_a_quotient_with_a_negative_constant_below_keeps_its_sign():
    x = sp.Symbol("x", real=True)
    radicand = 5 + x * (x - 1) / (1 - x)  # 5 - x, reduced to (x - 5)/(-1)
    expression = (1 + sp.sqrt(radicand)) ** 2
    assert prove_sign(expression, {x: (2, 4)}).sign >= Sign.NONNEGATIVE
    assert prove_sign(-expression, {x: (2, 4)}).sign == Sign.UNKNOWN


def test_a_point_where_an_inner_part_is_infinite_refutes_nothing():
    x = sp.Symbol("x", real=True)
    assert decide(Bound(1 / sp.log(x), "<", sp.Integer(0), {x: (0, sp.S.Half)})).status != REFUTED


def test_a_dual_that_moves_with_the_variable_proves_no_optimum():
    """|5 + t x2| <= 1 with x2 = -5/t: the printed value 5 passed for optimal, where 3 is reached."""
    t = sp.Symbol("t", real=True)
    problem = ((sp.Integer(1), t), (sp.Integer(1), sp.Integer(0)), t, (sp.Integer(1), sp.Integer(2)))
    solution = ((sp.Integer(1), sp.Rational(3, 2)), (sp.Integer(3), sp.Integer(-2)), sp.Integer(5))
    assert decide(Optimum(*problem, (sp.Integer(5), -5 / t), *solution)).status == OPEN
    best = ((sp.Integer(1), sp.Integer(2)), (sp.Integer(2), sp.Integer(-1)), sp.Integer(3))
    assert decide(Optimum(*problem, (sp.Integer(3), sp.Integer(-2)), *best)).status == PROVED
