"""Replay certificates in the independent checker, and exported code on its vectors."""

from __future__ import annotations

import os
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli._progress import Progress
from navsym.cli.output import Told, table

if TYPE_CHECKING:
    from navsym.export.acceptance import Checks

#: More accepted certificates of one folder than this stand on one line.
MANY = 12


def command(paths: list[Path], *, kernel: str | None = None, out: Path | None = None) -> Told:
    """Accept or reject every certificate; status 1 when one is rejected, or not proved by the kernel.

    Example: navsym check report/certificates
    """
    try:
        with Progress("parts", resume="those checked follow; name the other paths for the rest") as bar:
            checks = nav.check(*paths, kernel=kernel, out=out, progress=bar.follow)
    except KeyboardInterrupt as error:
        so_far: Checks | None = getattr(error, "checks", None)
        if so_far is not None:
            error.told = Told(so_far.document, lambda: as_text(so_far))  # type: ignore[attr-defined]
        raise
    return Told(checks.document, lambda: as_text(checks), 0 if checks.accepted else 1)


def as_text(checks: Checks) -> str:
    """A line for each part; many accepted certificates of one folder share a line."""
    rows: list[tuple[str, ...]] = []
    for (folder, plain), group in groupby(checks, lambda c: (os.path.dirname(c.path), c.holds and not c.why)):
        words = [part.words() for part in group]
        share = plain and len(words) > MANY
        rows += [(folder, f"{len(words)} certificates", words[0][2], words[0][3])] if share else words
    return table(("path", "kind", "status", "why"), rows)
