"""Regimes without a closed form: followed and certified for every value of the parameter."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import sympy as sp
from flint import fmpq, fmpq_mat

from navsym.methods.phases_closed import refined
from navsym.methods.phases_family import Family
from navsym.methods.phases_scan import Pattern
from navsym.methods.phases_vanishing import echelon, scaled, scaled_certificate
from navsym.proof.decimals import decimal, exact
from navsym.proof.enclosure import rational
from navsym.proof.optimality_basis import make_basis
from navsym.proof.optimality_moving import Member, Moving
from navsym.proof.optimality_range import Ranged, Track, follow, march, piece, simple


def fraction_of(x: fmpq) -> Fraction:
    """The same rational number for Python."""
    return Fraction(int(x.p), int(x.q))


def followed(family: Family, pattern: Pattern, lower: fmpq, upper: fmpq) -> Ranged:
    """Certificate pieces for the pattern between two values, as far as the tests pass."""
    bases: list[tuple[fmpq, fmpq, fmpq_mat]] = []

    def moving(a: fmpq, b: fmpq) -> Moving:
        middle, half = (a + b) / 2, (b - a) / 2
        if not bases or abs(middle - bases[-1][0]) > 2 * bases[-1][1]:
            bases.append((middle, half, conditioner(family, middle)))
        return Moving(family.moving, family.parameter, bases[-1][2], middle, half)

    track = Track(family.moving, family.parameter, pattern, lambda p: member(family, pattern, p), moving)
    return follow_from_zero(family, track, upper) if lower == 0 and family.growing else follow(track, lower, upper)


def follow_from_zero(family: Family, track: Track, upper: fmpq) -> Ranged:
    """A first piece that begins at the length zero, scaled by powers, then pieces as usual."""
    form = echelon(family)
    if form is None:
        return Ranged(())
    powers = replace(track, moving=lambda a, b: scaled(family, form, a, b))
    end = min(upper, simple(form.reach, form.reach))
    for _ in range(12):
        start = track.first(end / 2)
        first = None if start is None else piece(powers, start, fmpq(0), end)
        if first is not None:
            rest = march(track, first.ends[1], end, upper)
            return Ranged(tuple(rest), (first, scaled_certificate(family, form, first)))
        end = simple(end / 2, end)
    return Ranged(())


def member(family: Family, pattern: Pattern, p: fmpq) -> Member | None:
    """The solution at a value whose pattern can be told in double precision."""
    found = refined(family, fraction_of(p), pattern)
    if found is None:
        return None
    done, problem = found.polished, family.exact(sp.Rational(int(p.p), int(p.q)))
    weights = [w * problem.panels[k].bound() for w, k in zip(done.weights, done.panel, strict=True)]
    return Member(tuple(map(rational, done.dual)), tuple(map(rational, done.v)), tuple(map(rational, weights)))


def conditioner(family: Family, p: fmpq) -> fmpq_mat:
    """The orthonormalising matrix at a value, rounded to twelve digits."""
    basis = make_basis(family.exact(sp.Rational(int(p.p), int(p.q))))
    m = basis.transform.nrows()
    return fmpq_mat(m, m, [exact(decimal(basis.transform[i, j], 12)) for i in range(m) for j in range(m)])



