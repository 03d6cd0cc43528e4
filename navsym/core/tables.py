"""Tables of text in HTML, and what shows itself as one in a notebook."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from typing import Any

Table = tuple[Sequence[str], Iterable[Sequence[Any]]]

#: Colours of verdicts; dark enough on white, light enough on black. The mark says the same without colour.
COLOURS = {"PROVED": "#1a7f37", "CERTIFIED": "#0f7f7f", "CONFIRMED": "#0969da", "REFUTED": "#cf222e", "OPEN": "#9a6700"}
MARKS = {"PROVED": "✓", "CERTIFIED": "◎", "CONFIRMED": "≈", "REFUTED": "✗", "OPEN": "?"}


class Shown:
    """Base of what people see as a table: on a terminal by its verb, in a notebook by itself."""

    __slots__ = ()

    def table(self) -> Table:
        """Heads and rows; NotImplementedError, which a notebook takes for no table, where there are none."""
        raise NotImplementedError

    def _repr_html_(self) -> str:
        return write_table(*self.table())


def mark_verdict(status: str) -> str:
    """A verdict in its colour, with its mark."""
    colour = COLOURS.get(status, "inherit")
    return f'<b style="color:{colour}">{MARKS.get(status, "")} {html.escape(status)}</b>'


def write_table(heads: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """A table; a cell between dollar signs is a formula, a verdict has its colour, anything else is text."""
    head = "".join(f'<th style="text-align:left">{html.escape(name)}</th>' for name in heads)
    body = "".join("<tr>" + "".join(write_cell(value) for value in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def write_cell(value: Any) -> str:
    """One cell of a table of text in HTML; a verdict has its mark and colour."""
    text = str(value)
    shown = mark_verdict(text) if text in MARKS else html.escape(text)
    return f'<td style="text-align:left">{shown}</td>'
