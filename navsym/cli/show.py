"""Show one claim: what is printed, what follows, and the verdict."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from navsym.cli._claims import decide, parts_of
from navsym.cli.output import emit

SHOWN = ("scope", "method", "evidence")


def command(
    claim: Annotated[str, typer.Argument(help="id of a claim, guaranteed_velocity:4.3.u2, or an equation, …:4.16")],
    seconds: Annotated[float, typer.Option(help="limit, seconds; above it the verdict is OPEN")] = 90.0,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> int:
    """Show both sides of a claim and its verdict, decided now; of an equation in several parts, all of them.

    Example: navsym show guaranteed_velocity:4.3.u2
    """
    records = [decide(part, seconds)[1] for part in parts_of(claim)]
    document = records[0] if len(records) == 1 else {"claims": records}
    emit(document, as_json=json_, text=lambda: "\n\n".join(map(as_text, records)))
    return 0 if all(record["status"] == record["expect"] for record in records) else 1


def as_text(record: dict[str, Any]) -> str:
    """A few lines, the verdict first."""
    lines = [f"{record['id']}  {record['status']}", record["title"], f"  printed  {record['printed']}"]
    if record["derived"]:
        lines.append(f"  derived  {record['derived']}")
    lines += [f"  {key:<9}{record[key]}" for key in SHOWN if record[key]]
    if record["assumptions"]:
        lines.append(f"  assuming {'; '.join(record['assumptions'])}")
    if record["counterexample"]:
        lines.append("  at       " + ", ".join(f"{k} = {v}" for k, v in record["counterexample"].items()))
    if record["reason"]:
        lines.append(f"  {record['slip'] or 'note':<9}{record['reason']}")
    if record["corrects"]:
        lines.append(f"  corrects {record['corrects']}")
    if record["status"] != record["expect"]:
        lines.append(f"  declared {record['expect']}")
    return "\n".join(lines)
