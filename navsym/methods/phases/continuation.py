"""The complete solution as a parameter varies: regimes, boundaries, closed forms.

A regime is a range of the parameter with one pattern of instants. Where instants, weights and value have a
closed form it is proved as a primal-dual pair for all values of the regime; elsewhere the optimum is
certified for every value by contacts that are followed rigorously, and slivers around boundaries by
two-sided certificates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import sympy as sp

from navsym.methods.phases.answer import Phases, Regime, end_text
from navsym.methods.phases.changes import change, firm, located, middle_of
from navsym.methods.phases.closed import Closed, candidates
from navsym.methods.phases.continued import continued
from navsym.methods.phases.events import Boundary
from navsym.methods.phases.family import Family
from navsym.methods.phases.limit import DEFAULT_SECONDS, Limit
from navsym.methods.phases.range import fraction_of
from navsym.methods.phases.scan import COUNT, Span, exact, scan
from navsym.methods.phases.sections import (
    Section,
    begins,
    event,
    need_range,
    not_looked_at,
    real_parts,
    sections,
    split,
)
from navsym.methods.phases.settle import Follow, exact_fraction, limits_of, regime_of
from navsym.proof.balls import enclose
from navsym.proof.decimals import decimal
from navsym.proof.optimality.enclosure import rational

#: A span below this part of the range is given up when its neighbours are proved to meet.
SHORT = Fraction(1, 50)
DIGITS = 34


def phases(
    family: Family,
    lower: sp.Expr,
    upper: sp.Expr,
    *,
    certify: bool = True,
    alone: bool = False,
    seconds: float = DEFAULT_SECONDS,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> Phases:
    """All regimes for values of the parameter between two exact numbers.

    The range is split at singular values. certify : follow regimes without a closed form rigorously.
    alone : follow the others as well, which proves that no other estimator is optimal and gives them certificates.
    seconds : of work, after which what is known is returned: ``uncovered`` names the rest, ``given_up`` what was left
    progress : called with (finished, all) steps of the search: each stretch is scanned, each regime settled
    Raises DomainError for a range without length, lengths of the interval below zero, and seconds that are none.
    """
    need_range(family, lower, upper)
    limit = Limit.of(seconds)
    plan, lost, edges = planned(family, lower, upper, limit.share(1 / 4))
    steps = Steps(progress, len(plan) * (COUNT - 1))
    follow = Follow(certify, alone)
    parts = [stretch(section, follow, steps, limit.share(1 / (len(plan) - k))) for k, section in enumerate(plan)]
    uncovered = [*lost, *(pair for part in parts for pair in part.uncovered)]
    changes = {b if b.at is None else b.at: b for b in (*changes_between(plan, lower), *edges)}
    inner = [b for part in parts for b in part.boundaries]
    ties = {id(tie): tie for section in plan for tie in section.ties}
    return Phases(
        plan[-1].family if plan else family,
        lower,
        upper,
        tuple(regime for part in parts for regime in part.regimes),
        tuple(sorted((*changes.values(), *inner), key=lambda b: sp.Rational(b.lower))),
        tuple(uncovered),
        tuple(ties.values()),
        tuple(limit.given_up),
    )


def planned(
    family: Family, lower: sp.Expr, upper: sp.Expr, limit: Limit
) -> tuple[list[Section], list[tuple[str, str]], list[Boundary]]:
    """The sections of the range, the ends of parts that have none (imaginary, or not split within the limit), and where
    imaginary ones begin."""
    plan: list[Section] = []
    lost: list[tuple[str, str]] = []
    edges: list[Boundary] = []
    for part in sections(family, lower, upper):
        real, imaginary = real_parts(*part)
        lost += [(end_text(one.lower), end_text(one.upper)) for one in imaginary]
        edges += [b for one in imaginary for b in begins(one, lower, upper, family.parameter.name)]
        for one in real:
            ends = end_text(one[1]), end_text(one[2])
            found = limit.share(1 / 2).within(f"singular values from {ends[0]} to {ends[1]}", split, *one)
            plan += found or []
            lost += [ends] if found is None else []
    return plan, lost, edges


def changes_between(plan: Sequence[Section], lower: sp.Expr) -> list[Boundary]:
    """The singular values of all sections as boundaries, and what may hide further ones."""
    singular = {s.at: s for section in plan for s in section.singular}
    known = [event(s) for s in singular.values() if not (s.at == lower == 0 and plan[0].family.growing)]
    return known + [not_looked_at(s) for s in plan if s.unknown]


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


def stretch(section: Section, follow: Follow, steps: Steps, limit: Limit) -> Phases:
    """All regimes between two values without a singular one inside."""
    family, lower, singular = section.family, section.lower, section.names
    low, high = inner_range(lower, section.upper, singular)
    spans = scanned(family, low, high, steps, limit)
    upper = section.upper if spans[-1].upper == high else exact(spans[-1].upper)
    spans = without_accidents(family, spans, limit.share(1 / 4))
    steps.found(len(spans))
    guesses = guessed(family, spans, steps, limit.share(1 / 2))
    spans, guesses = limit.share(1 / 4).within("closed forms next to others", continued, family, spans, guesses) or (
        spans,
        guesses,
    )
    first = located(family, spans, [g[0] if g else None for g in guesses], limit.share(1 / 2))
    changes, forms = firm(family, spans, guesses, first, (lower, upper), limit.share(1 / 2))
    cuts = [lower, *(middle_of(b) for b in changes), upper]
    limits = limits_of(family, lower, upper, low, high, changes, singular)
    regimes, uncovered = [], []
    for k, span in enumerate(spans):
        part = limit.share(1 / (len(spans) - k))
        regime, holes = regime_of(family, span, (cuts[k], cuts[k + 1]), limits[k], forms[k], follow, part)
        regimes.append(regime)
        uncovered += holes
        steps.did(Steps.LOOKS)
    if upper != section.upper:
        uncovered.append((end_text(upper, -1), end_text(section.upper)))
    honest = tuple(b if b.proved else between(b, *pair) for b, pair in zip(changes, pairwise(regimes), strict=True))
    return Phases(family, lower, upper, tuple(regimes), honest, tuple(uncovered))


def scanned(family: Family, low: Fraction, high: Fraction, steps: Steps, limit: Limit) -> list[Span]:
    """The spans of a section, up to where half of its time allows."""
    half = limit.share(1 / 2)

    def step() -> bool:
        steps.did()
        return not half.met()

    spans = scan(family, low, high, step=step)
    if spans[-1].upper != high:
        limit.gives_up(f"the search for patterns from {float(spans[-1].upper):.6g} to {float(high):.6g}")
    return spans


def guessed(family: Family, spans: Sequence[Span], steps: Steps, limit: Limit) -> list[list[Closed]]:
    """Closed forms of every span, not yet proved."""
    found = []
    for k, span in enumerate(spans):
        what = f"the search for a closed form from {float(span.lower):.6g} to {float(span.upper):.6g}"
        found.append(limit.share(1 / (len(spans) - k)).within(what, candidates, family, span) or [])
        steps.did(Steps.LOOKS)
    return found


def without_accidents(family: Family, spans: list[Span], limit: Limit) -> list[Span]:
    """Spans without short ones between neighbours that are proved to follow each other: there contacts merge, and
    the search in double precision takes one pattern for another, or for several."""
    short = SHORT * (spans[-1].upper - spans[0].lower)
    kept, rest = spans[:1], spans[1:]
    while rest:
        beyond = next((k for k, span in enumerate(rest) if span.upper - span.lower >= short), 0)
        found = change(family, kept[-1], rest[beyond], limit) if beyond else None
        if found is not None and found.proved:
            cut = fraction_of(rational(enclose(middle_of(found), bits=200)))
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


def inner_range(lower: sp.Expr, upper: sp.Expr, singular: set[sp.Expr]) -> tuple[Fraction, Fraction]:
    """Rational values just inside the range, further inside at singular ends."""
    a, b = (fraction_of(rational(enclose(e, bits=200))) for e in (lower, upper))
    steps = [Fraction(1, 400) if e in singular else Fraction(1, 10**9) for e in (lower, upper)]
    low, high = a + steps[0] * (b - a), b - steps[1] * (b - a)
    return low.limit_denominator(10**12), high.limit_denominator(10**12)


__all__ = ["Phases", "Regime", "phases"]
