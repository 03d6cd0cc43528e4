"""Tables of text: a row on each line, whichever mark stands between its cells, and columns of numbers below a head."""

from __future__ import annotations

import csv
import math
import os
import re
from collections.abc import Iterator, Sequence

from navsym.core.errors import EmptyError, ExpressionSyntaxError, NotFiniteError, ShapeError
from navsym.language.files import name_file, read_text
from navsym.language.names import quote

LARGEST_FILE = 256 * 1024 * 1024
DECIMAL = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d{1,3})?|[+-]?(nan|inf|infinity)", re.I | re.A)


def lines_of(text: str) -> list[str]:
    """Lines as an editor counts them; other separators of Unicode are ordinary characters."""
    return re.split(r"\r\n|\n|\r", text)


def read_rows(text: str, columns: int) -> Iterator[tuple[int, list[str]]]:
    """(line, cells) of the lines that are not empty and do not start with #.

    A semicolon or a tab wins over commas, which may be decimal, where the first row has enough of them for the columns.
    """
    lines = [
        (k, line) for k, line in enumerate(lines_of(text), 1) if line.strip() and not line.lstrip().startswith("#")
    ]
    first = lines[0][1] if lines else ""
    mark = next((mark for mark in ";\t" if first.count(mark) >= columns - 1), ",")
    return ((k, split(line, mark)) for k, line in lines)


def split(line: str, mark: str) -> list[str]:
    """Cells of a line; none when the line is not a row of a table at all."""
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=mark, strict=True), [])]
    except csv.Error:
        return []


def number_of(text: str) -> float | None:
    """A decimal number, nan or inf; None for anything else (no underscores, no hexadecimals)."""
    return float(text) if DECIMAL.fullmatch(text.strip()) else None


def need_width(cells: Sequence[str], width: int, place: str) -> None:
    """Refuse a row of another length: with a stray or decimal comma, its columns cannot be told."""
    if not cells:
        raise ExpressionSyntaxError("expected cells of a table; got none, as behind a lone quote; mend it", where=place)
    if len(cells) != width:
        raise ShapeError(f"expected {width} cells, one per column; got {len(cells)}; mend the row", where=place)


def read_numbers(path: str | os.PathLike[str], choices: Sequence[tuple[str, ...]]) -> dict[str, list[float]]:
    """Finite numbers by column, of the first choice whose names stand in the head once each; others are ignored.

    Raises NavsymError with the line: an unreadable file, a head without such columns, a row of another length, a cell
    that is no finite number.
    """
    where = name_file(path)
    rows = list(read_rows(read_text(path, LARGEST_FILE), len(choices[-1])))
    number, head = rows.pop(0) if rows else (1, [])
    head = [name.lower() for name in head]
    names = next((names for names in choices if all(head.count(name) == 1 for name in names)), None)
    if names is None:
        expected = ", or ".join(", ".join(names) for names in choices)
        message = f"expected the columns {expected}, once each; got {quote(','.join(head))}; name them so"
        raise ShapeError(message, where=f"{where}: line {number}")
    found: dict[str, list[float]] = {name: [] for name in names}
    for number, cells in rows:
        place = f"{where}: line {number}"
        need_width(cells, len(head), place)
        for name in names:
            text = cells[head.index(name)]
            value = number_of(text)
            if value is None:
                raise ExpressionSyntaxError(f"expected a number; got {quote(text)}; mend it", where=f"{place}: {name}")
            if not math.isfinite(value):
                message = f"expected a finite number; got {quote(text)}; drop the row"
                raise NotFiniteError(message, where=f"{place}: {name}")
            found[name].append(value)
    if not rows:
        raise EmptyError("expected a row or more below the head; got none; add them", where=where)
    return found
