"""Certificates of the algebraic verdicts, as plain data that ``navsym check`` replays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import comb, prod
from typing import Any

import sympy as sp
from flint import arb, fmpq, fmpq_poly

from navsym.core.balls import Tape, enclose, exact_ball, precision, tape
from navsym.core.errors import NavsymError
from navsym.core.exact import to_fmpq
from navsym.language.expression import to_text
from navsym.prove.sampling.points import Range
from navsym.prove.signs.exact import Limits
from navsym.prove.signs.real_roots import UndecidedError, polynomial_at
from navsym.prove.signs.substitutions import closed_ends, substitute_one_number

BITS = 96
MOST_CELLS = 1000
MOST_TERMS = 10_000

#: What the checker knows at exact numbers only.
BENT = (sp.Abs, sp.asin, sp.acos, sp.atan2)

Cell = dict[sp.Symbol, tuple[fmpq, fmpq]]


def identity_certificate(left: sp.Expr, right: sp.Expr) -> Mapping[str, Any] | None:
    """``left = right`` in the language of files; None when a side lies outside it, or is too large for the checker."""
    if count_terms(left, right) > MOST_TERMS:
        return None
    symbols = sorted({s.name for s in left.free_symbols | right.free_symbols})
    try:
        return {"kind": "identity", "left": to_text(left), "right": to_text(right), "symbols": symbols}
    except NavsymError:
        return None


def count_terms(*sides: sp.Expr) -> int:
    """How many terms every term becomes when the checker multiplies by all sums that something is divided by."""
    powers: dict[sp.Expr, int] = {}
    for power in set().union(*(side.atoms(sp.Pow) for side in sides)):
        if power.base.is_Add and power.exp.is_Integer and power.exp < 0:
            powers[power.base] = max(powers.get(power.base, 0), -int(power.exp))
    return prod(comb(len(base.args) + power - 1, power) for base, power in powers.items())


def positivity_certificate(expression: sp.Expr, limits: Limits) -> Mapping[str, Any] | None:
    """``expression > 0`` on a closed bounded box, by halving alone; None where that does not show it."""
    ends = {s: (limits[s].lower, limits[s].upper) for s in sorted(expression.free_symbols, key=str)}
    if any(end is None for pair in ends.values() for end in pair) or expression.has(*BENT):
        return None
    try:
        cells = cells_needed(expression, ends)
        box = {s.name: [to_text(lower), to_text(upper)] for s, (lower, upper) in ends.items()}
        text = to_text(expression)
    except NavsymError:
        return None
    if cells is None:
        return None
    return {"kind": "positivity", "expression": text, "box": box, "bits": BITS, "cells": cells}


def cells_needed(expression: sp.Expr, ends: Mapping[sp.Symbol, tuple[Any, Any]]) -> int | None:
    """How many cells a halving of the unit cube looks at; None when they are too many."""
    powers = sorted(expression.atoms(sp.Pow), key=sp.default_sort_key)
    inside = [power.base for power in powers if not power.exp.is_Integer]  # a root of zero has no derivative
    programs, used = [tape(part) for part in (expression, *inside)], 0
    with precision(BITS):
        sides = {s: (exact_ball(lower, BITS), exact_ball(upper, BITS)) for s, (lower, upper) in ends.items()}
    pending: list[Cell] = [dict.fromkeys(ends, (fmpq(0), fmpq(1)))]
    while pending:
        cell, used = pending.pop(), used + 1
        if all(is_positive_on(program, cell, sides) for program in programs):
            continue
        if used > MOST_CELLS or not cell:
            return None
        widest = max(cell, key=lambda s: cell[s][1] - cell[s][0])
        low, high = cell[widest]
        middle = (low + high) / 2
        pending += [{**cell, widest: (low, middle)}, {**cell, widest: (middle, high)}]
    return used


def is_positive_on(program: Tape, cell: Cell, sides: Mapping[sp.Symbol, tuple[arb, arb]]) -> bool:
    with precision(BITS):
        values = {s: a + (b - a) * arb(cell[s][0]).union(arb(cell[s][1])) for s, (a, b) in sides.items()}
    return bool(enclose(program, values, BITS) > 0)


# Certificates of rational functions in one symbol that touch zero, or have no last end: squares taken out.
#
# ``f = S**2 (x - a) (b - x) Q/D**2`` is an identity, and Q is positive on the closed range; the checker replays both.
# Beyond a last end Q is looked at through its reversed polynomial: Q > 0 for x >= a when Q(a + y) and y**n Q(a + 1/y)
# are positive for y in [0, 1].


X = fmpq_poly([0, 1])


def factored_certificate(
    expression: sp.Expr, symbol: sp.Symbol, limit: Range, strict: bool
) -> Mapping[str, Any] | None:
    """``expression >= 0``, or ``> 0``, on the range of its symbol; None where it has another form."""
    if limit.integer or not expression.is_rational_function(symbol) or symbol not in expression.free_symbols:
        return None
    try:
        found = substitute_one_number((expression,), symbol, limit)
    except UndecidedError:
        return None
    if found is None:
        return None
    top, bottom = found.fractions[0]
    square, ends, rest = take_out_squares(top * bottom, limit, strict)
    product = sp.Mul(
        polynomial_at(square, symbol) ** 2, *(polynomial_at(end, symbol) for end in ends), polynomial_at(rest, symbol)
    )
    parts = [identity_certificate(expression, product / polynomial_at(bottom, symbol) ** 2)]
    for curve, box in list_covers(rest, limit):
        parts.append(positivity_certificate(polynomial_at(curve, symbol), {symbol: box}))
    return {"kind": "all", "of": [dict(part) for part in parts if part]} if all(parts) else None


def take_out_squares(curve: fmpq_poly, limit: Range, strict: bool) -> tuple[fmpq_poly, list[fmpq_poly], fmpq_poly]:
    """A square, what vanishes at an end of the range, and the rest; no square where zero is not allowed."""
    _, factors = curve.numer().factor()
    square, rest = fmpq_poly([1]), curve
    for factor, power in factors if not strict else ():
        square = square * fmpq_poly(factor) ** (power // 2)
    rest = rest / (square * square)
    ends: list[fmpq_poly] = []
    for end, closed, sign in zip((limit.lower, limit.upper), closed_ends(limit), (1, -1), strict=True):
        if not isinstance(end, sp.Rational) or (strict and closed):
            continue
        linear = sign * (X - to_fmpq(end))
        if rest % linear == 0:
            ends, rest = [*ends, linear], rest / linear
    return square, ends, rest


def list_covers(curve: fmpq_poly, limit: Range) -> Iterator[tuple[fmpq_poly, Range]]:
    """Polynomials and closed boxes on which they must be positive for the polynomial to be so on the range."""
    zero, one = sp.Integer(0), sp.Integer(1)
    if limit.lower is not None and limit.upper is not None:
        yield curve, Range(limit.lower, limit.upper)
        return
    if limit.lower is None and limit.upper is None:
        yield curve, Range(-one, one)
        yield reverse_polynomial(curve), Range(-one, one)  # of even degree, or it would change its sign
        return
    end = limit.lower if limit.lower is not None else limit.upper
    if isinstance(end, sp.Rational):
        way = X if limit.lower is not None else -X
        shifted = curve(to_fmpq(end) + way)
        yield shifted, Range(zero, one)
        yield reverse_polynomial(shifted), Range(zero, one)
    else:
        yield fmpq_poly([-1]), Range(zero, one)  # no certificate: nothing is positive


def reverse_polynomial(curve: fmpq_poly) -> fmpq_poly:
    """x**n Q(1/x)."""
    return fmpq_poly(list(reversed(curve.coeffs())))
