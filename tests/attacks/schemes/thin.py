"""False on sets that sampling hardly meets: points, peaks, beats, far places; with true neighbours of each."""

from __future__ import annotations

import random
from functools import lru_cache
from math import cos, pi, sqrt

from tests.attacks.schemes.values import draw_tiny
from tests.attacks.statements import Statement, family

NUMBERS = ("pi", "exp(1)", "sqrt(2)", "1e-15", "1/3", "sqrt(2)/3", "2**(1/3)", "log(2)", "1000/7", "-pi", "1e-9", "1e6")


@family("points")
def make_point(rng: random.Random) -> Statement:
    """Zero at one point of a line, a plane or a space."""
    a, b, d = rng.choice(NUMBERS), rng.choice(NUMBERS), draw_tiny(rng, 3, 30)
    one = rng.choice(
        (f"abs(x - {a})", f"(x - {a})**2", f"cosh(x - {a}) - 1", f"1 - 1/(1 + (x - {a})**2)", f"atan((x - {a})**2)")
    )
    two = rng.choice(
        (
            f"abs(y - {b})",
            f"(y - {b})**2",
            f"(x - {a} + y - {b})**2",
            f"sqrt(abs(y - {b}))",
            f"abs(y - {b})*(2 + sin(x))",
        )
    )
    text, witness = (one, {"x": a}) if rng.random() < 0.4 else (f"{one} + {two}", {"x": a, "y": b})
    kind = rng.choice(("> 0", "!= 0", f">= {d}", ">= 0", f"> -{d}", f"+ {d} > 0"))
    truth = kind in (">= 0", f"> -{d}", f"+ {d} > 0")
    return Statement(f"{text} {kind}", truth, {}, None if truth else witness)


@family("curves")
def make_curve(rng: random.Random) -> Statement:
    """Zero at the meeting of two curves, or on one."""
    c = rng.choice(("1/3", "1/2", "1/7", "2/5"))
    unit = {"x": ["0", "1"], "y": ["0", "1"]}
    text, witness, symbols = rng.choice((
        (f"abs(x - y) + abs(x**2 - {c})", {"x": f"sqrt({c})", "y": f"sqrt({c})"}, unit),
        (f"(y - x**2)**2 + (x - {c})**2", {"x": c, "y": f"({c})**2"}, unit),
        (f"abs(x*y - {c})", {"x": "1", "y": c}, unit),
        (f"abs(exp(x) - 1 - {c}) + abs(y - x)", {"x": f"log(1 + {c})", "y": f"log(1 + {c})"}, unit),
        ("(x**2 + y**2 - 1)**2 + (x - y)**2", {"x": "sqrt(2)/2", "y": "sqrt(2)/2"}, unit),
        (f"abs(sin(pi*x) - {c}) + abs(y - {c})", {"x": f"asin({c})/pi", "y": c}, unit),
        (f"abs(x - y - {c})", {"x": c, "y": "0"}, unit),
        (f"abs(x**3 - {c})", {"x": f"({c})**(1/3)"}, {"x": ["0", "1"]}),
        ("1 - cos(2*pi*x*y)", {"x": "1", "y": "1"}, unit),
    ))  # fmt: skip
    relation = rng.choice(("> 0", ">= 0", "!= 0", f"> -{draw_tiny(rng)}"))
    truth = relation not in ("> 0", "!= 0")
    return Statement(f"{text} {relation}", truth, symbols, None if truth else witness)


@family("peaks")
def make_peak(rng: random.Random) -> Statement:
    """A narrow peak at an irrational place."""
    k, at = rng.choice((2, 6, 12, 20)), rng.choice(("sqrt(2)/3", "pi/7", "1/3", "exp(1)/5", "log(2)"))
    peak = rng.choice(
        (
            f"exp(-1e{k}*(x - {at})**2)",
            f"1/(1 + 1e{k}*(x - {at})**2)",
            f"1/cosh(1e{k}*(x - {at}))",
            f"1 - tanh(1e{k}*(x - {at}))**2",
        )
    )
    top = rng.choice(("1/2", "99/100", "1 - 1e-9", "1", "1 + 1e-6"))
    relation = rng.choice(("<", "<="))
    truth = top == "1 + 1e-6" or (top == "1" and relation == "<=")
    symbols = rng.choice(({"x": "real"}, {"x": ["0", "1"]}))
    return Statement(f"{peak} {relation} {top}", truth, symbols, None if truth else {"x": at})


@lru_cache
def find_near_period(closeness: float) -> int:
    """k with sqrt(2) (pi/2 + 2 pi k) near pi/2 + 2 pi m."""
    return next(k for k in range(1, 10**6) if cos(sqrt(2) * (pi / 2 + 2 * pi * k) - pi / 2) > 1 - closeness)


@family("beats")
def make_beat(rng: random.Random) -> Statement:
    """Two sines that nearly meet in phase: beats on a range, quasi-periods on the line."""
    n, d = rng.choice((10, 50, 100, 300)), draw_tiny(rng, 3, 12)
    beat, near = f"sin({n}*x) + sin({n + 1}*x)", f"pi/{2 * n + 1}"
    room = rng.choice(("1/100", "1/50", "1/20"))
    k = find_near_period(5e-4)
    ranged, meets = {"x": ["0", "4"]}, 2 * (1 - cos(pi / (4 * n + 2))) < 0.005
    return rng.choice((
        Statement(f"{beat} < 2 - {room}", False if meets else None, ranged, {"x": near} if meets else None),
        Statement(f"{beat} <= 2", True, ranged), Statement(f"{beat} < 2 + {d}", True, ranged),
        Statement("sin(x) + sin(sqrt(2)*x) <= 1.999", False, {}, {"x": f"pi/2 + {2 * k}*pi"}),
        Statement("cos(x) + cos(sqrt(2)*x) > -2 - 1e-9", True),
        Statement("cos(x) + cos(sqrt(2)*x) < 2", False, {}, {"x": "0"}),
        Statement(f"cos(x) + cos(sqrt(2)*x) > -2 + {rng.choice(('1e-9', '1e-6', '1e-3'))}", False),
        Statement("cos(x) + cos(sqrt(2)*x) > -2", True), Statement(f"sin({n}*x)**2 < 1", False, {"x": ["1", "2"]},
        {"x": f"pi*{2 * (n // 3) + 1}/{2 * n}"}),
        Statement(f"cos({n}*x) >= -1 + {d}", False, {"x": ["0", "1"]}, {"x": f"pi/{n}"}),
        Statement(f"abs(sin({n}*x)) <= 1", True, {"x": ["0", "9"]}),
    ))  # fmt: skip


@family("far places")
def make_far(rng: random.Random) -> Statement:
    """False far away, or very near a place where a function grows without bound."""
    k, c, d = rng.choice((1, 2, 3, 4, 6)), rng.choice(("1/3", "1/2", "sqrt(2)/2")), rng.choice((10, 20, 30))
    return rng.choice((
        Statement(f"log(x) >= -10**{k}", False, {"x": ["0", "1"]}, {"x": f"exp(-10**{k} - 1)"}),
        Statement(f"log(x) >= -10**{k}", False, {"x": "positive"}, {"x": f"exp(-10**{k} - 1)"}),
        Statement(f"log(abs(x - {c})) >= -10**{min(k, 4)}", False, {}, {"x": f"{c} + exp(-10**{min(k, 4)} - 1)"}),
        Statement(f"(x*y - 1)**2 + x**2 >= 1/10**{d}", False, {}, {"x": f"1e-{d}", "y": f"1e{d}"}),
        Statement("(x*y - 1)**2 + x**2 > 0", True),
        Statement(f"1/x <= 1e{d}", False, {"x": "positive"}, {"x": f"1e-{d + 1}"}),
        Statement(f"x**2 - 1e{d} < 0", False, {}, {"x": f"1e{d}"}),
        Statement(f"tanh(x) <= 1 - 1e-{d}", False, {}, {"x": f"{3 * d}"}), Statement("tanh(x) < 1", True),
        Statement(f"atan(x) < pi/2 - 1e-{d}", False, {}, {"x": f"1e{d + 1}"}),
        Statement("atan(x) < pi/2", True), Statement(f"exp(-x) > 1e-{d}", False, {"x": "positive"},
        {"x": f"{3 * d}"}), Statement("exp(-x) > 0", True),
        Statement(f"x**3 - 1e{d}*x**2 <= 0", False, {}, {"x": f"2e{d}"}),
        Statement("x*exp(-x) <= 37/100", True, {"x": "positive"}),
        Statement("abs(sin(x**2)) < abs(x**2)", True, {"x": "nonzero"}),
        Statement("abs(sin(x**2)) < abs(x**2)", False, {"x": ["-3", "3"]}, {"x": "0"}),
        Statement(f"sqrt(x + 1) - sqrt(x) > 1e-{d}", False, {"x": "positive"}, {"x": f"1e{2 * d}"}),
        Statement("log(x) < sqrt(x)", True, {"x": "positive"}),
        Statement(f"x > log(x)*{5 * k}", False, {"x": "positive"}, {"x": "5"}),
        Statement(f"abs(x - {c})**(1/100) > 1/2", False, {}, {"x": c}),
    ))  # fmt: skip


@family("edge of a range")
def make_range_edge(rng: random.Random) -> Statement:
    """Compared at the edge of a range, where a term is tiny and not zero."""
    k, d = rng.choice((10, 20, 1000)), draw_tiny(rng, 3, 20)
    unit = {"x": ["0", "1"]}
    return rng.choice((
        Statement(f"{k}*x > atan(acos(tanh(10 + x)))", False, unit, {"x": "1e-9"}),
        Statement("atan(x*acos(sqrt(0.999999))) = 0", False, {}, {"x": "1"}),
        Statement("abs(x + 1e-4 - acos(sqrt(0.999999))) = x + 1e-4 - acos(sqrt(0.999999))", False,
        {"x": "nonnegative"}, {"x": "0"}),
        Statement("x + acos(tanh(19)) > 0", True, unit), Statement("x*acos(1 - 1e-20) = 0", False, unit, {"x": "1"}),
        Statement(f"x + 1 - cos({d}) > 0", True, unit), Statement(f"x + cos({d}) - 1 >= 0", False, unit, {"x": "0"}),
        Statement(f"x**2 + log(1 + {d}) > 0", True, unit), Statement(f"x - log(1 + {d}) >= 0", False, unit, {"x": "0"}),
        Statement(f"x*(1 + {d}) > x", False, unit, {"x": "0"}), Statement(f"x*(1 + {d}) >= x", True, unit),
        Statement(f"abs(x - {d}) >= x - {d}", True, unit),
        Statement(f"abs(x - acos(1 - {d})) = acos(1 - {d}) - x", False, unit, {"x": "1"}),
        Statement(f"abs(x - {d}) = x - {d}", False, unit, {"x": "0"}),
        Statement(f"x <= 1 - {d}", False, unit, {"x": "1"}), Statement(f"(1 - x)*(x - {d}) >= 0", False, unit,
        {"x": "0"}),
    ))  # fmt: skip
