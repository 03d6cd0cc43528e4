"""The [basis] and [targets] tables of a model file: regressors and functionals."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from navsym.errors import DomainError, EmptyError, ShapeError
from navsym.text.expression import ONE, ZERO, Expr, symbol
from navsym.text.modeltypes import BasisFile, Targets
from navsym.text.parameters import Parameter, require_order, require_positive
from navsym.text.schema import (
    Table,
    as_label,
    as_list,
    as_table,
    as_text,
    as_title,
    distinct,
    expect_keys,
    inside,
    required,
    vector,
)

Known = Mapping[str, Expr]


def read_basis(document: Table, where: str, parameters: Mapping[str, Parameter], known: Known) -> BasisFile:
    """The [basis] table with its targets."""
    expect_keys(document, ("basis", "parameters", "targets"), where)
    place = inside(where, "basis")
    table = as_table(document["basis"], place)
    expect_keys(table, ("name", "variable", "H", "sigma", "interval"), place)
    variable = as_text(required(table, "variable", place), inside(place, "variable"), "a name")
    made = symbol(variable, where=inside(place, "variable"))
    distinct((*known, variable), inside(place, "variable"))
    H = read_rows(required(table, "H", place), {**known, variable: made}, inside(place, "H"))
    names = tuple(f"c{i}" for i in range(len(H[0])))
    return BasisFile(
        name=as_title(table.get("name", "basis"), inside(place, "name")),
        parameters=parameters,
        variable=made,
        H=H,
        sigma=read_sigmas(table, known, len(H), place),
        interval=read_ends(required(table, "interval", place), known, inside(place, "interval")),
        targets=read_targets(document, known, names, where),
    )


def read_rows(value: Any, known: Known, where: str) -> tuple[tuple[Expr, ...], ...]:
    """One row of regressors, or a list of them, all of one length."""
    items = as_list(value, where, "a list of expressions")
    nested = [isinstance(item, list) for item in items]
    if any(nested) and not all(nested):
        message = "expected expressions or rows of expressions; got both; do write one list per measurement"
        raise ShapeError(message, where=where)
    rows = items if nested[0] else [items]
    size = len(rows[0])
    places = [inside(where, i) if nested[0] else where for i in range(len(rows))]
    return tuple(
        vector(row, known, here, size, "as many as in the first row") for row, here in zip(rows, places, strict=True)
    )


def read_sigmas(table: Table, known: Known, count: int, where: str) -> tuple[Expr, ...]:
    """One positive bound per measurement; ones where the file gives none."""
    place = inside(where, "sigma")
    value = table.get("sigma", ["1"] * count)
    if not isinstance(value, list):
        value = [value]
    sigmas = vector(value, known, place, count, "one per measurement")
    for i, sigma in enumerate(sigmas):
        require_positive(sigma, "a standard deviation", inside(place, i))
    return sigmas


def read_ends(value: Any, known: Known, where: str) -> tuple[Expr, Expr]:
    """Start and end of the variable, in order."""
    start, end = vector(value, known, where, 2, "start and end")
    require_order(start, end, where)
    return start, end


def read_targets(document: Table, known: Known, names: tuple[str, ...], where: str) -> Targets:
    """The file's functionals, or one for every unknown."""
    n, place = len(names), inside(where, "targets")
    if "targets" not in document:
        return {name: tuple(ONE if i == j else ZERO for j in range(n)) for i, name in enumerate(names)}
    targets = {}
    for label, row in as_table(document["targets"], place).items():
        here = inside(place, label)
        functional = vector(row, known, here, n, "one per unknown")
        if all(weight == 0 for weight in functional):
            raise DomainError("expected a functional that is not zero; got zeros; do correct it", where=here)
        targets[as_label(label, here)] = functional
    if not targets:
        raise EmptyError("expected at least one target; got none; do add one or drop the table", where=place)
    return targets
