"""Where formulas exist: declarations that exclude one point and no more, cancellations, edges, odd undefined places."""

from __future__ import annotations

import random
from fractions import Fraction

from tests.attacks.evaluator import digits_of
from tests.attacks.schemes.values import draw_tiny
from tests.attacks.statements import Statement, family, find_failure

NONZERO, POSITIVE = {"x": "nonzero"}, {"x": "positive"}


@family("nonzero and positive")
def make_declared(rng: random.Random) -> Statement:
    """What a declaration excludes: only 0, no other root; and what it is enough for."""
    c = rng.choice(("1", "2", "3", "1/2", "pi", "7/3"))
    at = f"2*pi/({c})"
    arg = "x" if c == "1" else f"{c}*x"
    false = (
        (f"cos({arg}) < 1", at), (f"1 - cos({arg}) != 0", at), (f"(1 - cos({arg}))*(2 + sin(x)) > 0", at),
        (f"2 - cos({arg}) - cos({arg}) > 0", at), (f"sin({arg}) != 0", at), (f"tan({arg}) != 0", at),
        ("x**2 - x != 0", "1"),
        (f"sin({arg})**2 > 0", at), ("log(x**2) != 0", "-1"), ("abs(x) - x > 0", "3"), ("x**3 - 4*x != 0", "2"),
        (f"1/(1 + sin({arg})**2) < 1", at), (f"cos({arg})**2 < 1", at), ("x + 1/x != 2", "1"), ("x**2 != 1", "-1"),
        (f"abs(sin({arg})) > 0", at), (f"exp(cos({arg})) < exp(1)", at), ("x > 0", "-1"), ("1/x > -1e9", "-1e-10"),
    )  # fmt: skip
    true = (
        "x**2 > 0", "abs(x) > 0", "exp(x) != 1", "sinh(x) != 0", "cosh(x) > 1", "x/x = 1", "x**2/x = x",
        "tanh(x)/x > 0",
        "atan(x) != 0", "x*sinh(x) > 0", "1/x**2 > 0", "abs(x)/x + abs(x)/(-x) = 0", "x**0 = 1", "sin(x)**2 < x**2",
        "exp(x) > 1 + x", "1/x = x**(-1)", "x**4 + x**2 > 0", "abs(1/x) = 1/abs(x)", "x - sin(x) != 0",
        "cos(x) > 1 - x**2/2",
    )  # fmt: skip
    positive = (
        ("log(x) != 0", False, "1"), ("1/x > 0", True, ""), ("x - sin(x) > 0", True, ""), ("sin(x) < 1", False, "pi/2"),
        ("x - log(x) > 1", False, "1"), ("sqrt(x**2) = x", True, ""), ("x**(1/2)*x**(1/2) = x", True, ""),
        ("x + 1/x > 2", False, "1"), ("log(x) < x - 1", False, "1"), (f"cos({arg}) < 1", False, at),
        ("exp(log(x)) = x", True, ""), ("tanh(x) < x", True, ""), ("x**x > 69/100", True, ""),
        ("x**x > 7/10", False, "exp(-1)"),
        ("sqrt(x) <= x", False, "1/4"), ("atan(x) + atan(1/x) = pi/2", True, ""), ("x**(1/3) > 0", True, ""),
    )  # fmt: skip
    kind = rng.random()
    if kind < 0.4:
        text, at = rng.choice(false)
        return Statement(text, False, NONZERO, {"x": at})
    if kind < 0.65:
        return Statement(rng.choice(true), True, NONZERO)
    text, truth, at = rng.choice(positive)
    return Statement(text, truth, POSITIVE, None if truth else {"x": at})


@family("cancelled divisors")
def make_cancelled(rng: random.Random) -> Statement:
    """True wherever defined; a verdict must name what was cancelled, unless the declaration excludes it."""
    f = rng.choice(
        ("x - y", "1 - cos(x)", "x**2 - 4", "sin(x)", "x + y", "log(1 + x**2)", "exp(x) - 1", "x*y - 1", "x**3")
    )
    text = rng.choice((
        f"({f})/({f}) = 1", f"abs(sin(x)) + 1/({f}) <= abs(x) + 1/({f})", f"x*({f})/({f}) = x", f"0/({f}) = 0",
        f"({f})**2/({f}) = {f}", f"1/(1/({f})) = {f}", f"0*log({f}) = 0", f"exp(log({f})) = {f}", f"sqrt({f})**2 = {f}",
        f"log({f}) - log({f}) = 0", f"x**2 + sqrt({f}) >= sqrt({f})", f"(1/({f}))*0 < 1", f"({f})**(-1)*({f}) > 0",
        f"atan2(({f})**2, ({f})**2) = pi/4", f"acos({f}) + asin({f}) = pi/2", f"tan({f}) - tan({f}) = 0",
        f"abs({f})/abs({f}) = 1",
    ))  # fmt: skip
    return Statement(text, True, {name: "real" for name in ("x", "y") if name in text.replace("exp", "")})


@family("edges of domains")
def make_edge(rng: random.Random) -> Statement:
    """Bounds at the ends of a range where a function stops to exist or has no slope."""
    d = draw_tiny(rng, 3, 30)
    unit, half = {"x": ["-1", "1"]}, {"x": ["0", "1"]}
    text, symbols, at = rng.choice((
        ("asin(x) <= pi/2", unit, "1"), ("acos(x) >= 0", unit, "1"), ("sqrt(1 - x**2) >= 0", unit, "1"),
        ("sqrt(x) >= x", half, "1"), ("sqrt(x)*log(1 + x) <= log(2)", half, "1"), ("asin(x) >= x", half, "0"),
        ("acos(x) <= pi - x - pi/2", half, "0"), ("acos(x) >= sqrt(2*(1 - x))", half, "1"),
        ("x**(1/3) >= x**(1/2)", half, "1"),
        ("sqrt(1 - x) + sqrt(1 + x) >= sqrt(2)", unit, "1"), ("acos(x)**2 >= 2*(1 - x)", unit, "1"),
        ("atan2(sqrt(1 - x**2), x) <= pi", unit, "-1"), ("log(1 + x) <= x", half, "0"),
        ("sqrt(x*(1 - x)) <= 1/2", half, "1/2"),
        ("x*sqrt(1 - x**2) <= 1/2", unit, "sqrt(2)/2"), ("abs(asin(x)) <= pi/2", unit, "-1"),
        ("x**x <= 1", {"x": ["1e-9", "1"]}, "1"),
        ("acos(abs(x)) <= pi/2", unit, "0"), ("asin(sqrt(x)) >= sqrt(x)", half, "0"),
        ("(1 - x)**(3/2) >= 0", half, "1"),
    ))  # fmt: skip
    left, relation, right = text.rpartition(" <= " if "<=" in text else " >= ")
    kind, sign = rng.choice(("true", "false", "strict", "room")), "+" if "<=" in text else "-"
    if kind == "true":
        return Statement(text, True, symbols)
    if kind == "strict":
        return Statement(f"{left}{relation.replace('=', '')}{right}", False, symbols, {"x": at})
    if kind == "room":
        return Statement(f"{left}{relation.replace('=', '')}{right} {sign} {d}", True, symbols)
    return Statement(f"{left}{relation}{right} {'-' if sign == '+' else '+'} {d}", False, symbols, {"x": at})


@family("irrational ends")
def make_irrational_end(rng: random.Random) -> Statement:
    """A function that grows, on a range that ends where it takes a round value."""
    text, end, value = rng.choice((
        ("x**2", "sqrt(2)", "2"), ("x**3", "2**(1/3)", "2"), ("sin(x)", "pi/6", "1/2"), ("tan(x)", "pi/4", "1"),
        ("exp(x)", "log(3)", "3"), ("x**2 + x", "(sqrt(5) - 1)/2", "1"), ("-cos(x)", "pi/3", "-1/2"),
        ("atan(x)", "sqrt(3)", "pi/3"),
        ("sinh(x)", "log(2)", "3/4"), ("cosh(x)", "log(2)", "5/4"), ("tanh(x)", "log(3)/2", "1/2"),
        ("x**4", "sqrt(3)", "9"),
        ("log(1 + x)", "exp(1) - 1", "1"), ("asin(x)", "sqrt(3)/2", "pi/3"), ("x*sqrt(2)", "sqrt(2)/2", "1"),
        ("x**5", "7**(1/5)", "7"),
        ("x**2 - 2*sqrt(2)*x", "3*sqrt(2)", "6"), ("x**2/(1 + x**2)", "sqrt(3)", "3/4"),
        ("log(1 + x**2)", "sqrt(exp(2) - 1)", "2"),
    ))  # fmt: skip
    d, symbols = draw_tiny(rng), {"x": ["0", end]}
    kind = rng.choice(("<=", "<", "<= -", "< +", "!=", "!= +"))
    relation = kind.split()[0]
    if kind in ("<=", "< +", "!= +"):
        return Statement(f"{text} {relation} {value}{f' + {d}' if '+' in kind else ''}", True, symbols)
    return Statement(f"{text} {relation} {value}{f' - {d}' if '-' in kind else ''}", False, symbols, {"x": end})


@family("undefined places")
def make_undefined(rng: random.Random) -> Statement:
    """Statements that are without a value at many places, at all but one, or at all."""
    d, c = draw_tiny(rng, 3, 80), Fraction(rng.randint(1, 9), rng.randint(2, 9))
    n = rng.choice((4, 6, 8))
    return rng.choice((
        Statement("atan2(x - y, 1/x) + atan2(1/x, x - y) = pi/2", False, {}, {"x": "-1", "y": "1"}),
        Statement("atan2(y, x) = -atan2(-y, x)", False, {}, {"x": "-1", "y": "0"}),
        Statement("atan2(y, x) = -atan2(-y, x)", True, {"y": "positive"}),
        Statement("sqrt(cosh(exp(x))**2 - 1) = sinh(exp(x))", True, {"x": ["1", "100"]}),
        Statement(f"((x - y)**{n})**(1/{2 * n}) = sqrt(x - y)", True), Statement("0**0 = 1", None),
        Statement("x**0 = 1", None),
        Statement(f"sqrt(-(x - {c})**2) > 0", False, {}, {"x": str(c)}), Statement(f"sqrt(-(x - {c})**2) = 0", True),
        Statement(f"sqrt(cos({d}) - 1)**2 < 0", None), Statement(f"log(-{c}) = 1", None),
        Statement("sqrt(-1 - x**2) = 5", None),
        Statement(f"abs(log(1 + {d}) - {d}) < 0", False, {}, {}), Statement("log(x - x) = 0", None),
        Statement("1/(x - x) = 1", None),
        Statement("(x*abs(x))**(1/3) = x*abs(x)/abs(x)**(4/3)", True),
        Statement("((x*abs(x))**3)**(1/3) = x*abs(x)", True),
        Statement("acos(2 + x**2) < 0", None), Statement("asin(x)*0 = 0", True),
        Statement(f"atan2({c}*y, {c}*x) = atan2(y, x)", True),
        Statement("atan2(y, x) = 2*atan(y/(sqrt(x**2 + y**2) + x))", True),
        Statement("atan(y/x) = atan2(y, x)", False, {}, {"x": "-1", "y": "1"}),
        Statement("atan(x) + atan(y) = atan((x + y)/(1 - x*y))", False, {}, {"x": "2", "y": "2"}),
        Statement("log(x*y) = log(x) + log(y)", True), Statement("log(x**2) = 2*log(x)", True),
        Statement("asin(sin(x)) = x", False, {}, {"x": "2"}),
        Statement("acos(cos(x)) = x", True, {"x": ["0", "pi"]}),
        Statement("acos(cos(x)) = x", False, {"x": ["0", "pi + 1e-6"]}, {"x": "pi + 1e-6"}),
        Statement("sqrt(x**2) = x", False, {}, {"x": "-1"}), Statement("(x**2)**(1/4) = sqrt(x)", True),
    ))  # fmt: skip


@family("decimal exponents")
def make_exponent(rng: random.Random) -> Statement:
    """Formulas of the atmosphere and their like: powers with many decimals, against values at the ends."""
    scale, power = (
        rng.choice(("44330.77", "44330", "44331.5", "145366.45")),
        rng.choice(("5.25588", "5.2561", "4.25588", "0.190263", "1/5.25588")),
    )
    top = rng.choice(("8000", "11000", "5000"))
    text = f"(1 - h/{scale})**({power})"
    end = digits_of(text.replace("h", top), 12)
    d = draw_tiny(rng, 3, 9)
    symbols = {"h": ["0", top]}
    return rng.choice((
        Statement(f"{text} <= 1", True, symbols), Statement(f"{text} < 1", False, symbols, {"h": "0"}),
        Statement(f"{text} >= {end} - {d}", True, symbols), Statement(f"{text} >= {end} + {d}", False, symbols,
        {"h": top}),
        Statement(f"101325*{text} <= 101325 + {d}", True, symbols),
        Statement(f"{text} = 1 - h/{scale}*({power})", False, symbols, {"h": top}),
        Statement(f"({text})**(1/({power})) = 1 - h/{scale}", True, symbols),
        Statement(f"log({text}) = ({power})*log(1 - h/{scale})", True, symbols),
        Statement("x**1.2345 * x**0.7655 = x**2", True, {"x": "positive"}),
        Statement("x**2.0001 >= x**2", False, {"x": ["0", "1"]}, {"x": "1/2"}),
        Statement(f"x**{rng.choice(('1.4', '0.286', '3.5'))} > 0", True, {"x": "positive"}),
    ))  # fmt: skip


@family("partial sides")
def make_partial_side(rng: random.Random) -> Statement:
    """A side that exists on a part of the declared numbers, moved by a known amount, so that it fails there."""
    f = rng.choice(("sqrt(x)", "log(x)", "asin(x)", "1/x", "acos(x/2)", "x**(1/3)", "sqrt(1 - x**2)", "log(1 - x)"))
    d = draw_tiny(rng, 3, 30)
    return find_failure(
        Statement(
            rng.choice((f"{f} = {f} + {d}", f"{f} >= {f} + {d}", f"{f} + {d} <= {f}", f"{f} < {f}", f"{f} != {f}")),
            False,
        )
    )
