"""Sines and cosines of parameters as polynomials.

With S = sin(x/2), C = cos(x/2) the functions of an angle are quotients of forms in S and C of equal degree,

    sin(n x) = Im (C + i S)^(2n) / (S^2 + C^2)^n,    cos(n x) = Re (C + i S)^(2n) / (S^2 + C^2)^n,

and quotients of equal degree form a field that depends on S/C = tan(x/2) alone: Pythagoras' relation is built
in, nothing has to be reduced modulo it, and exact division and factors stay what they are for polynomials.
No angle is lost, x = pi is the point C = 0. A rational multiple r x uses the half of x/q, q the denominator.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import comb, lcm
from typing import Any

import sympy as sp
from sympy.functions.elementary.trigonometric import TrigonometricFunction

from navsym.errors import DomainError, TooLargeError

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


def free_symbols(expression: sp.Basic) -> set[sp.Basic]:
    """Symbols and pi outside of trigonometric functions."""
    if isinstance(expression, TrigonometricFunction):
        return set()
    if not expression.args:
        return {expression} if isinstance(expression, sp.Symbol) or expression == sp.pi else set()
    return set().union(*(free_symbols(part) for part in expression.args))


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


def whole_angle(powers: tuple[int, int], S: Any, C: Any) -> Any:
    """2^d S^k C^l for k + l = 2 d, as a polynomial in sin and cos of the doubled angle.

    The letters S and C then stand for those: S^2 = (1 - c)/2, C^2 = (1 + c)/2, S C = s/2.
    """
    k, l = powers
    one = S**0
    value = (one - C) ** (k // 2) * (one + C) ** (l // 2)
    return value * S if k % 2 else value
