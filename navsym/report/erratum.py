"""The erratum sheet of a paper: where it slips, what to replace by what, and how to see that it is so.

Entries come from refuted claims that name a slip, state a numbered equation or stand in a claim file, each with
the proved claim that corrects it; their wording for an editor comes from a file beside the derivation, or is made
from the formulas where there is none. Slips of the scan, and slips that may be of either, are kept apart from slips
of the authors. A slip that another claim only repeats is told once.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from navsym.claims import Paper, Record, equation_of
from navsym.report.explain import arithmetic, ended, number_words
from navsym.report.formula.sides import Formula, as_printed, coordinates, formula, only_truth
from navsym.report.wording import Wording, Words, pattern_of

MOST_COORDINATES = 6  # more than that nobody inserts by hand


@dataclass(frozen=True, slots=True)
class Check:
    """Arithmetic that a reader can repeat: both sides at a point (the whole line where there is none).

    entry : which entry of a matrix or a list is meant, from 1; 0 where the sides are single
    whole : the printed statement is a whole equation, as in every claim file, and these are its two sides
    """

    at: tuple[Formula, ...]
    entry: int
    printed: str
    derived: str
    whole: bool


@dataclass(frozen=True, slots=True)
class Entry:
    """One correction.

    ids    : claims that it is about
    place  : where in the paper, in words
    slip   : "paper", "scan" or "undecidable"
    words  : wording for an editor, or None
    wrong, right : as printed, and as it should read, made from the claims (empty without a proved correction);
                   where a document was read, its own formula, then what was decided
    rows   : for a correction of several figures: what, as printed, as it should be
    reason : what is wrong
    check  : how to convince oneself, where numbers can
    status : verdict on the corrected statement
    """

    ids: tuple[str, ...]
    place: str
    slip: str
    words: Wording | None
    what: str
    wrong: tuple[Formula, ...]
    right: tuple[Formula, ...]
    right_words: str
    rows: tuple[tuple[str, str, str], ...]
    reason: str
    check: Check | None
    status: str


@dataclass(frozen=True, slots=True)
class Erratum:
    """All corrections of one paper in the order of the paper."""

    paper: Paper
    entries: tuple[Entry, ...]

    def of(self, slip: str) -> tuple[Entry, ...]:
        """Slips of the paper itself, of the scan that was read, or "undecidable" between the two."""
        return tuple(entry for entry in self.entries if entry.slip == slip)


def erratum_of(paper: Paper, records: Sequence[Record], words: Words | None = None) -> Erratum:
    """The sheet of one paper from its records; records of other papers must not be among them.

    Entries with wording stand in the order of the file of wordings, which is that of the paper.
    """
    words = words or {}
    corrections = {record.corrects: record for record in records if record.corrects}
    refuted = [r for r in records if r.status == "REFUTED" and slip_of(paper, r) and not r.cause]
    order = {pattern: place for place, pattern in enumerate(words)}
    entries = [
        entry(paper, group, corrections, words.get(pattern or ""))
        for pattern, group in sorted(grouped(refuted, words), key=lambda pair: order.get(pair[0] or "", len(order)))
    ]
    return Erratum(paper, tuple(entries))


def slip_of(paper: Paper, record: Record) -> str:
    """Who slipped: as declared; else the file, or nobody can tell who; empty for remarks of others on a paper."""
    if record.slip:
        return record.slip
    if is_file(paper.module):
        return "paper"
    return "undecidable" if equation_of(record.number, paper.equations) else ""


def grouped(refuted: Iterable[Record], words: Words) -> list[tuple[str | None, list[Record]]]:
    """Records that one wording covers come together; every other record stands alone."""
    found: list[tuple[str | None, list[Record]]] = []
    for record in refuted:
        pattern = pattern_of(record.number, words)
        known = next((group for key, group in found if key == pattern), None) if pattern else None
        if known is None:
            found.append((pattern, [record]))
        else:
            known.append(record)
    return found


def entry(paper: Paper, group: Sequence[Record], corrections: Mapping[str, Record], words: Wording | None) -> Entry:
    """One entry of the sheet from a group of records, whose first speaks for it; a correction only if it holds."""
    record = group[0]
    fixed = [corrections.get(r.id) for r in group]
    correction = fixed[0]
    holds = correction is not None and correction.status in ("PROVED", "CERTIFIED", "CONFIRMED")
    return Entry(
        ids=tuple(r.id for r in group),
        place=place_of(paper, record.number),
        slip=slip_of(paper, record),
        words=words,
        what=record.title,
        wrong=printed_sides(record),
        right=printed_sides(correction) if holds and correction is not None else (),
        right_words=correction.title if holds and correction is not None else "",
        rows=tuple(row(*pair) for pair in zip(group, fixed, strict=True)) if len(group) > 1 else (),
        reason=ended(capital(words.why if words and words.why else record.reason or "the statement is refuted")),
        check=check_of(record) if len(group) == 1 else None,
        status=correction.status if correction is not None else "",
    )


def row(record: Record, correction: Record | None) -> tuple[str, str, str]:
    """One line of a group: what it is about, as printed, and the correction."""
    what = re.sub(r", as .*$", "", record.title).rstrip(".")
    return what, printed_text(record), printed_text(correction) if correction is not None else "none proved"


def capital(sentence: str) -> str:
    """The sentence with a capital letter."""
    return sentence[:1].upper() + sentence[1:]


def printed_sides(record: Record) -> tuple[Formula, ...]:
    """The formula of the document that was read, where there is one, and the printed side."""
    return tuple(filter(None, (as_printed(record.latex), printed_side(record))))


def printed_side(record: Record) -> Formula:
    """The printed formula; a statement in words, which is only said to hold or not, is its title."""
    if only_truth(record.printed):
        ending = " (does not hold)" if record.printed == "False" else ""
        return Formula(record.title + ending, None, None, words=True)
    return formula(printed_text(record))


def printed_text(record: Record) -> str:
    """What is printed: the side of the paper, or in a claim file, where people wrote both sides, the equation."""
    both = is_file(record.paper) and record.derived and not only_truth(record.printed)
    return f"{record.printed} = {record.derived}" if both else record.printed


def is_file(module: str) -> bool:
    """True for a claim file, False for a paper."""
    return module.endswith(".toml")


def place_of(paper: Paper, number: str) -> str:
    """``equation (4.14), y2``; an unnumbered statement is called by its short name."""
    equation = equation_of(number, paper.equations)
    if equation is None:
        return f"statement “{number}”"
    part = number.removeprefix(equation).strip(".*")
    return f"equation ({equation})" + (f", {part}" if part else "")


def check_of(record: Record) -> Check | None:
    """The first entry that differs at the counterexample, where the sides are numbers there."""
    point = record.counterexample or {}
    line = next((line for line in arithmetic(record) if line.differs), None)
    if line is None or len(point) > MOST_COORDINATES or (not point and line.entry):
        return None
    printed, derived = number_words(line.printed), number_words(line.derived)
    return Check(coordinates(point), line.entry, printed, derived, whole=not record.derived or is_file(record.paper))
