"""Formulas of records for reading: both sides of a claim, set in type as they stand.

Records hold the sides as text in the language of files. What is not a formula comes back without MathML and LaTeX, and
its owner shows the plain text.
"""

from __future__ import annotations

import contextlib
import functools
import re
from collections.abc import Mapping
from dataclasses import dataclass

from markupsafe import Markup

from navsym.core.errors import ExpressionSyntaxError
from navsym.report.formula.latex import mathml as set_latex
from navsym.report.formula.notation import LATEX, MATHML
from navsym.report.formula.reader import read_formula
from navsym.report.formula.writer import write

FOLDED = 400


@dataclass(frozen=True, slots=True)
class Formula:
    """A side of a claim: its text, and its MathML and LaTeX where it is a formula; ``words`` for a sentence."""

    text: str
    mathml: Markup | None
    latex: str | None
    words: bool = False

    @property
    def long(self) -> bool:
        """True for what is folded away until a reader asks for it."""
        return len(self.text) > FOLDED


@functools.lru_cache(maxsize=4096)
def formula(text: str, inline: bool = False) -> Formula:
    """A side of a claim, set in type where it can be; in a line of words simple quotients are T/4."""
    written = mathml(text, inline) if text not in ("", "True", "False") else None
    return Formula(text, None, None) if written is None else Formula(text, Markup(written), latex(text, inline))


def as_printed(source: str) -> Formula | None:
    """LaTeX as a document prints it; None where there is none, or where it has a command that is not on the whitelist.

    What is on the list is safe to be handed to LaTeX again.
    """
    with contextlib.suppress(ExpressionSyntaxError):
        return Formula(source, set_latex(source, display=True), source) if source else None
    return None


def only_truth(text: str) -> bool:
    """True for a side that only says yes or no, once or for each of several: its title tells more."""
    return re.fullmatch(r"[\[(]?(True|False)(, (True|False))*[])]?", text) is not None


def coordinates(point: Mapping[str, str] | None) -> tuple[Formula, ...]:
    """A point in type, one equation for each coordinate, so that a narrow page can break between them."""
    return tuple(formula(f"{name} = {value}", inline=True) for name, value in (point or {}).items())


def mathml(text: str, inline: bool = False) -> str | None:
    """MathML of a formula, one element for each part between semicolons; None for what is not a formula."""
    node = read_formula(text)
    if node is None:
        return None
    several = node.kind == "list" and node.text == ";"
    style = MATHML.above() if inline else MATHML
    bodies = [write(part, style) for part in (node.parts if several else (node,))]
    return "".join(f'<math xmlns="http://www.w3.org/1998/Math/MathML" display="block">{body}</math>' for body in bodies)


def latex(text: str, inline: bool = False) -> str | None:
    """LaTeX of a formula, for a display of its own or for a line of words; or None."""
    node = read_formula(text)
    return None if node is None else write(node, LATEX.above() if inline else LATEX)
