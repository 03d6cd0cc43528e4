"""One regime settled: its proved closed form, or contacts followed for every value, slivers, holes and a table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

import sympy as sp
from flint import fmpq

from navsym.claims import CERTIFIED, OPEN
from navsym.methods.guaranteed.solver import solve
from navsym.methods.phases.answer import Regime, end_text
from navsym.methods.phases.closed import Closed
from navsym.methods.phases.events import Boundary
from navsym.methods.phases.family import Family
from navsym.methods.phases.limit import Limit
from navsym.methods.phases.range import covered, followed
from navsym.methods.phases.scan import Span, exact
from navsym.methods.phases.slivers import slivers
from navsym.proof.balls import enclose, exact_rational
from navsym.proof.decimals import decimal, lower_end, upper_end
from navsym.proof.decimals import exact as exact_decimal
from navsym.proof.optimality.enclosure import rational
from navsym.proof.optimality.range import Ranged

POINTS = 5
#: Next to a singular value this part of the range is left, and named in ``uncovered``.
MARGIN = Fraction(1, 100_000)
DIGITS = 34


@dataclass(frozen=True, slots=True)
class Follow:
    """Which regimes are followed rigorously: those without a closed form, those with one."""

    implicit: bool
    closed: bool


def exact_fraction(x: Fraction) -> fmpq:
    """A fraction of Python as a rational of flint."""
    return fmpq(x.numerator, x.denominator)


Limits = tuple[fmpq, fmpq, fmpq, fmpq]


def limits_of(
    family: Family,
    lower: sp.Expr,
    upper: sp.Expr,
    low: Fraction,
    high: Fraction,
    changes: Sequence[Boundary],
    singular: set[sp.Expr],
) -> list[Limits]:
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


def end_marks(family: Family, end: sp.Expr, side: int, singular: set[sp.Expr], margin: fmpq) -> tuple[fmpq, fmpq]:
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
    family: Family,
    span: Span,
    ends: tuple[sp.Expr, sp.Expr],
    limits: Limits,
    closed: Closed | None,
    follow: Follow,
    limit: Limit,
) -> tuple[Regime, list[tuple[str, str]]]:
    """One regime: its proved closed form, or contacts followed for every value, slivers and holes."""
    a, b = ends
    name = f"from {end_text(a)} to {end_text(b)}"
    if closed is not None:
        done = followed_within(family, span, limits, limit, name) if follow.closed else Ranged((), ())
        held, status = (limits[1], limits[2]), closed.verdict.status
        return Regime(family, span, a, b, closed, status, (), done.documents, (), held, longest(done)), []
    shown = limit.share(1 / 4).within(f"the table of values {name}", table_of, family, span) or ()
    if not follow.implicit:
        return Regime(family, span, a, b, None, OPEN, shown), [(end_text(a, -1), end_text(b, 1))]
    done = followed_within(family, span, limits, limit.share(3 / 4), name)
    thin, holes = [], []
    for left, right in rests(done, limits):
        made, left_over = slivers(family, left, right, limit.met)
        thin += made
        holes += [(end_text(exact_rational(p), -1), end_text(exact_rational(q), 1)) for p, q in left_over]
    run = longest(done)
    status = CERTIFIED if run is not None else OPEN
    return Regime(family, span, a, b, None, status, shown, done.documents, tuple(thin), run, run), holes


def followed_within(family: Family, span: Span, limits: Limits, limit: Limit, name: str) -> Ranged:
    """The contacts of a regime followed as far as the tests and the limit allow."""
    done = followed(family, span.pattern, limits[1], limits[2], limit.met)
    if limit.met():
        limit.gives_up(f"following the contacts {name}")
    return done


def rests(done: Ranged, limits: Limits) -> list[tuple[fmpq, fmpq]]:
    """Stretches of the regime that the followed contacts leave, before, between and behind their pieces."""
    edges = [limits[0], *(edge for run in covered(done.pieces) for edge in run), limits[3]]
    return [(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if a < b]


def longest(done: Ranged) -> tuple[fmpq, fmpq] | None:
    """The longest stretch that the followed contacts cover without a gap."""
    return max(covered(done.pieces), key=lambda run: run[1] - run[0], default=None)


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
