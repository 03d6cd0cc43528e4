"""Compare two formulas, claim files, models, exports or ledgers: proved equal, or the worst point shown."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import navsym as nav
from navsym.cli._settings import values_of
from navsym.cli.output import Told, table
from navsym.core.errors import ExpressionSyntaxError


def command(old: str, new: str, *, box: list[str] | None = None) -> Told:
    """Compare two formulas, files or folders exactly. Status 1 unless every formula is proved equal.

    Example: navsym diff "sin(2*a)" "2*sin(a)*cos(a)"

    Example: navsym diff build/old build/new
    """
    found = nav.diff(old, new, box=read_ranges(box))
    return Told(found.document, lambda: table(*found.table()), 0 if found.equal else 1)


def read_ranges(texts: Sequence[str] | None) -> dict[str, Any]:
    """``"T=0,2*pi"``, each with another name, as names and the texts of two ends; raises NavsymError for others."""
    found: dict[str, Any] = {}
    for name, ends in values_of(texts, "--range", "NAME=LOWER,UPPER", "--range T=0,2*pi").items():
        lower, comma, upper = ends.partition(",")
        if not comma or "," in upper:
            message = f"expected NAME=LOWER,UPPER; got {f'{name}={ends}'[:60]!r}; write --range {name}=0,1"
            raise ExpressionSyntaxError(message, where="--range")
        found[name] = (lower, upper)
    return found
