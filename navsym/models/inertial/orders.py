"""Bookkeeping of a small parameter: what is kept, what is dropped, and of which order it is.

Every symbol has a declared order, the power of mu relative to the common size rho of the error
variables; mu itself counts one. The order of a monomial is the sum over its factors.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp


@dataclass(frozen=True, slots=True)
class Dropped:
    """A term that was neglected: of order ``rho * mu**order``."""

    term: sp.Expr
    order: int


@dataclass(frozen=True, slots=True)
class Truncated:
    """An expression without its terms of high order, and those terms one by one."""

    kept: sp.Expr
    dropped: tuple[Dropped, ...]


def order_of(term: sp.Expr, orders: Mapping[sp.Symbol, int]) -> int:
    """Power of mu of one monomial; symbols that are not declared count zero."""
    total = 0
    for base, exponent in term.as_powers_dict().items():
        if base in orders:
            total += orders[base] * int(exponent)
    return total


def truncate(expression: sp.Expr, orders: Mapping[sp.Symbol, int], limit: int) -> Truncated:
    """Keep the monomials of order below ``limit``."""
    terms = sp.Add.make_args(sp.expand(expression))
    dropped = [Dropped(t, order_of(t, orders)) for t in terms if t != 0 and order_of(t, orders) >= limit]
    kept = sp.Add(*(t for t in terms if order_of(t, orders) < limit))
    return Truncated(kept, tuple(dropped))


def exactly(expression: sp.Expr, orders: Mapping[sp.Symbol, int], order: int) -> sp.Expr:
    """The monomials of one order."""
    return sp.Add(*(t for t in sp.Add.make_args(sp.expand(expression)) if order_of(t, orders) == order))


def lowest_order(expression: sp.Expr, orders: Mapping[sp.Symbol, int]) -> int | None:
    """The smallest order of a monomial; None for zero."""
    terms = [t for t in sp.Add.make_args(sp.expand(expression)) if t != 0]
    return min((order_of(t, orders) for t in terms), default=None)
