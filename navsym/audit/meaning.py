"""Units of source code: the declared ones must allow every formula that the code assigns, compares and returns.

Numbers of code often have a unit that nobody wrote: see :mod:`navsym.language.dimensions`, ``loose``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from navsym.audit.form import spell_entry
from navsym.audit.names import Names, squeeze
from navsym.audit.questions import Entry
from navsym.audit.sources import Source
from navsym.audit.values import Array, Scalar, cells_of, places_of
from navsym.core.errors import DomainError
from navsym.language.dimensions import infer_units
from navsym.language.shapes import Shape
from navsym.language.tree import Tree, build
from navsym.language.vectors import RELATIONS


def list_meaningless(names: Names, sources: Sequence[Source], entries: Sequence[Entry]) -> list[tuple[str, str]]:
    """Place and reason of every formula that the declared units do not allow; none where no unit is declared."""
    if not names.units:
        return []
    pairs = [*list_formulas(sources, names), *list_sides(entries)]
    shapes = {name: declare_unit(names, name) for name in names.spellings}
    refused: list[DomainError] = []
    infer_units([tree for _, tree in pairs], shapes, where=[place for place, _ in pairs], loose=True, refused=refused)
    return [*dict.fromkeys((error.where, names.show(error.message)) for error in refused)]


def declare_unit(names: Names, name: str) -> Shape:
    """The declaration of a symbol; what is said of an array is said of its entries."""
    key = squeeze(names.spellings[name])
    unit = names.units.get(key) or names.units.get(key.partition("[")[0], "")
    return Shape(name, ((name,),), "scalar", {}, unit=unit)


def list_formulas(sources: Sequence[Source], names: Names) -> Iterator[tuple[str, Tree]]:
    """What the code assigns, in the order of its lines, with its comparisons and what it returns."""
    for source in sources:
        reading, lines = source.read(), list[tuple[int, Tree]]()
        written = {**reading.written}
        for case in reading.cases:
            for test in case.conditions:
                if test.left is not None and test.right is not None:
                    sign = test.sign if test.sign in RELATIONS else "="
                    lines.append((test.line, build(sign, (test.left, test.right))))
            if (value := case.returned) is not None:
                places = places_of(value.shape) if isinstance(value, Array) else [()]
                for place, cell in zip(places, cells_of(value), strict=True):
                    if isinstance(cell, Scalar):
                        written[cell.tree, "return", place] = cell.line or source.function.line
        for (tree, name, place), line in written.items():
            spelling = spell_entry(source.unit, name, place)
            declared = not {squeeze(spelling), squeeze(name)}.isdisjoint(names.units)
            lines.append((line, build("=", (tree, source.symbol(spelling))) if declared else tree))
        for line, tree in sorted(lines, key=lambda pair: pair[0]):
            file, number = source.unit.locate(line)
            yield f"{file}:{number}", tree


def list_sides(entries: Sequence[Entry]) -> Iterator[tuple[str, Tree]]:
    """What the questions expect beside what the code has."""
    for entry in entries:
        if isinstance(entry.code, Scalar) and isinstance(entry.expected, Scalar):
            where = entry.asking.place(entry.key) if entry.asking is not None else ""
            yield f"{where}[{entry.place[0]},{entry.place[1]}]", build("=", (entry.code.tree, entry.expected.tree))
