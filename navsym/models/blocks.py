"""Vectors and matrices in model files: the document with one number in the place of each entry.

A state ``v[3]`` stands for ``v_1, v_2, v_3``, a parameter declared as a vector or matrix for its entries. F, h,
dynamics and targets then have one entry for each state of the list, which is a block of the state's size.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from math import prod
from typing import Any

from navsym.core.errors import DomainError, DuplicateError, ShapeError
from navsym.language.expression import read_tree
from navsym.language.names import join_place, quote
from navsym.language.printer import print_tree
from navsym.language.schema import SIDE, Table, as_list, as_table, as_text
from navsym.language.shapes import RANGES, Shape, name_entries, read_shape
from navsym.language.tree import (
    NUMBER,
    PRODUCT,
    SUM,
    SYMBOL,
    ZERO,
    Tree,
    build,
    build_number,
    build_product,
    build_sum,
    fold_tree,
    list_parts,
)
from navsym.language.vectors import describe_size, is_wide, list_free_names, read_value

#: Parts that have a value wherever their own parts have one.
PLAIN = {NUMBER, SYMBOL, SUM, PRODUCT}
STATE = re.compile(r"([A-Za-z]\w*)\[(\d{1,3})\]", re.ASCII)
Rows = list[list[str]]


def write_out(document: Table, where: str) -> Table:
    """The document without vectors and matrices; the same where it has none."""
    model = document.get("model", {} if "card" in document else None)
    if not isinstance(model, Mapping) or not has_arrays(document):
        return document
    return Writer(document, where).write(document, model)


def list_roles(document: Table) -> Iterator[Any]:
    """The states that the roles of a card name, in their order."""
    roles = document.get("roles") if "card" in document else None
    for names in roles.values() if isinstance(roles, Mapping) else ():
        yield from names if isinstance(names, list) else [names]


def has_arrays(value: Any) -> bool:
    """Whether a table declares an array, or some text in it needs one."""
    if isinstance(value, Mapping):
        return any(has_arrays(item) or (key == "parameters" and has_table(item)) for key, item in value.items())
    if isinstance(value, list):
        return any(map(has_arrays, value))
    return isinstance(value, str) and is_wide(value)


def has_table(parameters: Any) -> bool:
    return isinstance(parameters, Mapping) and any(isinstance(value, Mapping) for value in parameters.values())


def tidy(text: str) -> str:
    """An entry of a product of matrices without its zeros, its ones and nested signs."""

    def step(part: Tree, inner: list[Tree]) -> Tree:
        if part.head == PRODUCT:
            factors = [x for factor in inner for x in (factor.args if factor.head == PRODUCT else (factor,))]
            if ZERO in factors and all({x.head for x in list_parts(y)} <= PLAIN for y in factors):
                return ZERO
            number = prod((x.args[0] for x in factors if x.head == NUMBER), start=Fraction(1))
            others = [x for x in factors if x.head != NUMBER]
            return build_product(*([build_number(number)] if number != 1 or not others else []), *others)
        if part.head == SUM:
            return build_sum(*(x for term in inner for x in (term.args if term.head == SUM else (term,)) if x != ZERO))
        return build(part.head, tuple(inner)) if inner else part

    return print_tree(fold_tree(read_tree(text, None), step))


class Writer:
    """Writes the tables of a model out; ``arrays`` are the declared vectors and matrices by name."""

    def __init__(self, document: Table, where: str) -> None:
        self.where = where
        self.measured_names: dict[Any, list[str]] = {}
        quantities = document.get("quantities")
        texts = [quantities.get(key) for key in ("rotation", "quaternion")] if isinstance(quantities, Mapping) else []
        self.bound = {*re.findall(r"[A-Za-z]\w*", str(texts))}
        self.arrays: dict[str, tuple[tuple[str, ...], ...]] = {}
        self.scalars: set[str] = {"t"}
        place = join_place(where, "parameters")
        self.declared = declared = as_table(document.get("parameters", {}), place)
        self.rates = as_table(document.get("rates", {}), join_place(where, "rates"))
        self.parameters = dict(self.declare(declared, place))
        place, model = join_place(join_place(where, "model"), "states"), document.get("model", {})
        states = as_list(model.get("states", [*list_roles(document)]), place, "a list of names")
        self.sizes = [*self.list_states(states, place)]
        self.heights = [len(entries) for _, entries in self.sizes]
        self.whole = sum(self.heights)

    def declare(self, declared: Table, place: str) -> Iterator[tuple[str, Any]]:
        """The declarations of numbers; those of vectors and matrices entry by entry."""
        for name, value in declared.items():
            here = join_place(place, name)
            if not isinstance(value, Mapping):
                self.scalars.add(name)
                yield name, value
                continue
            (shape,) = self.read_shape(name, value, declared, here)
            if shape.kind == "scalar":
                self.scalars.add(name)
                limits = shape.ranges[name][:2]
                yield name, limits if "range" in value and None not in limits else value.get("sign", "real")
                continue
            self.arrays[name] = shape.rows
            yield from ((entry, "real") for entry in dict.fromkeys(entry for row in shape.rows for entry in row))

    def read_shape(self, name: str, value: Mapping[str, Any], declared: Table, here: str) -> list[Shape]:
        """What a table declares; a model has no relations between parameters, and no functions of its own."""
        found = read_shape(name, value, declared, here)
        related = found[0].relations and name not in self.bound  # a quantity brings the relations itself
        if related or len(found) > 1 or "integer" in value:
            message = (
                f"expected a number, a vector or a matrix; got {quote(dict(value))}; give its entries as parameters"
            )
            raise DomainError(message, where=here)
        return found

    def list_states(self, states: Sequence[Any], place: str) -> Iterator[tuple[str, tuple[str, ...]]]:
        """Each state of the list with the names of its entries."""
        for i, text in enumerate(states):
            found = STATE.fullmatch(text) if isinstance(text, str) else None
            if found is None:
                if isinstance(text, str) and "[" in text:
                    message = f"expected a name, or one with its size such as v[3]; got {quote(text)}; correct it"
                    raise ShapeError(message, where=join_place(place, i))
                yield text, (text,)
                continue
            name, size = found[1], int(found[2])
            if not 1 <= size <= SIDE:
                raise ShapeError(f"expected 1 to {SIDE} entries; got {size}; split it", where=join_place(place, i))
            if name in self.arrays or name in self.scalars:
                message = f"expected a new name; got {name!r}, which is declared already; rename it"
                raise DuplicateError(message, where=join_place(place, i))
            taken = {*self.scalars, *(other for other in states if isinstance(other, str))}
            self.arrays[name] = name_entries(name, (size, 1), False, taken)
            yield name, tuple(row[0] for row in self.arrays[name])

    # Texts

    def evaluate(self, text: Any, here: str) -> Rows | str:
        """The entries of a text, as texts; a number as it is written."""
        if not isinstance(text, str) or not (is_wide(text) or self.names_array(text)):
            return str(text) if isinstance(text, int) and not isinstance(text, bool) else text  # type: ignore[no-any-return]
        from navsym.prove.calculus.answers import settle_entries
        from navsym.prove.grant import write_numerals
        from navsym.prove.relations.reading import require_rates
        from navsym.prove.rooms.goals import player, write_term

        states = [name for name, entries in self.sizes if entries == (name,)] if hasattr(self, "sizes") else []
        known = dict.fromkeys([*self.scalars, *(name for name in states if isinstance(name, str))])
        sizes = known | {name: (len(rows), len(rows[0])) for name, rows in self.arrays.items()}
        tree = read_value(text, sizes, where=here).tree
        slopes: dict[str, str | None] = {}
        if {"diff", "dot_"} & {part.head for part in list_parts(tree)}:  # a state has a rate, but none that is known
            slopes = dict.fromkeys(sizes.keys() - self.declared.keys()) | {"t": "1"}
            slopes |= {name: write_numerals(str(rate)) for name, rate in self.rates.items() if name in sizes}
            require_rates([tree], slopes, here)
        names: dict[str, Any] = {name: ("symbol", name) for name in known}
        names |= {
            name: player.Matrix([[("symbol", entry) for entry in row] for row in rows])
            for name, rows in self.arrays.items()
        }
        used = list_free_names(tree) & names.keys()
        try:
            reader = player.Reader(names if slopes else {name: names[name] for name in used}, slopes, [])
            value = reader.read(write_numerals(text))
            box = {name: player.read_range(ends) for name, ends in self.list_limits(used)} if reader.questions else {}
            entries = settle_entries(reader, player.list_entries(value), box)
        except player.Refused as refusal:
            raise DomainError(
                f"expected a formula of numbers; got {quote(text)}: {refusal}; write it out", where=here
            ) from None
        texts = [write_term(entry) for entry in entries]
        if reader.choices or reader.fractions or any("erf(" in text for text in texts):
            message = f"expected no cases, floor and erf; got {quote(text)}; a model is one formula"
            raise DomainError(message, where=here)
        if not isinstance(value, player.Matrix):
            return texts[0]
        columns = len(value.rows[0])
        return [[*map(tidy, texts[k : k + columns])] for k in range(0, len(texts), columns)]

    def list_limits(self, names: Iterable[str]) -> Iterator[tuple[str, list[Any]]]:
        """The ranges of the numbers behind these names, in the words of the checker; states are real."""
        for name in names:
            if name in self.declared:
                yield from self.read_shape(name, self.declared[name], {}, name)[0].ranges.items()
            else:
                yield from ((entry, RANGES["real"]) for row in self.arrays.get(name, ((name,),)) for entry in row)

    def names_array(self, text: str) -> bool:
        return not self.arrays.keys().isdisjoint(re.findall(r"[A-Za-z]\w*", text))

    def scalar(self, value: Any, here: str) -> Any:
        """A number; an array is none."""
        found = self.evaluate(value, here)
        if isinstance(found, list):
            message = f"expected a number; got {describe_size((len(found), len(found[0])))}; pick an entry"
            raise ShapeError(message, where=here)
        return found

    def block(self, value: Any, rows: int, columns: int, here: str) -> Rows:
        """A block of this size; 0 is a block of zeros."""
        found = self.evaluate(value, here)
        if str(found).strip() == "0":
            return [["0"] * columns for _ in range(rows)]
        if not isinstance(found, list) and rows == columns == 1:
            return [[found]]
        size = (len(found), len(found[0])) if isinstance(found, list) else None
        if size != (rows, columns):
            message = f"expected {rows} x {columns}; got {describe_size(size)}; correct the block, or write 0"
            raise ShapeError(message, where=here)
        return found  # type: ignore[return-value]

    # Tables

    def write(self, document: Table, model: Table) -> Table:
        """All tables of the document, written out."""
        done, where = dict(document), join_place(self.where, "model")
        names = [entry for _, entries in self.sizes for entry in entries]
        done["parameters"] = self.parameters
        done["model"] = own = dict(model) | {"states": names}
        for key in ("F", "Phi", "reset"):
            if key in model:
                own[key] = self.square(model[key], join_place(where, key))
        if isinstance(model.get("G"), list):
            own["G"] = self.noises(model["G"], join_place(where, "G"))
        if isinstance(model.get("H"), list):
            place = join_place(where, "H")
            own["H"] = [
                row for i, line in enumerate(model["H"]) for row in self.measured(line, "h", join_place(place, i))
            ]
        if "dynamics" in model:
            own["dynamics"] = self.column(model["dynamics"], join_place(where, "dynamics"))
        if "relations" in model:
            place = join_place(where, "relations")
            items = as_list(model["relations"], place, "a list of equations")
            own["relations"] = [self.relation(item, join_place(place, i)) for i, item in enumerate(items)]
        for key, change in TABLES.items():
            if key in document:
                done[key] = change(self, document[key], join_place(self.where, key))
        return done

    def square(self, value: Any, here: str) -> Any:
        """F: one text, or a list of rows of blocks; written out in full already where it has a row for every entry."""
        if isinstance(value, str):
            return self.block(value, self.whole, self.whole, here)
        rows = as_list(value, here, "a list of rows")
        if len(rows) != len(self.heights):
            return self.entries(rows, here)
        return [line for i, row in enumerate(rows) for line in self.line(row, self.heights[i], join_place(here, i))]

    def entries(self, items: Sequence[Any], here: str) -> Any:
        """What is written out already, with an entry for each number."""
        if len(items) != self.whole:
            message = (
                f"expected {len(self.sizes)} entries, one for each state of the list; got {len(items)}; correct it"
            )
            raise ShapeError(message, where=here)
        return items

    def line(self, row: Any, height: int, here: str) -> Rows:
        """A row of blocks, or one text for all of it, as rows of entries."""
        if isinstance(row, str):
            return self.block(row, height, self.whole, here)
        items = as_list(row, here, "a list of expressions")
        if len(items) != len(self.heights):
            expected = f"expected {len(self.heights)} blocks, one for each state of the list"
            raise ShapeError(f"{expected}; got {len(items)}; correct the row", where=here)
        blocks = [
            self.block(item, height, size, join_place(here, j))
            for j, (item, size) in enumerate(zip(items, self.heights, strict=True))
        ]
        return [[entry for block in blocks for entry in block[i]] for i in range(height)]

    def noises(self, rows: Sequence[Any], here: str) -> Any:
        """G: blocks with the heights of the states; a column of blocks is as wide as its widest."""
        if len(rows) != len(self.sizes):
            return rows
        lines = [as_list(row, join_place(here, i), "a list of expressions") for i, row in enumerate(rows)]
        cells = [[self.evaluate(x, join_place(here, i)) for x in line] for i, line in enumerate(lines)]
        if len({*map(len, cells)}) > 1:
            raise ShapeError("expected rows of one length; got several; correct the matrix", where=here)
        columns = [*zip(*cells, strict=True)]
        if len(rows) < self.whole and ("0",) * len(rows) in columns:
            raise ShapeError("expected a block with a size in each column; got zeros; write zeros(3, 3)", where=here)
        widths = [max(len(x[0]) if isinstance(x, list) else 1 for x in column) for column in columns]
        done = []
        for i, (line, height) in enumerate(zip(lines, self.heights, strict=True)):
            place = join_place(here, i)
            blocks = [
                self.block(x, height, w, join_place(place, j))
                for j, (x, w) in enumerate(zip(line, widths, strict=True))
            ]
            done += [[entry for block in blocks for entry in block[k]] for k in range(height)]
        return done

    def list_names(self, value: Any, here: str) -> Any:
        """States of roles, or measurements, by the names of their vectors."""
        table = as_table(value, here)
        return {
            name: [x for item in (v if isinstance(v, list) else [v]) for x in self.spread(item)]
            for name, v in table.items()
        }

    def spread(self, item: Any) -> list[Any]:
        """The entries of a name that is a vector's, which may have its size beside it."""
        if isinstance(item, str) and item in self.measured_names:
            return list[Any](self.measured_names[item])
        found = STATE.fullmatch(item) if isinstance(item, str) else None
        rows = self.arrays.get(found[1] if found else item, ()) if isinstance(item, str) else ()
        return [x for row in rows for x in row] or [item]

    def list_quantities(self, value: Any, here: str) -> Any:
        """Quantities with an entry for each number; a matrix row by row."""
        done = {}
        for name, item in as_table(value, here).items():
            rows = self.evaluate(item, join_place(here, name)) if isinstance(item, str) else item
            narrow = isinstance(item, str) and isinstance(rows, list) and len(rows[0]) == 1
            done[name] = [row[0] for row in rows] if narrow else rows
        return done

    def column(self, value: Any, here: str) -> Any:
        """One entry for each state of the list, each a vector of its size."""
        items = as_list(value, here, "a list of expressions")
        if len(items) != len(self.sizes):
            return self.entries(items, here)
        rows = [
            self.block(item, height, 1, join_place(here, i))
            for i, (item, height) in enumerate(zip(items, self.heights, strict=True))
        ]
        return [entry for block in rows for (entry,) in block]

    def relation(self, text: Any, here: str) -> Any:
        """An equation between numbers."""
        sides = as_text(text, here, "an equation").split("=")
        return " = ".join(str(self.scalar(side.strip(), here)) for side in sides)

    def list_measurements(self, value: Any, here: str) -> Any:
        """One block for each number that is measured; a vector gives as many, with numbered names."""
        found: list[Any] = []
        for i, block in enumerate(as_list(value, here, "[[measurement]] blocks")):
            place = join_place(here, i)
            table = dict(as_table(block, place))
            key = "h" if "h" in table else "z"
            if key not in table:
                found.append(table)
                continue
            there = join_place(place, key)
            rows = self.measured(table[key], key, there)
            name, sigma = table.get("name", f"z{i + 1}"), self.scalar(table.get("sigma", 1), join_place(place, "sigma"))
            names = [name] if len(rows) == 1 else [f"{name}_{k}" for k in range(1, len(rows) + 1)]
            self.measured_names[name] = names
            found += [table | {key: row, "sigma": sigma, "name": own} for row, own in zip(rows, names, strict=True)]
        return found

    def measured(self, value: Any, key: str, here: str) -> list[Any]:
        """The rows of h, by blocks or in one text, or the entries of z."""
        found = value if isinstance(value, list) else self.evaluate(value, here)
        if key == "z":
            return [found] if isinstance(found, str) else [entry for (entry,) in self.block(value, len(found), 1, here)]
        if found is not value and isinstance(found, list):
            return self.block(value, len(found), self.whole, here)
        if not isinstance(value, list) or len(value) not in (len(self.sizes), self.whole):
            items = value if isinstance(value, list) else as_list(value, here, "a list of blocks")
            return [self.entries(items, here)]
        if len(value) != len(self.sizes):
            return [value]
        blocks = [self.evaluate(item, join_place(here, j)) for j, item in enumerate(value)]
        height = max((len(block) for block in blocks if isinstance(block, list)), default=1)
        return self.line(value, height, here)

    def list_targets(self, value: Any, here: str) -> Any:
        """Functionals: a block is a row of the state's size."""
        table = as_table(value, here)
        whole = {name: as_list(row, join_place(here, name), "a list of expressions") for name, row in table.items()}
        return {
            name: self.line(row, 1, join_place(here, name))[0] if len(row) == len(self.sizes) else row
            for name, row in whole.items()
        }

    def list_rates(self, value: Any, here: str) -> Any:
        """Rates of numbers; that of a vector or matrix entry by entry."""
        done: dict[str, Any] = {}
        for name, text in as_table(value, here).items():
            rows = self.arrays.get(name)
            if rows is None:
                done[name] = self.scalar(text, join_place(here, name))
                continue
            found = self.block(text, len(rows), len(rows[0]), join_place(here, name))
            done |= {
                entry: x for row, line in zip(rows, found, strict=True) for entry, x in zip(row, line, strict=True)
            }
        return done

    def list_inputs(self, value: Any, here: str) -> Any:
        """Columns of unknown inputs; a word stays."""
        table = as_table(value, here)
        return {
            name: self.column(item, join_place(here, name)) if isinstance(item, list) else item
            for name, item in table.items()
        }

    def list_pieces(self, value: Any, here: str) -> Any:
        """The pieces, each with its F."""
        blocks = [dict(as_table(block, join_place(here, i))) for i, block in enumerate(as_list(value, here, "blocks"))]
        for i, block in enumerate(blocks):
            place = join_place(here, i)
            block |= {key: self.scalar(block[key], join_place(place, key)) for key in ("from", "to") if key in block}
            if "F" in block:
                block["F"] = self.square(block["F"], join_place(place, "F"))
        return blocks

    def list_ranges(self, value: Any, here: str) -> Any:
        """Ranges of numbers; that of a vector or matrix is the range of each of its entries."""
        return {
            entry: ends
            for name, ends in as_table(value, here).items()
            for entry in (x for row in self.arrays.get(name, ((name,),)) for x in row)
        }

    def list_numbers(self, value: Any, here: str) -> Any:
        """A table of numbers."""
        return {key: self.scalar(item, join_place(here, key)) for key, item in as_table(value, here).items()}


TABLES: dict[str, Callable[[Writer, Any, str], Any]] = {
    "measurement": Writer.list_measurements,
    "targets": Writer.list_targets,
    "rates": Writer.list_rates,
    "inputs": Writer.list_inputs,
    "piece": Writer.list_pieces,
    "interval": Writer.list_numbers,
    "ranges": Writer.list_ranges,
    "roles": Writer.list_names,
    "measured": Writer.list_names,
    "quantities": Writer.list_quantities,
}
