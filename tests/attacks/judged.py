"""Random statements at edges, steps and extremes, judged by exact fractions, by theorems, or by mpmath with 60 digits.

``python -m tests.attacks.judged COUNT SEED`` prints the outcomes by scheme, as :mod:`tests.attacks.constructs` does.
"""

from __future__ import annotations

import math
import random
import sys
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import pairwise

import mpmath

from tests.attacks import constructs
from tests.attacks.constructs import Construct, perturb

DIGITS = 60
SCHEMES: dict[str, constructs.Scheme] = {}
TINY = (Fraction(1, 10**3), Fraction(1, 10**9), Fraction(1, 10**15), Fraction(1, 10**30))


def judged(scheme: constructs.Scheme) -> constructs.Scheme:
    """Register a scheme under its name."""
    SCHEMES[scheme.__name__] = scheme
    return scheme


def fraction(rng: random.Random, most: int = 9, divisors: Sequence[int] = (1, 1, 2, 3, 5)) -> Fraction:
    return Fraction(rng.randint(-most, most), rng.choice(divisors))


def is_related(value: Fraction, relation: str, bound: Fraction) -> bool:
    return {"<": value < bound, "<=": value <= bound, ">": value > bound, ">=": value >= bound, "=": value == bound}[
        relation
    ]


# -- Steps and pieces: exact on every piece between two breaks ---------------------------------------------------------
def places_of(breaks: set[Fraction], low: Fraction, high: Fraction) -> Iterator[Fraction]:
    """Ends, breaks, and three places between any two neighbours: they settle a function that is linear in between."""
    known = sorted({low, high, *(b for b in breaks if low < b < high)})
    yield from known
    for a, b in pairwise(known):
        yield from ((a + b) / 2, a + (b - a) / 10**9, b - (b - a) / 10**9)


@judged
def steps(rng: random.Random) -> Construct:
    """Weighted whole parts of linear functions, and a linear term, on a range or for all x where they are periodic."""
    rows = [
        (rng.choice((1, 1, -1, 2)), Fraction(rng.choice((1, -1, 2, -2, 3)), rng.choice((1, 1, 2))), fraction(rng, 4))
        for _ in range(rng.randint(1, 3))
    ]
    everywhere = rng.random() < 0.5
    slope = -sum((c * a for c, a, _ in rows), Fraction(0)) if everywhere else fraction(rng, 2)
    low = Fraction(0) if everywhere else fraction(rng, 5)
    high = low + (2 if everywhere else Fraction(rng.randint(1, 4), 2))  # 2 is a period
    breaks = {(n - b) / a for _, a, b in rows for n in range(-60, 60)}

    def value(x: Fraction) -> Fraction:
        return sum((c * math.floor(a * x + b) for c, a, b in rows), slope * x)

    relation = rng.choice(("<=", ">=", "<", ">"))
    extreme = (max if relation[0] == "<" else min)(map(value, places_of(breaks, low, high)))
    bound = Fraction(round(extreme)) + rng.choice((0, 0, 1, -1, Fraction(1, 2)))
    truth = all(is_related(value(x), relation, bound) for x in places_of(breaks, low, high))
    text = " + ".join(f"({c})*floor(({a})*x + ({b}))" for c, a, b in rows)
    given = {"x": "real" if everywhere else [str(low), str(high)]}
    return Construct(f"{text} + ({slope})*x {relation} {bound}", truth, given)


@judged
def pairs_of_steps(rng: random.Random) -> Construct:
    """floor(u) + floor(v) <= floor(u + v) <= floor(u) + floor(v) + 1, and what is stronger or turned round."""
    u, v = rng.sample(("x", "y", "2*x", "x - y", "x + 1/2", "-x", "3*y", "x*y"), 2)
    text, truth = rng.choice(
        (
            ("floor({0}) + floor({1}) <= floor({0} + {1})", True),
            ("floor({0} + {1}) <= floor({0}) + floor({1})", False),
            ("floor({0} + {1}) <= floor({0}) + floor({1}) + 1", True),
            ("floor({0}) <= {0}", True),
            ("floor({0}) > {0} - 1", True),
            ("floor({0}) >= {0} - 1/2", False),
            ("floor({0}) + floor(-({0})) >= -1", True),
            ("floor({0}) + floor(-({0})) <= 0", True),
            ("floor({0}) + floor(-({0})) >= 0", False),
            ("floor({0} + 3) = floor({0}) + 3", True),
            ("floor(2*({0})) = floor({0}) + floor({0} + 1/2)", True),
            ("floor(2*({0})) = 2*floor({0})", False),
            ("floor(floor({0})) = floor({0})", True),
            ("floor(floor({0})/2) = floor(({0})/2)", True),
            ("floor({0}/3) = floor({0})/3", False),
        )
    )
    return Construct(text.format(u, v), truth, {"x": "real", "y": "real"})


@judged
def pieces(rng: random.Random) -> Construct:
    """A quadratic on each of three pieces, and a bound that is attained, missed, or approached at an open end."""
    low, *cuts, high = sorted(rng.sample(range(-6, 7), 4))
    rows = [(fraction(rng, 3), fraction(rng, 4), fraction(rng, 6)) for _ in range(3)]
    texts = [f"({a})*x**2 + ({b})*x + ({c})" for a, b, c in rows]
    first, second = rng.choice(("<", "<=")), rng.choice(("<", "<="))
    text = f"where(x {first} {cuts[0]}, {texts[0]}, where(x {second} {cuts[1]}, {texts[1]}, {texts[2]}))"
    ends = [
        (low, True, cuts[0], first == "<="),
        (cuts[0], first == "<", cuts[1], second == "<="),
        (cuts[1], second == "<", high, True),
    ]
    values = []  # value, attained
    for (a, b, c), (lower, closed, upper, shut) in zip(rows, ends, strict=True):
        places = [(Fraction(lower), closed), (Fraction(upper), shut)]
        vertex = -b / (2 * a) if a else Fraction(lower)
        places += [(vertex, True)] if lower < vertex < upper else []
        inside = a == 0 and b == 0
        values += [(a * x * x + b * x + c, attained or inside) for x, attained in places]
    least = min(value for value, _ in values)
    attained = any(there for value, there in values if value == least)
    relation, bound = rng.choice((">", ">=")), least + rng.choice((0, 0, 0, *TINY, *(-t for t in TINY)))
    truth = least > bound or (least == bound and (relation == ">=" or not attained))
    return Construct(f"{text} {relation} {bound}", truth, {"x": [str(low), str(high)]})


# -- Branches and edges of domains -------------------------------------------------------------------------------------
@judged
def branches(rng: random.Random) -> Construct:
    """Inverse functions of functions: true on the principal range, and false a hair beyond it."""
    shape, low, high = rng.choice(
        (
            ("asin(sin({0})) = {0}", Fraction(-1, 2), Fraction(1, 2)),
            ("acos(cos({0})) = {0}", Fraction(0), Fraction(1)),
            ("atan2(sin({0}), cos({0})) = {0}", Fraction(-1), Fraction(1)),
            ("acos(cos({0})) = abs({0})", Fraction(-1), Fraction(1)),
            ("2*atan(tan(({0})/2)) = {0}", Fraction(-1), Fraction(1)),
            ("asin(sin({0})) = pi - ({0})", Fraction(1, 2), Fraction(3, 2)),
            ("acos(cos({0})) = 2*pi - ({0})", Fraction(1), Fraction(2)),
            ("acos(sin({0})) = pi/2 - ({0})", Fraction(-1, 2), Fraction(1, 2)),
        )
    )
    beyond = rng.choice((Fraction(0), Fraction(0), *TINY[:2], Fraction(1, 7)))
    end = rng.choice(("low", "high"))
    closed_turn = shape.startswith(("2*atan", "atan2"))  # has no value, or another one, at an end
    low, high = (low - beyond, high - Fraction(1, 9)) if end == "low" else (low + Fraction(1, 9), high + beyond)
    k, shift = rng.choice((1, 2, -1, Fraction(1, 3))), rng.choice((Fraction(0), Fraction(1, 4), Fraction(2)))
    ends = sorted(((low - shift) / k, (high - shift) / k))
    u = f"(({k})*x + ({shift})*pi)"
    truth = beyond == 0
    if closed_turn and beyond == 0 and end == "low" and shape.startswith("atan2"):
        truth = False  # atan2(0, -1) = pi
    return Construct(shape.format(u), truth, {"x": [f"({e})*pi" for e in ends]})


@judged
def edges(rng: random.Random) -> Construct:
    """Laws of roots, powers and logarithms on a range that begins at the edge of their truth, or a hair before it."""
    c = rng.choice((Fraction(0), Fraction(1), Fraction(-2), Fraction(1, 3)))
    u = f"(x - ({c}))"
    before = rng.choice((Fraction(0), Fraction(0), *TINY, Fraction(1)))
    text, truth = rng.choice(
        (
            (f"sqrt({u}**2) = {u}", before == 0),
            (f"abs({u}) = {u}", before == 0),
            (f"sqrt({u})**2 = {u}", True),
            (f"log({u}**2) = 2*log({u})", True),
            (f"log({u}**2) = 2*log(abs({u}))", True),
            (f"{u}/{u} = 1", True),
            (f"sqrt({u}**3) = {u}*sqrt({u})", True),
            (f"exp(log({u})) = {u}", True),
            (f"abs({u}) = -{u}", False),
            (f"sqrt({u}**2 + 2*{u} + 1) = {u} + 1", before <= 1),
            (f"{u}**2 > 0", False),
            (f"{u} >= 0", before == 0),
            (f"sqrt({u}**4) = {u}**2", True),
            (f"({u}**6)**(1/3) = {u}**2", True),
            (f"({u}**6)**(1/2) = {u}**3", before == 0),
            (f"1/{u}**2 > 1/10**6", True),
            (f"sqrt({u}) > 0", False),
            (f"sqrt({u}) >= 0", True),
            (f"{u}*abs({u}) = {u}**2", before == 0),
            (f"max({u}, 0) = {u}", before == 0),
            (f"1/sqrt({u}) > 0", True),
        )
    )
    return Construct(text, truth, {"x": [str(c - before), str(c + 5)]})


# -- Huge and tiny constants -------------------------------------------------------------------------------------------
@judged
def extremes(rng: random.Random) -> Construct:
    """Polynomials and curves whose constants are huge or tiny; what is missing to equality is exactly known."""
    N = 10 ** rng.choice((6, 12, 20, 40))
    d = rng.choice((Fraction(0), Fraction(1, N), -Fraction(1, N), Fraction(1, N**3), -Fraction(1, N**3)))
    text, truth = rng.choice(
        (
            (f"x**2 - {2 * N}*x + {N * N} >= {d}", d <= 0),
            (f"x**2 - {2 * N}*x + {N * N} > {d}", d < 0),
            (f"sqrt(x**2 + {N * N}) - {N} <= x**2/{2 * N} + ({d})", d >= 0),
            (f"exp(x/{N}) >= 1 + x/{N} + ({d})", d <= 0),
            (f"cos(x/{N}) >= 1 - x**2/{2 * N * N} + ({d})", d <= 0),
            (f"(x + {N})**2 - x**2 - {N * N} = {2 * N}*x + ({d})", d == 0),
            (f"abs(x - {N}) + abs(x + {N}) >= {2 * N} + ({d})", d <= 0),
            (f"x/(x**2 + {N * N}) <= 1/{2 * N} + ({d})", d >= 0),
            (f"x**4/{N} + {N} >= 2*x**2 + ({d})", d <= 0),
            (f"atan(x) < pi/2 + ({d})", d >= 0),
            (f"tanh(x) < 1 + ({d})", d >= 0),
            (f"sin({N}*pi + x) = sin(x) + ({d})", d == 0),
            (f"x**2/(1 + x**2) < 1 + ({d})", d >= 0),
            (f"exp(-x**2) > ({d})", d <= 0),
            (f"sqrt(x**2 + 1/{N}) > abs(x) + ({d})", d <= 0),
            (f"max(x, 1/{N}) >= 1/{N} + ({d})", d <= 0),
        )
    )
    return Construct(text, truth, {"x": "real"})


@judged
def numerals(rng: random.Random) -> Construct:
    """A printed numeral of a constant, with half a unit of its last place as tolerance, right or one unit off."""
    p, q, r = (rng.randint(2, 40) for _ in range(3))
    text, value = rng.choice(
        (
            (f"sqrt({p}) + {q}**(1/3)", lambda: mpmath.sqrt(p) + mpmath.cbrt(q)),
            (f"exp({p}/{q})", lambda: mpmath.exp(mpmath.mpf(p) / q)),
            (f"log({p})*sin({q})", lambda: mpmath.log(p) * mpmath.sin(q)),
            (f"atan({p}/{q})/pi", lambda: mpmath.atan(mpmath.mpf(p) / q) / mpmath.pi),
            (f"erf({p}/{10 * q})", lambda: mpmath.erf(mpmath.mpf(p) / (10 * q))),
            (f"cos(pi/{p}) + tanh({r}/{q})", lambda: mpmath.cos(mpmath.pi / p) + mpmath.tanh(mpmath.mpf(r) / q)),
            (
                f"integral(exp(-x**2), x, 0, {p}/{10 * q})",
                lambda: mpmath.sqrt(mpmath.pi) / 2 * mpmath.erf(mpmath.mpf(p) / (10 * q)),
            ),
        )
    )
    with mpmath.workdps(DIGITS):
        places = rng.choice((2, 5, 12, 25))
        shown = int(mpmath.nint(value() * mpmath.mpf(10) ** places)) + rng.choice((0, 0, 1, -1))
        truth = bool(abs(value() - mpmath.mpf(shown) / mpmath.mpf(10) ** places) <= mpmath.mpf(10) ** -places / 2)
    return Construct(f"{text} = {Fraction(shown, 10**places)}", truth, {"tolerance": f"1/{2 * 10**places}"})


# -- Vectors, hypotheses, chains, units --------------------------------------------------------------------------------
@judged
def lengths(rng: random.Random) -> Construct:
    """Inequalities between lengths and products of vectors, with their best constant or one beside it."""
    c = Fraction(1) + rng.choice((0, 0, Fraction(1, 10**3), Fraction(-1, 10**3), Fraction(-1, 10**9), 1))
    best, text = rng.choice(
        (
            (1, "dot(u, v) <= {0}*norm(u)*norm(v)"),
            (1, "norm(u + v) <= {0}*(norm(u) + norm(v))"),
            (1, "norm(cross(u, v)) <= {0}*norm(u)*norm(v)"),
            (1, "abs(norm(u) - norm(v)) <= {0}*norm(u - v)"),
            (1, "2*dot(u, v) <= {0}*(dot(u, u) + dot(v, v))"),
            (1, "abs(dot(u, cross(v, w))) <= {0}*norm(u)*norm(v)*norm(w)"),
            (1, "dot(u, v)**2 <= {0}*dot(u, u)*dot(v, v)"),
            (1, "abs(u[1]) <= {0}*norm(u)"),
            (1, "norm(u - w) <= {0}*(norm(u - v) + norm(v - w))"),
            (1, "dot(u + v, u + v) <= {0}*2*(dot(u, u) + dot(v, v))"),
            (1, "norm(u) <= {0}*(abs(u[1]) + abs(u[2]) + abs(u[3]))"),
        )
    )
    return Construct(text.format(f"({c})"), c >= best, {n: {"vector": 3} for n in "uvw"})


@judged
def relations(rng: random.Random) -> Construct:
    """Consequences of hypotheses that have points: vectors that are orthogonal, of length one, or add up to zero."""
    a, b = fraction(rng), fraction(rng)
    given, left, right = rng.choice(
        (
            (["dot(u, v) = 0"], f"norm(({a})*u + ({b})*v)**2", f"({a * a})*dot(u, u) + ({b * b})*dot(v, v)"),
            (["dot(u, u) = 1", "dot(v, v) = 1"], "norm(u - v)**2", "2 - 2*dot(u, v)"),
            (["dot(u, u) = 1"], f"dot(cross(u, v), cross(u, v)) + ({a})", f"dot(v, v) - dot(u, v)**2 + ({a})"),
            (["cross(u, v) = zeros(3, 1)"], "dot(u, v)**2", "dot(u, u)*dot(v, v)"),
            (["w = cross(u, v)"], f"dot(w, ({a})*u + ({b})*v)", "0"),
            (["u + v + w = zeros(3, 1)"], "cross(u, v)[1]", "cross(v, w)[1]"),
            (["dot(u, v) = 0", "dot(u, u) = 4"], "dot(cross(u, cross(u, v)), v)", "-4*dot(v, v)"),
            (["w = u - v", "dot(u, u) = dot(v, v)"], "dot(w, u + v)", "0"),
        )
    )
    right, truth = perturb(right, rng)
    return Construct(
        f"{left} = {right.replace('a**2', '1')}", truth, {**{n: {"vector": 3} for n in "uvw"}, "given": given}
    )


@judged
def triangles(rng: random.Random) -> Construct:
    """A linear function on a triangle that hypotheses bound: its largest value is at a corner."""
    p, q, s = fraction(rng, 5), fraction(rng, 5), rng.randint(1, 5)
    most = max(Fraction(0), p * s, q * s)
    bound, relation = most + rng.choice((0, 0, *TINY[:2], -TINY[0], -TINY[1])), rng.choice(("<=", "<"))
    truth = most <= bound if relation == "<=" else most < bound
    given = {"given": ["x >= 0", "y >= 0", f"x + y <= {s}"], "x": "real", "y": "real"}
    return Construct(f"({p})*x + ({q})*y {relation} {bound}", truth, given)


@judged
def chains(rng: random.Random) -> Construct:
    """Links that hold one by one; a chain with one broken link does not."""
    links = rng.choice(
        (
            ["(x + y)**2", "= x**2 + 2*x*y + y**2", "<= 2*x**2 + 2*y**2", "<= 2*(abs(x) + abs(y))**2"],
            ["sin(x)**2", "= (1 - cos(2*x))/2", "<= 1", "<= 1 + x**2"],
            ["x*y", "<= (x**2 + y**2)/2", "<= x**2 + y**2"],
            ["abs(x + y)", "<= abs(x) + abs(y)", "= max(x, -x) + max(y, -y)"],
            ["1 + x", "<= exp(x)", "< exp(x) + 1"],
        )
    )
    broken = rng.random() < 0.5
    if broken:
        k = rng.randrange(1, len(links))
        relation, rest = links[k].split(" ", 1)
        links = [
            *links[:k],
            f"{relation} {rest} {'+ 1/1000' if relation == '=' else '- (x**2 + y**2 + 3)'}",
            *links[k + 1 :],
        ]
        links = links[: k + 1]
    return Construct(" ".join(links), not broken, {"x": "real", "y": "real"})


UNITS = {"d": ("m", (1, 0)), "t": ("s", (0, 1)), "v": ("m/s", (1, -1)), "g": ("m/s^2", (1, -2)), "k": ("1", (0, 0))}


@judged
def units(rng: random.Random) -> Construct:
    """A sum and the same sum turned round: it is proved where its terms have one unit, and refused where not."""
    terms = [{rng.choice("dtvgk"): rng.choice((1, 2)), rng.choice("dtvg"): rng.choice((1, -1))} for _ in range(2)]
    if rng.random() < 0.5:
        terms[1] = rng.choice(({"v": 1, "t": 1}, {"d": 1}, {"g": 1, "t": 2}, {"v": 2, "g": -1}))
        terms[0] = rng.choice(({"v": 1, "t": 1}, {"d": 1}, {"g": 1, "t": 2}, {"v": 2, "g": -1}))
    dimensions = [tuple(sum(UNITS[n][1][i] * p for n, p in term.items()) for i in (0, 1)) for term in terms]
    first, second = ("*".join(f"{n}**({p})" for n, p in term.items()) for term in terms)
    given = {n: {"sign": "positive", "unit": unit} for n, (unit, _) in UNITS.items()}
    return Construct(f"{first} + {second} = {second} + {first}", dimensions[0] == dimensions[1], given)


# -- Integrals, sums and limits at their edges -------------------------------------------------------------------------
@judged
def kinked_integrals(rng: random.Random) -> Construct:
    """Integrals of absolute values over their zeros, endless ones, and some that do not exist."""
    c, n, a = fraction(rng, 3), rng.randint(0, 4), Fraction(rng.randint(1, 5), rng.randint(1, 3))
    low, high = c - rng.randint(1, 3), c + rng.randint(1, 4)
    area = ((c - low) ** (n + 1) + (high - c) ** (n + 1)) / (n + 1)
    text, value, exists = rng.choice(
        (
            (
                f"integral(abs(x - ({c}))**{n or 1}, x, {low}, {high})",
                area if n else ((c - low) ** 2 + (high - c) ** 2) / 2,
                True,
            ),
            (f"integral(x**{n}*exp(-({a})*x), x, 0, oo)", math.factorial(n) / a ** (n + 1), True),
            (f"integral(1/(x - ({c}))**2, x, {low}, {high})", 1 / (low - c) - 1 / (high - c), False),
            (f"integral(1/x**{n + 2}, x, 1, oo)", Fraction(1, n + 1), True),
            (f"integral(x/(x**2 + {n + 1}), x, -oo, oo)", Fraction(0), False),
            (f"integral(sign(x - ({c})), x, {low}, {high})", (high - c) - (c - low), True),
            (f"integral(max(x, {c}), x, {low}, {high})", (c - low) * c + (high**2 - c**2) / 2, True),
            (f"integral(min(x, {c}), x, {low}, {high})", (high - c) * c + (c**2 - low**2) / 2, True),
            (f"integral(where(x < {c}, 0, x - ({c})), x, {low}, {high})", (high - c) ** 2 / 2, True),
            (f"integral(1/sqrt(x), x, 0, {a})", None, True),
        )
    )
    right, truth = perturb(f"2*sqrt({a})" if value is None else f"{value}", rng)
    return Construct(f"{text} = {right}", truth and exists, {"a": "real"})


@judged
def endless_sums(rng: random.Random) -> Construct:
    """Geometric and telescoping series, empty sums, and series that do not converge."""
    m, low = rng.randint(1, 4), rng.randint(0, 2)
    harmonic = sum((Fraction(1, j) for j in range(1, m + 1)), Fraction(0))
    inside = {"r": ["-9/10", "9/10"], "a": "real", "n": {"integer": ["0", "oo"]}}
    text, value, exists, given = rng.choice(
        (
            (f"sum(r**k, k, {low}, oo)", f"r**{low}/(1 - r)", True, inside),
            ("sum(k*r**k, k, 0, oo)", "r/(1 - r)**2", True, inside),
            (f"sum(1/(k*(k + {m})), k, 1, oo)", f"{harmonic / m}", True, inside),
            ("sum(1/k, k, 1, oo)", "100", False, inside),
            ("sum(2**k, k, 0, oo)", "-1", False, inside),
            ("sum((-1)**k, k, 0, oo)", "1/2", False, inside),
            (f"sum(k**{m}, k, 1, n) - sum(k**{m}, k, 1, n + 1)", f"-(n + 1)**{m}", True, inside),
            ("sum(k, k, 1, n)", "n*(n + 1)/2", True, inside),
            ("sum(2*k + 1, k, 0, n)", "(n + 1)**2", True, inside),
            ("sum((1/2)**k, k, 0, n)", "2 - (1/2)**n", True, inside),
            ("product(2, k, 1, n)", "2**n", True, inside),
        )
    )
    right, truth = perturb(value, rng)
    return Construct(f"{text} = {right}", truth and exists, given)


@judged
def sided_limits(rng: random.Random) -> Construct:
    """Limits from both sides: some have two different sides, some none, and some are plain."""
    c = rng.choice((0, 1, -2))
    u = f"(x - ({c}))"
    text, value, exists = rng.choice(
        (
            (f"limit(abs({u})/{u}, x, {c})", "1", False),
            (f"limit(floor(x), x, {c})", f"{c}", False),
            (f"limit(1/{u}, x, {c})", "0", False),
            (f"limit(sin({u})/{u}, x, {c})", "1", True),
            (f"limit((exp({u}) - 1 - {u})/{u}**2, x, {c})", "1/2", True),
            (f"limit(({u}**2 - {u})/{u}, x, {c})", "-1", True),
            (f"limit(sign({u}), x, {c})", "0", False),
            (f"limit(abs({u}), x, {c})", "0", True),
            ("limit(x*exp(-x), x, oo)", "0", True),
            ("limit(atan(x), x, oo)", "pi/2", True),
            (f"limit(where(x < {c}, 0, 1), x, {c})", "1", False),
            ("limit(sin(x), x, oo)", "0", False),
            ("limit((x + 1)/(x - 1), x, oo)", "1", True),
            (f"limit((sqrt(1 + {u}) - 1)/{u}, x, {c})", "1/2", True),
            (f"limit(log(1 + {u})/{u}, x, {c})", "1", True),
        )
    )
    right, truth = perturb(value, rng)
    return Construct(f"{text} = {right}", truth and exists, {"a": "real"})


if __name__ == "__main__":
    constructs.main(*map(int, sys.argv[1:]), schemes=SCHEMES)
