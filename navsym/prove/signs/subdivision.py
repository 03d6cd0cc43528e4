"""Signs by balls on an adaptively divided box, with a mean-value form where plain balls are too wide."""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp
from flint import arb

from navsym.core.balls import DEFAULT_BITS, Tape, derivatives, enclose, exact_ball, hull, precision, tape
from navsym.prove.identities.numbers import is_zero
from navsym.prove.sampling.points import Range
from navsym.prove.signs.exact import UNKNOWN, Limits, Sign, SignProof


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
        halves = split_piece(program, piece, list(slopes))
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


def split_piece(
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


# Signs near zeros: a function that vanishes at an exact point is decided by its first derivative that does not.
#
# Near an end ``a`` of the range ``f(x) = (x - a)^k f^(k)(xi)/k!`` when f and its first k - 1 derivatives
# vanish at a, which the normal form proves; a ball of the k-th derivative settles the sign there.


MAX_CONTACT_ORDER = 8
MOST_OPERATIONS = 500


def end_contact(expression: sp.Expr, limits: Limits, wanted: Sign, budget: int, depth: int) -> SignProof:
    """One symbol: f vanishes at an end, and its first nonzero derivative there decides.

    Near the end f(x) = (x - a)^k f^(k)(xi)/k!, so a ball of the k-th derivative on a
    neighbourhood settles the sign there; the rest of the range is left to balls.
    """
    if len(limits) != 1:
        return UNKNOWN
    ((symbol, limit),) = limits.items()
    if limit.lower is None or limit.upper is None:
        return UNKNOWN
    orders = {end: contact_order(expression, symbol, end) for end in (limit.lower, limit.upper)}
    if None in orders.values() or not any(orders.values()):
        return UNKNOWN
    left, right = orders[limit.lower] or 0, orders[limit.upper] or 0
    return contact_pieces(expression, symbol, limit, (left, right), budget)


def contact_order(expression: sp.Expr, symbol: sp.Symbol, end: sp.Expr) -> int | None:
    """Number of derivatives, from the zeroth, that vanish exactly at the end."""
    derivative = expression
    for order in range(MAX_CONTACT_ORDER):
        if derivative.count_ops() > MOST_OPERATIONS:
            return None
        value = derivative.subs(symbol, end)
        if value.has(sp.nan, sp.zoo, sp.oo) or not exact_ball(value, 256).is_finite():
            return None
        if not exact_ball(value, 256).contains(0) or not is_zero(value):
            return order
        derivative = sp.diff(derivative, symbol)
    return None


def contact_pieces(
    expression: sp.Expr, symbol: sp.Symbol, limit: Range, orders: tuple[int, int], budget: int
) -> SignProof:
    lower, upper = limit.lower, limit.upper
    assert lower is not None and upper is not None
    width = upper - lower
    program = tape(expression)
    for halvings in range(1, 24):
        share = sp.Rational(1, 2**halvings)
        near_left = lower + width * share if orders[0] else lower
        near_right = upper - width * share if orders[1] else upper
        if orders[0] and not derivative_sign(program, symbol, lower, near_left, orders[0], False):
            continue
        if orders[1] and not derivative_sign(program, symbol, near_right, upper, orders[1], orders[1] % 2 == 1):
            continue
        inside = {symbol: Range(near_left, near_right)}
        rest = subdivide(expression, inside, Sign.POSITIVE, budget)
        if not rest.at_least(Sign.POSITIVE):
            return UNKNOWN
        attained = (orders[0] and not limit.open_lower and not (limit.nonzero and lower == 0)) or orders[1]
        sign = Sign.NONNEGATIVE if attained else Sign.POSITIVE
        return SignProof(sign, f"zero of order {orders} at the ends, balls inside", rest.boxes)
    return UNKNOWN


def derivative_sign(
    program: Tape, symbol: sp.Symbol, lower: sp.Expr, upper: sp.Expr, order: int, negative: bool
) -> bool:
    ball = derivatives(program, {symbol: hull(lower, upper)}, symbol, order)[order]
    return bool(ball < 0) if negative else bool(ball > 0)


def guess_points(limit: Range) -> list[sp.Expr]:
    """Exact points inside the range at which formulas like to vanish."""
    guesses = [
        sp.Integer(0),
        sp.Integer(1),
        sp.Integer(-1),
        sp.E,
        1 / sp.E,
        sp.Integer(2),
        sp.Integer(-2),
        sp.Rational(1, 2),
        sp.Integer(3),
        *(sp.pi * sp.Rational(k, 4) for k in range(-8, 9)),
    ]
    if limit.lower is not None and limit.upper is not None:
        guesses.insert(0, (limit.lower + limit.upper) / 2)
    ends = (limit.lower, limit.upper)
    return [guess for guess in dict.fromkeys(guesses) if guess not in ends and limit.contains(guess)]
