"""Compare two formulas, claim files, models or exports: proved equal, or the worst point shown."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from navsym.cli.output import emit, table
from navsym.core.errors import DomainError, ExpressionSyntaxError, ShapeError


def command(
    old: Annotated[str, typer.Argument(help="a formula, a claim or model file (TOML), or an exported folder")],
    new: Annotated[str, typer.Argument(help="what it is compared with, of the same kind")],
    box: Annotated[
        list[str] | None, typer.Option("--range", help='range of a symbol, such as "T=0,2*pi"; may be repeated')
    ] = None,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> int:
    """Compare two formulas, files or folders exactly. Status 1 unless every formula is proved equal.

    Example: navsym diff "sin(2*a)" "2*sin(a)*cos(a)"

    Example: navsym diff build/old build/new
    """
    from navsym.export.differences import compare, formulas_of

    kinds = [kind_of(text) for text in (old, new)]
    if kinds[0] != kinds[1]:
        message = f"expected two things of one kind; got {kinds[0]} and {kinds[1]}; compare each with its own kind"
        raise ShapeError(message, where=new)
    ranges = dict(read_range(text) for text in box or [])
    document = compare(formulas_of(old, ranges), formulas_of(new, ranges))
    emit(document, as_json=json_, text=lambda: as_text(document))
    return 0 if document["equal"] else 1


def kind_of(text: str) -> str:
    """What a word of the command line names; a file of another kind is refused."""
    from pathlib import Path

    from navsym.language.tomlfile import read_toml

    if text.endswith(".toml"):
        return "a claim file" if "claim" in read_toml(Path(text)) else "a model file"
    if Path(text).is_dir():
        return "a folder"
    if Path(text).exists():
        message = "expected a formula, a file named *.toml or an exported folder; got another file; name one of these"
        raise DomainError(message, where=text)
    return "a formula"


def read_range(text: str) -> tuple[str, tuple[Any, Any]]:
    """``"T=0,2*pi"`` as a name and two exact ends."""
    from navsym.language.expression import parse

    name, equals, ends = text.partition("=")
    parts = ends.split(",")
    if not equals or len(parts) != 2:
        raise ExpressionSyntaxError(f"expected NAME=LOWER,UPPER; got {text[:60]!r}; do correct it", where="--range")
    lower, upper = (parse(part, {}, where="--range") for part in parts)
    return name.strip(), (lower, upper)


def as_text(document: dict[str, Any]) -> str:
    rows = []
    for record in document["differences"]:
        point = ", ".join(f"{k} = {v}" for k, v in (record["worst"] or {}).items())
        size = f"old - new = {record['difference'][0]}…" if record["difference"] else ""
        words = f"{size} at {point or 'every point'}" if size else record["why"]
        if record["assumptions"]:
            words += f"; taken: {'; '.join(record['assumptions'])}"
        rows.append((record["name"], record["status"], words))
    return table(("formula", "status", "where"), rows)
