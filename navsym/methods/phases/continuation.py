"""The complete solution as a parameter varies: regimes, boundaries, closed forms.

A regime is a range of the parameter with one pattern of instants. Where instants, weights and value have a
closed form it is proved as a primal-dual pair for all values of the regime; elsewhere the optimum is
certified for every value by contacts that are followed rigorously, and slivers around boundaries by
two-sided certificates.
"""

from __future__ import annotations

import html
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

import sympy as sp
from flint import arb, fmpq

from navsym.claims import CERTIFIED, OPEN, Status
from navsym.claims.display import card, displayed, latex_of, table
from navsym.errors import DomainError
from navsym.methods.guaranteed.solver import solve
from navsym.methods.phases.closed import Closed, candidates, prove
from navsym.methods.phases.dependent import without_dependent
from navsym.methods.phases.events import Boundary, boundary
from navsym.methods.phases.family import Family
from navsym.methods.phases.range import followed, fraction_of
from navsym.methods.phases.scan import COUNT, Span, scan
from navsym.methods.phases.singular import Singular, singular_values
from navsym.methods.phases.slivers import Sliver, slivers
from navsym.proof.balls import enclose
from navsym.proof.decimals import decimal, lower_end, upper_end
from navsym.proof.decimals import exact as exact_decimal
from navsym.proof.optimality.enclosure import rational
from navsym.proof.optimality.range import Ranged
from navsym.text.expression import to_text

POINTS = 5
#: Next to a singular value this part of the range is left, and named in ``uncovered``.
MARGIN = Fraction(1, 100_000)
#: A span below this part of the range is given up when its neighbours are proved to meet.
SHORT = Fraction(1, 500)
DIGITS = 34


@dataclass(frozen=True, slots=True, eq=False)
class Regime:
    """One pattern of instants between two lengths.

    lower, upper : ends, exact or the enclosure's middle
    closed       : closed form, or None
    status       : PROVED, CERTIFIED or OPEN for every length in the regime
    table        : enclosures at some lengths, for regimes without a closed form
    certificates : of kind "range" and what belongs to it
    slivers      : two-sided certificates of what the range certificate leaves
    held         : values between which the pattern itself is proved, without its slivers
    """

    span: Span
    lower: sp.Expr
    upper: sp.Expr
    closed: Closed | None
    status: Status
    table: tuple[dict[str, str], ...] = ()
    certificates: tuple[Mapping[str, Any], ...] = ()
    slivers: tuple[Sliver, ...] = ()
    held: tuple[fmpq, fmpq] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Phases:
    """Regimes in order, the boundaries between them, and what is left uncovered."""

    family: Family
    lower: sp.Expr
    upper: sp.Expr
    regimes: tuple[Regime, ...]
    boundaries: tuple[Boundary, ...]
    uncovered: tuple[tuple[str, str], ...] = field(default=())
    ties: tuple[Mapping[str, Any], ...] = field(default=())

    def certificates(self) -> list[dict[str, Any]]:
        """Certificates of the regimes without a closed form and of slivers, for ``navsym check``."""
        ranges = [dict(c) for regime in self.regimes for c in regime.certificates]
        thin = [dict(s.certificate) for regime in self.regimes for s in regime.slivers]
        return ranges + thin + [dict(tie) for tie in self.ties]

    def _repr_html_(self) -> str:
        """The regimes as a table, for notebooks."""
        name, heads = self.family.parameter.name, ("from", "to", "value", "instants", "verdict")
        rows = [
            (
                displayed(latex_of(r.lower)), displayed(latex_of(r.upper)),
                displayed(latex_of(r.closed.value)) if r.closed else "a table of enclosures",
                displayed(latex_of(r.closed.places)) if r.closed else "", str(r.status),
            )
            for r in self.regimes
        ]  # fmt: skip
        return card([html.escape(f"{self.family.target} by {name}"), table(heads, rows)])

    def document(self) -> dict[str, Any]:
        """The answer of ``navsym phases``."""
        return {
            "target": self.family.target, "parameter": self.family.parameter.name,
            "range": [to_text(self.lower), to_text(self.upper)],
            "regimes": [regime_row(self.family, regime) for regime in self.regimes],
            "boundaries": [
                {"at": None if b.at is None else to_text(b.at), "lower": b.lower, "upper": b.upper, "why": b.why}
                for b in self.boundaries
            ],
            "uncovered": [list(pair) for pair in self.uncovered],
        }  # fmt: skip


def phases(
    family: Family, lower: sp.Expr, upper: sp.Expr, *, certify: bool = True,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> Phases:  # fmt: skip
    """All regimes for values of the parameter between two exact numbers.

    The range is split at singular values. certify : follow regimes without a closed form rigorously.
    progress : called with (finished, all) steps of the search: each stretch is scanned, each regime settled
    Raises DomainError for a range without length, and lengths of the interval below zero.
    """
    need_range(family, lower, upper)
    between = inside_of(lower, upper)
    family, ties = without_dependent(family, between)
    singular = singular_values(family, lower, upper)
    inner = [s for s in singular if bool(enclose(s.at - lower) > 0) and bool(enclose(upper - s.at) > 0)]
    cuts = [lower, *(s.at for s in inner), upper]
    names = {s.at for s in singular}
    steps = Steps(progress, (len(cuts) - 1) * (COUNT - 1))
    parts = [stretch(family, a, b, names, certify, steps) for a, b in pairwise(cuts)]
    regimes = [regime for part in parts for regime in part.regimes]
    changes = [event(s) for s in singular if not (s.at == lower == 0 and family.growing)]
    changes += [b for part in parts for b in part.boundaries]
    changes.sort(key=lambda b: sp.Rational(b.lower))
    uncovered = [pair for part in parts for pair in part.uncovered]
    return Phases(family, lower, upper, tuple(regimes), tuple(changes), tuple(uncovered), ties)


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


def need_range(family: Family, lower: sp.Expr, upper: sp.Expr) -> None:
    for end in (lower, upper):
        if end.free_symbols or not enclose(end).is_finite():
            raise DomainError(f"range: expected finite numbers; got {end}; give two numbers")
    if not bool(enclose(upper - lower) > 0):
        raise DomainError(f"range: expected from < to; got {lower} to {upper}; exchange or mend them")
    if family.growing and not bool(enclose(lower) >= 0):
        raise DomainError(f"range: expected lengths 0 <= from < to; got {lower} to {upper}; mend them")


def stretch(
    family: Family, lower: sp.Expr, upper: sp.Expr, singular: set[sp.Expr], certify: bool, steps: Steps
) -> Phases:
    """All regimes between two values without a singular one inside."""
    low, high = inner_range(lower, upper, singular)
    spans = without_accidents(family, scan(family, low, high, step=steps.did))
    steps.found(len(spans))
    guesses = []
    for span in spans:
        guesses.append(candidates(family, span))
        steps.did(Steps.LOOKS)
    firsts = [g[0] if g else None for g in guesses]
    pairs = zip(spans, spans[1:], firsts, firsts[1:], strict=False)
    changes = tuple(boundary(family, a, b, c, d) for a, b, c, d in pairs)
    cuts = [lower, *(middle_of(b) for b in changes), upper]
    limits = limits_of(family, lower, upper, low, high, changes, singular)
    regimes, uncovered = [], []
    for k, span in enumerate(spans):
        closed = prove(family, guesses[k], cuts[k], cuts[k + 1]) if guesses[k] else None
        held = closed if closed is not None and closed.verdict.status.holds else None
        regime, holes = regime_of(family, span, (cuts[k], cuts[k + 1]), limits[k], held, certify)
        regimes.append(regime)
        uncovered += holes
        steps.did(Steps.LOOKS)
    honest = tuple(b if b.proved else between(b, *pair) for b, pair in zip(changes, pairwise(regimes), strict=True))
    return Phases(family, lower, upper, tuple(regimes), honest, tuple(uncovered))


def without_accidents(family: Family, spans: list[Span]) -> list[Span]:
    """Spans without short ones between neighbours that are proved to follow each other: there contacts merge, and
    the search in double precision takes one pattern for another."""
    short = SHORT * (spans[-1].upper - spans[0].lower)
    kept, rest = spans[:1], spans[1:]
    while rest:
        span = rest.pop(0)
        if rest and span.upper - span.lower < short:
            change = boundary(family, kept[-1], rest[0], None, None)
            if change.proved:
                cut = fraction_of(rational(enclose(middle_of(change), bits=200)))
                kept[-1], rest[0] = replace(kept[-1], upper=cut), replace(rest[0], lower=cut)
                continue
        kept.append(span)
    return kept


def between(guess: Boundary, before: Regime, after: Regime) -> Boundary:
    """A change that was not located lies between the last value of one proved pattern and the first of the other.

    Where a pattern is proved nowhere, the bracket is that of the search, and the regime is uncovered.
    """
    last = before.held[1] if before.held else exact_fraction(before.span.lower)
    first = after.held[0] if after.held else exact_fraction(after.span.upper)
    return replace(guess, lower=lower_end(arb(last), DIGITS), upper=upper_end(arb(first), DIGITS))


def exact_fraction(x: Fraction) -> fmpq:
    return fmpq(x.numerator, x.denominator)


def inner_range(lower: sp.Expr, upper: sp.Expr, singular: set[sp.Expr]) -> tuple[Fraction, Fraction]:
    """Rational values just inside the range, further inside at singular ends."""
    a, b = (fraction_of(rational(enclose(e, bits=200))) for e in (lower, upper))
    steps = [Fraction(1, 400) if e in singular else Fraction(1, 10**9) for e in (lower, upper)]
    low, high = a + steps[0] * (b - a), b - steps[1] * (b - a)
    return low.limit_denominator(10**12), high.limit_denominator(10**12)


def middle_of(b: Boundary) -> sp.Expr:
    return b.at if b.at is not None else (sp.Rational(b.lower) + sp.Rational(b.upper)) / 2


Limits = tuple[fmpq, fmpq, fmpq, fmpq]


def limits_of(
    family: Family, lower: sp.Expr, upper: sp.Expr, low: Fraction, high: Fraction,
    changes: Sequence[Boundary], singular: set[sp.Expr],
) -> list[Limits]:  # fmt: skip
    """For every regime: where it must be covered (outer) and where exact contacts are followed (inner)."""
    part = MARGIN * (high - low)
    margin = fmpq(part.numerator, part.denominator)
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
    family: Family, span: Span, ends: tuple[sp.Expr, sp.Expr], limits: Limits, closed: Closed | None, certify: bool
) -> tuple[Regime, list[tuple[str, str]]]:
    """One regime: its proved closed form, or contacts followed for every value, slivers and holes."""
    a, b = ends
    if closed is not None:
        return Regime(span, a, b, closed, closed.verdict.status, held=(limits[1], limits[2])), []
    if not certify:
        return Regime(span, a, b, None, OPEN, table_of(family, span)), [(end_text(a), end_text(b))]
    done = followed(family, span.pattern, limits[1], limits[2])
    holes, thin = [], []
    for left, right in rests(done, limits):
        made = slivers(family, left, right)
        if made is None:
            holes.append((end_text(number_of(left)), end_text(number_of(right))))
        else:
            thin += made
    status = CERTIFIED if done.ends is not None else OPEN
    return Regime(span, a, b, None, status, table_of(family, span), done.documents, tuple(thin), done.ends), holes


def rests(done: Ranged, limits: Limits) -> list[tuple[fmpq, fmpq]]:
    """Stretches of the regime that the followed contacts leave."""
    if done.ends is None:
        return [(limits[0], limits[3])]
    first, last = done.ends
    return [(a, b) for a, b in ((limits[0], first), (last, limits[3])) if a < b]


def number_of(x: fmpq) -> sp.Rational:
    return sp.Rational(int(x.p), int(x.q))


def exact(x: Fraction) -> sp.Rational:
    return sp.Rational(x.numerator, x.denominator)


def table_of(family: Family, span: Span) -> tuple[dict[str, str], ...]:
    """Enclosures of the value at a few lengths."""
    rows = []
    for k in range(POINTS):
        T = (span.lower + (span.upper - span.lower) * Fraction(2 * k + 1, 2 * POINTS)).limit_denominator(1000)
        found = solve(family.problem(exact(T)), 20)
        rows.append({family.parameter.name: str(T), "lower": found.lower, "upper": found.upper})
    return tuple(rows)


def regime_row(family: Family, regime: Regime) -> dict[str, Any]:
    row: dict[str, Any] = {"from": end_text(regime.lower), "to": end_text(regime.upper)}
    if regime.closed is not None:
        closed = regime.closed
        order = range(len(closed.places) - 1, -1, -1) if family.backward else range(len(closed.places))
        row["value"] = to_text(closed.value)
        row["support"] = [
            {"measurement": family.measurements[closed.panels[i]], "at": to_text(family.time(closed.places[i])),
             "weight": to_text(closed.weights[i])} for i in order
        ]  # fmt: skip
        dual = dict(zip(family.unknowns, closed.dual, strict=True))
        row["dual"] = [to_text(dual.get(k, sp.S.Zero)) for k in range(len(dual) + len(family.left_out))]
        row["method"] = closed.verdict.method
    else:
        row |= {
            "value": None,
            "support": pattern_rows(family, regime.span),
            "dual": None,
            "table": list(regime.table),
        }
    row["status"] = str(regime.status)
    if regime.slivers:
        row["slivers"] = [
            dict(zip(("from", "to", "lower", "upper"), s.row(), strict=True)) for s in regime.slivers
        ]
    return row


def end_text(end: sp.Expr) -> str:
    """An end in the language of files; the middle of an enclosure as a decimal of 34 digits."""
    if end.is_Rational and end.q > 10**9:
        return decimal(fmpq(int(end.p), int(end.q)), 34)
    return to_text(end)


def pattern_rows(family: Family, span: Span) -> list[dict[str, Any]]:
    """The instants of an implicit regime: which ends, how many inside, with which signs."""
    ends = (to_text(family.time(family.start)), to_text(family.time(family.stop)))
    names = dict(zip(("from", "to"), ends, strict=True))
    rows = [
        {"measurement": family.measurements[k], "at": names.get(kind), "sign": s}
        for k, kind, s in span.pattern
    ]
    return rows[::-1] if family.backward else rows


__all__ = ["Phases", "Regime", "phases"]
