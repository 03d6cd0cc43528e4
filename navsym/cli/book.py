"""Standard formulas of navigation and estimation, with their verdicts."""

from __future__ import annotations

from typing import Annotated

import typer

from navsym.cli.output import emit, table


def command(
    search: Annotated[str, typer.Argument(help="words that all occur in id, title, formula or source")] = "",
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> int:
    """Search the formulas of the book. Status 1 when no entry has all words.

    Example: navsym book "transport rate"
    """
    import navsym as nav

    entries = nav.book.search(search)
    rows = [(entry.id, entry.status, entry.title, entry.statement) for entry in entries]
    shown = {"entries": [entry.record() for entry in entries]}
    emit(shown, as_json=json_, text=lambda: table(("entry", "verdict", "title", "statement"), rows))
    return 0 if entries else 1
