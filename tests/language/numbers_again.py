"""Trees of the whole language in floating point, by numpy: a reading that shares nothing with that of the checker."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from navsym.language.tree import Tree

SCALARS = {name: getattr(math, name) for name in ("sin", "cos", "tan", "exp", "log", "sqrt", "asin", "acos", "atan")}
ORDER = {
    "=": lambda a, b: a == b, "!=": lambda a, b: a != b, "<": lambda a, b: a < b,
    "<=": lambda a, b: a <= b, ">": lambda a, b: a > b, ">=": lambda a, b: a >= b,
}  # fmt: skip


def multiply(p, q):
    """Hamilton's product by the matrix of the left factor."""
    w, x, y, z = np.ravel(p)
    left = np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]])
    return left @ np.reshape(q, (4, 1))


def conjugate(q):
    return np.reshape(q, (4, 1)) * np.array([[1], [-1], [-1], [-1]])


def rotate(q):
    """The columns q e q* of the unit vectors."""
    columns = [multiply(multiply(q, np.r_[0.0, unit]), conjugate(q))[1:, 0] for unit in np.eye(3)]
    return np.array(columns).T


FUNCTIONS = {
    "cross": lambda u, v: np.cross(u[:, 0], v[:, 0])[:, None],
    "dot": lambda u, v: float(np.vdot(u, v)),
    "norm": lambda u: float(np.linalg.norm(u)),
    "skew": lambda u: np.array([np.cross(u[:, 0], unit) for unit in np.eye(3)]).T,
    "det": lambda a: float(np.linalg.det(a)),
    "inv": np.linalg.inv,
    "trace": lambda a: float(np.trace(a)),
    "transpose": np.transpose,
    "T": np.transpose,
    "eye": lambda n: np.eye(int(n)),
    "zeros": lambda m, n: np.zeros((int(m), int(n))),
    "diag": lambda *e: np.diag(np.ravel(e[0]) if len(e) == 1 else np.array(e)),
    "qmul": multiply,
    "conj": conjugate,
    "rot": rotate,
    "min": min,
    "max": max,
    "sign": lambda x: float(np.sign(x)),
    "abs": abs,
    "pi": lambda: math.pi,
    "index": lambda a, i, j=1: a[int(i) - 1, int(j) - 1],
    "row": lambda *e: list(e),
    "matrix": lambda *rows: np.array(rows, dtype=float),
    "@": lambda a, b: (a @ b)[0, 0] if (a @ b).shape == (1, 1) else a @ b,
    "**": lambda a, b: a**b,
    **SCALARS,
    **ORDER,
}


def evaluate(tree: Tree, names: Mapping[str, Any]) -> Any:
    """The number or array (rows, columns) of a tree without derivatives."""
    if tree.head == "number":
        return float(tree.args[0])
    if tree.head == "symbol":
        return names[tree.args[0]]
    if tree.head == "where":
        condition, yes, no = tree.args
        return evaluate(yes if evaluate(condition, names) else no, names)
    values = [evaluate(part, names) for part in tree.args]
    if tree.head in ("+", "*"):
        total = values[0]
        for value in values[1:]:
            total = total + value if tree.head == "+" else total * value
        return total
    return FUNCTIONS[tree.head](*values)
