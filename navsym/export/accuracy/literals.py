"""The number that stands in the code for an exact constant: the nearest of the type."""

from __future__ import annotations

import math

import numpy as np
import sympy as sp

from navsym.core.errors import DomainError
from navsym.export.accuracy.rounding import Arithmetic
from navsym.export.expression_graph import Graph


def literals_of(graph: Graph, arithmetic: Arithmetic) -> tuple[float | None, ...]:
    """The number in the code for each constant node."""
    return tuple(literal(n.value, arithmetic) if n.op == "const" else None for n in graph.nodes)


def literal(value: sp.Expr, arithmetic: Arithmetic) -> float:
    """The nearest number of the type; raises DomainError for a constant beyond the largest one."""
    try:
        nearest = int(value.p) / int(value.q) if value.is_Rational else float(sp.N(value, 40))
    except OverflowError:
        nearest = math.inf
    with np.errstate(over="ignore"):
        nearest = float(np.float32(nearest)) if arithmetic.name == "float" else nearest
    if not math.isfinite(nearest):
        size = f"expected constants within the range of {arithmetic.name}; got one of size 2^{size_of(value)}"
        raise DomainError(f"{size}; rescale the formula")
    return nearest


def size_of(value: sp.Expr) -> int:
    """The exponent of a number, for people."""
    return int(sp.floor(sp.log(abs(value), 2).evalf(20)))
