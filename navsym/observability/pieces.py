"""Observability of a model in pieces: the rows of all legs, stacked at the start of the last one.

With the state at the end of a leg as the unknown, S are the functionals that a measurement has shown so far. The next
leg adds what it shows at its start, and its motion carries all on: S <- S Phi^-1. Where the span of S is invariant
under the motion, it is itself again and no Phi is needed: always after the first leg, so that two constant legs have
the rank of their stacked rows whatever their lengths are. The rest takes the exact transition matrix of a constant leg.
Rank, unobservable directions, drops and certificates are those of a state at rest that is measured by these rows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from navsym.core.errors import DomainError
from navsym.language.expression import to_text
from navsym.models.along import model_along_motion
from navsym.models.linear import LinearModel
from navsym.models.modelfile import ModelFile
from navsym.observability.chains import JointObservability, observe_jointly
from navsym.observability.linear import (
    Matrix,
    at_point,
    independent_places,
    integer_points,
    linear_relation,
    null_vectors,
    scalar_product,
)
from navsym.observability.motion import motion_of
from navsym.observability.rank_drops import DropList, find_drops


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """One leg for one measurement.

    model       : F and H of the leg
    start, end  : its ends
    found       : its observability by itself
    """

    model: LinearModel
    start: sp.Expr
    end: sp.Expr
    found: JointObservability

    def shown_at(self, moment: sp.Expr) -> sp.ImmutableMatrix:
        """Rows that the leg shows at a time; DomainError where they degenerate there."""
        basis = self.found.measurements[0].basis
        if self.model.constant and basis.rows == self.found.joint_dimension:
            return basis
        rows = self.found.unobservable.subs(self.model.time, moment)
        if rows.has(sp.nan, sp.zoo) or len(independent_rows(rows)) < rows.rows:
            got = f"directions that degenerate at t = {to_text(moment)}"
            raise DomainError(f"expected pieces that begin at a regular time; got {got}; move it", where="piece")
        return annihilator(rows, self.model.size)


def observe_pieces(
    contents: ModelFile,
) -> tuple[LinearModel, JointObservability, tuple[Mapping[str, Any], ...], DropList]:
    """The first leg, the observability over all legs, from, to and rank of each leg by itself, and the drops.

    Directions and bases hold at the start of the last leg. Drops are listed for two constant legs, whose rows span what
    is shown for all parameters.

    Raises the errors of :func:`observe_jointly`, and DomainError for moving parameters, and for varying or too
    complicated inner pieces that would have to carry a direction on.
    """
    if contents.rates:
        message = f"expected parameters that are constant; got the rate of {next(iter(contents.rates))} beside pieces"
        raise DomainError(f"{message}; write F as F(t)", where="rates")
    models = [model_along_motion(contents, piece) for piece in contents.pieces]
    ends = [(piece.start, piece.end if piece.end is not None else piece.start) for piece in contents.pieces]
    every = [Stage(model, *span, observe_jointly(model)) for model, span in zip(models, ends, strict=True)]
    stacks = []
    for j in range(len(models[0].measurements)):
        single = [measured(model, j) for model in models]
        stacks.append(rows_over([Stage(m, *span, observe_jointly(m)) for m, span in zip(single, ends, strict=True)]))
    owners = tuple(name for name, rows in zip(models[0].measurements, stacks, strict=True) for _ in range(rows.rows))
    still = sp.Dummy("still", real=True)
    H = sp.ImmutableMatrix.vstack(*stacks)
    polynomial_rows(H)
    rest = LinearModel(sp.zeros(H.cols), None, H, contents.states, time=still)
    joint = observe_jointly(rest, owners)
    assumptions = tuple(dict.fromkeys(a for stage in every for a in stage.found.assumptions))
    joint = replace(joint, assumptions=assumptions)
    exact = len(models) == 2 and all(model.constant for model in models)
    drops = find_drops(joint, contents.box) if exact else DropList((), {"joint": False}, {})
    return models[0], joint, tuple(map(piece_data, every)), drops


def measured(model: LinearModel, place: int) -> LinearModel:
    """The model with one of its measurements."""
    return LinearModel(
        model.F, None, model.H[place, :], model.states, model.measurements[place : place + 1], model.time
    )


def piece_data(stage: Stage) -> Mapping[str, Any]:
    """A piece for the document."""
    found = stage.found
    return {
        "from": to_text(stage.start),
        "to": to_text(stage.end),
        "joint_dimension": found.joint_dimension,
        "unobservable_basis": [[to_text(x) for x in found.unobservable.row(k)] for k in range(found.unobservable.rows)],
    }


def rows_over(stages: Sequence[Stage]) -> sp.ImmutableMatrix:
    """Rows of what all legs show, at the start of the last one."""
    shown = stages[0].shown_at(stages[0].end)
    for stage in stages[1:-1]:
        shown = carried(shown, stage)
    return sp.ImmutableMatrix.vstack(shown, stages[-1].shown_at(stages[-1].start))


def carried(rows: sp.ImmutableMatrix, stage: Stage) -> sp.ImmutableMatrix:
    """What is known at the end of a leg, from what is known at its start and what the leg shows."""
    own = stage.shown_at(stage.start)
    fresh = rows_beside(own, rows)
    if not fresh.rows:
        return stage.shown_at(stage.end)
    if not stage.model.constant:
        got = f"F(t) from {to_text(stage.start)} to {to_text(stage.end)}"
        raise DomainError(f"expected a constant F in an inner piece; got {got}; split it finer", where="piece")
    whole = sp.ImmutableMatrix.vstack(own, fresh)
    if not rows_beside(whole, fresh * stage.model.F).rows:
        return whole
    from navsym.models.transition.exponential import transition_matrix

    Phi = transition_matrix(stage.model.F, stage.start - stage.end)
    if Phi.matrix.has(sp.RootSum):
        got = "eigenvalues that are roots of a polynomial of high degree"
        raise DomainError(f"expected a transition matrix in closed form; got {got}; set some parameters", where="piece")
    return sp.ImmutableMatrix.vstack(own, fresh * Phi.matrix)


# Exact linear algebra on rows of functions


def polynomial_rows(*matrices: sp.MatrixBase) -> tuple[list[Matrix], Any]:
    """Rows of some matrices over one ring, without denominators, and the motion that holds the ring."""
    n = matrices[0].cols
    still = LinearModel(sp.zeros(n, n), None, matrices[0], time=sp.Dummy("still", real=True))
    motion, listed = motion_of(still, matrices[1:])
    rows = [row for row, _ in listed]
    parts, first = [], 0
    for matrix in matrices:
        parts.append(rows[first : first + matrix.rows])
        first += matrix.rows
    if motion.roots:
        got = f"roots beside {', '.join(str(motion.ring.symbols[place]) for place in motion.roots)}"
        raise DomainError(
            f"expected pieces without square roots; got {got}; name each root as a parameter", where="piece"
        )
    return parts, motion


def independent_rows(rows: sp.ImmutableMatrix) -> list[int]:
    """Places of rows that are independent of those before."""
    if not rows.rows:
        return []
    (listed,), motion = polynomial_rows(rows)
    return independent_places(at_point(listed, integer_points(motion.ring)[0]))


def annihilator(rows: sp.ImmutableMatrix, n: int) -> sp.ImmutableMatrix:
    """Independent functionals that vanish on all rows."""
    if not rows.rows:
        return sp.ImmutableMatrix.eye(n)
    (listed,), motion = polynomial_rows(rows)
    chosen = independent_places(at_point(listed, integer_points(motion.ring)[0]))
    found = null_vectors([listed[k] for k in chosen], n, motion.ring)
    if any(scalar_product(row, vector, motion.ring.constant(0)) != 0 for row in listed for vector in found):
        raise ArithmeticError("annihilator: the point was unlucky")
    return sp.ImmutableMatrix(len(found), n, [motion.ring.expression(x) for row in found for x in row])


def is_spanned(rows: sp.ImmutableMatrix, other: sp.ImmutableMatrix) -> bool:
    """True when a row lies in the span of independent rows."""
    return not rows_beside(rows, other).rows


def rows_beside(rows: sp.ImmutableMatrix, others: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """Those of the others, one after the other, that do not lie in the span of independent rows and of those before."""
    (basis, targets), motion = polynomial_rows(rows, others)
    fresh = []
    for k, target in enumerate(targets):
        if any(x != 0 for x in target) and linear_relation(basis, target, motion.ring) is None:
            basis.append(target)
            fresh.append(k)
    return others.extract(fresh, list(range(others.cols)))
