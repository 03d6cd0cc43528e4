"""The range of the parameter cut into sections without a singular value inside."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import sympy as sp

from navsym.errors import DomainError
from navsym.methods.phases.dependent import without_dependent
from navsym.methods.phases.events import Boundary
from navsym.methods.phases.family import Family
from navsym.methods.phases.range import fraction_of
from navsym.methods.phases.scan import exact
from navsym.methods.phases.singular import Singular, singular_values
from navsym.proof.balls import enclose
from navsym.proof.decimals import lower_end, upper_end
from navsym.proof.optimality.enclosure import rational

DIGITS = 34


@dataclass(frozen=True, slots=True, eq=False)
class Section:
    """A part of the range without a singular value inside, as far as they are known.

    singular : those of the range
    unknown  : expressions that may have roots in the range at which it is singular
    ties     : certificates of unknowns left out
    """

    family: Family
    lower: sp.Expr
    upper: sp.Expr
    singular: tuple[Singular, ...]
    unknown: tuple[sp.Expr, ...]
    ties: tuple[dict[str, Any], ...]

    @property
    def names(self) -> set[sp.Expr]:
        """The singular values."""
        return {s.at for s in self.singular}


def sections(family: Family, lower: sp.Expr, upper: sp.Expr) -> list[tuple[Family, sp.Expr, sp.Expr]]:
    """The range cut where one family of a chain follows another."""
    chain = family.chain
    first = [lower, *(one.least for one in chain[1:])]
    last = [*(one.least for one in chain[1:]), upper]
    done = []
    for one, a, b in zip(chain, first, last, strict=True):
        start, end = (lower if above(lower, a) else a), (upper if above(b, upper) else b)
        if above(end, start):
            done.append((one, start, end))
    return done


def above(x: sp.Expr, y: sp.Expr) -> bool:
    """x > y, by balls."""
    return x != y and bool(enclose(x - y) > 0)


def split(family: Family, lower: sp.Expr, upper: sp.Expr) -> list[Section]:
    """The range cut at its singular values, and unknowns that depend on others left out."""
    inside = inside_of(lower, upper)
    family, ties = without_dependent(family.real_near(inside), inside)
    singular, unknown = singular_values(family, lower, upper)
    inner = [s.at for s in singular if above(s.at, lower) and above(upper, s.at)]
    return [
        Section(family.real_near(inside_of(a, b)), a, b, singular, unknown, ties)
        for a, b in pairwise([lower, *inner, upper])
    ]


def inside_of(lower: sp.Expr, upper: sp.Expr) -> sp.Rational:
    """A rational value between the ends that no symmetry singles out."""
    ball = enclose(lower + (upper - lower) * sp.Rational(5, 13), bits=96)
    return exact(fraction_of(rational(ball)).limit_denominator(10**6))


def event(singular: Singular) -> Boundary:
    """A singular value as a boundary."""
    ball = enclose(singular.at, bits=200)
    return Boundary(singular.at, lower_end(ball, DIGITS), upper_end(ball, DIGITS), singular.why, True)


def not_looked_at(section: Section) -> Boundary:
    """What may split a section further, as a boundary somewhere in it that was not located."""
    ends = lower_end(enclose(section.lower, bits=200), DIGITS), upper_end(enclose(section.upper, bits=200), DIGITS)
    shown = ", ".join(map(str, section.unknown[:5])) + (", …" if len(section.unknown) > 5 else "")
    return Boundary(None, *ends, f"singular values may lie where these vanish, which were not solved: {shown}", False)


def need_range(family: Family, lower: sp.Expr, upper: sp.Expr) -> None:
    """Raises DomainError for ends that are no finite numbers, for from >= to, and for lengths below zero."""
    for end in (lower, upper):
        if end.free_symbols or not enclose(end).is_finite():
            raise DomainError(f"range: expected finite numbers; got {end}; give two numbers")
    if not bool(enclose(upper - lower) > 0):
        raise DomainError(f"range: expected from < to; got {lower} to {upper}; exchange or mend them")
    if family.growing and not bool(enclose(lower) >= 0):
        raise DomainError(f"range: expected lengths 0 <= from < to; got {lower} to {upper}; mend them")
