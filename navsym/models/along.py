"""A model file as a linear model along its motion: the same for constant, varying and nonlinear models."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import sympy as sp

from navsym.core.errors import DomainError
from navsym.language.expression import symbol
from navsym.language.printer import to_text
from navsym.models.linear import LinearModel
from navsym.models.modelfile import ModelFile, Piece

#: Functions whose derivative never vanishes: what they measure is what their argument measures.
MONOTONE = (sp.log, sp.exp, sp.atan, sp.asin, sp.acos)


def model_along_motion(found: ModelFile, piece: Piece | None = None) -> LinearModel:
    """``dx/dt = F x, z = H x`` of a file, or of one of its pieces, with the rates of all that moves.

    A nonlinear model is linearised along its own motion: F = df/dx, H = dz/dx, and the states have the rates f.
    The relations of a manifold are measurements ``relation 1``, ... that are known to be zero. Of a model in steps
    F is the matrix Phi of one step.

    Raises DomainError for relations that the motion does not keep, or that are not solved by the square of a state.
    """
    rates = {found.parameters[name].symbol: rate for name, rate in found.rates.items()}
    names = tuple(measurement.name for measurement in found.measurements)
    if not found.dynamics:
        # The rows H, H Phi, H Phi^2, ... of a model in steps are those of a constant F with the entries of Phi.
        F = found.Phi if found.Phi is not None else (piece or found.pieces[0]).F
        rows = [list(measurement.h) for measurement in found.measurements]
        return LinearModel(F, None, rows or None, found.states, names, found.time, rates)
    states = [symbol(name) for name in found.states]
    rates |= dict(zip(states, found.dynamics, strict=True))
    squares = manifold_squares(found.relations, states)
    for relation in found.relations:
        need_kept(relation, rates | {found.time: sp.Integer(1)}, squares)
    formulas = [m.z for m in found.measurements if m.z is not None]
    F = sp.ImmutableMatrix([[sp.diff(f, x) for x in states] for f in found.dynamics])
    H = [gradient(z, states) for z in formulas] + [[sp.diff(c, x) for x in states] for c in found.relations]
    names += tuple(f"relation {k + 1}" for k in range(len(found.relations)))
    return LinearModel(F, None, sp.ImmutableMatrix(H), found.states, names, found.time, rates, squares)


def gradient(z: sp.Expr, states: Sequence[sp.Symbol]) -> list[sp.Expr]:
    """dz/dx, up to a factor that never vanishes where z is smooth: of a range the gradient of its square."""
    number, rest = z.as_coeff_Mul()
    if number != 0 and number.is_Rational:
        z = rest
    if isinstance(z, MONOTONE):
        return gradient(z.args[0], states)
    if isinstance(z, sp.Pow) and z.exp == sp.Rational(1, 2):
        return gradient(z.base, states)
    if isinstance(z, sp.atan2):
        y, x = z.args
        return [sp.expand(x * sp.diff(y, s) - y * sp.diff(x, s)) for s in states]
    return [sp.diff(z, s) for s in states]


def manifold_squares(relations: Sequence[sp.Expr], states: Sequence[sp.Symbol]) -> dict[sp.Symbol, sp.Expr]:
    """A state for each relation whose square it gives: q0^2 = 1 - q1^2 - q2^2 - q3^2."""
    squares: dict[sp.Symbol, sp.Expr] = {}
    for relation in relations:
        whole = sp.expand(relation)
        for state in states:
            share = whole.coeff(state, 2)
            rest = sp.expand(whole - share * state**2)
            if share.is_Rational and share != 0 and state not in rest.free_symbols and state not in squares:
                squares[state] = sp.expand(-rest / share)
                break
        else:
            got = to_text(relation)
            message = f"expected a relation with the square of a state alone; got {got} = 0; write it as q0**2 = …"
            raise DomainError(message, where="relations")
    return squares


def need_kept(relation: sp.Expr, rates: Mapping[sp.Symbol, sp.Expr], squares: Mapping[sp.Symbol, sp.Expr]) -> None:
    """Refuse a relation whose derivative along the motion does not vanish on the manifold."""
    moved = sp.Add(*(sp.diff(relation, s) * rates[s] for s in relation.free_symbols & rates.keys()))
    top = sp.expand(sp.numer(sp.together(moved)))
    for state, square in squares.items():
        while top.has(state) and sp.degree(top, state) > 1:
            top = sp.expand(top.coeff(state, 0) + sum(lowered(top, state, square)))
    if top != 0:
        message = f"expected a relation that the motion keeps; got {to_text(relation)} = 0 with another derivative"
        raise DomainError(f"{message}; correct the dynamics", where="relations")


def lowered(value: sp.Expr, state: sp.Symbol, square: sp.Expr) -> list[sp.Expr]:
    """Terms of the powers of a state above the zeroth, with its square put in once."""
    degree = int(sp.degree(value, state))
    return [value.coeff(state, k) * (square * state ** (k - 2) if k > 1 else state) for k in range(1, degree + 1)]
