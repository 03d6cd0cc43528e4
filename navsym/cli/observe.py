"""What each measurement of a model observes, where that breaks, and how the problem splits."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from navsym.cli._candidates import read_candidates, restoration, restored_text
from navsym.cli._settings import values_of
from navsym.cli.output import emit, table, write_text
from navsym.core.errors import DomainError, DuplicateError, ExpressionSyntaxError, NavsymError

if TYPE_CHECKING:
    from navsym.models.modelfile import ModelFile


def command(
    file: Annotated[Path, typer.Argument(help="model file (TOML) with constant F and h")],
    split: Annotated[
        str | None, typer.Option(help='vectors taken from each measurement, such as "2,1"; default m,n-m')
    ] = None,
    poles: Annotated[
        str | None, typer.Option(help='wanted polynomials in p, one per stage, such as "(p+1)**2; p+2"')
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="value of a parameter, such as w=1/2; may be repeated")
    ] = None,
    restoring: Annotated[
        bool, typer.Option("--restore", help="the fewest further measurements that would show every state")
    ] = False,
    candidate: Annotated[
        list[str] | None,
        typer.Option(help='what could be measured, such as "gps = x + a*v"; may be repeated; default: each state'),
    ] = None,
    html: Annotated[Path | None, typer.Option(help="write the decomposition to this HTML file")] = None,
    latex: Annotated[Path | None, typer.Option(help="write the decomposition to this LaTeX file")] = None,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Exact observability of a model: dimensions, rank drops, splits, gains by poles.

    Example: navsym observe examples/schuler-velocity.toml

    What is missing: navsym observe model.toml --restore --candidate "gps = x"
    """
    from navsym.observability.document import as_html, as_latex, document, examine

    model_file = read(file, set_ or [])
    request = read_split(split) if split is not None else None
    polynomials, variable = read_poles(poles, model_file) if poles is not None else ((), None)
    rows = read_candidates(candidate or [], model_file) if restoring or candidate else {}
    options = {"variable": variable} if variable is not None else {}
    model = linear_model(model_file)
    try:
        examination = examine(model, request, polynomials, **options)
        further = {"restore": restoration(model, rows)} if restoring or candidate else {}
    except NavsymError as error:
        raise error.at(str(file)) from None
    if html is not None:
        write_text(html, as_html(examination, model_file.name))
    if latex is not None:
        write_text(latex, as_latex(examination))
    data = document(examination) | further
    emit(data, as_json=json_, text=lambda: as_text(data))


def read(file: Path, settings: list[str]) -> ModelFile:
    """The model of a file; a file of regressors has no F to observe."""
    from navsym.models.modelfile import ModelFile, read_model

    found = read_model(file, values_of(settings))
    if not isinstance(found, ModelFile):
        raise DomainError(
            "expected a [model] with F and h; got a [basis] of regressors; give the system", where=str(file)
        )
    return found


def linear_model(found: ModelFile) -> Any:
    """The model file as a linear model."""
    from navsym.models.linear import LinearModel

    return LinearModel(
        found.F,
        None,
        [list(m.h) for m in found.measurements] or None,
        found.states,
        measurements=tuple(m.name for m in found.measurements),
        time=found.time,
    )


def read_split(text: str) -> tuple[int, int]:
    """Two numbers with a comma between them."""
    match = re.fullmatch(r"\s*(\d{1,3})\s*,\s*(\d{1,3})\s*", text)
    if match is None:
        raise ExpressionSyntaxError(
            f'expected two numbers "i,j"; got {text[:40]!r}; write --split 3,2', where="--split"
        )
    return int(match[1]), int(match[2])


def read_poles(text: str, found: ModelFile) -> tuple[tuple[Any, ...], Any]:
    """Polynomials in p; names that the file does not declare are positive symbols of their own."""
    from navsym.language.expression import parse, symbol
    from navsym.language.names import RESERVED

    declared = {name: parameter.symbol for name, parameter in found.parameters.items()}
    if "p" in declared:
        raise DuplicateError(
            "expected p to be free for the variable of the polynomials; got a parameter p; rename the parameter",
            where="--poles",
        )
    names = set(re.findall(r"[A-Za-z][A-Za-z0-9_]*", text)) - RESERVED - declared.keys() - {"p"}
    for name in sorted(names & set(found.states)):
        raise DuplicateError(f"expected a symbol of its own; got {name}, which is a state; rename it", where="--poles")
    variable = symbol("p")
    known = {**declared, "p": variable, **{name: symbol(name, positive=True) for name in sorted(names)}}
    parts = [part.strip() for part in text.split(";")]
    return tuple(parse(part, known, where="--poles") for part in parts), variable


# Text for people


def as_text(data: Mapping[str, Any]) -> str:
    """Tables of the document."""
    chosen = split_text(data["split"]) if data["split"] else ""
    restored = restored_text(data["restore"]) if "restore" in data else ""
    blocks = (overview(data), restored, drops_text(data), splits_text(data), chosen, *gains_text(data["gains"]))
    return "\n".join(block for block in blocks if block)


def overview(data: Mapping[str, Any]) -> str:
    """What each measurement observes, and what none of them does."""
    verdict = "observable" if data["observable"] else "NOT observable"
    hidden = data["unobservable_directions"]
    return "\n".join(
        [
            f"{data['n']} states, joint dimension {data['joint_dimension']}: {verdict}\n",
            table(
                ["measurement", "dimension", "companion"],
                [[m["name"], str(m["dimension"]), ", ".join(m["companion"])] for m in data["measurements"]],
            ),
            *(["hidden: " + "; ".join(hidden) + "\n"] if hidden else []),
        ]
    )


def drops_text(data: Mapping[str, Any]) -> str:
    """Where a dimension drops, and for which subspaces the list of such places is proved complete."""
    blocks = ["no rank drops found\n"]
    if data["rank_drops"]:
        blocks = [table(["rank drops of", "where", "list complete"], [drop_row(d) for d in data["rank_drops"]])]
    unsure = [name for name, complete in data["rank_drops_complete"].items() if not complete]
    if unsure:
        blocks.append(f"list of rank drops not proved complete for {', '.join(unsure)}\n")
    return "\n".join(blocks)


def drop_row(drop: Mapping[str, Any]) -> list[str]:
    """One rank drop as a row: subspace, conditions, completeness of its list."""
    where = " and ".join(f"{zero} = 0" for zero in drop["zeros"])
    excluded = " (excluded by declaration)" if drop["excluded_by_declaration"] else ""
    return [drop["subspace"], where + excluded, "proved" if drop["complete"] else "not proved"]


def splits_text(data: Mapping[str, Any]) -> str:
    """The regular splits with their determinants; the best one is marked."""
    if not data["splits"]:
        return ""
    return table(["i", "j", "det L", ""], [split_row(s, data["best_split"]) for s in data["splits"]])


def split_row(split: Mapping[str, Any], best: list[int]) -> list[str]:
    """One split as a row: sizes, determinant, a mark for the best."""
    sizes = [split["i"], split["j"]]
    return [*map(str, sizes), split["det_L"], "least max(i, j)" if sizes == best else ""]


def gains_text(gains: Mapping[str, Any]) -> list[str]:
    """One line for each vector of gains."""
    return [f"{name} = ({', '.join(values)})\n" for name, values in gains.items() if name != "stable" and values]


def split_text(chosen: Mapping[str, Any]) -> str:
    """The matrices of a split, row by row."""
    lines = [f"split i = {chosen['i']}, j = {chosen['j']} ({chosen['form']}), det L = {chosen['det_L']}"]
    for name in ("L", "Theta", "Phi_x", "Phi_z"):
        rows = chosen[name]
        if rows and rows[0]:
            lines += [f"{name}:", *("  [" + ", ".join(cells) + "]" for cells in rows)]
    return "\n".join(lines) + "\n"
