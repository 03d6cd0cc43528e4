"""What the preprocessor of C surely leaves out, and where a name is known that only some of its ways define."""

from __future__ import annotations

import itertools
import re
from typing import Any

from navsym.audit.form import Unit
from navsym.audit.syntax import ascend, field_of

WAYS = ("preproc_if", "preproc_ifdef", "preproc_elif", "preproc_elifdef", "preproc_else")
#: Comments and texts, what is no blank, and the lines of the preprocessor.
HIDING = re.compile(rb"(?s)//(?:\\\r?\n|[^\n])*|/\*.*?(?:\*/|\Z)|R\"\w*\(.*?\)\w*\"|\"(?:\\.|[^\"\\\n])*\"|'\\?.'")
BLACK = re.compile(rb"[^\s]")
DIRECTIVE = re.compile(
    rb"(?<!\\\n)(?<!\\\r\n)^[ \t]*#[ \t]*((?:el)?if(?:n?def)?|else|endif|define|undef)\b([^\n]*)", re.MULTILINE
)


def region_of(node: Any) -> tuple[int, int] | None:
    """The way of an undecided ``#if`` around a definition, or the function around an inner one."""
    for above in ascend(node):
        if above.type in WAYS:
            other = field_of(above, "alternative")
            return above.start_byte, above.end_byte if other is None else other.start_byte
        if above.type == "function_definition":
            return above.start_byte, above.end_byte
    return None


def drop_ways(source: bytes, unit: Unit) -> bytes:
    """The source with blanks for what the preprocessor surely leaves out, and for the conditions that say so.

    A file says that a name is not defined by defining it itself: ``#ifndef NAME`` before ``#define NAME``.
    """
    defined, own = unit.defined, "__cplusplus"
    bare, text, before = HIDING.sub(lambda found: BLACK.sub(b" ", found[0]), source), bytearray(source), 0
    known = {*(defined or ()), *([own] if unit.language == "cpp" else ())}
    doubtful, states = set[str](), list[str]()  # "on", "off", "past" behind "on", or "open"

    def state_of(word: str, rest: str) -> str:
        """Of the lines behind a condition; "open" where it is no number and no name of which something is known."""
        if (name := re.fullmatch(r"(!?)\s*defined\s*\(?\s*(\w+)\s*\)?", rest)) and word == "if":
            word, rest = "ifndef" if name[1] else "ifdef", name[2]
        if word == "if":
            return "open" if not re.fullmatch("[0-9]+", rest) else "on" if int(rest) else "off"
        is_open = rest in doubtful or (defined is None and rest not in {own, *known})
        return "open" if is_open else "on" if (rest in known) == (word == "ifdef") else "off"

    def blank(start: int, end: int) -> None:
        text[start:end] = BLACK.sub(b" ", text[start:end])

    directives = [*DIRECTIVE.finditer(bare)]
    for found, following in itertools.zip_longest(directives, directives[1:]):
        word, rest = (part.decode("utf-8", "replace").strip() for part in found.groups())
        if {"off", "past"} & {*states}:
            blank(before, found.start())
        before = found.end()
        old = states.pop() if word.startswith("e") and states else ""
        is_hidden = bool({"off", "past"} & {*states})
        if word in ("define", "undef"):
            if is_hidden:
                blank(*found.span())
            elif name := re.match(r"\w+", rest):
                (doubtful.add if "open" in states else known.add if word == "define" else known.discard)(name[0])
            continue
        new = "past" if old in ("on", "past") else old if old == "open" else "on"
        new = state_of(word.removeprefix("el"), rest) if "if" in word and old in ("", "off") else new
        if word == "ifndef" and new == "open" and rest not in doubtful and following is not None:
            is_own = following[1] == b"define" and following[2].split()[:1] == [rest.encode()]
            new = "on" if is_own else new
        if word != "endif":
            states.append(new)
        if is_hidden or "open" not in (old, new if word != "endif" else ""):
            blank(*found.span())
        elif old == "off":  # the first way of which nothing is known
            text[slice(*found.span(1))] = found[1].removeprefix(b"el").rjust(len(word))
    return bytes(text)
