"""A decided claim of a paper, as the ledger and the verbs pass it on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import msgspec

from navsym.claims.claim import Slip
from navsym.claims.paper import Kind
from navsym.claims.verdict import Status
from navsym.core.answers import named
from navsym.core.numbers import Number

#: What varies from run to run, or is too large for a ledger.
NOT_IN_LEDGERS = ("certificate", "seconds")


@dataclass(frozen=True, slots=True, repr=False)
class Record:
    """Name, both sides as text, and verdict of one claim: plain values only, so that it outlives the engines.

    id, paper, number, title, expect, corrects, slip, reason : as in :class:`Claim`; ``corrects`` is a whole id
    status, method, scope, assumptions, evidence, counterexample, difference, certificate : as in :class:`Verdict`
    printed, derived : the sides in the language of files; empty when deriving them was stopped
    latex            : the formula as a document printed it; empty, and in no document, where none is known
    seconds          : how long deriving and deciding took
    kind             : as in :class:`Paper`: a printed formula, a sentence beside one, a remark, or beyond the paper
    cause            : id of the claim whose slip a refuted one only repeats
    statement        : hash of the statement that was decided; in ledgers only, empty where it is not known

    ``Record.from_json(data).to_json() == data`` for an entry of ``navsym verify --json``, and
    ``Record.from_json(data).ledger_json() == data`` for an entry of a ledger.

    >>> record = Record.from_json({
    ...     "id": "paper:1", "paper": "paper", "number": "1", "title": "One is one.", "status": "PROVED",
    ...     "expect": "PROVED", "method": "normal form", "scope": "numbers", "assumptions": [], "printed": "1",
    ...     "derived": "1", "corrects": None, "slip": None, "reason": "", "evidence": "", "counterexample": None,
    ...     "difference": None})
    >>> record.is_expected, "seconds" in record.ledger_json(), record
    (True, False, <paper:1: PROVED; One is one.>)
    """

    id: str
    paper: str
    number: str
    title: str
    status: Status
    expect: Status
    method: str
    scope: str
    assumptions: tuple[str, ...]
    printed: str
    derived: str
    corrects: str | None
    slip: Slip | None
    reason: str
    evidence: str
    counterexample: Mapping[str, str] | None
    difference: Number | None
    kind: Kind = "printed"
    cause: str | None = None
    certificate: Mapping[str, Any] | None = None
    seconds: float = 0.0
    latex: str = ""
    statement: str = ""

    def __repr__(self) -> str:
        return f"<{self.id}: {self.status}; {self.title}>"

    @property
    def is_expected(self) -> bool:
        """True when the verdict is the one that the source declares."""
        return self.status == self.expect

    @property
    def point_text(self) -> str:
        """The counterexample in words: ``T = 1, a = pi``; empty without one."""
        return ", ".join(f"{name} = {value}" for name, value in (self.counterexample or {}).items())

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Record:
        """The record of an entry of a document or of a ledger; further keys are left out."""
        ends = data["difference"]
        return msgspec.convert({**data, "difference": None if ends is None else Number(*ends)}, cls)

    def to_json(self) -> dict[str, Any]:
        """The entry of ``claims`` in the document of ``navsym verify``."""
        ends = self.difference and [self.difference.lower, self.difference.upper]
        names = " ".join(field.name for field in fields(self) if field.name not in ("statement", "latex"))
        return named(self, names) | {"difference": ends} | ({"latex": self.latex} if self.latex else {})

    def ledger_json(self) -> dict[str, Any]:
        """The entry of a ledger: nothing that varies from run to run."""
        values = {key: value for key, value in self.to_json().items() if key not in NOT_IN_LEDGERS}
        return values | ({"statement": self.statement} if self.statement else {})
