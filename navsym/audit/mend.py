"""The smallest change of an assignment that makes it right: sought among edits of its text, then proved."""

from __future__ import annotations

import functools
import itertools
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from navsym.audit.decide import Scope, decide_entry, draw_points
from navsym.audit.evaluate import Edits, Evaluator
from navsym.audit.form import Function, Part, Unit, mentioned_in, names_in, spell_entry, walk
from navsym.audit.names import squeeze
from navsym.audit.questions import Entry, NotThereError
from navsym.audit.sources import Source, read_expression
from navsym.audit.values import Array, Cell, Scalar, Unread, Unreadable, Value
from navsym.audit.writes import written_outside
from navsym.claims.verdict import PROVED
from navsym.core.errors import NavsymError
from navsym.language.printer import print_tree
from navsym.language.tree import MINUS_ONE, NUMBER, POWER, SYMBOL, Tree, build, build_symbol, fold_tree, list_names
from navsym.prove.rooms.goals import player

PER_ENTRY = 4000  # changes that are tried, of a short function
PER_QUESTION = 6000
SHORT = 40  # statements of one
MOST_NAMES = 24
BESIDE = 12  # places that an entry depends on directly, of which all changes are tried first
TOLERANCE = 1e-9
FAMILIES = (("sin", "cos", "tan", "sqrt"), ("asin", "acos", "atan"), ("exp", "log"))
SWAPS = {
    f"{head}{name}{tail}": [f"{head}{other}{tail}" for other in family if other != name]
    for head, tail in (("", ""), ("", "f"), ("np.", ""), ("math.", ""), ("std::", ""))
    for family in FAMILIES
    for name in family
}
NUMBERS = ("0", "1", "2", "3", "4")

#: First byte, byte behind the last, and the text in between.
Edit = tuple[int, int, str]
Kind = Callable[["Place", list[Part]], Iterator[Edit]]


@dataclass(frozen=True, slots=True)
class Mend:
    """A change of one statement: parts in the place of others by ``id``, its line, and its new right side as text.

    Where the left side changes the text is the whole assignment; ``old`` is the expression that is changed otherwise.
    """

    line: int
    text: str
    edits: Mapping[int, Part]
    old: Part | None = None


@dataclass(slots=True)
class Budget:
    """How many changes may be tried for a question; ``known`` ones mended other entries."""

    question: int = PER_QUESTION
    known: list[Mend] = field(default_factory=list)


def suggest(entry: Entry, scope: Scope, budget: Budget) -> Mend | None:
    """The smallest change of one statement with which the entry is proved; None where none is found.

    First the statement that assigns the entry is edited, then those that it depends on, then the others.
    """
    if (source := entry.source) is None or entry.again is None or not isinstance(entry.expected, Scalar):
        return None
    assert isinstance(entry.code, Scalar)
    least = budget.question - PER_ENTRY
    own = entry.code.origin
    places = list_places(source, own, entry.expected.tree)
    value = None if own is None else right_side(own, entry.place)
    near = [place for place in places if place.statement is own]
    near = [place for place in near if place.part is value] or near
    rest = [place for place in places if place not in near]
    beside = [place for place in rest if place.distance < 2][:BESIDE]
    rest = [place for place in rest if place not in beside]
    reading, tried = source.read(), set[tuple[Any, ...]]()
    price = 1 + len(reading.cases) * len(reading.met) // SHORT
    box = {name: player.read_range(limits) for name, limits in scope.ranges.items()}
    points = itertools.islice(draw_points(box, scope), 3)  # at which wrong ones are dropped before anything is proved
    probes = [{name: int(v.p) / int(v.q) for name, v in point.items()} for point in points]
    for batch in itertools.chain(
        ([mend] for mend in budget.known),
        change_all(near, [*SMALL_EDITS, edit_names]),
        change_all(beside, [*SMALL_EDITS, edit_names]),
        change_all(rest, SMALL_EDITS),
        ([*place.change_target()] for place in places if place.statement.kind == "declare"),
        change_all(rest, [edit_names]),
        change_all(near + beside, [add_names]),
        change_all(near, [add_products]),
        ([*place.change_target()] for place in near or places),
        ([*place.put(text)] for place in near for text in rewrite(source, entry.expected.tree)),
        ([*place.change_target()] for place in places),
    ):
        fresh = {(*mend.edits, mend.text): mend for mend in batch if (*mend.edits, mend.text) not in tried}
        left = (budget.question - max(least, 0)) // price
        tried |= {*fresh}
        budget.question -= price * min(len(fresh), left)
        for mend in sift([*fresh.values()][:left], entry, source, probes):
            if is_right(mend, entry, source, scope, probes):
                budget.known.append(mend)
                return mend
        if len(fresh) > left:
            return None
    return None


def change_all(places: Sequence[Place], kinds: Sequence[Kind]) -> Iterator[list[Mend]]:
    """The mends of places by edits of some kinds, kind by kind."""
    return ([*place.change([kind])] for kind in kinds for place in places)


@dataclass(frozen=True, slots=True)
class Words:
    """The names that a mend may use, those of what is expected first.

    arrays  : names that have entries
    numbers : names without, and entries of inputs
    """

    arrays: tuple[str, ...]
    numbers: tuple[str, ...]
    others: tuple[str, ...]

    def like(self, name: str) -> Iterator[str]:
        """Other names, first those that have entries as this one has, or have none."""
        is_array = name in self.arrays
        for known in (self.arrays, self.others) if is_array else (self.others, self.arrays):
            yield from (other for other in known if other != name)


def list_words(source: Source, expected: Tree) -> Words:
    """The names of a function, of its mapping, and of what is expected of it."""
    spelled = [source.names.spellings.get(name, name) for name in list_names(expected)]
    first = list(dict.fromkeys(re.split(r"[\[(]", spelling)[0] for spelling in spelled))
    variables, body = source.read().cases[0].variables, source.function.body
    parts = [*walk(*body)]
    arrays = {name for p in parts if p.kind == "index" for name in names_in(p.parts[0])} | {*source.shapes}
    arrays |= {p.parts[0] for p in parts if p.kind == "declare" and p.parts[2]}
    arrays |= {name for name, variable in variables.items() if variable.shape}
    arrays |= {re.split(r"[\[(]", spelling)[0] for spelling in spelled if spelling[-1] in ")]"}
    known = dict.fromkeys([*first, *sorted(arrays | names_in(*body) | {a.name for a in source.function.arguments})])
    scalars = [name for name, variable in variables.items() if variable.shape == () and not {*"(@"} & {*name}]
    entries = [s for s in source.names.spellings.values() if s[-1] in ")]"]
    of_arrays, others = (tuple(name for name in known if (name in arrays) is kind) for kind in (True, False))
    return Words(of_arrays, tuple(dict.fromkeys([*spelled, *scalars, *entries]))[:MOST_NAMES], others)


@dataclass(frozen=True, slots=True)
class Place:
    """An expression on the right of a statement, which may be wrong, in its function.

    distance : how many statements lie between it and the entry, 0 for the one that assigns it
    """

    source: Source
    function: Function
    statement: Part
    part: Part
    words: Words
    distance: int

    def change(self, kinds: Sequence[Kind]) -> Iterator[Mend]:
        """The mends by edits of some kinds."""
        parts = list_inner(self.part)
        for text in (text for kind in kinds for text in rewrite_part(self.source.unit, self.part, kind(self, parts))):
            yield from self.put(text)

    def put(self, text: str) -> Iterator[Mend]:
        """The mend with a text in the place of the expression, where it is one."""
        if (part := read_mend(text, self.source.unit)) is not None and text != self.source.unit.text(self.part):
            (low, high), (start, end) = (whole_side(self.statement) or self.part).span, self.part.span
            source = self.source.unit.source
            whole = f"{cut(source, low, start)}{text}{cut(source, end, high)}"
            yield Mend(self.part.line, " ".join(whole.split()), {id(self.part): part}, self.part)

    def change_target(self) -> Iterator[Mend]:
        """The mends by another name or index on the left."""
        statement, unit = self.statement, self.source.unit
        if statement.kind not in ("assign", "declare"):
            return
        side = unit.text(whole_side(statement))
        target, *rest = statement.parts
        targets: list[tuple[str, Any]]
        if statement.kind == "declare":  # names that the function reads, and that nobody has declared
            body, arguments = self.function.body, {argument.name for argument in self.function.arguments}
            declared = {p.parts[0] for p in walk(*body) if p.kind in ("declare", "for")}
            targets = [(name, name) for name in sorted(names_in(*body) - declared - arguments)]
        else:
            parts, taken = list_inner(target), self.list_taken()
            texts = rewrite_part(unit, target, itertools.chain(edit_indices(self, parts), edit_names(self, parts)))
            free = [text for text in texts if squeeze(text) not in taken]
            targets = [(text, part) for text in free if (part := read_mend(text, unit)) is not None]
        for text, new in targets:
            edited = Part(statement.kind, statement.line, (new, *rest), statement.span)
            sign = statement.parts[1] if statement.kind == "assign" else ""
            yield Mend(statement.line, " ".join(f"{text} {sign}= {side}".split()), {id(statement): edited})

    def list_taken(self) -> set[str]:
        """The entries that other statements assign."""
        variables = self.source.read().cases[0].variables.items()
        cells = [(name, at, cell) for name, variable in variables for at, cell in variable.cells.items()]
        others = [(n, at) for n, at, c in cells if isinstance(c, Unread) or (c.line and c.origin is not self.statement)]
        return {squeeze(spell_entry(self.source.unit, name, at)) for name, at in others}


def cut(source: bytes, start: int, end: int) -> str:
    """A piece of a source."""
    return source[start:end].decode("utf-8", "replace")


def list_inner(part: Part) -> list[Part]:
    """A part and those in it that stand inside its text."""
    low, high = part.span
    return [inner for inner in walk(part) if low <= inner.span[0] < inner.span[1] <= high]


def rewrite_part(unit: Unit, part: Part, edits: Iterator[Edit]) -> Iterator[str]:
    """The text of a part after each of the edits."""
    low, high = part.span
    return (f"{cut(unit.source, low, start)}{new}{cut(unit.source, end, high)}" for start, end, new in edits)


@functools.lru_cache(1 << 13)
def read_mend(text: str, unit: Unit) -> Part | None:
    """A text as an expression of a language; None where it is none."""
    part = read_expression(text, unit)
    return None if any(inner.kind == "refused" for inner in walk(part)) else part


def list_places(source: Source, own: Part | None, expected: Tree) -> list[Place]:
    """The right sides of a function and of those that it calls, those on which a statement depends first."""
    functions, at = [source.function], 0
    while at < len(functions):
        called = [p.parts[0] for p in walk(*functions[at].body) if p.kind == "call"]
        fresh = [f for name in called for f in source.unit.functions.get(name, [])]
        functions += [f for f in dict.fromkeys(fresh) if f not in functions]
        at += 1
    kinds = ("assign", "declare", "return", "do", "for", "loop")
    pairs = ((function, part) for function in functions for part in walk(*function.body) if part.kind in kinds)
    statements = sorted(pairs, key=lambda pair: (functions.index(pair[0]), -pair[1].line))
    distances, near, at = {id(own): 0}, [own] if own is not None else [], 1
    while near:
        used = set[str]().union(*map(read_in, near))
        waiting = [(f.name, s) for f, s in statements if id(s) not in distances]
        near = [s for name, s in waiting if used & {name, *mentioned_in(*(s.parts[:1] if s.kind == "assign" else ()))}
                or (s.kind in ("declare", "for") and s.parts[0] in used)]  # fmt: skip
        distances |= {id(statement): at for statement in near}
        at += 1
    words, sides = list_words(source, expected), ((f, s, part) for f, s in statements for part in right_sides(s))
    places = [Place(source, f, s, part, words, distances.get(id(s), at)) for f, s, part in sides]
    return sorted(places, key=lambda place: place.distance)


def read_in(statement: Part) -> set[str]:
    """The names that a statement reads; ``+=`` reads what it writes."""
    is_new = statement.kind == "declare" or (statement.kind == "assign" and not statement.parts[1])
    return mentioned_in(whole_side(statement) if is_new else statement)


def whole_side(statement: Part) -> Any:
    """The right side of a statement, the returned value or the call; None where there is none."""
    at = {"assign": 2, "declare": 3, "return": 0, "do": 0}.get(statement.kind)
    return None if at is None else statement.parts[at]


def right_sides(statement: Part) -> list[Part]:
    """The expressions of a statement that may be wrong: the items of a list one by one, the bounds of a loop."""
    if statement.kind == "loop":
        return [*statement.parts[1].parts[1:]] if statement.parts[1].kind == "compare" else []
    if statement.kind == "for":
        return [bound for bound in statement.parts[1:4] if bound.span[0] < bound.span[1]]
    waiting, done = [unwrap(whole_side(statement))], list[Part]()
    while waiting:
        if (part := waiting.pop(0)) is not None and part.kind == "list":
            waiting += part.parts[0]
        elif part is not None:
            done.append(part)
    return done


def unwrap(value: Part | None) -> Part | None:
    """The list inside a call that makes an array of it, or the value itself."""
    is_made = value is not None and value.kind == "call" and len(value.parts[1]) == 1
    return value.parts[1][0] if value is not None and is_made and value.parts[1][0].kind == "list" else value


def right_side(statement: Part, place: tuple[int, int]) -> Part | None:
    """What a statement assigns to a place: the item of a list, or the whole right side."""
    value = unwrap(whole_side(statement)) if statement.kind in ("declare", "assign") else None
    for at in place:
        if value is not None and value.kind == "list":
            value = value.parts[0][at - 1] if at <= len(value.parts[0]) else None
    return None if value is not None and value.kind == "list" else value


def is_right(mend: Mend, entry: Entry, source: Source, scope: Scope, probes: list[dict[str, float]]) -> bool:
    """True when the entry is proved with this mend."""
    cell, expected = read_again(entry, source, mend.edits)
    if not isinstance(cell, Scalar) or not isinstance(expected, Scalar):
        return False
    if not {*list_names(cell.tree, expected.tree)} <= {*scope.ranges}:  # a name that has no value
        return False
    fits = all(map(functools.partial(are_near, cell.tree, expected.tree), probes))
    return fits and decide_entry(cell.tree, expected.tree, scope).status == PROVED


def read_again(entry: Entry, source: Source, edits: Edits) -> tuple[Cell, Cell]:
    """What the code computes with edits at the place of an entry, in its case, and what it should be."""
    texts, unread = [(c.text, c.holds) for c in entry.conditions], Unread(0, "not in this case")
    try:
        cases = source.read(edits).cases
        case = next((c for c in cases if all((x.text, x.holds) in texts for x in c.conditions)), None)
        return (unread, unread) if case is None or entry.again is None else entry.again(case)
    except (NavsymError, NotThereError):
        return unread, unread


def are_near(one: Tree, two: Tree, probe: Mapping[str, float]) -> bool:
    """True for formulas with values that are nearly equal at a point, or with none."""
    a, b = (evaluate(tree, probe) for tree in (one, two))
    return a is b is None or (a is not None and b is not None and abs(a - b) <= TOLERANCE * (1 + abs(a) + abs(b)))


def sift(mends: list[Mend], entry: Entry, source: Source, probes: list[dict[str, float]]) -> Iterator[Mend]:
    """Those mends of one expression that numbers do not rule out: the function runs once for all of them.

    In the place of the expression it gets symbols, beside which every mend is computed.
    """
    old = mends[0].old if len(mends) > 1 else None
    if old is None or may_write_more(source.unit, old):
        yield from mends
        return
    gap = Gap([mend.edits[id(old)] for mend in mends], source.unit.source, source.names.declarations)
    cell, expected = read_again(entry, source, {id(old): gap})
    for number, mend in enumerate(mends):
        if number in gap.doubtful or not isinstance(cell, Scalar) or not isinstance(expected, Scalar):
            yield mend
        elif gap.trials.keys() & {*list_names(cell.tree, expected.tree)}:
            points = (Filled(probe, gap.trials, number) for probe in probes)
            if all(map(functools.partial(are_near, cell.tree, expected.tree), points)):
                yield mend


def may_write_more(unit: Unit, part: Part) -> bool:
    """True for an expression with a call of a function of the file that may write to what is not its own."""
    return any(written_outside(unit, f) for name in mentioned_in(part) for f in unit.functions.get(name, ()))


class Gap:
    """What computes the mends of an expression each time that the expression is met, and gives symbols in its place.

    trials   : symbol -> its meaning in each mend, None where a mend is not read
    doubtful : the places of mends of which nothing is known
    """

    def __init__(self, parts: Sequence[Part], source: bytes, names: Iterable[str]):
        taken = (*names, source.decode("utf-8", "replace"))
        words = ("gap" + "x" * k for k in itertools.count(1))
        self.letters = next(word for word in words if not any(word in text for text in taken))
        self.parts, self.trials, self.doubtful = parts, dict[str, list[Cell | None]](), set[int]()

    def __call__(self, machine: Evaluator, part: Part) -> Value:
        own = machine.value(replace(part))  # which has no edit
        cells = own.cells
        trials = [self.attempt(machine, number, own) for number in range(len(self.parts))]
        symbols = list[Cell]()
        for at, cell in enumerate(cells):
            name = f"{self.letters}{len(self.trials)}"
            self.trials[name] = [None if trial is None else trial.cells[at] for trial in trials]
            symbols.append(cell if isinstance(cell, Unread) else replace(cell, tree=build_symbol(name)))
        return type(own)(own.shape, tuple(symbols)) if isinstance(own, Array) else symbols[0]

    def attempt(self, machine: Evaluator, number: int, own: Value) -> Value | None:
        """The value of a mend; the state of the run stays as it is."""
        part, unit = self.parts[number], machine.unit
        if may_write_more(unit, part):
            self.doubtful.add(number)
            return None
        count, others, steps = len(machine.conditions), len(machine.other_ways), machine.steps
        unknown = [v for v in (*machine.frame.values(), *machine.globals.values()) if v.shape is None]
        try:
            value = machine.value(part)
        except Unreadable:
            return None
        finally:
            for variable in unknown:  # a number or an array is not said by what is tried
                variable.shape = None
                variable.cells.pop((), None)
            is_split = len(machine.conditions) > count
            del machine.conditions[count:], machine.other_ways[others:]
            machine.steps = steps
        if is_split or value.shape != own.shape:
            self.doubtful.add(number)
            return None
        return value


class Filled(dict[str, float]):
    """A point at which the symbols of a gap have the values that a mend gives."""

    def __init__(self, probe: Mapping[str, float], trials: Mapping[str, list[Cell | None]], number: int):
        super().__init__(probe)
        self.trials, self.number = trials, number

    def __missing__(self, name: str) -> float:
        cell = self.trials[name][self.number]
        value = evaluate(cell.tree, self) if isinstance(cell, Scalar) else None
        if value is None:
            raise KeyError(name)
        self[name] = value
        return value


FLOATS: dict[str, Any] = {
    **{name: getattr(math, name) for name in "sin cos tan exp log sqrt asin acos atan sinh cosh tanh atan2".split()},
    **{"abs": abs, "pi": lambda: math.pi, POWER: pow},
    **{"+": lambda *terms: math.fsum(terms), "*": lambda *factors: math.prod(factors)},
}


def evaluate(tree: Tree, point: Mapping[str, float]) -> float | None:
    """The value in doubles, or None."""

    def step(part: Tree, inner: list[float]) -> float:
        if part.head in (NUMBER, SYMBOL):
            return float(part.args[0] if part.head == NUMBER else point[part.args[0]])
        return float(FLOATS[part.head](*inner))

    try:
        return fold_tree(tree, step)
    except (ArithmeticError, ValueError, KeyError, TypeError):
        return None


# Edits of a text


def edit_signs(place: Place, parts: list[Part]) -> Iterator[Edit]:
    """Another sign before a term, or another operator."""
    for part in parts:
        if part.kind == "op":
            sign, a, b = part.parts
            at = place.source.unit.source.find(sign.encode(), a.span[1], b.span[0])
            for other in {"+": "-*/", "-": "+*/", "*": "/+-", "/": "*-+"}.get(sign, "") if at >= 0 else "":
                yield at, at + len(sign), other
        elif part.kind == "minus":
            yield part.span[0], part.parts[0].span[0], ""
    for part in parts:
        yield part.span[0], part.span[0], "-"


def edit_indices(place: Place, parts: list[Part]) -> Iterator[Edit]:
    """Another index, or two of them exchanged."""
    for part in parts:
        if part.kind not in ("index", "call"):
            continue
        indices = [p for p in part.parts[1] if p.kind == "number"]
        inner = part.parts[0]
        if part.kind == "index" and inner.kind == "index":
            indices = [p for p in inner.parts[1] if p.kind == "number"] + indices
        if len(indices) == 2:
            (a, b), texts = indices, [place.source.unit.text(i) for i in indices]
            middle = place.source.unit.source[a.span[1] : b.span[0]].decode()
            yield a.span[0], b.span[1], f"{texts[1]}{middle}{texts[0]}"
        for index in indices:
            for other in range(place.source.unit.rules.first, 8 + place.source.unit.rules.first):
                yield *index.span, str(other)


def edit_calls(place: Place, parts: list[Part]) -> Iterator[Edit]:
    """sin for cos, and the like; a root less, or more."""
    root, functions = place.source.unit.rules.root, place.source.unit.functions
    for part in parts:
        known, given = part.parts[:2] if part.kind == "call" else ("", ())
        own = (n for n in sorted(functions) if n != known and len(functions[n][0].arguments) == len(given))
        for name in (*own, *SWAPS.get(known, ())) if part.kind == "call" else ():
            yield part.span[0], part.span[0] + len(known), name
        if part.kind == "call" and part.parts[0].endswith(("sqrt", "sqrtf")) and len(part.parts[1]) == 1:
            yield *part.span, place.source.unit.text(part.parts[1][0])
    for part in parts:
        if part.kind in ("name", "index"):
            yield *part.span, root.format(place.source.unit.text(part))


def edit_numbers(place: Place, parts: list[Part]) -> Iterator[Edit]:
    """Another small number, a half or the double."""
    for part in parts:
        if part.kind == "number":
            text = place.source.unit.text(part)
            sign, tail = "-" * text.startswith("-"), ".0" if "." in text else ""
            for number in (*NUMBERS, "0.5", "0.25"):
                yield *part.span, sign + number + tail * ("." not in number)
            yield *part.span, f"2*{text}"


def edit_factors(place: Place, parts: list[Part]) -> Iterator[Edit]:
    """A factor or term less, a square in the place of a factor, and the other way round."""
    text, source = place.source.unit.text, place.source.unit.source
    for part in parts:
        if part.kind == "op":
            sign, a, b = part.parts
            (low, middle), (start, high) = find_parentheses(source, a), find_parentheses(source, b)
            yield middle, high, ""
            yield low, start, ""
            if sign == "*":
                yield middle, high, f"/({text(b)}*{text(b)})"
    for part in parts:
        if part.kind in ("name", "index", "call"):
            yield *part.span, f"({text(part)}*{text(part)})"
            for factor in ("2", "0.5"):
                yield *part.span, f"{factor}*{text(part)}"


def edit_groups(place: Place, parts: list[Part]) -> Iterator[Edit]:
    """Parentheses less, or around other operands."""
    for part in parts:
        if part.kind != "op":
            continue
        sign, a, b = part.parts
        for inner, other in ((a, b), (b, a)):
            if inner.kind != "op" or (sign in "+-") == (inner.parts[0] in "+-"):
                continue
            if sign not in "+-":  # (x + y)*z
                low, high = find_parentheses(place.source.unit.source, inner)
                if low < inner.span[0]:
                    yield low, high, place.source.unit.text(inner)
                continue
            side = inner.parts[2] if inner is a else inner.parts[1]
            low, high = sorted((side.span, other.span))[0][0], max(side.span[1], other.span[1])
            yield low, high, f"({cut(place.source.unit.source, low, high)})"


def find_parentheses(source: bytes, part: Part) -> tuple[int, int]:
    """The bytes of a part with the parentheses around it."""
    before, behind = source[: part.span[0]].rstrip(), source[part.span[1] :]
    if not before.endswith(b"(") or not behind.lstrip().startswith(b")"):
        return part.span
    return len(before) - 1, part.span[1] + len(behind) - len(behind.lstrip()) + 1


def edit_names(place: Place, parts: list[Part]) -> Iterator[Edit]:
    """Another name in the place of one, or of one before parentheses; another entry or number for one."""
    for part in parts:
        if part.kind == "name" or (part.kind == "call" and part.parts[0] in place.words.arrays):
            for name in place.words.like(part.parts[0]) if part.kind == "name" else place.words.arrays:
                yield part.span[0], part.span[0] + len(part.parts[0]), name
    for part in parts:
        if part.kind in ("name", "index", "number"):
            for name in place.words.numbers:
                yield *part.span, name


def add_names(place: Place, parts: list[Part]) -> Iterator[Edit]:
    """One more name, as a factor, a divisor or a term, of a part or of the whole; arrays are terms of arrays."""
    for part in (*(p for p in parts if p.kind in ("name", "index", "call")), place.part):
        text, is_array = place.source.unit.text(part), part.parts[0] in place.words.arrays
        inside = f"({text})" if part.kind == "op" else text
        for name in (*(place.words.arrays if is_array else ()), *place.words.numbers):
            for sign in "+-":
                yield *part.span, f"{text} {sign} {name}" if part is place.part else f"({text} {sign} {name})"
        for name in ("2", "0.5", *place.words.numbers):
            yield *part.span, f"{inside}*{name}"
            yield *part.span, f"{inside}/{name}"


def add_products(place: Place, _: list[Part]) -> Iterator[Edit]:
    """A matrix, or its transpose, before the whole right side."""
    unit, text = place.source.unit, place.source.unit.text(place.part)
    mark, product = unit.rules.turned, "@" if unit.language == "python" else "*"
    shapes = {name: variable.shape for name, variable in place.source.read().cases[0].variables.items()}
    for name in [name for name, shape in shapes.items() if mark and shape and len(shape) == 2]:
        yield *place.part.span, f"{name} {product} ({text})"
        yield *place.part.span, f"{name}{mark} {product} ({text})"


def edit_shapes(place: Place, parts: list[Part]) -> Iterator[Edit]:
    """A transposition more or less, and factors exchanged."""
    mark = place.source.unit.rules.turned
    for part in parts:
        if mark and part.kind == "name":
            yield part.span[1], part.span[1], mark
        if part.kind == "method" and part.parts[1] in ("T", "transpose"):
            yield part.parts[0].span[1], part.span[1], ""
        pair = part.parts[1:] if part.kind == "op" else part.parts[1][:2] if part.kind == "call" else ()
        if len(pair) == 2:
            source = place.source.unit.source
            (low, middle), (start, high) = (find_parentheses(source, side) for side in pair)
            yield low, high, f"{cut(source, start, high)}{cut(source, middle, start)}{cut(source, low, middle)}"


SMALL_EDITS = (edit_signs, edit_indices, edit_calls, edit_numbers, edit_factors, edit_groups, edit_shapes)


def rewrite(source: Source, expected: Tree) -> Iterator[str]:
    """What is expected, in the language of the source."""

    def step(part: Tree, inner: list[Tree]) -> Tree:
        if not inner:
            return part
        is_call = part.head == POWER and part.args[1] is not MINUS_ONE and source.unit.language in ("c", "cpp")
        return build("pow" if is_call else part.head, tuple(inner))

    text, language = print_tree(fold_tree(expected, step)), source.unit.language
    if language == "python":
        text = re.sub(r"\b(sin|cos|tan|exp|log|sqrt)\(", r"np.\1(", text)
    if language in ("c", "cpp"):  # abs may be that of integers
        text = re.sub(r"\babs\(", "fabs(", text)
    text = source.names.show(text).replace("**", "^" if language == "matlab" else "**")
    yield re.sub(r"(?<![\w.])(\d+)/(\d+)", r"\1.0/\2.0", text) if language in ("c", "cpp") else text
