"""Keys of tables in files: where one stands, and which ones a format knows.

Apart from :mod:`navsym.text.schema` because files of numbers need no reader of expressions.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from navsym.errors import ExpressionSyntaxError, UnknownSymbolError
from navsym.text.names import nearest, shown

Table = Mapping[str, Any]


def inside(where: str, key: object) -> str:
    """The place of a key: ``"file: model.F"``, ``"file: measurement[2].h"``."""
    part = f"[{key}]" if isinstance(key, int) else shown(key)[1:-1]
    if not where:
        return part
    if isinstance(key, int):
        return f"{where}{part}"
    return f"{where}.{part}" if ": " in where else f"{where}: {part}"


def expect_keys(table: Table, known: Collection[str], where: str) -> None:
    """Refuse a key that the format does not have, naming the one that was probably meant.

    A key that is passed over in silence may be a misspelt one, and then the answer belongs to another question.
    """
    for key in table:
        if key not in known:
            raise ExpressionSyntaxError(unknown(key, known), where=inside(where, key))


def only_keys(table: Table, known: Collection[str], place: str = "") -> None:
    """The same for tables of numbers, of kind ``unknown-symbol``; whoever knows the file puts it before the place."""
    for key in table:
        if key not in known:
            name = inside("", key)
            raise UnknownSymbolError(unknown(key, known), where=f"{place}.{name}" if place else name)


def unknown(key: object, known: Collection[str]) -> str:
    """What to say of a key that a format does not have."""
    return (
        f"expected one of the keys {', '.join(known)}; got {shown(key)}; "
        f"do remove or correct it: {nearest(str(key), known)}"
    )
