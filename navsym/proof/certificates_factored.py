"""Certificates of rational functions in one symbol that touch zero, or have no last end: squares taken out.

``f = S**2 (x - a) (b - x) Q/D**2`` is an identity, and Q is positive on the closed range; the checker replays both.
Beyond a last end Q is looked at through its reversed polynomial: Q > 0 for x >= a when Q(a + y) and y**n Q(a + 1/y)
are positive for y in [0, 1].
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import sympy as sp
from flint import fmpq, fmpq_poly

from navsym.proof.certificates import identity_certificate, positivity_certificate
from navsym.proof.sampling.points import Range
from navsym.proof.signs.real_roots import UndecidedError, value_of
from navsym.proof.signs.substitutions import carried, closed_ends

X = fmpq_poly([0, 1])


def factored_certificate(
    expression: sp.Expr, symbol: sp.Symbol, limit: Range, strict: bool
) -> Mapping[str, Any] | None:
    """``expression >= 0``, or ``> 0``, on the range of its symbol; None where it has another form."""
    if limit.integer or not expression.is_rational_function(symbol) or symbol not in expression.free_symbols:
        return None
    try:
        found = carried((expression,), symbol, limit)
    except UndecidedError:
        return None
    if found is None:
        return None
    top, bottom = found.fractions[0]
    square, ends, rest = parted(top * bottom, limit, strict)
    product = sp.Mul(value_of(square, symbol) ** 2, *(value_of(end, symbol) for end in ends), value_of(rest, symbol))
    parts = [identity_certificate(expression, product / value_of(bottom, symbol) ** 2)]
    for curve, box in covers(rest, limit):
        parts.append(positivity_certificate(value_of(curve, symbol), {symbol: box}))
    return {"kind": "all", "of": [dict(part) for part in parts if part]} if all(parts) else None


def parted(curve: fmpq_poly, limit: Range, strict: bool) -> tuple[fmpq_poly, list[fmpq_poly], fmpq_poly]:
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
        linear = sign * (X - fmpq(int(end.p), int(end.q)))
        if rest % linear == 0:
            ends, rest = [*ends, linear], rest / linear
    return square, ends, rest


def covers(curve: fmpq_poly, limit: Range) -> Iterator[tuple[fmpq_poly, Range]]:
    """Polynomials and closed boxes on which they must be positive for the polynomial to be so on the range."""
    zero, one = sp.Integer(0), sp.Integer(1)
    if limit.lower is not None and limit.upper is not None:
        yield curve, Range(limit.lower, limit.upper)
        return
    if limit.lower is None and limit.upper is None:
        yield curve, Range(-one, one)
        yield reversed_polynomial(curve), Range(-one, one)  # of even degree, or it would change its sign
        return
    end = limit.lower if limit.lower is not None else limit.upper
    if isinstance(end, sp.Rational):
        way = X if limit.lower is not None else -X
        shifted = curve(fmpq(int(end.p), int(end.q)) + way)
        yield shifted, Range(zero, one)
        yield reversed_polynomial(shifted), Range(zero, one)
    else:
        yield fmpq_poly([-1]), Range(zero, one)  # no certificate: nothing is positive


def reversed_polynomial(curve: fmpq_poly) -> fmpq_poly:
    """x**n Q(1/x)."""
    return fmpq_poly(list(reversed(curve.coeffs())))
