"""Units and frames of a model: every entry of F, h, dynamics and z is a formula that the declared ones must allow.

``dx_i/dt = F_ij x_j`` says what the unit of an entry is, ``z = h_j x_j`` what that of a measurement. Entries are looked
at as they are written, before values stand in place of parameters: a value has lost the unit of its name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from navsym.core.errors import DuplicateError, UnknownSymbolError
from navsym.language.dimensions import infer_units
from navsym.language.frames import infer_frames
from navsym.language.names import join_place, quote, suggest_nearest
from navsym.language.schema import Table, as_table, expect_keys
from navsym.language.shapes import NOTES, Shape, read_shape
from navsym.language.tree import (
    MINUS_ONE,
    ONE,
    PRODUCT,
    SYMBOL,
    Tree,
    build,
    build_inverse,
    build_product,
    build_symbol,
    list_names,
)
from navsym.language.vectors import read_value
from navsym.models.blocks import STATE

#: In [units]: nothing is looked at, as numbers stand in place of quantities.
UNCHECKED = {"*": "any"}
TIME = "t"
Sides = Sequence[tuple[str, str]]


def read_units(document: Table, names: Sequence[str], where: str) -> dict[str, Shape]:
    """The [units] of states, measurements, inputs and the time: a unit, or a table of unit and frame."""
    place, found = join_place(where, "units"), {}
    table = as_table(document.get("units", {}), place)
    if table == UNCHECKED:
        return {}
    sizes = {name: size for name, size in map(split_state, names)}
    for name, value in table.items():
        here = join_place(place, name)
        if name in document.get("parameters", {}):
            message = f"expected a state or a measurement; got the parameter {quote(name)}"
            raise DuplicateError(f"{message}; write its unit under [parameters]", where=here)
        if name not in sizes:
            message = f"expected a state, a measurement, an input or t; got {quote(name)}; correct it: "
            raise UnknownSymbolError(message + suggest_nearest(name, sizes), where=here)
        said = dict(value) if isinstance(value, Mapping) else {"unit": value}
        expect_keys(said, NOTES, here)
        size = {"vector": sizes[name]} if sizes[name] else {}
        found[name] = read_shape("x", size | said, (), here)[0]
    return found


def split_state(text: str) -> tuple[str, int]:
    """Name and size of a state; 0 for a number."""
    found = STATE.fullmatch(text)
    return (found[1], int(found[2])) if found else (text, 0)


def require_meaning(document: Table, written: Table, where: str) -> None:
    """Refuse entries whose units or frames contradict each other, as far as there are declared ones.

    document : of a model file that has been read
    written  : the same with a number in place of each entry of a vector
    """
    parameters = document.get("parameters", {})
    noted = any(isinstance(value, Mapping) and {"unit", "frame"} & value.keys() for value in parameters.values())
    states = document.get("model", {}).get("states")  # which a card may leave out
    if states and (noted or document.get("units")) and document.get("units") != UNCHECKED:
        meaning = Meaning(document, written, where)
        places, trees = zip(*meaning.list_formulas(), strict=True)
        infer_units(trees, meaning.shapes, where=places, loose=True)
        infer_frames(trees, meaning.shapes, where=places)


def is_one(tree: Tree) -> bool:
    """Whether a number is 1 or -1, or a matrix of a unit matrix, which have no unit; another may be a quantity."""
    if tree.head == PRODUCT:
        return all(map(is_one, tree.args))
    return tree in (ONE, MINUS_ONE) or tree.head == "eye"


class Meaning:
    """The formulas of a model as equations; ``shapes`` are the declarations of all names in them."""

    def __init__(self, document: Table, written: Table, where: str):
        self.document, self.written, self.where = document, written, where
        model = document["model"]
        self.states = [split_state(text) for text in model["states"]]
        self.entries = [(name, 0) for name in written["model"]["states"]]
        blocks, inputs = document.get("measurement", ()), document.get("inputs", {})
        names = [block.get("name", f"z{k}") for k, block in enumerate(blocks, 1)]
        known = [TIME, *model["states"], *inputs]
        self.units = read_units(document, [*known, *(name for name in names if name not in known)], where)
        declared = document.get("parameters", {})
        self.shapes = {name: read_shape(name, value, (), "")[0] for name, value in declared.items()}
        for name, size in (*self.states, *((name, 0) for name in (*inputs, TIME))):
            self.declare(name, size, name)
        T = document.get("interval", {}).get("T")
        clock = self.shapes[T].unit if T in declared else ""
        if not self.shapes[TIME].unit:
            self.shapes[TIME] = read_shape(TIME, {"unit": clock or "s"} if clock or self.units else {}, (), "")[0]
        arrays = [shape for shape in self.shapes.values() if shape.size]
        for shape in arrays:
            for entry in {entry for row in shape.rows for entry in row}:
                self.shapes.setdefault(entry, Shape(entry, ((entry,),), "scalar", {}, unit=shape.unit))
        self.sizes = {name: shape.size for name, shape in self.shapes.items()}

    def declare(self, name: str, size: int, source: str = "") -> Tree:
        """A symbol of a state, or of what has no name of its own, with what [units] says of it."""
        rows = tuple((f"{name}_{k}",) for k in range(1, size + 1)) or ((name,),)
        said = self.units.get(source)
        unit, frame = (said.unit, said.frame) if said else ("", "")
        self.shapes[name] = Shape(name, rows, "vector" if size else "scalar", {}, unit=unit, frame=frame)
        return build(SYMBOL, (name,))

    # Equations

    def list_formulas(self) -> Iterator[tuple[str, Tree]]:
        """All equations, each with its place."""
        document, model = self.document, self.document["model"]
        place = join_place(self.where, "model")
        for key in ("F", "Phi", "reset"):
            if key in model:
                yield from self.list_matrix(model[key], self.written["model"][key], key == "F", join_place(place, key))
        for k, piece in enumerate(document.get("piece", ())):
            here = join_place(join_place(self.where, "piece"), k)
            yield from self.list_matrix(piece["F"], self.written["piece"][k]["F"], True, join_place(here, "F"))
            yield from (e for key in ("from", "to") for e in self.compare(piece[key], TIME, join_place(here, key)))
        yield from self.list_noises(join_place(place, "G"))
        for i, row in enumerate(self.written["model"].get("H", ())):
            yield from self.list_row(row, self.entries, f"row {i + 1} of H", join_place(join_place(place, "H"), i))
        for key, table in (("dynamics", model), ("rates", document)):
            yield from self.list_rates(table.get(key, ()), join_place(place if key == "dynamics" else self.where, key))
        for i, text in enumerate(model.get("relations", ())):
            here = join_place(join_place(place, "relations"), i)
            yield here, build("=", tuple(self.read(side, here) for side in text.split("=")))
        yield from self.list_measurements(join_place(self.where, "measurement"))
        for key in ("inputs", "targets"):
            yield from getattr(self, f"list_{key}")(document.get(key, {}), join_place(self.where, key))
        T = document.get("interval", {}).get("T", "0")
        yield from self.compare(T, TIME, join_place(join_place(self.where, "interval"), "T"))

    def read(self, text: Any, here: str) -> Tree:
        return read_value(str(text), self.sizes, where=here).tree

    def compare(self, text: Any, name: str, here: str) -> Iterator[tuple[str, Tree]]:
        """A formula that is in the unit of a name."""
        if list_names(tree := self.read(text, here)):
            yield here, build("=", (tree, build(SYMBOL, (name,))))

    def times(self, text: Any, name: str, here: str) -> Tree | None:
        """An entry times what it stands before; None for zeros, and for numbers that may be quantities."""
        value, x = read_value(str(text), self.sizes, where=here), build(SYMBOL, (name,))
        if not list_names(value.tree) and not is_one(value.tree):
            return None
        if value.tree is ONE:
            return x
        size = self.shapes[name].size
        return build("@", (value.tree, x)) if value.size and size else build_product(value.tree, x)

    def rate(self, name: str) -> Tree:
        """The derivative of a name by the time, as far as units and frames go."""
        return build_product(build(SYMBOL, (name,)), build_inverse(build_symbol(TIME)))

    def list_matrix(self, value: Any, written: Any, is_rate: bool, here: str) -> Iterator[tuple[str, Tree]]:
        """F, or Phi: by blocks where it is written so, else by entries."""
        rows, sides = value, self.states
        if isinstance(value, str) and len(sides) == 1:
            rows = [[value]]
        elif not isinstance(value, list) or len(value) != len(sides) or any(isinstance(row, str) for row in value):
            rows, sides = written, self.entries
        for i, (row, (name, _)) in enumerate(zip(rows, sides, strict=True)):
            result = self.rate(name) if is_rate else build(SYMBOL, (name,))
            for j, (cell, (by, _)) in enumerate(zip(row, sides, strict=True)):
                place = join_place(join_place(here, i), j)
                if (product := self.times(cell, by, place)) is not None:
                    yield place, build("=", (product, result))

    def list_row(
        self, row: Sequence[Any], sides: Any, name: str, here: str, size: int = 0
    ) -> Iterator[tuple[str, Tree]]:
        """The terms of a row, which are all in the unit of what it gives."""
        result = self.declare(name, size, name.removeprefix("z of "))
        for j, (cell, (by, _)) in enumerate(zip(row, sides, strict=True)):
            if (product := self.times(cell, by, join_place(here, j))) is not None:
                yield join_place(here, j), build("=", (product, result))

    def list_noises(self, here: str) -> Iterator[tuple[str, Tree]]:
        """G: a column belongs to one noise."""
        rows = self.written["model"].get("G", ())
        names = [f"noise {k + 1}" for k in range(len(rows[0]) if rows else 0)]
        for name in names:
            self.declare(name, 0)
        for i, (row, (state, _)) in enumerate(zip(rows, self.entries, strict=False)):
            for j, (cell, name) in enumerate(zip(row, names, strict=True)):
                place = join_place(join_place(here, i), j)
                if (product := self.times(cell, name, place)) is not None:
                    yield place, build("=", (product, self.rate(state)))

    def list_rates(self, table: Any, here: str) -> Iterator[tuple[str, Tree]]:
        """Dynamics of the states, or rates of parameters."""
        if isinstance(table, list | tuple):
            sides = self.states if len(table) == len(self.states) else self.entries
            table = dict(zip((name for name, _ in sides), table, strict=len(table) == len(sides)))
            here_of = {name: join_place(here, i) for i, name in enumerate(table)}
        else:
            here_of = {name: join_place(here, name) for name in table}
        for name, text in table.items():
            if str(text).strip() != "0":
                yield here_of[name], build("=", (self.read(text, here_of[name]), self.rate(name)))

    def list_measurements(self, here: str) -> Iterator[tuple[str, Tree]]:
        """Rows h and formulas z, and the bounds of their errors."""
        for k, block in enumerate(self.document.get("measurement", ())):
            place = join_place(here, k)
            name = f"z of {block.get('name', f'z{k + 1}')}"
            key = "h" if "h" in block else "z"
            row, there = block[key], join_place(place, key)
            if key == "z":
                value = read_value(str(row), self.sizes, where=there)
                z = self.declare(name, value.size[0] if value.size else 0, name.removeprefix("z of "))
                yield there, build("=", (value.tree, z))
            elif isinstance(row, list) and len(row) == len(self.states):
                sizes = [read_value(str(cell), self.sizes, where=there).size for cell in row]
                height = max((size[0] for size in sizes if size), default=1)
                size = height if any(s for (_, s) in self.states) and any(sizes) and height > 1 else 0
                yield from self.list_row(row, self.states, name, there, size)
            elif isinstance(row, list):
                yield from self.list_row(row, self.entries, name, there)
            else:
                continue
            shape = self.shapes[name]
            z = build(SYMBOL, (name,))
            if list_names(sigma := self.read(block.get("sigma", "1"), join_place(place, "sigma"))):
                yield join_place(place, "sigma"), build("=", (sigma, build("norm", (z,)) if shape.size else z))

    def list_inputs(self, table: Table, here: str) -> Iterator[tuple[str, Tree]]:
        """Columns of unknown inputs."""
        for name, column in table.items():
            sides = self.states if len(column) == len(self.states) else self.entries
            for i, (cell, (state, _)) in enumerate(zip(column, sides, strict=False) if column != "unknown" else ()):
                place = join_place(join_place(here, name), i)
                if (product := self.times(cell, name, place)) is not None:
                    yield place, build("=", (product, self.rate(state)))

    def list_targets(self, table: Table, here: str) -> Iterator[tuple[str, Tree]]:
        """Functionals of the states."""
        for name, row in table.items():
            sides = self.states if len(row) == len(self.states) else self.entries
            if isinstance(row, list):
                yield from self.list_row(row, sides, f"target {name}", join_place(here, name))
