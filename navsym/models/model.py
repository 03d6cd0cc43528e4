"""Models of the front door: a linear system, or regressors, with measurements, an interval and targets."""

from __future__ import annotations

import html
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import sympy as sp

from navsym.claims.display import count_in_words, display_latex, latex_of, write_card
from navsym.core.errors import DomainError, DuplicateError, EmptyError, NavsymError, ShapeError
from navsym.language.declarations import Parameter, read_parameters, symbols_of
from navsym.language.expression import parse, symbol, to_text
from navsym.language.files import write_text
from navsym.language.names import join_place, quote, require_path, require_table
from navsym.language.shapes import KINDS
from navsym.language.tomlfile import read_toml, toml_text
from navsym.language.values import declared_unit, read_assumptions, write_declaration, write_entries, write_value
from navsym.language.vectors import is_wide
from navsym.models.linear import LinearModel, linear_row
from navsym.models.meaning import UNCHECKED
from navsym.models.modelfile import BasisFile, ModelFile, linear_model, model_from, need_fixed, read_model

#: Keys of a model file -> the arguments that write them, for the place of an error.
PLACES = (
    (r"^Model: (model|basis|parameters)\.", "Model: "),
    (r"^Model: measurement\[(\d+)\]\.[hz]", r"Model: H[\1]"),
    (r"^Model: measurement\[(\d+)\]\.sigma", r"Model: sigma[\1]"),
    (r"^Model: measurement\[(\d+)\]\.name", r"Model: measurements[\1]"),
    (r"^Model: measurement$", "Model: measurements"),
    (r"^Model: piece$", "Model: pieces"),
    (r"^--set ", "Model: values."),
    (r"^Model: interval\.T", "Model: interval"),
    (r"^Model: (piece|block)\[", r"Model: \1s["),
)


@dataclass(frozen=True, init=False, repr=False, eq=False)
class Model:
    """A linear system ``dx/dt = F x`` with measurements ``z_j = h_j x + r_j`` on [0, T].

    states       : n names, in one text or a list
    F            : (n, n) the matrix of the system; may contain parameters and the time t
    H            : (p, n) one row per measurement, or a formula of the states in place of a row; may contain t
    sigma        : (p,) bounds of the standard deviations of r_j, in the units of z_j; one for all, by default "1"
    interval     : T, the length of the interval: a number, or the name of a parameter
    targets      : name -> n entries, or a formula of the states: functionals of x(T); by default every state
    measurements : p names, by default z1, z2, ...
    pieces       : (from, to, F) in order, where F differs from piece to piece
    dynamics     : f, one formula per state, in place of F: ``dx/dt = f(x)``; H then holds formulas z of the states
    Phi          : (n, n) in place of F: a model in steps, ``x_(k+1) = Phi x_k``; for ``observe`` only
    relations    : equations between the states that hold always, such as ``q0**2 + q1**2 = 1``; with dynamics
    rates        : parameter -> its derivative by the time, for parameters that move; for ``observe`` only
    inputs       : unknown input -> its column of n entries, or "unknown" where dynamics name it; for ``observe`` only
    ranges       : state, parameter or ``dt`` -> two ends, what the inputs of exported code may be; for ``export`` only
    blocks       : tables of measurements whose errors are bounded together: ``{"measurements": "z1 z2", "norm": "l2"}``
    units        : state, measurement, input or t -> its unit, or ``{"unit": "m/s", "frame": "n"}``; seconds by default
    parameters   : name -> declaration; keywords that remain mean the same

    Entries are text of the language of files, ints, Fractions, sympy expressions, or matrices and integer arrays
    of them. A parameter is declared by a range ``("0", "2*pi")`` or by "real", "positive", "nonnegative", "nonzero";
    an undeclared symbol of sympy has the sign that sympy knows.
    Arguments and model files are read by the same reader, with the same limits.

    Raises NavsymError; ``where`` names the argument. A float raises DomainError with its exact spelling.

    >>> import navsym as nav
    >>> model = nav.Model(states="y1 y2 y3", F=[["0", "-1", "0"], ["0", "0", "1"], ["0", "-1", "0"]],
    ...                   H=[["1", "0", "0"]], sigma=["1"], interval="T", targets={"drift": "y3"}, T=("0", "2*pi"))
    >>> model
    Model(model: 3 states y1, y2, y3; 1 measurement; on [0, T]; target drift; parameter T)
    >>> model.F
    Matrix([
    [0, -1, 0],
    [0,  0, 1],
    [0, -1, 0]])
    >>> nav.Model(states="x v", F=[[0, 1], [0, 0]], H=["x"], interval=0.5)
    Traceback (most recent call last):
    navsym.core.errors.DomainError: Model: interval: expected an exact number; got the float 0.5; ...
    """

    _document: Mapping[str, Any]
    _contents: ModelFile | BasisFile

    def __init__(
        self,
        states: str | Sequence[str] | None = None,
        F: Any = None,
        H: Any = None,
        sigma: Any = 1,
        interval: Any = None,
        targets: Mapping[str, Any] | None = None,
        *,
        measurements: str | Sequence[str] | None = None,
        pieces: Sequence[Any] | None = None,
        dynamics: Any = None,
        Phi: Any = None,
        relations: Any = None,
        rates: Mapping[str, Any] | None = None,
        inputs: Mapping[str, Any] | None = None,
        ranges: Mapping[str, Any] | None = None,
        blocks: Sequence[Mapping[str, Any]] = (),
        units: Mapping[str, Any] | None = None,
        name: str = "model",
        parameters: Mapping[str, Any] | None = None,
        **declared: Any,
    ):
        with places_of_arguments():
            names = name_list(states, "Model: states")
            formulas = (F, H, sigma, interval, targets, pieces, dynamics, rates, Phi, inputs)
            unknown = require_table(inputs, "Model: inputs")
            declarations = declarations_of(parameters, declared, formulas, {*names, *unknown, "t"})
            document: dict[str, Any] = {"model": {"name": name, "states": names}}
            for key, value in (("F", F), ("Phi", Phi), ("dynamics", dynamics)):
                if value is not None:
                    document["model"][key] = write_entries(value, f"Model: {key}")
            if relations is not None:
                document["model"]["relations"] = relations
            document["units"] = dict(require_table(units, "Model: units"))
            document["parameters"] = declarations
            for key, table in (("rates", rates), ("inputs", inputs), ("ranges", ranges)):
                if table is not None:
                    rows = require_table(table, f"Model: {key}").items()
                    own = {**document["units"], **declarations} if key == "ranges" else {}
                    document[key] = {
                        n: write_entries(value, f"Model: {key}.{n}", declared_unit(n, own)) for n, value in rows
                    }
            linear = names if dynamics is None else None
            document["measurement"] = measurement_blocks(H, sigma, measurements, linear, declarations)
            if not isinstance(blocks, list | tuple):
                raise ShapeError(f"expected a list of tables; got {quote(blocks)}; give a list", where="Model: blocks")
            document["block"] = [block_table(block, f"Model: blocks[{k}]") for k, block in enumerate(blocks)]
            if pieces is not None:
                document["piece"] = piece_blocks(pieces)
            if interval is not None:
                document["interval"] = {"T": write_value(interval, "Model: interval")}
            if targets is not None:
                document["targets"] = target_rows(targets, names, declarations)
            self._fill(document)

    def _fill(self, document: Mapping[str, Any], where: str = "Model") -> None:
        """Read the document; empty tables are left out of it."""
        full = {table: content for table, content in document.items() if content or table == "targets"}
        object.__setattr__(self, "_contents", model_from(full, where))
        object.__setattr__(self, "_document", full)

    @classmethod
    def from_document(cls, document: Mapping[str, Any], where: str = "Model") -> Model:
        """The model of a document: the tables of a model file as plain data.

        Raises the errors of a model file; ``where`` stands before the key.
        """
        if not isinstance(document, Mapping):
            got = quote(document)
            raise ShapeError(f"expected the tables of a model file; got {got}; give a dict", where=where)
        model = object.__new__(cls)
        model._fill(copy_as_texts(document), where)
        return model

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Model:
        """The model of a model file (TOML).

        Raises NavsymError with the file and the key; kind ``missing-file`` where there is none.
        """
        document = read_toml(require_path(path, "Model.load: path"))
        return cls.from_document(document, os.fspath(path))

    @classmethod
    def from_basis(
        cls,
        H: Any,
        interval: Any = (0, 1),
        sigma: Any = 1,
        targets: Mapping[str, Any] | None = None,
        *,
        variable: str = "s",
        name: str = "basis",
        parameters: Mapping[str, Any] | None = None,
        **declared: Any,
    ) -> Model:
        """Regressors without a system: ``z_j(s) = H_j(s) q + r_j``.

        H        : (m,) one function of the variable per unknown, or (p, m) with one row per measurement
        interval : start and end of the variable
        sigma    : bounds of the standard deviations of r_j, one per measurement or one for all
        targets  : name -> m entries, or a formula of the unknowns c0, c1, ...; by default every unknown

        Raises the errors of :class:`Model`.

        >>> import navsym as nav
        >>> nav.Model.from_basis(["1", "s", "s**2"], interval=(0, 1), targets={"curvature": "2*c2"})
        Model(basis: 3 unknowns c0, c1, c2; 1 measurement; s from 0 to 1; target curvature)
        """
        with places_of_arguments():
            rows = write_entries(H, "Model: H")
            nested = rows if isinstance(rows, list) and rows and isinstance(rows[0], list) else [rows]
            declarations = declarations_of(parameters, declared, (H, sigma, interval, targets), {variable})
            basis = {"name": name, "variable": variable, "H": rows}
            basis["sigma"] = one_for_each(sigma, len(nested), "Model: sigma")
            basis["interval"] = write_entries(interval, "Model: interval")
            document = {"basis": basis, "parameters": declarations}
            if targets is not None:
                unknowns = [f"c{k}" for k in range(len(nested[0]))]
                document["targets"] = target_rows(targets, unknowns, declarations)
            return cls.from_document(document)

    @classmethod
    def from_linear(
        cls,
        linear: LinearModel,
        sigma: Any = 1,
        interval: Any = None,
        targets: Mapping[str, Any] | None = None,
        *,
        name: str = "model",
        parameters: Mapping[str, Any] | None = None,
        **declared: Any,
    ) -> Model:
        """The model of a :class:`LinearModel` without process noise; arguments as for :class:`Model`.

        Parameters that are not declared are declared as their symbols are. A blank in a name becomes an underscore,
        because the files that hold a model name states without blanks.

        Raises DomainError for process noise, and the errors of :class:`Model`.
        """
        if linear.G.cols:
            got = f"G with {linear.G.cols} columns"
            raise DomainError(f"expected a model without process noise; got {got}; drop G", where="Model: linear")
        time = {linear.time: symbol("t")}
        states, measurements = (
            ["_".join(text.split()) for text in names] for names in (linear.states, linear.measurements)
        )
        return cls(
            states,
            linear.F.subs(time),
            linear.H.subs(time),
            sigma,
            interval,
            targets,
            measurements=measurements,
            name=name,
            parameters=parameters,
            **declared,
        )

    @classmethod
    def from_contents(cls, contents: ModelFile | BasisFile) -> Model:
        """The model of what was read from a model file."""
        model = object.__new__(cls)
        object.__setattr__(model, "_contents", contents)
        object.__setattr__(model, "_document", document_of(contents))
        return model

    def document(self) -> dict[str, Any]:
        """The tables of a model file as plain data; every entry is text."""
        return copy_as_texts(self._document)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a model file (TOML) that reads back to the same model.

        Raises OutputError where the file cannot be written.
        """
        write_text(require_path(path, "Model.save: path"), toml_text(self._document))

    def read(self, values: Mapping[str, Any] | None = None) -> ModelFile | BasisFile:
        """The exact contents, with values put in for some parameters.

        values : parameter -> exact number, inside its declaration; ``"90 min"`` and quantities of pint are converted to
                 the unit that is declared, else to SI

        Raises UnknownSymbolError for a name that is no parameter, DomainError for a value outside.
        """
        if not values:
            return self._contents
        with places_of_arguments():
            return model_from(self._document, "Model", values, is_known=True)

    def with_values(self, **values: Any) -> Model:
        """The model with exact values in place of some parameters.

        >>> import navsym as nav
        >>> swing = nav.Model("x v", F=[["0", "1"], ["-w**2", "0"]], H=["x"], interval="T", w="positive", T="positive")
        >>> swing.with_values(w="1/2").document()["model"]["F"]
        [['0', '1'], ['-1/4', '0']]
        """
        return Model.from_contents(self.read(values)) if values else self

    def linear(self, values: Mapping[str, Any] | None = None) -> LinearModel:
        """The system as a :class:`LinearModel`.

        Raises ShapeError for a system in pieces, DomainError for regressors.
        """
        return linear_model(self._system(values))

    def _system(self, values: Mapping[str, Any] | None = None) -> ModelFile:
        """The contents where they are a system; DomainError for regressors."""
        contents = self.read(values)
        if isinstance(contents, ModelFile):
            return contents
        message = "expected a model with F and H; got a basis of regressors; give the system"
        raise DomainError(message, where="Model")

    @property
    def name(self) -> str:
        """Name of the model."""
        return self._contents.name

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the n states; of the unknowns c0, c1, ... where regressors are given."""
        contents = self._contents
        return contents.states if isinstance(contents, ModelFile) else tuple(f"c{k}" for k in range(len(contents.H[0])))

    @property
    def measurements(self) -> tuple[str, ...]:
        """Names of the p measurements."""
        contents = self._contents
        if isinstance(contents, ModelFile):
            return tuple(measurement.name for measurement in contents.measurements)
        return tuple(f"z{j + 1}" for j in range(len(contents.H)))

    @property
    def F(self) -> sp.ImmutableMatrix:
        """Matrix of the system (n, n). Raises ShapeError for pieces, DomainError for regressors."""
        return self._system().F

    @property
    def H(self) -> sp.ImmutableMatrix:
        """Rows of the measurements (p, n). Raises DomainError beside dynamics."""
        contents = self._contents
        if isinstance(contents, ModelFile) and contents.dynamics:
            need_fixed(contents, "Model")
        rows = [m.h for m in contents.measurements] if isinstance(contents, ModelFile) else contents.H
        return sp.ImmutableMatrix(rows)

    @property
    def sigma(self) -> tuple[sp.Expr, ...]:
        """Bounds of the standard deviations (p,), in the units of the measurements."""
        contents = self._contents
        return tuple(m.sigma for m in contents.measurements) if isinstance(contents, ModelFile) else contents.sigma

    @property
    def T(self) -> sp.Expr | None:
        """Length of the interval; None where the model states none, the end of the variable for regressors."""
        contents = self._contents
        return contents.T if isinstance(contents, ModelFile) else contents.interval[1]

    @property
    def targets(self) -> dict[str, tuple[sp.Expr, ...]]:
        """Name -> functional of x(T), one entry per state."""
        return dict(self._contents.targets)

    @property
    def parameters(self) -> dict[str, Parameter]:
        """Name -> declared parameter."""
        return dict(self._contents.parameters)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Model) and self._document == other._document

    def __hash__(self) -> int:
        return hash(toml_text(self._document))

    def __repr__(self) -> str:
        contents = self._contents
        kind = "states" if isinstance(contents, ModelFile) else "unknowns"
        parts = [list_names(kind, self.states), count_in_words(len(self.measurements), "measurement")]
        if isinstance(contents, BasisFile):
            start, end = contents.interval
            parts.append(f"{contents.variable} from {to_text(start)} to {to_text(end)}")
        elif contents.T is not None:
            parts.append(f"on [0, {to_text(contents.T)}]")
        parts += [
            list_names(word, names)
            for word, names in (("target", self.targets), ("parameter", self.parameters))
            if names
        ]
        return f"Model({contents.name}: {'; '.join(parts)})"

    def _repr_latex_(self) -> str:
        """The equations of the model, for notebooks."""
        return display_latex(r", \qquad ".join(equations_latex(self._contents)))

    def _repr_html_(self) -> str:
        """A card for notebooks: name, equations, parameters and targets."""
        lines = [f"<b>{html.escape(self.name)}</b>: {html.escape(', '.join(self.states))}"]
        lines += [html.escape(display_latex(latex)) for latex in equations_latex(self._contents)]
        return write_card([*lines, html.escape(repr(self))])


def contents_of(
    model: Any, values: Mapping[str, Any] | None, parameters: Mapping[str, Any], where: str
) -> ModelFile | BasisFile:
    """The contents that an argument means, with values of its parameters.

    model              : a Model, a LinearModel, contents of a model file, its document, or its path
    values, parameters : parameter -> exact value; a name stands in one of them only
    where              : name of the function of the front door, for errors
    """
    values = require_table(values, f"{where}: values")
    twice = next((name for name in parameters if name in values), None)
    if twice is not None:
        raise DuplicateError(f"expected one value; got two of {twice}; give one", where=f"{where}: {twice}")
    given = {**values, **parameters}
    try:
        if isinstance(model, str | os.PathLike):
            found = read_model(model, given)
        else:
            found = as_model(model, f"{where}: model").read(given)
        if where != "observe":
            need_fixed(found, f"{where}: model")
        return found
    except NavsymError as error:
        for start in ("Model: values.", "--set "):
            error.where = error.where.replace(start, f"{where}: ", 1) if error.where.startswith(start) else error.where
        raise


def as_model(value: Any, where: str) -> Model:
    """The model that an argument means; ``where`` names it in errors."""
    if isinstance(value, Model):
        return value
    if isinstance(value, LinearModel):
        return Model.from_linear(value)
    if isinstance(value, ModelFile | BasisFile):
        return Model.from_contents(value)
    if isinstance(value, Mapping):
        return Model.from_document(value, where)
    if isinstance(value, str | os.PathLike):
        return Model.load(value)
    message = f"expected a model, or the path of a model file; got {quote(value)}; make one with navsym.Model"
    raise DomainError(message, where=where)


# Arguments to tables of a model file


@contextmanager
def places_of_arguments() -> Iterator[None]:
    """Errors of the reader name the argument in place of the key of a file."""
    try:
        yield
    except NavsymError as error:
        for pattern, argument in PLACES:
            error.where = re.sub(pattern, argument, error.where)
        raise


def name_list(names: Any, where: str) -> list[Any]:
    """Names from one text with blanks or commas between them, or from a list; symbols by their names."""
    if names is None:
        raise EmptyError('expected names; got none; write them in one text: "x v"', where=where)
    if isinstance(names, str):
        return names.replace(",", " ").split()
    if not isinstance(names, list | tuple) or any(isinstance(name, list | dict) for name in names):
        raise ShapeError(f'expected names; got {quote(names)}; write them in one text: "x v"', where=where)
    return [item.name if isinstance(item, sp.Symbol) else item for item in names]


def declarations_of(
    parameters: Any, declared: Mapping[str, Any], formulas: Sequence[Any], others: set[Any]
) -> dict[str, Any]:
    """The [parameters] table: what the caller declares, and the assumptions of further symbols of sympy.

    formulas : arguments that may hold expressions of sympy; ``others`` are the names in them that are no parameters
    """
    if not isinstance(parameters, Mapping | None):
        message = f"expected name -> declaration; got {quote(parameters)}; write keywords or a dict"
        raise ShapeError(message, where="Model: parameters")
    given = {**(parameters or {}), **declared}
    words = read_assumptions([list(f.values()) if isinstance(f, Mapping) else f for f in formulas], "Model")
    table = {name: write_declaration(value, f"Model: {name}") for name, value in given.items()}
    for name, word in words.items():
        if name in table and word != "real":
            need_sign(name, word, table[name])
        elif name not in others:
            table.setdefault(name, word)
    return table


def need_sign(name: str, word: str, declaration: Any) -> None:
    """DomainError where sympy has simplified by a sign that the declaration does not grant."""
    symbol = known_symbols({name: declaration})[name]
    granted = {"positive": symbol.is_nonnegative, "nonnegative": symbol.is_nonnegative, "nonzero": symbol.is_nonzero}
    if not granted[word]:
        got = f"a symbol of sympy that is {word}, declared {declaration}"
        raise DomainError(f"expected one declaration; got {got}; declare both alike", where=f"Model: {name}")


def measurement_blocks(
    H: Any, sigma: Any, measurements: Any, states: Sequence[str] | None, declared: Mapping[str, Any]
) -> list[dict[str, Any]]:
    """The [[measurement]] blocks: rows h, or formulas z where no states are given."""
    if H is None:
        raise EmptyError("expected H with one row per measurement; got none; give H=[[…]]", where="Model: H")
    rows = write_entries(H, "Model: H")
    rows = rows if isinstance(rows, list) else [rows]
    sigmas = one_for_each(sigma, len(rows), "Model: sigma")
    names = [f"z{k + 1}" for k in range(len(rows))]
    if measurements is not None:
        names = name_list(measurements, "Model: measurements")
    if len(names) != len(rows):
        message = f"expected {len(rows)} names, one per row of H; got {len(names)}; name each once"
        raise ShapeError(message, where="Model: measurements")
    if states is None:
        return [{"name": name, "z": row, "sigma": bound} for name, row, bound in zip(names, rows, sigmas, strict=True)]
    known = {**known_symbols(declared), "t": symbol("t")}
    return [
        {"name": name, "h": read_row(row, states, known, f"Model: H[{k}]"), "sigma": bound}
        for k, (name, row, bound) in enumerate(zip(names, rows, sigmas, strict=True))
    ]


def one_for_each(value: Any, count: int, where: str) -> list[str]:
    """One text per measurement; a single value is that of all."""
    values = write_entries(value, where)
    if not isinstance(values, list):
        return [values] * count
    if len(values) != count:
        raise ShapeError(
            f"expected {count} entries, one per measurement; got {len(values)}; complete them", where=where
        )
    return values


def piece_blocks(pieces: Any) -> list[dict[str, Any]]:
    """The [[piece]] blocks."""
    if not isinstance(pieces, list | tuple):
        message = f"expected a list of (from, to, F); got {quote(pieces)}; give them in order"
        raise ShapeError(message, where="Model: pieces")
    return [piece_block(piece, f"Model: pieces[{k}]") for k, piece in enumerate(pieces)]


def block_table(block: Any, where: str) -> dict[str, Any]:
    """One [[block]] table: names of measurements, a norm, and perhaps a shape."""
    if not isinstance(block, Mapping):
        message = f'expected a table; got {quote(block)}; write {{"measurements": "z1 z2", "norm": "l2"}}'
        raise ShapeError(message, where=where)
    words = {key: value for key, value in block.items() if key not in ("measurements", "shape")}
    if "measurements" in block:
        words["measurements"] = name_list(block["measurements"], f"{where}.measurements")
    return words | ({"shape": write_entries(block["shape"], f"{where}.shape")} if "shape" in block else {})


def piece_block(piece: Any, where: str) -> dict[str, Any]:
    """One [[piece]] block from (from, to, F), or from a table with these keys."""
    if isinstance(piece, Mapping):
        return {key: write_entries(value, join_place(where, key)) for key, value in piece.items()}
    if not isinstance(piece, list | tuple) or len(piece) != 3:
        raise ShapeError(f"expected (from, to, F); got {quote(piece)}; give all three", where=where)
    keys = ("from", "to", "F")
    return {key: write_entries(value, join_place(where, key)) for key, value in zip(keys, piece, strict=True)}


def target_rows(targets: Mapping[str, Any], states: Sequence[str], declared: Mapping[str, Any]) -> dict[str, Any]:
    """The [targets] table: rows of entries, or formulas of the states."""
    if not isinstance(targets, Mapping):
        message = f'expected name -> functional; got {quote(targets)}; write {{"{states[0]}": "{states[0]}"}}'
        raise ShapeError(message, where="Model: targets")
    known = known_symbols(declared)
    rows = {}
    for name, row in targets.items():
        where = join_place("Model: targets", name)
        rows[name] = read_row(write_entries(row, where), states, known, where)
    return rows


def read_row(row: Any, states: Sequence[str], known: Mapping[str, sp.Symbol], where: str) -> Any:
    """A row of texts as it is, and so a text of vectors and matrices; a formula of the states as its coefficients."""
    if not isinstance(row, str) or is_wide(row) or any("[" in str(name) for name in states):
        return row
    symbols = {name: symbol(name, where=where) for name in states}
    formula = parse(row, {**known, **symbols}, where=where)
    return [to_text(entry) for entry in linear_row(formula, list(symbols.values()), where)]


def known_symbols(declared: Mapping[str, Any]) -> dict[str, sp.Symbol]:
    """The declared parameters as symbols."""
    tables = {name: value for name, value in declared.items() if isinstance(value, Mapping)}
    signs = {name: value.get("sign", "real") for name, value in tables.items() if not value.keys() & {*KINDS}}
    numbers = {name: value for name, value in declared.items() if name not in tables} | signs
    return symbols_of(read_parameters(numbers, "Model: parameters"))


# Contents to tables of a model file


def document_of(contents: ModelFile | BasisFile) -> dict[str, Any]:
    """The tables of a model file that reads back to these contents."""
    parameters = {p.name: declaration_of(p) for p in contents.parameters.values()}
    targets = {name: [to_text(entry) for entry in row] for name, row in contents.targets.items()}
    if isinstance(contents, BasisFile):
        basis = {
            "name": contents.name,
            "variable": contents.variable.name,
            "H": [[to_text(entry) for entry in row] for row in contents.H],
            "sigma": [to_text(bound) for bound in contents.sigma],
            "interval": [to_text(end) for end in contents.interval],
        }
        tables: dict[str, Any] = {"basis": basis, "parameters": parameters, "targets": targets}
        return {table: content for table, content in tables.items() if content}
    tables = {"model": {"name": contents.name, "states": list(contents.states)}, "parameters": parameters}
    tables["units"] = UNCHECKED if any(p.unit for p in contents.parameters.values()) else {}
    tables["rates"] = {name: to_text(rate) for name, rate in contents.rates.items()}
    tables["inputs"] = {name: [*map(to_text, column)] or "unknown" for name, column in contents.inputs.items()}
    tables["measurement"] = [
        {"name": m.name, "sigma": to_text(m.sigma)}
        | ({"h": [to_text(entry) for entry in m.h]} if m.z is None else {"z": to_text(m.z)})
        for m in contents.measurements
    ]
    if contents.dynamics:
        tables["model"]["dynamics"] = [to_text(entry) for entry in contents.dynamics]
        if contents.relations:
            tables["model"]["relations"] = [f"{to_text(value)} = 0" for value in contents.relations]
    elif contents.Phi is not None:
        tables["model"]["Phi"] = write_entries(contents.Phi, "Phi")
    elif len(contents.pieces) == 1 and contents.pieces[0].end in (None, contents.T):
        tables["model"]["F"] = write_entries(contents.F, "F")
    else:
        tables["piece"] = [
            {"from": to_text(piece.start), "to": to_text(piece.end), "F": write_entries(piece.F, "F")}
            for piece in contents.pieces
        ]
    tables["block"] = [
        {"measurements": list(block.names), "norm": block.norm}
        | ({"shape": write_entries(block.shape, "shape")} if block.norm == "l2" else {})
        for block in contents.blocks
    ]
    tables["interval"] = {} if contents.T is None else {"T": to_text(contents.T)}
    tables["targets"] = targets
    tables["ranges"] = {name: [to_text(end) for end in ends] for name, ends in contents.ranges.items()}
    return {table: content for table, content in tables.items() if content}


def declaration_of(parameter: Parameter) -> Any:
    """A range as two texts, or the word; a table where it has a unit."""
    ranged = parameter.lower is not None and parameter.upper is not None
    plain = [to_text(parameter.lower), to_text(parameter.upper)] if ranged else parameter.kind
    return {"range" if ranged else "sign": plain, "unit": parameter.unit} if parameter.unit else plain


def copy_as_texts(value: Any) -> Any:
    """Plain data of our own: tables and lists copied, numbers of TOML as text; sizes stay numbers."""
    if isinstance(value, Mapping):
        return {key: item if key in ("vector", "matrix") else copy_as_texts(item) for key, item in value.items()}
    if isinstance(value, list):
        return [copy_as_texts(item) for item in value]
    return str(value) if isinstance(value, str) or type(value) is int else value


# Words and formulas for people


def list_names(word: str, names: Any) -> str:
    """``target drift``, ``3 states y1, y2, y3``; long lists are cut."""
    names = list(names)
    text = ", ".join(names[:6]) + (", …" if len(names) > 6 else "")
    return f"{len(names)} {word} {text}" if word.endswith("s") else f"{word}{'s' if len(names) > 1 else ''} {text}"


def equations_latex(contents: ModelFile | BasisFile) -> list[str]:
    """Equations of the system and of its measurements in LaTeX, without dollar signs."""
    if isinstance(contents, BasisFile):
        rows = latex_of(sp.ImmutableMatrix(contents.H))
        return [rf"z({latex_of(contents.variable)}) = {rows} q + r"]
    if contents.dynamics:
        column, z = sp.ImmutableMatrix(contents.dynamics), sp.ImmutableMatrix([m.z for m in contents.measurements])
        return [rf"\frac{{d}}{{dt}} x = {latex_of(column)}", rf"z = {latex_of(z)} + r"]
    lines = [] if contents.Phi is None else [rf"x_{{k+1}} = {latex_of(contents.Phi)} x_k"]
    for piece in contents.pieces:
        where = ""
        if len(contents.pieces) > 1:
            where = rf", \quad {latex_of(piece.start)} \le t \le {latex_of(piece.end)}"
        lines.append(rf"\frac{{d}}{{dt}} x = {latex_of(piece.F)} x{where}")
    H = sp.ImmutableMatrix([list(m.h) for m in contents.measurements])
    sigma = sp.ImmutableMatrix([m.sigma for m in contents.measurements])
    return [*lines, rf"z = {latex_of(H)} x + r", rf"\sigma = {latex_of(sigma)}"]
