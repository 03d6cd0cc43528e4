"""As many places as unknowns, with weights that satisfy the constraints exactly: the upper side of the optimum."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from flint import arb, arb_mat, fmpq

from navsym.numeric.exchange.search import Contacts, nodes_for, rows_at
from navsym.proof.optimality.basis import Basis, as_fraction
from navsym.proof.optimality.enclosure import Problem


def support_points(basis: Basis, contacts: Contacts, at: Sequence[fmpq]) -> list[tuple[int, fmpq]]:
    """As many places as unknowns, regressors far from dependent: the contacts, filled up from the grid.

    at : the exact fraction of each contact; where a step of Newton's left the panel by a rounding, its end is taken
    """
    C = basis.panels.coefficients
    m = C.shape[2]
    nodes = nodes_for(basis.panels)
    grid = [(k, float(u)) for k in range(C.shape[0]) for u in nodes[:: max(1, nodes.size // (12 * m))]]
    grid += [(k, 1.0) for k in range(C.shape[0])]
    order = np.argsort(-np.abs(contacts.weights))
    chosen: list[tuple[int, fmpq]] = []
    rest = np.eye(m)
    for i in order:
        row = rows_at(C, contacts.panel[i : i + 1], contacts.u[i : i + 1])[0] @ rest
        if np.linalg.norm(row) > 1e-7 and len(chosen) < m:
            chosen.append((int(contacts.panel[i]), min(max(at[i], fmpq(0)), fmpq(1))))
            rest = without(rest, row)
    rows = rows_at(C, np.array([k for k, _ in grid]), np.array([u for _, u in grid]))
    while len(chosen) < m:
        along = rows @ rest
        best = int(np.argmax(np.linalg.norm(along, axis=1)))
        chosen.append((grid[best][0], as_fraction(grid[best][1])))
        rest = without(rest, along[best])
    return chosen


def without(rest: np.ndarray, row: np.ndarray) -> np.ndarray:
    """The projection ``rest`` with one more direction taken out."""
    unit = row / np.linalg.norm(row)
    projected: np.ndarray = rest - np.outer(rest @ unit, unit)
    return projected


def balanced(problem: Problem, support: Sequence[tuple[int, fmpq]]) -> list[arb]:
    """Weights with ``sum w_i H(t_i) = P`` exactly, as balls."""
    columns = [problem.panels[k].rows(arb(v)) for k, v in support]
    N = arb_mat(columns).transpose()
    solved = N.solve(arb_mat([[p] for p in problem.target()]))
    return [solved[i, 0] for i in range(len(support))]


def cost(problem: Problem, support: Sequence[tuple[int, fmpq]], weights: Sequence[arb]) -> arb:
    """``sum sigma |w|``, which no optimum exceeds when the weights satisfy the constraints."""
    value = arb(0)
    for (k, _), w in zip(support, weights, strict=True):
        value += problem.panels[k].bound() * abs(w)
    return value
