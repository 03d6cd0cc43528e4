"""Standard formulas of navigation and estimation, with their verdicts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli.output import Told

if TYPE_CHECKING:
    from navsym.book.entries import Entry


def command(search: str = "") -> Told:
    """Search the formulas of the book, by words or by a formula in any names. Status 1 when nothing is found.

    Example: navsym book "a/sqrt(1 - e**2*sin(x)**2)"
    """
    entries = nav.book.search(search)
    shown = {"entries": [entry.record() for entry in entries]}
    return Told(shown, lambda: as_text(entries), 0 if entries else 1)


def as_text(entries: list[Entry]) -> str:
    """Each entry with its verdict, its statement and its source, and the misprints that its author corrected."""
    blocks = []
    for entry in entries:
        blocks.append(f"{entry.id}  {entry.status}  {entry.title}\n  {entry.statement}\n  {entry.source}\n")
        blocks += [f"  misprint {shown.status}: {shown.latex}\n    {shown.source}\n" for shown in entry.misprints]
    return "\n".join([*blocks, "1 entry" if len(entries) == 1 else f"{len(entries)} entries"])
