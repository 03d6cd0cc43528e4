"""Random statements with hypotheses, cases, random vectors and inequalities, whose truth is exact.

A hypothesis is made to hold at a chosen point, a piecewise identity is compared at fractions, moments are sums over
independent normal numbers, a multilinear function is least at a corner of its box, a quadratic form is eliminated.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from itertools import product
from typing import Any

from tests.attacks.constructs import Construct, Scheme, normal_moment, perturb

SCHEMES: dict[str, Scheme] = {}
Polynomial = dict[tuple[int, ...], Fraction]
TINY = (Fraction(1, 10**3), Fraction(1, 10**9), Fraction(1, 10**15))


def scheme(action: Scheme) -> Scheme:
    """Register a scheme under its name."""
    SCHEMES[action.__name__] = action
    return action


def fraction(rng: random.Random, most: int = 5) -> Fraction:
    return Fraction(rng.randint(-most, most), rng.choice((1, 1, 1, 2, 3)))


# -- Polynomials as tables of exponents --------------------------------------------------------------------------------
def draw_polynomial(rng: random.Random, count: int, terms: int = 3, degree: int = 2) -> Polynomial:
    found: Polynomial = {}
    for k in range(rng.randint(1, terms)):
        exponents = [0] * count
        for _ in range(rng.randint(int(k == 0), degree)):
            exponents[rng.randrange(count)] += 1
        found[tuple(exponents)] = fraction(rng) or Fraction(1)
    return found


def write_polynomial(p: Polynomial, names: Sequence[str]) -> str:
    terms = []
    for exponents, c in p.items():
        powers = [f"{name}**{e}" if e > 1 else name for name, e in zip(names, exponents, strict=True) if e]
        terms.append("*".join([f"({c})", *powers]))
    return " + ".join(terms) or "0"


def value_at(p: Polynomial, point: Sequence[Fraction]) -> Fraction:
    total = Fraction(0)
    for exponents, c in p.items():
        for x, e in zip(point, exponents, strict=True):
            c *= x**e
        total += c
    return total


# -- Hypotheses --------------------------------------------------------------------------------------------------------
@scheme
def several_hypotheses(rng: random.Random) -> Construct:
    """p = p + c1 (h1 - k1) + c2 (h2 - k2) given h1 = k1, h2 = k2, the values of h1 and h2 at a point."""
    names = "xyzw"[: rng.randint(2, 4)]
    point = [fraction(rng, 3) for _ in names]
    given, terms = [], []
    for _ in range(rng.randint(1, 2)):
        h, c = draw_polynomial(rng, len(names)), draw_polynomial(rng, len(names), 2, 1)
        k = value_at(h, point)
        given.append(f"{write_polynomial(h, names)} = {k}")
        terms.append(f"({write_polynomial(c, names)})*({write_polynomial(h, names)} - ({k}))")
    p = write_polynomial(draw_polynomial(rng, len(names)), names)
    right, truth = perturb(f"{p} + {' + '.join(terms)}", rng)
    return Construct(f"{p} = {right}", truth, {**dict.fromkeys(names, "real"), "a": "real", "given": given})


@scheme
def substitutions(rng: random.Random) -> Construct:
    """A formula in x, and the same with what x is by hypothesis; the hypothesis has points for all y."""
    value = rng.choice(("2*y + 1", "y**2", "sin(y)", "exp(y)", "y/(1 + y**2)", "cos(2*y)", "3", "a*y - b"))
    formula = rng.choice(("x**2 + a*x", "sin(x)*b", "exp(-x)", "1/(1 + x**2)", "x*y - b", "abs(x) + a", "(x - y)**3"))
    right, truth = perturb(formula.replace("exp", "e#p").replace("x", f"({value})").replace("e#p", "exp"), rng)
    c = rng.choice(("2", "(-3)", "(1 + b**2)"))  # a factor that is not 0
    given = f"{c}*x = {c}*({value})" if rng.random() < 0.5 else f"x = {value}"
    return Construct(f"{formula} = {right}", truth, {**dict.fromkeys("xyab", "real"), "given": [given]})


@scheme
def signs_given(rng: random.Random) -> Construct:
    """Inequalities that follow from inequalities, with their best constant or one beside it."""
    p, q = Fraction(rng.randint(1, 9), rng.randint(1, 4)), Fraction(rng.randint(1, 9), rng.randint(1, 4))
    d = rng.choice((0, 0, *TINY[:2], -TINY[0], -TINY[1], Fraction(1, 2)))
    given, text, truth = rng.choice(
        (
            ([f"x >= {p}"], f"{q}*x >= {p * q + d}", d <= 0),
            ([f"x >= {p}", f"y >= {q}"], f"x*y >= {p * q + d}", d <= 0),
            ([f"x >= {p}", f"y >= {q}"], f"x + y > {p + q + d}", d < 0),
            ([f"x**2 <= {p * p}"], f"x <= {p + d}", d >= 0),
            ([f"x**2 <= {p * p}"], f"abs(x) < {p + d}", d > 0),
            ([f"x > {p}"], f"x > {p + d}", d <= 0),
            ([f"x > {p}"], f"x**2 > {p * p + d}", d <= 0),
            (["x + y = 1"], f"{p}*(x + y)**2 <= {p + d}", d >= 0),
            (["x + y = 1"], f"x*y <= {Fraction(1, 4) + d}", d >= 0),
            (["x**2 + y**2 = 1"], f"x + y <= sqrt(2) + ({d})", d >= 0),
            (["x >= y", "y >= 0"], f"x**2 - y**2 >= {d}", d <= 0),
        )
    )
    return Construct(text, truth, {"x": "real", "y": "real", "given": given})


# -- Cases -------------------------------------------------------------------------------------------------------------
Tree = Any
#: Operation -> its text, how many parts it has, its value.
CASES: dict[str, tuple[str, int, Callable[..., Fraction]]] = {
    "min": ("min({0}, {1})", 2, min),
    "max": ("max({0}, {1})", 2, max),
    "abs": ("abs({0})", 1, abs),
    "add": ("({0} + {1})", 2, lambda x, y: x + y),
    "sub": ("({0} - {1})", 2, lambda x, y: x - y),
    "half": ("({0})/2", 1, lambda x: x / 2),
    "where": ("where({0} <= {1}, {2}, {3})", 4, lambda x, y, p, q: p if x <= y else q),
    "below": ("where({0} < {1}, {2}, {3})", 4, lambda x, y, p, q: p if x < y else q),
    "signed": ("({0})*sign({1})", 2, lambda x, y: x * ((y > 0) - (y < 0))),
}


def grow(rng: random.Random, depth: int, names: str) -> Tree:
    if depth == 0 or rng.random() < 0.2:
        return rng.choice((*names, *names, "1", "0", "(-2)"))
    name = rng.choice([*CASES])
    return [name, *(grow(rng, depth - 1, names) for _ in range(CASES[name][1]))]


def write_tree(tree: Tree) -> str:
    return tree if isinstance(tree, str) else CASES[tree[0]][0].format(*map(write_tree, tree[1:]))


def value_of(tree: Tree, point: Mapping[str, Fraction]) -> Fraction:
    if isinstance(tree, str):
        return point[tree] if tree in point else Fraction(tree.strip("()"))
    return Fraction(CASES[tree[0]][2](*(value_of(part, point) for part in tree[1:])))


def rewrite(tree: Tree, rng: random.Random) -> Tree:
    """An equal tree; every law here holds for all numbers."""
    if isinstance(tree, str):
        return tree
    name, parts = tree[0], [rewrite(part, rng) for part in tree[1:]]
    x, y = (parts * 2)[:2]
    laws: list[Tree] = [[name, *parts]]
    match name:
        case "min" | "max":
            sign, other = ("sub", "max") if name == "min" else ("add", "min")
            laws += [[name, y, x], ["half", [sign, ["add", x, y], ["abs", ["sub", x, y]]]]]
            laws += [["where", x, y, x, y] if name == "min" else ["where", x, y, y, x]]
            laws += [["sub", ["add", x, y], [other, x, y]]]
        case "abs":
            laws += [["max", x, ["sub", "0", x]], ["signed", x, x], ["abs", ["sub", "0", x]]]
        case "add":
            laws += [["add", y, x], ["add", ["min", x, y], ["max", x, y]]]
        case "where":
            laws += [["below", y, x, parts[3], parts[2]]]
        case "below":
            laws += [["where", y, x, parts[3], parts[2]]]
        case "signed":
            laws += [["below", y, "0", ["sub", "0", x], ["below", "0", y, x, "0"]]]
    return rng.choice(laws)


def spoil(tree: Tree, rng: random.Random, names: str) -> Tree:
    if isinstance(tree, str):
        return rng.choice([leaf for leaf in (*names, "1", "0") if leaf != tree])
    if tree[0] in ("min", "max", "where", "below") and rng.random() < 0.4:
        other = {"min": "max", "max": "min", "where": "below", "below": "where"}[tree[0]]
        return [other, *tree[1:]]
    place = rng.randrange(1, len(tree))
    return [*tree[:place], spoil(tree[place], rng, names), *tree[place + 1 :]]


@scheme
def piecewise(rng: random.Random) -> Construct:
    """Nested min, max, abs, sign and where of one to three symbols; a false one differs at a small fraction."""
    names = "xyz"[: rng.choice((1, 2, 2, 3))]
    values = [Fraction(k, 2) for k in range(-7, 8)]
    while True:
        left = grow(rng, rng.choice((2, 2, 3)), names)
        if isinstance(left, str):
            continue
        right, truth = rewrite(left, rng), rng.random() < 0.5
        right = right if truth else spoil(right, rng, names)
        points = [{name: rng.choice(values) for name in names} for _ in range(200)]
        if truth or any(value_of(left, point) != value_of(right, point) for point in points):
            return Construct(f"{write_tree(left)} = {write_tree(right)}", truth, dict.fromkeys(names, "real"))


# -- Random numbers ----------------------------------------------------------------------------------------------------
def write_rows(rows: Sequence[Sequence[Any]]) -> str:
    return "[" + ", ".join("[" + ", ".join(f"{entry}" for entry in row) + "]" for row in rows) + "]"


@scheme
def independent_moments(rng: random.Random) -> Construct:
    """E and cov of polynomials in two independent normal numbers: moments multiply."""
    means = [Fraction(rng.randint(-2, 2), rng.randint(1, 2)) for _ in "xy"]
    variances = [Fraction(rng.randint(1, 6), rng.randint(1, 3)) for _ in "xy"]

    def moment(p: Polynomial) -> Fraction:
        total = Fraction(0)
        for exponents, c in p.items():
            for e, m, s in zip(exponents, means, variances, strict=True):
                c *= normal_moment([0] * e + [1], m, s)
            total += c
        return total

    f, g = draw_polynomial(rng, 2), draw_polynomial(rng, 2)
    both: Polynomial = {}
    for (e, c), (h, d) in product(f.items(), g.items()):
        key = (e[0] + h[0], e[1] + h[1])
        both[key] = both.get(key, Fraction(0)) + c * d
    texts = [write_polynomial(p, "xy") for p in (f, g)]
    given: dict[str, Any] = {"a": "real"}
    for name, m, s in zip("xy", means, variances, strict=True):
        given[name] = {"random": {"mean": str(m), "cov": str(s), "law": "normal"}}
    text, value = f"E(({texts[0]})*({texts[1]}))", moment(both)
    if rng.random() < 0.5:
        text, value = f"cov({texts[0]}, {texts[1]})", value - moment(f) * moment(g)
    right, truth = perturb(f"({value})", rng)
    return Construct(f"{text} = {right}", truth, given)


@scheme
def random_vectors(rng: random.Random) -> Construct:
    """cov(A x + b) = A P A' and E(x' M x) = trace(M P) + m' M m, of vectors with numbers as moments."""
    n = rng.choice((2, 2, 3))
    L = [[Fraction(rng.randint(-2, 2)) for _ in range(n)] for _ in range(n)]
    P = [[sum((p * q for p, q in zip(r, s, strict=True)), Fraction(int(r is s))) for s in L] for r in L]
    m = [[Fraction(rng.randint(-3, 3), rng.randint(1, 2))] for _ in range(n)]
    given = {"x": {"vector": n, "random": {"mean": write_rows(m), "cov": write_rows(P)}}, "a": "real"}
    places = [*product(range(n), repeat=2)]
    if rng.random() < 0.5:
        M = [[fraction(rng, 2) for _ in range(n)] for _ in range(n)]
        value = sum((M[i][j] * (P[i][j] + m[i][0] * m[j][0]) for i, j in places), Fraction(0))
        right, truth = perturb(f"({value})", rng)
        return Construct(f"E(x.T @ {write_rows(M)} @ x) = {right}", truth, given)
    A = [[fraction(rng, 3) for _ in range(n)] for _ in range(2)]
    spread = [[sum((r[k] * P[k][j] * s[j] for k, j in places), Fraction(0)) for s in A] for r in A]
    truth = rng.random() < 0.5
    if not truth:
        spread[rng.randrange(2)][rng.randrange(2)] += rng.choice((1, -1, Fraction(1, 10**6)))
    return Construct(f"cov({write_rows(A)} @ x + [1, 2]) = {write_rows(spread)}", truth, given)


# -- Inequalities ------------------------------------------------------------------------------------------------------
def write_bound(rng: random.Random, text: str, least: Fraction) -> tuple[str, bool]:
    """The text against its least value, or one a little beside it."""
    d, relation = rng.choice((0, 0, *TINY, *(-t for t in TINY), Fraction(1, 3))), rng.choice((">=", ">"))
    return f"{text} {relation} {least + d}", d <= 0 if relation == ">=" else d < 0


@scheme
def multilinear(rng: random.Random) -> Construct:
    """A function that is linear in each of up to four symbols is least at a corner of its box."""
    names = "xyzw"[: rng.randint(1, 4)]
    p = {e: fraction(rng) for e in product((0, 1), repeat=len(names)) if rng.random() < 0.7}
    lows = [Fraction(rng.randint(-6, 6), rng.choice((1, 2))) for _ in names]
    ends = [(low, low + rng.choice((1, 2, Fraction(1, 3)))) for low in lows]
    least = min(value_at(p, corner) for corner in product(*ends))
    text, truth = write_bound(rng, write_polynomial(p, names), least)
    return Construct(text, truth, {name: [str(e) for e in pair] for name, pair in zip(names, ends, strict=True)})


def is_nonnegative(form: list[list[Fraction]]) -> bool:
    """Whether a symmetric matrix is positive semidefinite, by elimination."""
    rows = [[*row] for row in form]
    for k in range(len(rows)):
        if rows[k][k] < 0 or (rows[k][k] == 0 and any(rows[k][k + 1 :])):
            return False
        if rows[k][k]:
            for i in range(k + 1, len(rows)):
                factor = rows[i][k] / rows[k][k]
                rows[i] = [x - factor * y for x, y in zip(rows[i], rows[k], strict=True)]
    return True


@scheme
def quadratic_forms(rng: random.Random) -> Construct:
    """A sum of squares of linear functions, and the same with more taken from a square than it may have."""
    n = rng.randint(1, 4)
    names = [*"xyzw"[:n]]
    rows = [[Fraction(rng.randint(-3, 3)) for _ in range(n)] for _ in range(rng.randint(1, n + 1))]
    form = [[sum((r[i] * r[j] for r in rows), Fraction(0)) for j in range(n)] for i in range(n)]
    if rng.random() < 0.6:
        k = rng.randrange(n)
        form[k][k] -= rng.choice((Fraction(1), Fraction(1, 10), Fraction(1, 10**6)))
    bound, relation = rng.choice((Fraction(0), Fraction(0), Fraction(-1), Fraction(1, 10**6))), rng.choice((">=", ">"))
    text = " + ".join(f"({form[i][j]})*{names[i]}*{names[j]}" for i in range(n) for j in range(n))
    truth = is_nonnegative(form) and (bound < 0 or (bound == 0 and relation == ">="))
    return Construct(f"{text} {relation} {bound}", truth, dict.fromkeys(names, "real"))


@scheme
def waves(rng: random.Random) -> Construct:
    """Best constants of curves and means, or constants beside them."""
    p, q = (Fraction(rng.randint(1, 12), rng.randint(1, 4)) for _ in "pq")
    d = rng.choice((0, 0, *TINY[:2], -TINY[0], -TINY[1]))
    text, truth = rng.choice(
        (
            (f"({p})*sin(x) + ({q})*cos(x) <= sqrt({p * p + q * q}) + ({d})", d >= 0),
            (f"({p})*sin(x) - ({q})*cos(y) < {p + q} + ({d})", d > 0),
            (f"({p})*x/y + ({q})*y/x >= 2*sqrt({p * q}) + ({d})", d <= 0),
            (f"x**2 + y**2 >= 2*({d + 1})*x*y", d <= 0),
            (f"({p})*x + ({q})/x >= 2*sqrt({p * q}) + ({d})", d <= 0),
            (f"x*exp(-x/({p})) <= ({p})*exp(-1) + ({d})", d >= 0),
            (f"log(x) <= x/({p}) + log({p}) - 1 + ({d})", d >= 0),
            (f"x + y >= 2*sqrt(x*y) + ({d})", d <= 0),
            (f"x/(x**2 + {p * p}) <= 1/({2 * p}) + ({d})", d >= 0),
        )
    )
    return Construct(text, truth, {"x": "positive", "y": "positive"})
