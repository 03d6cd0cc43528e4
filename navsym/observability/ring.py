"""Polynomials over the integers in the parameters of a model, and their quotients.

The exact observability of a symbolic system needs nothing but sums, products, exact divisions
and greatest common divisors of polynomials. Matrices come in as sympy and go out as sympy.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import comb, lcm
from typing import Any

import sympy as sp
from flint import Ordering, fmpz_mpoly, fmpz_mpoly_ctx
from flint.utils.flint_exceptions import DomainError as InexactError
from sympy.functions.elementary.trigonometric import TrigonometricFunction

from navsym.core.errors import DomainError, TooLargeError
from navsym.core.rational_functions import (
    Quotient,
    cancel_fraction,
    factor_exactly,
    polynomial_sum,
    powers_apart,
    read_arithmetic,
    replace_square,
)

# Sines and cosines of parameters as polynomials.
#
# With S = sin(x/2), C = cos(x/2) the functions of an angle are quotients of forms in S and C of equal degree,
#
#     sin(n x) = Im (C + i S)^(2n) / (S^2 + C^2)^n,    cos(n x) = Re (C + i S)^(2n) / (S^2 + C^2)^n,
#
# and quotients of equal degree form a field that depends on S/C = tan(x/2) alone: Pythagoras' relation is built
# in, nothing has to be reduced modulo it, and exact division and factors stay what they are for polynomials.
# No angle is lost, x = pi is the point C = 0. A rational multiple r x uses the half of x/q, q the denominator.


#: Largest multiple of an angle, counted in halves of its smallest part.
MULTIPLE = 64


@dataclass(frozen=True, slots=True)
class Angle:
    """A symbol x whose smallest part in the expressions is x/parts."""

    symbol: sp.Symbol
    parts: int

    @property
    def sine(self) -> sp.Expr:
        """sin of half the smallest part: a generator of the ring."""
        return sp.sin(self.symbol / (2 * self.parts))

    @property
    def cosine(self) -> sp.Expr:
        """cos of half the smallest part: the other generator of the ring."""
        return sp.cos(self.symbol / (2 * self.parts))


def angles_of(expressions: Iterable[sp.Basic]) -> tuple[Angle, ...]:
    """The angles under all trigonometric functions, by name; DomainError for other arguments."""
    parts: dict[sp.Symbol, int] = {}
    for expression in expressions:
        for function in expression.atoms(TrigonometricFunction):
            for symbol, factor in linear_parts(function.args[0])[0].items():
                parts[symbol] = lcm(parts.get(symbol, 1), int(factor.q))
    return tuple(Angle(symbol, parts[symbol]) for symbol in sorted(parts, key=str))


def linear_parts(argument: sp.Expr) -> tuple[dict[sp.Symbol, sp.Rational], int]:
    """(factors of the symbols, number of quarter turns) of an argument such as 2*a - b/3 + pi/2."""
    factors: dict[sp.Symbol, sp.Rational] = {}
    turns = sp.Integer(0)
    for term in sp.Add.make_args(sp.expand(argument)):
        factor, rest = term.as_coeff_Mul()
        if isinstance(factor, sp.Rational) and isinstance(rest, sp.Symbol):
            factors[rest] = factor
        elif isinstance(factor, sp.Rational) and rest == sp.pi:
            turns = 2 * factor
        elif term != 0:
            raise DomainError(
                f"expected angles such as 2*a - b + pi/2; got {str(argument)[:60]}; name the angle as a parameter"
            )
    if turns.q != 1:
        raise DomainError(
            f"expected multiples of pi/2 beside a parameter; got {str(argument)[:60]}; name the angle as a parameter"
        )
    return factors, int(turns) % 4


def symbols_outside_angles(expression: sp.Basic) -> set[sp.Basic]:
    """Symbols and pi outside of trigonometric functions."""
    if isinstance(expression, TrigonometricFunction):
        return set()
    if not expression.args:
        return {expression} if isinstance(expression, sp.Symbol) or expression == sp.pi else set()
    return set().union(*(symbols_outside_angles(part) for part in expression.args))


def sine_and_cosine(argument: sp.Expr, angles: Sequence[Angle], half: Mapping[Angle, tuple[Any, Any]]) -> Any:
    """(top of sin, top of cos, common bottom) as polynomials; half : angle -> (S, C)."""
    factors, turns = linear_parts(argument)
    one = next(iter(half.values()))[0] ** 0
    sine, cosine, bottom = 0 * one, one, one
    for angle in angles:
        multiple = factors.get(angle.symbol, sp.Integer(0)) * angle.parts
        if multiple == 0:
            continue
        s, c, b = multiple_angle(int(multiple), *half[angle])
        sine, cosine, bottom = sine * c + cosine * s, cosine * c - sine * s, bottom * b
    for _ in range(turns):
        sine, cosine = cosine, -sine
    return sine, cosine, bottom


def multiple_angle(n: int, S: Any, C: Any) -> tuple[Any, Any, Any]:
    """sin(n x), cos(n x) and their bottom from S = sin(x/2), C = cos(x/2)."""
    power = 2 * abs(n)
    if power > MULTIPLE:
        raise TooLargeError(f"expected multiples of an angle up to {MULTIPLE // 2}; got {n}; rename the angle")
    cosine, sine = 0 * S, 0 * S
    for k in range(power + 1):
        term = comb(power, k) * S**k * C ** (power - k) * (-1 if k % 4 in (2, 3) else 1)
        if k % 2:
            sine += term
        else:
            cosine += term
    return (sine if n > 0 else -sine), cosine, (S * S + C * C) ** abs(n)


Poly = fmpz_mpoly

#: Largest integer exponent that is multiplied out.
EXPONENT = 64


@dataclass(frozen=True, slots=True, eq=False)
class Ring:
    """Z[symbols], graded reverse lexicographic.

    angles  : symbols that stand under sines and cosines; their halves are generators, as explained above
    meaning : symbols that stand for functions -> the functions, put in on the way back
    units   : irreducible polynomials that vanish nowhere in the domain of the model: factors of its denominators,
              and S^2 + C^2 of every angle. Next to numbers they are what may be divided by
    """

    symbols: tuple[sp.Basic, ...]
    context: Any
    angles: tuple[Angle, ...] = ()
    places: dict[sp.Basic, int] = field(default_factory=dict)
    meaning: Mapping[sp.Basic, sp.Basic] = field(default_factory=dict)
    units: tuple[Poly, ...] = ()

    @classmethod
    def of(
        cls, expressions: Iterable[sp.Basic | sp.MatrixBase], meaning: Mapping[sp.Basic, sp.Basic] | None = None
    ) -> Ring:
        """The ring of all symbols of the expressions, in the order of their names.

        The number pi is a symbol too: it is transcendental, so no relation is lost.
        """
        entries: set[sp.Basic] = set()
        for expression in expressions:
            entries.update(expression if isinstance(expression, sp.MatrixBase) else (expression,))
        varying = [entry for entry in entries if not isinstance(entry, sp.Number)]
        angles = angles_of(varying)
        found: set[sp.Basic] = set().union(*map(symbols_outside_angles, varying))
        return cls.over(sorted(found, key=str), angles, meaning)

    @classmethod
    def over(
        cls,
        symbols: Sequence[sp.Basic],
        angles: tuple[Angle, ...] = (),
        meaning: Mapping[sp.Basic, sp.Basic] | None = None,
    ) -> Ring:
        """The ring of the given symbols and angles."""
        listed = (*symbols, *(half for angle in angles for half in (angle.sine, angle.cosine)))
        names = tuple(f"g{place}" for place in range(len(listed)))
        context = fmpz_mpoly_ctx.get(names, Ordering.degrevlex)
        return cls(listed, context, angles, {symbol: place for place, symbol in enumerate(listed)}, meaning or {})

    def with_units(self, denominators: Iterable[Poly]) -> Ring:
        """The ring in which these denominators, and S^2 + C^2 of every angle, are known to vanish nowhere."""
        circles = [self.context.gen(s) ** 2 + self.context.gen(c) ** 2 for s, c in self.pairs()]
        found = list(self.units)
        for factor in (f for d in (*denominators, *circles) for f in irreducible_factors(d)):
            found += [] if any(factor == other for other in found) else [factor]
        return replace(self, units=tuple(found))

    def without_units(self, value: Poly) -> Poly:
        """The polynomial without its factors that vanish nowhere; with the same zeros in the domain of the model."""
        for unit in self.units:
            while value != 0 and len(value) >= len(unit):
                quotient = divide(value, unit)
                if quotient is None:
                    break
                value = quotient
        return value

    def is_unit(self, value: Poly) -> bool:
        """True for a number, or a product of units: not zero anywhere in the domain of the model."""
        return bool(value != 0 and (value.is_constant() or (self.units and self.without_units(value).is_constant())))

    def halves(self, angle: Angle) -> tuple[Poly, Poly]:
        """The generators sin and cos of half the smallest part of an angle."""
        place = self.places[angle.sine]
        return self.context.gen(place), self.context.gen(place + 1)

    def pairs(self) -> list[tuple[int, int]]:
        """Places of the generators (sin, cos) of every angle; both never vanish together."""
        return [(self.places[angle.sine], self.places[angle.cosine]) for angle in self.angles]

    def constant(self, value: int) -> Poly:
        """An integer as a polynomial."""
        return self.context.constant(value)

    def quotient(self, expression: sp.Basic) -> Quotient:
        """A rational function of the symbols, sines and cosines; DomainError for anything else."""
        if isinstance(expression, TrigonometricFunction):
            return self.trigonometric(expression)
        if expression in self.places:
            return Quotient(self.context.gen(self.places[expression]), self.constant(1))
        if isinstance(expression, sp.Pow) and isinstance(expression.exp, sp.Integer) and abs(expression.exp) > EXPONENT:
            got, remedy = expression.exp, "name the power as a parameter"
            raise TooLargeError(f"expected exponents up to {EXPONENT}; got {got}; {remedy}")
        arithmetic = read_arithmetic(expression, self.context, self.quotient)
        if arithmetic is None:
            raise DomainError(
                f"expected rational functions of the parameters and their sines and cosines; got "
                f"{str(expression)[:60]}; name such a function as a parameter of its own"
            )
        return arithmetic

    def trigonometric(self, function: TrigonometricFunction) -> Quotient:
        """sin, cos, tan, cot, sec or csc of an angle."""
        half = {angle: self.halves(angle) for angle in self.angles}
        sine, cosine, bottom = sine_and_cosine(function.args[0], self.angles, half)
        parts = {
            sp.sin: (sine, bottom),
            sp.cos: (cosine, bottom),
            sp.tan: (sine, cosine),
            sp.cot: (cosine, sine),
            sp.sec: (bottom, cosine),
            sp.csc: (bottom, sine),
        }
        return cancel_fraction(*parts[function.func])

    def expression(self, value: Poly | Quotient) -> sp.Expr:
        """Back to sympy, expanded above and below; whole angles wherever they suffice."""
        if isinstance(value, Quotient):
            top, bottom = self.even_angles(value)
            return self.expression(top) / self.expression(bottom)
        whole, power, names = self.whole_angles(value)
        return polynomial_sum(self.named(names), whole, 2**power)

    def even_angles(self, value: Quotient) -> Quotient:
        """The quotient with forms of even degree in the halves of every angle, where both were odd."""
        top, bottom = value
        for _, cosine in self.pairs():
            if is_odd(top, cosine) and is_odd(bottom, cosine):
                top, bottom = (part * self.context.gen(cosine) for part in (top, bottom))
        return Quotient(top, bottom)

    def condition(self, value: Poly) -> sp.Expr:
        """An expression that vanishes where the polynomial does, without a common numerical factor."""
        whole, _, names = self.whole_angles(value)
        plain = whole.primitive()[1]
        plain = -plain if plain.leading_coefficient() < 0 else plain
        return polynomial_sum(self.named(names), plain)

    def named(self, names: Sequence[sp.Basic]) -> Sequence[sp.Basic]:
        """The names with the functions that they stand for."""
        return [name.xreplace(dict(self.meaning)) for name in names] if self.meaning else names

    def whole_angles(self, value: Poly) -> tuple[Poly, int, list[sp.Basic]]:
        """(numerator, k, names): the value is numerator/2^k with the generators read as the names.

        Forms of even degree in the halves of an angle become polynomials in its sine and cosine, with the
        sine to the power one at most; for forms of odd degree the halves stay.
        """
        names, total = list(self.symbols), 0
        for angle, (sine, cosine) in zip(self.angles, self.pairs(), strict=True):
            if is_odd(value, cosine):
                continue
            names[sine], names[cosine] = sp.sin(angle.symbol / angle.parts), sp.cos(angle.symbol / angle.parts)
            value, power = self.doubled(value, sine, cosine)
            total += power
        return value, total, names

    def doubled(self, value: Poly, sine: int, cosine: int) -> tuple[Poly, int]:
        """A form of even degree in two generators, times 2^d, in terms of the doubled angle."""
        groups = powers_apart(value, sine, cosine)
        highest = max((sum(pair) // 2 for pair in groups), default=0)
        S, C = self.context.gen(sine), self.context.gen(cosine)
        total = self.constant(0)
        for (k, l), rest in groups.items():
            # S^2 = (1 - c)/2, C^2 = (1 + c)/2, S C = s/2 with s and c in the places of S and C.
            doubled = (1 - C) ** (k // 2) * (1 + C) ** (l // 2) * S ** (k % 2)
            total += rest * doubled * 2 ** (highest - (k + l) // 2)
        return replace_square(total, sine, 1 - C**2), highest

    def factored(self, value: Poly | Quotient) -> sp.Expr:
        """Back to sympy as a product of irreducible factors."""
        if isinstance(value, Quotient):
            top, bottom = self.even_angles(value)
            return self.factored(top) / self.factored(bottom)
        if value == 0:
            return sp.Integer(0)
        content, factors = factor_exactly(value)
        whole, halves = [], self.constant(1)
        for base, power in factors:
            if any(is_odd(base, cosine) for _, cosine in self.pairs()):
                whole.append(self.expression(base**2) ** (int(power) // 2))
                halves *= base ** (int(power) % 2)
            else:
                whole.append(self.expression(base) ** int(power))
        return sp.Mul(sp.Integer(int(content)), *whole, self.expression(halves))


def is_odd(value: Poly, cosine: int) -> bool:
    """True when a form has odd degree in the halves of an angle, given the place of its cosine."""
    powers = next(iter(value.to_dict()), None)
    return powers is not None and (int(powers[cosine - 1]) + int(powers[cosine])) % 2 == 1


def is_divisor(bottom: Poly, top: Poly) -> bool:
    """True when the division leaves no remainder."""
    return divide(top, bottom) is not None


def divide(top: Poly, bottom: Poly) -> Poly | None:
    """The quotient; None where a remainder is left, which is seen long before it is known."""
    try:
        return top / bottom
    except InexactError:
        return None


def gcd_all(values: Iterable[Poly], zero: Poly) -> Poly:
    """Greatest common divisor; zero when all values vanish."""
    common = zero
    for value in values:
        common = common.gcd(value) if common != 0 else value
        if common == 1:
            break
    return common


@dataclass(frozen=True, slots=True)
class Hashed:
    """A polynomial that can stand in a set: equal texts are equal polynomials of one ring."""

    poly: Poly

    def __hash__(self) -> int:
        return hash(str(self.poly))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Hashed) and self.poly == other.poly


def irreducible_factors(value: Poly) -> list[Poly]:
    """Different irreducible factors that are not numbers."""
    return list(factors_of(Hashed(value)))


@functools.lru_cache(4096)
def factors_of(value: Hashed) -> tuple[Poly, ...]:
    """The factors of a polynomial; a search meets the same equations in many cases."""
    return tuple(base for base, _ in factor_exactly(value.poly)[1])
