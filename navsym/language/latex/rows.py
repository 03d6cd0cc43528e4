r"""A displayed formula cut into its relations: rows of ``align``, chains of ``=``, formulas beside each other."""

from __future__ import annotations

import re
from dataclasses import dataclass

from navsym.language.latex.parts import Refusal

RELATIONS = {
    **dict.fromkeys(("=", ":=", r"\triangleq", r"\coloneqq", r"\equiv", r"\doteq"), "="), "<": "<", ">": ">",
    **dict.fromkeys((r"\le", r"\leq", r"\leqslant"), "<="), **dict.fromkeys((r"\ge", r"\geq", r"\geqslant"), ">="),
    **dict.fromkeys((r"\ne", r"\neq"), "!="), r"\lt": "<", r"\gt": ">",
}  # fmt: skip
OTHERS = frozenset(
    r"\approx \simeq \cong \sim \propto \to \rightarrow \leftarrow \Rightarrow \implies \iff \Leftrightarrow \in "
    r"\mapsto \gets \ll \gg \subset \longrightarrow \Longrightarrow \stackrel \overset \underset \pm \mp".split()
)
TOKEN = re.compile(r":=|\\[A-Za-z]+|\\.|.", re.S)
WRAPPER = re.compile(
    r"\\(?:begin|end)\{(?:aligned|split|align\*?|gather\*?|gathered|eqnarray\*?|equation\*?|multline\*?|alignedat)\}(?:\{\d+\})?"
)
LABEL = re.compile(
    r"\\(?:label|tag\*?|hspace\*?|vspace\*?)\{[^{}]*\}|\\(?:nonumber|notag)(?![A-Za-z])|\\text\{[\s.,;:]*\}"
)
OPERATORS = ("+", "-", r"\cdot", r"\times", r"\otimes")


@dataclass(frozen=True, slots=True)
class Side:
    """A side of a relation and where it begins in the block."""

    text: str
    start: int


@dataclass(frozen=True, slots=True)
class Relation:
    """Two sides, or why there are none; ``at`` is where the relation begins."""

    left: Side
    sign: str
    right: Side
    at: int
    trouble: Refusal | None = None


@dataclass(slots=True)
class Piece:
    """A stretch between two marks, and the mark behind it: a relation, a row, a separator, or the end."""

    start: int
    stop: int
    mark: str
    kind: str


def mask(text: str) -> str:
    """The text with blanks in place of labels and of environments that only align."""
    blank = re.compile(r"[^\n]")
    text = re.sub(r"\\\\(\s*\[[-0-9. a-z]{1,12}\])", lambda m: "\\\\" + blank.sub(" ", m[1]), text)
    for pattern in (WRAPPER, LABEL):
        text = pattern.sub(lambda m: blank.sub(" ", m[0]), text)
    body = text.strip()
    array = re.match(r"\\begin\{array\}\s*\{[^{}]*\}", body)
    if array and body.endswith(r"\end{array}") and body.count(r"\begin{array}") == 1 and "=" in body:
        start = text.index(r"\begin{array}")
        stop = text.rindex(r"\end{array}")
        text = text[:start] + " " * array.end() + text[start + array.end() : stop] + " " * (len(text) - stop)
    return text


def split_relations(text: str) -> list[Relation]:
    """The relations of a block in their order; a row without a relation is one trouble."""
    text = mask(text)
    pieces = list_pieces(text)
    found: list[Relation] = []
    previous: Side | None = None
    segments: list[list[Piece]] = [[]]
    for place, piece in enumerate(pieces):
        segments[-1].append(piece)
        if piece.kind in ("relation", "other"):
            continue
        if piece.kind == "separator":
            segments.append([])
            continue
        if piece.kind == "row" and continues(text, segments[-1], pieces[place + 1]):
            text = text[: piece.stop] + " " * len(piece.mark) + text[piece.stop + len(piece.mark) :]
            pieces[place + 1].start = segments[-1].pop().start
            continue
        relations = relate_row(text, segments, previous)
        found += relations
        if relations and relations[0].trouble is None:
            previous = relations[0].left
        segments = [[]]
    return found


def relate_row(text: str, segments: list[list[Piece]], previous: Side | None) -> list[Relation]:
    """The relations of a row; formulas beside each other count only when each of them is one."""
    lists = [relate(text, row, None if place else previous) for place, row in enumerate(segments)]
    troubles = [r for relations in lists for r in relations if r.trouble is not None]
    if troubles and len(segments) > 1:
        whole = Side(text[segments[0][0].start : segments[-1][-1].stop], segments[0][0].start)
        return [Relation(whole, "", whole, whole.start, troubles[0].trouble)]
    return [relation for relations in lists for relation in relations]


def continues(text: str, row: list[Piece], following: Piece) -> bool:
    """True when the next row goes on with this one: it begins with an operator, or nothing stands here behind one."""
    behind = text[following.start : following.stop].replace("&", " ").strip()
    here = text[row[-1].start : row[-1].stop].replace("&", " ").strip()
    if not behind or not (here or len(row) > 1):
        return False
    starts = behind.startswith(OPERATORS) or re.match(r"\\q?quad\s*([-+]|\\cdot|\\times)", behind)
    return bool((starts and following.kind != "relation") or (len(row) > 1 and not here) or here.endswith(OPERATORS))


def list_pieces(text: str) -> list[Piece]:
    """The block cut at relations, rows and separators that stand outside of brackets."""
    pieces: list[Piece] = []
    start = depth = 0
    for found in TOKEN.finditer(text):
        token = found[0]
        opens = token in ("{", "(", "[", r"\{", r"\begin", r"\lfloor", r"\langle")
        closes = token in ("}", ")", "]", r"\}", r"\end", r"\rfloor", r"\rangle")
        depth = max(0, depth + opens - closes)
        kind = ""
        if depth == 0:
            kind = (
                "relation" if token in RELATIONS else "row" if token == "\\\\" else "other" if token in OTHERS else ""
            )
            kind = "separator" if token in (",", ";") else kind
            if token in (r"\quad", r"\qquad") and separates(text, found.start(), found.end()):
                kind = "separator"
        if kind:
            pieces.append(Piece(start, found.start(), token, kind))
            start = found.end()
    pieces.append(Piece(start, len(text), "", "end"))
    return pieces


def separates(text: str, start: int, stop: int) -> bool:
    """True for a wide space between two things, and not beside an operator or at an end."""
    before, behind = text[:start].rstrip(" &\n\t"), text[stop:].lstrip(" &\n\t")
    if not before or not behind or before.endswith(("\\\\", *RELATIONS, *OPERATORS, ",", ";", r"\quad", r"\qquad")):
        return False
    return not behind.startswith((*RELATIONS, *OPERATORS, "\\\\", r"\quad", r"\qquad"))


def relate(text: str, row: list[Piece], previous: Side | None) -> list[Relation]:
    """The relations of one row; an empty left side is that of the row before."""
    sides = [cut(text, piece) for piece in row]
    whole = Side(text[row[0].start : row[-1].stop], row[0].start)
    if len(row) == 1 and not sides[0].text:
        return []
    if len(row) == 1:
        trouble = Refusal(sides[0].start, "a relation such as =", "none", "write both sides")
        return [Relation(whole, "", whole, whole.start, trouble)]
    if other := next((piece for piece in row if piece.kind == "other"), None):
        trouble = Refusal(other.stop, "a relation among = != < <= > >=", other.mark, "write one of these")
        return [Relation(whole, "", whole, whole.start, trouble)]
    if not sides[0].text and previous is not None:
        sides[0] = previous
    found = []
    for place, piece in enumerate(row[:-1]):
        left, right = sides[place], sides[place + 1]
        if not left.text or not right.text:
            trouble = Refusal(piece.stop, f"two sides of {piece.mark}", "an empty one", "write it")
            return [Relation(whole, "", whole, whole.start, trouble)]
        at = left.start if left is not previous else right.start
        found.append(Relation(left, RELATIONS[piece.mark], right, at))
    return found


def cut(text: str, piece: Piece) -> Side:
    """A side without the marks of alignment and the stop at its end."""
    body = text[piece.start : piece.stop]
    depth, chars = 0, list(body)
    for found in TOKEN.finditer(body):
        depth += (found[0] == r"\begin") - (found[0] == r"\end")
        if found[0] == "&" and depth == 0:
            chars[found.start()] = " "
    body = "".join(chars)
    lead = len(body) - len(body.lstrip())
    if spaced := re.match(r"(?:\s|\\q?quad(?![A-Za-z])|~|\\[,;:! ])*", body):
        lead = spaced.end()
    body = body[lead:].rstrip()
    body = re.sub(r"(?:\s|\\q?quad(?![A-Za-z])|~|\\[,;:! ]|(?<!\\)[.,;:])+$", "", body)
    return Side(body, piece.start + lead)
