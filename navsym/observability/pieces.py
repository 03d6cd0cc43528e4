"""Observability of a model in pieces: what is unobservable in one piece is carried into the next.

With the state at the end of a piece as the unknown, W is what no measurement has shown so far. In the next piece it
shrinks to its intersection with the unobservable directions N of that piece at its start, and the motion carries it on:
W <- Phi (W and N). Where W and N is invariant under the motion, it is itself again and no Phi is needed: always after
the first piece, so that two constant pieces have the rank of their stacked rows whatever their lengths are. The rest
takes the exact transition matrix of a constant piece.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from typing import Any

import sympy as sp

from navsym.core.errors import DomainError
from navsym.language.expression import to_text
from navsym.models.along import model_along_motion
from navsym.models.linear import LinearModel
from navsym.models.modelfile import ModelFile
from navsym.observability.chains import JointObservability, MeasurementObservability, observe_jointly
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


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """One piece for some of the measurements.

    model       : F and H of the piece
    start, end  : its ends
    found       : its observability by itself
    """

    model: LinearModel
    start: sp.Expr
    end: sp.Expr
    found: JointObservability

    def unobservable_at(self, moment: sp.Expr) -> sp.ImmutableMatrix:
        """Rows of the directions that the piece does not show, at a time; DomainError where they degenerate there."""
        rows = self.found.unobservable.subs(self.model.time, moment)
        if rows.has(sp.nan, sp.zoo) or len(independent_rows(rows)) < rows.rows:
            got = f"directions that degenerate at t = {to_text(moment)}"
            raise DomainError(f"expected pieces that begin at a regular time; got {got}; move it", where="piece")
        return rows


def observe_pieces(contents: ModelFile) -> tuple[LinearModel, JointObservability, tuple[Mapping[str, Any], ...]]:
    """The first piece, the joint observability over all pieces, and from, to and rank of each piece by itself.

    Directions and bases hold at the start of the last piece.

    Raises the errors of :func:`observe_jointly`, and DomainError for moving parameters, and for varying or too
    complicated inner pieces that would have to carry a direction on.
    """
    models = [model_along_motion(contents, piece) for piece in contents.pieces]

    @cache
    def stages_of(places: tuple[int, ...]) -> list[Stage]:
        return [stage_of(contents, k, measured(model, places)) for k, model in enumerate(models)]

    names = models[0].measurements
    every = stages_of(tuple(range(len(names))))
    joint = observe_by_subsets(contents.states, names, lambda places: unobservable_over(stages_of(places)))
    assumptions = tuple(dict.fromkeys(a for stage in every for a in stage.found.assumptions))
    return models[0], replace(joint, assumptions=assumptions), tuple(piece_data(stage) for stage in every)


def observe_by_subsets(
    states: tuple[str, ...],
    names: tuple[str, ...],
    unseen_by: Callable[[tuple[int, ...]], sp.ImmutableMatrix],
    proved: bool = True,
) -> JointObservability:
    """The answer for a model without chains, from the directions that the measurements in some places do not show."""
    n, single = len(states), [unseen_by((j,)) for j in range(len(names))]
    unseen = [unseen_by(tuple(range(j + 1))) for j in range(len(names))]
    return JointObservability(
        states,
        measurements=tuple(
            MeasurementObservability(name, annihilator(rows, n), (), n - rows.rows)
            for name, rows in zip(names, single, strict=True)
        ),
        staircase=tuple(before - after for before, after in pairwise([n, *(rows.rows for rows in unseen)])),
        unobservable=unseen[-1],
        assumptions=(),
        written=None,
        observed=annihilator(unseen[-1], n),
        proved=proved,
    )


def measured(model: LinearModel, places: Sequence[int]) -> LinearModel:
    """The model with some of its measurements."""
    H = sp.ImmutableMatrix([model.H[j, :] for j in places])
    return LinearModel(model.F, None, H, model.states, tuple(model.measurements[j] for j in places), model.time)


def stage_of(contents: ModelFile, place: int, model: LinearModel) -> Stage:
    """One piece with its ends and its observability by itself."""
    if contents.rates:
        message = f"expected parameters that are constant; got the rate of {next(iter(contents.rates))} beside pieces"
        raise DomainError(f"{message}; write F as F(t)", where="rates")
    piece = contents.pieces[place]
    end = piece.end if piece.end is not None else piece.start
    return Stage(model, piece.start, end, observe_jointly(model))


def piece_data(stage: Stage) -> Mapping[str, Any]:
    """A piece for the document."""
    found = stage.found
    return {
        "from": to_text(stage.start),
        "to": to_text(stage.end),
        "joint_dimension": found.joint_dimension,
        "unobservable_basis": [[to_text(x) for x in found.unobservable.row(k)] for k in range(found.unobservable.rows)],
    }


def unobservable_over(stages: Sequence[Stage]) -> sp.ImmutableMatrix:
    """Rows of the directions that no piece shows, at the start of the last piece."""
    unseen = stages[0].unobservable_at(stages[0].end)
    for before, stage in pairwise(stages):
        if before is not stages[0]:
            unseen = carried(unseen, before)
        unseen = intersection(unseen, stage.unobservable_at(stage.start))
    return unseen


def carried(rows: sp.ImmutableMatrix, stage: Stage) -> sp.ImmutableMatrix:
    """Directions at the end of a piece, from those at its start that the piece does not show."""
    if rows.rows == stage.found.unobservable.rows:
        return stage.unobservable_at(stage.end)
    if not stage.model.constant:
        got = f"F(t) from {to_text(stage.start)} to {to_text(stage.end)}"
        raise DomainError(f"expected a constant F in an inner piece; got {got}; split it finer", where="piece")
    moved = (stage.model.F * rows.T).T
    if all(is_spanned(rows, sp.ImmutableMatrix(moved.row(k))) for k in range(moved.rows)):
        return rows
    from navsym.models.transition.exponential import transition_matrix

    Phi = transition_matrix(stage.model.F, stage.end - stage.start)
    if Phi.matrix.has(sp.RootSum):
        got = "eigenvalues that are roots of a polynomial of high degree"
        raise DomainError(f"expected a transition matrix in closed form; got {got}; set some parameters", where="piece")
    return sp.ImmutableMatrix((Phi.matrix * rows.T).T)


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


def intersection(left: sp.ImmutableMatrix, right: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """What lies in the spans of the rows of both."""
    n = left.cols
    return annihilator(sp.ImmutableMatrix.vstack(annihilator(left, n), annihilator(right, n)), n)


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
    if all(x == 0 for x in other):
        return True
    (basis, (target,)), motion = polynomial_rows(rows, other)
    return all(x == 0 for x in target) or linear_relation(basis, target, motion.ring) is not None
