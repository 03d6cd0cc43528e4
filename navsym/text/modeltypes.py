"""What a model file says, as plain exact data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from navsym.errors import ShapeError
from navsym.text.expression import Expr, Matrix, Symbol
from navsym.text.parameters import Parameter, box_of

Targets = Mapping[str, tuple[Expr, ...]]


@dataclass(frozen=True, slots=True, eq=False)
class Measurement:
    """``z = h x + r`` with a standard deviation of r of at most sigma; h has one entry per state."""

    name: str
    h: tuple[Expr, ...]
    sigma: Expr


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """``dx/dt = F x`` from ``start`` to ``end`` (None: no end is given)."""

    start: Expr
    end: Expr | None
    F: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class ModelFile:
    """``dx/dt = F x`` with scalar measurements on [0, T].

    time         : the symbol t, which F and h may contain
    states       : n names
    pieces       : one piece for a constant (or continuously varying) F, otherwise one per stretch
    T            : length of the interval, None when the file has no [interval]
    targets      : name -> n expressions, a functional of the state at T
    """

    name: str
    parameters: Mapping[str, Parameter]
    states: tuple[str, ...]
    time: Symbol
    pieces: tuple[Piece, ...]
    measurements: tuple[Measurement, ...]
    T: Expr | None
    targets: Targets

    def _repr_latex_(self) -> str:
        """The matrix of the system, for notebooks."""
        return str(self.F._repr_latex_())

    @property
    def F(self) -> Matrix:
        """The matrix of a model in one piece. Raises ShapeError when there are several."""
        if len(self.pieces) != 1:
            message = f"expected one F; got {len(self.pieces)} pieces; do use a method that takes pieces"
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
