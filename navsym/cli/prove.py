"""Decide the formulas of a claim file, one by one."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli._progress import Progress
from navsym.cli.output import Told, table

if TYPE_CHECKING:
    from navsym.claims import Verdict, Verdicts


def command(file: Path, *, jobs: int = 1, seconds: float = 20.0) -> Told:
    """Decide the formulas of a claim file. Status 1 when one of them is refuted or open, 2 when one has no value.

    Example: navsym prove examples/formulas.toml
    """
    found: list[Verdict] = []
    try:
        with Progress("formulas", resume="those decided follow; run it again for the rest") as bar:

            def step(verdict: Verdict, total: int) -> None:
                found.append(verdict)
                bar.total = total
                bar.step(verdict.id)

            verdicts = nav.prove(file, jobs=jobs, seconds=seconds, progress=step)
    except KeyboardInterrupt as error:
        so_far = nav.Verdicts(tuple(found))
        document = {**so_far.document(), "interrupted": True}
        error.told = Told(document, lambda: as_text(so_far))  # type: ignore[attr-defined]
        raise
    fails = any(verdict.status in (nav.REFUTED, nav.OPEN) for verdict in verdicts)
    status = verdicts.first_error.status if verdicts.first_error else int(fails)
    return Told(verdicts.document, lambda: as_text(verdicts), status)


def as_text(verdicts: Verdicts) -> str:
    """A table with what each verdict rests on, or why a side has no value."""
    rows = [(v.id, v.status, v.method, str(verdicts.errors.get(v.id) or v.reason)) for v in verdicts]
    return table(("claim", "verdict", "method", "remark"), rows)
