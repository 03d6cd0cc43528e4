"""Observability with unknown inputs: x' = F x + G u, z = H x + D u, where nothing is known of u.

A pair (a, b) is known where a x + b u is. The measurements give (h, d). A combination with b = 0 shows a x, and with it
its derivative (a' + a F, a G), which is a pair again. What is shown of x at last is all that strong observability
grants: its annihilator is the largest V with F V - V' in V + G u and H V + D u = 0 for one u (Basile and Marro 1969;
Molinari 1976). A nonlinear model is linearised along its motion, whose inputs are symbols with endless derivatives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Any

import sympy as sp

from navsym.core.errors import DomainError, NavsymError
from navsym.core.rational_functions import Quotient
from navsym.language.expression import symbol
from navsym.models.along import gradient, model_along_motion
from navsym.models.linear import LinearModel
from navsym.models.modelfile import ModelFile
from navsym.observability.certificates import Certifier, diagonal_columns
from navsym.observability.chains import (
    JointObservability,
    MeasurementObservability,
    need_chains,
    numerators,
    observe_jointly,
)
from navsym.observability.linear import (
    Matrix,
    at_point,
    independent_places,
    linear_relation,
    null_vectors,
    primitive_vector,
    scalar_product,
)
from navsym.observability.motion import Motion, motion_of
from navsym.observability.pieces import annihilator
from navsym.observability.ring import Poly


@dataclass(frozen=True, slots=True, eq=False)
class Driven:
    """A model with unknown inputs over one ring.

    rows    : (h, d) of each measurement, n + q entries
    columns : G without its denominator, (n, q);  bottom : that denominator
    """

    motion: Motion
    rows: Matrix
    columns: Matrix
    bottom: Poly

    @property
    def size(self) -> int:
        """n, the number of states."""
        return self.motion.size


def driven_model(contents: ModelFile) -> tuple[LinearModel, sp.ImmutableMatrix, sp.ImmutableMatrix]:
    """F and H along the motion with the derivatives of the inputs, G (n, q), and D (p, q)."""
    model, inputs = model_along_motion(contents), [symbol(name) for name in contents.inputs]
    if not contents.dynamics:
        G = sp.ImmutableMatrix([list(column) for column in contents.inputs.values()]).T
        return model, G, sp.ImmutableMatrix.zeros(model.H.rows, len(inputs))
    if contents.relations:
        message = "expected a model without relations beside unknown inputs; got relations; solve them for a state"
        raise DomainError(message, where="relations")
    states = [symbol(name) for name in contents.states]
    rows = [gradient(m.z, [*states, *inputs]) for m in contents.measurements if m.z is not None]
    rates = dict(model.rates)
    taken = [*contents.states, *contents.parameters, *contents.inputs]
    for u in inputs:
        stem = f"{u}_"
        while any(name.startswith(stem) for name in taken):
            stem += "_"
        jets = [u, *(symbol(f"{stem}{k}") for k in range(1, model.size + 3))]
        rates |= dict(pairwise(jets))
    H = sp.ImmutableMatrix([row[: len(states)] for row in rows])
    G = sp.ImmutableMatrix([[sp.diff(f, u) for u in inputs] for f in contents.dynamics])
    D = sp.ImmutableMatrix([row[len(states) :] for row in rows])
    return LinearModel(model.F, None, H, model.states, model.measurements, model.time, rates), G, D


def over_one_ring(model: LinearModel, G: sp.ImmutableMatrix, D: sp.ImmutableMatrix) -> Driven:
    """All matrices as polynomials. Raises DomainError for square roots."""
    q, n = G.cols, model.size
    still = LinearModel(model.F, None, None, model.states, (), model.time, model.rates)
    motion, listed = motion_of(still, [sp.Matrix.hstack(model.H, D), sp.Matrix(1, n * q, list(G))])
    if motion.roots:
        message = "expected a model without square roots beside unknown inputs; got one; name it as a parameter"
        raise DomainError(message, where="inputs")
    *rows, (flat, bottom) = listed
    return Driven(motion, [row for row, _ in rows], [flat[i * q : (i + 1) * q] for i in range(n)], bottom)


def shown_functionals(model: Driven, rows: Matrix, point: Sequence[int]) -> Matrix:
    """Independent functionals of the state that some measurements (h, d) show whatever the inputs are."""
    n, ring = model.size, model.motion.ring
    pairs, shown = [list(row) for row in rows], list[list[Poly]]()
    done = 0
    while True:
        pairs = [pairs[k] for k in independent_places(at_point(pairs, point))] if pairs else []
        for combination in combinations_without_inputs([pair[n:] for pair in pairs], model, point):
            zero = ring.constant(0)
            row = [sum((c * pair[k] for c, pair in zip(combination, pairs, strict=True)), zero) for k in range(n)]
            trial = [*shown, primitive_vector(row, ring)]
            if len(independent_places(at_point(trial, point))) == len(trial):
                shown = trial
        if done == len(shown):
            return shown
        for row in shown[done:]:
            driven = [
                model.motion.clock * sum((a * g for a, g in zip(row, column, strict=True)), ring.constant(0))
                for column in zip(*model.columns, strict=True)
            ]
            moved = [model.bottom * entry for entry in model.motion.advance(row)]
            pairs.append(primitive_vector([*moved, *driven], ring))
        done = len(shown)


def combinations_without_inputs(parts: Matrix, model: Driven, point: Sequence[int]) -> Matrix:
    """Vectors c with c B = 0 for the shares B of the inputs in some pairs."""
    columns = [list(column) for column in zip(*parts, strict=True)]
    nonzero = [column for column in columns if any(entry != 0 for entry in column)]
    chosen = [nonzero[k] for k in independent_places(at_point(nonzero, point))] if nonzero else []
    return null_vectors(chosen, len(parts), model.motion.ring)


def find_friend(model: Driven, rows: Matrix, columns: Matrix, point: Sequence[int]) -> list[list[Quotient]] | None:
    """For each column N the input u with F N - N' + G u in the span of the columns and h N + d u = 0; None without one.

    Then a state that starts along the columns stays there for this input, and no measurement shows it: the rank is not
    larger. All are identities of polynomials.
    """
    n, zero = model.size, model.motion.ring.constant(0)
    width, clock, scale = len(rows), model.motion.clock, model.motion.clock * model.bottom
    spanning = [[*column, *([zero] * width)] for column in columns]
    for k in range(len(rows[0]) - n):
        entering = [clock * row[k] for row in model.columns]
        spanning.append([*entering, *(scale * row[n + k] for row in rows)])
    places = independent_places(at_point(spanning, point))
    friend = []
    for column in columns:
        moved = [model.bottom * entry for entry in model.motion.retreat(column)]
        seen = [scale * scalar_product(row[:n], column, zero) for row in rows]
        shares = linear_relation([spanning[k] for k in places], [*moved, *seen], model.motion.ring)
        if shares is None:
            return None
        found = {place - len(columns): Quotient(-c.top, c.bottom) for place, c in zip(places, shares, strict=True)}
        nothing = Quotient(zero, model.motion.ring.constant(1))
        friend.append([found.get(k, nothing) for k in range(len(rows[0]) - n)])
    return friend


def observe_driven(contents: ModelFile) -> tuple[LinearModel, JointObservability]:
    """The model along its motion, and what its measurements show of the state whatever the unknown inputs are.

    Raises the errors of :func:`observe_jointly`, and DomainError for relations and square roots.
    """
    model, G, D = driven_model(contents)
    need_chains(model)
    driven = over_one_ring(model, G, D)
    ring, point = driven.motion.ring, driven.motion.points(1)[0]

    @cache
    def unseen_by(places: tuple[int, ...]) -> sp.ImmutableMatrix:
        rows = null_vectors(shown_functionals(driven, [driven.rows[j] for j in places], point), model.size, ring)
        return sp.ImmutableMatrix(len(rows), model.size, [ring.expression(x) for row in rows for x in row])

    n, names = model.size, model.measurements
    single = [unseen_by((j,)) for j in range(len(names))]
    unseen = [unseen_by(tuple(range(j + 1))) for j in range(len(names))]
    columns = [numerators([unseen[-1][k, :]], ring)[0][0] for k in range(unseen[-1].rows)]
    return model, JointObservability(
        model.states,
        measurements=tuple(
            MeasurementObservability(name, annihilator(rows, n), (), n - rows.rows)
            for name, rows in zip(names, single, strict=True)
        ),
        staircase=tuple(before - after for before, after in pairwise([n, *(rows.rows for rows in unseen)])),
        unobservable=unseen[-1],
        assumptions=(),
        written=None,
        observed=annihilator(unseen[-1], n),
        proved=find_friend(driven, driven.rows, columns, point) is not None,
    )


# Certificates


def certify_inputs(contents: ModelFile, joint: JointObservability) -> dict[str, Any] | None:
    """That measurements show so many dimensions whatever the inputs are, as far as the checker grants it.

    Not more: with the inputs u = K x, which hide the unobservable columns, the rank of F + G K and H + D K is this one.
    Not less: z and its derivatives are O x + T (u, u', ...), and the combinations in which no input is left show
    rank [O T] - rank T dimensions of x. The checker grants all three ranks.
    """
    try:
        model, G, D = driven_model(contents)
        closed = close_loop(model, G, D, joint)
        below = certify_below(model, G, D, joint.joint_dimension)
        found = observe_jointly(closed) if closed is not None else None
        if closed is None or found is None or below is None or found.joint_dimension != joint.joint_dimension:
            return None
        above = Certifier.of(closed).certify_rank(found)
    except NavsymError:
        return None
    return {"kind": "all", "of": [above, *below]} if isinstance(above, dict) else None


def close_loop(model: LinearModel, G: sp.Matrix, D: sp.Matrix, joint: JointObservability) -> LinearModel | None:
    """F + G K and H + D K with the inputs u = K x that keep the unobservable columns unseen."""
    driven, unseen = over_one_ring(model, G, D), joint.unobservable
    ring, n = driven.motion.ring, model.size
    columns = [numerators([unseen[k, :]], ring)[0][0] for k in range(unseen.rows)]
    columns, free = diagonal_columns(columns, n, ring)
    friend = find_friend(driven, driven.rows, columns, driven.motion.points(1)[0])
    if friend is None or len(columns) < unseen.rows:
        return None
    K = sp.zeros(G.cols, n)
    for inputs, place, column in zip(friend, free, columns, strict=True):
        K[:, place] = sp.Matrix([ring.expression(u) / ring.expression(column[place]) for u in inputs])
    F, H = (
        (left + right * K).applyfunc(lambda x: ring.expression(ring.quotient(x)))
        for left, right in ((model.F, G), (model.H, D))
    )
    H = sp.Matrix([H.row(k) for k in range(H.rows) if any(H.row(k))])
    return LinearModel(F, None, H if H.rows else None, model.states, (), model.time, model.rates)


def certify_below(model: LinearModel, G: sp.Matrix, D: sp.Matrix, rank: int) -> list[dict[str, Any]] | None:
    """The ranks of [O T] and of T, with as few derivatives as show so much of the state."""
    n, q = model.size, G.cols
    for depth in range(n + 1):
        F = sp.diag(model.F, sp.zeros(q * (depth + 1)))
        F[:n, n : n + q] = G
        F[n : n + q * depth, n + q :] = sp.eye(q * depth)
        H = sp.Matrix.hstack(model.H, D, sp.zeros(D.rows, q * depth))
        motion, listed = motion_of(LinearModel(F, None, H, time=model.time, rates=model.rates))
        step = rows = [row for row, _ in listed]
        for _ in range(depth):
            step = [motion.advance(row) for row in step]
            rows = [*rows, *step]
        residues = at_point(rows, motion.points(1)[0])
        shown = len(independent_places(residues)) - len(independent_places([row[n:] for row in residues]))
        if shown == rank:
            written = sp.Matrix([[motion.ring.expression(x) for x in row] for row in rows])
            found = [certify_matrix(written), certify_matrix(written[:, n:])]
            return [item for item in found if item is not None] if None not in found else None
    return None


def certify_matrix(M: sp.Matrix) -> dict[str, Any] | None:
    """The generic rank of a matrix, as that of measurements of a state at rest."""
    certifier = Certifier.of(LinearModel(sp.zeros(M.cols), None, M, time=sp.Dummy("still", real=True)))
    rows, motion = certifier.rows, certifier.motion
    chosen = independent_places(at_point(rows, motion.points(1)[0]))
    columns = null_vectors([rows[k] for k in chosen], M.cols, motion.ring)
    item = certifier.certify(len(chosen), columns, [], range(len(rows)))
    return item if isinstance(item, dict) else None
