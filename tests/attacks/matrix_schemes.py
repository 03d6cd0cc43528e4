"""Random statements on matrices of many shapes and of any size, quaternions, rotations and rates of change.

Both sides are trees; their truth is what exact fractions at random points say, by code that shares nothing with the
package: rotations and unit quaternions have rational points, rates are the second part of dual numbers.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from tests.attacks.constructs import Construct, Scheme

SCHEMES: dict[str, Scheme] = {}
#: A leaf is a text, everything else an operation and its parts; a kind is "s" or the numbers of rows and columns.
Tree = Any
Kind = Any
Value = Any


def scheme(action: Scheme) -> Scheme:
    """Register a scheme under its name."""
    SCHEMES[action.__name__] = action
    return action


@dataclass(frozen=True)
class Dual:
    """A number and its rate."""

    value: Fraction
    rate: Fraction

    def __add__(self, other: Dual) -> Dual:
        return Dual(self.value + other.value, self.rate + other.rate)

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.rate)

    def __sub__(self, other: Dual) -> Dual:
        return self + -other

    def __mul__(self, other: Dual) -> Dual:
        return Dual(self.value * other.value, self.value * other.rate + self.rate * other.value)

    def __truediv__(self, other: Dual) -> Dual:
        value = self.value / other.value
        return Dual(value, (self.rate - value * other.rate) / other.value)

    def __bool__(self) -> bool:
        return bool(self.value)


# -- Values: numbers, and lists of rows --------------------------------------------------------------------------------
def each(action: Callable[..., Value], *values: Value) -> Value:
    if isinstance(values[0], list):
        return [each(action, *parts) for parts in zip(*values, strict=True)]
    return action(*values)


def total(values: Sequence[Value]) -> Value:
    first, *rest = values
    for value in rest:
        first = first + value
    return first


def times(x: Value, y: Value) -> Value:
    columns = [*zip(*y, strict=True)]
    return [[total([p * q for p, q in zip(row, column, strict=True)]) for column in columns] for row in x]


def flip(x: Value) -> Value:
    return [list(row) for row in zip(*x, strict=True)]


def dot(x: Value, y: Value) -> Value:
    return times(flip(x), y)[0][0]


def cross(x: Value, y: Value) -> Value:
    (a,), (b,), (c,) = x
    (d,), (e,), (f,) = y
    return [[b * f - c * e], [c * d - a * f], [a * e - b * d]]


def skew(x: Value) -> Value:
    (a,), (b,), (c,) = x
    zero = a - a
    return [[zero, -c, b], [c, zero, -a], [-b, a, zero]]


def determinant(m: Value) -> Value:
    if len(m) == 1:
        return m[0][0]
    minors = [[row[:k] + row[k + 1 :] for row in m[1:]] for k in range(len(m))]
    terms = [m[0][k] * determinant(minor) for k, minor in enumerate(minors)]
    return total([-term if k % 2 else term for k, term in enumerate(terms)])


def inverse(m: Value) -> Value:
    """By elimination; ZeroDivisionError where there is none."""
    n = len(m)
    some = next((x for row in m for x in row if x), None)
    if some is None:
        raise ZeroDivisionError
    one, zero = some / some, some - some
    rows = [[*row, *(one if i == j else zero for j in range(n))] for i, row in enumerate(m)]
    for k in range(n):
        place = next((i for i in range(k, n) if rows[i][k]), None)
        if place is None:
            raise ZeroDivisionError
        rows[k], rows[place] = rows[place], rows[k]
        pivot = rows[k][k]
        rows[k] = [x / pivot for x in rows[k]]
        for i in range(n):
            if i != k:
                factor = rows[i][k]
                rows[i] = [x - factor * y for x, y in zip(rows[i], rows[k], strict=True)]
    return [row[n:] for row in rows]


def qmul(p: Value, q: Value) -> Value:
    (a,), (b,), (c,), (d,) = p
    (e,), (f,), (g,), (h,) = q
    return [
        [a * e - b * f - c * g - d * h],
        [a * f + b * e + c * h - d * g],
        [a * g - b * h + c * e + d * f],
        [a * h + b * g - c * f + d * e],
    ]


def conj(q: Value) -> Value:
    return [q[0], *([-x] for (x,) in q[1:])]


def rot(q: Value) -> Value:
    """Columns are q e q*, for each unit vector e."""
    turned = [qmul(qmul(q, [[Fraction(0)], *([x] for x in row)]), conj(q)) for row in unit(3)]
    return flip([[x for (x,) in column[1:]] for column in turned])


#: Operation -> its text, its value. The first part of scalings and of entries is a number or an index.
OPERATIONS: dict[str, tuple[str, Callable[..., Value]]] = {
    "add": ("({0} + {1})", lambda x, y: each(lambda p, q: p + q, x, y)),
    "sub": ("({0} - {1})", lambda x, y: each(lambda p, q: p - q, x, y)),
    "neg": ("(-{0})", lambda x: each(lambda p: -p, x)),
    "mul": ("({0} @ {1})", times),
    "num": ("({0}*{1})", lambda x, y: x * y),
    "scale": ("({0}*{1})", lambda x, y: each(lambda q: x * q, y)),
    "flip": ("{0}.T", flip),
    "inv": ("inv({0})", inverse),
    "trace": ("trace({0})", lambda x: total([x[i][i] for i in range(len(x))])),
    "det": ("det({0})", determinant),
    "dot": ("dot({0}, {1})", dot),
    "cross": ("cross({0}, {1})", cross),
    "skew": ("skew({0})", skew),
    "qmul": ("qmul({0}, {1})", qmul),
    "conj": ("conj({0})", conj),
    "rot": ("rot({0})", rot),
}


def write_tree(tree: Tree) -> str:
    if isinstance(tree, str):
        return tree
    if tree[0] == "entry":
        return f"{write_tree(tree[1])}[{', '.join(str(k + 1) for k in tree[2])}]"
    return OPERATIONS[tree[0]][0].format(*map(write_tree, tree[1:]))


def value_of(tree: Tree, point: Mapping[str, Value]) -> Value:
    if isinstance(tree, str):
        return point[tree] if tree in point else lift(Fraction(tree.strip("()")), point)
    if tree[0] == "entry":
        value = value_of(tree[1], point)
        return value[tree[2][0]][tree[2][1] if len(tree[2]) == 2 else 0]
    return OPERATIONS[tree[0]][1](*(value_of(part, point) for part in tree[1:]))


def lift(number: Fraction, point: Mapping[str, Value]) -> Value:
    return Dual(number, Fraction(0)) if "dual" in point else number


# -- Declared leaves and their random values ---------------------------------------------------------------------------
@dataclass(frozen=True)
class Leaf:
    """A declared name: its kind, whose sizes may be names, its declaration, and how a value is drawn for a size."""

    kind: Kind
    declared: Any
    draw: Callable[[random.Random, Any], Value]


def number(rng: random.Random) -> Fraction:
    return Fraction(rng.randint(-99, 99), rng.randint(1, 9))


def draw_any(rng: random.Random, kind: Kind) -> Value:
    return number(rng) if kind == "s" else [[number(rng) for _ in range(kind[1])] for _ in range(kind[0])]


def unit(n: int) -> Value:
    return [[Fraction(int(i == j)) for j in range(n)] for i in range(n)]


def draw_symmetric(rng: random.Random, kind: Kind) -> Value:
    value = draw_any(rng, kind)
    return each(lambda p, q: p + q, value, flip(value))


def draw_skew(rng: random.Random, kind: Kind) -> Value:
    value = draw_any(rng, kind)
    return each(lambda p, q: p - q, value, flip(value))


def draw_positive(rng: random.Random, kind: Kind) -> Value:
    value = draw_any(rng, kind)
    return each(lambda p, q: p + q, times(value, flip(value)), unit(kind[0]))


def draw_diagonal(rng: random.Random, kind: Kind) -> Value:
    return [[number(rng) if i == j else Fraction(0) for j in range(kind[1])] for i in range(kind[0])]


def draw_orthogonal(rng: random.Random, kind: Kind) -> Value:
    """Cayley's form of a skew matrix, a row turned round in half of them."""
    s, e = draw_skew(rng, kind), unit(kind[0])
    value = times(each(lambda p, q: p - q, e, s), inverse(each(lambda p, q: p + q, e, s)))
    return [each(lambda p: -p, value[0]), *value[1:]] if rng.random() < 0.5 else value


def draw_unit_quaternion(rng: random.Random, kind: Kind) -> Value:
    """The square of a quaternion, divided by its length squared."""
    value = draw_any(rng, (4, 1))
    size = dot(value, value)
    return each(lambda p: p / size, qmul(value, value))


def draw_rotation(rng: random.Random, kind: Kind) -> Value:
    return rot(draw_unit_quaternion(rng, kind))


def leaf(kind: Kind, word: str = "", draw: Callable[..., Value] = draw_any) -> Leaf:
    """A number, a column or a matrix, with one word of its declaration."""
    if kind == "s":
        return Leaf(kind, "real", draw)
    rows, columns = kind
    declared: dict[str, Any] = {"vector": rows} if columns == 1 else {"matrix": [rows, columns]}
    return Leaf(kind, declared | ({word: True} if word else {}), draw)


def draw_point(rng: random.Random, leaves: Mapping[str, Leaf], sizes: Mapping[str, int]) -> dict[str, Value]:
    """Values of all leaves, and of unit matrices of named sizes."""
    point: dict[str, Value] = {f"eye({n})": unit(size) for n, size in sizes.items()}
    for n in range(1, 5):
        point[f"eye({n})"] = unit(n)
    for name, one in leaves.items():
        kind = one.kind if one.kind == "s" else tuple(sizes.get(size, size) for size in one.kind)
        point[name] = one.draw(rng, kind)
    return point


# -- Random trees and their changes ------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Garden:
    """What trees may have: leaves, sizes of rows and columns, operations."""

    leaves: Mapping[str, Leaf]
    sizes: Sequence[Any]
    operations: frozenset[str]
    numbers: Sequence[str] = ("2", "3", "1/2", "(-1)")


def grow(rng: random.Random, garden: Garden, kind: Kind, depth: int) -> Tree:
    """A random tree of a kind."""
    names = [name for name, one in garden.leaves.items() if one.kind == kind]
    if kind == "s":
        names += list(garden.numbers)
    elif kind[0] == kind[1] and rng.random() < 0.15:
        names = [f"eye({kind[0]})"]
    choices = [name for name in list_operations(garden, kind) if name in garden.operations]
    if not choices or (names and (depth <= 0 or rng.random() < 0.15)):
        return rng.choice(names) if names else ["flip", grow(rng, garden, (kind[1], kind[0]), depth - 1)]
    name = rng.choice(choices)
    if depth <= 0:
        name = "flip" if "flip" in choices and (kind[1], kind[0]) in {o.kind for o in garden.leaves.values()} else name
    return [name, *grow_parts(rng, garden, name, kind, depth - 1)]


def list_operations(garden: Garden, kind: Kind) -> list[str]:
    if kind == "s":
        return ["add", "num", "trace", "det", "dot", "entry"]
    found = ["add", "sub", "scale", "mul"] + (["flip"] if kind[1] != 1 or kind[0] == 1 else [])
    found += ["inv"] if kind[0] == kind[1] else []
    found += ["cross"] if kind == (3, 1) else []
    found += ["skew", "rot"] if kind == (3, 3) else []
    return found + (["qmul", "conj"] if kind == (4, 1) else [])


def grow_parts(rng: random.Random, garden: Garden, name: str, kind: Kind, depth: int) -> list[Tree]:
    def part(kind: Kind) -> Tree:
        return grow(rng, garden, kind, depth)

    size = rng.choice(garden.sizes)
    match name:
        case "scale" | "num":
            return [part("s"), part(kind)] if {"dot", "trace"} & garden.operations else [grow_number(rng), part(kind)]
        case "mul":
            return [part((kind[0], size)), part((size, kind[1]))]
        case "flip":
            return [part((kind[1], kind[0]))]
        case "trace" | "det":
            return [part((size, size))]
        case "dot":
            return [part((size, 1)), part((size, 1))]
        case "entry":
            other = rng.choice(garden.sizes)
            return [part((size, other)), (rng.randrange(size), rng.randrange(other))]
        case "skew":
            return [part((3, 1))]
        case "rot":
            return [part((4, 1))]
        case "inv" | "conj":
            return [part(kind)]
    return [part(kind), part(kind)]


def grow_number(rng: random.Random) -> str:
    return rng.choice(("2", "3", "1/2", "(-1)"))


def rewrite(tree: Tree, rng: random.Random) -> Tree:
    """An equal tree, or one that only looks equal: the values decide."""
    if isinstance(tree, str) or tree[0] == "entry":
        return tree
    name, parts = tree[0], [rewrite(part, rng) for part in tree[1:]]
    if rng.random() < 0.25:
        return [name, *parts]
    x, y = (parts * 2)[:2]
    inner = x[0] if isinstance(x, list) else ""
    behind = y[0] if isinstance(y, list) else ""
    match name:
        case "add" | "dot" | "num":
            return [name, y, x]
        case "sub":
            return ["neg", [name, y, x]]
        case "cross":
            return ["neg", [name, y, x]] if rng.random() < 0.5 else ["mul", ["skew", x], y]
        case "mul" if behind == "mul":
            return ["mul", ["mul", x, y[1]], y[2]]
        case "mul" if inner in ("add", "sub"):
            return [inner, ["mul", x[1], y], ["mul", x[2], y]]
        case "mul" if behind in ("add", "sub"):
            return [behind, ["mul", x, y[1]], ["mul", x, y[2]]]
        case "mul":
            return ["flip", ["mul", ["flip", y], ["flip", x]]]
        case "flip" if inner in ("add", "sub"):
            return [inner, ["flip", x[1]], ["flip", x[2]]]
        case "flip" if inner == "mul":
            return ["mul", ["flip", x[2]], ["flip", x[1]]]
        case "flip" | "inv" if inner in ("flip", "inv"):
            return [inner, [name, x[1]]]
        case "inv" if inner == "mul":
            return ["mul", ["inv", x[2]], ["inv", x[1]]]
        case "inv" if inner == "scale":
            return ["inv", x]
        case "trace" if inner == "mul":
            return ["trace", ["mul", x[2], x[1]]]
        case "det" if inner == "mul":
            return ["num", ["det", x[1]], ["det", x[2]]]
        case "trace" | "det":
            return [name, ["flip", x]]
        case "qmul" if behind == "qmul":
            return ["qmul", ["qmul", x, y[1]], y[2]]
        case "qmul":
            return ["conj", ["qmul", ["conj", y], ["conj", x]]]
        case "conj" if inner == "qmul":
            return ["qmul", ["conj", x[2]], ["conj", x[1]]]
        case "rot" if inner == "qmul":
            return ["mul", ["rot", x[1]], ["rot", x[2]]]
        case "rot":
            return ["flip", ["rot", ["conj", x]]]
        case "skew":
            return ["neg", ["flip", ["skew", x]]]
    return [name, *parts]


def spoil(tree: Tree, rng: random.Random, garden: Garden) -> Tree:
    """One change somewhere: another leaf of the same kind, a turned product, a sign, a missing transpose."""
    if isinstance(tree, str):
        bare = tree.removeprefix("dot_(").removesuffix(")") if tree.startswith("dot_(") else tree
        kind = garden.leaves[bare].kind if bare in garden.leaves else None
        names = [name for name, one in garden.leaves.items() if one.kind == kind and name != tree]
        if tree.startswith("eye"):
            return ["add", tree, tree]
        return rng.choice(names) if names else ["scale" if kind not in (None, "s") else "num", "(-1)", tree]
    name, *parts = tree
    if name in ("add", "sub") and rng.random() < 0.3:
        return ["sub" if name == "add" else "add", *parts]
    if name in ("qmul", "cross") and rng.random() < 0.4:
        return [name, *parts[::-1]]
    place = rng.randrange(1 if name == "entry" else len(parts))
    parts[place] = spoil(parts[place], rng, garden)
    return [name, *parts]


def is_equal(left: Tree, right: Tree, rng: random.Random, garden: Garden, sizes: Sequence[Mapping[str, int]]) -> bool:
    """Whether both sides agree at random points; raises ZeroDivisionError where a side has no value."""
    points = (draw_point(rng, garden.leaves, each_size) for each_size in sizes)
    return all(value_of(left, point) == value_of(right, point) for point in points)


def state(rng: random.Random, garden: Garden, kind: Kind, depth: int, sizes: Sequence[Mapping[str, int]]) -> Construct:
    """A tree and another one made of it."""
    while True:
        left = grow(rng, garden, kind, depth)
        if isinstance(left, str):
            continue
        right = rewrite(left, rng)
        right = spoil(right, rng, garden) if rng.random() < 0.5 else right
        try:
            truth = is_equal(left, right, rng, garden, sizes)
        except ZeroDivisionError:
            continue
        given = {name: one.declared for name, one in garden.leaves.items()}
        return Construct(f"{write_tree(left)} = {write_tree(right)}", truth, given)


PLAIN = ({}, {}, {})


@scheme
def shapes(rng: random.Random) -> Construct:
    """Matrices of 2 to 4 rows and columns, some symmetric, skew or diagonal; inverses and determinants."""
    m, n = rng.sample((2, 3, 4), 2)
    words = {"symmetric": draw_symmetric, "skew": draw_skew, "diagonal": draw_diagonal, "": draw_any}
    word = rng.choice([*words])
    leaves = {
        "A": leaf((m, n)), "B": leaf((n, m)), "S": leaf((n, n), word, words[word]), "M": leaf((m, m)),
        "u": leaf((m, 1)), "v": leaf((n, 1)), "a": leaf("s"),
    }  # fmt: skip
    known = {"add", "sub", "mul", "scale", "num", "flip", "trace", "dot", "entry"}
    known |= {"inv", "det"} if max(m, n) <= 3 and rng.random() < 0.5 else set()
    garden = Garden(leaves, (m, n), frozenset(known))
    kind = rng.choice(("s", (m, n), (n, n), (m, 1)))
    return state(rng, garden, kind, 2 if "inv" in known else 3, PLAIN)


@scheme
def rotations(rng: random.Random) -> Construct:
    """Rotations C and D, vectors and cross products; C.T @ C = eye(3) and det(C) = 1 are declared."""
    turn = Leaf((3, 3), {"rotation": "n to n"}, draw_rotation)
    leaves = {"C": turn, "D": turn, "u": leaf((3, 1)), "v": leaf((3, 1)), "a": leaf("s")}
    known = {"add", "mul", "scale", "num", "flip", "dot", "cross", "skew", "trace", "det", "inv"}
    garden = Garden(leaves, (3,), frozenset(known))
    law = rng.choice(ROTATION_LAWS)
    if rng.random() < 0.5:
        right = spoil(law[1], rng, garden) if rng.random() < 0.5 else law[1]
        truth = is_equal(law[0], right, rng, garden, PLAIN)
        given = {name: one.declared for name, one in leaves.items()}
        return Construct(f"{write_tree(law[0])} = {write_tree(right)}", truth, given)
    return state(rng, garden, rng.choice(("s", (3, 1))), 3, PLAIN)


ROTATION_LAWS: tuple[tuple[Tree, Tree], ...] = (
    (["mul", "C", ["cross", "u", "v"]], ["cross", ["mul", "C", "u"], ["mul", "C", "v"]]),
    (["mul", ["mul", "C", ["skew", "u"]], ["flip", "C"]], ["skew", ["mul", "C", "u"]]),
    (["dot", ["mul", "C", "u"], ["mul", "C", "v"]], ["dot", "u", "v"]),
    (["inv", ["mul", "C", "D"]], ["mul", ["flip", "D"], ["flip", "C"]]),
    (["det", ["mul", "C", ["skew", "u"]]], ["num", "0", "a"]),
    (["trace", ["mul", ["mul", "C", "D"], ["flip", "C"]]], ["trace", "D"]),
    (["det", ["scale", "a", "C"]], ["num", "a", ["num", "a", "a"]]),
    (["dot", "u", ["mul", "C", "v"]], ["dot", ["mul", ["flip", "C"], "u"], "v"]),
)


@scheme
def quaternion_trees(rng: random.Random) -> Construct:
    """Products, conjugates, sums and rotations of quaternions with and without length one."""
    unit_length = rng.random() < 0.5
    own = Leaf((4, 1), {"quaternion": "unit"}, draw_unit_quaternion)
    free = Leaf((4, 1), {"quaternion": "any"}, draw_any)
    leaves = {"p": own if unit_length else free, "q": own, "r": free, "u": leaf((3, 1)), "a": leaf("s")}
    garden = Garden(leaves, (4,), frozenset({"add", "sub", "scale", "num", "dot", "qmul", "conj"}))
    kind = rng.choice(("s", (4, 1), (4, 1)))
    if rng.random() < 0.3:
        p, q = (grow(rng, garden, (4, 1), 1) for _ in "pq")
        left: Tree = ["mul", ["rot", ["qmul", p, q]], "u"]
        right = rng.choice((
            ["mul", ["rot", p], ["mul", ["rot", q], "u"]], ["mul", ["mul", ["rot", q], ["rot", p]], "u"],
            ["mul", ["flip", ["rot", ["conj", ["qmul", p, q]]]], "u"],
        ))  # fmt: skip
        right = spoil(right, rng, garden) if rng.random() < 0.3 else right
        truth = is_equal(left, right, rng, garden, PLAIN)
        given = {name: one.declared for name, one in leaves.items()}
        return Construct(f"{write_tree(left)} = {write_tree(right)}", truth, given)
    return state(rng, garden, kind, 3, PLAIN)


# -- Matrices of any size ----------------------------------------------------------------------------------------------
ANY = ({"n": 3, "m": 4}, {"n": 4, "m": 2}, {"n": 1, "m": 2}, {"n": 2, "m": 1}, {"n": 1, "m": 1})
ANY_LEAVES = {
    "P": leaf(("n", "n"), "positive", draw_positive), "R": leaf(("m", "m"), "positive", draw_positive),
    "A": leaf(("n", "n")), "B": leaf(("n", "n"), "invertible"), "D": leaf(("m", "m"), "invertible"),
    "H": leaf(("m", "n")), "K": leaf(("n", "m")), "S": leaf(("n", "n"), "symmetric", draw_symmetric),
    "W": leaf(("n", "n"), "skew", draw_skew), "Q": leaf(("n", "n"), "orthogonal", draw_orthogonal),
    "x": leaf(("n", 1)), "y": leaf(("m", 1)),
}  # fmt: skip
M, T, ADD, SUB, INV = "mul", "flip", "add", "sub", "inv"


def chain(*parts: Tree) -> Tree:
    first, *rest = parts
    for part in rest:
        first = ["mul", first, part]
    return first


#: Laws of inverses; X, Y, H and K become random trees of their shapes.
ANY_LAWS: tuple[tuple[Tree, Tree], ...] = (
    ([INV, [ADD, "P", chain([T, "H"], "R", "H")]],
     [SUB, [INV, "P"], chain([INV, "P"], [T, "H"], [INV, [ADD, [INV, "R"], chain("H", [INV, "P"], [T, "H"])]], "H",
                             [INV, "P"])]),
    (chain("P", [T, "H"], [INV, [ADD, chain("H", "P", [T, "H"]), "R"]]),
     chain([INV, [ADD, [INV, "P"], chain([T, "H"], [INV, "R"], "H")]], [T, "H"], [INV, "R"])),
    ([INV, [ADD, "eye(n)", chain("K", "H")]],
     [SUB, "eye(n)", chain("K", [INV, [ADD, "eye(m)", chain("H", "K")]], "H")]),
    (chain("H", [INV, [ADD, "eye(n)", chain("K", "H")]]), chain([INV, [ADD, "eye(m)", chain("H", "K")]], "H")),
    ([INV, chain("B", "P")], chain([INV, "P"], [INV, "B"])),
    (chain([T, "Q"], "A", "Q"), [T, chain([T, "Q"], [T, "A"], "Q")]),
    ([INV, chain([T, "Q"], "B", "Q")], chain([T, "Q"], [INV, "B"], "Q")),
    ([SUB, [INV, "B"], [INV, "P"]], chain([INV, "B"], [SUB, "P", "B"], [INV, "P"])),
    ([INV, [ADD, [INV, "B"], [INV, "P"]]], chain("B", [INV, [ADD, "B", "P"]], "P")),
    (["trace", chain("A", "W")], ["trace", [T, chain([T, "W"], [T, "A"])]]),
    (["trace", chain("S", "W")], ["num", "0", "2"]),
    (["dot", "x", chain("W", "x")], ["num", "0", "2"]),
    (["dot", "x", chain("K", "y")], ["dot", chain([T, "K"], "x"), "y"]),
    (chain([SUB, "eye(n)", "W"], [INV, [ADD, "eye(n)", "W"]]),
     chain([INV, [ADD, "eye(n)", "W"]], [SUB, "eye(n)", "W"])),
)  # fmt: skip


@scheme
def any_size(rng: random.Random) -> Construct:
    """Words in matrices of any size: random ones, and laws of inverses with other matrices in place of some."""
    known = {"add", "sub", "mul", "flip", "scale", "trace", "dot"}
    garden = Garden(ANY_LEAVES, ("n", "m"), frozenset(known), ("2", "3", "1/2"))
    plain = Garden(ANY_LEAVES, ("n", "m"), frozenset(known - {"trace", "dot"}), ("2", "3", "1/2"))
    if rng.random() < 0.5:
        kind = rng.choice((("n", "n"), ("m", "n"), ("n", 1)))
        return state(rng, plain, kind, 3, ANY)
    left, right = rng.choice(ANY_LAWS)
    for name in rng.sample("HKAS", rng.choice((0, 1, 1))):
        kind = ANY_LEAVES[name].kind
        grown = grow(rng, plain, kind, 1)
        grown = [ADD, grown, [T, grown]] if name == "S" else grown
        left, right = plant(left, name, grown), plant(right, name, grown)
    right = spoil(right, rng, garden) if rng.random() < 0.5 else right
    try:
        truth = is_equal(left, right, rng, garden, ANY)
    except ZeroDivisionError:
        return any_size(rng)
    given = {name: one.declared for name, one in ANY_LEAVES.items()}
    return Construct(f"{write_tree(left)} = {write_tree(right)}", truth, given)


def plant(tree: Tree, name: str, grown: Tree) -> Tree:
    if isinstance(tree, str):
        return grown if tree == name else tree
    return [tree[0], *(plant(part, name, grown) for part in tree[1:])]


# -- Rates -------------------------------------------------------------------------------------------------------------
def rate_of(tree: Tree, rates: Mapping[str, Tree]) -> Tree | None:
    """The derivative by time, by the rules of a first course; None for 0."""
    if isinstance(tree, str):
        return rates.get(tree)
    name, *parts = tree
    if name == "entry":
        inner = rate_of(parts[0], rates)
        return inner and ["entry", inner, parts[1]]
    slopes = [rate_of(part, rates) for part in parts]
    if name == "inv":
        return slopes[0] and ["neg", ["mul", ["mul", tree, slopes[0]], tree]]
    if name == "det":
        return slopes[0] and ["num", tree, ["trace", ["mul", ["inv", parts[0]], slopes[0]]]]
    if len(parts) == 1:
        return slopes[0] and [name, slopes[0]]
    if name in ("add", "sub"):
        left, right = slopes
        return (
            [name, left, right] if left and right else left or (right and (right if name == "add" else ["neg", right]))
        )
    terms = [
        [name, *(slope if i == k else part for i, part in enumerate(parts))] for k, slope in enumerate(slopes) if slope
    ]
    return terms[0] if len(terms) == 1 else ["add", *terms] if terms else None


@scheme
def rates(rng: random.Random) -> Construct:
    """dot_ of a tree, by rates that are given or by functions of the time, against dual numbers."""
    n = rng.choice((2, 3))
    leaves = {
        "A": leaf((n, n)),
        "B": leaf((n, n)),
        "u": leaf((n, 1)),
        "v": leaf((n, 1)),
        "a": leaf("s"),
        "b": leaf("s"),
    }
    known = {"add", "sub", "mul", "scale", "num", "flip", "dot", "trace", "entry"} | (
        {"cross", "skew"} if n == 3 else set()
    )
    known |= {"inv"} if n == 2 else set()
    garden = Garden(leaves, (n,), frozenset(known))
    given: dict[str, Any] = {name: one.declared for name, one in leaves.items()}
    moving = rng.sample([*leaves], rng.randint(1, 4))
    if rng.random() < 0.5:
        own: dict[str, Tree] = {name: f"dot_({name})" for name in moving}
        for name in moving:
            given[name] = (given[name] if isinstance(given[name], dict) else {}) | {"function": "t"}
    else:
        own = {name: grow(rng, garden, leaves[name].kind, 1) for name in moving}
        given["rates"] = {name: write_tree(tree) for name, tree in own.items()}
    kind = rng.choice(("s", (n, 1), (n, n)))
    while True:
        tree = grow(rng, garden, kind, 2)
        right = rate_of(tree, own)
        if right is None:
            continue
        right = rewrite(right, rng)
        right = spoil(right, rng, garden) if rng.random() < 0.5 and not isinstance(right, str) else right
        try:
            truth = all(is_rate(tree, right, draw_moving(rng, leaves, own)) for _ in range(3))
        except (ZeroDivisionError, KeyError, ValueError):
            continue
        return Construct(f"dot_({write_tree(tree)}) = {write_tree(right)}", truth, given)


def draw_moving(rng: random.Random, leaves: Mapping[str, Leaf], own: Mapping[str, Tree]) -> dict[str, Value]:
    """Plain values of all leaves and of their rates, and the dual numbers made of both."""
    point = draw_point(rng, leaves, {})
    point |= {
        f"dot_({name})": draw_any(rng, leaves[name].kind) for name, tree in own.items() if tree == f"dot_({name})"
    }
    duals: dict[str, Value] = {"dual": True}
    for name, one in point.items():
        slope = value_of(own[name], point) if name in own else each(lambda _: Fraction(0), one)
        duals[name] = each(Dual, one, slope)
    return point | {"duals": duals}


def is_rate(tree: Tree, right: Tree, point: Mapping[str, Value]) -> bool:
    slope = each(lambda x: x.rate, value_of(tree, point["duals"]))
    return bool(slope == value_of(right, point))
