"""Inverse functions by their definition: ``A = B`` for A = asin(u) says that sin B = u with B in [-pi/2, pi/2].

A sum that contains inverse functions with rational coefficients is solved for one of them at a time;
what is left are equations and inequalities without it, which others prove.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import lcm

import sympy as sp

from navsym.proof.identities.monomials import PI, linear_terms, single

MOST_POWERS = 400
KINDS = (sp.log, sp.asin, sp.acos, sp.atan, sp.atan2)


@dataclass(frozen=True, slots=True)
class Solved:
    """A sum vanishes when ``left = right`` and the others have their signs."""

    atom: sp.Expr
    left: sp.Expr
    right: sp.Expr
    nonnegative: tuple[sp.Expr, ...] = ()
    positive: tuple[sp.Expr, ...] = ()


def solved_for_inverses(difference: sp.Expr) -> Iterator[Solved]:
    """The sum solved for each of its inverse functions, and what that leaves to prove."""
    for factor in sp.Mul.make_args(sp.factor_terms(difference)):
        terms = linear_terms(factor)
        atoms = {m: single(m, KINDS) for m in terms}
        if len(terms) < 2 and factor is not difference:
            continue
        for monomial, atom in sorted(atoms.items(), key=lambda item: str(item[1])):
            if atom is not None:
                coefficient = terms[monomial]
                share = sp.Rational(coefficient.numerator, coefficient.denominator)
                value = sp.expand_mul(atom - factor / share)
                if not isinstance(atom, sp.log) or size_of(value) <= MOST_POWERS:
                    yield definition(atom, value)


def size_of(value: sp.Expr) -> int:
    """The largest whole power that a sum of logarithms turns into."""
    shares = list(linear_terms(value).values())
    n = lcm(*(share.denominator for share in shares), 1)
    return max([n, *(abs(int(share * n)) for share in shares)])


def definition(atom: sp.Expr, value: sp.Expr) -> Solved:
    """``atom = value`` without the inverse function."""
    half = sp.pi / 2
    if isinstance(atom, sp.log):
        # u > 0 wherever the logarithm exists, so whole powers of the two sides may be compared.
        n = lcm(*(c.denominator for c in linear_terms(value).values()), 1)
        return Solved(atom, atom.args[0] ** n, sp.exp(sp.expand_mul(n * value)))
    if isinstance(atom, sp.asin):
        return Solved(atom, atom.args[0], sp.sin(value), (half - value, half + value))
    if isinstance(atom, sp.acos):
        return Solved(atom, atom.args[0], sp.cos(value), (value, sp.pi - value))
    if isinstance(atom, sp.atan):
        return Solved(atom, atom.args[0] * sp.cos(value), sp.sin(value), (), (half - value, half + value))
    y, x = atom.args
    along = x * sp.cos(value) + y * sp.sin(value)
    return Solved(atom, x * sp.sin(value), y * sp.cos(value), (sp.pi - value,), (sp.pi + value, along))


#: Principal ranges in half turns: the ends, and whether each is left out.
RANGES: dict[type, tuple[tuple[sp.Rational, bool], tuple[sp.Rational, bool]]] = {
    sp.asin: ((-sp.S.Half, False), (sp.S.Half, False)),
    sp.acos: ((sp.S.Zero, False), (sp.S.One, False)),
    sp.atan: ((-sp.S.Half, True), (sp.S.Half, True)),
    sp.atan2: ((-sp.S.One, True), (sp.S.One, False)),
}


def principal_least(value: sp.Expr) -> tuple[sp.Rational, bool]:
    """A lower bound of a sum of inverse functions in half turns, and whether it is left out; or -infinity."""
    total, left_out = sp.S.Zero, False
    for monomial, coefficient in linear_terms(value).items():
        share = sp.Rational(coefficient.numerator, coefficient.denominator)
        atom = single(monomial, tuple(RANGES))
        if monomial == PI:
            total += share
        elif atom is not None:
            end, open_end = RANGES[type(atom)][0 if share > 0 else 1]
            total, left_out = total + share * end, left_out or open_end
        else:
            return sp.S.NegativeInfinity, False
    return total, left_out
