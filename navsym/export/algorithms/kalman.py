"""Kalman's update for any numbers of states and measurements, one measurement after the other.

With independent measurement errors (R diagonal) the scalar updates give the same estimate as the update by the whole
vector, and need no inverse. Covariances are kept as upper triangles, row by row.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import combinations_with_replacement as pairs

import sympy as sp

from navsym.claims import Equation
from navsym.export.chain import Chain, Link, define, real
from navsym.export.parts import Layout

UNITS = {
    "x": "units of the state",
    "P": "their products",
    "z": "units of the measurement",
    "R": "their squares",
    "H": "ratios of these",
    "next_x": "units of the state",
    "next_P": "their products",
}


def triangle(name: str, n: int) -> tuple[str, ...]:
    """Names of the upper triangle, row by row."""
    return tuple(f"{name}{i}_{j}" for i, j in pairs(range(n), 2))


def entry(name: str, i: int, j: int) -> sp.Symbol:
    """Symbol of the entry (i, j) of a symmetric matrix, the smaller index first."""
    return real(f"{name}{min(i, j)}_{max(i, j)}")


def information() -> Equation:
    """P - g g^T/s inverts the sum of informations: (E + P h h^T/r) times it is P, for g = P h and s = h^T g + r.

    In g, c = h^T g and r this is one identity for each pair of entries, the same for every number of states.
    """
    a, b, c, r = (real(name) for name in ("g_i", "g_j", "c", "r"))
    after_h = b - c * b / (c + r)  # entry j of h^T (P - g g^T/s)
    return Equation(printed=-a * b / (c + r) + a * after_h / r, derived=sp.S.Zero)


def one_measurement(k: int, n: int) -> tuple[Link, ...]:
    """Gain and correction by measurement k, from the values named by k to those named by k + 1."""
    x, P = ("x", "P") if k == 0 else (f"x{k}at", f"P{k}at")
    h, g, gain = ([real(f"{letter}{k}_{i}") for i in range(n)] for letter in "hgK")
    state, (q, s, v, z) = [real(f"{x}{i}") for i in range(n)], (real(f"{letter}{k}") for letter in "qsvz")
    along = {s: scalar_product(h, g) + sp.Symbol(f"r{k}", positive=True), v: z - scalar_product(h, state)}
    moved = {real(f"x{k + 1}at{i}"): state[i] + gain[i] * v for i in range(n)}
    shrunk = {entry(f"P{k + 1}at", i, j): entry(P, i, j) - g[i] * gain[j] for i, j in pairs(range(n), 2)}
    return (
        define({g[i]: scalar_product([entry(P, i, j) for j in range(n)], h) for i in range(n)}),
        define(along),
        define({q: 1 / s}),
        define({gain[i]: g[i] * q for i in range(n)}),
        define(moved),
        define(shrunk, information, cites=("multistructure:8.correct",)),
    )


def scalar_product(a: Iterable[sp.Expr], b: Iterable[sp.Expr]) -> sp.Expr:
    """The sum of the products of entries."""
    return sum(x * y for x, y in zip(a, b, strict=True))


def update(n: int, m: int) -> Chain:
    """The update of n states by m measurements with independent errors of the variances R."""
    arrays = {
        "x": tuple(f"x{i}" for i in range(n)),
        "P": triangle("P", n),
        "z": tuple(f"z{k}" for k in range(m)),
        "H": tuple(f"h{k}_{i}" for k in range(m) for i in range(n)),
        "R": tuple(f"r{k}" for k in range(m)),
    }
    tests = {
        name: ((2.0, 4.0) if i == j else (-0.2, 0.2))
        for name, (i, j) in zip(triangle("P", n), pairs(range(n), 2), strict=True)
    }
    tests |= {"x": (-10.0, 10.0), "z": (-10.0, 10.0), "H": (-1.0, 1.0), "R": (0.1, 4.0)}
    return Chain(
        title=f"Update of {n} states by {m} independent measurements, one after the other",
        links=tuple(link for k in range(m) for link in one_measurement(k, n)),
        outputs={"next_x": tuple(f"x{m}at{i}" for i in range(n)), "next_P": triangle(f"P{m}at", n)},
        layout=Layout(arrays, ("x", "P", "z", "H", "R"), tests, UNITS),
    )
