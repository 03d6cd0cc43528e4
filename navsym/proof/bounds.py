"""Inequalities over boxes: ball subdivision, exact products, monotonicity and contacts.

``prove_sign(f, box)`` shows that an expression is positive, or nonnegative, on a whole box:

* products by the signs of their factors, exactly;
* balls on an adaptively divided box, with a mean-value form where plain balls are too wide;
* monotone in one symbol: reduced to the end at which it is smallest;
* a zero at an end of the range, f(a) = f'(a) = … = 0, by the sign of the first derivative that
  does not vanish, on a neighbourhood, and by balls on the rest.

Every step is rigorous; what none of them settles comes back as unknown.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import IntEnum

import sympy as sp
from flint import arb, fmpq

from navsym.claims.statement import Box
from navsym.proof.balls import (
    DEFAULT_BITS,
    Tape,
    UnsupportedError,
    derivatives,
    enclose,
    exact_ball,
    hull,
    precision,
    tape,
)
from navsym.proof.normal_form import OutsideLanguageError, linear_terms, vanishes_identically
from navsym.proof.products import as_product
from navsym.proof.sampling import Range, ranges

Limits = Mapping[sp.Symbol, Range]


class Sign(IntEnum):
    """What is known of an expression on a box."""

    UNKNOWN = 0
    NONNEGATIVE = 1
    POSITIVE = 2


@dataclass(frozen=True, slots=True)
class SignProof:
    """A sign with its reason; ``boxes`` counts the balls that were needed."""

    sign: Sign
    reason: str = ""
    boxes: int = 0
    exact: bool = False  # no ball subdivision was used

    def at_least(self, wanted: Sign) -> bool:
        return self.sign >= wanted


UNKNOWN = SignProof(Sign.UNKNOWN)
MAX_DEPTH = 4
MAX_CONTACT_ORDER = 8


def prove_sign(
    expression: sp.Expr, box: Box, wanted: Sign = Sign.NONNEGATIVE, budget: int = 4000
) -> SignProof:
    """Prove that the expression is nonnegative (or positive) on the box, or return unknown."""
    expression = sp.sympify(expression, strict=True)
    limits = ranges(sorted(expression.free_symbols, key=str), box)
    try:
        return attempt(expression, limits, wanted, budget, 0)
    except (UnsupportedError, OutsideLanguageError):
        return UNKNOWN


def attempt(expression: sp.Expr, limits: Limits, wanted: Sign, budget: int, depth: int) -> SignProof:
    """One level of the search; the cheap and exact ways come first."""
    if not expression.free_symbols:
        return constant_sign(expression)
    if negative_somewhere(expression, limits):
        return UNKNOWN
    product = as_product(expression) if depth == 0 else None
    if product is not None:
        by_product = product_sign(product, limits, budget, depth)
        if by_product.at_least(wanted):
            return replace(by_product, reason=f"product form {product}")
    by_factors = product_sign(expression, limits, budget, depth)
    if by_factors.at_least(wanted):
        return by_factors
    for exact_way in (angle_sign, bounded_terms, multilinear_sign):
        by_range = exact_way(expression, limits)
        if by_range.at_least(wanted):
            return by_range
    by_balls = subdivide(expression, limits, wanted, budget)
    if by_balls.at_least(wanted):
        return by_balls
    if depth >= MAX_DEPTH:
        return UNKNOWN
    for way in (end_contact, monotone, inner_contact):
        proof = way(expression, limits, wanted, budget, depth)
        if proof.at_least(wanted):
            return proof
    return UNKNOWN


def negative_somewhere(expression: sp.Expr, limits: Limits) -> bool:
    """A look at a few inner points, to give up early on what is not true."""
    program = tape(expression)
    for share in (fmpq(1, 2), fmpq(1, 7), fmpq(12, 13)):
        with precision(DEFAULT_BITS):
            point = {symbol: inner_value(limit, share) for symbol, limit in limits.items()}
        if enclose(program, point) < 0:
            return True
    return False


def inner_value(limit: Range, share: fmpq) -> arb:
    """A point inside the range, up to rounding; only a guess is built on it."""
    lower = None if limit.lower is None else exact_ball(limit.lower).mid()
    upper = None if limit.upper is None else exact_ball(limit.upper).mid()
    if lower is not None and upper is not None:
        return arb(lower + (upper - lower) * share)
    stretched = arb(share / (1 - share))
    if lower is not None:
        return arb(lower + stretched)
    return arb(upper - stretched) if upper is not None else stretched - arb(2) / 3


# -- constants ---------------------------------------


def constant_sign(expression: sp.Expr) -> SignProof:
    """Sign of a number: by a ball, or exactly zero by the normal form."""
    for bits in (64, 256, 1024):
        ball = exact_ball(expression, bits)
        if ball > 0:
            return SignProof(Sign.POSITIVE, "a positive number", exact=True)
        if ball < 0:
            return UNKNOWN
    if vanishes_identically(expression):
        return SignProof(Sign.NONNEGATIVE, "zero", exact=True)
    return UNKNOWN


# -- products ---------------------------------------


def product_sign(expression: sp.Expr, limits: Limits, budget: int, depth: int) -> SignProof:
    """Sign of a product, a power or a symbol from its parts."""
    if isinstance(expression, sp.Symbol):
        return symbol_sign(limits[expression])
    if isinstance(expression, sp.Pow):
        return power_sign(expression, limits, budget, depth)
    if isinstance(expression, sp.Add):
        return sum_sign(expression, limits, budget, depth)
    if not isinstance(expression, sp.Mul):
        return UNKNOWN
    worst, negative, exact, boxes = Sign.POSITIVE, False, True, 0
    for factor in expression.args:
        proof, flipped = factor_sign(factor, limits, budget, depth)
        if proof.sign == Sign.UNKNOWN:
            return UNKNOWN
        negative ^= flipped
        worst, exact, boxes = min(worst, proof.sign), exact and proof.exact, boxes + proof.boxes
    if negative:
        return UNKNOWN
    return SignProof(worst, "sign of every factor", boxes, exact)


def sum_sign(expression: sp.Add, limits: Limits, budget: int, depth: int) -> SignProof:
    """A sum of nonnegative terms, of which one may be positive."""
    best, boxes, exact = Sign.NONNEGATIVE, 0, True
    for term in expression.args:
        own = {s: limits[s] for s in term.free_symbols}
        if not term.free_symbols:
            proof = constant_sign(term)
        elif isinstance(term, sp.Add):
            proof = UNKNOWN
        else:
            proof = product_sign(term, own, 64, min(depth + 1, MAX_DEPTH))
        if proof.sign == Sign.UNKNOWN:
            return UNKNOWN
        best, boxes, exact = max(best, proof.sign), boxes + proof.boxes, exact and proof.exact
    return SignProof(best, "sum of nonnegative terms", boxes, exact)


def factor_sign(factor: sp.Expr, limits: Limits, budget: int, depth: int) -> tuple[SignProof, bool]:
    """Sign of a factor or of its negative; true when it is the negative."""
    if depth >= MAX_DEPTH:
        return UNKNOWN, False
    own = {s: limits[s] for s in factor.free_symbols}
    proof = attempt(factor, own, Sign.NONNEGATIVE, budget // 4, depth + 1)
    if proof.sign != Sign.UNKNOWN:
        return proof, False
    return attempt(-factor, own, Sign.NONNEGATIVE, budget // 4, depth + 1), True


def symbol_sign(limits: Range) -> SignProof:
    if limits.lower is None:
        return UNKNOWN
    lower = constant_sign(limits.lower)
    if lower.sign == Sign.NONNEGATIVE and (limits.open_lower or limits.nonzero):
        return SignProof(Sign.POSITIVE, "range of the symbol", exact=True)
    return lower


def power_sign(expression: sp.Pow, limits: Limits, budget: int, depth: int) -> SignProof:
    base, exponent = expression.args
    if not isinstance(exponent, sp.Rational):
        return UNKNOWN
    even = exponent.q == 1 and exponent.p % 2 == 0
    if even and exponent > 0 and is_entire(base):
        ways = [way(value, limits) for value in (base, -base) for way in (angle_sign, multilinear_sign)]
        best = max((way.sign for way in ways), default=Sign.UNKNOWN)
        return SignProof(max(best, Sign.NONNEGATIVE), "even power", exact=True)
    proof, flipped = factor_sign(base, limits, budget, depth)
    if exponent.q != 1 and (flipped or proof.sign == Sign.UNKNOWN):
        return UNKNOWN
    if exponent < 0 and proof.sign != Sign.POSITIVE:
        return UNKNOWN  # might divide by zero
    if proof.sign == Sign.UNKNOWN and not is_entire(base):
        return UNKNOWN  # tan(x)**2 is nonnegative only where it exists
    if even:
        strict = proof.sign == Sign.POSITIVE
        return SignProof(
            Sign.POSITIVE if strict else Sign.NONNEGATIVE, "even power", proof.boxes, proof.exact
        )
    return UNKNOWN if flipped else SignProof(proof.sign, "power of a signed base", proof.boxes, proof.exact)


ENTIRE = (sp.Add, sp.Mul, sp.sin, sp.cos, sp.exp, sp.sinh, sp.cosh, sp.tanh, sp.atan, sp.Symbol, sp.Number)


def is_entire(expression: sp.Expr) -> bool:
    """True when the expression is defined and smooth for all real values of its symbols."""
    if expression in (sp.pi, sp.E):
        return True
    if isinstance(expression, sp.Pow):
        whole = isinstance(expression.exp, sp.Integer) and expression.exp > 0
        return whole and is_entire(expression.base)
    return isinstance(expression, ENTIRE) and all(is_entire(a) for a in expression.args)


def bounded_terms(expression: sp.Expr, limits: Limits) -> SignProof:
    """A sum whose terms have exact least values: c sin(u) >= -|c|, c u**2 >= 0, c >= c."""
    least = [least_value(term) for term in sp.Add.make_args(expression)]
    if any(value is None for value in least):
        return UNKNOWN
    proof = constant_sign(sp.Add(*least))
    return SignProof(proof.sign, "least values of the terms", exact=True)


def least_value(term: sp.Expr) -> sp.Expr | None:
    """An exact lower bound of one term for all real values of its symbols, or None."""
    coefficient, rest = term.as_independent(*term.free_symbols, as_Add=False)
    if not term.free_symbols:
        return term
    if not is_entire(rest):
        return None
    if isinstance(rest, (sp.sin, sp.cos)):
        return -sp.Abs(coefficient)
    if isinstance(rest, sp.Pow) and rest.exp % 2 == 0:
        bounded = isinstance(rest.base, (sp.sin, sp.cos))
        if constant_sign(coefficient).sign != Sign.UNKNOWN:
            return sp.Integer(0)
        return coefficient if bounded and constant_sign(-coefficient).sign != Sign.UNKNOWN else None
    return None


# -- sine and cosine of an angle whose exact range is known ---------------------------------------


def angle_sign(expression: sp.Expr, limits: Limits) -> SignProof:
    """sin(u) or cos(u), or its negative, when the exact range of u lies between two zeros."""
    negative = expression.could_extract_minus_sign() and isinstance(-expression, (sp.sin, sp.cos))
    inner = -expression if negative else expression
    if not isinstance(inner, (sp.sin, sp.cos)):
        return UNKNOWN
    angle = inner.args[0] if isinstance(inner, sp.sin) else inner.args[0] + sp.pi / 2
    values = corner_values(angle, limits)
    if values is None:
        return UNKNOWN
    half_turn = middle_half_turn(values)
    if (half_turn % 2 == 1) != negative:
        return UNKNOWN
    return range_sign(angle, values, limits, (half_turn * sp.pi, (half_turn + 1) * sp.pi))


def middle_half_turn(values: list[sp.Expr]) -> int:
    """k with the middle of the values between k pi and (k + 1) pi: a guess, checked afterwards."""
    middle = float(sum((value.evalf(20) for value in values), sp.Integer(0))) / len(values)
    return math.floor(middle / math.pi)


def range_sign(
    angle: sp.Expr, values: list[sp.Expr], limits: Limits, allowed: tuple[sp.Expr, sp.Expr]
) -> SignProof:
    """Positive when the angle stays strictly inside the allowed range, nonnegative when it touches."""
    strict = True
    for margin in (lambda value: value - allowed[0], lambda value: allowed[1] - value):
        signs = {constant_sign(margin(value)).sign for value in values}
        if Sign.UNKNOWN in signs:
            return UNKNOWN
        # A corner on the limit may lie on an open end, as sin(T v) does at T = 0 for T > 0.
        strict &= Sign.NONNEGATIVE not in signs or monomial_sign(margin(angle), limits) == Sign.POSITIVE
    return SignProof(Sign.POSITIVE if strict else Sign.NONNEGATIVE, "exact range of the angle", exact=True)


def multilinear_sign(expression: sp.Expr, limits: Limits) -> SignProof:
    """A multilinear expression is least at a corner of the box."""
    if not isinstance(expression, (sp.Add, sp.Mul)):
        return UNKNOWN
    values = corner_values(expression, limits)
    if values is None:
        return UNKNOWN
    signs = [constant_sign(value).sign for value in values]
    return SignProof(min(signs), "least at a corner of the box", exact=True)


def monomial_sign(expression: sp.Expr, limits: Limits) -> Sign:
    """Sign of a product of numbers, symbols and multilinear factors, such as T (1/2 - v/4)."""
    spread = sp.expand(expression)
    gathered = sp.factor_terms(spread)
    sign = Sign.POSITIVE if sp.expand(gathered - spread) == 0 else Sign.UNKNOWN
    for factor in sp.Mul.make_args(gathered):
        if factor.is_number:
            sign = min(sign, constant_sign(factor).sign)
        elif isinstance(factor, sp.Symbol):
            sign = min(sign, symbol_sign(limits[factor]).sign)
        else:
            sign = min(sign, multilinear_sign(factor, limits).sign)
    return sign


def corner_values(angle: sp.Expr, limits: Limits) -> list[sp.Expr] | None:
    """Values of a multilinear expression at the corners of the box, which hold its extremes.

    None when the expression is not multilinear, the box is not bounded or it has many corners.
    """
    symbols = sorted(angle.free_symbols, key=str)
    if len(symbols) > 4 or any(limits[s].lower is None or limits[s].upper is None for s in symbols):
        return None
    for monomial in linear_terms(angle):
        for base, exponent in monomial:
            if exponent != 1 or not (isinstance(base, sp.Symbol) or base.is_number):
                return None
    corners: list[dict[sp.Symbol, sp.Expr]] = [{}]
    for symbol in symbols:
        ends = (limits[symbol].lower, limits[symbol].upper)
        corners = [{**corner, symbol: end} for corner in corners for end in ends]
    return [angle.subs(corner) for corner in corners]


# -- balls ---------------------------------------


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
        return [
            {**piece, widest: arb(lower).union(middle)},
            {**piece, widest: middle.union(arb(upper))},
        ]


# -- zeros at an end of the range ---------------------------------------


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
        value = derivative.subs(symbol, end)
        if value.has(sp.nan, sp.zoo, sp.oo) or not exact_ball(value, 256).is_finite():
            return None
        if not exact_ball(value, 256).contains(0) or not vanishes_identically(value):
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
        if orders[1] and not derivative_sign(
            program, symbol, near_right, upper, orders[1], orders[1] % 2 == 1
        ):
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


def inner_contact(expression: sp.Expr, limits: Limits, wanted: Sign, budget: int, depth: int) -> SignProof:
    """One symbol: a zero inside the range at a guessed exact point; both sides are proved apart."""
    if len(limits) != 1 or wanted > Sign.NONNEGATIVE:
        return UNKNOWN
    ((symbol, limit),) = limits.items()
    for point in guessed_points(limit):
        if contact_order(expression, symbol, point) in (None, 0):
            continue
        parts = [Range(limit.lower, point, limit.open_lower), Range(point, limit.upper)]
        proofs = [attempt(expression, {symbol: part}, wanted, budget, depth + 1) for part in parts]
        if all(proof.at_least(wanted) for proof in proofs):
            boxes = sum(proof.boxes for proof in proofs)
            return SignProof(Sign.NONNEGATIVE, f"zero at {symbol} = {point}, both sides apart", boxes)
    return UNKNOWN


def guessed_points(limit: Range) -> list[sp.Expr]:
    """Exact points inside the range at which formulas like to vanish."""
    guesses = [
        sp.Integer(0),
        sp.Integer(1),
        sp.Integer(-1),
        *(sp.pi * sp.Rational(k, 4) for k in range(-8, 9)),
    ]
    if limit.lower is not None and limit.upper is not None:
        guesses.insert(0, (limit.lower + limit.upper) / 2)
    ends = (limit.lower, limit.upper)
    return [guess for guess in dict.fromkeys(guesses) if guess not in ends and limit.contains(guess)]


# -- monotone in one symbol ---------------------------------------


def monotone(expression: sp.Expr, limits: Limits, wanted: Sign, budget: int, depth: int) -> SignProof:
    """Reduce to the end of one range at which the expression is smallest."""
    for symbol, limit in limits.items():
        slope = sp.diff(expression, symbol)
        for direction, end in ((1, limit.lower), (-1, limit.upper)):
            if end is None:
                continue
            at_end = expression.subs(symbol, end)
            if at_end.has(sp.nan, sp.zoo, sp.oo):
                continue
            rest = {s: limits[s] for s in at_end.free_symbols}
            floor = attempt(at_end, rest, Sign.NONNEGATIVE, budget // 4, depth + 1)
            if floor.sign == Sign.UNKNOWN:
                continue
            rising = attempt(direction * slope, limits, Sign.NONNEGATIVE, budget // 4, depth + 1)
            if rising.sign == Sign.UNKNOWN:
                continue
            sign = monotone_sign(floor, rising, limit, direction)
            if sign >= wanted:
                exact = floor.exact and rising.exact
                return SignProof(sign, f"monotone in {symbol}", floor.boxes + rising.boxes, exact)
    return UNKNOWN


def monotone_sign(floor: SignProof, rising: SignProof, limit: Range, direction: int) -> Sign:
    """Positive when the end value is, or when the end is left out and the slope is positive."""
    if floor.sign == Sign.POSITIVE:
        return Sign.POSITIVE
    left_out = direction == 1 and (limit.open_lower or (limit.nonzero and limit.lower == 0))
    return Sign.POSITIVE if left_out and rising.sign == Sign.POSITIVE else Sign.NONNEGATIVE
