"""How notebooks show values: small cards and tables in HTML, formulas in LaTeX, without loading an engine.

Formulas know their own LaTeX (``_repr_latex_``), so that nothing of a computer algebra system is needed
here. Every word that comes from data is escaped.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from navsym.core.tables import COLOURS as COLOURS
from navsym.core.tables import MARKS as MARKS
from navsym.core.tables import mark_verdict as mark_verdict
from navsym.core.tables import write_table as write_table

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


def count_in_words(count: int, word: str) -> str:
    """``1 measurement``, ``2 measurements``."""
    return f"{count} {word}{'' if count == 1 else 's'}"


def shorten_digits(digits: str, length: int = 14) -> str:
    """A decimal string cut for reading."""
    return digits if len(digits) <= length else digits[:length] + "…"
