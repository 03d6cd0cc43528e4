"""A second evaluator of statements: Python's own parser, mpmath numbers, differences for derivatives.

It shares nothing with the package but the text of an entry, so an entry that both accept is not a slip of one reader.
"""

from __future__ import annotations

import ast
import operator
import random
import re
from functools import reduce
from itertools import pairwise
from math import comb, prod

import mpmath as mp
import numpy as np

DIGITS = 80
STEP = mp.mpf(10) ** -12
CLOSE = mp.mpf(10) ** -9
RELATION = re.compile(r" (=|<=|>=|<|>|!=) ")
SCALARS = ("sin cos tan asin acos atan sinh cosh tanh exp log sqrt sign").split()
COMPARE = {ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt, ast.GtE: operator.ge}
ARITHMETIC = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv}


def array(rows):
    """An array of mpmath numbers."""
    return np.array(rows, dtype=object)


def product(left, right):
    """A matrix product in which vectors are columns; one row times one column is a number."""
    if left.ndim == 1:
        left = left[:, None]
    value = left @ right
    return value.reshape(-1)[0] if value.size == 1 else value


def determinant(a):
    """By the first row."""
    if len(a) == 1:
        return a[0, 0]
    minors = [np.delete(a[1:], k, axis=1) for k in range(len(a))]
    return sum((-1) ** k * a[0, k] * determinant(minor) for k, minor in enumerate(minors))


def inverse(a):
    """By cofactors."""
    n = len(a)
    rest = [[np.delete(np.delete(a, j, axis=0), i, axis=1) for j in range(n)] for i in range(n)]
    return array([[(-1) ** (i + j) * determinant(rest[i][j]) for j in range(n)] for i in range(n)]) / determinant(a)


def skew(v):
    """The matrix of v x."""
    return array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def hamilton(p, q):
    """Hamilton's product, scalar first."""
    vector = p[0] * q[1:] + q[0] * p[1:] + skew(p[1:]) @ q[1:]
    return array([p[0] * q[0] - p[1:] @ q[1:], *vector])


def rotation(q):
    """The matrix of v -> q v q*."""
    conjugate = array([q[0], *-q[1:]])
    columns = [hamilton(hamilton(q, array([mp.mpf(0), *unit])), conjugate)[1:] for unit in np.eye(3, dtype=int)]
    return array(columns).T


FUNCTIONS = {
    **{name: getattr(mp, name) for name in SCALARS},
    "abs": abs,
    "atan2": mp.atan2,
    "min": min,
    "max": max,
    "dot": lambda u, v: u @ v,
    "cross": lambda u, v: skew(u) @ v,
    "norm": lambda u: mp.sqrt((u * u).sum()),
    "skew": skew,
    "det": determinant,
    "inv": inverse,
    "trace": np.trace,
    "transpose": np.transpose,
    "eye": lambda n: array([[mp.mpf(i == j) for j in range(int(n))] for i in range(int(n))]),
    "zeros": lambda *shape: array(np.zeros([int(n) for n in shape], dtype=int)),
    "diag": lambda *entries: array(np.diag(array(entries))),
    "qmul": hamilton,
    "conj": lambda q: array([q[0], *-q[1:]]),
    "rot": rotation,
}


def integrate(term, low, high):
    """By mpmath's double exponential rule, cut where an oscillation may end."""
    cuts = [low, *([mp.mpf(0)] if low < 0 < high else []), *([mp.mpf(60)] if high == mp.inf and low < 60 else []), high]
    with mp.workdps(25):
        return mp.quad(term, cuts)


def add(term, low, high):
    """Term by term; to infinity until the terms are small, with Richardson's rule."""
    if high < mp.inf:
        return sum((term(mp.mpf(k)) for k in range(int(low), int(high) + 1)), mp.mpf(0))
    with mp.workdps(25):
        return mp.nsum(term, [int(low), mp.inf])


def multiply(term, low, high):
    """Factor by factor."""
    return prod((term(mp.mpf(k)) for k in range(int(low), int(high) + 1)), start=mp.mpf(1))


def approach(term, place):
    """The value far out, or the mean of both sides very near."""
    if place == mp.inf:
        return term(mp.mpf(10) ** 25)
    return (term(place + STEP) + term(place - STEP)) / 2


BINDERS = {"integral": integrate, "sum": add, "product": multiply, "limit": approach}


class Point:
    """Values of the declared symbols, and what dot_ does to them."""

    def __init__(self, values, rates):
        self.values, self.rates = values, rates

    def move(self, name, step):
        return Point({**self.values, name: self.values[name] + step}, self.rates)

    def flow(self, step):
        rated = {name: self.values[name] + step * self.at(text) for name, text in self.rates.items()}
        return Point({**self.values, **rated}, self.rates)

    def at(self, text):
        """The value of a text at this point."""
        return self.value(ast.parse(text, mode="eval").body)

    def differences(self, node, order, shift):
        """A central difference of the given order along a shift of the point."""
        offsets = [mp.mpf(order) / 2 - k for k in range(order + 1)]
        terms = [(-1) ** k * comb(order, k) * shift(o * STEP).value(node) for k, o in enumerate(offsets)]
        return reduce(operator.add, terms) / STEP**order

    def value(self, node):
        match node:
            case ast.Constant(value=number):
                return mp.mpf(number)
            case ast.Name(id=name):
                return {"pi": mp.pi, "oo": mp.inf, **self.values}[name]
            case ast.List(elts=entries):
                return array([self.value(entry) for entry in entries])
            case ast.UnaryOp(operand=inner):
                return -self.value(inner)
            case ast.BinOp(left=left, op=ast.MatMult(), right=right):
                return product(self.value(left), self.value(right))
            case ast.BinOp(left=left, op=ast.Pow(), right=right):
                return self.value(left) ** self.value(right)
            case ast.BinOp(left=left, op=op, right=right):
                return ARITHMETIC[type(op)](self.value(left), self.value(right))
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                return COMPARE[type(op)](self.value(left), self.value(right))
            case ast.Attribute(value=inner, attr="T"):
                value = self.value(inner)
                return value[None, :] if value.ndim == 1 else value.T
            case ast.Subscript(value=inner, slice=place):
                places = place.elts if isinstance(place, ast.Tuple) else [place]
                return self.entry(inner, places)
            case ast.Call(func=ast.Name(id=name), args=arguments):
                return self.call(name, arguments)
        raise AssertionError(ast.dump(node))

    def entry(self, inner, places):
        return self.value(inner)[tuple(int(self.value(place)) - 1 for place in places)]

    def call(self, name, arguments):
        if name == "dot_":
            return self.differences(arguments[0], 1, self.flow)
        if name == "diff":
            order = int(self.value(arguments[2])) if len(arguments) == 3 else 1
            return self.differences(arguments[0], order, lambda step: self.move(arguments[1].id, step))
        if name == "where":
            return self.value(arguments[1] if self.value(arguments[0]) else arguments[2])
        if name in BINDERS:
            term, bound = arguments[:2]
            ends = [self.value(argument) for argument in arguments[2:]]
            return BINDERS[name](lambda x: Point({**self.values, bound.id: x}, self.rates).value(term), *ends)
        values = [self.value(argument) for argument in arguments]
        flat = [v.reshape(-1) if name in ("dot", "cross", "norm") else v for v in values]
        return FUNCTIONS[name](*flat)


def draw(declared, rng):
    """A random value of one declaration."""
    some = lambda low=-2.0, high=2.0: mp.mpf(rng.uniform(low, high))  # noqa: E731
    if isinstance(declared, dict) and "vector" in declared:
        return array([some() for _ in range(declared["vector"])])
    if isinstance(declared, dict) and "matrix" in declared:
        value = array([[some() for _ in range(declared["matrix"][1])] for _ in range(declared["matrix"][0])])
        return with_property(value, declared)
    if isinstance(declared, dict) and ("quaternion" in declared or "rotation" in declared):
        q = array([some() for _ in range(4)])
        unit = q / mp.sqrt((q * q).sum())
        return rotation(unit) if "rotation" in declared else q if declared["quaternion"] == "any" else unit
    if isinstance(declared, dict) and "integer" in declared:
        return mp.mpf(rng.randint(int(declared["integer"][0]), int(declared["integer"][0]) + 6))
    kind = declared.get("range", declared.get("sign")) if isinstance(declared, dict) else declared
    if kind in ("positive", "nonnegative", "nonzero"):
        return some(0.3, 2.5)
    if kind == "real":
        return some()
    low, high = (
        float(mp.mpf(mp.mpmathify(bound)) if "/" not in bound else mp.fraction(*map(int, bound.split("/"))))
        for bound in kind
    )
    return some(low, high)


def with_property(value, declared):
    """A matrix that has what is declared, from one without."""
    if declared.get("positive"):
        return value @ value.T + array(np.eye(len(value), dtype=int))
    if declared.get("symmetric"):
        return value + value.T
    if declared.get("skew"):
        return value - value.T
    if declared.get("orthogonal"):  # Cayley's form
        one, turn = array(np.eye(len(value), dtype=int)), value - value.T
        return inverse(one + turn) @ (one - turn)
    assert set(declared) <= {"matrix", "invertible"}, declared
    return value


def with_sizes(declarations, rng):
    """Declarations with numbers for the names of dimensions, and these numbers."""
    names = {
        name: mp.mpf(rng.randint(2, 3))
        for part in declarations.values()
        if isinstance(part, dict)
        for name in np.atleast_1d(part.get("matrix", part.get("vector", 3))).tolist()
        if isinstance(name, str) and not name.isdigit()
    }
    sized = {}
    for symbol, part in declarations.items():
        kind = next((kind for kind in ("matrix", "vector") if isinstance(part, dict) and kind in part), None)
        sizes = np.atleast_1d(part[kind]).tolist() if kind else []
        numbers = [int(names.get(size, size)) for size in sizes]
        sized[symbol] = {**part, kind: numbers if kind == "matrix" else numbers[0]} if kind else part
    return sized, names


def define(point, equations):
    """The point with symbols that an equation defines by others, and the equations that are left."""
    left_over = []
    for left, right in equations:
        if left in point.values and not re.search(rf"\b{left}\b", right):
            point = Point({**point.values, left: point.at(right)}, point.rates)
        else:
            left_over.append((left, right))
    return point, left_over


def spread(value):
    """The entries of a value in one row."""
    return value.reshape(-1) if isinstance(value, np.ndarray) else array([value])


def solve_hypotheses(point, equations):
    """A near point at which the equations hold: Newton's steps of least length."""
    names = [
        name for name in point.values if any(re.search(rf"\b{name}\b", f"{left} {right}") for left, right in equations)
    ]
    sizes = [len(spread(point.values[name])) for name in names]

    def place(row):
        parts = np.split(array(row), np.cumsum(sizes)[:-1])
        shaped = {
            n: p.reshape(np.shape(point.values[n])) if np.ndim(point.values[n]) else p[0]
            for n, p in zip(names, parts, strict=True)
        }
        return Point({**point.values, **shaped}, point.rates)

    def gaps(row):
        there = place(row)
        return [there.at(left) - there.at(right) for left, right in equations]

    row = np.concatenate([spread(point.values[name]) for name in names])
    for _ in range(12):
        now = gaps(row)
        if max(map(abs, now)) < mp.mpf(10) ** (20 - DIGITS):
            return place(row)
        units = np.eye(len(row), dtype=int)
        slopes = mp.matrix(
            [[(a - b) / STEP for a, b in zip(gaps(row + STEP * unit), now, strict=True)] for unit in units]
        ).T
        step = slopes.T * mp.lu_solve(slopes * slopes.T, mp.matrix(now))
        row = row - array(list(step))
    return None


def split_relations(text):
    """Sides and relations of a statement, those inside brackets left alone."""
    depths = np.cumsum([(c in "([") - (c in ")]") for c in text])
    marks = [match for match in RELATION.finditer(text) if depths[match.start()] == 0]
    ends = [0, *(place for match in marks for place in match.span()), len(text)]
    return [text[a:b].strip() for a, b in pairwise(ends)]


def holds_numerically(document, seed):
    """Whether the statement of a claim file holds at one random point where its hypotheses do; None without a point."""
    claim = document["claim"][0]
    text = claim.get("chain") or f"{claim['left']} {claim.get('relation', '=')} {claim['right']}"
    sides, relations = split_relations(text)[::2], split_relations(text)[1::2]
    given = [split_relations(text) for text in claim.get("given", ())]
    equations = [(left, right) for left, relation, right in given if relation == "="]
    rng = random.Random(seed)
    with mp.workdps(DIGITS):
        for _ in range(60):
            symbols, sizes = with_sizes(document["symbols"], rng)
            values = {**sizes, **{name: draw(declared, rng) for name, declared in symbols.items()}}
            point, left_over = define(Point(values, document.get("rates", {})), equations)
            point = solve_hypotheses(point, left_over) if left_over else point
            if point is None or not all(compare(point, *part) for part in given if part[1] != "="):
                continue
            try:
                if "order" in claim:
                    return agree_to_order(point, *sides, *claim["order"].items())
                return all(compare(point, *part) for part in zip(sides, relations, sides[1:], strict=False))
            except (TypeError, ZeroDivisionError):  # a value that is not real: another point
                continue
    return None


def compare(point, left, relation, right):
    """One relation at a point, with a tolerance that is far above the differences' error."""
    a, b = spread(point.at(left)), spread(point.at(right))
    slack = CLOSE * (1 + max(map(abs, a)) + max(map(abs, b)))
    if relation == "=":
        return a.shape == b.shape and max(map(abs, a - b)) < slack
    return bool(a[0] <= b[0] + slack if relation in ("<", "<=") else a[0] >= b[0] - slack)


def agree_to_order(point, left, right, order):
    """Whether the difference falls with the power of a small quantity that is declared."""
    name, power = order
    gaps = []
    for small in (mp.mpf(10) ** -5, mp.mpf(10) ** -8):
        near = Point({**point.values, name: small}, point.rates)
        gaps.append(abs(near.at(left) - near.at(right)) / small**power)
    return gaps[1] <= 10 * gaps[0] + CLOSE
