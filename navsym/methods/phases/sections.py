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
from navsym.methods.phases.singular import Singular, is_square_root, real_roots, singular_values
from navsym.proof.balls import enclose
from navsym.proof.decimals import lower_end, upper_end
from navsym.proof.optimality.enclosure import rational

DIGITS = 34


Part = tuple[Family, sp.Expr, sp.Expr]


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


def sections(family: Family, lower: sp.Expr, upper: sp.Expr) -> list[Part]:
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


@dataclass(frozen=True, slots=True)
class Imaginary:
    """A part of the range in which a square root of the file is imaginary: there is no problem there."""

    root: sp.Expr
    lower: sp.Expr
    upper: sp.Expr

    def in_words(self, name: str) -> str:
        """What is imaginary where."""
        return f"{self.root} is imaginary for {name} from {self.lower} to {self.upper}, where there is no problem"


def real_parts(family: Family, lower: sp.Expr, upper: sp.Expr) -> tuple[list[Part], list[Imaginary]]:
    """The range cut where square roots of the parameter become imaginary, and the parts in which one of them is.

    Roots that only stand where sines become hyperbolic sines, or in pairs, cut nothing. Raises DomainError when one is
    imaginary on the whole range.
    """
    roots = {r for e in expressions(family) for r in e.atoms(sp.Pow) if is_square_root(r, family.parameter)}
    found = {z for r in roots for z in real_roots(r.base, family.parameter) or ()}
    marks = sorted((z for z in found if above(z, lower) and above(upper, z)), key=lambda z: float(enclose(z).mid()))
    parts, left = [], []
    for a, b in pairwise([lower, *marks, upper]):
        bad = imaginary_at(family, roots, inside_of(a, b))
        if bad is None:
            parts.append((family, a, b))
        else:
            left.append(Imaginary(bad, a, b))
    if not parts:
        raise DomainError(
            f"{family.parameter.name}: expected a range in which the problem is real; got {lower} to {upper}, and "
            f"{left[0].in_words(family.parameter.name)}; give a range in which {left[0].root.base} is not negative"
        )
    return ([(family, lower, upper)] if not left else parts), left


def expressions(family: Family) -> list[sp.Expr]:
    """All that may depend on the parameter."""
    rows = [h for row in family.rows for h in row]
    return [*family.functional, *family.sigma, *rows, family.start, *family.cuts, family.stop]


def imaginary_at(family: Family, roots: set[sp.Expr], value: sp.Rational) -> sp.Expr | None:
    """A square root that makes the problem imaginary at a value, or None."""
    real = family.real_near(value)
    if not any(real.at(e, value).has(sp.I) for e in expressions(real)):
        return None
    negative = [sp.sqrt(r.base) for r in roots if bool(enclose(family.at(r.base, value)) < 0)]
    return min(negative, key=sp.default_sort_key, default=None)


def begins(part: Imaginary, lower: sp.Expr, upper: sp.Expr, name: str) -> list[Boundary]:
    """The ends of an imaginary part inside the range, as boundaries."""
    ends = [end for end in (part.lower, part.upper) if end not in (lower, upper)]
    return [event(Singular(end, part.in_words(name))) for end in ends]


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
