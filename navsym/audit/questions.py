"""Questions about code: each becomes entries, what the code computes beside what it should be."""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement, product
from pathlib import Path
from typing import Any

from navsym.audit.cases import Case, Condition, is_contradictory
from navsym.audit.decide import differentiate
from navsym.audit.form import spell_entry
from navsym.audit.names import Names
from navsym.audit.sources import Source
from navsym.audit.values import (
    Array,
    Cell,
    Index,
    Scalar,
    Unread,
    Unset,
    Value,
    Variable,
    add,
    identity_array,
    make_array,
    map_cells,
    matrix_product,
    places_of,
    square_sum,
    transpose,
)
from navsym.core.choice import one_of
from navsym.core.errors import DomainError, ExpressionSyntaxError, NavsymError, ShapeError, UnknownSymbolError
from navsym.language.expression import read_tree
from navsym.language.names import expect_keys, join_place, quote, suggest_nearest
from navsym.language.printer import to_text
from navsym.language.schema import as_list, as_table, as_text, as_title, require_key
from navsym.language.tree import NUMBER, ONE, SYMBOL, Tree, build_symbol, list_parts, replace
from navsym.models.model import Model
from navsym.prove.claimfile import read_claims, require_numbers

MOST_CASES = 64
MOST_ENTRIES = 4000
INDEX = re.compile(r"(.*?)((?:\s*[\[(][\d\s,]+[\])])*)", re.DOTALL)
Again = Callable[[Case], tuple[Cell, Cell]]
MATRIX_KEYS = ("F", "G", "H", "Q", "R")

#: What is said about a question in a workspace, as about a claim.
NOTES = ("title", "expect", "corrects", "reason")
#: In which sense two formulas are equal, the strongest first; a question admits others than the first two.
SENSES = ("exact", "manifold", "tangent", "order", "approximation", "noise-sign", "renamed")
#: The keys of questions about the entries of matrices, and of all that are equations, beside their own.
MATRIX_SENSES = ("by", "noise")
SENSE_KEYS = ("senses", "order")
#: The keys of each kind of question.
KINDS = {
    "jacobian": ("of", "by", "is"),
    "equal": ("left", "right"),
    "covariance": ("P", "F", "Q", "is"),
    "symmetric": ("of",),
    "orthogonal": ("of",),
    "unit": ("of",),
    "inverse": ("of", "is"),
    "dead": ("of", "by"),
    "claim": ("of", "claim"),
    "model": ("file", *MATRIX_KEYS),
}


class NotThereError(Exception):
    """A local name of Python without a value in a case: there the question asks nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class Entry:
    """What the code computes at one place, and what it should be.

    place      : row and column, from 1
    code       : a formula, or why it is not read
    conditions : of the case in which both hold
    source     : of the code
    again      : both formulas in another case, for code that is read again with a mend
    asking     : the question in this case, and the key of it that the matrix belongs to
    """

    place: tuple[int, int]
    code: Cell
    expected: Cell
    conditions: tuple[Condition, ...]
    source: Source | None = None
    again: Again | None = None
    asking: Asking | None = None
    key: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Question:
    """A question of the file, with what it needs to be asked."""

    name: str
    kind: str
    keys: Mapping[str, Any]
    where: str
    sources: Mapping[str, Source]
    names: Names
    folder: Path

    def relations(self) -> tuple[Tree, ...]:
        """What is zero by the mappings of all sources."""
        return tuple(dict.fromkeys(relation for source in self.sources.values() for relation in source.relations))

    def inputs(self) -> dict[str, tuple[str, Any]]:
        """Symbol -> spelling and declaration of what the sources read, in the order of their arguments."""
        order = [argument.name for source in self.sources.values() for argument in source.function.arguments]
        known = {n: (self.names.spellings.get(n, n), word) for n, word in self.names.declarations.items()}
        bases = {name: re.split(r"\W", spelling)[0] for name, (spelling, _) in known.items()}
        places = {name: order.index(base) if base in order else len(order) for name, base in bases.items()}
        return dict(sorted(known.items(), key=lambda item: places[item[0]]))


def read_question(block: Any, sources: Mapping[str, Source], names: Names, folder: Path, where: str) -> Question:
    """One ``[[question]]`` block."""
    table = as_table(block, where)
    place = join_place(where, "kind")
    if (kind := as_text(require_key(table, "kind", where), place, "a kind")) not in KINDS:
        message = f"expected one of {' '.join(KINDS)}; got {quote(kind)}; correct it: {suggest_nearest(kind, KINDS)}"
        raise ExpressionSyntaxError(message, where=place)
    expect_keys(table, ("name", "kind", *NOTES, *KINDS[kind], *more_keys(kind)), where)
    for key in KINDS[kind] if kind != "model" else ("file",):
        require_key(table, key, where)
    name = as_title(table.get("name", kind), join_place(where, "name"))
    question = Question(name, kind, table, where, sources, names, folder)
    read_senses(question)
    return question


def more_keys(kind: str) -> tuple[str, ...]:
    """The keys that say in which sense the sides have to be equal."""
    if kind == "dead":
        return ()
    return (*SENSE_KEYS, *(MATRIX_SENSES if kind in ("jacobian", "equal", "claim", "model") else ()))


def read_senses(question: Question) -> None:
    """Refuse a sense that a kind of question does not have, or that lacks what it needs."""
    keys, where = question.keys, join_place(question.where, "senses")
    one_of(keys.get("noise", "any"), ("any", "independent"), join_place(question.where, "noise"))
    if "order" in keys:
        place = join_place(question.where, "order")
        table = as_table(keys["order"], place)
        expect_keys(table, ("of", "up_to"), place)
        require_key(table, "of", place)
        if type(require_key(table, "up_to", place)) is not int or not 0 <= table["up_to"] <= 7:
            message = f"expected an order from 0 to 7; got {quote(table['up_to'])}; correct it"
            raise DomainError(message, where=join_place(place, "up_to"))
    needs = {
        "order": ("order" in keys, "order = { of, up_to }"),
        "approximation": (any(s.approximations for s in question.sources.values()), "approximations below [[code]]"),
        "tangent": ("by" in keys and bool(question.relations()), "by, and relations below [[code]]"),
        "noise-sign": ("noise" in keys, 'noise = "any" or "independent"'),
        "renamed": (True, ""),
    }
    known = [*needs][: 2 if "noise" not in more_keys(question.kind) else None]
    for sense in as_list(keys["senses"], where) if "senses" in keys else ():
        if not needs[one_of(sense, known, where)][0]:
            raise DomainError(f"expected {needs[sense][1]} for the sense {sense}; got none; declare it", where=where)


def list_entries(question: Question) -> list[Entry]:
    """The entries of a question, in every case of the code that it is about."""
    if question.kind == "dead":
        return list_dead(question)
    entries: list[Entry] = []
    for asking in list_askings(question):
        with contextlib.suppress(NotThereError):
            entries += getattr(asking, f"ask_{question.kind}")()
    if question.kind == "symmetric":
        return [entry for entry in entries if entry.place[0] < entry.place[1]]
    if not entries:
        message = "expected names that have values in one case; got some that never have one together; ask for others"
        raise DomainError(message, where=question.where)
    return entries


def list_askings(question: Question) -> list[Asking]:
    """The question in every case of the code; raises DomainError for too many."""
    used = [s for s in question.sources.values() if is_used(s.name, question.keys)]
    cases = [[*source.read().cases] for source in used]
    limits, askings = list_limits(question.names), list[Asking]()
    for count, chosen in enumerate(product(*cases)):
        if count == MOST_CASES:
            message = f"expected at most {MOST_CASES} cases; got more; ask about one function at a time"
            raise DomainError(message, where=question.where)
        conditions = tuple(c for case in chosen for c in case.conditions)
        if not is_contradictory((*limits, *conditions)):
            askings.append(Asking(question, {s.name: case for s, case in zip(used, chosen, strict=True)}, conditions))
    return askings


def list_limits(names: Names) -> list[Condition]:
    """The ends of the declared ranges as conditions."""
    limits = list[Condition]()
    for name, (low, high, flags) in names.ranges().items():
        for end, sign, flag in ((low, ">", "open-low"), (high, "<", "open-high")):
            if end is not None and (number := read_tree(end, {})).head == NUMBER:
                limits.append(Condition(name, 0, True, sign + "=" * (flag not in flags), build_symbol(name), number))
    return limits


def list_dead(question: Question) -> list[Entry]:
    """Each output beside what it is for another value of one input: where it is dead, both are equal.

    Two values of an input may lead into two cases: each pair of cases is compared that one choice of the others allows.
    """
    entries: list[Entry] = []
    askings = list_askings(question)
    for column, symbol in enumerate(askings[0].inputs(question.keys["by"], "by"), start=1):
        held = [r for s in question.sources.values() for r in s.relations if symbol in list_parts(r)]
        if held or symbol.head != SYMBOL:
            got = "one in relations" if held else "a constant"
            message = f"expected an input that is free; got {got}; ask about others"
            raise DomainError(message, where=join_place(question.where, "by"))
        twin = {symbol: question.names.twin(symbol)}
        for one, two in combinations_with_replacement(askings, 2):
            moved_ones = [(c, [t and replace(t, twin) for t in (c.left, c.right)]) for c in two.conditions]
            conditions = (*one.conditions, *(Condition(c.text, c.line, c.holds, c.sign, *s) for c, s in moved_ones))
            if is_contradictory(conditions):
                continue
            if len(entries) > MOST_ENTRIES:
                raise DomainError("expected fewer outputs and cases; got too many; ask for one", where=question.where)
            cells = [asking.resolve(question.keys["of"], "of").cells for asking in (one, two)]
            for row, (cell, other) in enumerate(zip(*cells, strict=True)):
                source = one.repeat("of", row, cell)[0]
                moved = other if isinstance(other, Unread) else Scalar(replace(other.tree, twin))
                entries.append(Entry((row + 1, column), cell, moved, conditions, source))
    return entries


def is_used(name: str, keys: Any) -> bool:
    """True when a reference to a code stands somewhere in a question."""
    if isinstance(keys, Mapping | list):
        return any(is_used(name, value) for value in (keys.values() if isinstance(keys, Mapping) else keys))
    return isinstance(keys, str) and keys.startswith(f"{name}:")


@dataclass(frozen=True, slots=True, eq=False)
class Asking:
    """A question in one case of each source."""

    question: Question
    cases: Mapping[str, Case]
    conditions: tuple[Condition, ...]

    def place(self, key: str) -> str:
        return join_place(self.question.where, key)

    def split(self, reference: Any, where: str) -> tuple[Source, str] | None:
        """Source and name of ``code:name``; None for another text."""
        if isinstance(reference, str) and ":" in reference:
            head, _, tail = reference.partition(":")
            if head in self.question.sources:
                return self.question.sources[head], tail.strip()
            if not tail.startswith(":"):
                message = f"expected the name of a code before the colon; got {quote(head)}; correct it: "
                raise UnknownSymbolError(message + suggest_nearest(head, self.question.sources), where=where)
        return None

    def resolve(self, reference: Any, key: str) -> Value:
        """The value of a reference, of an expression, or of a list of these."""
        where = self.place(key)
        if isinstance(reference, list):
            values = [self.resolve(item, key) for item in as_list(reference, where)]
            shapes = {value.shape for value in values}
            if len(shapes) != 1:
                raise ShapeError("expected rows of one length; got a ragged list; correct it", where=where)
            return Array((len(values), *next(iter(shapes))), tuple(c for v in values for c in v.cells))
        if (parts := self.split(reference, where)) is not None:
            return self.output(*parts, where)
        if not isinstance(reference, (str, int)) or isinstance(reference, bool):
            message = f'expected a reference such as "model:F" or an expression; got {quote(reference)}; quote it'
            raise ExpressionSyntaxError(message, where=where)
        return self.known(str(reference), key)

    def output(self, source: Source, name: str, where: str) -> Value:
        """What the code assigns to a name, or returns."""
        case = self.cases[source.name]
        found = INDEX.fullmatch(name)
        base, indices = (found[1].strip(), found[2]) if found else (name, "")
        numbers = [int(n) - source.unit.rules.first for n in re.findall(r"\d+", indices)]
        if base == "return":
            if (value := case.returned) is None:
                raise UnknownSymbolError(f"expected a returned value; got none in {source.function.name}; "
                                         "name a variable", where=where)  # fmt: skip
            if numbers and isinstance(value, Array):
                require_inside(value.shape, numbers, where)
                return value.at(*numbers)
            return value
        variable = case.variables.get(base)
        if variable is None and any(base in other.variables for other in source.read().cases):
            is_local = "." not in base and base not in {argument.name for argument in source.function.arguments}
            if source.unit.language == "python" and is_local:  # there is no such name then
                raise NotThereError(f"{base} has no value in this case")
            return Unread(source.function.line, f"{base} is not assigned in a case of {source.function.name}")
        if variable is None:
            message = f"expected a name that {source.function.name} assigns; got {quote(base)}; correct it: "
            raise UnknownSymbolError(message + suggest_nearest(base, case.variables), where=where)
        return read_variable(source, variable, tuple(numbers), where)

    def inputs(self, reference: Any, key: str) -> list[Any]:
        """The symbols of inputs."""
        where = self.place(key)
        if isinstance(reference, list):
            return [symbol for item in reference for symbol in self.inputs(item, key)]
        if (parts := self.split(reference, where)) is None:
            message = f'expected inputs of a code, such as "model:x[0]"; got {quote(reference)}; name them so'
            raise ExpressionSyntaxError(message, where=where)
        return parts[0].inputs(parts[1], where)

    def matrix(self, key: str) -> Array:
        """A reference that must be a matrix; a vector is a column."""
        value = self.side(key)
        if not isinstance(value, Array):
            why = value.why if isinstance(value, Unread) else "a number"
            raise ShapeError(f"expected a matrix; got {why}; declare its size", where=self.place(key))
        return value if len(value.shape) == 2 else Array((*value.shape, 1), value.cells)

    def pair(self, code: Value, expected: Value, key: str, *, upper: bool = False) -> list[Entry]:
        """Entries of two values of one shape."""
        if isinstance(code, Unread) or isinstance(expected, Unread):
            is_, should = (v if isinstance(v, Unread) else Scalar(ONE) for v in (code, expected))
            return [Entry((1, 1), is_, should, self.conditions, asking=self, key=key)]
        shapes = [v.shape for v in (code, expected)]
        if shapes[0] != shapes[1] and not (all(shapes) and is_alike(*shapes)):
            got = " and ".join(str(list(s)) if s else "a number" for s in shapes)
            raise ShapeError(f"expected two sides of one shape; got {got}; correct one", where=self.place(key))
        entries = []
        cells = zip(places_of(shapes[0]), code.cells, expected.cells, strict=True)
        for number, (place, is_, should) in enumerate(cells):
            if upper and len(place) == 2 and place[0] > place[1] and isinstance(is_, Unset):
                continue  # the lower half of a symmetric matrix, which the code leaves alone
            row = (place[0] + 1, place[1] + 1) if len(place) == 2 else (place[0] + 1, 1) if place else (1, 1)
            entries.append(Entry(row, is_, should, self.conditions, *self.repeat(key, number, should), self, key))
        return entries

    def repeat(self, key: str, number: int, expected: Cell) -> tuple[Source | None, Again | None]:
        """How to find the same entry again when the code is read with a mend."""
        listed = flatten(self.question.keys.get(key))
        at = number if len(listed) > 1 else 0
        parts = self.split(listed[at], "") if at < len(listed) else None
        if parts is None:
            return next(iter(self.question.sources.values())), None
        source, name = parts
        is_direct = self.question.kind in ("equal", "jacobian", "covariance", "claim", "model")

        def again(case: Case) -> tuple[Cell, Cell]:
            asking = Asking(self.question, {**self.cases, source.name: case}, ())
            if is_direct:
                before, now = (a.output(source, name, self.question.where) for a in (self, asking))
                if before.shape != now.shape:
                    return Unread(0, "another shape"), expected
                return now.cells[number if len(listed) == 1 else 0], expected
            entries: list[Entry] = getattr(asking, f"ask_{self.question.kind}")()
            entry = entries[number] if number < len(entries) else None
            return (entry.code, entry.expected) if entry else (Unread(0, "another shape"), expected)

        return source, again

    def require_shapes(self, *wanted: tuple[Array, int, int]) -> None:
        """Raise ShapeError for a matrix of another number of rows or columns."""
        for matrix, *shape in wanted:
            if [*matrix.shape] != shape:
                message = f"expected a matrix of {shape}; got {list(matrix.shape)}; correct the question"
                raise ShapeError(message, where=self.question.where)

    def side(self, key: str) -> Value:
        """The value of a key."""
        return self.resolve(self.question.keys[key], key)

    def ask_equal(self) -> list[Entry]:
        return self.pair(self.side("left"), self.side("right"), "left")

    def ask_jacobian(self) -> list[Entry]:
        of, by, given = self.side("of").cells, self.inputs(self.question.keys["by"], "by"), self.side("is")
        shape = (len(of), len(by))
        if isinstance(given, Unread):
            given = Array(shape, (given,) * (len(of) * len(by)))
        if not is_alike(given.shape if isinstance(given, Array) else (1, 1), shape):
            got = list(given.shape) if isinstance(given, Array) else "a number"
            message = f"expected {len(of)} rows and {len(by)} columns; got {got}; correct of or by"
            raise ShapeError(message, where=self.place("is"))
        expected = make_array(shape, lambda i, j: derivative(of[i], by[j]))
        return self.pair(Array(shape, given.cells), expected, "is")

    def ask_covariance(self) -> list[Entry]:
        F, Q, new = (self.matrix(key) for key in ("F", "Q", "is"))
        P = self.start_of("P", F.shape)
        self.require_shapes((P, F.shape[1], F.shape[1]), (Q, F.shape[0], F.shape[0]))
        expected = whole = map_cells(add, matrix_product(matrix_product(F, P), transpose(F, True)), Q)
        if isinstance(whole, Array) and is_symmetric(P) and is_symmetric(Q):  # then F P F' + Q: one formula for both
            expected = make_array(whole.shape, lambda i, j: whole.at(min(i, j), max(i, j)))
        return self.pair(new, expected, "is", upper=True)

    def start_of(self, key: str, shape: Index) -> Array:
        """A matrix of the code before the code has changed it."""
        source, name = self.split(self.question.keys[key], self.place(key)) or (None, "")
        variable = self.cases[source.name].variables.get(name) if source is not None else None
        if source is None or variable is None:
            return self.matrix(key)
        if not variable.is_input and name not in {argument.name for argument in source.function.arguments}:
            return self.matrix(key)
        size = source.shapes.get(name) or variable.shape or (shape[1], shape[1])
        return make_array(size, lambda *p: Scalar(source.symbol(spell_entry(source.unit, name, p))))

    def ask_symmetric(self) -> list[Entry]:
        of = self.matrix("of")
        self.require_shapes((of, of.shape[0], of.shape[0]))
        return self.pair(of, make_array(of.shape, lambda i, j: of.at(j, i)), "of")

    def ask_orthogonal(self) -> list[Entry]:
        of = self.matrix("of")
        return self.pair(matrix_product(of, transpose(of, False)), identity_array(of.shape[0], of.shape[0]), "of")

    def ask_unit(self) -> list[Entry]:
        of = self.side("of")
        return self.pair(square_sum(of) if not isinstance(of, Unread) else of, Scalar(ONE), "of")

    def ask_inverse(self) -> list[Entry]:
        of, given = self.matrix("of"), self.matrix("is")
        self.require_shapes((of, of.shape[0], of.shape[0]), (given, of.shape[0], of.shape[0]))
        return self.pair(matrix_product(of, given), identity_array(*of.shape), "is")

    def ask_claim(self) -> list[Entry]:
        side = read_claim_side(self.question.keys["claim"], self.question.folder, self.place("claim"))
        return self.pair(self.side("of"), self.outside(side, "claim"), "of")

    def ask_model(self) -> list[Entry]:
        path = as_text(self.question.keys["file"], self.place("file"), "a model file")
        matrices = read_model_matrices(self.question.folder / path)
        asked = [key for key in MATRIX_KEYS if key in self.question.keys]
        if not asked:
            raise ShapeError("expected F, G, H, Q or R of the code; got none; name one", where=self.question.where)
        entries: list[Entry] = []
        for key in asked:
            if key not in matrices:
                message = f"expected a model with {key}; got one with {', '.join(matrices)}; remove the question"
                raise UnknownSymbolError(message, where=self.place(key))
            entries += self.pair(self.matrix(key), self.outside(matrices[key], key), key)
        return entries

    def outside(self, rows: list[list[str]], key: str) -> Value:
        """Formulas of another file in the symbols of the code."""
        cells = tuple(self.known(text, key) for row in rows for text in row)
        return cells[0] if len(cells) == 1 else Array((len(rows), len(rows[0])), cells)

    def known(self, text: str, key: str) -> Scalar:
        """A formula in the symbols of the code."""
        names, where = self.question.names, self.place(key)
        return Scalar(read_tree(names.translate(text, where), names.declarations, where=where))


def is_alike(one: Index, two: Index) -> bool:
    """True for shapes that have the same cells row by row: one of them is flat, or both differ by sides of one cell."""
    tight = [tuple(n for n in shape if n != 1) for shape in (one, two)]
    return math.prod(one) == math.prod(two) and (tight[0] == tight[1] or min(map(len, tight)) < 2)


def is_symmetric(matrix: Array) -> bool:
    """True for a matrix that reads the same across its diagonal, formula by formula."""
    m, n = matrix.shape
    trees = [cell.tree if isinstance(cell, Scalar) else None for cell in matrix.cells]
    return m == n and all(trees[i * n + j] is trees[j * n + i] is not None for i in range(n) for j in range(i + 1))


def flatten(reference: Any) -> list[Any]:
    """The references in a list of lists."""
    return [r for item in reference for r in flatten(item)] if isinstance(reference, list) else [reference]


def derivative(cell: Cell, symbol: Any) -> Cell:
    """The derivative of a formula."""
    if isinstance(cell, Unread):
        return cell
    try:
        return Scalar(differentiate(cell.tree, symbol))
    except NavsymError as error:
        return Unread(cell.line, error.message)


def require_inside(shape: Index, place: Sequence[int], where: str) -> None:
    """Raise ShapeError for a place outside an array."""
    if len(place) != len(shape) or any(not 0 <= i < n for i, n in zip(place, shape, strict=True)):
        raise ShapeError(f"expected a place inside {list(shape)}; got {list(place)}; correct it", where=where)


def read_variable(source: Source, variable: Variable, place: Index, where: str) -> Value:
    """The final value of a variable, or of one of its entries."""
    is_written = any(not isinstance(c, Scalar) or c.line for c in variable.cells.values())

    def cell(spot: Index) -> Cell:
        if variable.all_unread is not None:
            return variable.all_unread
        if spot in variable.cells:
            return variable.cells[spot]
        if variable.is_input and (variable.name in source.shapes or not is_written):
            return Scalar(source.symbol(spell_entry(source.unit, variable.name, spot)))
        return Unset(source.function.line, f"{source.function.name} does not assign it")

    if (shape := variable.shape) is None and (spots := [spot for spot in variable.cells if spot]):
        shape = tuple(max(spot[k] for spot in spots) + 1 for k in range(len(spots[0])))
    if place:
        if shape is not None:
            require_inside(shape, place, where)
        return cell(place)
    return Array(shape, tuple(map(cell, places_of(shape)))) if shape else cell(())


# What code is compared with from other files


def read_claim_side(reference: Any, folder: Path, where: str) -> list[list[str]]:
    """The right side of a claim of a claim file, ``"formulas.toml:half-angle"``, as rows of texts."""
    if not isinstance(reference, str) or ".toml:" not in reference:
        message = f'expected a claim such as "claims.toml:name"; got {quote(reference)}; write file and id'
        raise ExpressionSyntaxError(message, where=where)
    file, _, name = reference.rpartition(":")
    claims = {claim.id: claim for claim in read_claims(folder / file).claims}
    if name not in claims:
        message = f"expected a claim of {file} ({', '.join([*claims][:12])}); got {quote(name)}; correct the id"
        raise UnknownSymbolError(message, where=where)
    claim = require_numbers(claims[name])
    if claim.relation != "=" or claim.tolerance is not None:
        raise DomainError("expected an equation; got another claim; choose one with =", where=where)
    right = claim.formula.right
    rows = right if isinstance(right, list) else [right]
    return [[str(cell) for cell in row] if isinstance(row, list) else [str(row)] for row in rows]


def read_model_matrices(path: Path) -> dict[str, list[list[str]]]:
    """F, and H, of a linear model file as rows of texts."""
    model = Model.load(path)
    found = {key: matrix for key, matrix in (("F", model.F), ("H", model.H)) if matrix is not None}
    return {key: [[to_text(cell) for cell in row] for row in matrix.tolist()] for key, matrix in found.items()}
