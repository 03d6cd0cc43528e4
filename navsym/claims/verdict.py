"""How far a claim holds, and why one may believe it."""

from __future__ import annotations

import html
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from navsym.claims.display import card, verdict_words


class Status(StrEnum):
    """The five verdicts, from the strongest to the honest shrug.

    PROVED    exact algebra decides it on the whole stated scope
    CERTIFIED ball or rational arithmetic excludes failure on the whole stated box
    CONFIRMED sampled: the evidence gives the number of points and the largest residual
    REFUTED   an exact point where a ball excludes the printed statement
    OPEN      none of these; the evidence says what was tried
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


@dataclass(frozen=True, slots=True)
class Verdict:
    """A status with its reasons.

    method         : the rung of the ladder that decided
    scope          : what the quantifier covered, for example ``"all real T, omega"``
    assumptions    : what was taken to be nonzero, nonnegative or inside a range
    evidence       : a sentence for people: what was reduced, sampled or tried
    counterexample : for REFUTED, symbol name -> exact number in the language of files
    difference     : for REFUTED, decimal strings (lower, upper) that enclose left - right there
    certificate    : plain JSON data that ``navsym check`` replays, or None
    """

    status: Status
    method: str
    scope: str = ""
    assumptions: tuple[str, ...] = ()
    evidence: str = ""
    counterexample: Mapping[str, str] | None = None
    difference: tuple[str, str] | None = None
    certificate: Mapping[str, Any] | None = field(default=None, repr=False)

    def _repr_html_(self) -> str:
        """A card for notebooks."""
        head = f"{verdict_words(str(self.status))} by {html.escape(self.method)}"
        lines = [f"{head}, {html.escape(self.scope)}" if self.scope else head]
        if self.counterexample:
            point = ", ".join(f"{name} = {value}" for name, value in self.counterexample.items())
            between = f"; the difference is {self.difference[0]}" if self.difference else ""
            lines.append(html.escape(f"at {point}{between}"))
        if self.assumptions:
            lines.append(html.escape("assuming " + ", ".join(self.assumptions)))
        return card(lines, str(self.status))
