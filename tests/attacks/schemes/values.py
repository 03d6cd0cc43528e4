"""Constants: special values nearly hit, decimals of 60 digits, roots that nearly cancel, huge and tiny arguments."""

from __future__ import annotations

import random
from fractions import Fraction
from math import floor, isqrt

from tests.attacks.evaluator import UnsureError, bounds_on, digits_of
from tests.attacks.statements import Statement, family, truth_of_constants
from tests.attacks.trees import read, replace, write

RELATIONS = ("=", "!=", "<", "<=", ">", ">=")
#: Functions by the numbers that they take: every one of the language.
ANY = ("sin", "cos", "atan", "tanh", "abs", "exp", "sinh", "cosh", "tan", "sec", "cot", "csc")
ABOVE_ZERO = ("log", "sqrt", "atan2")
WITHIN_ONE = ("asin", "acos")
NUMBERS = ("1/2", "1", "2", "1/3", "pi/7", "sqrt(2)", "0.3", "3/4", "1e-3", "1/500", "7/5", "exp(-1)", "2/9", "1e-8")
FUNCTIONS = (*ANY, *ABOVE_ZERO, *WITHIN_ONE)


def constant(text: str, relation: str, other: str) -> Statement:
    """A relation of constants; raises ArithmeticError where no precision settles it."""
    statement = f"{text} {relation} {other}"
    truth = truth_of_constants(statement)
    return Statement(statement, truth, {}, None if truth else {})


def draw_tiny(rng: random.Random, least: int = 3, most: int = 30) -> str:
    return f"{rng.randint(1, 9)}e-{rng.randint(least, most)}"


def nest(rng: random.Random, inside: str, depth: int) -> str:
    """A formula with functions nested so deep; the innermost arguments are made to fit by sums and products."""
    text = inside
    for _ in range(depth):
        name = rng.choice(FUNCTIONS)
        if name in WITHIN_ONE:
            text = f"{name}({rng.choice((f'tanh({text})', f'sin({text})', f'({text})/(1 + abs({text}))'))})"
        elif name == "atan2":
            text = f"atan2({text}, {rng.choice(('1', '1/3', 'cosh(' + text + ')', '2'))})"
        elif name in ABOVE_ZERO:
            text = f"{name}({rng.choice((f'1 + ({text})**2', f'2 + sin({text})', f'abs({text}) + 1/9'))})"
        elif name in ("exp", "sinh", "cosh"):
            text = f"{name}({rng.choice((f'atan({text})', f'({text})/3', f'cos({text})'))})"
        elif name in ("tan", "sec"):
            text = f"{name}(atan({text})*{rng.choice(('0.9', '1/2', '1'))})"
        elif name in ("cot", "csc"):
            text = f"{name}(1 + sin({text}))"
        else:
            text = f"{name}({text}{rng.choice(('', ' - 1/2', '*2', ' + 1'))})"
    return text


@family("decimals")
def make_decimal(rng: random.Random) -> Statement:
    """A constant beside its decimal: printed to some digits, or moved in one of them; equality and tolerances."""
    text = nest(rng, rng.choice(NUMBERS), 3)
    digits = rng.choice((6, 12, 20, 30, 60))
    value = digits_of(text, digits)
    kind = rng.random()
    if kind < 0.3:
        return constant(text, rng.choice(RELATIONS), value)
    if kind < 0.6:
        return constant(text, rng.choice(RELATIONS), f"{value} {rng.choice('+-')} {draw_tiny(rng)}")
    unit = len(value.partition(".")[2])
    return constant(
        f"abs({text} - ({value}))", rng.choice(("<=", "<", ">", ">=")), f"{rng.choice((1, 5, 6))}e-{unit + 1}"
    )


@family("nearly special values")
def make_nearly_special(rng: random.Random) -> Statement:
    """Values near which a comparison of floats errs: arguments near 1, near 0 and near multiples of pi."""
    d, big = draw_tiny(rng, 3, 40), rng.choice((5, 8, 10, 15, 19, 20, 25, 40))
    zero = rng.choice((
        f"tan(acos(sin(1)**2 + cos(1)**2*cos({d}))/2)", f"abs(acos(sqrt(1 - {d})))", f"atan(acos(tanh({big})))",
        f"acos(1 - {d})", f"log(1 + {d})", f"sin(pi + {d})", f"acos(cos({d})*cos({d}))", f"sqrt(1 - cos({d}))",
        f"1 - tanh({big})", f"asin(1) - asin(1 - {d})", f"cosh({d}) - 1", f"exp({d}) - 1", f"tan({d})",
        f"atan2({d}, 1)",
        f"pi/2 - atan({big}e{big})", f"cos(pi/2 - {d})", f"atan2({d}, -1) - pi", f"sqrt(1 + {d}) - 1",
        f"1 - sin(pi/2 - {d})",
        f"acos(sqrt(0.{'9' * rng.randint(3, 25)}))", f"sinh({d})**3", f"log(cosh({d}))", f"exp(-{big}**2)",
    ))  # fmt: skip
    if rng.random() < 0.4:
        zero = rng.choice((f"abs({zero})", f"atan({zero})", f"({zero})**2", f"sin({zero})", f"sqrt(abs({zero}))"))
    if rng.random() < 0.4:
        return constant(f"abs({zero} - {draw_tiny(rng)})", rng.choice(("<", ">", "<=", "=")), draw_tiny(rng, 3, 40))
    return constant(zero, rng.choice(RELATIONS), "0")


@family("nearly cancelling roots")
def make_roots(rng: random.Random) -> Statement:
    """Sums of square roots that differ late; nested radicals that are equal, and that nearly are."""
    kind = rng.random()
    n = rng.choice((10, 1000, 10**6, 10**12, 10**20)) + rng.randint(1, 99)
    if kind < 0.3:
        return constant(f"sqrt({n + 1}) - sqrt({n})", rng.choice(RELATIONS), f"1/(2*sqrt({n}))")
    if kind < 0.5:
        k = rng.randint(1, 5)
        return constant(f"sqrt({n + k}) + sqrt({n - k})", rng.choice(RELATIONS), f"2*sqrt({n})")
    if kind < 0.7:
        a, b = sorted(rng.sample(range(2, 60), 2))
        small = rng.choice(("0", draw_tiny(rng)))
        relation = rng.choice(("=", "<=", ">=", "!=", "<"))
        text = f"sqrt({a + b} + 2*sqrt({a * b})) {relation} sqrt({a}) + sqrt({b})"
        if small == "0":
            truth = relation in ("=", "<=", ">=")
            return Statement(text, truth, {}, None if truth else {})
        return constant(text.split(relation)[0].strip(), relation, f"sqrt({a}) + sqrt({b}) + {small}")
    if kind < 0.85:
        a = rng.randint(1, 9)
        text = f"(sqrt({a * a + 1}) + {a})**(1/3) - (sqrt({a * a + 1}) - {a})**(1/3)"
        return constant(text, rng.choice(RELATIONS), digits_of(text, rng.choice((8, 15, 30))))
    parts = [rng.randint(1, 10**6) for _ in range(6)]
    rest = sum(isqrt(p * 10**24) for p in parts[:3]) - sum(isqrt(p * 10**24) for p in parts[3:])
    left, right = (" + ".join(f"sqrt({p})" for p in some) for some in (parts[:3], parts[3:]))
    return constant(left, rng.choice(("<", ">", "=")), f"{right} {'-' if rest < 0 else '+'} {abs(rest)}e-12")


@family("huge and tiny arguments")
def make_extreme(rng: random.Random) -> Statement:
    k, d = rng.choice((15, 20, 40, 100, 300)), draw_tiny(rng, 10, 200)
    x = rng.choice(("x", "y"))
    text = rng.choice((
        f"sin(1e{k})", f"cos(1e{k} + 1)", f"tan(1e{k})", f"exp(-1e{min(k, 20)}) + 1 - 1", f"log(1e{k})",
        f"tanh(1e{k // 5}) - 1",
        f"1e{k} + {d} - 1e{k}", f"(1 + {d})**{k} - 1", f"cos({d}) - 1", f"atan(1e{k}) - pi/2",
        f"sqrt(1e{k} + 1) - sqrt(1e{k})",
        f"exp({d}) - 1 - {d}", f"sinh({k})", f"exp({k}) - exp({k} - {d})", f"atan2({d}, -1e{k}) - pi",
        f"exp(exp({k % 7}))",
    ))  # fmt: skip
    known = rng.choice((
        (f"{x} + {d} > {x}", True), (f"{x} + 1e{k} = {x}", False), (f"log(1e{k}*exp({x})) = {x} + {k}*log(10)", True),
        (f"exp({x})*exp(1e3) > exp({x})", True), (f"{x}**2 + {d} > 0", True), (f"({x} + 1e{k}) - 1e{k} = {x}", True),
        (f"{d}*{x}**2 >= {d}**2*{x}**2", True), (f"1/(1e{k} + {x}**2) > 0", True), (f"cosh({x}) > 1 - {d}", True),
        (f"exp(-{x}**2*1e{k}) <= 1", True), (f"{x}**2 - {d} >= 0", False), (f"tanh({x}) < 1 - {d}", False),
    ))  # fmt: skip
    if rng.random() < 0.5:
        other = rng.choice(("0", d, f"-{d}", digits_of(text, 20)))
        return constant(text, rng.choice(RELATIONS), other)
    return Statement(*known, {x: "real"}, None if known[1] else {x: "1000" if "tanh" in known[0] else "0"})


@family("functions three deep")
def make_nested(rng: random.Random) -> Statement:
    """f(g(h(x))) on a range against bounds of intervals over pieces: above all, below some, or between."""
    low, high = sorted(rng.sample((-2, -1, 0, 1, 2, 3), 2))
    text = nest(rng, "x", 3)
    tree, ends = read(text), {"x": [str(low), str(high)]}
    least, most = bounds_on(tree, "x", Fraction(low), Fraction(high), 48)
    if most - least > 10**6:
        raise UnsureError("too wide")
    margin = Fraction(1, 10 ** rng.randint(1, 6)) + Fraction(most - least).limit_denominator(1000) / 1000
    kind = rng.choice(("above", "below", "inside", "equal"))
    if kind == "above":
        return Statement(f"{text} {rng.choice(('<', '<=', '!='))} {round_to(most + margin, 1)}", True, ends)
    if kind == "below":
        return Statement(f"{text} {rng.choice(('>', '>=', '!='))} {round_to(least - margin, -1)}", True, ends)
    point = Fraction(rng.randint(0, 100), 100) * (high - low) + low
    value = digits_of(write(replace(tree, {"x": ("number", point)})), 15)
    small = draw_tiny(rng, 3, 8)
    if kind == "inside":
        relation, sign = rng.choice((("<", "-"), ("<=", "-"), (">", "+"), (">=", "+")))
        return Statement(f"{text} {relation} {value} {sign} {small}", False, ends, {"x": str(point)})
    relation = rng.choice(("=", ">=", "<"))
    other = (
        f"{text} {'+' if relation == '>=' else rng.choice('+-')} {small}" if relation != "<" else f"{text} - {small}"
    )
    return Statement(f"{text} {relation} {other}", False, ends, {"x": str(point)})


def round_to(value: object, way: int) -> str:
    """A short decimal beyond a number."""
    thousands = floor(value * 10**6) + (1 if way > 0 else 0)
    return f"{'-' if thousands < 0 else ''}{abs(thousands) // 10**6}.{abs(thousands) % 10**6:06d}"
