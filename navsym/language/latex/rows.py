r"""A displayed formula cut into its relations: rows of ``align``, chains of ``=``, formulas beside each other."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import pairwise

from navsym.language.latex.macros import close_brace
from navsym.language.latex.parts import Refusal

RELATIONS = {
    **dict.fromkeys(("=", ":=", "=:", r"\triangleq", r"\coloneqq", r"\equiv", r"\doteq"), "="), "<": "<", ">": ">",
    **dict.fromkeys((r"\le", r"\leq", r"\leqslant"), "<="), **dict.fromkeys((r"\ge", r"\geq", r"\geqslant"), ">="),
    **dict.fromkeys((r"\ne", r"\neq"), "!="), r"\lt": "<", r"\gt": ">",
}  # fmt: skip
#: Links without a meaning in the language, and what to write instead. The links beside them are read.
LINKS = {
    **dict.fromkeys((r"\approx", r"\simeq", r"\cong", r"\sim"), "write a claim with its tolerance or its order"),
    **dict.fromkeys((r"\in", r"\subset"), "declare it below [symbols], such as { vector = 3 } or a range"),
    **dict.fromkeys((r"\propto", r"\ll", r"\gg"), "write an equation or a bound"),
}
#: Marks that refuse their whole row: what stands beside them may hold under a condition only.
OTHERS = frozenset(
    r"\to \rightarrow \leftarrow \Rightarrow \implies \iff \Leftrightarrow \mapsto \gets \longrightarrow "
    r"\Longrightarrow \stackrel \overset \underset \pm \mp \forall".split()
)
THEREFORE = (r"\Rightarrow", r"\implies", r"\Longrightarrow")
TOKEN = re.compile(r":=|=:|\\[A-Za-z]+|\\.|.", re.S)
WRAPPER = re.compile(
    r"\\(?:begin|end)\{(?:aligned|split|align\*?|gather\*?|gathered|eqnarray\*?|equation\*?|multline\*?|alignedat)\}(?:\{\d+\})?"
)
LABEL = re.compile(
    r"\\(?:label|tag\*?|[hv]space\*?|textcolor)\{[^{}]*\}|\\(?:nonumber|notag|empty)(?![A-Za-z])(?!\s*[_^])|\\text\{[\s.,;:]*\}"
)
OPERATORS = ("+", "-", r"\cdot", r"\times", r"\otimes")
#: Words between formulas, none of which is a condition.
JOINT = re.compile(
    r"\\(?:text|textrm|textnormal|mathrm)\s*\{\s*(?:where|and|with)[\s,:]*\}|\{\s*\\rm\s+(?:where|and|with)\s*\}"
)
LIMIT = re.compile(r"\\underset\s*\{([^{}]*)\}\s*\{\s*\\(?:lim|(?:mathrm|operatorname)\s*\{\s*lim\s*\})\s*\}")
FRAMED = re.compile(r"\\(boxed|underbrace|overbrace)\s*\{")
ENDS = r"[0-9]{0,3}[A-Za-z]|[0-9]{1,4}|[A-Za-z]\s*[-+]\s*[0-9]{1,3}"
DOTS = r"\\(?:l|c|)dots(?![A-Za-z])"
RUN = re.compile(
    rf"([A-Za-z])\s*=\s*([0-9]{{1,4}})((?:\s*,\s*[0-9]{{1,4}}(?![A-Za-z]))*)\s*,?\s*{DOTS}\s*,?\s*({ENDS})?(?=\s*(?:$|\\\\|[,;.}}]|\\q?quad))"
)
SPACE = r"(?:\s|~|\\[,;:! ]|\\q?quad(?![A-Za-z])|&)*"
FOR = re.compile(
    rf"(?:\\(?:text|textrm|textnormal|mathrm)\s*\{{\s*for(?: all)?\s*\}}|\\forall)(?={SPACE}{RUN.pattern})"
)
ALL = re.compile(rf"\\forall\s*(?:[A-Za-z]|\\[a-z]+)(?:_[A-Za-z0-9])?(?={SPACE}(?:\.?$|\\\\))")


@dataclass(frozen=True, slots=True)
class Side:
    """A side of a relation and where it begins in the block."""

    text: str
    start: int


@dataclass(frozen=True, slots=True)
class Relation:
    """Two sides, or why there are none.

    at     : where the relation begins
    linked : False where a row without two sides is refused whole
    index  : the letter that runs through a list such as ``k = 1, …, n``; it has to be a whole number
    """

    left: Side
    sign: str
    right: Side
    at: int
    trouble: Refusal | None = None
    linked: bool = True
    index: str = ""


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
    text = re.sub(r"\\text\{\s*\}(?=\s*[_^])", lambda m: "{}".ljust(len(m[0])), text)
    for pattern in (WRAPPER, LABEL):
        text = pattern.sub(lambda m: blank.sub(" ", m[0]), text)
    text = LIMIT.sub(lambda m: rf"\lim_{{{m[1]}}}".ljust(len(m[0])), unframe(text))
    for pattern in (JOINT, FOR, ALL):
        text = pattern.sub(lambda m: ",".ljust(len(m[0])), text)
    body = text.strip()
    array = re.match(r"\\begin\{array\}\s*\{[^{}]*\}", body)
    if array and closes_last(body) and "=" in body:
        start = text.index(r"\begin{array}")
        stop = text.rindex(r"\end{array}")
        text = text[:start] + " " * array.end() + text[start + array.end() : stop] + " " * (len(text) - stop)
    return text


def closes_last(body: str) -> bool:
    r"""True when the array at the beginning ends with the text."""
    depth = 0
    for found in re.finditer(r"\\(begin|end)\{array\}", body):
        depth += 1 if found[1] == "begin" else -1
        if depth == 0:
            return found.end() == len(body)
    return False


def unframe(text: str) -> str:
    r"""A frame falls; what stands above a brace is in parentheses, and the words below it fall."""
    while found := FRAMED.search(text):
        stop = close_brace(text, found.end() - 1)
        if stop < 0:
            raise Refusal(found.start(), "a closing brace", "none in reach", "close it")
        label = re.match(r"\s*[_^]\s*\{", text[stop + 1 :])
        end = close_brace(text, stop + label.end()) if label and found[1] != "boxed" else stop
        left, right = (" ", " ") if found[1] == "boxed" else ("(", ")")
        head, tail = left.ljust(len(found[0])), right.ljust(max(end, stop) - stop + 1)
        text = text[: found.start()] + head + text[found.end() : stop] + tail + text[max(end, stop) + 1 :]
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
        if piece.kind == "row" and continues(text, segments[-1], pieces[place + 1], not found):
            text = text[: piece.stop] + " " * len(piece.mark) + text[piece.stop + len(piece.mark) :]
            pieces[place + 1].start = segments[-1].pop().start
            continue
        relations = relate_row(text, segments, previous)
        found += relations
        previous = follow(relations, previous)
        segments = [[]]
    return found


def follow(relations: list[Relation], previous: Side | None) -> Side | None:
    """The side before a row that begins with a relation: behind equations the first one, behind others the last."""
    if not relations:
        return previous
    first, last = relations[0], relations[-1]
    if not all(relation.linked for relation in relations):
        return None
    return first.left if all(relation.sign == "=" for relation in relations) else last.right


def relate_row(text: str, segments: list[list[Piece]], previous: Side | None) -> list[Relation]:
    """The relations of a row; formulas beside each other count only when each of them is one."""
    lists = [relate(text, row, None if place else previous) for place, row in enumerate(segments)]
    troubles = [r for relations in lists for r in relations if r.trouble is not None]
    if troubles and len(segments) > 1:
        whole = Side(text[segments[0][0].start : segments[-1][-1].stop], segments[0][0].start)
        return [Relation(whole, "", whole, whole.start, troubles[0].trouble, False)]
    return [relation for relations in lists for relation in relations]


def continues(text: str, row: list[Piece], following: Piece, is_first: bool) -> bool:
    """True when the next row goes on with this one: with an operator, or with a relation behind a first left side."""
    behind = re.sub("[&~]", " ", text[following.start : following.stop]).strip()
    here = re.sub("[&~]", " ", text[row[-1].start : row[-1].stop]).strip()
    if not behind or not (here or len(row) > 1):
        return bool(is_first and here and len(row) == 1 and following.kind == "relation")
    starts = behind.startswith(OPERATORS) or re.match(r"\\q?quad\s*([-+]|\\cdot|\\times)", behind)
    joins = following.kind != "relation" or (is_first and len(row) == 1)
    return bool((starts and joins) or (len(row) > 1 and not here) or here.endswith(OPERATORS))


def list_pieces(text: str) -> list[Piece]:
    """The block cut at relations, rows and separators outside of brackets; a list of numbers is one piece."""
    pieces: list[Piece] = []
    runs = {found.start(): found.end() for found in RUN.finditer(text)}
    start = depth = skip = 0
    token = ""
    for found in TOKEN.finditer(text):
        before, token = token, found[0]
        if depth == 0 and found.start() in runs and re.fullmatch(SPACE, text[start : found.start()]):
            skip = runs[found.start()]
        if found.start() < skip:
            continue
        opens = token in ("{", "(", "[", r"\{", r"\begin", r"\lfloor", r"\langle")
        closes = token in ("}", ")", "]", r"\}", r"\end", r"\rfloor", r"\rangle")
        closes |= (before, token) == (r"\right", ".")
        depth = max(0, depth + opens - closes)
        kind = sort_mark(text, found) if depth == 0 else ""
        if kind:
            pieces.append(Piece(start, found.start(), token, kind))
            start = found.end()
    pieces.append(Piece(start, len(text), "", "end"))
    return pieces


def sort_mark(text: str, found: re.Match[str]) -> str:
    """What a mark outside of brackets does: nothing where it is part of a formula."""
    token = found[0]
    if token in RELATIONS or token in LINKS:
        return "relation"
    if token == "\\\\":
        return "row"
    if token in OTHERS:
        leads = token in THEREFORE and re.search(rf"(?:^|\\\\|[,;]){SPACE}$", text[: found.start()])
        return "separator" if leads else "other"
    wide = token in (r"\quad", r"\qquad") and separates(text, found.start(), found.end())
    return "separator" if token in (",", ";") or wide else ""


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
    if len(row) == 1:
        return relate_alone(sides[0], whole)
    if other := next((piece for piece in row if piece.kind == "other"), None):
        trouble = Refusal(other.stop, "a relation among = != < <= > >=", other.mark, "write one of these")
        return [Relation(whole, "", whole, whole.start, trouble, False)]
    if not sides[0].text and previous is not None:
        sides[0] = previous
    found = []
    for place, piece in enumerate(row[:-1]):
        left, right = sides[place], sides[place + 1]
        if not left.text or not right.text:
            trouble = Refusal(piece.stop, f"two sides of {piece.mark}", "an empty one", "write it")
            return [Relation(whole, "", whole, whole.start, trouble, False)]
        at = left.start if left is not previous else right.start
        link = LINKS.get(piece.mark)
        refused = Refusal(piece.stop, "a relation among = != < <= > >=", piece.mark, link) if link else None
        found.append(Relation(left, RELATIONS.get(piece.mark, piece.mark), right, at, refused))
    return found


def relate_alone(side: Side, whole: Side) -> list[Relation]:
    r"""What stands without a relation: nothing, a list such as ``k = 1, …, n``, or a trouble."""
    if not side.text:
        return []
    run = RUN.fullmatch(side.text)
    numbers = [int(run[2]), *map(int, re.findall("[0-9]+", run[3]))] if run else []
    if run is None or any(b != a + 1 for a, b in pairwise(numbers)):
        trouble = Refusal(side.start, "a relation such as =", "none", "write both sides")
        return [Relation(whole, "", whole, whole.start, trouble, False)]
    at = side.start
    index, first = Side(run[1], at), Side(run[2], at + run.start(2))
    found = [Relation(first, "<=", index, at, None, False, run[1])]
    if run[4]:
        found.append(Relation(index, "<=", Side(run[4], at + run.start(4)), at, None, False, run[1]))
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
    body = re.sub(r"(?:\s|\\q?quad(?![A-Za-z])|~|\\[,;:! ]|(?<!\\)(?<!\\right)[.,;:])+$", "", body)
    return Side(body, piece.start + lead)
