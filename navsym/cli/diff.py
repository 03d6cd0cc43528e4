"""Compare two formulas, claim files, models, exports or ledgers: proved equal, or the worst point shown."""

from __future__ import annotations

from navsym.cli.output import emit, table
from navsym.core.errors import ExpressionSyntaxError


def command(old: str, new: str, *, box: list[str] | None = None, json_: bool = False) -> int:
    """Compare two formulas, files or folders exactly. Status 1 unless every formula is proved equal.

    Example: navsym diff "sin(2*a)" "2*sin(a)*cos(a)"

    Example: navsym diff build/old build/new
    """
    import navsym as nav

    found = nav.diff(old, new, box=dict(read_range(text) for text in box or []))
    emit(found.document(), as_json=json_, text=lambda: table(*found.table()))
    return 0 if found.equal else 1


def read_range(text: str) -> tuple[str, tuple[str, str]]:
    """``"T=0,2*pi"`` as a name and the text of two ends."""
    name, equals, ends = text.partition("=")
    parts = ends.split(",")
    if not equals or len(parts) != 2:
        raise ExpressionSyntaxError(f"expected NAME=LOWER,UPPER; got {text[:60]!r}; correct it", where="--range")
    return name.strip(), (parts[0], parts[1])
