"""Random statements of calculus whose answer is made before the question.

Improper and iterated integrals, finite and endless sums, limits at infinity, composed power series, exponentials of
matrices.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import pairwise, permutations
from typing import Any

from tests.attacks.constructs import Construct, Scheme, at, draw_function, perturb
from tests.attacks.trees import derivative, read, write

SCHEMES: dict[str, Scheme] = {}
GIVEN: dict[str, Any] = {"a": "real", "b": "positive", "T": "positive", "x": "real", "y": "real"}
Series = list[Fraction]


def scheme(action: Scheme) -> Scheme:
    """Register a scheme under its name."""
    SCHEMES[action.__name__] = action
    return action


def weight(rng: random.Random) -> str:
    return rng.choice(("2", "(-1)", "1/3", "a", "(-5/2)"))


# -- Integrals ---------------------------------------------------------------------------------------------------------
#: Functions on [0, oo) with their limits there.
TAILS = (
    ("exp(-{n}*x)", "0"), ("x**{m}*exp(-{n}*x)", "0"), ("exp(-b*x)", "0"), ("exp(-{n}*x)*sin({m}*x)", "0"),
    ("exp(-{n}*x)*cos({m}*x)", "0"), ("exp(-x**2)", "0"), ("1/(x + {n})", "0"), ("1/(x**2 + b**2)", "0"),
    ("1/sqrt(x + {n})", "0"), ("x/(x + {n})", "1"), ("atan({n}*x)", "pi/2"), ("atan(x/b)", "pi/2"),
    ("tanh({n}*x)", "1"), ("log((x + {n})/(x + {m}))", "0"), ("x*exp(-b*x)", "0"),
)  # fmt: skip
#: Functions on [0, 1] whose slope has no bound at an end, with their values at 0 and 1.
STEEP = (
    ("sqrt(x)", "0", "1"), ("x*sqrt(x)", "0", "1"), ("sqrt(1 - x)", "1", "0"), ("x*log(x)", "0", "0"),
    ("asin(x)", "0", "pi/2"), ("x**2*log(x)", "0", "0"), ("sqrt(x)*(1 - x)", "0", "0"),
)  # fmt: skip


@scheme
def improper_integrals(rng: random.Random) -> Construct:
    """The integral of F' to infinity is lim F - F(low), of functions with known limits."""
    low = rng.choice(("0", "1", "T"))
    parts, ends, starts = [], [], []
    for _ in range(rng.randint(1, 2)):
        text, limit = rng.choice(TAILS)
        text, c = text.format(n=rng.randint(1, 4), m=rng.randint(1, 3)), weight(rng)
        parts.append(f"{c}*({text})")
        ends.append(f"{c}*({limit})")
        starts.append(f"{c}*({at(text, low)})")
    slope = write(derivative(read(" + ".join(parts)), "x"))
    right, truth = perturb(f"{' + '.join(ends)} - ({' + '.join(starts)})", rng)
    return Construct(f"integral({slope}, x, {low}, oo) = {right}", truth, GIVEN)


@scheme
def steep_integrals(rng: random.Random) -> Construct:
    """Integrals from 0 to 1 of what has no bound at an end."""
    text, low, high = rng.choice(STEEP)
    c, smooth = weight(rng), rng.choice(("x**2", "exp(2*x)", "sin(3*x)", "0*x"))
    slope = write(derivative(read(f"{c}*{text} + {smooth}"), "x"))
    value = f"{c}*(({high}) - ({low})) + ({at(smooth, '1')}) - ({at(smooth, '0')})"
    right, truth = perturb(value, rng)
    return Construct(f"integral({slope}, x, 0, 1) = {right}", truth, GIVEN)


@scheme
def iterated_integrals(rng: random.Random) -> Construct:
    """Monomials over rectangles and triangles, and with ends turned round."""
    terms, total = [], Fraction(0)
    low, high = sorted(rng.sample(range(-3, 4), 2))
    shape = rng.choice(("triangle", "rectangle"))
    for _ in range(rng.randint(1, 3)):
        i, j, c = rng.randint(0, 3), rng.randint(0, 3), Fraction(rng.randint(-4, 4), rng.randint(1, 3))
        terms.append(f"({c})*x**{i}*y**{j}")
        if shape == "rectangle":
            inner = Fraction(high ** (i + 1) - low ** (i + 1), i + 1)
            total += c * inner * Fraction(2 ** (j + 1), j + 1)
        else:  # the inner integral from 0 to y
            total += c * Fraction(2 ** (i + j + 2), (i + 1) * (i + j + 2))
    ends = f"{low}, {high}" if shape == "rectangle" else "0, y"
    turned = rng.random() < 0.3
    outer = "2, 0" if turned else "0, 2"
    right, truth = perturb(f"({-total if turned else total})", rng)
    return Construct(f"integral(integral({' + '.join(terms)}, x, {ends}), y, {outer}) = {right}", truth, {"a": "real"})


@scheme
def partial_derivatives(rng: random.Random) -> Construct:
    """Mixed derivatives of a function of two symbols, in either order, and of a quotient of two."""
    f, g = draw_function(rng, 2), draw_function(rng, 1).replace("x", "y").replace("eyp", "exp")
    tree = read(
        rng.choice((f"({f})*({g})", f"({f})/(2 + y**2)", f"sin(x*y) + ({f})", f"exp(x - y**2)*({g})", "(x*y + 3)**4"))
    )
    names = rng.sample("xy", 2)
    slope = derivative(derivative(tree, names[0]), names[1])
    right, truth = perturb(write(slope), rng)
    return Construct(f"diff(diff({write(tree)}, {names[1]}), {names[0]}) = {right}", truth, GIVEN)


# -- Sums and products -------------------------------------------------------------------------------------------------
def evaluate(coefficients: Sequence[Fraction], x: Fraction) -> Fraction:
    return sum((c * x**k for k, c in enumerate(coefficients)), Fraction(0))


def write_polynomial(coefficients: Sequence[Fraction], name: str) -> str:
    return " + ".join(f"({c})*({name})**{k}" if k else f"({c})" for k, c in enumerate(coefficients))


def draw_polynomial(rng: random.Random, degree: int) -> Series:
    return [Fraction(rng.randint(-4, 4), rng.choice((1, 1, 2, 3))) for _ in range(degree + 1)]


def interpolate(values: Sequence[Fraction], first: int) -> str:
    """Newton's form of the polynomial with these values at first, first + 1, ..., in the name n."""
    text, factor, differences = [], "1", list(values)
    for k in range(len(values)):
        text.append(f"({differences[0] / math.factorial(k)})*{factor}")
        factor = f"{factor}*(n - ({first + k}))"
        differences = [q - p for p, q in pairwise(differences)]
    return " + ".join(text)


@scheme
def power_sums(rng: random.Random) -> Construct:
    """The sum of a polynomial is the polynomial of one degree more that has its first values."""
    degree, low = rng.randint(0, 5), rng.randint(-2, 3)
    p = draw_polynomial(rng, degree)
    values = [sum((evaluate(p, Fraction(k)) for k in range(low, low + j)), Fraction(0)) for j in range(degree + 2)]
    right, truth = perturb(interpolate(values, low - 1), rng)
    given = {"n": {"integer": [str(low), "oo"]}, "a": "real"}
    return Construct(f"sum({write_polynomial(p, 'k')}, k, {low}, n) = {right}", truth, given)


@scheme
def geometric_sums(rng: random.Random) -> Construct:
    """sum p(k) q**k = G(n + 1) q**(n + 1) - G(low) q**low with q G(k + 1) - G(k) = p(k), also to infinity."""
    degree, low = rng.randint(0, 3), rng.randint(0, 2)
    q = rng.choice((Fraction(1, 2), Fraction(-1, 3), Fraction(2, 3), Fraction(2), Fraction(-2), Fraction(3)))
    p = draw_polynomial(rng, degree)
    G = [Fraction(0)] * (degree + 1)
    for k in range(degree, -1, -1):  # (q - 1) G_k + q sum_{j > k} binomial(j, k) G_j = p_k
        G[k] = (p[k] - q * sum((math.comb(j, k) * G[j] for j in range(k + 1, degree + 1)), Fraction(0))) / (q - 1)
    term, start = f"({write_polynomial(p, 'k')})*({q})**k", -evaluate(G, Fraction(low)) * q**low
    if abs(q) < 1 and rng.random() < 0.5:
        right, truth = perturb(f"({start})", rng)
        return Construct(f"sum({term}, k, {low}, oo) = {right}", truth, {"a": "real"})
    right, truth = perturb(f"({write_polynomial(G, 'n + 1')})*({q})**(n + 1) + ({start})", rng)
    given = {"n": {"integer": [str(low), "oo"]}, "a": "real"}
    return Construct(f"sum({term}, k, {low}, n) = {right}", truth, given)


@scheme
def vanishing_sums(rng: random.Random) -> Construct:
    """sum F(k) - F(k + 1) to infinity is F(low) where F vanishes there; products of F(k + 1)/F(k) likewise."""
    shape = rng.choice(("1/(k + {d})", "1/(k + {d})**2", "1/(k**2 + {d})", "k/2**k", "1/(2*k + {d})", "(1/3)**k*k**2"))
    f, low = shape.format(d=rng.randint(1, 5)), rng.randint(0, 3)

    def put(value: str) -> str:
        return f"({f.replace('k', f'({value})')})"

    c = rng.choice(("1", "2", "(-1)", "a"))
    right, truth = perturb(f"{c}*{put(str(low))}", rng)
    return Construct(f"sum({c}*({put('k')} - {put('k + 1')}), k, {low}, oo) = {right}", truth, {"a": "real"})


@scheme
def written_sums(rng: random.Random) -> Construct:
    """Sums and products with numbers as ends, also nested and empty, against the terms one by one."""
    low, count = rng.randint(-3, 3), rng.choice((0, 0, 1, 2, 5, 9))
    p, q = draw_polynomial(rng, 2), draw_polynomial(rng, 1)
    places = range(low, low + count)
    kind = rng.choice(("sum", "product", "nested"))
    if kind == "nested":
        term = f"sum({write_polynomial(p, 'k')} + ({q[1]})*k*j, j, {low}, k)"
        value = sum((evaluate(p, Fraction(k)) + q[1] * k * j for k in places for j in range(low, k + 1)), Fraction(0))
        text = f"sum({term}, k, {low}, {low + count - 1})"
    else:
        values = [evaluate(p, Fraction(k)) for k in places]
        value = sum(values, Fraction(0)) if kind == "sum" else math.prod(values, start=Fraction(1))
        text = f"{kind}({write_polynomial(p, 'k')}, k, {low}, {low + count - 1})"
    right, truth = perturb(f"({value})", rng)
    return Construct(f"{text} + a = {right} + a", truth, {"a": "real"})


# -- Limits and orders -------------------------------------------------------------------------------------------------
@scheme
def far_limits(rng: random.Random) -> Construct:
    """Quotients of polynomials at infinity, by their leading terms; what grows slower; difference quotients."""
    kind = rng.choice(("quotient", "decay", "slope", "hole"))
    if kind == "quotient":
        degree = rng.randint(0, 4)
        top, bottom = draw_polynomial(rng, rng.randint(0, degree)), draw_polynomial(rng, degree)
        bottom[-1] = bottom[-1] or Fraction(1)
        side = rng.choice(("oo", "-oo"))
        top += [Fraction(0)] * (degree + 1 - len(top))
        text, value = (
            f"({write_polynomial(top, 'x')})/({write_polynomial(bottom, 'x')}), x, {side}",
            str(top[-1] / bottom[-1]),
        )
    elif kind == "decay":
        body = rng.choice(("x**{m}*exp(-{n}*x)", "atan(x)**0*exp(-x/{n})", "log(x)/x**{n}", "{m}/sqrt(x + {n})",
                           "exp(-{n}*x)*sin({m}*x)", "log(x + {n}) - log(x + {m})"))  # fmt: skip
        text, value = f"{body.format(n=rng.randint(1, 3), m=rng.randint(1, 3))} + 7/3, x, oo", "7/3"
    elif kind == "slope":
        f = draw_function(rng, 2)
        text, value = f"(({at(f, 'y + h')}) - ({at(f, 'y')}))/h, h, 0", at(write(derivative(read(f), "x")), "y")
    else:  # a root of both polynomials
        p, c = draw_polynomial(rng, rng.randint(0, 3)), rng.randint(-3, 3)
        text, value = (
            f"(x - ({c}))*({write_polynomial(p, 'x')})/((x - ({c}))*(x**2 + 1)), x, {c}",
            str(evaluate(p, Fraction(c)) / (c * c + 1)),
        )
    right, truth = perturb(value, rng)
    return Construct(f"limit({text}) = {right}", truth, GIVEN)


LENGTH = 8


def product_of(p: Series, q: Series) -> Series:
    return [sum((p[i] * q[k - i] for i in range(k + 1)), Fraction(0)) for k in range(LENGTH)]


def compose(f: Callable[[int], Fraction], g: Series) -> Series:
    """sum f_k g**k; g has no constant."""
    power, found = [Fraction(int(k == 0)) for k in range(LENGTH)], [Fraction(0)] * LENGTH
    for k in range(LENGTH):
        found = [p + f(k) * q for p, q in zip(found, power, strict=True)]
        power = product_of(power, g)
    return found


def binomial(p: Fraction, k: int) -> Fraction:
    return math.prod(((p - j) / (j + 1) for j in range(k)), start=Fraction(1))


OUTER: dict[str, Callable[[int], Fraction]] = {
    "exp({0})": lambda k: Fraction(1, math.factorial(k)),
    "sin({0})": lambda k: Fraction((0, 1, 0, -1)[k % 4], math.factorial(k)),
    "cos({0})": lambda k: Fraction((1, 0, -1, 0)[k % 4], math.factorial(k)),
    "log(1 + {0})": lambda k: Fraction((-1) ** (k + 1), k) if k else Fraction(0),
    "sqrt(1 + {0})": lambda k: binomial(Fraction(1, 2), k),
    "1/(1 + {0})": lambda k: Fraction((-1) ** k),
    "1/sqrt(1 - {0})": lambda k: (-1) ** k * binomial(Fraction(-1, 2), k),
    "(1 + {0})**(3/2)": lambda k: binomial(Fraction(3, 2), k),
    "atan({0})": lambda k: Fraction((0, 1, 0, -1)[k % 4], max(k, 1)),
    "sinh({0})": lambda k: Fraction(k % 2, math.factorial(k)),
}


def draw_series(rng: random.Random, depth: int) -> tuple[str, Series]:
    """A function that is 0 at 0, and its power series."""
    if depth == 0:
        p = [Fraction(0), Fraction(rng.choice((1, 1, 2, -1))), Fraction(rng.randint(-1, 1), 2)]
        return f"({write_polynomial(p, 'x')})", p + [Fraction(0)] * (LENGTH - 3)
    text, inner = draw_series(rng, depth - 1)
    name = rng.choice([*OUTER])
    series = compose(OUTER[name], inner)
    shown = f"({name.format(text)} - ({series[0]}))"
    return shown, [Fraction(0), *series[1:]]


@scheme
def composed_orders(rng: random.Random) -> Construct:
    """Functions of functions, sums and products of them, against their series, or one coefficient off."""
    (first, p), (second, q) = draw_series(rng, rng.randint(1, 2)), draw_series(rng, 1)
    text, series = rng.choice(
        (
            (f"{first} + {second}", [x + y for x, y in zip(p, q, strict=True)]),
            (f"{first}*{second}", product_of(p, q)),
            (first, p),
        )
    )
    n, shown = rng.randint(1, 6), [*series]
    place = rng.choice([None, *range(LENGTH)])
    if place is not None:
        shown[place] += Fraction(rng.choice((1, -1)), rng.choice((1, 24, 10**6)))
    last = rng.randint(n, LENGTH)
    truth = place is None or place >= n
    right = write_polynomial(shown[:last], "x")
    return Construct(f"{text} = {right}", truth, {"x": ["-1/20", "1/20"], "order": {"x": n}})


# -- Exponentials of matrices ------------------------------------------------------------------------------------------
def write_rows(rows: Sequence[Sequence[Any]]) -> str:
    return "[" + ", ".join("[" + ", ".join(f"{entry}" for entry in row) + "]" for row in rows) + "]"


def multiply(x: list[list[Fraction]], y: list[list[Fraction]]) -> list[list[Fraction]]:
    return [
        [sum((p * q for p, q in zip(row, column, strict=True)), Fraction(0)) for column in zip(*y, strict=True)]
        for row in x
    ]


@scheme
def flows(rng: random.Random) -> Construct:
    """exp(t N) of nilpotent N, exp(s N) exp(t N), and exp(t A) exp(t B) = exp(t (A + B)), true where A B = B A."""
    n = rng.choice((2, 3))
    order = rng.choice([*permutations(range(n))])
    N = [[Fraction(rng.randint(-2, 2)) if order[i] < order[j] else Fraction(0) for j in range(n)] for i in range(n)]
    square = multiply(N, N)
    text = f"expm(t*{write_rows(N)})"
    kind = rng.choice(("entries", "semigroup", "commute", "determinant"))
    if kind == "entries":
        i, j = rng.randrange(n), rng.randrange(n)
        right, truth = perturb(f"({int(i == j)}) + ({N[i][j]})*t + ({square[i][j]})*t**2/2", rng)
        return Construct(f"{text}[{i + 1},{j + 1}] = {right}", truth, {"t": "real", "a": "real"})
    if kind == "semigroup":
        right, moves = rng.choice((("s + t", False), ("s - t", True), ("s*t", True)))
        truth = not moves or not any(any(row) for row in N)
        texts = (f"expm({time}*{write_rows(N)})" for time in ("s", "t", f"({right})"))
        return Construct("{} @ {} = {}".format(*texts), truth, {"s": "real", "t": "real"})
    D = [[Fraction(rng.randint(-1, 1)) if i == j else Fraction(0) for j in range(n)] for i in range(n)]
    if kind == "determinant":
        total = sum((D[i][i] for i in range(n)), Fraction(0))
        triangle = [[p + q for p, q in zip(r, s, strict=True)] for r, s in zip(N, D, strict=True)]
        right, truth = perturb(f"exp(({total})*t)", rng)
        return Construct(f"det(expm(t*{write_rows(triangle)})) = {right}", truth, {"t": "real", "a": "real"})
    both = [[p + q for p, q in zip(r, s, strict=True)] for r, s in zip(N, D, strict=True)]
    truth = multiply(N, D) == multiply(D, N)
    return Construct(f"{text} @ expm(t*{write_rows(D)}) = expm(t*{write_rows(both)})", truth, {"t": "real"})
