"""Derive from a model file: F, Phi, H, the observability matrix and the conditions of the contacts."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from navsym.cli.output import emit, write_text
from navsym.errors import ExpressionSyntaxError, NavsymError


def command(
    file: Annotated[Path, typer.Argument(help="model file (TOML)")],
    latex: Annotated[
        bool, typer.Option("--latex", help="print LaTeX instead of text; with --json add it"),
    ] = False,
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="value of a parameter, such as w=1/2; may be repeated"),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="write the text to this file")] = None,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Derive the transition matrix, the regressors and the conditions of optimality from a model.

    Example: navsym derive examples/schuler-velocity.toml
    """
    from navsym.models.derivation import derive
    from navsym.models.derivation_document import as_latex, as_text, document
    from navsym.text.modelfile import read_model

    found = read_model(file, dict(setting(text) for text in set_ or []))
    try:
        data = document(derive(found), latex=latex)
    except NavsymError as error:
        raise error.at(str(file)) from None
    text = as_latex(data) if latex else as_text(data)
    if out is not None:
        write_text(out, text)
    emit(data, as_json=json_, text=text)


def setting(text: str) -> tuple[str, str]:
    """NAME=VALUE as a pair."""
    name, equals, value = text.partition("=")
    if not equals:
        raise ExpressionSyntaxError(
            f"expected NAME=VALUE; got {text[:40]!r}; write --set w=1/2", where="--set"
        )
    return name.strip(), value.strip()
