"""Make a derivation module for another paper: its card, its equations, and an example claim."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from navsym.cli.output import emit


def command(
    name: Annotated[str, typer.Argument(help="module name, such as schuler_pendulum")],
    title: Annotated[str, typer.Option(help="title of the paper")] = "",
    author: Annotated[list[str] | None, typer.Option(help="author; may be repeated")] = None,
    year: Annotated[int | None, typer.Option(help="year")] = None,
    source: Annotated[str, typer.Option(help="journal, volume, pages")] = "",
    language: Annotated[str, typer.Option(help="language of the paper")] = "English",
    equations: Annotated[str, typer.Option(help='every number printed, such as "1-6" or "1.1-1.9, 2.1"')] = "1",
    folder: Annotated[Path | None, typer.Option(help="where; default: the folder of derivations")] = None,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Write derivations/NAME.py. It passes the generic tests at once; add claims with navsym new-claim.

    Example: navsym new-paper schuler_pendulum --author "A. Author" --year 1923 --equations "1-6"
    """
    import navsym as nav

    paper = nav.new_paper(
        name,
        title=title,
        authors=author or [],
        year=year,
        source=source,
        language=language,
        equations=equations,
        folder=folder,
    )
    emit(paper.document(), as_json=json_, text=lambda: f"{paper.path}\nnext: {next_step(name, folder)}")


def next_step(name: str, folder: Path | None) -> str:
    """The next command; ``verify`` knows only the folder of derivations."""
    claims = f"navsym new-claim {name} NUMBER --printed … --derived …"
    if folder is None:
        return f"{claims}; then navsym verify {name}"
    return f"{claims} --folder {folder}; navsym verify {name} knows it once the file stands in derivations/"
