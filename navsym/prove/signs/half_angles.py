"""Sines and cosines as rational functions of t = tan(angle/2), so that polynomials decide about them.

Every angle except an odd multiple of pi has its t; what is continuous and nonnegative for all t is
nonnegative for that angle too, but need not be positive there.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from math import lcm

import sympy as sp

from navsym.prove.identities.ingredients import PI, TRIGONOMETRIC, Monomial, linear_terms

MOST_TURNS = 12
Pair = tuple[sp.Expr, sp.Expr]


@dataclass(slots=True)
class HalfAngles:
    """One t for every angle monomial, at the common denominator of its coefficients."""

    denominators: dict[Monomial, int] = field(default_factory=dict)
    tangents: dict[Monomial, sp.Symbol] = field(default_factory=dict)
    pairs: dict[sp.Expr, Pair] = field(default_factory=dict)


def replace_angles(expression: sp.Expr) -> tuple[sp.Expr, HalfAngles] | None:
    """The expression with all sines and cosines written in the t; None where an angle has another form."""
    angles = HalfAngles()
    nodes = sorted(expression.atoms(*TRIGONOMETRIC), key=sp.default_sort_key)
    for node in nodes:
        if node.args[0].has(*TRIGONOMETRIC):
            return None
        for monomial, coefficient in linear_terms(node.args[0]).items():
            if monomial == PI and (2 * coefficient).denominator != 1:
                return None
            if monomial != PI:
                known = angles.denominators.get(monomial, 1)
                angles.denominators[monomial] = lcm(known, coefficient.denominator)
    values = {node: combine_functions(node, *cosine_and_sine(node.args[0], angles)) for node in nodes}
    return expression.xreplace(values), angles


def combine_functions(node: sp.Expr, cosine: sp.Expr, sine: sp.Expr) -> sp.Expr:
    """The six functions by cosine and sine."""
    kinds = {
        sp.cos: lambda: cosine,
        sp.sin: lambda: sine,
        sp.tan: lambda: sine / cosine,
        sp.cot: lambda: cosine / sine,
        sp.sec: lambda: 1 / cosine,
        sp.csc: lambda: 1 / sine,
    }
    return kinds[node.func]()


def cosine_and_sine(angle: sp.Expr, angles: HalfAngles) -> Pair:
    """cos and sin of a sum of multiples of the angle monomials and of pi/2."""
    if angle not in angles.pairs:
        pair: Pair = (sp.Integer(1), sp.Integer(0))
        for monomial, coefficient in linear_terms(angle).items():
            pair = add_angles(
                pair, quarter_turn(coefficient) if monomial == PI else multiply_angle(monomial, coefficient, angles)
            )
        angles.pairs[angle] = pair
    return angles.pairs[angle]


def quarter_turn(coefficient: Fraction) -> Pair:
    turns = int(2 * coefficient) % 4
    return ((sp.Integer((1, 0, -1, 0)[turns])), sp.Integer((0, 1, 0, -1)[turns]))


def multiply_angle(monomial: Monomial, coefficient: Fraction, angles: HalfAngles) -> Pair:
    """cos and sin of a whole multiple of the angle whose half has the tangent t."""
    share = angles.denominators[monomial]
    count = int(coefficient * share)
    if abs(count) > MOST_TURNS:
        raise OverflowError("an angle is taken too many times")
    t = tangent(monomial, angles)
    once: Pair = ((1 - t**2) / (1 + t**2), sp.sign(count) * 2 * t / (1 + t**2))
    pair: Pair = (sp.Integer(1), sp.Integer(0))
    for _ in range(abs(count)):
        pair = add_angles(pair, once)
    return pair


def add_angles(first: Pair, second: Pair) -> Pair:
    """cos and sin of a sum of two angles."""
    return (first[0] * second[0] - first[1] * second[1], first[1] * second[0] + first[0] * second[1])


def tangent(monomial: Monomial, angles: HalfAngles) -> sp.Symbol:
    """The t of an angle."""
    if monomial not in angles.tangents:
        angles.tangents[monomial] = sp.Dummy(f"t{len(angles.tangents)}", real=True)
    return angles.tangents[monomial]
