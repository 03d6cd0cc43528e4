"""Explain a verdict step by step: the question, the method, and the arithmetic of a counterexample."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli.output import Told

if TYPE_CHECKING:
    from navsym.report.explain import Explanation

WIDTH = 100
FORMULA = " " * 6


def command(claim: str, *, seconds: float = 90.0) -> Told:
    """Tell why a claim has its verdict.

    Example: navsym explain guaranteed_velocity:4.3.u2
    """
    told = nav.explain(claim, seconds=seconds)
    return Told(told.document, lambda: as_text(told), 0 if told.record.is_expected else 1)


def indented(formula: str) -> str:
    """A formula on lines of its own."""
    return textwrap.fill(formula, WIDTH, initial_indent=FORMULA, subsequent_indent=FORMULA)


def as_text(told: Explanation) -> str:
    """Numbered steps; formulas on lines of their own."""
    lines, number = [f"{told.record.id}  {told.record.status}", told.paper, ""], 0
    for step in told.steps:
        number += bool(step.heading)
        head = f"{number}. {step.heading}. " if step.heading else "   "
        lines.append(textwrap.fill(head + step.words, WIDTH, subsequent_indent="   ", break_long_words=False))
        if step.formula:
            lines += ["", indented(step.formula), ""]
    lines += ["", f"Derivation: {told.source}"]
    if told.correction:
        lines += ["", f"It should read ({told.correction.id}): {told.correction.title}"]
        lines += ["", indented(told.correction.formula)] if told.correction.formula else []
    return "\n".join(lines)
