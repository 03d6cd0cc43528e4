"""The outputs of a function as formulas, when nothing is asked."""

from __future__ import annotations

from collections.abc import Iterator

from navsym.audit.answer import OutputFormula
from navsym.audit.decide import measure
from navsym.audit.evaluate import Case
from navsym.audit.form import spell_entry
from navsym.audit.sources import Source
from navsym.audit.values import Array, Cell, Scalar, Unread, Value, places_of
from navsym.language.printer import print_tree

LONGEST = 20_000


def list_formulas(source: Source) -> list[OutputFormula]:
    """What the function returns, and what it assigns to parameters, members and globals, case by case."""
    formulas = []
    for case in source.read().cases:
        words = " and ".join(c.text if c.holds else f"not {c.text}" for c in case.conditions)
        for name, cell in list_outputs(source, case):
            formulas.append(OutputFormula(name, cell.line, write_cell(source, cell), words))
    return formulas


def list_outputs(source: Source, case: Case) -> Iterator[tuple[str, Cell]]:
    """Names of outputs with their values."""
    if case.returned is not None:
        yield from list_cells(source, "return", case.returned)
    for name, variable in case.variables.items():
        if not variable.is_input and name not in source.function.outputs:
            continue
        for place, cell in sorted(variable.cells.items()):
            if isinstance(cell, Unread) or cell.line:
                yield spell_entry(source.unit, name, place), variable.all_unread or cell


def list_cells(source: Source, name: str, value: Value) -> Iterator[tuple[str, Cell]]:
    """The cells of a value with their spellings."""
    if not isinstance(value, Array):
        yield name, value
        return
    for place, cell in zip(places_of(value.shape), value.cells, strict=True):
        yield spell_entry(source.unit, name, place), cell


def write_cell(source: Source, cell: Cell) -> str:
    """A formula in the spelling of the source, or why there is none."""
    if isinstance(cell, Scalar):
        if measure(cell.tree) > LONGEST:
            return "not shown: a formula of more than 20,000 characters"
        return source.names.show(print_tree(cell.tree))
    return f"not read: {cell.why}"
