"""Model files: a linear system with its measurements, or the regressors themselves."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from navsym.errors import DomainError, DuplicateError, EmptyError, UnknownSymbolError
from navsym.text.arithmetic import sign
from navsym.text.basisfile import Known, read_basis, read_targets
from navsym.text.expression import ZERO, Expr, parse, symbol
from navsym.text.files import called
from navsym.text.modeltypes import BasisFile, Measurement, ModelFile, Piece
from navsym.text.names import check_name, nearest, shown
from navsym.text.parameters import Parameter, brief, read_parameters, require_order, require_positive, symbols_of
from navsym.text.schema import (
    Table,
    as_label,
    as_list,
    as_table,
    as_title,
    distinct,
    entry,
    expect_keys,
    inside,
    required,
    square,
    vector,
)
from navsym.text.tomlfile import read_toml

__all__ = ["BasisFile", "Measurement", "ModelFile", "Piece", "model_from", "read_model"]

TABLES = ("model", "basis", "parameters", "measurement", "piece", "interval", "targets")


def read_model(path: str | os.PathLike[str], values: Mapping[str, str] | None = None) -> ModelFile | BasisFile:
    """The model or basis of a TOML file.

    values : parameter -> exact value as text, put in its place everywhere (``--set T=2.5``)

    Raises a NavsymError whose ``where`` names the file and the key.
    """
    return model_from(read_toml(path), called(path), values)


def model_from(document: Table, where: str = "", values: Mapping[str, str] | None = None) -> ModelFile | BasisFile:
    """Like :func:`read_model` for a document in memory, with the same errors."""
    place = inside(where, "parameters")
    parameters = read_parameters(as_table(document.get("parameters", {}), place), place)
    known = dict(symbols_of(parameters)) | read_values(values or {}, parameters)
    free = {name: parameter for name, parameter in parameters.items() if name not in (values or {})}
    if "basis" in document:
        return read_basis(document, where, free, known)
    if "model" not in document:
        expect_keys(document, TABLES, where)
        raise EmptyError("expected a [model] or a [basis]; got neither; do add one", where=where)
    return read_system(document, where, free, known)


def read_values(values: Mapping[str, str], parameters: Mapping[str, Parameter]) -> dict[str, Expr]:
    """Exact numbers that replace parameters, each inside what the file declares."""
    given = {}
    for name, text in values.items():
        where = f"--set {shown(name)[1:-1]}"
        if name not in parameters:
            hint = nearest(name, parameters)
            message = f"expected a declared parameter; got {shown(name)}; do correct it: {hint}"
            raise UnknownSymbolError(message, where=where)
        value = parse(text, {}, where=where)
        if not admitted(value, parameters[name]):
            message = f"expected a value in the declared range of {name}; got {shown(text)}; do correct it"
            raise DomainError(message, where=where)
        given[name] = value
    return given


def admitted(value: Expr, parameter: Parameter) -> bool:
    """False when the value certainly contradicts the declaration."""
    below = parameter.lower is not None and sign(value - parameter.lower) == -1
    above = parameter.upper is not None and sign(parameter.upper - value) == -1
    wrong = {"positive": (0, -1), "nonnegative": (-1,), "nonzero": (0,)}.get(parameter.kind, ())
    return not below and not above and sign(value) not in wrong


def read_system(document: Table, where: str, parameters: Mapping[str, Parameter], known: Known) -> ModelFile:
    """The [model] with its measurements, interval and targets."""
    expect_keys(document, tuple(key for key in TABLES if key != "basis"), where)
    place = inside(where, "model")
    model = as_table(document["model"], place)
    expect_keys(model, ("name", "states", "F"), place)
    states = read_names(required(model, "states", place), inside(place, "states"))
    distinct((*known, "t", *states), inside(place, "states"))
    time = symbol("t")
    moving = {**known, "t": time}
    T = read_interval(document, known, inside(where, "interval"))
    return ModelFile(
        name=as_title(model.get("name", "model"), inside(place, "name")),
        parameters=parameters,
        states=states,
        time=time,
        pieces=read_pieces(document, model, moving, len(states), T, where),
        measurements=read_measurements(document, moving, len(states), where),
        T=T,
        targets=read_targets(document, known, states, where),
    )


def read_names(value: Any, where: str) -> tuple[str, ...]:
    """Distinct declared names, in order."""
    items = as_list(value, where, "a list of names")
    names = tuple(check_name(name, where=inside(where, i)) for i, name in enumerate(items))
    distinct(names, where)
    return names


def read_interval(document: Table, known: Known, where: str) -> Expr | None:
    """T of the [interval] table, above zero; None when the file has none."""
    if "interval" not in document:
        return None
    table = as_table(document["interval"], where)
    expect_keys(table, ("T",), where)
    T = entry(required(table, "T", where), known, inside(where, "T"))
    require_positive(T, "a length of time T", inside(where, "T"))
    return T


def read_pieces(document: Table, model: Table, moving: Known, n: int, T: Expr | None, where: str) -> tuple[Piece, ...]:
    """F of [model], or the [[piece]] blocks in order and without gaps."""
    place, why = inside(where, "piece"), "one per state"
    if "piece" not in document:
        F = required(model, "F", inside(where, "model"))
        return (Piece(ZERO, T, square(F, moving, inside(where, "model.F"), n, why)),)
    if "F" in model:
        raise DuplicateError("expected F or [[piece]]; got both; do remove one of them", where=place)
    blocks = as_list(document["piece"], place, "[[piece]] blocks")
    pieces = tuple(read_piece(block, moving, n, inside(place, i)) for i, block in enumerate(blocks))
    ends = [ZERO, *(piece.end for piece in pieces)]
    for i, piece in enumerate(pieces):
        if piece.start != ends[i]:
            message = f"expected a start at {brief(ends[i])}; got {brief(piece.start)}; do close the gap"
            raise DomainError(message, where=inside(inside(place, i), "from"))
    if T is not None and ends[-1] != T:
        message = f"expected the last piece to end at T = {brief(T)}; got {brief(ends[-1])}; do correct it"
        raise DomainError(message, where=inside(inside(place, len(pieces) - 1), "to"))
    return pieces


def read_piece(block: Any, moving: Known, n: int, where: str) -> Piece:
    """One [[piece]] block."""
    table = as_table(block, where)
    expect_keys(table, ("from", "to", "F"), where)
    fixed = {name: value for name, value in moving.items() if name != "t"}
    start = entry(required(table, "from", where), fixed, inside(where, "from"))
    end = entry(required(table, "to", where), fixed, inside(where, "to"))
    require_order(start, end, where)
    F = square(required(table, "F", where), moving, inside(where, "F"), n, "one per state")
    return Piece(start, end, F)


def read_measurements(document: Table, moving: Known, n: int, where: str) -> tuple[Measurement, ...]:
    """The [[measurement]] blocks, with distinct names."""
    place = inside(where, "measurement")
    blocks = as_list(required(document, "measurement", where), place, "[[measurement]] blocks")
    found = []
    for i, block in enumerate(blocks):
        here = inside(place, i)
        table = as_table(block, here)
        expect_keys(table, ("name", "h", "sigma"), here)
        name = as_label(table.get("name", f"z{i + 1}"), inside(here, "name"))
        h = vector(required(table, "h", here), moving, inside(here, "h"), n, "one per state")
        fixed = {key: value for key, value in moving.items() if key != "t"}
        found.append(Measurement(name, h, read_sigma(table.get("sigma", 1), fixed, inside(here, "sigma"))))
    distinct((measurement.name for measurement in found), place)
    return tuple(found)


def read_sigma(value: Any, known: Known, where: str) -> Expr:
    """A bound of a standard deviation, above zero."""
    sigma = entry(value, known, where)
    require_positive(sigma, "a standard deviation", where)
    return sigma
