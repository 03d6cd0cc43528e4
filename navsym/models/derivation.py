"""Everything that follows from a model before an estimator is chosen.

From dx/dt = F x and z_j = h_j x + r_j on [0, T]: the transition matrix, the measurements referred to
the state at the end, the observability matrix, and the conditions that an optimal guaranteed
estimate satisfies. They are the duality of two programmes for a functional P^T x(T):

    minimise  sum_j sigma_j int |Phi_j|   subject to  sum_j int H_j Phi_j = P,
    maximise  x . P                       subject to  |x . H_j(tau)| <= sigma_j  on [0, T].

At the optimum the weights sit where a dual polynomial f_j = x . H_j touches its bound.
Lidov 1964; Karlin and Studden, Tchebycheff Systems, chapter 2.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import sympy as sp

from navsym.core.errors import DomainError
from navsym.models.linear import LinearModel, observability_matrix
from navsym.models.modelfile import BasisFile, ModelFile, piece_model
from navsym.models.transition.exponential import (
    TransitionMatrix,
    collected,
    need_constant,
    regressors,
    transition_matrix,
)

#: Names tried for the instant of a measurement and for the multipliers, until one is free.
INSTANTS = ("tau", "s", "theta", "instant")
MULTIPLIERS = ("x", "lambda_", "multiplier")


@dataclass(frozen=True, slots=True, eq=False)
class Stretch:
    """Regressors on one stretch of the interval: rows (p, n), valid for start <= tau <= end."""

    start: sp.Expr
    end: sp.Expr
    rows: sp.ImmutableMatrix


@dataclass(frozen=True, slots=True, eq=False)
class Conditions:
    """Optimality of one target: functional P, dual polynomials f_j and slopes f_j', one row per stretch."""

    target: str
    functional: tuple[sp.Expr, ...]
    dual: tuple[tuple[sp.Expr, ...], ...]
    slope: tuple[tuple[sp.Expr, ...], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Derivation:
    """What was derived from one file.

    states, measurements, sigmas : names and bounds, as the file gives them
    system        : F, one matrix per stretch; empty for a basis
    transition    : exp(F t) per stretch; empty for a basis
    stretches     : H_j(tau)
    instant, end  : tau and T
    multipliers   : x, one per unknown
    observability : rows H, H F, ...; None for a basis or several stretches
    assumptions   : what the formulas take to hold
    """

    name: str
    states: tuple[str, ...]
    measurements: tuple[str, ...]
    sigmas: tuple[sp.Expr, ...]
    system: tuple[sp.ImmutableMatrix, ...]
    transition: tuple[TransitionMatrix, ...]
    stretches: tuple[Stretch, ...]
    instant: sp.Symbol
    end: sp.Expr
    multipliers: tuple[sp.Symbol, ...]
    observability: sp.ImmutableMatrix | None
    conditions: tuple[Conditions, ...]
    assumptions: tuple[sp.Basic, ...]


def derive(found: ModelFile | BasisFile) -> Derivation:
    """Derive everything that a model or basis file determines.

    Raises DomainError when F varies with the time (no closed form is looked for) or has a repeated
    factor without one; the conditions need H(tau) and so the closed form.
    """
    return derive_basis(found) if isinstance(found, BasisFile) else derive_model(found)


def derive_model(found: ModelFile) -> Derivation:
    """Like :func:`derive` for a system, in one piece or several."""
    models = tuple(piece_model(found, piece.F) for piece in found.pieces)
    for model in models:
        need_constant(model, matrix_only=True)
    taken = {str(symbol) for symbol in symbols_of(found)} | set(found.states)
    end = found.T if found.T is not None else sp.Symbol(free("T", taken), positive=True)
    instant = sp.Symbol(next(name for name in INSTANTS if name not in taken), real=True)
    stretches, backward = stretches_of(found, models, instant, end)
    transition = tuple(transition_matrix(model.F, found.time) for model in models)
    multipliers = multipliers_of(len(found.states), taken | {str(instant)})
    noted = [t.assumptions for t in (*transition, *backward)]
    return Derivation(
        name=found.name,
        states=found.states,
        measurements=tuple(m.name for m in found.measurements),
        sigmas=tuple(m.sigma for m in found.measurements),
        system=tuple(model.F for model in models),
        transition=transition,
        stretches=stretches,
        instant=instant,
        end=end,
        multipliers=multipliers,
        observability=observability_matrix(models[0]) if len(models) == 1 else None,
        conditions=conditions_of(found.targets.items(), stretches, multipliers, instant),
        assumptions=tuple(dict.fromkeys(relation for relations in noted for relation in relations)),
    )


def derive_basis(found: BasisFile) -> Derivation:
    """Like :func:`derive` for regressors without a system: only the conditions are left to derive."""
    unknowns = len(found.H[0])
    rows = sp.ImmutableMatrix(found.H)
    taken = {str(symbol) for symbol in rows.free_symbols} | {str(found.variable)}
    multipliers = multipliers_of(unknowns, taken)
    stretches = (Stretch(*found.interval, rows),)
    return Derivation(
        name=found.name,
        states=tuple(f"q{k + 1}" for k in range(unknowns)),
        measurements=tuple(f"z{j + 1}" for j in range(len(found.H))),
        sigmas=found.sigma,
        system=(),
        transition=(),
        stretches=stretches,
        instant=found.variable,
        end=found.interval[1],
        multipliers=multipliers,
        observability=None,
        conditions=conditions_of(found.targets.items(), stretches, multipliers, found.variable),
        assumptions=(),
    )


def stretches_of(
    found: ModelFile, models: tuple[LinearModel, ...], instant: sp.Symbol, end: sp.Expr
) -> tuple[tuple[Stretch, ...], list[TransitionMatrix]]:
    """H on each stretch, from the last to the first: what lies behind is undone stretch by stretch."""
    stretches: list[Stretch] = []
    undone: list[TransitionMatrix] = []
    behind = sp.ImmutableMatrix.eye(len(found.states))
    for piece, model in reversed(list(zip(found.pieces, models, strict=True))):
        stop = end if piece.end is None else piece.end
        here = regressors(model, stop, instant)
        rows = (here.matrix * behind).applyfunc(collected)
        stretches.insert(0, Stretch(piece.start, stop, rows))
        whole = transition_matrix(-model.F, stop - piece.start)
        undone.append(whole)
        behind = whole.matrix * behind
    return tuple(stretches), undone


def conditions_of(
    targets: Iterable[tuple[str, tuple[sp.Expr, ...]]],
    stretches: tuple[Stretch, ...],
    multipliers: tuple[sp.Symbol, ...],
    instant: sp.Symbol,
) -> tuple[Conditions, ...]:
    """The conditions of every target; the dual polynomials are the same for all, the functional differs."""
    x = sp.Matrix(multipliers)
    dual = tuple(tuple(stretch.rows * x) for stretch in stretches)
    slope = tuple(tuple(f.diff(instant) for f in polynomials) for polynomials in dual)
    return tuple(Conditions(name, functional, dual, slope) for name, functional in targets)


def symbols_of(found: ModelFile) -> set[sp.Symbol]:
    """Every symbol that the file uses or declares."""
    declared = {parameter.symbol for parameter in found.parameters.values()}
    matrices = [piece.F.free_symbols for piece in found.pieces]
    rows = [entry.free_symbols for measurement in found.measurements for entry in measurement.h]
    return declared.union({found.time}, *matrices, *rows)


def free(name: str, taken: set[str]) -> str:
    """The name, with as many zeros behind it as it takes to be new."""
    while name in taken:
        name += "0"
    return name


def multipliers_of(count: int, taken: set[str]) -> tuple[sp.Symbol, ...]:
    """x1, x2, ... under a letter that nothing else uses."""
    for letter in MULTIPLIERS:
        names = [f"{letter}{k + 1}" for k in range(count)]
        if not taken & set(names):
            return tuple(sp.Symbol(name, real=True) for name in names)
    letters = ", ".join(MULTIPLIERS)
    raise DomainError(f"parameters: expected a free letter of {letters}; got all of them taken; rename one")
