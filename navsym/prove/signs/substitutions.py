"""Expressions in one symbol as rational functions over Q of one number u, with the exact range of u.

u is the symbol x itself, a root of it or of a + b x, exp(x/d), or tan(theta/2) of an angle theta = x/d (or pi x/d).
Each of these rises or falls with x, so that the range of u follows from the ends of that of x; an angle that turns
past an odd multiple of pi, where the tangent is infinite, has its range cut there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import floor
from typing import TypeAlias

import sympy as sp
from flint import fmpq, fmpq_mpoly, fmpq_poly

from navsym.core.balls import exact_ball
from navsym.core.errors import NavsymError
from navsym.core.exact import to_fmpq, to_fraction
from navsym.prove.identities.converter import Converter, Quotient
from navsym.prove.identities.ingredients import Monomial
from navsym.prove.identities.transcendental import largest_exponent
from navsym.prove.sampling.points import Range
from navsym.prove.signs.exact import Sign, constant_sign
from navsym.prove.signs.half_angles import HalfAngles, replace_angles
from navsym.prove.signs.products import monomial_expression
from navsym.prove.signs.real_roots import (
    MOST_DEGREE,
    RealNumber,
    UndecidedError,
    compare_numbers,
    enclose_number,
    rational_number,
)

#: Functions that are no rational functions of one u.
BENT = (sp.Abs, sp.sign, sp.Max, sp.Min, sp.atan2)

End: TypeAlias = sp.Expr | None
Fraction: TypeAlias = tuple[fmpq_poly, fmpq_poly]


@dataclass(frozen=True, slots=True, eq=False)
class Interval:
    """Values of u from ``lower`` to ``upper``, None at infinity.

    closed : whether the ends belong to it; one at infinity does where the angle is an odd multiple of pi
    ends   : the symbol at the ends, None at infinity
    back   : the symbol as a formula of u
    """

    lower: RealNumber | None
    upper: RealNumber | None
    closed: tuple[bool, bool]
    ends: tuple[End, End]
    back: Callable[[sp.Expr], sp.Expr]


@dataclass(frozen=True, slots=True, eq=False)
class Substitution:
    """Expressions as (top, bottom) of one u, coprime, and the range of u in pieces."""

    fractions: tuple[Fraction, ...]
    pieces: tuple[Interval, ...]


def substitute_one_number(expressions: Sequence[sp.Expr], symbol: sp.Symbol, limit: Range) -> Substitution | None:
    """The expressions by one u, wherever they exist; None where there is no such u.

    Raises UndecidedError where ends of ranges cannot be compared.
    """
    whole = sp.Tuple(*expressions)
    if not whole.free_symbols <= {symbol} or whole.has(*BENT) or largest_exponent(whole) > MOST_DEGREE:
        return None
    try:
        found = replace_angles(whole)
        if found is None or found[0].has(sp.zoo, sp.nan, sp.oo):
            return None
        rational, angles = found
        converter = Converter(list(rational.args))
        quotients = [converter.convert(part) for part in rational.args]
    except (NavsymError, OverflowError, ZeroDivisionError):
        return None
    return (
        carry_tangent(converter, quotients, symbol, limit, angles)
        if angles.tangents
        else (carry_generators(converter, quotients, symbol, limit))
    )


def carry_generators(
    converter: Converter, quotients: Sequence[Quotient], symbol: sp.Symbol, limit: Range
) -> Substitution | None:
    """u by the generators that occur in the ring of the normal form."""
    names, used = converter.generator_names(), used_places(quotients)
    kinds = {names[place][0] for place in used}
    if kinds <= {"x"} and symbol in converter.found.symbols:
        return carry_symbol(converter, quotients, symbol, limit)
    if kinds == {"e"} and len(used) == 1:
        monomial, share = list(converter.found.exponents.items())[int(names[min(used)][1:])]
        return carry_exponential(quotients, min(used), monomial, share, limit, symbol)
    if kinds <= {"x", "g"} and len(used - {0}) == 1 and converter.found.symbols.get(symbol) == 1:
        return carry_root(converter, quotients, max(used), symbol, limit)
    return None


def used_places(quotients: Sequence[Quotient]) -> set[int]:
    """Places of the generators that occur."""
    parts = [part for quotient in quotients for part in (quotient.numerator, quotient.denominator)]
    return {place for part in parts for place, degree in enumerate(part.degrees()) if degree > 0}


def fraction_of(quotient: Quotient, images: dict[int, fmpq_poly]) -> Fraction:
    """Numerator and denominator with polynomials of u for the generators, in lowest terms."""
    top, bottom = (substitute_images(part, images) for part in (quotient.numerator, quotient.denominator))
    if bottom.degree() < 0:
        raise UndecidedError
    common = top.gcd(bottom)
    return top / common, bottom / common


def substitute_images(polynomial: fmpq_mpoly, images: dict[int, fmpq_poly]) -> fmpq_poly:
    """The polynomial with images in u for its generators."""
    total = fmpq_poly([0])
    for exponents, value in polynomial.to_dict().items():
        term = fmpq_poly([value])
        for place, image in images.items():
            term = term * image ** int(exponents[place])
        total = total + term
    return total


U = fmpq_poly([0, 1])


# -- the symbol, roots, exponentials ---------------------------------------


def closed_ends(limit: Range) -> tuple[bool, bool]:
    """Whether the ends of a range belong to it."""
    lower = limit.lower is not None and not limit.open_lower and not (limit.nonzero and limit.lower == 0)
    return lower, limit.upper is not None and not (limit.nonzero and limit.upper == 0)


def rising_interval(
    limit: Range,
    closed: tuple[bool, bool],
    forth: Callable[[sp.Expr], sp.Expr],
    back: Callable[[sp.Expr], sp.Expr],
    least: RealNumber | None = None,
) -> Interval:
    """The piece of an u that rises with the symbol; ``least`` is its limit towards minus infinity."""
    lower = least if limit.lower is None else enclose_number(forth(limit.lower))
    upper = None if limit.upper is None else enclose_number(forth(limit.upper))
    return Interval(lower, upper, closed, (limit.lower, limit.upper), back)


def carry_symbol(
    converter: Converter, quotients: Sequence[Quotient], symbol: sp.Symbol, limit: Range
) -> Substitution | None:
    """u**q = x; a root is taken only of a symbol that is declared nonnegative."""
    q = converter.found.symbols[symbol]
    place = list(converter.found.symbols).index(symbol)
    fractions = tuple(fraction_of(quotient, {place: U}) for quotient in quotients)
    piece = rising_interval(limit, closed_ends(limit), lambda x: sp.Pow(x, sp.Rational(1, q)), lambda u: u**q)
    return Substitution(fractions, (piece,))


def carry_exponential(
    quotients: Sequence[Quotient], place: int, monomial: Monomial, share: int, limit: Range, symbol: sp.Symbol
) -> Substitution | None:
    """u = exp(x/share)."""
    if monomial_expression(monomial) != symbol:
        return None
    fractions = tuple(fraction_of(quotient, {place: U}) for quotient in quotients)
    piece = rising_interval(
        limit, closed_ends(limit), lambda x: sp.exp(x / share), lambda u: share * sp.log(u), rational_number(fmpq(0))
    )
    return Substitution(fractions, (piece,))


def carry_root(
    converter: Converter, quotients: Sequence[Quotient], place: int, symbol: sp.Symbol, limit: Range
) -> Substitution | None:
    """u**q = a + b x, where that is not negative."""
    radicand, q = converter.roots[int(converter.generator_names()[place][1:])]
    if is_odd_power(radicand, symbol):
        return carry_power(converter, quotients, place, symbol, limit)
    slope, start = sp.diff(radicand, symbol), radicand.subs(symbol, 0)
    if radicand.free_symbols != {symbol} or not (slope.is_Rational and start.is_Rational and slope != 0):
        return None
    if sp.expand(radicand - start - slope * symbol) != 0:
        return None
    a, b = (to_fmpq(n) for n in (start, slope))
    x = list(converter.found.symbols).index(symbol)
    fractions = tuple(fraction_of(quotient, {x: (U**q - a) / b, place: U}) for quotient in quotients)
    ends = (limit.lower, limit.upper) if b > 0 else (limit.upper, limit.lower)
    closed = closed_ends(limit) if b > 0 else closed_ends(limit)[::-1]
    values = tuple(None if end is None else start + slope * end for end in ends)
    if values[1] is not None and constant_sign(values[1]).sign == Sign.UNKNOWN:
        return None  # it exists nowhere, or that is not known
    inside = values[0] is not None and constant_sign(values[0]).sign != Sign.UNKNOWN
    if not inside and values[0] is not None and not exact_ball(values[0]) < 0:
        return None
    least = values[0] if inside else sp.Integer(0)
    places = [
        None if value is None else enclose_number(sp.Pow(value, sp.Rational(1, q))) for value in (least, values[1])
    ]
    closed = (closed[0] or not inside, closed[1])
    last = ends[0] if inside else -start / slope
    return Substitution(
        fractions, (Interval(places[0], places[1], closed, (last, ends[1]), lambda u: (u**q - start) / slope),)
    )


def is_odd_power(radicand: sp.Expr, symbol: sp.Symbol) -> bool:
    """True for x**3, x**5 and so on."""
    base, exponent = radicand.as_base_exp()
    return bool(base == symbol and exponent.is_Integer and exponent > 1 and exponent % 2 == 1)


def carry_power(
    converter: Converter, quotients: Sequence[Quotient], place: int, symbol: sp.Symbol, limit: Range
) -> Substitution | None:
    """u = x**(1/q) for a root of an odd power x**k, which exists where x is not negative: it is u**k."""
    radicand, q = converter.roots[int(converter.generator_names()[place][1:])]
    x = list(converter.found.symbols).index(symbol)
    images = {x: U**q, place: U ** int(radicand.exp)}
    fractions = tuple(fraction_of(quotient, images) for quotient in quotients)
    if limit.upper is not None and constant_sign(limit.upper).sign != Sign.POSITIVE:
        return None
    inside = limit.lower is not None and constant_sign(limit.lower).sign != Sign.UNKNOWN
    if not inside and limit.lower is not None and not exact_ball(limit.lower) < 0:
        return None
    cut = limit if inside else replace(limit, lower=sp.Integer(0), open_lower=False)
    piece = rising_interval(cut, closed_ends(cut), lambda x: sp.Pow(x, sp.Rational(1, q)), lambda u: u**q)
    return Substitution(fractions, (piece,))


# -- angles ---------------------------------------


def carry_tangent(
    converter: Converter, quotients: Sequence[Quotient], symbol: sp.Symbol, limit: Range, angles: HalfAngles
) -> Substitution | None:
    """u = tan(theta/2) for the one angle theta = c x that occurs."""
    if len(angles.tangents) != 1 or set(converter.found.symbols) != set(angles.tangents.values()):
        return None
    ((monomial, t),) = angles.tangents.items()
    speed = monomial_expression(monomial) / symbol / angles.denominators[monomial]
    place = list(converter.found.symbols).index(t)
    if speed.free_symbols or converter.found.symbols[t] != 1 or not used_places(quotients) <= {place}:
        return None
    if constant_sign(speed).sign != Sign.POSITIVE:
        return None
    fractions = tuple(fraction_of(quotient, {place: U}) for quotient in quotients)
    return Substitution(fractions, tuple(split_turns(limit, speed)))


def split_turns(limit: Range, speed: sp.Expr) -> Iterator[Interval]:
    """The range of theta = speed x, one turn of it where it is longer, cut at odd multiples of pi."""
    turn = 2 * sp.pi / speed
    closed, (lower, upper) = closed_ends(limit), (limit.lower, limit.upper)
    if lower is None:
        lower, closed = (-turn / 2 if upper is None else upper - turn), (False, closed[1])
    if upper is None or compare_numbers(enclose_number(upper - lower), enclose_number(turn)) >= 0:
        if limit.parted:
            raise UndecidedError  # one turn stands for all, but zero is left out of one of them only
        upper, closed = lower + turn, (closed[0], True)
    k = floor(to_fraction(exact_ball(lower / turn + sp.S.Half, 256)))
    k += compare_with_cut(lower, k + 1, turn) >= 0
    k -= compare_with_cut(lower, k, turn) < 0
    if compare_with_cut(lower, k, turn) * compare_with_cut(lower, k + 1, turn) > 0:
        raise UndecidedError  # the number of the turn was guessed too roughly
    while True:
        side = compare_with_cut(upper, k + 1, turn)
        last = upper if side <= 0 else odd_half_turn(k + 1, turn)
        yield cut_arc((lower, last), (closed[0], closed[1] or side > 0), k, turn)
        if side <= 0:
            return
        lower, closed, k = last, (True, closed[1]), k + 1


def compare_with_cut(value: sp.Expr, k: int, turn: sp.Expr) -> int:
    """-1, 0 or 1 as an exact number lies before, at or behind the k-th cut."""
    return compare_numbers(enclose_number(value), enclose_number(odd_half_turn(k, turn)))


def odd_half_turn(k: int, turn: sp.Expr) -> sp.Expr:
    """Where the k-th half turn before a whole one ends: theta = (2 k - 1) pi."""
    return (k - sp.S.Half) * turn


def cut_arc(ends: tuple[sp.Expr, sp.Expr], closed: tuple[bool, bool], k: int, turn: sp.Expr) -> Interval:
    """The piece between two ends in the turn from (2 k - 1) pi to (2 k + 1) pi, where the tangent is infinite."""
    cuts = (odd_half_turn(k, turn), odd_half_turn(k + 1, turn))
    places = [
        None
        if compare_numbers(enclose_number(end), enclose_number(cut)) == 0
        else enclose_number(sp.tan(sp.pi * end / turn))
        for end, cut in zip(ends, cuts, strict=True)
    ]
    return Interval(places[0], places[1], closed, ends, lambda u: (sp.atan(u) / sp.pi + k) * turn)
