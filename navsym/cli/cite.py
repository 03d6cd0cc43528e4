"""Cite a verdict: BibTeX of the paper and of the verdict."""

from __future__ import annotations

from typing import Annotated

import typer

from navsym import __version__
from navsym.cli._claims import decide, find, stored_records
from navsym.cli.output import emit


def command(
    claim: Annotated[str, typer.Argument(help="id of a claim, such as guaranteed_velocity:4.3.u2")],
    fresh: Annotated[bool, typer.Option("--fresh", help="decide now instead of citing the ledger")] = False,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Print BibTeX for the paper and for the verdict, from the ledger where it has one.

    Example: navsym cite "guaranteed_velocity:4.3.u2*" >> references.bib
    """
    from navsym.report.citation import bibtex

    paper, found = find(claim)
    stored = stored_records()
    record = None if fresh else stored.get(found.id)
    if record is None:
        paper, record = decide(claim)
    correction = next((other for other in stored.values() if other["corrects"] == found.id), None)
    text = bibtex(paper, record, __version__, correction)
    emit({"id": found.id, "status": record["status"], "bibtex": text}, as_json=json_, text=text)
