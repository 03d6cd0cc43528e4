"""Random statements on each construct of the language whose truth is known by exact arithmetic or by a theorem.

Vectors and matrices: both sides are polynomials, evaluated in fractions at random points by code that shares nothing
with the package; two different polynomials agree at none of three. Calculus: the answer is built before the question.

``python -m tests.attacks.constructs COUNT SEED`` prints the outcomes by construct.
"""

from __future__ import annotations

import json
import math
import random
import re
import sys
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import product
from typing import Any

import navsym as nav
from tests.attacks.trees import derivative, read, write

SECONDS = 5.0


@dataclass(frozen=True)
class Construct:
    """A statement in the language of files, and whether it holds wherever both sides are defined."""

    text: str
    truth: bool
    given: Mapping[str, Any] = field(default_factory=dict)


Scheme = Callable[[random.Random], Construct]
SCHEMES: dict[str, Scheme] = {}


def construct(scheme: Scheme) -> Scheme:
    """Register a scheme under its name."""
    SCHEMES[scheme.__name__] = scheme
    return scheme


def make_construct(number: int, seed: int, schemes: Mapping[str, Scheme] = SCHEMES) -> tuple[str, Construct]:
    """The statement of a number; the constructs take turns."""
    names = sorted(schemes)
    name = names[number % len(names)]
    return name, keep_used(schemes[name](random.Random(f"constructs {seed} {number}")))


def keep_used(statement: Construct) -> Construct:
    """The statement with the declarations of the names that occur in it."""
    rates = statement.given.get("rates", {})
    texts = " ".join([statement.text, *statement.given.get("given", []), *rates, *rates.values()])
    words = {"given", "order", "tolerance", "rates", *re.findall(r"[A-Za-z]\w*", texts)}
    used = {key: value for key, value in statement.given.items() if key in words}
    return replace(statement, given=used)


def outcome_of(statement: Construct, seconds: float = SECONDS) -> tuple[str, str]:
    """``decided``, ``open``, ``refused``, ``confirmed``, ``false confirmed`` or ``wrong``, and what was said."""
    try:
        verdict = nav.prove(statement.text, seconds=seconds, **statement.given)
    except nav.NavsymError as error:
        return "refused", str(error)
    except Exception as error:
        return "wrong", repr(error)
    return judge_status(verdict, statement.truth)


def judge_status(verdict: nav.Verdict, truth: bool) -> tuple[str, str]:
    """The outcome of a verdict on a statement of known truth, and what was said."""
    status = str(verdict.status)
    if status in ("OPEN", "CONFIRMED"):
        return "open" if status == "OPEN" else "confirmed" if truth else "false confirmed", verdict.evidence
    holds = status in ("PROVED", "CERTIFIED")
    return ("decided" if holds == truth else "wrong"), f"{status} {dict(verdict.counterexample or {})}"


def main(count: int, seed: int, schemes: Mapping[str, Scheme] = SCHEMES) -> None:
    """Judge ``count`` statements; one line for each that is not decided, then the counts."""
    counts: dict[str, Counter[str]] = {name: Counter() for name in sorted(schemes)}
    for number in range(count):
        name, statement = make_construct(number, seed, schemes)
        found, why = outcome_of(statement)
        counts[name][found] += 1
        if found != "decided":
            row = {"text": statement.text, "given": statement.given, "truth": statement.truth, "why": why}
            print(found, name, json.dumps(row, default=str), flush=True)
        if number % 100 == 99 or number == count - 1:
            print(number + 1, json.dumps(counts), flush=True)


# -- Vectors and matrices ----------------------------------------------------------------------------------------------
VECTORS, SQUARES, NUMBERS = ("u", "v", "w"), ("A", "B"), ("a", "b")
NAMES = {
    **{n: {"vector": 3} for n in VECTORS},
    **{n: {"matrix": [3, 3]} for n in SQUARES},
    **dict.fromkeys(NUMBERS, "real"),
}
Value = Any


def cross(x: Value, y: Value) -> Value:
    return [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]]


def times(x: Value, y: Value) -> Value:
    if isinstance(y[0], list):
        return [[sum(p * q for p, q in zip(row, column, strict=True)) for column in zip(*y, strict=True)] for row in x]
    return [sum(p * q for p, q in zip(row, y, strict=True)) for row in x]


def each(action: Callable[..., Value], *values: Value) -> Value:
    if isinstance(values[0], list):
        return [each(action, *parts) for parts in zip(*values, strict=True)]
    return action(*values)


def skew(x: Value) -> Value:
    return [[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]]


def determinant(m: Value) -> Value:
    return sum(p * q for p, q in zip(m[0], cross(m[1], m[2]), strict=True))


#: Operation -> kind of its result, kinds of its parts, its text, its value.
OPERATIONS: dict[str, tuple[str, str, str, Callable[..., Value]]] = {
    "add s": ("s", "ss", "({0} + {1})", lambda x, y: x + y),
    "mul s": ("s", "ss", "({0}*{1})", lambda x, y: x * y),
    "dot": ("s", "vv", "dot({0}, {1})", lambda x, y: sum(p * q for p, q in zip(x, y, strict=True))),
    "trace": ("s", "m", "trace({0})", lambda x: x[0][0] + x[1][1] + x[2][2]),
    "det": ("s", "m", "det({0})", determinant),
    "add v": ("v", "vv", "({0} + {1})", lambda x, y: each(lambda p, q: p + q, x, y)),
    "scale v": ("v", "sv", "({0}*{1})", lambda x, y: each(lambda q: x * q, y)),
    "cross": ("v", "vv", "cross({0}, {1})", cross),
    "turn": ("v", "mv", "({0} @ {1})", times),
    "add m": ("m", "mm", "({0} + {1})", lambda x, y: each(lambda p, q: p + q, x, y)),
    "scale m": ("m", "sm", "({0}*{1})", lambda x, y: each(lambda q: x * q, y)),
    "mul m": ("m", "mm", "({0} @ {1})", times),
    "flip": ("m", "m", "({0}).T", lambda x: [list(row) for row in zip(*x, strict=True)]),
    "skew": ("m", "v", "skew({0})", skew),
    "outer": ("m", "vv", "{0} @ ({1}).T", lambda x, y: [[p * q for q in y] for p in x]),
}
LEAVES = {"s": (*NUMBERS, "2", "3", "1/2"), "v": VECTORS, "m": SQUARES}


def grow(rng: random.Random, kind: str, depth: int) -> Value:
    """A random tree: a leaf, or an operation and its parts."""
    if depth == 0 or rng.random() < 0.15:
        return rng.choice(LEAVES[kind])
    name = rng.choice([n for n, row in OPERATIONS.items() if row[0] == kind])
    return [name, *(grow(rng, part, depth - 1) for part in OPERATIONS[name][1])]


def write_tree(tree: Value) -> str:
    return tree if isinstance(tree, str) else OPERATIONS[tree[0]][2].format(*map(write_tree, tree[1:]))


def value_of(tree: Value, point: Mapping[str, Value]) -> Value:
    if isinstance(tree, str):
        return point[tree] if tree in point else Fraction(tree.strip("()"))
    return OPERATIONS[tree[0]][3](*(value_of(part, point) for part in tree[1:]))


def minus(tree: Value, kind: str) -> Value:
    return [f"{'mul s' if kind == 's' else f'scale {kind}'}", "(-1)", tree]


def rewrite(tree: Value, rng: random.Random) -> Value:
    """An equal tree, by the laws that a student knows."""
    if isinstance(tree, str):
        return tree
    name, parts = tree[0], [rewrite(part, rng) for part in tree[1:]]
    if rng.random() < 0.3:
        return [name, *parts]
    x, y = (parts * 2)[:2]
    match name:
        case "add s" | "add v" | "add m" | "mul s" | "dot":
            return [name, y, x]
        case "cross" if not isinstance(y, str) and y[0] == "cross":
            first, second = ["scale v", ["dot", x, y[2]], y[1]], ["scale v", ["dot", x, y[1]], y[2]]
            return ["add v", first, minus(second, "v")]
        case "cross":
            return minus([name, y, x], "v") if rng.random() < 0.5 else ["turn", ["skew", x], y]
        case "turn" if not isinstance(x, str) and x[0] == "mul m":
            return ["turn", x[1], ["turn", x[2], y]]
        case "trace" if not isinstance(x, str) and x[0] == "mul m":
            return ["trace", ["mul m", x[2], x[1]]]
        case "det" if not isinstance(x, str) and x[0] == "mul m":
            return ["mul s", ["det", x[1]], ["det", x[2]]]
        case "det" | "trace":
            return [name, ["flip", x]]
        case "flip" if not isinstance(x, str) and x[0] == "mul m":
            return ["mul m", ["flip", x[2]], ["flip", x[1]]]
        case "skew":
            return minus(["flip", [name, x]], "m")
        case "outer":
            return ["flip", [name, y, x]]
    return [name, *parts]


def spoil(tree: Value, rng: random.Random) -> Value:
    """One change somewhere in a tree."""
    if tree == "(-1)":
        return "2"
    if isinstance(tree, str):
        kind = next(k for k, leaves in LEAVES.items() if tree in leaves)
        return rng.choice([leaf for leaf in LEAVES[kind] if leaf != tree])
    parts = [*tree[1:]]
    if len(parts) == 2 and len(set(OPERATIONS[tree[0]][1])) == 1 and rng.random() < 0.4:
        return [tree[0], *parts[::-1]]
    place = rng.randrange(len(parts))
    parts[place] = spoil(parts[place], rng)
    return [tree[0], *parts]


def is_equal(left: Value, right: Value, rng: random.Random) -> bool:
    def number() -> Fraction:
        return Fraction(rng.randint(-(10**6), 10**6), rng.randint(1, 10**3))

    for _ in range(3):
        point = {n: number() for n in NUMBERS} | {n: [number() for _ in range(3)] for n in VECTORS}
        point |= {n: [[number() for _ in range(3)] for _ in range(3)] for n in SQUARES}
        if value_of(left, point) != value_of(right, point):
            return False
    return True


def state_trees(rng: random.Random, kind: str, depth: int) -> Construct:
    left: Value = ""
    while isinstance(left, str):
        left = grow(rng, kind, depth)
    right = rewrite(left, rng)
    right = spoil(right, rng) if rng.random() < 0.5 else right
    return Construct(f"{write_tree(left)} = {write_tree(right)}", is_equal(left, right, rng), NAMES)


@construct
def vectors(rng: random.Random) -> Construct:
    return state_trees(rng, "v", 3)


@construct
def numbers_of_vectors(rng: random.Random) -> Construct:
    return state_trees(rng, "s", 3)


@construct
def matrices(rng: random.Random) -> Construct:
    return state_trees(rng, "m", 3)


# -- Calculus: the answer is built before the question -----------------------------------------------------------------
PIECES = ("x**{n}", "{c}*x", "sin({n}*x)", "cos({n}*x)", "exp(-{n}*x)", "x*exp({n}*x)", "atan({n}*x)",
          "log(1 + {n}*x**2)", "x**{n}*sin(x)", "sqrt(x**2 + {n})", "1/(x**2 + {n})")  # fmt: skip


def draw_function(rng: random.Random, most: int = 3) -> str:
    pieces = (rng.choice(PIECES).format(n=rng.randint(1, 4), c=Fraction(rng.randint(1, 9), rng.randint(1, 5)))
              for _ in range(rng.randint(1, most)))  # fmt: skip
    return " + ".join(f"{rng.choice(('2', '(-1)', '1/3', 'a'))}*{piece}" for piece in pieces)


def perturb(text: str, rng: random.Random) -> tuple[str, bool]:
    """The text, or the text and a small number that is not 0."""
    if rng.random() < 0.5:
        return text, True
    return f"{text} + {rng.choice(('1', '-1/7', '1e-9', '(1 + a**2)/1000'))}", False


def at(text: str, value: str) -> str:
    return " ".join(text.replace("exp", "e#p").replace("x", f"({value})").replace("e#p", "exp").split())


@construct
def integrals(rng: random.Random) -> Construct:
    f = draw_function(rng)
    slope = write(derivative(read(f), "x"))
    low, high = rng.choice((("0", "1"), ("0", "T"), ("-1", "2"), ("0", "pi"), ("T", "2*T")))
    right, truth = perturb(f"({at(f, high)}) - ({at(f, low)})", rng)
    return Construct(f"integral({slope}, x, {low}, {high}) = {right}", truth, {"a": "real", "T": "positive"})


@construct
def derivatives(rng: random.Random) -> Construct:
    f, order = draw_function(rng), rng.choice((1, 1, 2, 3))
    slope = read(f)
    for _ in range(order):
        slope = derivative(slope, "x")
    right, truth = perturb(write(slope), rng)
    return Construct(f"diff({f}, x, {order}) = {right}", truth, {"a": "real", "x": "real"})


@construct
def sums(rng: random.Random) -> Construct:
    """sum F(k+1) - F(k) over k = a..n is F(n+1) - F(a)."""
    shape = rng.choice(
        ("k**{d}", "k**{d} + {c}*k", "{c}*r**k", "k*r**k", "1/(k + {d})", "k**{d}*2**k", "1/(k + {d})**2")
    )
    f = shape.format(d=rng.randint(1, 4), c=rng.choice((2, -3, Fraction(1, 2))))

    def put(value: str) -> str:
        return f"({f.replace('k', f'({value})')})"

    low = rng.choice(("0", "1", "2"))
    right, truth = perturb(f"{put('n + 1')} - {put(low)}", rng)
    given = {"n": {"integer": ["3", "oo"]}, "r": ["1/10", "9/10"], "a": "real"}
    return Construct(f"sum({put('k + 1')} - {put('k')}, k, {low}, n) = {right}", truth, given)


@construct
def products(rng: random.Random) -> Construct:
    """The product of f(k+1)/f(k) over k = 1..n is f(n+1)/f(1), f > 0."""
    f = rng.choice(("(k + {c})", "(2*k + {c})", "(k**2 + {c})", "r**k", "(k + {c})*r**k")).format(c=rng.randint(1, 4))

    def put(value: str) -> str:
        return f"({f.replace('k', f'({value})')})"

    right, truth = perturb(f"{put('n + 1')}/{put('1')}", rng)
    given = {"n": {"integer": ["1", "oo"]}, "r": "positive", "a": "real"}
    return Construct(f"product({put('k + 1')}/{put('k')}, k, 1, n) = {right}", truth, given)


#: Functions with their power series at 0, by coefficients.
SERIES: dict[str, Callable[[int], Fraction]] = {
    "exp(x)": lambda k: Fraction(1, math.factorial(k)),
    "sin(x)": lambda k: Fraction((0, 1, 0, -1)[k % 4], math.factorial(k)),
    "cos(x)": lambda k: Fraction((1, 0, -1, 0)[k % 4], math.factorial(k)),
    "log(1 + x)": lambda k: Fraction(0) if k == 0 else Fraction((-1) ** (k + 1), k),
    "1/(1 - x)": lambda k: Fraction(1),
    "atan(x)": lambda k: Fraction((0, 1, 0, -1)[k % 4], max(k, 1)),
    "sinh(x)": lambda k: Fraction(k % 2, math.factorial(k)),
}


def draw_series(rng: random.Random) -> tuple[str, list[Fraction]]:
    """a f(x) + b g(x), perhaps times x, with its first coefficients."""
    chosen = rng.sample(sorted(SERIES), 2)
    weights = [Fraction(rng.choice((1, -1, 2, 3)), rng.choice((1, 2, 5))) for _ in chosen]
    coefficients = [sum(w * SERIES[f](k) for w, f in zip(weights, chosen, strict=True)) for k in range(8)]
    return " + ".join(f"({w})*{f}" for w, f in zip(weights, chosen, strict=True)), coefficients


def polynomial(coefficients: list[Fraction]) -> str:
    return " + ".join(f"({c})*x**{k}" if k else f"({c})" for k, c in enumerate(coefficients)) or "0"


@construct
def orders(rng: random.Random) -> Construct:
    """f is its Taylor polynomial up to O(x**n), and not with another coefficient below n."""
    f, known = draw_series(rng)
    n, truth = rng.randint(1, 5), rng.random() < 0.5
    shown = known[:n]
    if not truth:
        shown[rng.randrange(n)] += Fraction(rng.choice((1, -1)), rng.choice((1, 24, 10**6)))
    return Construct(f"{f} = {polynomial(shown)}", truth, {"x": "real", "order": {"x": n}})


@construct
def limits(rng: random.Random) -> Construct:
    """(f - Taylor polynomial of degree below n)/x**n tends to the next coefficient."""
    f, known = draw_series(rng)
    n = rng.randint(1, 3)
    right, truth = perturb(f"{known[n]}", rng)
    return Construct(f"limit(({f} - ({polynomial(known[:n])}))/x**{n}, x, 0) = {right}", truth, {"a": "real"})


# -- Hypotheses, cases, moments, exponentials --------------------------------------------------------------------------
@construct
def hypotheses(rng: random.Random) -> Construct:
    """p = p + c (h - g) given h = g; a further term that is not 0 makes it false."""
    h, g = rng.choice((("x**2 + y**2", "1"), ("x*y", "a"), ("x + y", "a"), ("y**2", "x"), ("x", "a*y + 1")))
    p = rng.choice(("x**3 - y", "x*y + a", "(x + y)**2", "a*x - 2"))
    c = rng.choice(("x", "(x - y)", "(a + 2*y)", "x*y", "3"))
    right, truth = perturb(f"{p} + {c}*({h} - ({g}))", rng)
    return Construct(f"{p} = {right}", truth, {"given": [f"{h} = {g}"], "x": "real", "y": "real", "a": "real"})


@construct
def cases(rng: random.Random) -> Construct:
    """A piecewise linear function of one symbol on [-5, 5]: its least value is at an end or at a kink."""
    terms, kinks, pieces = [], {Fraction(-5), Fraction(5)}, []
    for _ in range(rng.randint(1, 3)):
        kind, c, s = rng.choice(("abs", "min", "max", "where")), Fraction(rng.randint(-8, 8), 2), rng.choice((1, -1, 2))
        text = {"abs": f"abs(x - ({c}))", "min": f"min(x, {c})", "max": f"max(x, {c})",
                "where": f"where(x < {c}, x, {c})"}[kind]  # fmt: skip
        terms.append(f"({s})*{text}")
        pieces.append((kind, c, s))
        kinks.add(c)

    def value(x: Fraction) -> Fraction:
        own = {"abs": lambda c: abs(x - c), "min": lambda c: min(x, c), "max": lambda c: max(x, c),
               "where": lambda c: x if x < c else c}  # fmt: skip
        return sum((s * own[kind](c) for kind, c, s in pieces), Fraction(0))

    least = min(map(value, kinks))
    bound, relation = least + rng.choice((0, 0, Fraction(1, 3), -Fraction(1, 7))), rng.choice((">=", ">"))
    truth = least >= bound if relation == ">=" else least > bound
    return Construct(f"{' + '.join(terms)} {relation} {bound}", truth, {"x": ["-5", "5"]})


@construct
def strips(rng: random.Random) -> Construct:
    """A case that says too much on a strip between two parallel planes, or nothing wrong where it is empty."""
    a, b, c = (rng.randint(-4, 4) or 1 for _ in range(3))
    c += 5 * (c == a == -b)  # no side is the other one and 1
    side, other, tiny = f"{a}*x + {b}*y", f"{c}*x - {a}*y + 1", f"1e-{rng.choice((3, 12, 20, 40))}"
    truth = rng.random() < 0.3
    text = rng.choice((
        f"where({side} < {other}{'' if truth else ' + ' + tiny}, {side}, {other}) = min({side}, {other})",
        f"max({side}, {other}{'' if truth else ' - ' + tiny}) = where({side} > {other}, {side}, {other})",
        f"max({side}, -({side}){'' if truth else ' + ' + tiny}) = abs({side})",
    ))  # fmt: skip
    return Construct(text, truth, {"x": "real", "y": "real"})


@construct
def whole_parts(rng: random.Random) -> Construct:
    """floor(p x + q) = k on a closed range."""
    p, q = rng.choice((1, 2, -1, Fraction(1, 2))), Fraction(rng.randint(-9, 9), rng.randint(1, 4))
    low = Fraction(rng.randint(-20, 20), rng.randint(1, 5))
    high = low + Fraction(rng.randint(1, 12), 10)
    k = math.floor(p * rng.choice((low, high)) + q)
    truth = {math.floor(p * x + q) for x in (low, high)} == {k}
    return Construct(f"floor(({p})*x + ({q})) = {k}", truth, {"x": [str(low), str(high)]})


def normal_moment(powers: list[int], m: Fraction, s: Fraction) -> Fraction:
    """E of a polynomial, by coefficients, of a normal number with mean m and variance s."""
    moments = [Fraction(1), m]
    while len(moments) < len(powers):
        moments.append(m * moments[-1] + (len(moments) - 1) * s * moments[-2])
    return sum((c * moments[k] for k, c in enumerate(powers)), Fraction(0))


@construct
def moments(rng: random.Random) -> Construct:
    powers = [rng.randint(-3, 3) for _ in range(rng.randint(2, 6))]
    m, s = Fraction(rng.randint(-3, 3), 2), Fraction(rng.randint(1, 9), 4)
    right, truth = perturb(f"{normal_moment(powers, m, s)}", rng)
    body = " + ".join(f"({c})*x**{k}" if k else f"({c})" for k, c in enumerate(powers))
    given = {"x": {"random": {"mean": str(m), "cov": str(s), "law": "normal"}}, "a": "real"}
    return Construct(f"E({body}) = {right}", truth, given)


@construct
def exponentials(rng: random.Random) -> Construct:
    """exp(t S D S^-1) = S exp(t D) S^-1 with whole S of determinant 1, 2 x 2."""
    p, q = rng.randint(-2, 2), rng.randint(-2, 2)
    S, back = [[1, p], [q, 1 + p * q]], [[1 + p * q, -p], [-q, 1]]
    d = [Fraction(rng.randint(-3, 3), rng.randint(1, 2)) for _ in range(2)]
    A = [[sum(S[i][k] * d[k] * back[k][j] for k in range(2)) for j in range(2)] for i in range(2)]
    i, j = rng.choice([*product((0, 1), repeat=2)])
    entry = " + ".join(f"({S[i][k] * back[k][j]})*exp(({d[k]})*t)" for k in range(2))
    right, truth = perturb(entry, rng)
    return Construct(f"expm(t*[[{A[0][0]}, {A[0][1]}], [{A[1][0]}, {A[1][1]}]])[{i + 1},{j + 1}] = {right}", truth,
                     {"t": "real", "a": "real"})  # fmt: skip


@construct
def quaternions(rng: random.Random) -> Construct:
    """rot(p q) = rot(p) rot(q) and its kin, for unit quaternions, with one change or none."""
    true = (
        ("rot(qmul(p, q))", "rot(p) @ rot(q)"), ("rot(conj(q))", "rot(q).T"), ("rot(q) @ rot(q).T", "eye(3)"),
        ("conj(qmul(p, q))", "qmul(conj(q), conj(p))"), ("det(rot(q))", "1"), ("rot(-1*q)", "rot(q)"),
        ("rot(q) @ cross(u, v)", "cross(rot(q) @ u, rot(q) @ v)"), ("dot(rot(q) @ u, rot(q) @ v)", "dot(u, v)"),
        ("rot(q) @ skew(u) @ rot(q).T", "skew(rot(q) @ u)"), ("norm(rot(q) @ u)", "norm(u)"),
    )  # fmt: skip
    false = (
        ("rot(qmul(p, q))", "rot(q) @ rot(p)"), ("rot(conj(q))", "rot(q)"), ("rot(q) @ rot(q)", "eye(3)"),
        ("conj(qmul(p, q))", "qmul(conj(p), conj(q))"), ("det(rot(q))", "-1"), ("rot(-1*q)", "-1*rot(q)"),
        ("rot(q) @ cross(u, v)", "cross(rot(q) @ u, v)"), ("dot(rot(q) @ u, v)", "dot(u, rot(q) @ v)"),
        ("rot(q) @ skew(u) @ rot(q)", "skew(rot(q) @ u)"), ("norm(rot(q) @ u)", "norm(u)**2"),
    )  # fmt: skip
    truth = rng.random() < 0.5
    left, right = rng.choice(true if truth else false)
    given = {"p": {"quaternion": "unit"}, "q": {"quaternion": "unit"}, "u": {"vector": 3}, "v": {"vector": 3}}
    renamed = dict(zip("pquv", rng.sample("pq", 2) + rng.sample("uv", 2), strict=True))
    text = re.sub(r"\b[pquv]\b", lambda name: renamed[name[0]], f"{left} = {right}")
    return Construct(text, truth, given)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
