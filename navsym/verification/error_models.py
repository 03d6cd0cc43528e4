"""The conventions of an error model, whatever it is read from: a file, a document, a model, source code of a filter."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING, Any

from navsym.audit.answer import read_sources
from navsym.audit.decide import differentiate
from navsym.audit.questions import Question, list_askings
from navsym.audit.values import Unread, Value, multiply, raise_to, total
from navsym.conventions.answer import Conflict, Conventions, find_conventions
from navsym.conventions.generating import fill_model, require_known
from navsym.conventions.reading import read_cell, read_problem
from navsym.core.errors import DomainError, DuplicateError, UnknownSymbolError
from navsym.language.files import name_file
from navsym.language.names import join_place, quote, suggest_nearest
from navsym.language.printer import print_tree
from navsym.language.schema import as_list, as_table, require_key
from navsym.language.tomlfile import read_toml
from navsym.language.tree import NUMBER, ONE, POWER, PRODUCT, SUM, SYMBOL, ZERO, Tree, build, build_symbol, fold_tree
from navsym.models.blocks import write_out
from navsym.models.meaning import require_meaning

if TYPE_CHECKING:
    from navsym.audit.names import Names
    from navsym.conventions.card import Card

BOOK = "book:"
WORD = re.compile(r"[A-Za-z]\w*")
#: Functions that have these values at zero.
AT_ZERO = dict.fromkeys(("sin", "tan", "asin", "atan", "sinh", "tanh", "sqrt"), ZERO) | dict.fromkeys(
    ("cos", "cosh", "exp"), ONE
)
MATRICES = ("F", "G", "H", "reset", "Phi")


def conventions(
    model: Any,
    *,
    roles: Mapping[str, Sequence[str]] | None = None,
    quantities: Mapping[str, Any] | None = None,
    known: Mapping[str, str] | None = None,
    card: Card | Mapping[str, str] | str | os.PathLike[str] | None = None,
) -> Conventions:
    """All cards of conventions under which the error dynamics of a model are right.

    For each card the error equations are derived from the nonlinear mechanisation, to first order along the true flow,
    and compared with F block by block: by the prover where they agree, at an exact point where they differ.

    model      : path of a conventions file, its document, or a :class:`navsym.Model`. With blocks ``[[code]]``, as in
                 an audit, the matrices are read from source code: ``F = "filter:F"``
    roles      : role (position, velocity, attitude, bias or scale of gyro or accelerometer) -> its three states
    quantities : quantity (specific_force, rotation, latitude, velocity, radii, ...) -> names or expressions
    known      : parts of the card that are certain, such as ``{"frame": "inertial"}``
    card       : a card, its words, or the path of a file with the table [card], as the table of a model's file. Without
                 F the model of the card is derived, and the answer has all cards that are equal to it

    With no card the answer names the fewest blocks that must change. Raises a NavsymError for bad input: roles that are
    no states, unknown quantities, wrong numbers of components, a matrix that is no rotation, code that is not read.

    >>> states = "v1 v2 v3 p1 p2 p3".split()
    >>> F = [["0"] * 6 for _ in range(6)]
    >>> F[0][4], F[0][5], F[1][3], F[1][5], F[2][3], F[2][4] = "f3", "-f2", "-f3", "f1", "f2", "-f1"
    >>> answer = conventions(
    ...     {"model": {"states": states, "F": F}, "parameters": dict.fromkeys(("f1", "f2", "f3"), "real")},
    ...     roles={"velocity": states[:3], "attitude": states[3:]},
    ...     quantities={"specific_force": ["f1", "f2", "f3"]},
    ...     known={"frame": "inertial", "error": "estimate - truth"},
    ... )
    >>> [(card.attitude_error, card.rotation_sign) for card in answer.cards], answer.complete
    ([('frame', '+')], True)
    """
    from navsym.models.model import Model

    extra = {"roles": roles, "quantities": quantities, "known": known, "card": None if card is None else words_of(card)}
    given = {name: plain_lists(value) for name, value in extra.items() if value is not None}
    where, folder = "conventions", Path()
    if isinstance(model, str | os.PathLike):
        where, folder = name_file(model), Path(model).parent
        model = read_toml(model)
    model = model.document() if isinstance(model, Model) else model
    if not isinstance(model, Mapping):
        message = f"expected a model, a document or the path of a file; got {quote(model)}; give one of these"
        raise DomainError(message, where="conventions: model")
    document = {**model, **given}
    code = read_code(document, folder, where) if "code" in document else None
    source = code.document if code else read_entries(document, where)
    written = source if code else write_out(source, where)
    document = source if code else linearise(written, where)
    problem = read_problem(fill_model(document, where) if "card" in document else document, where)
    require_meaning(source, written, where)
    require_known(problem, join_place(where, "known"))
    answer, words = find_conventions(problem), as_table(document.get("card", {}), where).items()
    cards = (*sorted(answer.cards, key=lambda found: sum(getattr(found, name) != word for name, word in words)),)
    answer = replace(answer, cards=cards)  # the card of the file is first: conversions start from it
    return answer if code is None else code.point_out(answer)


def words_of(card: Any) -> Any:
    """A card as the table of a file."""
    if isinstance(card, str | os.PathLike):
        return require_key(read_toml(card), "card", name_file(card))
    return card if isinstance(card, Mapping) or not hasattr(card, "words") else card.words()


def plain_lists(value: Any) -> Any:
    """Tuples as lists, in tables too."""
    if isinstance(value, Mapping):
        return {key: plain_lists(item) for key, item in value.items()}
    return [plain_lists(item) for item in value] if isinstance(value, tuple | list) else value


# Equations of the errors, which entries of the book may say


def read_entries(document: Mapping[str, Any], where: str) -> dict[str, Any]:
    """The document with the right sides of entries of the book, and their symbols, in place of ``book:ID``."""
    model, place = document.get("model"), join_place(join_place(where, "model"), "dynamics")
    items = model.get("dynamics") if isinstance(model, Mapping) else None
    if not isinstance(model, Mapping) or not isinstance(items, list):
        return dict(document)
    rows, symbols = [*items], dict[str, Any]()
    for k, item in enumerate(items):
        if isinstance(item, str) and item.startswith(BOOK):
            from navsym.book.entries import book

            name = item.removeprefix(BOOK)
            if name not in book:
                known = suggest_nearest(name, [*book])
                message = f"expected an entry of the book; got {quote(name)}; correct it: {known}"
                raise UnknownSymbolError(message, where=join_place(place, k))
            entry = book[name].document
            rows[k] = entry["claim"][0]["right"]
            named = {*WORD.findall(rows[k])}
            symbols |= {symbol: value for symbol, value in entry["symbols"].items() if symbol in named}
    states = {*WORD.findall(" ".join(map(str, model.get("states", ()))))}
    declared = as_table(document.get("parameters", {}), join_place(where, "parameters"))
    symbols = {name: value for name, value in symbols.items() if name not in states}
    return {**document, "model": {**model, "dynamics": rows}, "parameters": {**symbols, **declared}}


def linearise(document: Mapping[str, Any], where: str) -> dict[str, Any]:
    """F of a model that has equations of its errors: their derivatives where the errors are zero."""
    model, place = document.get("model"), join_place(join_place(where, "model"), "dynamics")
    if not isinstance(model, Mapping) or "dynamics" not in model:
        return dict(document)
    if "F" in model:
        raise DuplicateError("expected F or dynamics; got both; remove one of them", where=place)
    names = as_list(model.get("states", []), join_place(join_place(where, "model"), "states"), "a list of names")
    states = [build_symbol(name) for name in names]
    known = {*names, *as_table(document.get("parameters", {}), join_place(where, "parameters"))}
    F = []
    for k, item in enumerate(as_list(model["dynamics"], place, "a list of expressions")):
        tree = read_cell(item, dict.fromkeys(known), join_place(place, k))
        if reduce(put_zero, states, tree) is not ZERO:
            message = (
                f"expected no rate where the errors are zero; got {print_tree(tree)}; write equations of the errors"
            )
            raise DomainError(message, where=join_place(place, k))
        F.append([print_tree(reduce(put_zero, states, differentiate(tree, state))) for state in states])
    return {**document, "model": {key: value for key, value in model.items() if key != "dynamics"} | {"F": F}}


# Matrices of source code


@dataclass(frozen=True, slots=True, eq=False)
class CodedModel:
    """A document whose matrices were read from source code.

    places : matrix and entry from 1 -> file and line of its assignment
    """

    document: dict[str, Any]
    names: Names
    places: Mapping[tuple[str, int, int], str]

    def point_out(self, answer: Conventions) -> Conventions:
        """The answer with the changes in the spelling of the code, and the lines that they concern."""

        def respell(conflict: Conflict) -> Conflict:
            places = (self.places.get((conflict.matrix, i, j)) for i, j in conflict.entries)
            found = tuple(dict.fromkeys(place for place in places if place))
            return replace(conflict, change=self.names.show(conflict.change), places=found)

        return replace(answer, conflicts=tuple(map(respell, answer.conflicts)))


def read_code(document: Mapping[str, Any], folder: Path, where: str) -> CodedModel:
    """The matrices and quantities of a document from the code that they name; nothing of it is executed."""
    place = join_place(where, "model")
    model = dict(as_table(require_key(dict(document), "model", where), place))
    if {"F", "Phi"} <= set(model):
        raise DuplicateError("expected F or Phi; got both; remove one of them", where=place)
    names, sources = read_sources(document, folder, where)
    for name, declaration in as_table(document.get("parameters", {}), join_place(where, "parameters")).items():
        names.declare(name, declaration, join_place(join_place(where, "parameters"), name))
    places: dict[tuple[str, int, int], str] = {}

    def read(key: str, reference: Any, spot: str, rows: bool) -> Any:
        value = settle_cases(Question(key, "equal", {"of": reference}, spot, sources, names, folder))
        cells = list_rows(value, spot)
        for i, row in enumerate(cells if rows else ()):
            for j, cell in enumerate(row):
                if cell.line and isinstance(reference, str):
                    unit = sources[reference.partition(":")[0]].unit
                    file, line = unit.locate(cell.line)
                    places[key, i + 1, j + 1] = f"{file}:{line}"
        return [[cell.tree for cell in row] for row in cells]

    for key in MATRICES:
        if key in model:
            spot = join_place(place, key)
            trees = read(key, model[key], spot, True)
            if key == "Phi":
                symbol = read("step", require_key(model, "step", place), join_place(place, "step"), False)[0][0]
                trees = [[slope_of(x, symbol, i == j, spot) for j, x in enumerate(r)] for i, r in enumerate(trees)]
                places |= {("F", i, j): spot for (name, i, j), spot in places.items() if name == "Phi"}
            model["F" if key == "Phi" else key] = [[print_tree(tree) for tree in row] for row in trees]
    given, spot = as_table(document.get("quantities", {}), join_place(where, "quantities")), "quantities"
    quantities = {
        name: read(name, value, join_place(join_place(where, spot), name), False) for name, value in given.items()
    }
    texts = {
        name: [[print_tree(x) for x in row] for row in rows]
        if name == "rotation"
        else [print_tree(x) for r in rows for x in r]
        for name, rows in quantities.items()
    }
    whole = {name: value for name, value in document.items() if name != "code"}
    model = {key: value for key, value in model.items() if key not in ("Phi", "step")}
    declared = dict(names.declarations)
    return CodedModel({**whole, "model": model, "quantities": texts, "parameters": declared}, names, places)


def settle_cases(question: Question) -> Value:
    """What a reference means; raises DomainError where that depends on a case of the code."""
    values = [(asking, asking.resolve(question.keys["of"], "of")) for asking in list_askings(question)]
    texts = {
        repr([getattr(cell, "tree", cell) for row in list_rows(v, question.where) for cell in row]) for _, v in values
    }
    if len(texts) > 1:
        words = " and ".join(c.text for c in values[0][0].conditions)
        message = f"expected one value; got several, by whether {words}; fix a constant, or give the lines of one case"
        raise DomainError(message, where=question.where)
    return values[0][1]


def list_rows(value: Value, where: str) -> list[list[Any]]:
    """A value row by row, as one column where it is a vector; raises DomainError for what is not read."""
    for cell in value.cells:
        if isinstance(cell, Unread):
            message = f"expected a formula; got a value that is not read: {cell.why} (line {cell.line}); "
            raise DomainError(f"{message}write it within the language of audit", where=where)
    width = value.shape[1] if len(value.shape) == 2 else 1
    return [list(value.cells[k : k + width]) for k in range(0, len(value.cells), width)]


def slope_of(tree: Tree, step: Tree, diagonal: bool, where: str) -> Tree:
    """An entry of F from that of Phi(step): its derivative where the step is zero; Phi is the unit matrix there."""
    if step.head != SYMBOL:
        raise DomainError(f"expected an input as step; got {print_tree(step)}; name one of the code", where=where)
    if put_zero(tree, step) is not (ONE if diagonal else ZERO):
        message = "expected a transition that is the unit matrix for a step of zero; got another one; give F instead"
        raise DomainError(message, where=where)
    return put_zero(differentiate(tree, step), step)


def put_zero(tree: Tree, symbol: Tree) -> Tree:
    """A formula where a symbol is zero."""

    def step(part: Tree, inner: list[Tree]) -> Tree:
        if part is symbol:
            return ZERO
        if part.head in (SUM, PRODUCT):
            return total(*inner) if part.head == SUM else reduce(multiply, inner)
        if part.head == POWER:
            positive = inner[1].head == NUMBER and inner[1].args[0] > 0
            if inner[0] is ZERO and not positive:
                message = (
                    f"expected a value where the errors or the step are zero; got {print_tree(part)}; write it without"
                )
                raise DomainError(message, where="conventions: model")
            return ZERO if inner[0] is ZERO else raise_to(*inner)
        if inner[:1] == [ZERO] and part.head in AT_ZERO:
            return AT_ZERO[part.head]
        return build(part.head, tuple(inner)) if inner else part

    return fold_tree(tree, step)
