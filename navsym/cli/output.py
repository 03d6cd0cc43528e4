"""What verbs print: one JSON document, or text and tables for people, and files written whole."""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import IO, Any

from navsym.cli._progress import LINE
from navsym.core.errors import OutputError
from navsym.language.files import write_text as write_text

#: Colours of the words that a reader looks for first.
STYLES: Mapping[str, str] = {
    "PROVED": "bold green",
    "CERTIFIED": "green",
    "CONFIRMED": "cyan",
    "REFUTED": "bold red",
    "OPEN": "yellow",
    "ACCEPTED": "green",
    "REJECTED": "bold red",
    "missing": "yellow",
    "yes": "green",
    "no": "yellow",
}


#: What rich writes to colour a word.
COLOUR = re.compile("(\x1b\\[[0-9;]*m)")


# One document, or text


@dataclass(frozen=True, slots=True)
class Told:
    """What a verb has to say, as data and for people, and its exit status.

    document : plain data, or a function that returns it; numpy arrays and scalars are written as lists and numbers
    text     : the text, or a function that returns it; of the two functions the one is called that is wanted
    """

    document: Any
    text: str | Callable[[], str]
    status: int = 0

    def print(self, as_json: bool) -> int:
        """Print the document as JSON or the text, and return the status.

        Raises ValueError when the document holds NaN or an infinity: those are decimal strings or null.
        """
        if as_json:
            put(dumps(self.document() if callable(self.document) else self.document) + "\n")
        elif shown := self.text() if callable(self.text) else self.text:
            put(harmless(shown if shown.endswith("\n") else shown + "\n"))
        return self.status


def dumps(document: Any, *, indent: int | None = 2) -> str:
    """The document as JSON text: UTF-8 throughout, keys as given, never NaN."""
    return json.dumps(document, ensure_ascii=False, allow_nan=False, indent=indent, default=plain)


def plain(value: Any) -> Any:
    """Plain data for the values of numpy; anything else has to be made plain by its owner."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} is not plain data")


def put(text: str, stream: IO[str] | None = None) -> None:
    """Write text in UTF-8, whatever the locale says; lone surrogates of file names become '?'.

    Raises OutputError for an output that is closed or full; BrokenPipeError when its reader went away.
    """
    stream = sys.stdout if stream is None else stream
    LINE.clear()
    if stream is None:  # Python's word for an output that was closed before the start
        raise OutputError("expected an output that is open; got a closed one; open it", where="standard output")
    try:
        write_whole(stream, text.encode("utf-8", "replace"))
    except BrokenPipeError:
        raise
    except OSError as error:
        reason = error.strerror or type(error).__name__
        message = f"expected an output that can be written; got '{reason}'; redirect it elsewhere"
        raise OutputError(message, where="standard output") from error


def write_whole(stream: IO[str], data: bytes) -> None:
    """Bytes to a text stream, behind what it holds already."""
    stream.flush()
    raw = getattr(stream, "buffer", None)
    if raw is None:
        stream.write(data.decode("utf-8"))
    else:
        raw.write(data)
    stream.flush()


def remark(text: str) -> None:
    """Progress and remarks: on standard error, so that standard output stays one document."""
    put(visible(text) + "\n", sys.stderr)


def visible(text: str) -> str:
    """The text without control characters, so that a file's words cannot steer a terminal."""
    return "".join(c if c.isprintable() or c in "\n\t" else repr(c)[1:-1] for c in text)


def harmless(text: str) -> str:
    """The text without control characters but the colours of our own tables, on a terminal that wants them."""
    return "".join(
        part if place % 2 and wants_colour() else visible(part) for place, part in enumerate(COLOUR.split(text))
    )


# Tables


def wants_colour(stream: Any = None) -> bool:
    """True when the stream is a terminal and nobody asked for plain text (NO_COLOR, TERM=dumb)."""
    stream = sys.stdout if stream is None else stream
    if os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb":
        return False
    return bool(getattr(stream, "isatty", lambda: False)())


def table(columns: Sequence[str], rows: Iterable[Sequence[Any]], *, title: str = "", right: Iterable[str] = ()) -> str:
    """A table as text: drawn by rich on a terminal, aligned plain columns otherwise.

    columns : headings
    rows    : one sequence of cells per row, as long as ``columns``; cells are shown with ``str``
    right   : headings of the columns that are aligned to the right
    """
    cells = [[visible(str(cell)).replace("\n", " ") for cell in row] for row in rows]
    if wants_colour():
        return drawn_table(columns, cells, title, frozenset(right))
    return plain_table(columns, cells, title, frozenset(right))


def plain_table(columns: Sequence[str], cells: list[list[str]], title: str, right: frozenset[str]) -> str:
    """Columns two blanks apart, headings underlined; nothing is cut off."""
    widths = [max(map(len, column)) for column in zip(columns, *cells, strict=True)]

    def line(row: Sequence[str]) -> str:
        fields = zip(row, widths, columns, strict=True)
        return "  ".join(c.rjust(w) if name in right else c.ljust(w) for c, w, name in fields).rstrip()

    head = [title] if title else []
    return "\n".join([*head, line(columns), line(["-" * w for w in widths]), *map(line, cells)])


def drawn_table(columns: Sequence[str], cells: list[list[str]], title: str, right: frozenset[str]) -> str:
    """The same table drawn by rich; cells are text, never markup."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    drawn = Table(title=Text(title) if title else None, title_justify="left")
    for name in columns:
        drawn.add_column(Text(name), justify="right" if name in right else "left", overflow="fold")
    for row in cells:
        drawn.add_row(*(Text(cell, style=STYLES.get(cell, "")) for cell in row))
    console = Console()
    with console.capture() as capture:
        console.print(drawn)
    return capture.get()
