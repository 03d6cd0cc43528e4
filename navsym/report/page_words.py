"""Scopes and truth values of records, as a page says them."""

from __future__ import annotations

import re

RANGES = (
    (re.compile(r"(\w+) in \(0, oo\)"), r"\1 > 0"),
    (re.compile(r"(\w+) in \[0, oo\)"), r"\1 ≥ 0"),
    (re.compile(r"(\w+) in \(-oo, 0\)"), r"\1 < 0"),
    (re.compile(r"\boo\b"), "∞"),
    (re.compile(r" != "), " ≠ "),
    (re.compile(r" >= "), " ≥ "),
    (re.compile(r" <= "), " ≤ "),
)
SINGLE = {"True": "it holds", "False": "it does not hold"}


def scope_words(text: str) -> str:
    """A scope or an assumption with the signs of mathematics: ``T in (0, oo)`` is T > 0."""
    if text == "one point":
        return "one point, which is enough to refute"
    for pattern, sign in RANGES:
        text = pattern.sub(sign, text)
    return text


def truth_words(text: str) -> str:
    """One truth value or several, as a statement about what is asked."""
    values = re.findall(r"True|False", text)
    if len(values) == 1:
        return SINGLE[values[0]]
    if set(values) == {"True"}:
        return f"it holds in all {len(values)} cases"
    return "; ".join(f"case {place}: {SINGLE[value]}" for place, value in enumerate(values, start=1))
