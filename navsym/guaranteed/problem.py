"""The guaranteed estimation problem as exact data, from a model, from a basis, or by hand."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import sympy as sp
from flint import arb

from navsym.core.balls import enclose
from navsym.core.errors import DomainError, EmptyError, NotFiniteError, ShapeError, TooLargeError
from navsym.core.exact import to_fmpq
from navsym.guaranteed.certificate.enclosure import Panel, PanelProblem
from navsym.guaranteed.time_varying import (
    ERROR,
    error_bound,
    has_varying_system,
    integrate_steps,
    step_regressors,
    to_rational_interval,
)
from navsym.language.names import quote
from navsym.models.linear import LinearModel, exact_entry
from navsym.models.model import Model, contents_of
from navsym.models.modelfile import BasisFile, Measurement, ModelFile
from navsym.models.transition.exponential import regressors, transition_matrix

Rows = tuple[tuple[sp.Expr, ...], ...]
#: Measurements of a block with "l1", which becomes 2**(p - 1) single ones.
MOST_TOGETHER = 6


@dataclass(frozen=True, slots=True, eq=False)
class RegressorPiece:
    """Part of the interval on which the regressors are analytic: one row H_j(t) per measurement."""

    start: sp.Expr
    end: sp.Expr
    rows: Rows


@dataclass(frozen=True, slots=True, eq=False)
class GuaranteedProblem:
    """Minimise ``sum_j sigma_j integral |Phi_j|`` subject to ``sum_j integral H_j Phi_j = P``.

    stretches    : parts of the interval in order, with the regressors on each
    functional   : P, one exact entry per unknown
    sigma        : noise bound of each measurement
    variable     : t
    measurements : names
    target       : name of the functional
    error        : bound of the error of regressors that contain ERROR; zero when they are exact
    model        : the model whose regressors were integrated, None when they are exact

    Raises ShapeError, EmptyError, NotFiniteError and DomainError (no length, sigma <= 0, P = 0, free symbols).
    """

    stretches: tuple[RegressorPiece, ...]
    functional: tuple[sp.Expr, ...]
    sigma: tuple[sp.Expr, ...]
    variable: sp.Symbol
    measurements: tuple[str, ...] = ()
    target: str = "target"
    error: sp.Rational = sp.S.Zero
    model: ModelFile | None = None

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "functional", tuple(exact_entry("functional", 0, j, p) for j, p in enumerate(self.functional)))
        put(self, "sigma", tuple(exact_entry("sigma", 0, j, s) for j, s in enumerate(self.sigma)))
        names = self.measurements or tuple(f"z{j + 1}" for j in range(len(self.sigma)))
        put(self, "measurements", tuple(names))
        need_shapes(self)
        need_numbers(self)

    @property
    def interval(self) -> tuple[sp.Expr, sp.Expr]:
        """Start of the first stretch and end of the last."""
        return self.stretches[0].start, self.stretches[-1].end

    @property
    def unknown(self) -> dict[sp.Symbol, arb]:
        """A ball for the error of the regressors."""
        return {ERROR: arb(0, arb(to_fmpq(self.error)).upper())} if self.error else {}

    def exact(self) -> PanelProblem:
        """The same for the proofs: one panel per stretch and measurement, empty rows left out."""
        panels = [
            Panel(j, row, self.variable, stretch.start, stretch.end, self.sigma[j], self.unknown)
            for stretch in self.stretches
            for j, row in enumerate(stretch.rows)
        ]
        return PanelProblem(tuple(panels), self.functional)


def need_shapes(problem: GuaranteedProblem) -> None:
    """Refuse a problem whose parts do not fit.

    Raises EmptyError without unknowns, measurements or stretches, and ShapeError when a stretch is not n rows of m
    entries or the names are not n.
    """
    m, n = len(problem.functional), len(problem.sigma)
    if m == 0 or n == 0 or not problem.stretches:
        raise EmptyError("expected unknowns, measurements and an interval; got none; give at least one of each")
    for stretch in problem.stretches:
        sizes = {len(row) for row in stretch.rows}
        if len(stretch.rows) != n or sizes != {m}:
            raise ShapeError(
                f"regressors: expected {n} rows of {m}, measurements by unknowns; got {len(stretch.rows)} rows of "
                f"{sorted(sizes)}; complete them"
            )
    if len(problem.measurements) != n:
        raise ShapeError(f"measurements: expected {n} names; got {len(problem.measurements)}; name each once")


def need_numbers(problem: GuaranteedProblem) -> None:
    """Everything but the variable has a value; lengths and noise bounds are positive."""
    parts = [*problem.functional, *problem.sigma, *(h for s in problem.stretches for row in s.rows for h in row)]
    parts += [e for s in problem.stretches for e in (s.start, s.end)]
    free = sorted({x.name for part in parts for x in part.free_symbols - {problem.variable, *problem.unknown}})
    if free:
        keywords, options = ", ".join(f'{name}="…"' for name in free), " ".join(f"--set {name}=…" for name in free)
        raise DomainError(
            f"expected a value for every parameter; got none for {', '.join(free)}; give {keywords} ({options})"
        )
    for what, values in (("functional", problem.functional), ("sigma", problem.sigma)):
        if any(not enclose(v).is_finite() for v in values):
            raise NotFiniteError(f"{what}: expected finite numbers; got {values}; mend them")
    if any(not bool(enclose(s) > 0) for s in problem.sigma):
        raise DomainError(f"sigma: expected positive noise bounds; got {problem.sigma}; give standard deviations")
    for stretch in problem.stretches:
        if not bool(enclose(stretch.end - stretch.start) > 0):
            raise DomainError(
                f"interval: expected a positive length; got {stretch.start} to {stretch.end}; choose T > 0"
            )
    if all(p == 0 for p in problem.functional):
        raise DomainError("functional: expected one that is not zero; got zeros; every estimator of it is free")


def from_regressors(
    rows: Sequence[Sequence[Any]],
    functional: Sequence[Any],
    variable: sp.Symbol,
    interval: tuple[Any, Any],
    sigma: Sequence[Any] | None = None,
    *,
    target: str = "target",
) -> GuaranteedProblem:
    """The problem of given regressors, one row per measurement."""
    exact = tuple(tuple(exact_entry("H", i, j, h) for j, h in enumerate(row)) for i, row in enumerate(rows))
    start, end = (exact_entry("interval", 0, k, e) for k, e in enumerate(interval))
    bounds = tuple(sigma) if sigma is not None else (1,) * len(exact)
    return GuaranteedProblem((RegressorPiece(start, end, exact),), tuple(functional), bounds, variable, target=target)


def problem_of(
    model: Model | str | os.PathLike[str] | GuaranteedProblem,
    target: str | None,
    values: Mapping[str, Any] | None,
    parameters: Mapping[str, Any],
    where: str,
) -> GuaranteedProblem:
    """The problem that the arguments of a function of the front door mean.

    values, parameters : parameter of the model -> exact value; a name stands in one of them only
    where              : name of that function, for errors
    """
    if not isinstance(model, GuaranteedProblem):
        return from_contents(contents_of(model, values, parameters, where), target, where)
    if target not in (None, model.target):
        got = f"a problem that has {quote(model.target)}"
        raise DomainError(f"expected its target; got {got}; leave the target out", where=f"{where}: target")
    if values or parameters:
        name = next(iter({**(values or {}), **parameters}))
        message = "expected a model with parameters; got a problem, whose numbers are all given; leave the value out"
        raise DomainError(message, where=f"{where}: {name}")
    return model


def from_contents(found: ModelFile | BasisFile, target: str | None = None, where: str = "") -> GuaranteedProblem:
    """The problem that a model file states for one of its targets: regressors H(t), functional, bounds sigma.

    target : its name; not needed where the file has one
    Raises DomainError for an unknown target or a parameter without a value, EmptyError without measurements.
    """
    name, functional = chosen_target(found, target, where)
    if isinstance(found, BasisFile):
        stretch = RegressorPiece(*found.interval, found.H)
        return GuaranteedProblem((stretch,), functional, found.sigma, found.variable, target=name)
    found = divide_blocks(found, where)
    if found.T is None:
        raise EmptyError("expected the length of the interval; got no [interval]; add T", where="interval.T")
    stretches, error = regressor_pieces(found)
    return GuaranteedProblem(
        stretches,
        functional,
        tuple(m.sigma for m in found.measurements),
        found.time,
        tuple(m.name for m in found.measurements),
        name,
        error,
        found if error else None,
    )


def divide_blocks(found: ModelFile, where: str) -> ModelFile:
    """The model with single measurements in place of blocks. Raises DomainError for "l2", TooLargeError for long ones.

    Errors with ``sum |r_j|/sigma_j <= 1`` are those of all sums ``+-z_j/sigma_j``, each with the bound 1: weights on
    these sums cost what the block costs, and a dual keeps the bound of the block when it keeps theirs.
    """
    rows = list(found.measurements)
    for block in found.blocks:
        if block.norm == "l2" and len(block.names) > 1:
            message = 'expected blocks with "l1" or "linf" on an interval; got "l2"; ask Guard, or choose "l1"'
            raise DomainError(message, where=f"{where}: model")
        if block.norm == "l1" and len(block.names) > 1:
            if len(block.names) > MOST_TOGETHER:
                got = f"{len(block.names)} of them"
                message = f"expected at most {MOST_TOGETHER} measurements in a block; got {got}; split the block"
                raise TooLargeError(message, where=f"{where}: model")
            members = [m for m in rows if m.name in block.names]
            rows = [*(m for m in rows if m.name not in block.names), *list_sums(members)]
    return replace(found, measurements=tuple(rows), blocks=())


def list_sums(members: Sequence[Measurement]) -> list[Measurement]:
    """All sums ``+-z_j/sigma_j``, up to their sign, each with the bound 1."""
    found = []
    for signs in product((1, -1), repeat=len(members) - 1):
        pairs = [*zip((1, *signs), members, strict=True)]
        h = tuple(
            sum(s * e / m.sigma for (s, m), e in zip(pairs, column, strict=True))
            for column in zip(*(m.h for m in members), strict=True)
        )
        name = " ".join(f"{'+' if s > 0 else '-'} {m.name}/sigma" for s, m in pairs).removeprefix("+ ")
        found.append(Measurement(name, h, sp.S.One))
    return found


def regressor_pieces(found: ModelFile) -> tuple[tuple[RegressorPiece, ...], sp.Rational]:
    """Regressors and the bound of their error: exact where exp(F t) has a closed form."""
    if not has_varying_system(found):
        stretches = exact_pieces(found)
        if not any(h.has(sp.RootSum) for stretch in stretches for row in stretch.rows for h in row):
            return stretches, sp.S.Zero
    return polynomial_pieces(found)


def polynomial_pieces(found: ModelFile) -> tuple[tuple[RegressorPiece, ...], sp.Rational]:
    """Polynomial regressors and the bound of their error."""
    if not found.measurements:
        raise EmptyError("expected a measurement; got none; add a [[measurement]]", where="measurement")
    moved, shift = to_rational_interval(found)
    made = [(step, *step_regressors(moved, step, shift)) for step in integrate_steps(moved)]
    ends = [sp.S.Zero, *(sp.Rational(str(step.end)) + shift for step, _, _ in made)]
    stretches = tuple(
        RegressorPiece(start, end, rows) for start, end, (_, rows, _) in zip(ends[:-1], ends[1:], made, strict=True)
    )
    return stretches, sp.Rational(str(error_bound([bound for _, _, bound in made])))


def chosen_target(found: ModelFile | BasisFile, target: str | None, where: str = "") -> tuple[str, tuple[sp.Expr, ...]]:
    """Name and functional of a target; the only one when none is named. Raises DomainError."""
    names, where = list(found.targets), f"{where}: target" if where else ""
    if target is None and len(names) > 1:
        message = f"expected one target; got {len(names)} in the model; name one of {', '.join(names)}"
        raise DomainError(message, where=where)
    name = names[0] if target is None else target
    if not isinstance(name, str) or name not in found.targets:
        message = f"expected a target of the model; got {quote(name)}; name one of {', '.join(names)}"
        raise DomainError(message, where=where)
    return name, found.targets[name]


def exact_pieces(found: ModelFile) -> tuple[RegressorPiece, ...]:
    """H_j(tau)^T = h_j Phi(tau, T) on every piece of F, the last piece first.

    Within a piece ``Phi(tau, T) = exp(F (tau - e)) Phi(e, T)`` with e its end.
    """
    T = found.T
    assert T is not None
    if not found.measurements:
        raise EmptyError("expected a measurement; got none; add a [[measurement]]", where="measurement")
    H = sp.ImmutableMatrix([list(m.h) for m in found.measurements])
    if len(found.pieces) == 1:
        model = LinearModel(found.pieces[0].F, None, H, found.states, time=found.time)
        return (RegressorPiece(sp.S.Zero, T, matrix_rows(regressors(model, T, found.time).matrix)),)
    done: list[RegressorPiece] = []
    after = sp.ImmutableMatrix.eye(len(found.states))
    for piece in reversed(found.pieces):
        end = T if piece.end is None else piece.end
        back = transition_matrix(-piece.F, end - found.time).matrix
        done.append(RegressorPiece(piece.start, end, matrix_rows(H * back * after)))
        after = sp.ImmutableMatrix(transition_matrix(-piece.F, end - piece.start).matrix * after)
    return tuple(reversed(done))


def matrix_rows(matrix: sp.ImmutableMatrix) -> Rows:
    """The rows of a matrix as tuples."""
    return tuple(tuple(row) for row in matrix.tolist())
