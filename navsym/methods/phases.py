"""The complete solution as the length of the interval varies: regimes, boundaries, closed forms.

A regime is a range of lengths with one pattern of instants. Where instants, weights and value have a
closed form it is proved as a primal-dual pair for all lengths of the regime; elsewhere the optimum is
certified for every length by contacts that are followed rigorously, and slivers around boundaries by
two-sided certificates: the value never increases with T, so the values at both ends enclose it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import sympy as sp
from flint import fmpq

from navsym.claims import CERTIFIED, OPEN, Status
from navsym.errors import DomainError
from navsym.methods.guaranteed import solve
from navsym.methods.phases_closed import Closed, candidates, number, prove
from navsym.methods.phases_events import Boundary, boundary
from navsym.methods.phases_family import Family
from navsym.methods.phases_range import followed, fraction_of
from navsym.methods.phases_scan import Span, scan
from navsym.proof.balls import enclose
from navsym.proof.decimals import decimal
from navsym.proof.enclosure import rational
from navsym.text.expression import to_text

POINTS = 5
#: An implicit regime is followed down to this part of the range; below it nothing is claimed.
FLOOR = Fraction(1, 60)
#: Parts of a regime left to two-sided certificates at either end; larger ones where the first is too near.
SLIVERS = (Fraction(1, 2000), Fraction(1, 200), Fraction(1, 30))


@dataclass(frozen=True, slots=True, eq=False)
class Regime:
    """One pattern of instants between two lengths.

    lower, upper : ends, exact or the enclosure's middle
    closed       : closed form, or None
    status       : PROVED, CERTIFIED or OPEN for every length in the regime
    table        : enclosures at some lengths, for regimes without a closed form
    certificate  : of kind "range", or None
    slivers      : ends that the range certificate leaves to two-sided ones: (from, to, lower, upper)
    """

    span: Span
    lower: sp.Expr
    upper: sp.Expr
    closed: Closed | None
    status: Status
    table: tuple[dict[str, str], ...] = ()
    certificate: Mapping[str, Any] | None = None
    slivers: tuple[tuple[str, str, str, str], ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Phases:
    """Regimes in order, the boundaries between them, and what is left uncovered."""

    family: Family
    lower: sp.Expr
    upper: sp.Expr
    regimes: tuple[Regime, ...]
    boundaries: tuple[Boundary, ...]
    uncovered: tuple[tuple[str, str], ...] = field(default=())

    def certificates(self) -> list[dict[str, Any]]:
        """The range certificates of the regimes without a closed form, for ``navsym check``."""
        return [dict(regime.certificate) for regime in self.regimes if regime.certificate is not None]

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


def phases(family: Family, lower: sp.Expr, upper: sp.Expr, *, certify: bool = True) -> Phases:
    """All regimes for lengths between two exact numbers, 0 <= lower < upper.

    certify : follow regimes without a closed form rigorously (seconds to a minute each)
    """
    low, high = inner_range(lower, upper)
    spans = scan(family, low, high)
    guesses = [candidates(family, span) for span in spans]
    firsts = [g[0] if g else None for g in guesses]
    pairs = zip(spans, spans[1:], firsts, firsts[1:], strict=False)
    changes = tuple(boundary(family, a, b, c, d) for a, b, c, d in pairs)
    cuts = [lower, *(middle_of(b) for b in changes), upper]
    regimes, uncovered = [], []
    for k, span in enumerate(spans):
        a, b = cuts[k], cuts[k + 1]
        closed = prove(family, guesses[k], a, b) if guesses[k] else None
        if closed is not None and closed.verdict.status.holds:
            regimes.append(Regime(span, a, b, closed, closed.verdict.status))
        elif certify:
            regime, holes = certified(family, span, a, b, closed)
            regimes.append(regime)
            uncovered += holes
        else:
            regimes.append(Regime(span, a, b, closed, OPEN, table_of(family, span)))
            uncovered.append((end_text(a), end_text(b)))
    return Phases(family, lower, upper, tuple(regimes), changes, tuple(uncovered))


def inner_range(lower: sp.Expr, upper: sp.Expr) -> tuple[Fraction, Fraction]:
    """Rational lengths just inside the range; zero length is a singularity and is left by a small step."""
    for end in (lower, upper):
        if not enclose(end).is_finite():
            raise DomainError(f"range: expected finite lengths; got {end}; give two numbers")
    if not bool(enclose(lower) >= 0) or not bool(enclose(upper - lower) > 0):
        raise DomainError(f"range: expected 0 <= from < to; got {lower} to {upper}; exchange or mend them")
    high = inside(upper, -1)
    low = high / 400 if lower == 0 else inside(lower, 1)
    return low, high


def inside(end: sp.Expr, side: int) -> Fraction:
    value = fraction_of(rational(enclose(end)))
    return (value * (1 + side * Fraction(1, 10**9))).limit_denominator(10**12)


def middle_of(b: Boundary) -> sp.Expr:
    return b.at if b.at is not None else (sp.Rational(b.lower) + sp.Rational(b.upper)) / 2


def certified(
    family: Family, span: Span, lower: sp.Expr, upper: sp.Expr, closed: Closed | None
) -> tuple[Regime, list[tuple[str, str]]]:
    """A regime followed rigorously; holes that are left, as pairs of texts."""
    width = span.upper - span.lower
    for part in SLIVERS:
        start = rounded(max(span.lower + part * width, FLOOR * span.upper), part * width, 1)
        stop = rounded(span.upper - part * width, part * width, -1)
        done = followed(family, span.pattern, start, stop)
        if done.pieces:
            break
    reached = fraction_of(done.reached)
    holes: list[tuple[str, str]] = []
    slivers = []
    for a, b in ((lower, exact(start)), (exact(reached), upper)):
        if bool(enclose(b - a) <= 0):
            continue
        row = sliver(family, a, b)
        if row is None:
            holes.append((end_text(a), end_text(b)))
        else:
            slivers.append(row)
    document = done.document(family.exact(1), family.parameter.name) if done.pieces else None
    status = CERTIFIED if done.pieces else OPEN
    regime = Regime(span, lower, upper, closed if closed and closed.verdict.status.holds else None, status,
                    table_of(family, span), document, tuple(slivers))  # fmt: skip
    return regime, holes


def rounded(x: Fraction, room: Fraction, side: int) -> Fraction:
    """A short decimal next to x, on the given side of it and well within the room."""
    unit = Fraction(1)
    while unit * 4 > room:
        unit /= 10
    return (x // unit + (1 if side > 0 else 0)) * unit


def exact(x: Fraction) -> sp.Rational:
    return sp.Rational(x.numerator, x.denominator)


def sliver(family: Family, lower: sp.Expr, upper: sp.Expr) -> tuple[str, str, str, str] | None:
    """Bounds of the value between two lengths, from the values there: it never increases with T."""
    if lower == 0 or bool(enclose((upper - lower) / upper) > sp.Rational(1, 4)):
        return None
    first, last = solve(family.problem(lower), 15), solve(family.problem(upper), 15)
    return end_text(lower), end_text(upper), last.lower, first.upper


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
        row["dual"] = [to_text(x) for x in closed.dual]
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
        row["slivers"] = [dict(zip(("from", "to", "lower", "upper"), s, strict=True)) for s in regime.slivers]
    return row


def end_text(end: sp.Expr) -> str:
    """An end in the language of files; the middle of an enclosure as a decimal of 34 digits."""
    if end.is_Rational and end.q > 10**9:
        return decimal(fmpq(int(end.p), int(end.q)), 34)
    return to_text(end)


def pattern_rows(family: Family, span: Span) -> list[dict[str, Any]]:
    """The instants of an implicit regime: which ends, how many inside, with which signs."""
    names = {"from": "T", "to": "0"} if family.backward else {"from": "0", "to": "T"}
    rows = [
        {"measurement": family.measurements[k], "at": names.get(kind), "sign": s}
        for k, kind, s in span.pattern
    ]
    return rows[::-1] if family.backward else rows


__all__ = ["Phases", "Regime", "number", "phases"]
