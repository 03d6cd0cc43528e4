"""Linear models: dx/dt = F x + G w, z = H x + r, with symbols for everything that is not a number.

A model is a value: sympy matrices without floating-point numbers, checked once. What follows
from a model (transition matrix, observability, regressors) are functions in the files beside.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import sympy as sp

from navsym.claims.display import display_latex, latex_of, latex_words
from navsym.core.errors import DomainError, DuplicateError, EmptyError, NotFiniteError, ShapeError

#: The independent variable of a model that is not told otherwise.
TIME = sp.Symbol("t", real=True)


@dataclass(frozen=True, slots=True, eq=False)
class LinearModel:
    """dx/dt = F x + G w,  z = H x + r.

    F            : (n, n) matrix of the system; may contain parameters and ``time``
    G            : (n, q) how the process noise w enters; no columns when there is none
    H            : (p, n) one row per scalar measurement
    states       : n different names
    measurements : p different names, by default z1, z2, ...
    time         : the symbol of the independent variable
    rates        : symbol -> its derivative along the motion, for those beside the time that move
    squares      : symbol -> its square, for a symbol that lies on a manifold such as q0^2 = 1 - q1^2

    Matrices may be given as nested lists of exact numbers and expressions; a missing F makes no
    model, a missing G means no process noise, a missing H no measurement.

    Raises ShapeError, EmptyError, DuplicateError, NotFiniteError and DomainError (floats).
    """

    F: sp.ImmutableMatrix
    G: Any = None  # sp.ImmutableMatrix once constructed
    H: Any = None
    states: tuple[str, ...] = ()
    measurements: tuple[str, ...] = ()
    time: sp.Symbol = TIME
    rates: Mapping[sp.Symbol, sp.Expr] = field(default_factory=dict)
    squares: Mapping[sp.Symbol, sp.Expr] = field(default_factory=dict)

    def __post_init__(self) -> None:
        F = need_square("F", self.F)
        n = F.rows
        G = sp.ImmutableMatrix.zeros(n, 0) if self.G is None else exact_matrix("G", self.G)
        H = sp.ImmutableMatrix.zeros(0, n) if self.H is None else exact_matrix("H", self.H)
        need_shape("G", G, (n, G.cols), "states by process noises")
        need_shape("H", H, (H.rows, n), "measurements by states")
        states = need_different("states", self.states or number_names("x", n), n, "states")
        measurements = need_different(
            "measurements", self.measurements or number_names("z", H.rows), H.rows, "measurements"
        )
        values = {"F": F, "G": G, "H": H, "states": states, "measurements": measurements}
        for name, value in values.items():
            object.__setattr__(self, name, value)

    @property
    def size(self) -> int:
        """Number of states."""
        return len(self.states)

    @property
    def constant(self) -> bool:
        """True when F and H contain neither the time nor a symbol that moves."""
        return not (self.F.free_symbols | self.H.free_symbols) & {self.time, *self.rates}

    @property
    def parameters(self) -> tuple[sp.Symbol, ...]:
        """Symbols of F, G, H other than the time, in the order of their names."""
        symbols = self.F.free_symbols | self.G.free_symbols | self.H.free_symbols
        return tuple(sorted(symbols - {self.time}, key=str))

    def _repr_latex_(self) -> str:
        """The equations of the model with named states, for notebooks."""
        states = r" \\ ".join(rf"\text{{{latex_words(name)}}}" for name in self.states)
        x = rf"\begin{{bmatrix}} {states} \end{{bmatrix}}"
        noise = rf" + {latex_of(self.G)} w" if self.G.cols else ""
        lines = [rf"\frac{{d}}{{d{latex_of(self.time)}}} x = {latex_of(self.F)} x{noise}"]
        lines += [rf"z = {latex_of(self.H)} x + r"] if self.H.rows else []
        return display_latex(r", \qquad ".join([*lines, rf"x = {x}"]))

    def at(self, values: Mapping[sp.Symbol, Any]) -> LinearModel:
        """The model with exact values or expressions put in for some of its parameters.

        This is how a degenerate case is reached: substitute first, then derive. Raises NotFiniteError at a pole.
        """
        exact = {symbol: exact_entry("value of", 0, 0, value) for symbol, value in values.items()}
        F, G, H = (matrix.subs(exact, simultaneous=True) for matrix in (self.F, self.G, self.H))
        rates = {symbol: rate.subs(exact, simultaneous=True) for symbol, rate in self.rates.items()}
        return LinearModel(F, G, H, self.states, self.measurements, self.time, rates, self.squares)


def exact_matrix(name: str, value: Any) -> sp.ImmutableMatrix:
    """A sympy matrix without floats and infinities; text is refused, so that nothing is parsed here."""
    if isinstance(value, sp.MatrixBase):
        rows = value.tolist()
    else:
        nested = isinstance(value, Sequence) and all(isinstance(r, Sequence) and not isinstance(r, str) for r in value)
        rows = [list(row) for row in value] if nested else [[value]]
    if len({len(row) for row in rows}) > 1:
        lengths = [len(row) for row in rows]
        raise ShapeError(f"{name}: expected rows of one length; got {lengths}; complete them")
    entries = [[exact_entry(name, i, j, entry) for j, entry in enumerate(row)] for i, row in enumerate(rows)]
    if isinstance(value, sp.MatrixBase):
        return sp.ImmutableMatrix(*value.shape, [entry for row in entries for entry in row])
    return sp.ImmutableMatrix(entries)


def exact_entry(name: str, i: int, j: int, entry: Any) -> sp.Expr:
    """One entry as a sympy expression, refused when it is a float, an infinity or text."""
    if isinstance(entry, sp.Rational):
        return entry
    if type(entry) is int:
        return sp.Integer(entry)
    place = f"{name}[{i}, {j}]"
    if isinstance(entry, str | float | complex) or (isinstance(entry, sp.Basic) and entry.has(sp.Float)):
        raise DomainError(
            f"{place}: expected an exact number or an expression; got {entry!r}; write sp.Rational(1, 10), not 0.1"
        )
    try:
        expression = sp.sympify(entry, strict=True)
    except sp.SympifyError:
        raise DomainError(f"{place}: expected a number or an expression; got {entry!r}; give one") from None
    if expression.has(sp.nan, sp.oo, -sp.oo, sp.zoo):
        raise NotFiniteError(f"{place}: expected a finite expression; got {expression}; remove it")
    return expression


def need_square(name: str, value: Any) -> sp.ImmutableMatrix:
    """An exact matrix with as many rows as columns, at least one."""
    matrix = exact_matrix(name, value)
    if matrix.rows == 0:
        raise EmptyError(f"{name}: expected a square matrix; got no rows; give one row per state")
    need_shape(name, matrix, (matrix.rows, matrix.rows), "one row and one column per state")
    return matrix


def need_shape(name: str, matrix: sp.ImmutableMatrix, shape: tuple[int, int], why: str) -> None:
    """ShapeError unless the matrix has the shape."""
    if matrix.shape != shape:
        raise ShapeError(f"{name}: expected shape {shape}, {why}; got {matrix.shape}; complete it")


def need_different(name: str, values: Iterable[Any], count: int, why: str) -> tuple[str, ...]:
    """Names as strings, as many as needed and no two alike."""
    names = tuple(str(value) for value in values)
    if len(names) != count:
        raise ShapeError(f"{name}: expected {count} names, one for each of the {why}; got {len(names)}")
    for place, name_ in enumerate(names):
        if name_ in names[:place]:
            raise DuplicateError(f"{name}: expected different names; got {name_!r} twice; rename one")
    return names


def number_names(letter: str, count: int) -> tuple[str, ...]:
    """Default names: the letter with 1, 2, ..."""
    return tuple(f"{letter}{place + 1}" for place in range(count))


def linear_row(formula: sp.Expr, states: Sequence[sp.Symbol], where: str) -> list[sp.Expr]:
    """Coefficients of the states in a formula that is linear in them; DomainError for any other formula."""
    expanded = formula.expand()
    row = [expanded.coeff(state) for state in states]
    rest = (expanded - sum(entry * state for entry, state in zip(row, states, strict=True))).expand()
    if rest != 0 or any(entry.free_symbols & set(states) for entry in row) or not any(row):
        message = "expected a sum of states times numbers and parameters; got another formula; make it linear"
        raise DomainError(message, where=where)
    return row


def observability_matrix(model: LinearModel) -> sp.ImmutableMatrix:
    """The rows H, H F + H', (H F + H') F + ..., n blocks of p rows: (n p, n).

    The state is determined by the measurements on any interval where its rank is n (for constant
    F and H exactly then). Kalman's matrix for a constant model, Silverman and Meadows otherwise.
    """
    blocks = [model.H]
    for _ in range(model.size - 1):
        last = blocks[-1]
        blocks.append((last * model.F + last.diff(model.time)).applyfunc(sp.expand))
    return sp.ImmutableMatrix.vstack(*blocks)
