r"""Macros of a document: ``\newcommand`` and its like, expanded without running anything.

A body with conditions, files or definitions of its own is no abbreviation; it stays, and its formulas are refused.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import islice

from navsym.language.latex.parts import Refusal

DEFINITION = re.compile(
    r"\\(?:(?:re|provide)?newcommand\*?|def)\s*(?:\{\s*(\\[A-Za-z]+)\s*\}|(\\[A-Za-z]+))\s*(?:\[([1-9])\])?\s*(\[?)(?=[{\[])"
)
OPERATOR = re.compile(r"\\DeclareMathOperator\*?\s*\{\s*(\\[A-Za-z]+)\s*\}\s*\{([A-Za-z]+)\}")
CODE = re.compile(
    r"\\(if|else|fi\b|csname|expandafter|input|include|write|catcode|def|newcommand|let|loop|read|open|@)|@"
)
BRACE = re.compile(r"\\.|[{}]", re.S)
COMMAND = re.compile(r"\\[A-Za-z]+")
EXPANSIONS, LENGTH, MACROS = 2_000, 20_000, 2_000


@dataclass(frozen=True, slots=True)
class Macro:
    """Number of arguments, and the body with ``#1``."""

    count: int
    body: str


def list_macros(text: str) -> dict[str, Macro]:
    """The abbreviations that a document defines, by command; the last definition counts."""
    macros: dict[str, Macro] = {}
    for found in islice(DEFINITION.finditer(text), MACROS):
        name, count = found[1] or found[2], int(found[3] or 0)
        stop = close_brace(text, found.end())
        if found[4] or stop < 0:
            continue
        body = text[found.end() + 1 : stop]
        if not CODE.search(body) and len(body) <= 1_000:
            macros[name] = Macro(count, body)
    for found in islice(OPERATOR.finditer(text), MACROS):
        macros[found[1]] = Macro(0, rf"\operatorname{{{found[2]}}}")
    return macros


def close_brace(text: str, opening: int) -> int:
    """Place of the brace that closes the one at ``opening``; -1 where there is none in 2,000 characters."""
    depth = 0
    for found in BRACE.finditer(text, opening, opening + 2_000):
        depth += (found[0] == "{") - (found[0] == "}")
        if depth == 0:
            return found.start()
    return -1


def expand_macros(text: str, macros: Mapping[str, Macro]) -> tuple[str, list[int]]:
    r"""The text without abbreviations, and for each character its place in the original; raises Refusal.

    >>> from navsym.language.latex.macros import Macro, expand_macros
    >>> print(expand_macros(r"2\half{x}", {r"\half": Macro(1, r"\frac{#1}{2}")})[0])
    2\frac{x}{2}
    """
    places = list(range(len(text)))
    start = count = 0
    while found := next((m for m in COMMAND.finditer(text, start) if m[0] in macros), None):
        macro, stop = macros[found[0]], found.end()
        given: list[str] = []
        for _ in range(macro.count):
            while text[stop : stop + 1].isspace():
                stop += 1
            close = close_brace(text, stop) if text[stop : stop + 1] == "{" else stop
            if close < 0 or close >= len(text):
                raise Refusal(places[found.start()], f"{macro.count} arguments of {found[0]}", "fewer", "write them")
            given.append(text[stop + 1 : close] if text[stop] == "{" else text[stop])
            stop = close + 1
        filled = [*given, *[""] * 9]  # one that is not given is empty
        pieces = re.split("#([1-9])", macro.body)
        body = "".join(filled[int(piece) - 1] if k % 2 else piece for k, piece in enumerate(pieces))
        body = f"{body} " if body[-1:].isalpha() and text[stop : stop + 1].isalpha() else body
        count += 1
        if count > EXPANSIONS or len(text) + len(body) > LENGTH:
            raise Refusal(places[found.start()], "a macro that comes to an end", found[0], "write it out")
        places[found.start() : stop] = [places[found.start()]] * len(body)
        text = text[: found.start()] + body + text[stop:]
        start = found.start()
    return text, places
