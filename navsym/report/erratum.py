"""The erratum sheet of a paper: what to replace, by what, and how to see that it is so.

Entries come from refuted claims that name a slip, each with the proved claim that corrects it.
Slips of the scan are kept apart from slips of the authors.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from navsym.claims import Paper, equation_of
from navsym.report.page_explain import arithmetic, ball_words, ended
from navsym.report.page_formula import Formula, formula

Record = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Entry:
    """One correction.

    place  : where in the paper, in words
    slip   : "paper" or "scan"
    what   : what the statement is about
    wrong, right : as printed, and as it should read (None when no correction is proved)
    reason : what is wrong, one sentence
    check  : how to convince oneself, sentences
    status : verdict on the corrected statement
    """

    id: str
    place: str
    slip: str
    what: str
    wrong: Formula
    right: Formula | None
    right_words: str
    reason: str
    check: tuple[str, ...]
    status: str


@dataclass(frozen=True, slots=True)
class Erratum:
    """All corrections of one paper, slips of the authors first."""

    paper: Paper
    entries: tuple[Entry, ...]

    @property
    def of_paper(self) -> tuple[Entry, ...]:
        return tuple(entry for entry in self.entries if entry.slip == "paper")

    @property
    def of_scan(self) -> tuple[Entry, ...]:
        return tuple(entry for entry in self.entries if entry.slip == "scan")


def erratum_of(paper: Paper, records: Sequence[Record]) -> Erratum:
    """The sheet of one paper from its records; records of other papers must not be among them."""
    corrections = {record["corrects"]: record for record in records if record["corrects"]}
    refuted = [r for r in records if r["status"] == "REFUTED" and r["slip"] in ("paper", "scan")]
    return Erratum(paper, tuple(entry(paper, record, corrections.get(record["id"])) for record in refuted))


def entry(paper: Paper, record: Record, correction: Record | None) -> Entry:
    holds = correction is not None and correction["status"] in ("PROVED", "CERTIFIED", "CONFIRMED")
    return Entry(
        id=record["id"],
        place=place_of(paper, record["number"]),
        slip=record["slip"],
        what=record["title"],
        wrong=printed_side(record),
        right=printed_side(correction) if holds and correction is not None else None,
        right_words=correction["title"] if holds and correction is not None else "",
        reason=record["reason"],
        check=tuple(check_words(record)),
        status=correction["status"] if correction is not None else "",
    )


def printed_side(record: Record) -> Formula:
    """The printed formula; a statement in words, which is only said to hold or not, is its title."""
    if record["printed"] in ("True", "False"):
        ending = "" if record["printed"] == "True" else " (does not hold)"
        return Formula(record["title"] + ending, None, None)
    return formula(record["printed"])


def place_of(paper: Paper, number: str) -> str:
    """``equation (4.14), y2``; an unnumbered statement is called by its short name."""
    equation = equation_of(number, paper.equations)
    if equation is None:
        return f"statement “{number}”"
    part = number.removeprefix(equation).strip(".*")
    return f"equation ({equation})" + (f", {part}" if part else "")


def check_words(record: Record) -> list[str]:
    """Arithmetic that a reader can repeat."""
    point = record["counterexample"] or {}
    lines = [line for line in arithmetic(record) if line.differs]
    where = "With " + ", ".join(f"{name} = {value}" for name, value in point.items()) if point else "As it stands"
    if not lines:
        return plain_check(record, where)
    line = lines[0]
    entry_words = f" (entry {line.entry})" if line.entry else ""
    printed, derived = ball_words(line.printed), ball_words(line.derived)
    sentence = f"{where} the printed side{entry_words} is {printed}; what follows from the model is {derived}"
    return [ended(sentence)]


def plain_check(record: Record, where: str) -> list[str]:
    """The same where the sides are words, relations or whole optima."""
    if record["difference"]:
        return [f"{where} the two sides of what is printed differ by {record['difference'][0]}."]
    if record["derived"] in ("True", "False"):
        return [f"Decided by: {record['method']}, for {record['scope']}."] if record["scope"] else []
    return [f"The model gives: {record['derived']}."] if 0 < len(record["derived"]) < 300 else []
