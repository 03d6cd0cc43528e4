"""Where formulas stand in a document: LaTeX, reStructuredText, Markdown and Doxygen, by plain scanning."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

DISPLAYS = "equation align gather eqnarray multline displaymath flalign alignat math aligned gathered split".split()
ENDINGS = {".tex": "tex", ".rst": "rst", ".md": "md", ".dox": "dox"}

TEX = re.compile(
    r"\\begin\{(?P<env>(?:" + "|".join(DISPLAYS) + r")\*?)\}|(?P<dollars>\$\$)|(?P<square>\\\[)|(?P<round>\\\()"
    r"|(?P<dollar>\$)|\\begin\{(?P<skip>verbatim\*?|lstlisting|comment)\}|\\."
)
MARKDOWN = re.compile(
    r"^[ ]*(?P<fence>`{3,}|~{3,})(?P<kind>[^\n]*)$|(?P<code>`+)|(?P<dollars>\$\$)|(?P<dollar>\$)|(?P<square>\\\[)|\\.",
    re.M,
)
DIRECTIVE = re.compile(r"^(?P<indent>[ \t]*)\.\. math::(?P<first>[^\n]*)$|:math:`(?P<inline>[^`]+)`", re.M)
DOXYGEN = re.compile(
    r"\\f\[(?P<square>.*?)\\f\]|\\f\$(?P<dollar>.*?)\\f\$|\\f\{(?P<env>[a-z]+\*?)\}\{?(?P<body>.*?)\\f\}", re.S
)


@dataclass(frozen=True, slots=True)
class Block:
    """A formula of a document: its text, where that begins, and whether it stands on lines of its own."""

    text: str
    start: int
    display: bool


def list_blocks(text: str, form: str) -> list[Block]:
    """The formulas of a document, in its order.

    form : ``tex``, ``rst``, ``md`` or ``dox``
    """
    found = {"tex": scan_tex, "md": scan_markdown, "rst": scan_rst, "dox": scan_doxygen}[form](text)
    return [block for block in found if block.text.strip()]


def hide_comments(text: str) -> str:
    """LaTeX without its comments: blanks stand in their place."""
    return re.sub(r"(?<!\\)((?:\\\\)*)%[^\n]*", lambda m: m[1] + " " * (len(m[0]) - len(m[1])), text)


def scan_tex(text: str) -> Iterator[Block]:
    """Environments of formulas, brackets and dollars; nothing of ``verbatim``."""
    place = 0
    while found := TEX.search(text, place):
        kind = found.lastgroup
        if kind is None:
            place = found.end()
            continue
        closing = {"dollars": "$$", "square": r"\]", "round": r"\)", "dollar": "$"}.get(kind)
        closing = closing or rf"\end{{{found[kind]}}}"
        stop = find_closing(text, closing, found.end())
        if stop < 0:
            yield Block(text[found.end() : found.end() + 200], found.end(), True)
            return
        if kind != "skip":
            body = text[found.end() : stop]
            start = found.end()
            if kind == "env" and found["env"].startswith("alignat"):
                argument = re.match(r"\s*\{\d+\}", body)
                start, body = (start + argument.end(), body[argument.end() :]) if argument else (start, body)
            yield Block(body, start, kind not in ("dollar", "round"))
        place = stop + len(closing)


def find_closing(text: str, closing: str, start: int) -> int:
    """Place of the closing mark that no backslash stands before; -1 where there is none."""
    place = text.find(closing, start)
    while place > 0 and closing[0] == "$" and text[place - 1] == "\\":
        place = text.find(closing, place + 1)
    return place


def scan_markdown(text: str) -> Iterator[Block]:
    """Dollars, brackets and fences of the kind ``math``; nothing of other code."""
    place = 0
    while found := MARKDOWN.search(text, place):
        kind = found.lastgroup
        place = found.end()
        if found["fence"]:
            closing = re.compile(rf"^[ ]*{re.escape(found['fence'])}[ ]*$", re.M).search(text, place)
            stop = closing.start() if closing else len(text)
            if found["kind"].strip() in ("math", "{math}"):
                yield Block(text[place:stop], place, True)
            place = closing.end() if closing else stop
        elif kind in ("code", "dollars", "dollar", "square"):
            mark = found[0]
            closing_mark = r"\]" if kind == "square" else mark
            stop = find_closing(text, closing_mark, place)
            limit = text.find("\n\n", place)
            if stop < 0 or (kind == "dollar" and 0 <= limit < stop):
                continue
            if kind != "code":
                yield Block(text[place:stop], place, kind != "dollar")
            place = stop + len(closing_mark)


def scan_rst(text: str) -> Iterator[Block]:
    """Directives and roles of the name ``math``; a blank line within a directive begins another formula."""
    for found in DIRECTIVE.finditer(text):
        if found["inline"]:
            yield Block(found["inline"], found.start("inline"), False)
            continue
        if found["first"].strip():
            yield Block(found["first"], found.start("first"), True)
        indent = len(found["indent"].expandtabs())
        start = place = found.end() + 1
        lines: list[str] = []
        for line in text[place:].splitlines(keepends=True):
            if line.strip() and len(line.expandtabs()) - len(line.expandtabs().lstrip()) <= indent:
                break
            if not line.strip() or re.match(r"\s*:\w+:", line):
                if "".join(lines).strip():
                    yield Block("".join(lines), start, True)
                lines, start = [], place + len(line)
            else:
                lines.append(line)
            place += len(line)
        if lines:
            yield Block("".join(lines), start, True)


def scan_doxygen(text: str) -> Iterator[Block]:
    r"""Formulas between ``\f[`` and ``\f]``, ``\f$``, and of ``\f{align*}{``."""
    for found in DOXYGEN.finditer(text):
        kind = found.lastgroup or "body"
        yield Block(found[kind], found.start(kind), kind != "dollar")
