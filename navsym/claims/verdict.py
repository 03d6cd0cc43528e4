"""How far a claim holds, and why one may believe it."""

from __future__ import annotations

import html
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from navsym.claims.display import count_in_words, mark_verdict, write_card
from navsym.claims.formula import Formula
from navsym.core.answers import Answer, Answers, named
from navsym.core.errors import NavsymError
from navsym.core.numbers import Number
from navsym.core.tables import Table


class Status(StrEnum):
    """The five verdicts, from the strongest to the honest shrug.

    PROVED    exact algebra decides it on the whole stated scope
    CERTIFIED ball or rational arithmetic excludes failure on the whole stated box
    CONFIRMED sampled: the evidence gives the number of points and the largest residual
    REFUTED   an exact point where a ball excludes the printed statement
    OPEN      none of these; the evidence says what was tried

    >>> Status("CERTIFIED").holds, Status("CONFIRMED").holds
    (True, False)
    """

    PROVED = "PROVED"
    CERTIFIED = "CERTIFIED"
    CONFIRMED = "CONFIRMED"
    REFUTED = "REFUTED"
    OPEN = "OPEN"

    @property
    def holds(self) -> bool:
        """True for the two verdicts on which code may be exported."""
        return self in (Status.PROVED, Status.CERTIFIED)


PROVED, CERTIFIED, CONFIRMED, REFUTED, OPEN = Status


@dataclass(frozen=True, slots=True, repr=False)
class Verdict(Answer):
    """A status with its reasons.

    status         : one of the five words
    method         : the rung of the ladder that decided
    scope          : what the quantifier covered, for example ``"all real T, omega"``
    assumptions    : what was taken to be nonzero, nonnegative or inside a range
    evidence       : a sentence for people: what was reduced, sampled or tried
    counterexample : for REFUTED, symbol name -> exact number in the language of files
    difference     : for REFUTED, an enclosure of left - right there
    certificate    : plain JSON data that :meth:`check` replays, or None
    formula        : both sides as the author wrote them, or None for a claim of a paper

    >>> import navsym as nav
    >>> verdict = nav.prove("2*sin(a) = sin(2*a)")
    >>> verdict
    <REFUTED: 2*sin(a) = sin(2*a); exact point, ball arithmetic; at a = 1: left - right = 0.77364454279011131…>
    >>> verdict.holds, dict(verdict.counterexample)
    (False, {'a': '1'})
    >>> nav.prove("(a - b)*(a + b) = a**2 - b**2").certificate["kind"]
    'proof'
    """

    status: Status
    method: str
    scope: str = ""
    assumptions: tuple[str, ...] = ()
    evidence: str = ""
    counterexample: Mapping[str, str] | None = None
    difference: Number | None = None
    certificate: Mapping[str, Any] | None = None
    formula: Formula | None = field(default=None, compare=False)

    @property
    def id(self) -> str:
        """The label of the formula; empty without one."""
        return self.formula.id if self.formula else ""

    @property
    def holds(self) -> bool:
        """True for PROVED and CERTIFIED: what an ``assert`` and an export rely on."""
        return self.status.holds

    def __repr__(self) -> str:
        found = self.point_text() if self.counterexample else self.scope
        parts = [str(self.formula or ""), self.method, found]
        return f"<{self.status}: {'; '.join(part for part in parts if part)}>"

    def document(self) -> dict[str, Any]:
        """One entry of ``claims`` in the JSON document of ``navsym prove``."""
        head = {"id": self.formula.id} if self.formula else {}
        wrong = {"counterexample": None, "difference": None}
        if self.status == REFUTED:
            wrong = {"counterexample": dict(self.counterexample or {})} | named(self, "difference")
        return {
            **head,
            **named(self, "status method scope assumptions evidence"),
            **wrong,
            "certificate": self.certificate,
        }

    def point_text(self) -> str:
        """The counterexample in words, ``at a = 1``, with where the difference lies."""
        point = ", ".join(f"{name} = {value}" for name, value in (self.counterexample or {}).items()) or "no symbols"
        return f"at {point}" + (f": left - right {self.difference.words}" if self.difference else "")

    @property
    def reason(self) -> str:
        """The verdict's ground in a few words: the counterexample, the assumptions, the scope or what was tried."""
        if self.status == REFUTED:
            return self.point_text()
        return f"assuming {'; '.join(self.assumptions)}" if self.assumptions else self.scope or self.evidence

    def _repr_latex_(self) -> str | None:
        """The formula, with the verdict behind it."""
        return self.formula._repr_latex_()[:-1] + rf"\qquad \text{{{self.status}}}$" if self.formula else None

    def _repr_html_(self) -> str:
        """A card for notebooks: verdict, formula, scope, counterexample, assumptions."""
        head = f"{mark_verdict(str(self.status))} by {html.escape(self.method)}"
        lines = [f"{head}, {html.escape(self.scope)}" if self.scope else head]
        if self.formula:
            lines.insert(0, html.escape(self.formula._repr_latex_()))
        if self.counterexample:
            lines.append(html.escape(self.point_text()))
        if self.assumptions:
            lines.append(html.escape("assuming " + ", ".join(self.assumptions)))
        return write_card(lines, str(self.status))


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Verdicts(Answers[Verdict]):
    """The verdicts of a claim file, in its order; by place or by the id of a claim.

    verdicts : one for each claim
    errors   : id -> why a side of that claim has no value

    >>> import navsym as nav
    >>> verdicts = nav.prove("examples/formulas.toml")
    >>> verdicts
    <3 verdicts: 2 PROVED, 1 REFUTED>
    >>> verdicts["half-angle"].holds, verdicts.holds
    (True, False)
    """

    verdicts: tuple[Verdict, ...]
    errors: Mapping[str, NavsymError] = field(default_factory=dict)

    @property
    def holds(self) -> bool:
        """True when every claim is PROVED or CERTIFIED."""
        return all(verdict.holds for verdict in self.verdicts)

    @property
    def first_error(self) -> NavsymError | None:
        """Why the first claim with an undefined side has no value, or None."""
        return next(iter(self.errors.values()), None)

    def __repr__(self) -> str:
        counts = {status: sum(verdict.status == status for verdict in self.verdicts) for status in Status}
        told = ", ".join(f"{n} {status}" for status, n in counts.items() if n)
        return f"<{count_in_words(len(self), 'verdict')}: {told}>"

    def certificates(self) -> list[Mapping[str, Any]]:
        """The certificates of all verdicts that have one."""
        return [item for verdict in self.verdicts for item in verdict.certificates()]

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym prove``."""
        records = [verdict.document() for verdict in self.verdicts]
        records = [{**r, **self.errors[r["id"]].as_json()} if r.get("id") in self.errors else r for r in records]
        return {**(self.first_error.as_json() if self.first_error else {}), "claims": records}

    def table(self) -> Table:
        """A line for each claim."""
        rows = [
            (v.formula.id if v.formula else "", v.formula or "", v.status, v.method, v.reason) for v in self.verdicts
        ]
        return ("claim", "formula", "verdict", "method", "ground"), rows
