"""Regimes without a closed form: followed and certified for every length of the interval."""

from __future__ import annotations

from fractions import Fraction

import sympy as sp
from flint import fmpq, fmpq_mat

from navsym.methods.phases_closed import refined
from navsym.methods.phases_family import Family
from navsym.methods.phases_scan import Pattern
from navsym.proof.decimals import decimal, exact
from navsym.proof.enclosure import rational
from navsym.proof.optimality_basis import make_basis
from navsym.proof.optimality_range import Member, Ranged, Track, follow


def fraction_of(x: fmpq) -> Fraction:
    """The same rational number for Python."""
    return Fraction(int(x.p), int(x.q))


def followed(family: Family, pattern: Pattern, lower: Fraction, upper: Fraction) -> Ranged:
    """Certificate pieces for the pattern from ``lower`` upwards, as far as the tests pass."""
    members: dict[fmpq, Member | None] = {}
    bases: list[tuple[fmpq, fmpq_mat]] = []

    def solve(T: fmpq) -> Member | None:
        if T not in members:
            members[T] = member(family, pattern, T)
        return members[T]

    def basis(T: fmpq) -> fmpq_mat:
        if not bases or not bases[-1][0] * fmpq(5, 6) <= T <= bases[-1][0] * fmpq(6, 5):
            bases.append((T, conditioner(family, T)))
        return bases[-1][1]

    track = Track(family.exact(1), pattern, solve, basis)
    return follow(track, fmpq(lower.numerator, lower.denominator), fmpq(upper.numerator, upper.denominator))


def member(family: Family, pattern: Pattern, T: fmpq) -> Member | None:
    found = refined(family, fraction_of(T), pattern)
    if found is None:
        return None
    done = found.polished
    times = tuple(rational(v) * T for v in done.v)
    return Member(tuple(map(rational, done.dual)), times, tuple(map(rational, done.weights)))


def conditioner(family: Family, T: fmpq) -> fmpq_mat:
    """The orthonormalising matrix on [0, T], rounded to twelve digits."""
    basis = make_basis(family.exact(sp.Rational(int(T.p), int(T.q))))
    m = basis.transform.nrows()
    return fmpq_mat(m, m, [exact(decimal(basis.transform[i, j], 12)) for i in range(m) for j in range(m)])
