"""Exact points at which a factor of an expression vanishes: (x + y - 3)**2 > 0 fails on a whole line.

A descent comes as near to such a line as its digits allow and never lies on it. Here a factor that is a
polynomial of degree one or two in some symbol is solved for it, at ordinary points of the others.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import sympy as sp

from navsym.proof.balls import UnsupportedError, exact_ball
from navsym.proof.identities.logarithms import factored
from navsym.proof.sampling.points import Point, Range, points

PLACES = 6
MOST_FACTORS = 8

#: Functions that are zero where their argument is.
VANISHING = (sp.Abs, sp.sin, sp.tan, sp.atan, sp.asin, sp.sinh, sp.tanh)


def zeros_of_factors(difference: sp.Expr, limits: Mapping[sp.Symbol, Range]) -> Iterator[Point]:
    """Points of the box where a factor is zero; the caller shows that the whole is, and exists there."""
    bases = dict.fromkeys(unwrapped(factor) for factor in sp.Mul.make_args(factored(difference)))
    for base in list(bases)[:MOST_FACTORS]:
        for symbol in sorted(base.free_symbols, key=str):
            yield from zeros_in(base, symbol, limits)


def unwrapped(factor: sp.Expr) -> sp.Expr:
    """What a power or a function like |u| vanishes with."""
    base = factor.as_base_exp()[0]
    return unwrapped(base.args[0]) if isinstance(base, VANISHING) else base


def zeros_in(base: sp.Expr, symbol: sp.Symbol, limits: Mapping[sp.Symbol, Range]) -> Iterator[Point]:
    """The roots of ``c + b symbol + a symbol**2`` at ordinary points of the other symbols."""
    slope = sp.diff(base, symbol)
    curve = sp.expand(sp.diff(slope, symbol) / 2)
    if symbol in curve.free_symbols:
        return
    others = [other for other in limits if other is not symbol]
    for point in points(others, ends_of(limits), PLACES):
        numbers = [part.subs({**point, symbol: 0}) for part in (curve, slope, base)]
        try:
            found = [value for value in roots_of(*numbers) if limits[symbol].contains(value)]
        except UnsupportedError:
            continue
        yield from ({**point, symbol: value} for value in found)


def ends_of(limits: Mapping[sp.Symbol, Range]) -> dict[sp.Symbol, tuple[sp.Expr | None, sp.Expr | None]]:
    """The ranges as a box."""
    return {symbol: (limit.lower, limit.upper) for symbol, limit in limits.items()}


def roots_of(a: sp.Expr, b: sp.Expr, c: sp.Expr) -> list[sp.Expr]:
    """Real roots of ``a x**2 + b x + c`` with numbers; none where a ball cannot tell."""
    if any(part.has(sp.nan, sp.zoo, sp.oo) for part in (a, b, c)):
        return []
    if a == 0:
        return [] if exact_ball(b).contains(0) else [-c / b]
    discriminant = b**2 - 4 * a * c
    if exact_ball(a).contains(0) or not exact_ball(discriminant) > 0:
        return []
    root = sp.sqrt(discriminant)
    return [(-b - root) / (2 * a), (-b + root) / (2 * a)]
