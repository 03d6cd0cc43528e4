"""List the claims of the papers, with filters; verdicts come from the ledger."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

import typer

from navsym.cli._choice import one_of
from navsym.cli._claims import stored_records
from navsym.cli.output import emit, table

STATUSES = ("PROVED", "CERTIFIED", "CONFIRMED", "REFUTED", "OPEN")
SLIPS = ("paper", "scan", "any")


def command(
    paper: Annotated[list[str] | None, typer.Option(help="derivation module; may be repeated")] = None,
    status: Annotated[list[str] | None, typer.Option(help="verdict; may be repeated")] = None,
    slip: Annotated[str | None, typer.Option(help="paper, scan, or any")] = None,
    words: Annotated[str | None, typer.Option(help="text that the id or the title contains")] = None,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """List claims in the order of the paper, without deciding them; a verdict that no ledger holds is declared.

    Example: navsym list --status REFUTED --slip paper
    """
    from navsym.cli.verify import load
    from navsym.verification.ledger import in_order

    wanted = {one_of(s.upper(), STATUSES, "--status") for s in status or ()}
    kind = one_of(slip, SLIPS, "--slip") if slip else None
    stored = stored_records()
    rows = [
        found
        for module in load(paper or [])
        for found in in_order(module.paper, [row(claim, stored) for claim in module.claims])
    ]
    chosen = [r for r in rows if fits(r, wanted, kind, (words or "").lower())]
    emit({"claims": chosen, "count": len(chosen)}, as_json=json_, text=lambda: as_text(chosen))


def row(claim: Any, stored: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """One claim as plain data."""
    record = stored.get(claim.id)
    return {
        "id": claim.id,
        "paper": claim.module,
        "number": claim.number,
        "title": claim.title,
        "status": record["status"] if record else str(claim.expect),
        "decided": record is not None,
        "corrects": claim.corrects_id,
        "slip": claim.slip,
        "reason": claim.reason,
    }


def fits(row: Mapping[str, Any], statuses: set[str], slip: str | None, words: str) -> bool:
    if statuses and row["status"] not in statuses:
        return False
    if slip and not (row["slip"] if slip == "any" else row["slip"] == slip):
        return False
    return words in row["id"].lower() or words in row["title"].lower()


def as_text(rows: Sequence[Mapping[str, Any]]) -> str:
    cells = [
        (r["id"], r["status"] + ("" if r["decided"] else " (declared)"), r["title"], r["slip"] or "") for r in rows
    ]
    counted = f"{len(rows)} claim" + "s" * (len(rows) != 1)
    return table(("claim", "verdict", "what it says", "slip"), cells) + f"\n{counted}"
