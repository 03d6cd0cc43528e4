"""Cite a verdict: BibTeX of the paper and of the verdict."""

from __future__ import annotations

from typing import Annotated

import typer

from navsym.cli.output import emit


def command(
    claim: Annotated[str, typer.Argument(help="id of a claim, such as guaranteed_velocity:4.3.u2")],
    fresh: Annotated[bool, typer.Option("--fresh", help="decide now instead of citing the ledger")] = False,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Print BibTeX for the paper and for the verdict, from the ledger where it has one.

    Example: navsym cite "guaranteed_velocity:4.3.u2*" >> references.bib
    """
    import navsym as nav

    cited = nav.cite(claim, fresh=fresh)
    emit(cited.document(), as_json=json_, text=cited.bibtex)
