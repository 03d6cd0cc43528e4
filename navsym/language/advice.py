"""What to write instead: advice for what people bring from paper, Matlab, numpy and other habits.

It goes into messages only. Nothing is accepted, refused or repaired here.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable

from navsym.language.names import suggest_nearest

HINTS = {
    "^": "write ** for a power",
    "\u2212": "write the ASCII minus -",
    "\u2013": "write the ASCII minus -",
    "\u00b7": "write * for a product",
    "\u00d7": "write * for a product",
    "\u00f7": "write / for a quotient",
    "\u03c0": "write pi",
    "\u00b0": "write *pi/180: angles are radians",
    "\u221a": "write sqrt(...)",
    "[": "use ( and ) only",
    "{": "use ( and ) only",
    "=": "give the two sides separately",
    "<": "give the two sides separately",
    ">": "give the two sides separately",
    "!": "write a factorial as a number",
    "%": "divide by 100",
    "|": "write abs(...)",
    ".": "write the digits on both sides of the point: 0.5, 1.0",
    "_": "let a name start with a letter, and write numbers without separators",
}

RAISED = {"\u00b2": "2", "\u00b3": "3"}

#: Functions and numbers as they are called elsewhere.
FOREIGN = dict(
    ln="log", arcsin="asin", arccos="acos", arctan="atan", arctg="atan", arctan2="atan2", tg="tan", ctg="cot",
    cosec="csc", sh="sinh", ch="cosh", th="tanh", arsinh="asinh", arcosh="acosh", artanh="atanh", Abs="abs",
    fabs="abs", Pi="pi", PI="pi", e="exp(...)", E="exp(...)", pow="**",
    oo="it as an end alone", inf="oo as an end", nan="a number",
)  # fmt: skip

UNITS = frozenset(("m", "km", "s", "min", "h", "deg", "rad", "kg", "Hz", "mg"))
RELATION = {"==": "=", "\u2264": "<=", "=<": "<=", "\u2265": ">=", "=>": ">=", "\u2260": "!=", "<>": "!=", "~=": "!="}


def advise_on_character(text: str, at: int) -> str:
    """What to write for a character that the language does not have."""
    char = text[at]
    if char in RAISED:
        return f"write **{RAISED[char]}"
    if char == "." and text[at + 1 : at + 2] in ("*", "/", "^"):
        return "leave the point out: every symbol is a single number"
    if char == "." and re.search(r"[A-Za-z]\w*$", text[:at]):
        return "write the function alone: sin(x)"
    greek = re.fullmatch(r"GREEK (SMALL|CAPITAL) (?:LETTER )?(?:FINAL )?(\w+)(?: SYMBOL)?", unicodedata.name(char, ""))
    if greek and char not in HINTS:
        name = "lam" if greek[2] == "LAMDA" else greek[2].lower()
        name = name if greek[1] == "SMALL" else name.capitalize()
        return f"write its name, {name}, here and where it is declared"
    return HINTS.get(char, "remove it or write it in ASCII")


def advise_on_name(name: str, known: Iterable[str]) -> str:
    """What to do about a name that nobody declared."""
    if name in FOREIGN and name not in known:
        return f"write {FOREIGN[name]}" + ("" if name == "oo" else ", or declare it if it is a symbol of yours")
    return f"declare it or correct it: {suggest_nearest(name, known)}"


def advise_on_token(text: str, at: int, implicit: bool) -> str:
    """What to do about a token that is in its place by mistake; implicit for one that may be a factor."""
    before, mark = text[:at].rstrip(), text[at : at + 2]
    if mark[:1] == "," and re.search(r"\d$", before) and re.match(r"\d", mark[1:]):
        return "write a decimal point: 0.5"
    word = re.match(r"[A-Za-z]+", text[at:])
    if word and word[0] in UNITS and re.search(r"\d$", before):
        return f"leave the unit out, or write *{word[0]} if it is a symbol: numbers have one system, angles are radians"
    called = re.search(r"([a-z]+2?)$", before)
    if mark == "**" and called:
        return f"write the power behind the call: {called[1]}(x)**2"
    return "write a product with *" if implicit else "complete or remove this part"


def advise_on_relation(relation: str, known: Iterable[str]) -> str:
    """What to write for a relation that is none."""
    return f"write {RELATION[relation]}" if relation in RELATION else suggest_nearest(relation, known)
