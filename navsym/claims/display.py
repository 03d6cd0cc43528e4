"""How notebooks show values: small cards and tables in HTML, formulas in LaTeX, without loading an engine.

Formulas know their own LaTeX (``_repr_latex_``), so that nothing of a computer algebra system is needed
here. Every word that comes from data is escaped.
"""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from typing import Any

#: Colours of verdicts; dark enough on white, light enough on black. The mark says the same without colour.
COLOURS = {"PROVED": "#1a7f37", "CERTIFIED": "#0f7f7f", "CONFIRMED": "#0969da", "REFUTED": "#cf222e", "OPEN": "#9a6700"}
MARKS = {"PROVED": "✓", "CERTIFIED": "◎", "CONFIRMED": "≈", "REFUTED": "✗", "OPEN": "?"}
SIGNS = {"<=": r"\le", ">=": r"\ge", "!=": r"\ne"}


def latex_of(value: Any) -> str:
    """LaTeX of a formula, a sequence of formulas or a plain value, without dollar signs."""
    written = getattr(value, "_repr_latex_", None)
    text = written() if callable(written) else None
    if isinstance(text, str):
        return text.strip().strip("$").removeprefix(r"\displaystyle").strip()
    if isinstance(value, (tuple, list)):
        return r"\left(" + r",\; ".join(latex_of(part) for part in value) + r"\right)"
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return str(value)
    return rf"\text{{{latex_words(str(value))}}}"


def latex_words(text: str) -> str:
    r"""Words inside ``\text``: what LaTeX would obey becomes a blank."""
    return "".join(" " if c in "\\{}$&#%_^~" or not c.isprintable() else c for c in text)


def display_latex(latex: str) -> str:
    """A formula as a notebook displays it."""
    return rf"$\displaystyle {latex}$"


def write_card(lines: Iterable[str], status: str = "") -> str:
    """Lines of HTML in a card, with the colour of a verdict at its edge."""
    colour = COLOURS.get(status, "#57606a")
    body = "<br>".join(lines)
    return f'<div style="border-left:4px solid {colour};padding-left:10px;margin:4px 0;overflow-x:auto">{body}</div>'


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


def count_in_words(count: int, word: str) -> str:
    """``1 measurement``, ``2 measurements``."""
    return f"{count} {word}{'' if count == 1 else 's'}"


def shorten_digits(digits: str, length: int = 14) -> str:
    """A decimal string cut for reading."""
    return digits if len(digits) <= length else digits[:length] + "…"
