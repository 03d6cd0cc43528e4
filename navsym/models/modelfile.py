"""Model files: a linear system with its measurements, or the regressors themselves."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from navsym.core.errors import DomainError, DuplicateError, EmptyError, ShapeError, UnknownSymbolError
from navsym.core.units import drop_unit
from navsym.language.arithmetic import sign_of_constant
from navsym.language.declarations import (
    Parameter,
    box_of,
    cut_text,
    read_parameters,
    read_range,
    require_order,
    require_positive,
    symbols_of,
)
from navsym.language.expression import ONE, ZERO, Expr, Matrix, Symbol, parse, symbol
from navsym.language.files import name_file
from navsym.language.names import check_name, quote, suggest_nearest
from navsym.language.schema import (
    Table,
    as_label,
    as_list,
    as_table,
    as_text,
    as_title,
    expect_keys,
    join_place,
    read_entry,
    read_square,
    read_vector,
    require_distinct,
    require_key,
)
from navsym.language.tomlfile import read_toml
from navsym.language.values import declared_unit, write_value
from navsym.models.blocks import write_out
from navsym.models.linear import LinearModel
from navsym.models.meaning import require_meaning

# What a model file says, as plain exact data.


Targets = Mapping[str, tuple[Expr, ...]]


@dataclass(frozen=True, slots=True, eq=False)
class Measurement:
    """``z = h x + r`` with a standard deviation of r of at most sigma; h has one entry per state.

    z : the formula of a measurement that is given as one, beside ``dynamics``; h is empty then
    """

    name: str
    h: tuple[Expr, ...]
    sigma: Expr
    z: Expr | None = None


@dataclass(frozen=True, slots=True, eq=False)
class NoiseBlock:
    """Measurements of one time whose errors ``r = diag(sigma) e`` are bounded together.

    names : of the measurements
    norm  : "l2": ``e' shape^-1 e <= 1``, with ones on the diagonal of shape; "l1": ``sum |e_j| <= 1``;
            "linf": ``|e_j| <= 1``, as without a block
    """

    names: tuple[str, ...]
    norm: str
    shape: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """``dx/dt = F x`` from ``start`` to ``end`` (None: no end is given)."""

    start: Expr
    end: Expr | None
    F: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class ModelFile:
    """``dx/dt = F x``, ``dx/dt = f(x)`` or ``x_(k+1) = Phi x_k``, with scalar measurements on [0, T].

    time         : the symbol t, which F and h may contain
    states       : n names
    pieces       : one piece for a constant (or continuously varying) F, otherwise one for each [[piece]]
    T            : length of the interval, None when the file has no [interval]
    targets      : name -> n expressions, a functional of the state at T
    rates        : parameter -> its derivative by the time; the others are constant
    dynamics     : f, one entry per state, of a nonlinear model; there are no pieces then
    relations    : functions of the states that are zero on the manifold on which they move
    Phi          : matrix of one step of a discrete-time model; there are no pieces then
    inputs       : unknown input -> how it enters, one entry per state; none beside dynamics, which name it
    ranges       : state, parameter or ``dt`` (the step of a filter) -> its ends, for exported code
    blocks       : measurements whose errors are bounded together; a measurement by itself is a block of one
    """

    name: str
    parameters: Mapping[str, Parameter]
    states: tuple[str, ...]
    time: Symbol
    pieces: tuple[Piece, ...]
    measurements: tuple[Measurement, ...]
    T: Expr | None
    targets: Targets
    rates: Mapping[str, Expr] = field(default_factory=dict)
    dynamics: tuple[Expr, ...] = ()
    relations: tuple[Expr, ...] = ()
    Phi: Matrix | None = None
    inputs: Mapping[str, tuple[Expr, ...]] = field(default_factory=dict)
    ranges: Mapping[str, tuple[Expr, Expr]] = field(default_factory=dict)
    blocks: tuple[NoiseBlock, ...] = ()

    def _repr_latex_(self) -> str:
        """The matrix of the system, for notebooks."""
        return str(self.F._repr_latex_())

    @property
    def F(self) -> Matrix:
        """The matrix of a model in one piece. Raises ShapeError when there are several, DomainError for dynamics."""
        need_fixed(self, "Model")
        if len(self.pieces) != 1:
            message = f"expected one F; got {len(self.pieces)} pieces; use a method that takes pieces"
            raise ShapeError(message)
        return self.pieces[0].F

    @property
    def box(self) -> dict[Symbol, tuple[Expr, Expr]]:
        """Symbol -> (lower, upper) for the parameters that have a range."""
        return box_of(self.parameters)


@dataclass(frozen=True, slots=True, eq=False)
class BasisFile:
    """Regressors without a model: ``z_j(s) = H_j(s) q + r_j``.

    H        : one row per measurement, one expression per unknown
    sigma    : one bound per measurement
    interval : (start, end) of the variable
    targets  : name -> one expression per unknown
    """

    name: str
    parameters: Mapping[str, Parameter]
    variable: Symbol
    H: tuple[tuple[Expr, ...], ...]
    sigma: tuple[Expr, ...]
    interval: tuple[Expr, Expr]
    targets: Targets

    @property
    def box(self) -> dict[Symbol, tuple[Expr, Expr]]:
        """Symbol -> (lower, upper) for the parameters that have a range."""
        return box_of(self.parameters)


def need_fixed(found: ModelFile | BasisFile, where: str) -> None:
    """Refuse what only observability is asked about: steps, nonlinear dynamics, unknown inputs, moving parameters."""
    if isinstance(found, ModelFile) and found.Phi is not None:
        raise DomainError("expected a model in continuous time with F; got steps Phi; ask observe", where=where)
    if isinstance(found, ModelFile) and found.inputs:
        got = f"the unknown input {next(iter(found.inputs))}"
        raise DomainError(f"expected a model without unknown inputs; got {got}; ask observe", where=where)
    if isinstance(found, ModelFile) and (found.dynamics or found.rates):
        got = "nonlinear dynamics" if found.dynamics else f"the rate of {next(iter(found.rates))}"
        message = f"expected a linear model with constant parameters; got {got}; ask observe, or write F as F(t)"
        raise DomainError(message, where=where)


def linear_model(found: ModelFile) -> LinearModel:
    """The model of a file in one piece; ShapeError when there are several."""
    return piece_model(found, found.F)


def piece_model(found: ModelFile, F: Matrix) -> LinearModel:
    """The linear model of one piece of the motion."""
    rows = [list(measurement.h) for measurement in found.measurements]
    names = tuple(measurement.name for measurement in found.measurements)
    return LinearModel(F, None, rows or None, found.states, measurements=names, time=found.time)


# The [basis] and [targets] tables of a model file: regressors and functionals.


Known = Mapping[str, Expr]


def read_basis(document: Table, where: str, parameters: Mapping[str, Parameter], known: Known) -> BasisFile:
    """The [basis] table with its targets."""
    expect_keys(document, ("basis", "parameters", "targets", "design"), where)
    place = join_place(where, "basis")
    table = as_table(document["basis"], place)
    expect_keys(table, ("name", "variable", "H", "sigma", "interval"), place)
    variable = as_text(require_key(table, "variable", place), join_place(place, "variable"), "a name")
    made = symbol(variable, where=join_place(place, "variable"))
    require_distinct((*known, variable), join_place(place, "variable"))
    H = read_rows(require_key(table, "H", place), {**known, variable: made}, join_place(place, "H"))
    names = tuple(f"c{i}" for i in range(len(H[0])))
    ends = join_place(place, "interval")
    start, end = read_vector(require_key(table, "interval", place), known, ends, 2, "start and end")
    require_order(start, end, ends)
    return BasisFile(
        name=as_title(table.get("name", "basis"), join_place(place, "name")),
        parameters=parameters,
        variable=made,
        H=H,
        sigma=read_sigmas(table, known, len(H), place),
        interval=(start, end),
        targets=read_targets(document, known, names, where),
    )


def read_rows(value: Any, known: Known, where: str) -> tuple[tuple[Expr, ...], ...]:
    """One row of regressors, or a list of them, all of one length."""
    items = as_list(value, where, "a list of expressions")
    nested = [isinstance(item, list) for item in items]
    if any(nested) and not all(nested):
        message = "expected expressions or rows of expressions; got both; write one list per measurement"
        raise ShapeError(message, where=where)
    rows = items if nested[0] else [items]
    size = len(rows[0])
    places = [join_place(where, i) if nested[0] else where for i in range(len(rows))]
    return tuple(
        read_vector(row, known, here, size, "as many as in the first row")
        for row, here in zip(rows, places, strict=True)
    )


def read_sigmas(table: Table, known: Known, count: int, where: str) -> tuple[Expr, ...]:
    """One positive bound per measurement; ones where the file gives none."""
    place = join_place(where, "sigma")
    value = table.get("sigma", ["1"] * count)
    if not isinstance(value, list):
        value = [value]
    sigmas = read_vector(value, known, place, count, "one per measurement")
    for i, sigma in enumerate(sigmas):
        require_positive(sigma, "a standard deviation", join_place(place, i))
    return sigmas


def read_targets(document: Table, known: Known, names: tuple[str, ...], where: str) -> Targets:
    """The file's functionals, or one for every unknown."""
    n, place = len(names), join_place(where, "targets")
    if "targets" not in document:
        return {name: tuple(ONE if i == j else ZERO for j in range(n)) for i, name in enumerate(names)}
    targets = {}
    for label, row in as_table(document["targets"], place).items():
        here = join_place(place, label)
        functional = read_vector(row, known, here, n, "one per unknown")
        if all(weight == 0 for weight in functional):
            raise DomainError("expected a functional that is not zero; got zeros; correct it", where=here)
        targets[as_label(label, here)] = functional
    if not targets:
        raise EmptyError("expected at least one target; got none; add one or drop the table", where=place)
    return targets


SYSTEM = (
    "model", "units", "parameters", "rates", "inputs", "measurement", "block", "piece", "interval", "targets", "ranges",
)  # fmt: skip
TABLES = (*SYSTEM, "basis")
#: Tables of the same file that only ``conventions`` or ``design`` reads, and keys of [model].
BESIDE = ("card", "code", "roles", "quantities", "known", "measured", "noises", "design")
BESIDE_F = ("G", "H", "reset", "step")
KEYS = ("name", "states", "F", "Phi", "dynamics", "relations")
NORMS = ("l2", "linf", "l1")
#: Name of the step of a filter among the ranges.
STEP = "dt"


def read_model(path: str | os.PathLike[str], values: Mapping[str, Any] | None = None) -> ModelFile | BasisFile:
    """The model or basis of a TOML file.

    values : parameter -> exact value, put in its place everywhere (``--set T=2.5``, ``--set "T=90 min"``)

    Raises a NavsymError whose ``where`` names the file and the key.
    """
    return model_from(read_toml(path), name_file(path), values)


def model_from(
    document: Table, where: str = "", values: Mapping[str, Any] | None = None, *, is_known: bool = False
) -> ModelFile | BasisFile:
    """Like :func:`read_model` for a document in memory, with the same errors.

    is_known : it has been read before, so that its units need not be looked at again
    """
    declared, place = document.get("parameters"), join_place(where, "parameters")
    source, document = document, write_out(document, where)
    parameters = {
        name: replace(parameter, unit=declared_unit(name, declared))
        for name, parameter in read_parameters(as_table(document.get("parameters", {}), place), place).items()
    }
    known = dict(symbols_of(parameters)) | read_values(values or {}, parameters)
    free = {name: parameter for name, parameter in parameters.items() if name not in (values or {})}
    if "basis" in document:
        return read_basis(document, where, free, known)
    if "model" not in document:
        expect_keys(document, TABLES, where)
        raise EmptyError("expected a [model] or a [basis]; got neither; add one", where=where)
    found = read_system(document, where, free, known)
    if not is_known:
        require_meaning(source, document, where)
    return found


def read_values(values: Mapping[str, Any], parameters: Mapping[str, Parameter]) -> dict[str, Expr]:
    """Exact numbers that replace parameters, each inside what the file declares, in its unit."""
    given = {}
    for name, raw in values.items():
        where = f"--set {quote(name)[1:-1]}"
        if name not in parameters:
            hint = suggest_nearest(name, parameters)
            message = f"expected a declared parameter; got {quote(name)}; correct it: {hint}"
            raise UnknownSymbolError(message, where=where)
        text = write_value(raw, where, parameters[name].unit)
        value = parse(drop_unit(text, where, parameters[name].unit), {}, where=where)
        if not admitted(value, parameters[name]):
            message = f"expected a value in the declared range of {name}; got {quote(text)}; correct it"
            raise DomainError(message, where=where)
        given[name] = value
    return given


def admitted(value: Expr, parameter: Parameter) -> bool:
    """False when the value certainly contradicts the declaration."""
    below = parameter.lower is not None and sign_of_constant(value - parameter.lower) == -1
    above = parameter.upper is not None and sign_of_constant(parameter.upper - value) == -1
    wrong = {"positive": (0, -1), "nonnegative": (-1,), "nonzero": (0,)}.get(parameter.kind, ())
    return not below and not above and sign_of_constant(value) not in wrong


#: What gives the motion -> keys of [model] and tables that have no place beside it.
FOREIGN = {
    "Phi": (("F", "dynamics", "relations"), ("piece", "rates", "interval", "targets", "ranges", "block")),
    "dynamics": (("F",), ("piece", "targets", "block")),
    "F": ((), ()),
}


def read_system(document: Table, where: str, parameters: Mapping[str, Parameter], known: Known) -> ModelFile:
    """The [model] with its measurements, interval and targets: F or pieces, steps Phi, or dynamics f(x)."""
    expect_keys(document, (*SYSTEM, *BESIDE), where)
    place = join_place(where, "model")
    model = as_table(document["model"], place)
    expect_keys(model, (*KEYS, *BESIDE_F), place)
    states = read_names(require_key(model, "states", place), join_place(place, "states"))
    require_distinct((*known, "t", *states), join_place(place, "states"))
    kind = "Phi" if "Phi" in model else "dynamics" if {"dynamics", "relations"} & model.keys() else "F"
    require_alone(document, model, kind, where)
    moving: Known = known if kind == "Phi" else {**known, "t": symbol("t")}
    if kind == "dynamics":
        moving = {**moving, **{name: symbol(name) for name in states}}
    n = 0 if kind == "dynamics" else len(states)
    inputs = read_inputs(document, moving, states, n, where)
    driven = moving if n else {**moving, **{name: symbol(name) for name in inputs}}
    T = read_interval(document, known, join_place(where, "interval"))
    return ModelFile(
        name=as_title(model.get("name", "model"), join_place(place, "name")),
        parameters=parameters,
        states=states,
        time=symbol("t"),
        pieces=read_pieces(document, model, moving, n, T, where) if kind == "F" else (),
        measurements=(measurements := read_measurements(document, driven, n, where)),
        blocks=read_blocks(document, [m.name for m in measurements], where),
        T=T,
        targets=read_targets(document, known, states, where) if kind == "F" else {},
        rates=read_rates(document, moving, parameters, where),
        inputs=inputs,
        ranges=read_ranges(document, states, parameters, where) if kind == "F" else {},
        **read_motion(model, driven, moving, kind, len(states), place),
    )


def require_alone(document: Table, model: Table, kind: str, where: str) -> None:
    """DuplicateError for what another kind of motion would need."""
    place = join_place(where, "model")
    own, tables = FOREIGN[kind]
    foreign = [(key, model, place) for key in own] + [(key, document, where) for key in tables]
    for key, table, outer in foreign:
        if key in table:
            raise DuplicateError(
                f"expected {kind} or {key}; got both; remove one of them", where=join_place(outer, key)
            )


def read_motion(model: Table, driven: Known, moving: Known, kind: str, n: int, place: str) -> dict[str, Any]:
    """Phi of a model in steps, or the dynamics and relations of a nonlinear one."""
    if kind == "Phi":
        return {"Phi": read_square(model["Phi"], moving, join_place(place, "Phi"), n, "one per state")}
    if kind == "F":
        return {}
    there = join_place(place, "relations")
    relations = as_list(model["relations"], there, "a list of equations") if "relations" in model else []
    dynamics = require_key(model, "dynamics", place)
    return {
        "dynamics": read_vector(dynamics, driven, join_place(place, "dynamics"), n, "one per state"),
        "relations": tuple(read_relation(text, moving, join_place(there, i)) for i, text in enumerate(relations)),
    }


def read_relation(text: Any, moving: Known, where: str) -> Expr:
    """left - right of an equation between the states."""
    sides = as_text(text, where, 'an equation such as "q0**2 + q1**2 = 1"').split("=")
    if len(sides) != 2:
        message = f"expected one equation; got {quote(text)}; write both sides with one = between them"
        raise DomainError(message, where=where)
    return parse(sides[0], moving, where=where) - parse(sides[1], moving, where=where)


def read_rates(document: Table, moving: Known, parameters: Mapping[str, Parameter], where: str) -> dict[str, Expr]:
    """The [rates] table: derivatives of parameters by the time; what ``--set`` fixes has none."""
    place = join_place(where, "rates")
    table = as_table(document.get("rates", {}), place)
    for name in table:
        if name not in moving or name == "t":
            hint = suggest_nearest(name, [known for known in moving if known != "t"])
            message = f"expected a declared parameter; got {quote(name)}; declare it: {hint}"
            raise UnknownSymbolError(message, where=place)
        if name not in parameters:
            message = f"expected a parameter that is left free; got a value for {name}, which moves; drop its rate"
            raise DomainError(message, where=place)
    return {name: read_entry(value, moving, join_place(place, name)) for name, value in table.items()}


def read_inputs(
    document: Table, moving: Known, states: tuple[str, ...], n: int, where: str
) -> dict[str, tuple[Expr, ...]]:
    """The [inputs] table: a column of n entries for each unknown input, or "unknown" where dynamics name it."""
    place = join_place(where, "inputs")
    table = as_table(document.get("inputs", {}), place)
    if table and "piece" in document:
        raise DuplicateError("expected [inputs] or [[piece]]; got both; remove one of them", where=place)
    found = {}
    for name, value in table.items():
        here = join_place(place, name)
        if check_name(name, where=here) in (*moving, *states, "t"):
            raise DuplicateError(f"expected a name of its own; got {quote(name)}; rename the input", where=here)
        if not n and value != "unknown":
            raise DomainError(f'expected "unknown"; got {quote(value)}; name the input in dynamics', where=here)
        found[name] = read_vector(value, moving, here, n, "one per state") if n else ()
    return found


def read_ranges(
    document: Table, states: tuple[str, ...], parameters: Mapping[str, Parameter], where: str
) -> dict[str, tuple[Expr, Expr]]:
    """The [ranges] table: what the inputs of exported code may be; two exact numbers for each."""
    place, names = join_place(where, "ranges"), (*states, *parameters, STEP)
    said = as_table(document.get("units", {}), join_place(where, "units"))
    units = {n: u if isinstance(u, Mapping) else {"unit": u} for n, u in said.items()}
    found = {}
    for name, value in as_table(document.get("ranges", {}), place).items():
        here = join_place(place, name)
        if name not in names:
            hint = suggest_nearest(name, names)
            raise UnknownSymbolError(
                f"expected a state, a parameter or dt; got {quote(name)}; correct it: {hint}", where=here
            )
        unit = parameters[name].unit if name in parameters else declared_unit(name, units)
        low, high = read_range(value, here, unit)
        if name == STEP:
            require_positive(low, "the least step", here)
        found[name] = (low, high)
    return found


def read_names(value: Any, where: str) -> tuple[str, ...]:
    """Distinct declared names, in order."""
    items = as_list(value, where, "a list of names")
    names = tuple(check_name(name, where=join_place(where, i)) for i, name in enumerate(items))
    require_distinct(names, where)
    return names


def read_interval(document: Table, known: Known, where: str) -> Expr | None:
    """T of the [interval] table, above zero; None when the file has none."""
    if "interval" not in document:
        return None
    table = as_table(document["interval"], where)
    expect_keys(table, ("T",), where)
    T = read_entry(require_key(table, "T", where), known, join_place(where, "T"))
    require_positive(T, "a length of time T", join_place(where, "T"))
    return T


def read_pieces(document: Table, model: Table, moving: Known, n: int, T: Expr | None, where: str) -> tuple[Piece, ...]:
    """F of [model], or the [[piece]] blocks in order and without gaps."""
    place, why = join_place(where, "piece"), "one per state"
    if "piece" not in document:
        F = require_key(model, "F", join_place(where, "model"))
        return (Piece(ZERO, T, read_square(F, moving, join_place(where, "model.F"), n, why)),)
    if "F" in model:
        raise DuplicateError("expected F or [[piece]]; got both; remove one of them", where=place)
    blocks = as_list(document["piece"], place, "[[piece]] blocks")
    pieces = tuple(read_piece(block, moving, n, join_place(place, i)) for i, block in enumerate(blocks))
    ends = [ZERO, *(piece.end for piece in pieces)]
    for i, piece in enumerate(pieces):
        if piece.start != ends[i]:
            message = f"expected a start at {cut_text(ends[i])}; got {cut_text(piece.start)}; close the gap"
            raise DomainError(message, where=join_place(join_place(place, i), "from"))
    if T is not None and ends[-1] != T:
        message = f"expected the last piece to end at T = {cut_text(T)}; got {cut_text(ends[-1])}; correct it"
        raise DomainError(message, where=join_place(join_place(place, len(pieces) - 1), "to"))
    return pieces


def read_piece(block: Any, moving: Known, n: int, where: str) -> Piece:
    """One [[piece]] block."""
    table = as_table(block, where)
    expect_keys(table, ("from", "to", "F"), where)
    fixed = {name: value for name, value in moving.items() if name != "t"}
    start = read_entry(require_key(table, "from", where), fixed, join_place(where, "from"))
    end = read_entry(require_key(table, "to", where), fixed, join_place(where, "to"))
    require_order(start, end, where)
    F = read_square(require_key(table, "F", where), moving, join_place(where, "F"), n, "one per state")
    return Piece(start, end, F)


def read_measurements(document: Table, moving: Known, n: int, where: str) -> tuple[Measurement, ...]:
    """The [[measurement]] blocks, with distinct names; rows h of n entries, formulas z where n is 0."""
    place = join_place(where, "measurement")
    blocks = as_list(require_key(document, "measurement", where), place, "[[measurement]] blocks")
    found = []
    for i, block in enumerate(blocks):
        here = join_place(place, i)
        table = as_table(block, here)
        key = "h" if n else "z"
        expect_keys(table, ("name", key, "sigma"), here)
        name = as_label(table.get("name", f"z{i + 1}"), join_place(here, "name"))
        value, there = require_key(table, key, here), join_place(here, key)
        h = read_vector(value, moving, there, n, "one per state") if n else ()
        z = None if n else read_entry(value, moving, there)
        fixed = {key: value for key, value in moving.items() if key != "t"}
        sigma = read_entry(table.get("sigma", 1), fixed, join_place(here, "sigma"))
        require_positive(sigma, "a standard deviation", join_place(here, "sigma"))
        found.append(Measurement(name, h, sigma, z))
    require_distinct((measurement.name for measurement in found), place)
    return tuple(found)


def read_blocks(document: Table, names: list[str], where: str) -> tuple[NoiseBlock, ...]:
    """The [[block]] tables: measurements of the model, each in one block at most."""
    place, found, free = join_place(where, "block"), [], list(names)
    blocks = as_list(document["block"], place, "[[block]] tables") if "block" in document else []
    for i, block in enumerate(blocks):
        here = join_place(place, i)
        table = as_table(block, here)
        expect_keys(table, ("measurements", "norm", "shape"), here)
        there = join_place(here, "measurements")
        members = as_list(require_key(table, "measurements", here), there, "a list of names")
        for name in members:
            if name not in free:
                message = f"expected a measurement in one block; got {quote(name)}; name one of {', '.join(free)}"
                raise UnknownSymbolError(message, where=there)
            free.remove(name)
        norm, n = table.get("norm", "l2"), len(members)
        if norm not in NORMS or ("shape" in table and norm != "l2"):
            got = quote(norm) + (" with a shape" if "shape" in table else "")
            message = f'expected "l2", which may have a shape, "l1" or "linf"; got {got}; choose one'
            raise DomainError(message, where=join_place(here, "norm"))
        there = join_place(here, "shape")
        rows = table.get("shape", [["1" if j == k else "0" for k in range(n)] for j in range(n)])
        shape = read_square(rows, {}, there, n, "one per measurement of the block")
        minors = [shape[:k, :k].det() for k in range(1, n + 1) if all(e.is_Rational for e in shape)]
        if len(minors) < max(n, 1) or shape != shape.T or min(minors) <= 0 or any(shape[k, k] != 1 for k in range(n)):
            message = (
                "expected a symmetric positive definite matrix of fractions with ones on its diagonal; got another"
            )
            raise DomainError(f"{message}; divide it by the sigmas", where=there)
        found.append(NoiseBlock(tuple(members), norm, shape))
    return tuple(found)
