"""Run the ready-made exports in every language: vectors, worst error, bound, MISRA findings, size."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from navsym.cli._progress import Progress
from navsym.cli.output import emit, table
from navsym.core.errors import DomainError

if TYPE_CHECKING:
    from navsym.export.functions import ExportedFunction

RESUME = "nothing is kept: name some of the exports, or fewer --vectors"
EVERY = "c,cpp,python,batch,javascript,rust,fortran,casadi,wasm,julia,octave"


def command(
    names: Annotated[list[str] | None, typer.Argument(help="ready-made names; all when none is given")] = None,
    to: Annotated[str, typer.Option("--to", help="languages")] = EVERY,
    real: Annotated[str, typer.Option("--real", help="double or float")] = "double",
    vectors: Annotated[int, typer.Option("--vectors", min=4, max=200_000, help="vectors for each function")] = 48,
    points: Annotated[int, typer.Option("--points", min=0, max=10_000_000, help="points at which C is held, too")] = 0,
    jobs: Annotated[int, typer.Option("--jobs", min=1, max=256, help="groups or functions at the same time")] = 1,
    write: Annotated[Path | None, typer.Option("--write", help="write the table as a markdown page")] = None,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> int:
    """Compile and run everything that this machine can, and say what it cannot.

    Example: navsym exports --write docs/exports.md
    """
    from navsym.export.languages.targets import TARGETS, find_targets
    from navsym.export.materials import functions_of_claim
    from navsym.export.ready import READY
    from navsym.export.table import as_markdown, closing_table

    wanted = names or list(READY)
    unknown = [name for name in wanted if name not in READY]
    if unknown:
        raise DomainError(f"expected ready-made names among {', '.join(READY)}; got {unknown[0][:40]!r}; correct it")
    spoken = [n for n in to.split(",") if real in (TARGETS[n].reals if n in TARGETS else (real,))]
    targets = find_targets(spoken, real)
    groups: dict[str, list[ExportedFunction]] = {name: [] for name in wanted}
    parts = [(name, claim) for name in wanted for claim in READY[name]]
    with Progress("parts", len(parts), RESUME) as bar:
        for name, claim in parts:
            groups[name] += functions_of_claim(claim, real)
            bar.step(claim)
        bar.total = len(parts) + len(groups) + sum(len(made) for made in groups.values() if points)
        document = closing_table(groups, targets, vectors, bar.step, points, jobs)
    words = [
        "navsym",
        "exports",
        *(names or []),
        *(["--to", to] if to != EVERY else []),
        *(["--real", real] if real != "double" else []),
        "--vectors",
        str(vectors),
        *(["--points", str(points)] if points else []),
    ]
    if write is not None:
        write.write_text(as_markdown(document, shlex.join(words)), encoding="utf-8")
    emit(document, as_json=json_, text=lambda: as_text(document))
    said = [*document["languages"].values(), *document["tools"].values()]
    return 1 if any(record["status"] == "failed" for record in said) else 0


def as_text(document: dict[str, Any]) -> str:
    """One line for each function, one for each language and tool."""
    from navsym.export.table import measured_cell

    names = [n for n, record in document["languages"].items() if record["status"] != "not executed"]
    rows = [
        (
            f["name"],
            *(measured_cell(f["languages"][n]) for n in names),
            f["misra"] if f["misra"] is not None else "-",
            f["cortex_m4_bytes"] or "-",
        )
        for f in document["functions"]
    ]
    said = [(name, r["status"], r["why"]) for name, r in (*document["languages"].items(), *document["tools"].items())]
    head = ("function", *names, "MISRA", "M4 bytes")
    held = [
        (f["name"], p["points"], p["by_balls"], p["undefined"], p["wrong"], f"{p['worst']:.3g}")
        for f in document["functions"]
        if (p := f["points"]) is not None
    ]
    names_of_points = ("function", "points", "by balls", "undefined", "outside", "worst ulp")
    tables = [table(head, rows), *([table(names_of_points, held)] if held else [])]
    return "\n".join([*tables, table(("what", "status", "remark"), said)])
