"""Inequalities with known cases of equality: kinks and strips, many symbols, margins of known size."""

from __future__ import annotations

import random
from fractions import Fraction

from tests.attacks.schemes.values import draw_tiny
from tests.attacks.statements import Statement, family
from tests.attacks.trees import read, replace, write

#: left <= right for real a, b, c, d and positive p, q, r; equal at the point.
THEOREMS = (
    ("abs(a + b)", "abs(a) + abs(b)", "a=1 b=2"), ("sin(a)", "abs(a)", "a=0"), ("1 + a", "exp(a)", "a=0"),
    ("log(p)", "p - 1", "p=1"), ("2*a*b", "a**2 + b**2", "a=3 b=3"), ("sqrt(p*q)", "(p + q)/2", "p=2 q=2"),
    ("1 - a**2/2", "cos(a)", "a=0"), ("2", "p + 1/p", "p=1"), ("(a + b + c)**2", "3*(a**2 + b**2 + c**2)",
    "a=1 b=1 c=1"),
    ("a*b + b*c + c*a", "a**2 + b**2 + c**2", "a=1 b=1 c=1"), ("abs(abs(a) - abs(b))", "abs(a - b)", "a=1 b=2"),
    ("(a*b + c*d)**2", "(a**2 + c**2)*(b**2 + d**2)", "a=1 b=1 c=2 d=2"), ("1 + a**2/2", "cosh(a)", "a=0"),
    ("0", "p*(p - q)*(p - r) + q*(q - p)*(q - r) + r*(r - p)*(r - q)", "p=1 q=1 r=1"),
    ("a**3*b + a*b**3", "a**4 + b**4", "a=1 b=1"),
    ("3*a**2*b**2", "a**4*b**2 + a**2*b**4 + 1", "a=1 b=1"), ("a", "sqrt(1 + a**2) - 1 + abs(a)", "a=0"),
    ("3*(a**3*b + b**3*c + c**3*a)", "(a**2 + b**2 + c**2)**2", "a=1 b=1 c=1"), ("a - abs(a)", "0", "a=5"),
    ("abs(sin(a))", "abs(a)", "a=0"),
    ("exp((a + b)/2)", "(exp(a) + exp(b))/2", "a=1 b=1"), ("a*p", "exp(a) + p*log(p) - p", "p=1 a=0"),
    ("tanh(a)*a", "a**2", "a=0"),
    ("9*p*q*r", "(p + q + r)*(p*q + q*r + r*p)", "p=1 q=1 r=1"),
    ("3/2", "p/(q + r) + q/(r + p) + r/(p + q)", "p=1 q=1 r=1"),
    ("sqrt((a + c)**2 + (b + d)**2)", "sqrt(a**2 + b**2) + sqrt(c**2 + d**2)", "a=1 b=2 c=2 d=4"),
    ("1", "cosh(a)", "a=0"),
    ("abs(sin(a) - sin(b))", "abs(a - b)", "a=1 b=1"), ("abs(atan(a) - atan(b))", "abs(a - b)", "a=1 b=1"),
    ("atan(p)", "p", ""),
    ("sqrt(p + q)", "sqrt(p) + sqrt(q)", ""), ("tanh(a)", "1", ""), ("log(1 + p)", "p", ""), ("sin(p)", "p", ""),
)  # fmt: skip
WORDS = {"a": "real", "b": "real", "c": "real", "d": "real", "p": "positive", "q": "positive", "r": "positive"}
SHIFTS = ("0", "0", "sqrt(2)/3", "pi", "exp(1)", "1e-15", "1/3", "1000", "sqrt(2)")


@family("inequalities")
def make_inequality(rng: random.Random) -> Statement:
    """A theorem, perhaps with real symbols shifted so that the case of equality is irrational or far away."""
    low, high, place = rng.choice(THEOREMS)
    point = dict(word.split("=") for word in place.split())
    names = [name for name in WORDS if name in names_of(low, high)]
    shift = {name: rng.choice(SHIFTS) if WORDS[name] == "real" and rng.random() < 0.6 else "0" for name in names}
    moved = {name: ("-", ("name", name), read(by)) for name, by in shift.items() if by != "0"}
    low, high = (write(replace(read(side), moved)) for side in (low, high))
    symbols = {name: WORDS[name] for name in names}
    d, kind = draw_tiny(rng), rng.choice(("<=", "< +", "<", "<= -", ">", "!="))
    if not point:
        return Statement(f"{low} {rng.choice(('<', '<='))} {high}", True, symbols)
    if kind in ("<=", "< +"):
        return Statement(f"{low} {kind[:2].strip()} {high}{f' + {d}' if '+' in kind else ''}", True, symbols)
    witness = {name: f"{value} + ({shift[name]})" for name, value in point.items()}
    if kind == ">":
        return Statement(f"{low} > {high}", False, symbols, witness)
    return Statement(f"{low} {kind.split()[0]} {high}{f' - {d}' if '-' in kind else ''}", False, symbols, witness)


def names_of(*sides: str) -> set[str]:
    from tests.attacks.trees import names_in

    return set().union(*(names_in(read(side)) for side in sides))


@family("kinks")
def make_kinks(rng: random.Random) -> Statement:
    """A sum of absolute values in one symbol against its least value, which is taken at a kink."""
    count = rng.randint(2, 5)
    kinks = [Fraction(rng.randint(-20, 20), rng.choice((1, 2, 3, 7))) for _ in range(count)]
    weights = [rng.randint(1, 4) for _ in range(count)]
    slope = rng.randint(1 - sum(weights), sum(weights) - 1)

    def value(x: Fraction) -> Fraction:
        return sum(w * abs(x - k) for w, k in zip(weights, kinks, strict=True)) + slope * x

    at = min(kinks, key=value)
    parts = " + ".join(f"{w}*abs(x - ({k}))" for w, k in zip(weights, kinks, strict=True))
    return by_least(rng, f"{parts} + ({slope})*x", value(at), {"x": "real"}, {"x": str(at)})


def by_least(rng: random.Random, text: str, least: object, symbols: dict, at: dict) -> Statement:
    """A formula against its least value, with or without room."""
    d, kind = draw_tiny(rng), rng.choice((">=", "> -", ">", ">= +", "!=", "!= -"))
    relation, truth = kind.split()[0], kind in (">=", "> -", "!= -")
    change = f" {kind[-1]} {d}" if kind[-1] in "+-" else ""
    return Statement(f"{text} {relation} {least}{change}", truth, symbols, None if truth else at)


@family("strips")
def make_strip(rng: random.Random) -> Statement:
    """Piecewise linear statements in two and three symbols that differ on thin strips, or nowhere."""
    d = draw_tiny(rng, 2, 15)
    u, at = rng.choice(
        (
            ("x - y", "x=D/2 y=0"),
            ("x + y", "x=D/2 y=0"),
            ("2*x - y", "x=D/2 y=D/2"),
            ("x - 1/3", "x=1/3+D/2"),
            ("x - sqrt(2)*y", "x=D/2 y=0"),
        )
    )
    point = {n: v.replace("D", d) for n, v in (word.split("=") for word in at.split())}
    symbols = dict.fromkeys(point, "real")
    text, truth = rng.choice((
        (f"abs({u}) + abs({u} - {d}) = abs(2*({u}) - {d})", False),
        (f"abs({u}) + abs({u} - {d}) >= abs(2*({u}) - {d})", True),
        (f"abs({u}) + abs({u} - {d}) > {d}", False), (f"abs({u}) + abs({u} - {d}) >= {d}", True),
        (f"abs({u} - {d}/2) > 0", False), (f"abs(abs({u}) - {d}/2) > 0", False),
        (f"({u} + {d} + abs({u} - {d}))/2 >= {u}", True),
        (f"({u} + abs({u}))/2 + ({d} - ({u}) + abs({d} - ({u})))/2 >= {d}", True),
        (f"abs({u})*abs({u} - {d}) = ({u})*({u} - {d})", False),
        (f"abs(({u})*({u} - {d})) = abs({u})*abs({u} - {d})", True), (f"({u})*({u} - {d}) >= 0", False),
        (f"({u})*({u} - {d}) >= -({d})**2/4", True),
    ))  # fmt: skip
    return Statement(text, truth, symbols, None if truth else point)


@family("many symbols")
def make_many(rng: random.Random) -> Statement:
    """Ten symbols and more: sums of squares, means, corners of a cube."""
    n = rng.randint(10, 14)
    names = [f"x{k}" for k in range(1, n + 1)]
    total, squares, product = " + ".join(names), " + ".join(f"{x}**2" for x in names), "*".join(names)
    backwards = " + ".join(reversed(names))
    d, cube, line = draw_tiny(rng, 2, 12), {x: ["0", "1"] for x in names}, {x: "real" for x in names}
    ones, zeros = dict.fromkeys(names, "1"), dict.fromkeys(names, "0")
    text, truth, symbols, at = rng.choice((
        (f"({total})**2 <= {n}*({squares})", True, line, ones),
        (f"({total})**2 <= {n}*({squares}) - {d}", False, line, ones),
        (f"{total} = {backwards}", True, line, ones), (f"{total} = {backwards} + {d}*x1", False, line, ones),
        (f"{product} <= 1", True, cube, ones), (f"{product} <= 1 - {d}", False, cube, ones),
        (f"{product} < 1", False, cube, ones),
        (f"{total} <= {n}", True, cube, ones), (f"{total} <= {n} - {d}", False, cube, ones),
        (f"{squares} >= 0", True, line, zeros),
        (f"{squares} > 0", False, line, zeros), (f"{squares} + {d} > 0", True, line, zeros),
        (f"{squares} <= {total}", True, cube, ones),
        (" + ".join(f"abs({x})" for x in names) + f" >= abs({total})", True, line, ones),
        (f"{squares} < {total}", False, cube, ones),
        (" + ".join(f"sin({x})**2 + cos({x})**2" for x in names) + f" = {n}", True, line, ones),
        ("*".join(f"(1 + {x}**2)" for x in names[:6]) + f" >= 1 + {squares.split(' + ' + names[6])[0]}", True,
        {x: "real" for x in names[:6]}, ones),
        (f"sqrt({squares}) <= " + " + ".join(f"abs({x})" for x in names), True, line, ones),
        (f"exp({total}) >= 1 + {total}", True, line, zeros),
        (f"exp({total}) = " + "*".join(f"exp({x})" for x in names), True, line, ones),
        (f"({total})**2 - ({squares}) <= {n * (n - 1)}", True, cube, ones),
    ))  # fmt: skip
    return Statement(text, truth, symbols, None if truth else at)


@family("homogeneous")
def make_homogeneous(rng: random.Random) -> Statement:
    """Inequalities that are tight at a point where the added term is not zero: false by a little, near that point."""
    c = rng.choice(("1/10", "1/100", "1e-4", "1e-6", "0"))
    top = "sin(4*pi/7)**2 sin(2*pi/7)**2 sin(pi/7)**2".split()
    vasc = f"(x**2 + y**2 + z**2)**2 >= 3*(x**3*y + y**3*z + z**3*x) + (x - y)**2*(y - z)**2*{c}"
    return rng.choice((
        Statement(vasc, c == "0", {}, None if c == "0" else dict(zip("xyz", top, strict=True))),
        Statement(f"x**4 + y**4 + z**4 + 1 >= 4*x*y*z + {c}*x**2", c == "0", {},
        None if c == "0" else dict.fromkeys("xyz", "1")),
        Statement(f"x**4*y**2 + x**2*y**4 + z**6 - 3*x**2*y**2*z**2 >= {c}*z**6", c == "0", {},
        None if c == "0" else dict.fromkeys("xyz", "1")),
        Statement(f"x**2 + y**2 - 2*x*y >= {c}*y**2", c == "0", {}, None if c == "0" else {"x": "1", "y": "1"}),
        Statement(f"x**3 + y**3 + z**3 - 3*x*y*z >= {c}*x*y*z", c == "0", dict.fromkeys("xyz", "positive"),
                  None if c == "0" else dict.fromkeys("xyz", "1")),
    ))  # fmt: skip
