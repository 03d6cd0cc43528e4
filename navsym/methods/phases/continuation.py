"""The complete solution as a parameter varies: regimes, boundaries, closed forms.

A regime is a range of the parameter with one pattern of instants. Where instants, weights and value have a
closed form it is proved as a primal-dual pair for all values of the regime; elsewhere the optimum is
certified for every value by contacts that are followed rigorously, and slivers around boundaries by
two-sided certificates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

import sympy as sp
from flint import fmpq

from navsym.claims import CERTIFIED, OPEN
from navsym.errors import DomainError
from navsym.methods.guaranteed.solver import solve
from navsym.methods.phases.answer import Phases, Regime, end_text, number_of
from navsym.methods.phases.closed import Closed, candidates, prove
from navsym.methods.phases.continued import continued
from navsym.methods.phases.dependent import without_dependent
from navsym.methods.phases.events import Boundary, boundary
from navsym.methods.phases.family import Family
from navsym.methods.phases.range import followed, fraction_of
from navsym.methods.phases.scan import COUNT, Span, scan
from navsym.methods.phases.singular import Singular, singular_values
from navsym.methods.phases.slivers import slivers
from navsym.proof.balls import enclose
from navsym.proof.decimals import decimal, lower_end, upper_end
from navsym.proof.decimals import exact as exact_decimal
from navsym.proof.optimality.enclosure import rational
from navsym.proof.optimality.range import Ranged

POINTS = 5
#: Next to a singular value this part of the range is left, and named in ``uncovered``.
MARGIN = Fraction(1, 100_000)
#: A span below this part of the range is given up when its neighbours are proved to meet.
SHORT = Fraction(1, 50)
DIGITS = 34


def phases(
    family: Family, lower: sp.Expr, upper: sp.Expr, *, certify: bool = True, alone: bool = False,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> Phases:  # fmt: skip
    """All regimes for values of the parameter between two exact numbers.

    The range is split at singular values. certify : follow regimes without a closed form rigorously.
    alone : follow the others as well, which proves that no other estimator is optimal and gives them certificates.
    progress : called with (finished, all) steps of the search: each stretch is scanned, each regime settled
    Raises DomainError for a range without length, and lengths of the interval below zero.
    """
    need_range(family, lower, upper)
    plan = [section for part in sections(family, lower, upper) for section in split(*part)]
    steps = Steps(progress, len(plan) * (COUNT - 1))
    follow = Follow(certify, alone)
    parts = [stretch(section, follow, steps) for section in plan]
    singular = {s.at: s for section in plan for s in section.singular}
    changes = [event(s) for s in singular.values() if not (s.at == lower == 0 and plan[0].family.growing)]
    changes += [b for part in parts for b in part.boundaries] + [not_looked_at(s) for s in plan if s.unknown]
    changes.sort(key=lambda b: sp.Rational(b.lower))
    regimes = [regime for part in parts for regime in part.regimes]
    uncovered = [pair for part in parts for pair in part.uncovered]
    ties = {id(tie): tie for section in plan for tie in section.ties}
    return Phases(
        plan[-1].family, lower, upper, tuple(regimes), tuple(changes), tuple(uncovered), tuple(ties.values())
    )


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


@dataclass(frozen=True, slots=True)
class Follow:
    """Which regimes are followed rigorously: those without a closed form, those with one."""

    implicit: bool
    closed: bool


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


class Steps:
    """Counts the steps of a search that finds more of them on its way.

    A closed form that is guessed and one that is settled are worth ten looks of a scan each.
    """

    LOOKS = 10

    def __init__(self, progress: Callable[[int, int], None], of: int):
        self.progress, self.done, self.of = progress, 0, of

    def found(self, regimes: int) -> None:
        """The scan of a stretch found so many regimes to settle."""
        self.of += 2 * regimes * self.LOOKS
        self.progress(self.done, self.of)

    def did(self, steps: int = 1) -> None:
        """So many steps are done."""
        self.done += steps
        self.progress(self.done, self.of)


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


def stretch(section: Section, follow: Follow, steps: Steps) -> Phases:
    """All regimes between two values without a singular one inside."""
    family, lower, upper, singular = section.family, section.lower, section.upper, section.names
    low, high = inner_range(lower, upper, singular)
    spans = without_accidents(family, scan(family, low, high, step=steps.did))
    steps.found(len(spans))
    guesses = []
    for span in spans:
        guesses.append(candidates(family, span))
        steps.did(Steps.LOOKS)
    found, (spans, guesses) = len(spans), continued(family, spans, guesses)
    steps.did(Steps.LOOKS * (found - len(spans)))
    firsts = [g[0] if g else None for g in guesses]
    pairs = zip(spans, spans[1:], firsts, firsts[1:], strict=False)
    changes = tuple(boundary(family, a, b, c, d) for a, b, c, d in pairs)
    cuts = [lower, *(middle_of(b) for b in changes), upper]
    limits = limits_of(family, lower, upper, low, high, changes, singular)
    regimes, uncovered = [], []
    for k, span in enumerate(spans):
        closed = prove(family, guesses[k], cuts[k], cuts[k + 1]) if guesses[k] else None
        held = closed if closed is not None and closed.verdict.status.holds else None
        regime, holes = regime_of(family, span, (cuts[k], cuts[k + 1]), limits[k], held, follow)
        regimes.append(regime)
        uncovered += holes
        steps.did(Steps.LOOKS)
    honest = tuple(b if b.proved else between(b, *pair) for b, pair in zip(changes, pairwise(regimes), strict=True))
    return Phases(family, lower, upper, tuple(regimes), honest, tuple(uncovered))


def without_accidents(family: Family, spans: list[Span]) -> list[Span]:
    """Spans without short ones between neighbours that are proved to follow each other: there contacts merge, and
    the search in double precision takes one pattern for another, or for several."""
    short = SHORT * (spans[-1].upper - spans[0].lower)
    kept, rest = spans[:1], spans[1:]
    while rest:
        beyond = next((k for k, span in enumerate(rest) if span.upper - span.lower >= short), 0)
        change = boundary(family, kept[-1], rest[beyond], None, None) if beyond else None
        if change is not None and change.proved:
            cut = fraction_of(rational(enclose(middle_of(change), bits=200)))
            kept[-1], rest = replace(kept[-1], upper=cut), rest[beyond:]
            rest[0] = replace(rest[0], lower=cut)
        kept.append(rest.pop(0))
    return kept


def between(guess: Boundary, before: Regime, after: Regime) -> Boundary:
    """A change that was not located lies between the last value of one proved pattern and the first of the other.

    Where a pattern is proved nowhere, the bracket is that of the search, and the regime is uncovered.
    """
    last = before.held[1] if before.held else exact_fraction(before.span.lower)
    first = after.held[0] if after.held else exact_fraction(after.span.upper)
    return replace(guess, lower=decimal(last, DIGITS, -1), upper=decimal(first, DIGITS, 1))


def exact_fraction(x: Fraction) -> fmpq:
    """A fraction of Python as a rational of flint."""
    return fmpq(x.numerator, x.denominator)


def inner_range(lower: sp.Expr, upper: sp.Expr, singular: set[sp.Expr]) -> tuple[Fraction, Fraction]:
    """Rational values just inside the range, further inside at singular ends."""
    a, b = (fraction_of(rational(enclose(e, bits=200))) for e in (lower, upper))
    steps = [Fraction(1, 400) if e in singular else Fraction(1, 10**9) for e in (lower, upper)]
    low, high = a + steps[0] * (b - a), b - steps[1] * (b - a)
    return low.limit_denominator(10**12), high.limit_denominator(10**12)


def middle_of(b: Boundary) -> sp.Expr:
    """The exact value of a boundary, or the middle of its bracket."""
    return b.at if b.at is not None else (sp.Rational(b.lower) + sp.Rational(b.upper)) / 2


Limits = tuple[fmpq, fmpq, fmpq, fmpq]


def limits_of(
    family: Family, lower: sp.Expr, upper: sp.Expr, low: Fraction, high: Fraction,
    changes: Sequence[Boundary], singular: set[sp.Expr],
) -> list[Limits]:  # fmt: skip
    """For every regime: where it must be covered (outer) and where exact contacts are followed (inner)."""
    margin = exact_fraction(MARGIN * (high - low))
    marks = [end_marks(family, lower, -1, singular, margin)]
    marks += [(exact_decimal(b.lower), exact_decimal(b.upper)) for b in changes]
    marks.append(end_marks(family, upper, 1, singular, margin))
    done: list[Limits] = []
    for k, (left, right) in enumerate(pairwise(marks)):
        outer = left[0] if k == 0 else (left[0] + left[1]) / 2
        done.append((outer, left[1], right[0], right[1] if k == len(changes) else (right[0] + right[1]) / 2))
    return done


def end_marks(
    family: Family, end: sp.Expr, side: int, singular: set[sp.Expr], margin: fmpq
) -> tuple[fmpq, fmpq]:
    """An end of the range as two rationals in order, the outer at or beyond it, the inner where contacts start."""
    ball = enclose(end, bits=200)
    if end.is_Rational:
        at = fmpq(int(end.p), int(end.q))
    else:
        at = exact_decimal(lower_end(ball, DIGITS) if side < 0 else upper_end(ball, DIGITS))
    vanishing = side < 0 and end == 0 and family.growing
    inner = at - side * margin if end in singular and not vanishing else at
    return (at, inner) if side < 0 else (inner, at)


def regime_of(
    family: Family, span: Span, ends: tuple[sp.Expr, sp.Expr], limits: Limits, closed: Closed | None, follow: Follow
) -> tuple[Regime, list[tuple[str, str]]]:
    """One regime: its proved closed form, or contacts followed for every value, slivers and holes."""
    a, b = ends
    if closed is not None:
        return with_closed_form(family, span, ends, limits, closed, follow), []
    if not follow.implicit:
        return Regime(family, span, a, b, None, OPEN, table_of(family, span)), [(end_text(a), end_text(b))]
    done = followed(family, span.pattern, limits[1], limits[2])
    holes, thin = [], []
    for left, right in rests(done, limits):
        made, left_over = slivers(family, left, right)
        thin += made
        holes += [(end_text(number_of(p), -1), end_text(number_of(q), 1)) for p, q in left_over]
    status = CERTIFIED if done.ends is not None else OPEN
    shown = table_of(family, span)
    return Regime(
        family, span, a, b, None, status, shown, done.documents, tuple(thin), done.ends, done.ends
    ), holes


def with_closed_form(
    family: Family, span: Span, ends: tuple[sp.Expr, sp.Expr], limits: Limits, closed: Closed, follow: Follow
) -> Regime:
    """A regime whose closed form is proved, and where it is the only optimum when this is asked for."""
    done = followed(family, span.pattern, limits[1], limits[2]) if follow.closed else Ranged((), ())
    return Regime(
        family, span, *ends, closed, closed.verdict.status, (), done.documents, (), (limits[1], limits[2]), done.ends
    )


def rests(done: Ranged, limits: Limits) -> list[tuple[fmpq, fmpq]]:
    """Stretches of the regime that the followed contacts leave."""
    if done.ends is None:
        return [(limits[0], limits[3])]
    first, last = done.ends
    return [(a, b) for a, b in ((limits[0], first), (last, limits[3])) if a < b]


def exact(x: Fraction) -> sp.Rational:
    """A fraction of Python as a rational of sympy."""
    return sp.Rational(x.numerator, x.denominator)


def table_of(family: Family, span: Span) -> tuple[dict[str, Any], ...]:
    """Enclosures of the value, instants and weights at a few values of the parameter."""
    rows = []
    for k in range(POINTS):
        T = (span.lower + (span.upper - span.lower) * Fraction(2 * k + 1, 2 * POINTS)).limit_denominator(1000)
        found = solve(family.problem(exact(T)), 20)
        places = [
            {"measurement": s.measurement, "at": instant(family, T, s.at), "weight": s.weight} for s in found.support
        ]
        places.sort(key=lambda place: sp.Rational(place["at"]))
        rows.append({family.parameter.name: str(T), "lower": found.lower, "upper": found.upper, "support": places})
    return tuple(rows)


def instant(family: Family, T: Fraction, u: str) -> str:
    """The instant that a coordinate means at a value of the parameter, to twenty digits."""
    end = family.at(family.stop, exact(T))
    return decimal(rational(enclose(end - sp.Rational(u), bits=200)), 20) if family.backward else u


__all__ = ["Phases", "Regime", "phases"]
