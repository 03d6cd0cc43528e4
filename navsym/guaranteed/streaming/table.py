"""Measurements of a CSV file: a column ``t``, one for each measurement, an empty cell where there is none."""

from __future__ import annotations

import os
from collections.abc import Iterator

from navsym.core.errors import DuplicateError, EmptyError, ShapeError, UnknownSymbolError
from navsym.guaranteed.streaming.numbers import read_exact
from navsym.language.csvfile import need_width, read_rows
from navsym.language.files import name_file, read_text
from navsym.language.names import quote

LARGEST = 500_000_000
#: What stands before the name of a measurement in the head of a column of noise bounds.
SIGMA = "sigma "

Epoch = tuple[str, dict[str, str], dict[str, str]]


def read_epochs(path: str | os.PathLike[str], names: tuple[str, ...]) -> Iterator[tuple[str, Epoch]]:
    """(place, (t, values, bounds)) of each row; numbers stay text, which is exact.

    Columns: ``t``, measurements of the model, and ``sigma NAME`` for a bound that changes. A line that starts with # is
    a remark. Raises NavsymError with file and line.
    """
    where = name_file(path)
    head: list[str] | None = None
    seen = 0
    for line, cells in read_rows(read_text(path, LARGEST), 2):
        place = f"{where}: line {line}"
        if head is None:
            head = cells
            need_head(head, names, place)
        elif not cells or any(cells):
            need_width(cells, len(head), place)
            seen += 1
            yield place, read_cells(head, cells, place)
    if not seen:
        message = "expected a row for each epoch; got none; add t and the measurements"
        raise EmptyError(message, where=where)


def need_head(head: list[str], names: tuple[str, ...], place: str) -> None:
    """Refuse a head without t, with a column twice, or with one that means nothing."""
    if "t" not in head:
        message = f"expected a column t; got {', '.join(map(quote, head[:6]))}; name the columns in the first row"
        raise ShapeError(message, where=place)
    twice = next((name for name in head if head.count(name) > 1), None)
    if twice is not None:
        raise DuplicateError(f"expected every column once; got {quote(twice)} again; drop one", where=place)
    if len(head) == 1:
        message = f"expected a column for a measurement; got t alone; add one of {', '.join(names)}"
        raise ShapeError(message, where=place)
    known = {"t", *names, *(SIGMA + name for name in names)}
    for name in head:
        if name not in known:
            message = f"expected t or a measurement of the model; got {quote(name)}; name one of t, {', '.join(names)}"
            raise UnknownSymbolError(message, where=place)


def read_cells(head: list[str], cells: list[str], place: str) -> Epoch:
    """The cells of an epoch by name, those that are not empty; each is a number."""
    values, bounds, time = {}, {}, ""
    for name, cell in zip(head, cells, strict=True):
        if cell:
            read_exact(cell, f"{place}: {name}")
        if name == "t":
            time = cell
        elif cell and name.startswith(SIGMA):
            bounds[name.removeprefix(SIGMA)] = cell
        elif cell:
            values[name] = cell
    if not time:
        raise EmptyError("expected a time; got an empty cell; fill it in", where=f"{place}: t")
    return time, values, bounds
