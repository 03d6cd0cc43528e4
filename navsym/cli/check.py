"""Replay certificates in the independent checker, and exported code on its vectors."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from navsym.cli._progress import Progress
from navsym.cli.output import emit, table

if TYPE_CHECKING:
    from navsym.export.acceptance import Checks


def command(
    paths: Annotated[list[Path], typer.Argument(help="certificates (JSON), or folders of them or of exported code")],
    kernel: Annotated[str | None, typer.Option(help="have a proof kernel prove each statement, too: coq")] = None,
    out: Annotated[Path | None, typer.Option(help="folder of the kernel's theories; default: beside each file")] = None,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> int:
    """Accept or reject every certificate; status 1 when one is rejected, or not proved by the kernel.

    Example: navsym check report/certificates
    """
    import navsym as nav

    try:
        with Progress("parts", resume="those checked follow; name the other paths for the rest") as bar:
            checks = nav.check(*paths, kernel=kernel, out=out, progress=bar.follow)
    except KeyboardInterrupt as error:
        so_far: Checks | None = getattr(error, "checks", None)
        if so_far is not None:
            emit(so_far.document(), as_json=json_, text=lambda: as_text(so_far))
        raise
    emit(checks.document(), as_json=json_, text=lambda: as_text(checks))
    return 0 if checks.accepted else 1


def as_text(checks: Checks) -> str:
    """A table, one line for each certificate."""
    return table(("path", "kind", "status", "why"), [c.words() for c in checks])
