"""Make a derivation module for another paper: its card, its equations, and an example claim."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from navsym.cli.output import emit, write_text
from navsym.core.errors import DuplicateError


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
    from navsym.claims.paper import papers_folder
    from navsym.language.scaffold import check_module_name, module_source, split_numbers

    path = (folder or papers_folder()) / f"{check_module_name(name)}.py"
    if path.exists() or path.with_suffix("").exists():
        message = f"expected a new module; got {name}, which exists; choose another name"
        raise DuplicateError(message, where=str(path))
    text = module_source(name, title, author or [], year, source, language, split_numbers(equations))
    write_text(path, text)
    emit({"path": str(path), "module": name}, as_json=json_, text=f"{path}\nnext: {advice(name, folder)}")


def advice(name: str, folder: Path | None) -> str:
    """What to do with the new module; ``verify`` knows only the folder of derivations."""
    claims = f"navsym new-claim {name} NUMBER --printed … --derived …"
    if folder is None:
        return f"{claims}; then navsym verify {name}"
    return f"{claims} --folder {folder}; navsym verify {name} knows it once the file stands in derivations/"
