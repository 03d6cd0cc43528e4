"""Signs by balls on an adaptively divided box, with a mean-value form where plain balls are too wide."""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp
from flint import arb

from navsym.proof.balls import DEFAULT_BITS, Tape, derivatives, enclose, hull, precision, tape
from navsym.proof.signs.known import UNKNOWN, Limits, Sign, SignProof


def subdivide(expression: sp.Expr, limits: Limits, wanted: Sign, budget: int) -> SignProof:
    """Divide the box until every piece has a ball of the right sign."""
    program = tape(expression)
    pieces = [initial_piece(limits)]
    slopes = {s: None for s in limits if limits[s].lower is not None and limits[s].upper is not None}
    used, positive = 0, True
    while pieces:
        piece = pieces.pop()
        used += 1
        if used > budget:
            return UNKNOWN
        sign = piece_sign(program, piece, list(slopes))
        if sign >= wanted:
            positive = positive and sign == Sign.POSITIVE
            continue
        halves = split(program, piece, list(slopes))
        if halves is None or len(pieces) > 400:
            return UNKNOWN
        pieces.extend(halves)
    return SignProof(Sign.POSITIVE if positive else Sign.NONNEGATIVE, f"balls on {used} boxes", used)


def initial_piece(limits: Limits) -> dict[sp.Symbol, arb]:
    return {symbol: hull(limit.lower, limit.upper) for symbol, limit in limits.items()}


def piece_sign(program: Tape, piece: Mapping[sp.Symbol, arb], divisible: list[sp.Symbol]) -> Sign:
    plain = enclose(program, piece)
    if plain > 0:
        return Sign.POSITIVE
    if plain >= 0:
        return Sign.NONNEGATIVE
    if not divisible or plain < 0:
        return Sign.UNKNOWN
    return ball_sign(mean_value(program, piece, divisible))


def ball_sign(ball: arb) -> Sign:
    if ball > 0:
        return Sign.POSITIVE
    return Sign.NONNEGATIVE if ball >= 0 else Sign.UNKNOWN


def mean_value(program: Tape, piece: Mapping[sp.Symbol, arb], divisible: list[sp.Symbol]) -> arb:
    """f(centre) + sum of f_i(piece) (x_i - centre_i)."""
    with precision(DEFAULT_BITS):
        centre = dict(piece)
        for symbol in divisible:
            centre[symbol] = arb(piece[symbol].mid())
        value = enclose(program, centre)
        for symbol in divisible:
            slope = derivatives(program, piece, symbol, 1)[1]
            value += slope * (piece[symbol] - centre[symbol])
        return value


def split(
    program: Tape, piece: Mapping[sp.Symbol, arb], divisible: list[sp.Symbol]
) -> list[dict[sp.Symbol, arb]] | None:
    """Two halves along the widest side; None when the piece is too small to go on."""
    with precision(DEFAULT_BITS):
        widest = max(divisible, key=lambda s: float(piece[s].rad()), default=None)
        if widest is None or float(piece[widest].rad()) < 1e-12:
            return None
        middle = arb(piece[widest].mid())
        lower, upper = piece[widest].lower(), piece[widest].upper()
        return [{**piece, widest: arb(lower).union(middle)}, {**piece, widest: middle.union(arb(upper))}]
