"""Symbols declared by tables: vectors, matrices, rotations, quaternions, functions of time, integers, ranges.

A vector or matrix has one symbol for each entry: ``v`` has ``v_1, v_2, v_3``, shown as ``v[1]``. A symmetric matrix has
one symbol in two places. A rotation and a unit quaternion have relations, which every claim about them may use.
A matrix of any size, ``["m", "n"]``, has names of dimensions and no symbols of entries.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

from navsym.core.errors import DomainError, ExpressionSyntaxError, ShapeError, TooLargeError
from navsym.core.units import drop_unit, read_unit
from navsym.language.declarations import SIGNS, read_range
from navsym.language.expression import Expr
from navsym.language.names import NAME, RESERVED, check_name, expect_keys, quote
from navsym.language.printer import to_text
from navsym.language.schema import SIDE, as_list, as_table, as_text, describe_value, join_place, read_entry, require_key

#: What a table may say.
KINDS = ("vector", "matrix", "rotation", "quaternion", "integer")
#: What a square matrix may be; positive is positive definite, nonnegative is positive semidefinite.
PROPERTIES = ("symmetric", "positive", "nonnegative", "invertible", "orthogonal", "skew", "diagonal")
NOTES = ("unit", "frame")
KEYS = (*KINDS, *PROPERTIES, "function", "random", "range", "sign", *NOTES)
MOST_RANDOM = 4  # entries of a random vector
ORDERS = 3  # derivatives of a function of time that have symbols of their own
INFINITY = {"oo", "-oo"}
RANGES: dict[str, list[Any]] = {
    "real": [None, None, []],
    "positive": ["0", None, ["open-low"]],
    "nonnegative": ["0", None, []],
    "nonzero": [None, None, ["nonzero"]],
}


@dataclass(frozen=True, slots=True)
class Shape:
    """A declared name.

    rows      : the symbols of the entries, row by row; a scalar has one of its own name
    kind      : scalar, vector, matrix, rotation or quaternion
    ranges    : symbol -> range in the words of the checker
    relations : what holds of it, as text
    rates     : name -> derivative by time as text, None where none is known
    label     : how a derivative is written, ``dot_(x)``; empty for what is declared
    sizes     : rows and columns of a matrix of any size, numbers or names of dimensions, which has no rows
    properties : what a matrix is, words of :data:`PROPERTIES`
    random    : mean and covariance as text, and whether it is normal; such a name has no ranges
    unit, frame : as they are declared; the frame of a rotation is ``b to n``
    """

    name: str
    rows: tuple[tuple[str, ...], ...]
    kind: str
    ranges: Mapping[str, list[Any]]
    relations: tuple[str, ...] = ()
    rates: Mapping[str, str | None] | None = None
    label: str = ""
    sizes: tuple[int | str, int | str] | None = None
    properties: tuple[str, ...] = ()
    random: Mapping[str, Any] | None = None
    unit: str = ""
    frame: str = ""

    @property
    def size(self) -> tuple[int | str, int | str] | None:
        """Rows and columns; None for a scalar."""
        if self.sizes:
            return self.sizes
        return None if self.kind == "scalar" else (len(self.rows), len(self.rows[0]))

    def shown(self) -> dict[str, str]:
        """Symbol -> how the entry is written: ``v[1]``, ``A[1,2]``; the first place of a symbol that stands in two."""
        name = self.label or self.name
        if self.kind == "scalar":
            return {self.name: name} if self.label else {}
        places = {}
        for i, row in reversed([*enumerate(self.rows, 1)]):
            for j, entry in reversed([*enumerate(row, 1)]):
                places[entry] = f"{name}[{i}]" if len(row) == 1 else f"{name}[{i},{j}]"
        return places


def read_shape(name: str, value: Any, taken: Collection[str], where: str) -> list[Shape]:
    """The declared name, and behind it the derivatives of a function of time.

    value : a table, or what ``[symbols]`` has for scalars
    taken : names that the entries may not have
    """
    check_name(name, where=where)
    if isinstance(value, list):
        value = {"range": value}
    if isinstance(value, str):
        value = {"sign": value}
    if not isinstance(value, Mapping):
        got, remedy = describe_value(value), "write { vector = 3 }, for example"
        raise ShapeError(f"expected a word, a range or a table; got {got}; {remedy}", where=where)
    expect_keys(value, KEYS, where)
    kinds = [kind for kind in KINDS if kind in value]
    if len(kinds) > 1:
        message = f"expected one of {', '.join(KINDS)}; got {' and '.join(kinds)}; keep one of them"
        raise ShapeError(message, where=where)
    kind = kinds[0] if kinds else "scalar"
    properties = read_properties(kind, value, where)
    size = read_size(kind, value, where)
    unit, frame = read_notes(kind, value, where)
    if size is not None and properties and size[0] != size[1]:
        got = f"{size[0]} x {size[1]}"
        raise ShapeError(f"expected a square matrix to be {properties[0]}; got {got}; correct it", where=where)
    if size is not None and not all(isinstance(side, int) for side in size):
        if "function" in value or "range" in value or "sign" in value:
            message = f"expected a constant matrix of any size; got {', '.join(value)}; give the dimensions as numbers"
            raise ShapeError(message, where=where)
        return [Shape(name, (), kind, {}, sizes=size, properties=properties, unit=unit, frame=frame)]
    even = bool({"symmetric", "positive", "nonnegative"} & {*properties})
    rows = name_entries(name, size, even, taken)
    if "random" in value:
        random = read_random(value, len(rows), kind, where)
        return [Shape(name, rows, kind, {}, random=random, unit=unit, frame=frame)]
    limits = read_limits(kind, value, unit, where)
    relations = (*relations_of(kind, value, name, where), *relations_of_properties(name, len(rows), properties))
    kind, ranges = "scalar" if kind == "integer" else kind, limit_entries(rows, limits)
    shape = Shape(name, rows, kind, ranges, relations, properties=properties, unit=unit, frame=frame)
    if "function" not in value:
        return [shape]
    if value["function"] != "t":
        message = f'expected function = "t", the time; got {describe_value(value["function"])}; correct it'
        raise DomainError(message, where=join_place(where, "function"))
    return list_derivatives(shape, taken)


def read_notes(kind: str, value: Mapping[str, Any], where: str) -> tuple[str, str]:
    """Unit and frame; the frames of a rotation are two words, ``b to n``, or a text that says nothing about frames."""
    notes = {note: as_text(value[note], join_place(where, note), f"a {note}") for note in NOTES if note in value}
    if "unit" in notes:
        read_unit(notes["unit"], join_place(where, "unit"))
    if kind == "rotation":
        notes.setdefault("frame", value["rotation"])
    return notes.get("unit", ""), notes.get("frame", "")


def read_random(value: Mapping[str, Any], n: int, kind: str, where: str) -> dict[str, Any]:
    """Mean and covariance of a random number or vector, and whether it is normal."""
    if set(value) - {"random", "vector", "unit", "frame"} or n > MOST_RANDOM:
        got = f"a {kind} of {n} entries" if n > MOST_RANDOM else ", ".join(value)
        message = f"expected a random number, or a random vector of at most {MOST_RANDOM}; got {got}"
        raise ShapeError(f"{message}; declare it so", where=where)
    place = join_place(where, "random")
    table = as_table(value["random"], place)
    expect_keys(table, ("mean", "cov", "law"), place)
    law = table.get("law", "any")
    if law not in ("any", "normal"):
        message = f'expected law = "normal", or none; got {describe_value(law)}; correct it'
        raise DomainError(message, where=join_place(place, "law"))
    nothing = "0" if kind == "scalar" else f"zeros({n}, 1)"
    mean = str(table.get("mean", "0"))
    covariance = str(require_key(table, "cov", place))
    return {"mean": nothing if mean == "0" else mean, "cov": covariance, "normal": law == "normal"}


def read_properties(kind: str, value: Mapping[str, Any], where: str) -> tuple[str, ...]:
    """The properties that a table gives a matrix."""
    words = tuple(word for word in PROPERTIES if word in value)
    for word in words:
        place = join_place(where, word)
        if not isinstance(value[word], bool):
            raise ShapeError(f"expected true or false; got {describe_value(value[word])}; correct it", where=place)
        if kind != "matrix":
            raise ShapeError(f"expected {word} beside a matrix; got none; remove it", where=place)
    return tuple(word for word in words if value[word])


def read_size(kind: str, value: Mapping[str, Any], where: str) -> tuple[int | str, int | str] | None:
    """Rows and columns of what a table declares; None for a scalar."""
    if kind == "rotation":
        as_text(value["rotation"], join_place(where, "rotation"), 'two frames, such as "b to n",')
        return 3, 3
    if kind == "quaternion":
        if value["quaternion"] not in ("unit", "any"):
            message = f'expected "unit" or "any"; got {describe_value(value["quaternion"])}; correct it'
            raise DomainError(message, where=join_place(where, "quaternion"))
        return 4, 1
    if kind not in ("vector", "matrix"):
        return None
    place = join_place(where, kind)
    sizes = [value["vector"]] if kind == "vector" else list(as_list(value["matrix"], place, "two numbers"))
    if len(sizes) != (1 if kind == "vector" else 2):
        raise ShapeError(f"expected rows and columns; got {len(sizes)} numbers; write [2, 3]", where=place)
    for size in sizes:
        if isinstance(size, str) and NAME.fullmatch(size) and size not in RESERVED:
            continue
        if not isinstance(size, int) or isinstance(size, bool) or size < 1:
            message = f"expected a whole number from 1 on, or the name of one; got {describe_value(size)}"
            raise ShapeError(f"{message}; give the dimension so", where=place)
        if size > SIDE:
            raise TooLargeError(f"expected at most {SIDE} rows; got {size}; split it", where=place)
    return (sizes[0], 1) if kind == "vector" else (sizes[0], sizes[1])


def name_entries(name: str, size: Any, symmetric: bool, taken: Collection[str]) -> tuple[tuple[str, ...], ...]:
    """Names of the entries that nobody has declared: ``v_1``, or ``v__1`` where ``v_1`` is taken."""
    if size is None:
        return ((name,),)
    mark = "_"
    while True:
        places = [[(i, j) for j in range(1, size[1] + 1)] for i in range(1, size[0] + 1)]
        places = [[(min(p), max(p)) if symmetric else p for p in row] for row in places]
        ends = [[f"{i}" if size[1] == 1 else f"{i}_{j}" for i, j in row] for row in places]
        rows = tuple(tuple(f"{name}{mark}{end}" for end in row) for row in ends)
        if not {entry for row in rows for entry in row} & {*taken}:
            return rows
        mark += "_"


def read_limits(kind: str, value: Mapping[str, Any], unit: str, where: str) -> list[Any]:
    """The range of every entry in the words of the checker."""
    place = join_place(where, "range")
    if kind == "integer":
        ends = list(as_list(value["integer"], join_place(where, "integer"), "two whole numbers"))
        if len(ends) != 2:
            message = f'expected two ends; got {len(ends)}; write ["1", "oo"]'
            raise ShapeError(message, where=join_place(where, "integer"))
        low, high = (read_end(end, join_place(where, "integer")) for end in ends)
        return [low, high, ["integer"]]
    if "range" in value and kind == "scalar":
        if INFINITY & {str(end) for end in as_list(value["range"], place)}:
            return read_long_range(value["range"], place, unit)
        low, high = read_range(value["range"], place, unit)
        return [to_text(low), to_text(high), []]
    if "range" in value:
        raise DomainError(f"expected a range of a number; got one of a {kind}; state it by given", where=place)
    word = value.get("sign", "real")
    if word not in SIGNS or (word != "real" and kind != "scalar"):
        message = f"expected one of {', '.join(SIGNS)}; got {quote(word)}; correct it"
        raise ExpressionSyntaxError(message, where=where)
    return RANGES[word]


def read_long_range(value: Any, where: str, unit: str) -> list[Any]:
    """A range with oo as an end."""
    ends = as_list(value, where, "a range of two ends")
    if len(ends) != 2 or ends[0] == "oo" or ends[1] == "-oo":
        raise ShapeError(f'expected a range such as ["0", "oo"]; got {describe_value(value)}; correct it', where=where)
    texts = [None if end in INFINITY else to_text(read_entry(drop_unit(end, where, unit), {}, where)) for end in ends]
    return [*texts, []]


def read_end(value: Any, where: str) -> str | None:
    """An end of a range of integers; None for ``oo`` and ``-oo``."""
    if value in ("oo", "-oo"):
        return None
    end: Expr = read_entry(value, {}, where)
    if not end.is_Integer:
        raise DomainError(f'expected a whole number or "oo"; got {quote(value)}; correct it', where=where)
    return to_text(end)


def limit_entries(rows: tuple[tuple[str, ...], ...], limits: list[Any]) -> dict[str, list[Any]]:
    return {entry: limits for row in rows for entry in row}


def relations_of(kind: str, value: Mapping[str, Any], name: str, where: str) -> tuple[str, ...]:
    """What holds of a rotation, C'C = CC' = E, det C = 1 and each column the product of the others; or of a unit."""
    if kind == "quaternion" and value["quaternion"] == "unit":
        return (f"dot({name}, {name}) = 1",)
    if kind != "rotation":
        return ()
    columns = [f"[{', '.join(f'{name}[{i},{j}]' for i in (1, 2, 3))}]" for j in (1, 2, 3)]
    products = [f"cross({columns[a]}, {columns[b]}) = {columns[c]}" for a, b, c in ((0, 1, 2), (1, 2, 0), (2, 0, 1))]
    return (f"{name}.T @ {name} = eye(3)", f"{name} @ {name}.T = eye(3)", f"det({name}) = 1", *products)


def relations_of_properties(name: str, n: int, properties: tuple[str, ...]) -> tuple[str, ...]:
    """What a matrix of fixed size is, as hypotheses; Sylvester: leading minors are > 0, principal minors are >= 0."""

    def minor(places: Iterable[int]) -> str:
        chosen = list(places)
        rows = [f"[{', '.join(f'{name}[{i},{j}]' for j in chosen)}]" for i in chosen]
        return f"det([{', '.join(rows)}])" if len(chosen) > 1 else f"{name}[{chosen[0]},{chosen[0]}]"

    every = [c for k in range(1, n + 1) for c in combinations(range(1, n + 1), k)] if n < 6 else []
    stated: dict[str, Callable[[], list[str]]] = {
        "symmetric": list,
        "positive": lambda: [f"{minor(range(1, k + 1))} > 0" for k in range(1, n + 1)],
        "nonnegative": lambda: [f"{minor(c)} >= 0" for c in every],
        "invertible": lambda: [f"{minor(range(1, n + 1))} != 0"],
        "orthogonal": lambda: [f"{name}.T @ {name} = eye({n})", f"{name} @ {name}.T = eye({n})"],
        "skew": lambda: [f"{name}.T = -{name}"],
        "diagonal": lambda: [f"{name}[{i},{j}] = 0" for i in range(1, n + 1) for j in range(1, n + 1) if i != j],
    }
    return tuple(text for word in properties for text in stated[word]())


def list_derivatives(shape: Shape, taken: Collection[str]) -> list[Shape]:
    """A function of time and its derivatives, each the rate of the one before; of the last no rate is known."""
    found, names = [], [shape.name]
    for order in range(1, ORDERS + 1):
        name = f"{shape.name}_dot{order}"
        while name in taken:
            name += "_"
        names.append(name)
    for order, name in enumerate(names):
        rate = names[order + 1] if order < ORDERS else None
        if order == 0:
            found.append(replace(shape, rates={name: rate}))
            continue
        rows = name_entries(name, shape.size, False, taken)
        kind = "vector" if shape.kind == "quaternion" else "matrix" if shape.kind == "rotation" else shape.kind
        label = "dot_(" * order + shape.name + ")" * order
        found.append(Shape(name, rows, kind, limit_entries(rows, RANGES["real"]), (), {name: rate}, label))
    return found
