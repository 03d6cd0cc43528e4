"""List the real data sets, with source, licence and checksum, or get one into the cache."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from navsym.cli._choice import one_of
from navsym.cli.output import emit, table
from navsym.core.errors import EmptyError, ExpressionSyntaxError, NavsymError


def command(
    action: Annotated[str, typer.Argument(help="list or get")] = "list",
    names: Annotated[list[str] | None, typer.Argument(help="data sets to get; all for every one")] = None,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Show what is known and where it lies, or fetch data sets and check them.

    Example: navsym data get srtm        (NAVSYM_DATA names a folder that already has them)
    """
    from navsym.core.datasets import DATASETS, dataset, fetch

    if action == "list":
        rows = [row(data) for data in DATASETS.values()]
        emit({"datasets": rows}, as_json=json_, text=lambda: listed(rows))
        return
    if action != "get":
        raise ExpressionSyntaxError(f"expected list or get; got {action[:40]}; write one of them", where="data")
    if not names:
        raise EmptyError("expected names of data sets; got none; see navsym data list", where="data get")
    wanted = list(DATASETS) if names == ["all"] else names
    for name in wanted:
        one_of(name, DATASETS, "data get")
    got = [{"name": name, "path": str(fetch(name)), "citation": dataset(name).citation} for name in wanted]
    text = "\n".join(f"{item['path']}\n  cite: {item['citation']}" for item in got)
    emit({"datasets": got}, as_json=json_, text=text)


def row(data: Any) -> dict[str, Any]:
    """One data set as plain data; ``here`` is where it lies, or null."""
    from navsym.core.datasets import local_copy

    try:
        path, trouble = local_copy(data), None
    except NavsymError as error:
        path, trouble = None, error.message
    return {
        "name": data.name,
        "what": data.what,
        "path": data.path,
        "repository": data.repository,
        "commit": data.commit,
        "source": data.source,
        "sha256": data.sha256,
        "licence": data.licence,
        "here": None if path is None else str(path),
        "trouble": trouble,
    }


def listed(rows: list[dict[str, Any]]) -> str:
    cells = [
        (
            r["name"],
            "yes" if r["here"] else "damaged" if r["trouble"] else "no",
            r["what"],
            r["licence"],
            f"{r['repository']} @ {r['commit']}",
        )
        for r in rows
    ]
    return table(("data set", "here", "what it is", "licence", "source"), cells)
