"""Decide the formulas of a claim file, one by one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from navsym.cli._progress import Progress
from navsym.cli.output import emit, table


def command(
    file: Annotated[Path, typer.Argument(help="claim file (TOML) with [symbols] and [[claim]] blocks")],
    jobs: Annotated[int, typer.Option(min=1, help="claims decided at the same time")] = 1,
    seconds: Annotated[
        float,
        typer.Option(min=0.1, help="limit for one claim, seconds of processor time; above it the verdict is OPEN"),
    ] = 20.0,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> int:
    """Decide the formulas of a claim file. Status 1 when one of them is refuted or open, 2 when one has no value.

    Example: navsym prove examples/formulas.toml
    """
    from navsym.language.tomlfile import read_toml

    read_toml(file)  # a file that is none is refused before the slow import of the algebra

    from navsym.prove.claimfile import read_claims

    claims = read_claims(file, go_on=True)

    from navsym.prove.claimfile import prove

    found: list[dict[str, Any]] = []
    try:
        with Progress("formulas", len(claims.claims), "those decided follow; run it again for the rest") as bar:

            def step(record: dict[str, Any]) -> None:
                found.append(record)
                bar.step(record["id"])

            document = prove(claims, jobs=jobs, seconds=seconds, progress=step)
    except KeyboardInterrupt:
        emit({"claims": found, "interrupted": True}, as_json=json_, text=lambda: as_text({"claims": found}))
        raise
    emit(document, as_json=json_, text=lambda: as_text(document))
    if claims.undefined:
        return claims.undefined[0].error.status
    return 0 if all(record["status"] not in ("REFUTED", "OPEN") for record in document["claims"]) else 1


def as_text(document: dict[str, Any]) -> str:
    rows = [(r["id"], r["status"], r["method"], remark_of(r)) for r in document["claims"]]
    return table(("claim", "verdict", "method", "remark"), rows)


def remark_of(record: dict[str, Any]) -> str:
    if "error" in record:
        return f"{record['error']['where']}: {record['error']['message']}"
    if record["counterexample"] is not None:
        point = ", ".join(f"{k} = {v}" for k, v in record["counterexample"].items()) or "no symbols"
        difference = record["difference"]
        return f"at {point}" + (f": left - right = {difference['lower']}…" if difference else "")
    if record["assumptions"]:
        return f"assuming {'; '.join(record['assumptions'])}"
    return record["scope"] or record["evidence"]
