"""List the real data sets, with source, licence and checksum, or get one into the cache."""

from __future__ import annotations

from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli.output import Told, table
from navsym.core.errors import EmptyError, ExpressionSyntaxError

if TYPE_CHECKING:
    from navsym.core.datasets import Datasets


def command(action: str = "list", names: list[str] | None = None) -> Told:
    """List the data sets and their places, or fetch some and check them.

    Example: navsym data get srtm        (NAVSYM_DATA names a folder that already has them)
    """
    if action not in ("list", "get"):
        raise ExpressionSyntaxError(f"expected list or get; got {action[:40]}; write one of them", where="data")
    if action == "get" and not names:
        raise EmptyError("expected names of data sets; got none; see navsym data list", where="data get")
    found = nav.data(*names) if action == "get" and names else nav.data()
    return Told(found.document, lambda: as_text(found))


def as_text(found: Datasets) -> str:
    """A table of what is known, or the paths and citations of what was fetched."""
    if found.fetched:
        return "\n".join(f"{row.here}\n  cite: {row.data.citation}" for row in found)
    cells = [
        (
            row.data.name,
            "yes" if row.here else "damaged" if row.trouble else "no",
            row.data.what,
            row.data.licence,
            f"{row.data.repository} @ {row.data.commit}",
        )
        for row in found
    ]
    return table(("data set", "here", "what it is", "licence", "source"), cells)
