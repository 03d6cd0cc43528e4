"""A claim: a statement with a name, a source and the verdict that its author expects."""

from __future__ import annotations

import functools
import html
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Literal, cast, get_args

from navsym.claims.display import mark_verdict, write_card
from navsym.claims.statement import Equation, Statement
from navsym.claims.verdict import PROVED, REFUTED, Status, Verdict
from navsym.core.errors import MissingEngineError

#: Who slipped: the authors, the copy that was read, or one of the two, nobody can tell which.
Slip = Literal["paper", "scan", "undecidable"]

#: The package of the papers; in a checkout it is the folder ``derivations/``.
PAPERS = "navsym_papers"


@dataclass(frozen=True, slots=True, eq=False)
class Claim:
    """One checkable statement of a paper.

    module   : derivation module, for example ``"guaranteed_velocity"``
    number   : equation and part, ``"4.12.Phi21"``; an unnumbered statement has a short name
    title    : one sentence, the first line of the docstring of ``derive``
    derive   : function without arguments that returns the statement
    expect   : the verdict that the source declares
    corrects : number of the refuted claim that this one replaces
    slip     : where the printed side went wrong: ``"paper"``, ``"scan"``, or ``"undecidable"`` between the two
    reason   : one sentence: what is wrong and how one can tell
    place    : file and line of a claim that no Python states; empty for others
    complete : what is added to a verdict, such as the conditions that only the text shows
    latex    : the formula as a document printed it; empty where none is known
    either   : True when ``expect`` only says that it holds: PROVED and CERTIFIED are both as declared
    """

    module: str
    number: str
    title: str
    derive: Callable[[], Statement]
    expect: Status = PROVED
    corrects: str | None = None
    slip: Slip | None = None
    reason: str = ""
    place: str = ""
    complete: Callable[[Verdict], Verdict] | None = None
    either: bool = False
    latex: str = ""

    @property
    def id(self) -> str:
        """``module:number``, under which verbs and files name the claim."""
        return f"{self.module}:{self.number}"

    @property
    def corrects_id(self) -> str | None:
        """The id of the claim that this one corrects, or None."""
        return None if self.corrects is None else f"{self.module}:{self.corrects}"

    def _repr_html_(self) -> str:
        """A card for notebooks; nothing is derived or decided for it."""
        lines = [f"<b>{html.escape(self.id)}</b> {html.escape(self.title)}"]
        lines.append(f"declared {mark_verdict(str(self.expect))}")
        if self.corrects_id:
            lines.append(html.escape(f"corrects {self.corrects_id}"))
        if self.reason:
            lines.append(html.escape(f"{self.slip or 'note'}: {self.reason}"))
        return write_card(lines, str(self.expect))


#: What a claim's function gives: its statement, or pairs of printed and derived sides, case by case.
Derive = Callable[[], Statement | Iterator[tuple[Any, Any]]]


def claim(
    number: str,
    title: str | None = None,
    derive: Derive | None = None,
    *,
    expect: Status | None = None,
    corrects: str | None = None,
    slip: Slip | None = None,
    reason: str = "",
) -> Any:
    """A :class:`Claim` of a number, a title and a function that states it; without the function a decorator of one.

    The number may be a whole heading (:func:`claims`). Without a title it is the first line of the docstring. A slip is
    declared REFUTED, a number with a star corrects the one without. A function that gives pairs of a printed and a
    derived side states that each pair is equal.
    """
    number, *cells = number.split(" | ", 2)
    slip, expect, reason = read_slip(cells[1]) if cells[1:] else (slip, expect, reason)

    def make(derive: Derive) -> Claim:
        return Claim(
            module=derivation_name(derive),
            number=number,
            title=cells[0] if cells else title if title is not None else title_of(derive),
            derive=collect_pairs(derive),
            expect=expect or (REFUTED if slip else PROVED),
            corrects=corrects or (number.removesuffix("*") if number.endswith("*") else None),
            slip=slip,
            reason=reason,
        )

    return make if derive is None else make(derive)


def claims(*rows: str | Derive) -> tuple[Claim, ...]:
    """The claims of a section: headings and the functions that state them, in turn.

    A heading is ``number | title``, with ``| paper: reason`` behind it for a slip of the paper, ``| scan: …`` or
    ``| undecidable: …``; ``| CERTIFIED`` for another verdict than PROVED, ``| note: reason`` for a word on it.

    >>> [one.reason for one in claims("5 | The sum. | paper: a sign is lost", lambda: Equation(-2, 1 + 1))]
    ['a sign is lost']
    """
    if len(rows) % 2 or not all(isinstance(text, str) for text in rows[::2]) or not all(map(callable, rows[1::2])):
        raise ValueError(
            "claims: expected headings and functions in turn; got another order; put a heading before each"
        )
    return tuple(claim(cast(str, text), derive=cast(Derive, f)) for text, f in zip(rows[::2], rows[1::2], strict=True))


def read_slip(text: str) -> tuple[Slip | None, Status | None, str]:
    """Who slipped, or the verdict declared, and the reason: the end of a heading."""
    word, _, reason = text.partition(": ")
    if word in get_args(Slip):
        return cast(Slip, word), None, reason
    return None, None if word == "note" else Status(word), reason


def collect_pairs(derive: Callable[[], Any]) -> Callable[[], Statement]:
    """A function that gives a statement, or one equation of all pairs, entry by entry."""

    @functools.wraps(derive)
    def collected() -> Statement:
        statement = derive()
        if not isinstance(statement, Iterator):
            return cast(Statement, statement)
        printed: list[Any] = []
        derived: list[Any] = []
        for left, right in statement:
            printed += entries_of(left)
            derived += entries_of(right)
        return Equation(printed, derived)

    return collected


def entries_of(side: Any) -> list[Any]:
    """The entries of a list or a matrix, row by row; or the one expression."""
    return list(side) if isinstance(side, (list, tuple)) or hasattr(side, "shape") else [side]


def derivation_name(derive: Derive) -> str:
    """Name of the derivation module: the part of the dotted name after the package of the papers."""
    parts = derive.__module__.split(".")
    return parts[1] if parts[0] == PAPERS and len(parts) > 1 else parts[-1]


def title_of(derive: Derive) -> str:
    """First line of the docstring of a claim's function: the title.

    Raises MissingEngineError under -OO, which drops docstrings, and ValueError without one.
    """
    text = (derive.__doc__ or "").strip()
    if not text and sys.flags.optimize > 1:
        raise MissingEngineError("expected Python with docstrings, which hold titles; got -OO; run it without -OO")
    if not text:
        raise ValueError(f"{derive.__name__}: a claim needs a docstring, its first line is the title")
    return text.splitlines()[0].strip()
