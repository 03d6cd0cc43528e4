"""The smallest change of an assignment that makes it right: sought among edits of its text, then proved."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from navsym.audit.decide import Scope, decide_entry, draw_points
from navsym.audit.form import Part, Unit, walk
from navsym.audit.questions import Entry
from navsym.audit.sources import Source, read_expression
from navsym.audit.values import Scalar
from navsym.claims.verdict import PROVED
from navsym.core.errors import NavsymError
from navsym.language.printer import print_tree
from navsym.language.tree import MINUS_ONE, NUMBER, POWER, SYMBOL, Tree, build, build_call, fold_tree, list_names
from navsym.prove.rooms.goals import player

PER_ENTRY = 1000  # changes that are tried
PER_QUESTION = 2000
MOST_NAMES = 24
TOLERANCE = 1e-9
SWAPS = {"sin": "cos", "cos": "sin", "sinf": "cosf", "cosf": "sinf", "asin": "acos", "acos": "asin"}
SWAPS |= {f"{head}{old}": f"{head}{new}" for head in ("np.", "math.", "std::") for old, new in SWAPS.items()}
NUMBERS = ("0", "1", "2", "3", "4")
ROOTS = {"c": "sqrt({})", "cpp": "sqrt({})", "python": "np.sqrt({})", "matlab": "sqrt({})", "rust": "{}.sqrt()"}
TRANSPOSED = {"rust": ".transpose()", "cpp": ".transpose()", "python": ".T", "matlab": "'"}

#: First byte, byte behind the last, and the text in between.
Edit = tuple[int, int, str]


@dataclass(frozen=True, slots=True)
class Mend:
    """The line of the assignment that is mended, and its new right side."""

    line: int
    text: str


@dataclass(slots=True)
class Budget:
    """How many changes may be tried: of one entry, and of a question; ``known`` ones mended other entries."""

    entry: int = PER_ENTRY
    question: int = PER_QUESTION
    known: list[tuple[Part, str]] = field(default_factory=list)

    def start_entry(self) -> None:
        """A new entry may try its share."""
        self.entry = min(PER_ENTRY, self.question)

    def spend(self) -> bool:
        """True when one more change may be tried."""
        self.entry, self.question = self.entry - 1, self.question - 1
        return self.entry >= 0


def suggest(entry: Entry, scope: Scope, budget: Budget) -> Mend | None:
    """The smallest change of one right side with which the entry is proved; None where none is found.

    First the statement that assigns the entry is edited, then the others, also in functions that it calls.
    """
    source = entry.source
    if source is None or entry.again is None or not isinstance(entry.expected, Scalar):
        return None
    assert isinstance(entry.code, Scalar)
    budget.start_entry()
    own = entry.code.origin
    value = None if own is None else right_side(own, entry.place)
    wholes = {id(part): whole_side(s) for s in list_statements(source) for part in right_sides(s)}
    search = Search(source, entry, scope, list_probes(entry, scope), budget, wholes)
    texts = () if value is None else rewrite(source, entry.expected.tree)
    others = [p for s in list_statements(source) if s is not own for p in right_sides(s)]
    rounds = itertools.chain(
        ((part, iter([text])) for part, text in budget.known),
        ((part, search.list_edits(part, nearby=False)) for part in ([] if value is None else [value]) + others),
        () if value is None else ((value, search.list_edits(value, nearby=True)), (value, texts)),
    )
    for part, changes in rounds:
        if (mend := search.try_texts(part, changes)) is not None:
            budget.known.append((part, mend.text))
            return mend
    return None


@dataclass(frozen=True, slots=True)
class Search:
    """What a change has to achieve."""

    source: Source
    entry: Entry
    scope: Scope
    probes: list[dict[str, float]]
    budget: Budget
    wholes: Mapping[int, Part]

    def list_edits(self, value: Part, *, nearby: bool) -> Iterator[str]:
        """The edits of a right side; with names from nearby, or without."""
        return list_edits(self.source, value, self.source.unit.text(value), nearby=nearby)

    def try_texts(self, value: Part, texts: Iterable[str]) -> Mend | None:
        """The first text that is right in the place of a right side."""
        tried = {self.source.unit.text(value)}
        for text in texts:
            if text in tried:
                continue
            tried.add(text)
            if not self.budget.spend():
                return None
            if is_right(text, value, self.entry, self.source, self.scope, self.probes):
                return Mend(value.line, self.write_whole(value, text))
        return None

    def write_whole(self, value: Part, text: str) -> str:
        """The whole right side, with the text in the place of the part that is mended."""
        whole = self.wholes.get(id(value), value)
        source = self.source.unit.source
        before, behind = source[whole.span[0] : value.span[0]], source[value.span[1] : whole.span[1]]
        return " ".join(f"{before.decode('utf-8', 'replace')}{text}{behind.decode('utf-8', 'replace')}".split())


def list_statements(source: Source) -> list[Part]:
    """The statements of a function, the last one first, and those of the functions that it calls."""
    functions, at = [source.function], 0
    while at < len(functions):
        called = [p.parts[0] for p in walk(*functions[at].body) if p.kind == "call"]
        fresh = [f for name in called for f in source.unit.functions.get(name, [])]
        functions += [f for f in dict.fromkeys(fresh) if f not in functions]
        at += 1
    kinds = ("assign", "declare", "return", "do")
    return [
        p
        for function in functions
        for p in sorted((p for p in walk(*function.body) if p.kind in kinds), key=lambda p: -p.line)
    ]


def whole_side(statement: Part) -> Any:
    """The right side of a statement, the returned value or the call; None where there is none."""
    return statement.parts[{"assign": 2, "declare": 3, "return": 0, "do": 0}[statement.kind]]


def right_sides(statement: Part) -> list[Part]:
    """The expressions of a statement that may be wrong: the items of a list one by one."""
    value = whole_side(statement)
    if value is None:
        return []
    if value.kind == "call" and len(value.parts[1]) == 1 and value.parts[1][0].kind == "list":
        value = value.parts[1][0]
    waiting, done = [value], []
    while waiting:
        part = waiting.pop(0)
        if part.kind == "list":
            waiting += part.parts[0]
        else:
            done.append(part)
    return done


def right_side(statement: Part, place: tuple[int, int]) -> Part | None:
    """What a statement assigns to a place: the item of a list, or the whole right side."""
    if statement.kind not in ("declare", "assign"):  # the argument of a call
        return None
    value = statement.parts[3] if statement.kind == "declare" else statement.parts[2]
    if statement.kind not in ("declare", "assign") or value is None:
        return None
    if value.kind == "call" and len(value.parts[1]) == 1 and value.parts[1][0].kind == "list":
        value = value.parts[1][0]
    for at in place:
        if value.kind != "list":
            break
        if at > len(value.parts[0]):
            return None
        value = value.parts[0][at - 1]
    return None if value.kind == "list" else value


def is_right(
    text: str, value: Part, entry: Entry, source: Source, scope: Scope, probes: list[dict[str, float]]
) -> bool:
    """True when the entry is proved with this text in the place of the right side."""
    part = read_expression(text, source.unit)
    if any(inner.kind == "refused" for inner in walk(part)):
        return False
    try:
        cases = source.read({id(value): part}).cases
        texts = [(c.text, c.holds) for c in entry.conditions]
        case = next((c for c in cases if all((x.text, x.holds) in texts for x in c.conditions)), None)
        if case is None or entry.again is None:
            return False
        cell, expected = entry.again(case)
    except NavsymError:
        return False
    if not isinstance(cell, Scalar) or not isinstance(expected, Scalar):
        return False
    for probe in probes:
        a, b = (evaluate(tree, probe) for tree in (cell.tree, expected.tree))
        if a is None and b is None:  # neither has a value there
            continue
        if a is None or b is None or abs(a - b) > TOLERANCE * (1 + abs(a) + abs(b)):
            return False
    return decide_entry(cell.tree, expected.tree, scope).status == PROVED


def list_probes(entry: Entry, scope: Scope) -> list[dict[str, float]]:
    """Points in doubles at which wrong candidates are dropped before anything is proved."""
    box = {name: player.read_range(limits) for name, limits in scope.ranges.items()}
    assert isinstance(entry.expected, Scalar)
    related = {name for relation in scope.relations for name in list_names(relation)}
    box = {name: limits for name, limits in box.items() if name in related or not scope.relations} | box
    points = itertools.islice(draw_points(box, scope), 3)
    return [{name: int(v.p) / int(v.q) for name, v in point.items()} for point in points]


FLOATS: dict[str, Any] = {
    **{name: getattr(math, name) for name in "sin cos tan exp log sqrt asin acos atan sinh cosh tanh atan2".split()},
    "abs": abs,
}


def evaluate(tree: Tree, point: dict[str, float]) -> float | None:
    """The value in doubles, or None."""

    def step(part: Tree, inner: list[float]) -> float:
        if part.head == NUMBER:
            return float(part.args[0])
        if part.head == SYMBOL:
            return point[part.args[0]]
        if part.head == "+":
            return math.fsum(inner)
        if part.head == "*":
            return math.prod(inner)
        if part.head == POWER:
            return float(inner[0] ** inner[1])
        return math.pi if part.head == "pi" else float(FLOATS[part.head](*inner))

    try:
        return fold_tree(tree, step)
    except (ArithmeticError, ValueError, KeyError, TypeError):
        return None


# Edits of a text


def list_edits(source: Source, value: Part, text: str, nearby: bool) -> Iterator[str]:
    """The text with one edit, small ones first; with names from nearby only on demand."""
    start = value.span[0]
    parts = [part for part in walk(value) if value.span[0] <= part.span[0] < part.span[1] <= value.span[1]]
    kinds = [edit_signs, edit_indices, edit_calls, edit_numbers, edit_factors, edit_shapes]
    for edits in [edit_names] if nearby else kinds:
        for low, high, new in edits(source, parts):
            yield text[: low - start] + new + text[high - start :]
    if nearby:
        yield from wrap(source, value, text)


def edit_signs(source: Source, parts: list[Part]) -> Iterator[Edit]:
    """Another sign before a term, or another operator."""
    for part in parts:
        if part.kind == "op":
            sign, a, b = part.parts
            place = find_sign(source.unit, a, b, sign)
            if place is None:
                continue
            for other in {"+": "-", "-": "+", "*": "/", "/": "*"}.get(sign, ""):
                yield place, place + len(sign), other
        elif part.kind == "minus":
            yield part.span[0], part.parts[0].span[0], ""
    for part in parts:
        yield part.span[0], part.span[0], "-"


def find_sign(unit: Unit, a: Part, b: Part, sign: str) -> int | None:
    """The byte of an operator between its operands."""
    between = unit.source[a.span[1] : b.span[0]]
    place = between.find(sign.encode())
    return None if place < 0 else a.span[1] + place


def edit_indices(source: Source, parts: list[Part]) -> Iterator[Edit]:
    """Another index, or two of them exchanged."""
    for part in parts:
        if part.kind not in ("index", "call"):
            continue
        indices = [p for p in part.parts[1] if p.kind == "number"]
        inner = part.parts[0]
        if part.kind == "index" and inner.kind == "index":
            indices = [p for p in inner.parts[1] if p.kind == "number"] + indices
        if len(indices) == 2:
            (a, b), texts = indices, [source.unit.text(i) for i in indices]
            middle = source.unit.source[a.span[1] : b.span[0]].decode()
            yield a.span[0], b.span[1], f"{texts[1]}{middle}{texts[0]}"
        for index in indices:
            for other in range(source.unit.rules.first, 8 + source.unit.rules.first):
                yield *index.span, str(other)


def edit_calls(source: Source, parts: list[Part]) -> Iterator[Edit]:
    """sin for cos, and the like; a root less, or more."""
    root = ROOTS[source.unit.language]
    for part in parts:
        if part.kind == "call" and part.parts[0] in SWAPS:
            low = part.span[0]
            yield low, low + len(part.parts[0]), SWAPS[part.parts[0]]
        if part.kind == "call" and part.parts[0].endswith(("sqrt", "sqrtf")) and len(part.parts[1]) == 1:
            yield *part.span, source.unit.text(part.parts[1][0])
    for part in parts:
        if part.kind in ("name", "index"):
            yield *part.span, root.format(source.unit.text(part))


def edit_numbers(source: Source, parts: list[Part]) -> Iterator[Edit]:
    """Another small number, a half or the double."""
    for part in parts:
        if part.kind == "number":
            text = source.unit.text(part)
            tail = ".0" if "." in text else ""
            for number in (*NUMBERS, "0.5", "0.25"):
                yield *part.span, number if "." in number else number + tail
            yield *part.span, f"2*{text}"


def edit_factors(source: Source, parts: list[Part]) -> Iterator[Edit]:
    """A factor or term less, a square in the place of a factor, and the other way round."""
    for part in parts:
        if part.kind == "op":
            _, a, b = part.parts
            yield a.span[1], b.span[1], ""
            yield a.span[0], b.span[0], ""
    for part in parts:
        if part.kind in ("name", "index", "call"):
            text = source.unit.text(part)
            yield *part.span, f"({text}*{text})"
            for factor in ("2", "0.5"):
                yield *part.span, f"{factor}*{text}"


def edit_names(source: Source, parts: list[Part]) -> Iterator[Edit]:
    """Another name of the function in the place of one."""
    names = nearby_names(source)
    for part in parts:
        if part.kind in ("name", "index"):
            for name in names:
                yield *part.span, name
    for part in parts:
        if part.kind in ("name", "index", "call"):
            text = source.unit.text(part)
            for name in names:
                yield *part.span, f"{text}*{name}"
                yield *part.span, f"({text} + {name})"
                yield *part.span, f"({text} - {name})"


def nearby_names(source: Source) -> list[str]:
    """Numbers that a right side could use: locals and parameters first, then entries of inputs."""
    case = source.read().cases[0]
    scalars = [name for name, variable in case.variables.items() if variable.shape == () and not {*"(@"} & {*name}]
    entries = [s for s in source.names.spellings.values() if "[" in s or "(" in s]
    return list(dict.fromkeys([*scalars, *entries]))[:MOST_NAMES]


def edit_shapes(source: Source, parts: list[Part]) -> Iterator[Edit]:
    """A transposition more or less, and factors exchanged."""
    mark = TRANSPOSED.get(source.unit.language)
    for part in parts:
        if mark and part.kind == "name":
            yield part.span[1], part.span[1], mark
        if part.kind == "method" and part.parts[1] in ("T", "transpose"):
            yield part.parts[0].span[1], part.span[1], ""
        pair = part.parts[1:] if part.kind == "op" else part.parts[1][:2] if part.kind == "call" else ()
        if len(pair) == 2:
            a, b = pair
            middle = source.unit.source[a.span[1] : b.span[0]].decode("utf-8", "replace")
            yield a.span[0], b.span[1], f"{source.unit.text(b)}{middle}{source.unit.text(a)}"


def wrap(source: Source, value: Part, text: str) -> Iterator[str]:
    """The whole right side with a factor."""
    inside = f"({text})" if value.kind == "op" and value.parts[0] in "+-" else text
    for factor in ("2", "0.5", *nearby_names(source)):
        yield f"{factor}*{inside}"
    for name in nearby_names(source):
        yield f"{inside}/{name}"
        yield f"{text} + {name}"
        yield f"{text} - {name}"
    product = "@" if source.unit.language == "python" else "*"
    mark = TRANSPOSED.get(source.unit.language)
    shapes = {name: variable.shape for name, variable in source.read().cases[0].variables.items()}
    for name in [name for name, shape in shapes.items() if mark and shape and len(shape) == 2]:
        yield f"{name} {product} ({text})"
        yield f"{name}{mark} {product} ({text})"


def rewrite(source: Source, expected: Tree) -> Iterator[str]:
    """What is expected, in the language of the source."""

    def step(part: Tree, inner: list[Tree]) -> Tree:
        if not inner:
            return part
        if part.head == POWER and part.args[1] is not MINUS_ONE and source.unit.language in ("c", "cpp"):
            return build_call("pow", *inner)
        return build(part.head, tuple(inner))

    text = print_tree(fold_tree(expected, step))
    if source.unit.language == "python":
        text = re.sub(r"\b(sin|cos|tan|exp|log|sqrt)\(", r"np.\1(", text)
    text = source.names.show(text) if source.unit.language != "matlab" else source.names.show(text).replace("**", "^")
    if source.unit.language in ("c", "cpp"):
        text = re.sub(r"(?<![\w.])(\d+)/(\d+)", r"\1.0/\2.0", text)
    yield text
