"""Exact observability of a model: what each measurement observes, where that breaks, and how the problem splits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from navsym.cli._settings import values_of
from navsym.cli.output import emit, table, write_text
from navsym.core.errors import DuplicateError, ExpressionSyntaxError, NavsymError


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
    """Show the exact observability of a model: dimensions, rank drops, splits, gains by poles.

    Example: navsym observe examples/schuler-velocity.toml

    Further measurements: navsym observe model.toml --restore --candidate "gps = x"
    """
    import navsym as nav

    named = read_candidates(candidate or [])
    try:
        answer = nav.observe(
            file, split=split, poles=poles, restore=restoring, candidates=named, values=values_of(set_)
        )
    except NavsymError as error:
        error.where = error.where.replace("observe: candidates.", "--candidate ").replace("observe: ", "--")
        raise
    if html is not None:
        write_text(html, answer.page())
    if latex is not None:
        write_text(latex, answer.latex())
    emit(answer.document(), as_json=json_, text=lambda: as_text(answer.document()))


def read_candidates(texts: Sequence[str]) -> dict[str, str]:
    """``NAME = formula`` each as a mapping."""
    formulas: dict[str, str] = {}
    for text in texts:
        name, equals, formula = (part.strip() for part in text.partition("="))
        if not equals or not name:
            message = f'expected NAME = formula of the states; got {text[:40]!r}; write "gps = x"'
            raise ExpressionSyntaxError(message, where="--candidate")
        if name in formulas:
            raise DuplicateError(f"expected one formula of {name[:40]}; got two; rename one", where="--candidate")
        formulas[name] = formula
    return formulas


# Text for people


def as_text(data: Mapping[str, Any]) -> str:
    """Tables of the document."""
    chosen = split_text(data["split"]) if data["split"] else ""
    restored = restored_text(data["restore"]) if "restore" in data else ""
    blocks = (overview(data), restored, drops_text(data), splits_text(data), chosen, *gains_text(data["gains"]))
    return "\n".join(block for block in blocks if block)


def overview(data: Mapping[str, Any]) -> str:
    """The dimension that each measurement observes, and the unobservable directions."""
    verdict = "observable" if data["observable"] else "NOT observable"
    directions = data["unobservable_directions"]
    return "\n".join(
        [
            f"{data['n']} states, joint dimension {data['joint_dimension']}: {verdict}\n",
            table(
                ["measurement", "dimension", "companion"],
                [[m["name"], str(m["dimension"]), ", ".join(m["companion"])] for m in data["measurements"]],
            ),
            *(["unobservable: " + "; ".join(directions) + "\n"] if directions else []),
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


def restored_text(data: Mapping[str, Any]) -> str:
    """The number of further measurements needed at least, and the smallest sets of candidates that are enough."""
    if not data["hidden"]:
        return "every state is shown already: no further measurement is needed\n"
    lines = [f"further measurements: at least {data['needed']} needed, whatever they measure"]
    if not data["sets"]:
        proved = "proved" if data["proved"] else "not proved"
        lines.append(f"not enough, all together: {', '.join(data['candidates'])} ({proved})")
    else:
        fewer = "proved that no fewer of them are" if data["proved"] else "not proved that no fewer of them are"
        lines.append(f"enough ({fewer}):")
        lines += ["  " + ", ".join(names) for names in data["sets"]]
    return "\n".join(lines) + "\n"
