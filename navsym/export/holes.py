"""Removable singularities and cancellation at a zero of one variable, by one rule for all formulas.

A part b of a formula that depends on x through u = q x alone, and vanishes there to the order v (decided exactly, by
rational power series), is written as

    b = u^v filled(b, v, u)         filled(b, k, u) = b(u)/u^k, and its limit where u = 0 (k = v or 0),

wherever a product divides by a power of x (sin(x)/x, log(1 + x)/x, x/tan(x)); and as filled(b, 0, u) wherever a sum
loses its leading terms (x - sin x, exp(x) - 1 - x). Zeros elsewhere, as in log(x)/(x - 1), are moved to the origin.
How such a part is computed near zero, and how well, is :mod:`navsym.export.accuracy.continuation`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import sympy as sp

from navsym.export.atoms import filled, plain
from navsym.export.series import NoSeriesError, order

Ranges = Mapping[sp.Symbol, tuple[Any, Any]]
T = sp.Symbol("t", real=True)  # the variable of every part
MOST_OPERATIONS = 200  # of a part that is looked at


@dataclass(frozen=True, slots=True)
class Part:
    """One such part as an operation of code: t -> formula(t)/t^divided, with its limit at zero."""

    formula: sp.Expr
    divided: int

    @property
    def plain(self) -> sp.Expr:
        """The formula in functions that have a series."""
        return plain(self.formula)

    @property
    def order(self) -> int:
        """The order to which the formula vanishes at zero."""
        return order(self.plain, T)

    def at(self, u: sp.Expr) -> sp.Expr:
        """The operation applied to an argument, as an expression."""
        return filled(sp.Lambda(T, self.formula), sp.Integer(self.divided), u)


def part_of(e: filled) -> Part:
    """The operation of an expression ``filled(…)``."""
    part, divided, _ = e.args
    return Part(part.expr.xreplace({part.variables[0]: T}), int(divided))


@lru_cache(maxsize=1024)
def order_of(part: sp.Expr) -> int | None:
    """Order of a formula in T at zero; None where it is not known."""
    try:
        return order(part, T)
    except (NoSeriesError, sp.PolynomialError):
        return None


def split(b: sp.Expr, x: sp.Symbol) -> tuple[sp.Expr, sp.Expr, int] | None:
    """(q, part, v) with b = part(q x) and v its order at zero; None when b is not of this kind.

    Of several q the one that leaves the shortest part is taken: sin(x/2) is sin at x/2.
    """
    if isinstance(b, filled):
        return split_again(b, x)
    if b.has(filled) or b.count_ops() > MOST_OPERATIONS:
        return None
    found: list[tuple[int, int, sp.Expr, sp.Expr]] = []
    for q in scales(b, x):
        part = b.xreplace({x: T}) if q == 1 else b.subs(x, T / q)
        if part.free_symbols == {T}:
            found.append((part.count_ops(), len(found), q, part))
    if not found:
        return None
    _, _, q, part = min(found, key=lambda item: item[:2])
    v = order_of(plain(part))
    return None if v is None else (q, part, v)


def split_again(b: filled, x: sp.Symbol) -> tuple[sp.Expr, sp.Expr, int] | None:
    """The same for a part that was found before, in a sum."""
    part, k, u = b.args
    q = sp.cancel(u / x)
    v = order_of(plain(part.expr))
    return None if k != 0 or q.has(x) or v is None else (q, part.expr.xreplace({part.variables[0]: T}), v)


def scales(b: sp.Expr, x: sp.Symbol) -> Iterator[sp.Expr]:
    """What x is multiplied by in b."""
    seen = [sp.S.One]
    yield seen[0]
    for node in sp.preorder_traversal(b):
        if isinstance(node, sp.Mul) and x in node.args:
            q = node / x
            if q not in seen and not q.has(x):
                seen.append(q)
                yield q


def filled_part(x: sp.Expr, q: sp.Expr, part: sp.Expr, v: int) -> sp.Expr:
    """``b/x^v`` for b = part(q x); a rational one is divided out."""
    if part.is_rational_function(T):
        return (q**v * sp.cancel(part / T**v)).subs(T, q * x)
    return q**v * filled(sp.Lambda(T, part), sp.Integer(v), q * x)


def product(factors: sp.Expr, ranges: Ranges) -> sp.Expr:
    """The product with what vanishes above and below the line at the same place divided out."""
    for x, place in zeros_below(factors, ranges):
        found = divided(factors, x, place)
        if found is not None:
            return product(found, ranges)
    return factors


def zeros_below(whole: sp.Expr, ranges: Ranges) -> list[tuple[sp.Symbol, sp.Expr]]:
    """(symbol, value) where a factor with a negative exponent may vanish: 0, and the root of a linear factor."""
    found: list[tuple[sp.Symbol, sp.Expr]] = []
    for factor in sp.Mul.make_args(whole):
        base, exponent = factor.as_base_exp()
        if not (exponent.is_Integer and exponent < 0):
            continue
        for x in sorted(base.free_symbols, key=str):
            found += [(x, place) for place in {sp.S.Zero, root_of(base, x)} if in_range(x, place, ranges)]
    return list(dict.fromkeys(found))


def root_of(base: sp.Expr, x: sp.Symbol) -> sp.Expr:
    """The root of a linear factor with known coefficients, else zero."""
    if base.free_symbols != {x} or not base.is_Add:
        return sp.S.Zero
    slope = base.coeff(x, 1)
    rest = sp.expand(base - slope * x)
    return -rest / slope if slope.is_number and slope != 0 and not rest.has(x) else sp.S.Zero


def in_range(x: sp.Symbol, place: sp.Expr, ranges: Ranges) -> bool:
    """True when the value lies in the range of the symbol."""
    if place == 0 and (x.is_positive or x.is_negative or x.is_nonzero):
        return False
    lower, upper = ranges.get(x, (None, None))
    return (lower is None or bool(lower <= place)) and (upper is None or bool(place <= upper))


def divided(whole: sp.Expr, x: sp.Symbol, place: sp.Expr) -> sp.Expr | None:
    """The product with its zeros in x taken out of its factors; None when they are not on both sides of the line."""
    at = x if place == 0 else sp.Dummy("d", real=True)
    parts = []
    for factor in sp.Mul.make_args(whole):
        base, exponent = factor.as_base_exp()
        moved = base if place == 0 else sp.expand(base.xreplace({x: place + at}), power_base=False, mul=True)
        known = split(moved, at) if exponent.is_Integer and moved.has(at) else None
        parts.append((base, exponent, known))
    zeros = [(known[2] * exponent) for _, exponent, known in parts if known]
    if not (any(z > 0 for z in zeros) and any(z < 0 for z in zeros)):
        return None
    made, power = [], sp.S.Zero
    for base, exponent, known in parts:
        if known is None or known[2] == 0:
            made.append(base**exponent)
            continue
        power += known[2] * exponent
        if base != x:
            made.append(filled_part(at, *known) ** exponent)
    result = sp.Mul(*made) * at**power
    return result if place == 0 else result.xreplace({at: x - place})


def total(whole: sp.Expr, ranges: Ranges) -> sp.Expr:
    """The sum with the terms that cancel at zero joined."""
    if not isinstance(whole, sp.Add):
        return whole
    for x in sorted(whole.free_symbols, key=str):
        if not in_range(x, sp.S.Zero, ranges):
            continue
        inner = [term for term in whole.args if x in term.free_symbols]
        if all(term.is_rational_function(x) or term.has(filled) for term in inner):
            continue
        numbers = [term for term in whole.args if term.is_number]
        for chosen in ([*inner, *numbers], inner) if numbers else (inner,):
            joined = joined_terms(sp.Add(*chosen), x, ranges)
            if joined is not None:
                rest = sp.Add(*(term for term in whole.args if term not in chosen))
                return joined + total(rest, ranges)
    return whole


def joined_terms(whole: sp.Expr, x: sp.Symbol, ranges: Ranges) -> sp.Expr | None:
    """Terms that cancel at x = 0 as a power of x times what is left; None when they do not."""
    content, whole = content_of(whole)
    known = split(whole, x) if isinstance(whole, sp.Add) else None
    if known is None:
        return None
    q, part, v = known
    orders = [order_of(plain(term)) for term in part.args]
    if any(one is None for one in orders) or v <= min(one for one in orders if one is not None):
        return None
    if min(one for one in orders if one is not None) >= 0:
        return content * filled(sp.Lambda(T, part), sp.S.Zero, q * x)
    above, below = (side.subs(T, q * x) for side in sp.fraction(sp.together(part)))
    return product(content * sp.factor_terms(above) / below, ranges)


def content_of(whole: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """The common factors of a sum, and the sum that is left."""
    outer = sp.factor_terms(whole)
    if isinstance(outer, sp.Mul):
        sums = [factor for factor in outer.args if isinstance(factor, sp.Add)]
        if len(sums) == 1:
            return outer / sums[0], sums[0]
    return sp.S.One, whole
