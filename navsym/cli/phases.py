"""The complete solution as a parameter varies: regimes, boundaries, closed forms."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from navsym.cli._progress import Progress
from navsym.cli._settings import values_of
from navsym.cli.output import dumps, emit, table, write_text
from navsym.errors import DomainError, ExpressionSyntaxError, NavsymError

RESUME = "nothing is kept: a shorter --range, or --quick, takes less time"


def command(
    file: Annotated[Path, typer.Argument(help="model or basis file (TOML)")],
    target: Annotated[
        str | None, typer.Option(help="name of the target; not needed where the file has one")
    ] = None,
    parameter: Annotated[str, typer.Option(help="name of the parameter that is the interval's length")] = "T",
    range_: Annotated[
        str | None, typer.Option("--range", help='its range, such as "0, 2*pi"; default: the declared one')
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="value of another parameter, such as w=1/2; may be repeated"),
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="leave regimes without a closed form uncertified")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="write the certificates to files of this name, numbered")
    ] = None,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Which instants, which weights and which value are optimal, on exactly which range of a parameter.

    Example: navsym phases examples/schuler-velocity.toml --target drift --range "0, 2*pi"
    """
    from navsym.methods.phases.continuation import phases
    from navsym.methods.phases.family import family_of
    from navsym.text.modelfile import read_model

    found = read_model(file, values_of(set_))
    try:
        lower, upper = ends_of(found, parameter, range_)
        with Progress("steps", resume=RESUME) as bar:
            answer = phases(
                family_of(found, target, parameter), lower, upper, certify=not quick, progress=bar.told_by_job
            )
    except NavsymError as error:
        raise error.at(str(file)) from None
    document = answer.document()
    if out is not None:
        for k, certificate in enumerate(answer.certificates()):
            write_text(out.with_name(f"{out.stem}-{k + 1}.json"), dumps(certificate) + "\n")
    emit(document, as_json=json_, text=lambda: as_text(document))


def ends_of(found: Any, parameter: str, text: str | None) -> tuple[Any, Any]:
    """The range of the option, or the one that the file declares for the parameter."""
    from navsym.text.expression import parse

    if text is not None:
        parts = text.split(",")
        if len(parts) != 2:
            raise ExpressionSyntaxError(
                f'expected two numbers; got {text[:40]!r}; write --range "0, 2*pi"', where="--range"
            )
        return parse(parts[0], {}, where="--range"), parse(parts[1], {}, where="--range")
    for symbol, ends in found.box.items():
        if symbol.name == parameter and None not in ends:
            return ends
    raise DomainError(f'expected a range of {parameter}; got none; give --range "0, 2*pi"')


def as_text(document: dict[str, Any]) -> str:
    rows = [
        (
            row["from"],
            row["to"],
            row["value"] or "implicit",
            "; ".join(str(s["at"] or "inside") for s in row["support"]),
            row["status"],
        )
        for row in document["regimes"]
    ]
    lines = [table(("from", "to", "value", "instants", "status"), rows, title=document["target"])]
    for b in document["boundaries"]:
        lines.append(f"{b['at'] or b['lower']}: {b['why']}")
    if document["uncovered"]:
        lines.append("uncovered: " + ", ".join(f"{a} to {b}" for a, b in document["uncovered"]))
    return "\n".join(lines)
