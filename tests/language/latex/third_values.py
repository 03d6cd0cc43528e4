"""Values of formulas: columns of six entries, matrices of six by six.

Whatever has no plain value there (powers, cross products, integrals, blocks) is a fixed generic function of its parts.
So two values agree only when both texts are built alike.
"""

from __future__ import annotations

import ast
import re
import zlib

import numpy as np

N = 6
CALLS = dict(
    sin="sin",
    cos="cos",
    tan="tan",
    cot="cot",
    sec="sec",
    csc="csc",
    exp="exp",
    ln="log",
    log="log",
    sinh="sinh",
    cosh="cosh",
    tanh="tanh",
    arcsin="asin",
    arccos="acos",
    arctan="atan",
    det="det",
    min="min",
    max="max",
    atan2="atan2",
    arctan2="atan2",
    sgn="sign",
    sign="sign",
    tr="trace",
    Tr="trace",
    trace="trace",
    diag="diag",
    skew="skew",
    erf="erf",
    expm="exp",
    asin="asin",
    acos="acos",
    atan="atan",
)


def noise(tag, shape=()):
    """Fixed random numbers for a tag."""
    return np.random.default_rng(zlib.crc32(repr(tag).encode())).uniform(0.4, 1.6, shape)


def blend(tag, *values):
    """A generic number made of values."""
    total = noise(tag)
    for place, value in enumerate(values):
        array = np.asarray(value, dtype=float)
        total = np.sin(total + 0.37 * float(np.sum(noise((tag, place), array.shape) * array)) + 0.1 * place)
    return float(total) + 1.5


def is_scalar(value):
    return np.shape(value) == ()


def is_column(value):
    return np.shape(value) == (N, 1)


def times(one, other):
    """A product by shapes; one by one is a number."""
    value = one * other if is_scalar(one) or is_scalar(other) else one @ other
    return float(value[0, 0]) if np.shape(value) == (1, 1) else value


def over(one, other):
    assert is_scalar(other)
    return one / other


def power(base, exponent):
    if is_scalar(base):
        return blend("power", base, exponent)
    if exponent == -1:
        return np.linalg.inv(base)
    return times(base, base) if exponent == 2 else times(times(base, base), base)


def skew(v):
    return (noise("skew", (N * N, N)) @ v).reshape(N, N)


def cross(u, v):
    return (noise("cross one", (N, N)) @ u) * (noise("cross two", (N, N)) @ v)


def literal(rows):
    """A matrix from its cells, whatever their shapes."""
    height, width = len(rows), len(rows[0])
    cells = [[c if is_scalar(c) else blend(("cell", np.shape(c)), c) for c in row] for row in rows]
    if width == 1:
        return sum(noise(("entry", i), (N, 1)) * row[0] for i, row in enumerate(cells))
    if height == 1:
        return sum(noise(("entry", j), (N, 1)).T * c for j, c in enumerate(cells[0]))
    return sum(noise(("entry", i, j), (N, N)) * c for i, row in enumerate(cells) for j, c in enumerate(row))


def exponential(x):
    return blend("exp", x) if is_scalar(x) else np.eye(N) + x + 0.5 * x @ x


def derive(f, x, order=1):
    return f @ x.T + order if is_column(x) else f * 1.9 + np.sin(x) + order


def bind(tag):
    return lambda f, x, *ends: f * blend(tag, x, *ends)


def entry(value, *indices):
    weights = [np.cos(np.arange(N) * float(i))[:, None] for i in indices]
    return float((weights[0].T @ value @ (weights[1] if len(indices) > 1 else np.ones((np.shape(value)[1], 1))))[0, 0])


FUNCTIONS = {
    **{name: (lambda *a, name=name: blend(name, *a)) for name in (*CALLS.values(), "floor")},
    "sqrt": lambda x: blend("root", x), "abs": abs, "norm": lambda v: float(np.sqrt(np.sum(v * v))),
    "dot": lambda u, v: times(u.T, v), "cross": cross, "skew": skew, "inv": lambda m: power(m, -1), "exp": exponential,
    "expm": exponential, "conj": lambda q: noise("conj", (N, N)) @ q, "det": lambda m: blend("det", m), "L": literal,
    "trace": lambda m: blend("trace", m), "diag": lambda *a: noise("diag", (N, N)) * blend("diag", *a),
    "qmul": lambda p, q: (noise("first", (N, N)) @ p) * (noise("second", (N, N)) @ q),
    "P": power, "M": times, "D": over,
    "dot_": lambda x: 1.7 * x + 0.3, "diff": derive, "integral": bind("integral"), "sum": bind("sum"),
    "product": bind("product"), "limit": bind("limit"), "I": entry, "eye": lambda n: np.eye(N), "oo": 1e3, "pi": 3.25,
    "zeros": lambda a, b=None: np.zeros((N, 1) if b == 1 else (1, N) if a == 1 and b else (N, N)),
    "where": lambda c, a, b: a * c + b * (1.25 - c), "C": lambda a, sign, b: blend(("compare", sign), a, b),
}  # fmt: skip


def draw_values(symbols):
    """Name -> a value of its declared kind."""
    values = {}
    for name, declaration in symbols.items():
        size = declaration if isinstance(declaration, dict) else {}
        column = "vector" in size or "quaternion" in size
        wide = str(size.get("matrix", ["", ""])[0]) == "1"
        thin = str(size.get("matrix", ["", ""])[1]) == "1"
        shape = (N, 1) if column or thin else (1, N) if wide else (N, N) if {"matrix", "rotation"} & set(size) else ()
        values[name] = noise(("name", name), shape) if shape else float(noise(("name", name)))
    return values


def evaluate(text, values):
    """The value of a reading, by Python's own grammar on a text whose operators are calls."""

    class Calls(ast.NodeTransformer):
        def visit_BinOp(self, node):
            self.generic_visit(node)
            names = {ast.Mult: "M", ast.MatMult: "M", ast.Div: "D", ast.Pow: "P"}
            name = names.get(type(node.op))
            return ast.Call(ast.Name(name, ast.Load()), [node.left, node.right], []) if name else node

        def visit_List(self, node):
            rows = [[self.visit(c) for c in row.elts] for row in node.elts]
            lists = ast.List([ast.List(row, ast.Load()) for row in rows], ast.Load())
            return ast.Call(ast.Name("L", ast.Load()), [lists], [])

        def visit_Subscript(self, node):
            inner = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
            return ast.Call(ast.Name("I", ast.Load()), [node.value, *map(self.visit, inner)], [])

        def visit_Compare(self, node):
            self.generic_visit(node)
            sign = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "=", ast.NotEq: "!="}[
                type(node.ops[0])
            ]
            return ast.Call(ast.Name("C", ast.Load()), [node.left, ast.Constant(sign), node.comparators[0]], [])

    renamed = re.sub(r"\b[A-Za-z]\w*\b(?!\()", lambda m: m[0] if m[0] in ("T", "oo", "pi") else f"n_{m[0]}", text)
    renamed = re.sub(r"(?<!\.)\bT\b", "n_T", renamed)
    tree = Calls().visit(ast.parse(re.sub(r"(?<![<>!=])=(?!=)", "==", renamed), mode="eval"))
    free = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and node.id.startswith("n_")}
    scope = {name: values.get(name[2:], float(noise(("name", name[2:])))) for name in free} | FUNCTIONS
    return eval(compile(ast.fix_missing_locations(tree), "reading", "eval"), {"__builtins__": {}}, scope)
