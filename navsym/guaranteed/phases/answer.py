"""The answer: regimes in order, boundaries between them, what is left; as a document, as certificates, as a table."""

from __future__ import annotations

import html
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import sympy as sp
from flint import fmpq

from navsym.claims import Status
from navsym.claims.display import card, displayed, latex_of, table
from navsym.core.exact import decimal, to_fmpq
from navsym.guaranteed.phases.boundaries import Boundary
from navsym.guaranteed.phases.closed_forms import Closed
from navsym.guaranteed.phases.family import Family
from navsym.guaranteed.phases.narrow import Sliver
from navsym.guaranteed.phases.patterns import Span
from navsym.language.expression import to_text

DIGITS = 34


@dataclass(frozen=True, slots=True, eq=False)
class Regime:
    """One pattern of instants between two lengths.

    family       : the problems to which it belongs
    lower, upper : ends, exact or the enclosure's middle
    closed       : closed form, or None
    status       : PROVED, CERTIFIED or OPEN for every length in the regime
    table        : enclosures at some lengths, for regimes without a closed form
    certificates : of kind "range" and what belongs to it
    slivers      : two-sided certificates of what the range certificate leaves
    held         : values between which the pattern itself is proved, without its slivers
    alone        : values between which no other estimator is proved to be optimal, or None
    """

    family: Family
    span: Span
    lower: sp.Expr
    upper: sp.Expr
    closed: Closed | None
    status: Status
    table: tuple[dict[str, Any], ...] = ()
    certificates: tuple[Mapping[str, Any], ...] = ()
    slivers: tuple[Sliver, ...] = ()
    held: tuple[fmpq, fmpq] | None = None
    alone: tuple[fmpq, fmpq] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Phases:
    """Regimes in order, the boundaries between them, what is left uncovered, and what was given up at the limit."""

    family: Family
    lower: sp.Expr
    upper: sp.Expr
    regimes: tuple[Regime, ...]
    boundaries: tuple[Boundary, ...]
    uncovered: tuple[tuple[str, str], ...] = field(default=())
    ties: tuple[Mapping[str, Any], ...] = field(default=())
    given_up: tuple[str, ...] = field(default=())

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
                displayed(latex_of(r.lower)),
                displayed(latex_of(r.upper)),
                displayed(latex_of(r.closed.value)) if r.closed else "a table of enclosures",
                displayed(latex_of(r.closed.places)) if r.closed else "",
                str(r.status),
            )
            for r in self.regimes
        ]
        return card([html.escape(f"{self.family.target} by {name}"), table(heads, rows)])

    def document(self) -> dict[str, Any]:
        """The answer of ``navsym phases``."""
        return {
            "target": self.family.target,
            "parameter": self.family.parameter.name,
            "range": [to_text(self.lower), to_text(self.upper)],
            "regimes": [regime_row(regime) for regime in self.regimes],
            "boundaries": [
                {"at": None if b.at is None else to_text(b.at), "lower": b.lower, "upper": b.upper, "why": b.why}
                for b in self.boundaries
            ],
            "uncovered": [list(pair) for pair in self.uncovered],
        } | ({"given_up": list(self.given_up)} if self.given_up else {})


def regime_row(regime: Regime) -> dict[str, Any]:
    """A regime of the document: its ends, value, instants, dual and verdict."""
    family = regime.family
    row: dict[str, Any] = {"from": end_text(regime.lower), "to": end_text(regime.upper)}
    if regime.closed is not None:
        closed = regime.closed
        order = range(len(closed.places) - 1, -1, -1) if family.backward else range(len(closed.places))
        row["value"] = to_text(closed.value)
        row["support"] = [
            {
                "measurement": family.measurements[closed.panels[i]],
                "at": to_text(family.time(closed.places[i])),
                "weight": to_text(closed.weights[i]),
            }
            for i in order
        ]
        dual = dict(zip(family.unknowns, closed.dual, strict=True))
        row["dual"] = [to_text(dual.get(k, sp.S.Zero)) for k in range(len(dual) + len(family.left_out))]
        row["method"] = closed.verdict.method
    else:
        row |= {"value": None, "support": pattern_rows(family, regime.span), "dual": None, "table": list(regime.table)}
    row["status"] = str(regime.status)
    row["unique"] = True if regime.alone else None
    if regime.alone:
        row["unique_between"] = [decimal(end, DIGITS, side) for end, side in zip(regime.alone, (1, -1), strict=True)]
    if regime.slivers:
        row["slivers"] = [dict(zip(("from", "to", "lower", "upper"), s.row(), strict=True)) for s in regime.slivers]
    return row


def end_text(end: sp.Expr, side: int = 0) -> str:
    """An end in the language of files; the middle of an enclosure as a decimal of 34 digits, rounded to a side."""
    if end.is_Rational and end.q > 10**9:
        return decimal(to_fmpq(end), DIGITS, side)
    return to_text(end)


def pattern_rows(family: Family, span: Span) -> list[dict[str, Any]]:
    """The instants of an implicit regime: which ends, how many inside, with which signs."""
    rows = []
    for k, kind, s in span.pattern:
        start, stop = family.panels[k]
        at = {"from": to_text(family.time(start)), "to": to_text(family.time(stop))}.get(kind)
        rows.append({"measurement": family.measurements[k], "at": at, "sign": s})
    return rows[::-1] if family.backward else rows
