"""Derive from a model file: F, Phi, H, the observability matrix and the conditions of the contacts."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from navsym.cli.output import dumps, emit, write_text
from navsym.core.errors import DomainError, ExpressionSyntaxError, NavsymError

if TYPE_CHECKING:
    from navsym.models.derivation import Derivation


def command(
    file: Annotated[Path, typer.Argument(help="model file (TOML)")],
    latex: Annotated[bool, typer.Option("--latex", help="print LaTeX instead of text; with --json add it")] = False,
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="value of a parameter, such as w=1/2; may be repeated")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="write the text to this file")] = None,
    certificate: Annotated[
        Path | None, typer.Option(help="write proofs of exp(F t) and of the observed rank, for navsym check")
    ] = None,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Derive the transition matrix, the regressors and the conditions of optimality from a model.

    Example: navsym derive examples/schuler-velocity.toml
    """
    from navsym.models.derivation import derive
    from navsym.models.document import as_latex, as_text, document
    from navsym.models.modelfile import read_model

    found = read_model(file, dict(setting(text) for text in set_ or []))
    try:
        derivation = derive(found)
        data = document(derivation, latex=latex)
        if certificate is not None:
            write_certificate(derivation, certificate)
    except NavsymError as error:
        raise error.at(str(file)) from None
    text = as_latex(data) if latex else as_text(data)
    if out is not None:
        write_text(out, text)
    emit(data, as_json=json_, text=text)


def write_certificate(derivation: Derivation, path: Path) -> None:
    """The certificate as a JSON file; DomainError when nothing in the file has one."""
    from navsym.models.document import derivation_certificate

    found = derivation_certificate(derivation)
    if found is None:
        raise DomainError("expected a system with a transition matrix; got none; give a [model] with F")
    write_text(path, dumps(found) + "\n")


def setting(text: str) -> tuple[str, str]:
    """NAME=VALUE as a pair."""
    name, equals, value = text.partition("=")
    if not equals:
        raise ExpressionSyntaxError(f"expected NAME=VALUE; got {text[:40]!r}; write --set w=1/2", where="--set")
    return name.strip(), value.strip()
