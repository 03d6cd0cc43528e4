"""Make a derivation module for another paper: its card, its equations, and an example claim."""

from __future__ import annotations

from pathlib import Path

import navsym as nav
from navsym.cli.output import Told


def command(
    name: str,
    *,
    title: str = "",
    author: list[str] | None = None,
    year: int | None = None,
    source: str = "",
    language: str = "English",
    equations: str = "1",
    folder: Path | None = None,
) -> Told:
    """Write derivations/NAME.py. It passes the generic tests at once; add claims with navsym new-claim.

    Example: navsym new-paper schuler_pendulum --author "A. Author" --year 1923 --equations "1-6"
    """
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
    return Told(paper.document, lambda: f"{paper.path}\nnext: {next_step(name, folder)}")


def next_step(name: str, folder: Path | None) -> str:
    """The next command; ``verify`` knows only the folder of derivations."""
    claims = f"navsym new-claim {name} NUMBER --printed … --derived …"
    if folder is None:
        return f"{claims}; then navsym verify {name}"
    return f"{claims} --folder {folder}; navsym verify {name} knows it once the file stands in derivations/"
