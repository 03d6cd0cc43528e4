"""The wording of an erratum sheet: where a slip stands in the paper and what replaces it, for an editor.

Claims hold formulas in the language of files; a sheet has to speak the paper's notation and name the
line. This file reads such wording from TOML. It words corrections and decides none of them.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase

from navsym.core.errors import ExpressionSyntaxError, NavsymError, UnknownSymbolError
from navsym.report.formula.latex import sentence_html

KEYS = ("where", "printed", "correct", "why", "check")


@dataclass(frozen=True, slots=True)
class Wording:
    """One correction in words with formulas between dollar signs.

    where   : section, equation and part, as a reader finds it
    printed : what stands there
    correct : what should stand there
    why     : the reason, a sentence or two; empty to take that of the claim
    check   : numbers to see it by; empty where those of the counterexample will do
    """

    where: str
    printed: str
    correct: str
    why: str = ""
    check: str = ""


Words = Mapping[str, Wording]


def read_wording(text: str, where: str = "wording") -> dict[str, Wording]:
    """Wording by the number of the claim, or by a pattern such as ``table.*``.

    Raises ExpressionSyntaxError for text that is no TOML or holds formulas outside the language, and
    UnknownSymbolError for keys that are missing or unknown.
    """
    try:
        sections = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        message = f"expected TOML; got {error}; put sections of numbers into it"
        raise ExpressionSyntaxError(message, where=where) from None
    return {number: wording_of(section, f"{where}: {number}") for number, section in sections.items()}


def wording_of(section: object, where: str) -> Wording:
    """The wording of one equation, its keys and its formulas checked.

    Raises UnknownSymbolError for missing or further keys, and NavsymError for a formula that cannot be shown.
    """
    if not isinstance(section, dict) or not set(KEYS[:3]) <= set(section) <= set(KEYS):
        got = ", ".join(section) if isinstance(section, dict) else "no section"
        message = f"expected the keys where, printed, correct and perhaps why and check; got {got}; write them"
        raise UnknownSymbolError(message, where=where)
    try:
        for value in section.values():
            sentence_html(value)
    except NavsymError as error:
        raise error.at(where) from None
    return Wording(**section)


def pattern_of(number: str, words: Words) -> str | None:
    """The section that words a claim: its own number, or the pattern that fits it."""
    if number in words:
        return number
    return next((pattern for pattern in words if "*" in pattern[-1:] and fnmatchcase(number, pattern)), None)
