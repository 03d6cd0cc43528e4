"""An audit as one page: its sources line by line, coloured by verdict, with formulas and remarks beside the lines.

The page needs no network and no script. Every word of a source, a name or a remark is escaped by the template; formulas
are set in type by :mod:`navsym.report.formula.sides`, which escapes what it takes.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from navsym.audit.syntax import SIZE
from navsym.language.files import read_text
from navsym.report.formula.sides import FOLDED, Formula, formula
from navsym.report.page import MARKS, environment

if TYPE_CHECKING:
    from navsym.audit.answer import Audit, AuditedEntry, AuditedFile

NEAR = 8  # lines shown before and behind one of which something is said
MOST = 12  # notes of a line that are shown unfolded
#: What a line with several verdicts shows: the first of these that occurs.
WORST = ("REFUTED", "OPEN", "CERTIFIED", "PROVED", "formula")


@dataclass(frozen=True, slots=True)
class Note:
    """What is said beside a line.

    status : a verdict; OPEN of a line that is not read; "formula" where nothing was asked
    label  : the question and its entries, or the name of an output
    text   : the ground of the verdict
    sides  : what the code computes, and of REFUTED what is expected
    """

    status: str
    label: str
    text: str
    sides: tuple[tuple[str, Formula], ...] = ()


@dataclass(frozen=True, slots=True)
class Line:
    """A line of a source; ``number`` 0 stands for lines that are left out."""

    number: int
    text: str = ""
    notes: tuple[Note, ...] = ()

    @property
    def status(self) -> str:
        """The worst verdict on the line; empty where nothing is said."""
        present = {note.status for note in self.notes}
        return next((status for status in WORST if status in present), "")


def audit_page(answer: Audit) -> str:
    """The page of an audit as HTML.

    Lines far from all that is said are left out. Raises NavsymError when a source cannot be read again.

    >>> import navsym as nav
    >>> page = audit_page(nav.audit("examples/audit/yaw_jacobian.toml"))
    >>> page.count('<tr id="f1-14" class="refuted">'), "<script" in page
    (1, False)
    """
    notes = collect_notes(answer)
    sources = [(file, [*list_lines(file, notes[file.file])]) for file in answer.files]
    totals = Counter(str(entry.status) for question in answer.questions for entry in question.entries)
    names = ", ".join(Path(file.file).name for file in answer.files)
    template = environment().get_template("audit.html")
    return template.render(
        title=names, sources=sources, questions=answer.questions, numbers=totals, marks=MARKS, most=MOST
    )


def collect_notes(answer: Audit) -> Mapping[str, dict[int, list[Note]]]:
    """File -> line -> what is said there."""
    notes: defaultdict[str, dict[int, list[Note]]] = defaultdict(dict)
    for question in answer.questions:
        alike: dict[tuple[str, int, Note], list[str]] = {}  # a loop assigns many entries in one line
        for entry in question.entries:
            note = Note(str(entry.status), question.name, entry.remark(), sides_of(entry))
            alike.setdefault((entry.file, entry.line, note), []).append(f"{entry.entry[0]},{entry.entry[1]}")
        for (source, line, note), places in alike.items():
            label = f"{question.name} {' '.join(places)}"
            notes[source].setdefault(line, []).append(replace(note, label=label))
    for place, why in answer.meaningless:
        source, _, number = place.rpartition(":")
        if number.isdigit():
            notes[source].setdefault(int(number), []).append(Note("REFUTED", "meaningless", why))
    for file in answer.files:
        for line, why in file.refused:
            notes[file.file].setdefault(line, []).append(Note("OPEN", "not read", why))
        for output in answer.formulas:
            text = f"{output.formula}, when {output.case}" if output.case else output.formula
            notes[file.file].setdefault(output.line, []).append(Note("formula", output.name, text))
    return notes


def sides_of(entry: AuditedEntry) -> tuple[tuple[str, Formula], ...]:
    """The formulas of the statement that was decided; long ones are left out."""
    statement = (entry.certificate or {}).get("statement", {})
    wanted = {"left": "computes", "right": "expected"} if str(entry.status) == "REFUTED" else {"left": "computes"}
    texts = {word: statement[side] for side, word in wanted.items() if side in statement}
    return tuple((word, formula(text)) for word, text in texts.items() if len(text) <= FOLDED)


def list_lines(file: AuditedFile, notes: Mapping[int, list[Note]]) -> Iterator[Line]:
    """The lines near those of which something is said; notes without a line come before the first."""
    texts = [text.rstrip("\r") for text in read_text(file.file, SIZE).split("\n")]
    near = {n for line in notes for n in range(line - NEAR, line + NEAR + 1)} or {*range(1, len(texts) + 1)}
    elsewhere = [note for line, several in notes.items() if not 0 < line <= len(texts) for note in several]
    if elsewhere:
        yield Line(0, "", tuple(elsewhere))
    last = 0
    for number, text in enumerate(texts, start=1):
        if number not in near:
            continue
        if number != last + 1:
            yield Line(0)
        last = number
        yield Line(number, text.expandtabs(4), tuple(notes.get(number, ())))
