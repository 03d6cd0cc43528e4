"""Vector measurements: the optimum over blocks with cones, by clarabel, and made sharp by Newton's method in balls.

Over states x whose measurements are admissible noise, ``H_i x in B_i``, the largest ``x . P`` is the least radius.
The multipliers of the constraints are the weights. What is returned is a proposal; nothing rests on it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from flint import arb, arb_mat, fmpq, fmpq_mat

from navsym.core.balls import precision
from navsym.core.exact import to_fmpq
from navsym.guaranteed.search.kernels import Array
from navsym.guaranteed.streaming.exchange import Cloud, exchange

#: What a measurement of the dual may be and count as zero, in bounds; and a weight, as part of the largest.
ACTIVE, NEGLIGIBLE = 1e-6, 1e-7
BITS, STEPS, GOAL = 320, 14, 1e-70


@dataclass(frozen=True, slots=True, eq=False)
class Cone:
    """A block for the search: regressors H (p, m), and the noise that is allowed.

    norm : "linf" or "l1" with sizes (p, 1), or "l2" with a positive definite shape (p, p): ``r' shape^-1 r <= 1``
    """

    H: fmpq_mat
    norm: str
    size: fmpq_mat

    @property
    def rows(self) -> int:
        """Measurements of the block."""
        return int(self.H.nrows())

    def scaled(self) -> fmpq_mat:
        """Regressors over their sizes; of an ellipsoid ``shape^-1 H``."""
        if self.norm == "l2":
            return self.size.solve(self.H)
        divide = fmpq_mat(
            self.rows,
            self.rows,
            [1 / e if i == j else fmpq(0) for i, e in enumerate(self.size.entries()) for j in range(self.rows)],
        )
        return divide * self.H

    def gauge(self, x: fmpq_mat) -> fmpq:
        """How many times the allowed noise the measurements of x are; for "l2" the square of it."""
        y, z = self.H * x, self.scaled() * x
        if self.norm == "l2":
            return (y.transpose() * z)[0, 0]
        sizes = [abs(e) for e in z.entries()]
        return max(sizes) if self.norm == "linf" else sum(sizes, fmpq(0))

    def cost(self, w: Sequence[fmpq]) -> arb:
        """The largest ``w . r`` of allowed noise r."""
        if self.norm == "l2":
            column = fmpq_mat(self.rows, 1, list(w))
            return arb((column.transpose() * self.size * column)[0, 0]).sqrt()
        costs = [abs(a) * s for a, s in zip(w, self.size.entries(), strict=True)]
        return arb(sum(costs, fmpq(0)) if self.norm == "linf" else max(costs))


def to_array(matrix: fmpq_mat) -> Array:
    """A matrix in doubles."""
    return np.array([[int(e.p) / int(e.q) for e in row] for row in matrix.tolist()])


@dataclass(frozen=True, slots=True, eq=False)
class Proposal:
    """A dual x (m,) and weights block by block, as rationals near the optimum."""

    x: list[fmpq]
    weights: list[list[fmpq]]


def propose_optima(cones: Sequence[Cone], functional: fmpq_mat) -> list[Proposal]:
    """Duals and weights, of which one may be the optimum: of boxes alone by the exchange of scalar measurements.

    Of other cones by clarabel, sharpened where the active constraints determine them, and as it is.
    """
    if all(cone.norm == "linf" for cone in cones):
        return exchange_rows(cones, functional)
    found = solve_cones(cones, functional)
    if found is None:
        return []
    x, weights = found
    sharp = sharpen(cones, functional, x, weights)
    return [*([] if sharp is None else [sharp]), Proposal(exact_list(x), [exact_list(w) for w in weights])]


def exchange_rows(cones: Sequence[Cone], functional: fmpq_mat) -> list[Proposal]:
    """The optimum over boxes, whose entries are measurements by themselves."""
    rows = [arb_mat([row]) for cone in cones for row in cone.H.tolist()]
    sigma = [arb(e) for cone in cones for e in cone.size.entries()]
    cloud = Cloud(rows, sigma, np.vstack([to_array(cone.scaled()) for cone in cones]))
    found = exchange(cloud, arb_mat(functional.transpose()), cloud.start() or [])
    if found is None:
        return []
    flat = [fmpq(0)] * len(rows)
    for k, w in zip(found.basis, found.weights.entries(), strict=True):
        flat[k] = to_fmpq(w.mid())
    ends = [sum(cone.rows for cone in cones[:k]) for k in range(len(cones) + 1)]
    return [Proposal([to_fmpq(e.mid()) for e in found.dual.entries()], [flat[a:b] for a, b in pairwise(ends)])]


def exact_list(values: Array) -> list[fmpq]:
    """Doubles as rationals."""
    return [to_fmpq(arb(float(v))) for v in values]


def solve_cones(cones: Sequence[Cone], functional: fmpq_mat) -> tuple[Array, list[Array]] | None:
    """Maximise ``x . P`` with ``H_i x in B_i``; x and the weights from the multipliers, in doubles."""
    import clarabel
    from scipy import sparse

    m = functional.nrows()
    H = [to_array(cone.H) for cone in cones]
    white = np.vstack([whiten(cone) @ h for cone, h in zip(cones, H, strict=True)])
    turn = np.linalg.inv(np.linalg.qr(white)[1])  # orthonormal columns
    extra = sum(cone.rows for cone in cones if cone.norm == "l1")
    rows: list[Array] = []
    right: list[Array] = []
    kinds: list[Any] = []
    used = 0
    for cone, h in zip(cones, H, strict=True):
        part, bound, kind, more = cone_rows(cone, whiten(cone) @ h @ turn, extra, used, clarabel)
        rows, right, kinds, used = [*rows, part], [*right, bound], [*kinds, *kind], used + more
    cost = np.concatenate([-turn.T @ to_array(functional)[:, 0], np.zeros(extra)])
    scale = np.abs(cost).max()
    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_iter = False, 100
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-10
    n = m + extra
    done = clarabel.DefaultSolver(
        sparse.csc_matrix((n, n)),
        cost / scale,
        sparse.csc_matrix(np.vstack(rows)),
        np.concatenate(right),
        kinds,
        settings,
    ).solve()
    x, z = np.array(done.x)[:m], np.array(done.z) * scale
    if not (np.isfinite(x).all() and np.isfinite(z).all()) or "Solved" not in str(done.status):
        return None
    weights, at = [], 0
    for cone, part in zip(cones, rows, strict=True):
        weights.append(whiten(cone).T @ block_weights(cone, z[at : at + part.shape[0]]))
        at += part.shape[0]
    return turn @ x, weights


def whiten(cone: Cone) -> Array:
    """The matrix that makes the allowed noise the unit ball of its norm."""
    if cone.norm == "l2":
        return np.linalg.inv(np.linalg.cholesky(to_array(cone.size)))  # type: ignore[no-any-return]
    return np.diag(1 / to_array(cone.size)[:, 0])


def cone_rows(cone: Cone, h: Array, extra: int, used: int, clarabel: Any) -> tuple[Array, Array, list[Any], int]:
    """Rows A, right sides b and cones of ``A (x, u) + s = b`` for one block with unit noise; and its variables u."""
    p, m = h.shape
    blank = np.zeros((p, extra))
    if cone.norm == "l2":
        A = np.vstack([np.zeros((1, m + extra)), np.hstack([-h, blank])])
        return A, np.concatenate([[1.0], np.zeros(p)]), [clarabel.SecondOrderConeT(p + 1)], 0
    if cone.norm == "linf":
        both = np.vstack([np.hstack([h, blank]), np.hstack([-h, blank])])
        return both, np.ones(2 * p), [clarabel.NonnegativeConeT(2 * p)], 0
    own = blank.copy()
    own[:, used : used + p] = np.eye(p)
    A = np.vstack([np.hstack([h, -own]), np.hstack([-h, -own]), np.hstack([np.zeros((1, m)), own.sum(axis=0)[None]])])
    return A, np.concatenate([np.zeros(2 * p), [1.0]]), [clarabel.NonnegativeConeT(2 * p + 1)], p


def block_weights(cone: Cone, z: Array) -> Array:
    """The weights on a block with unit noise, from the multipliers of its rows."""
    p = cone.rows
    return -z[1:] if cone.norm == "l2" else z[:p] - z[p : 2 * p]


# Newton's method on the active constraints


def sharpen(cones: Sequence[Cone], functional: fmpq_mat, x: Array, weights: Sequence[Array]) -> Proposal | None:
    """The solution of the optimality system with the constraints that are active; None where it is singular.

    Unknowns are x, multipliers mu of rows ``a x = b``, and lambda of quadratics ``x' Q x = 1``:
    ``sum lambda Q x + sum mu a = P``. A row keeps places and factors with which its multiplier enters the weights.
    """
    total = sum(float(cone.cost(exact_list(w)).mid()) for cone, w in zip(cones, weights, strict=True))
    rows: list[tuple[fmpq_mat, fmpq, list[tuple[int, int, fmpq]], float]] = []
    round_: list[tuple[int, float]] = []
    for i, (cone, w) in enumerate(zip(cones, weights, strict=True)):
        cost = float(cone.cost(exact_list(w)).mid())
        if cost <= NEGLIGIBLE * total:
            continue
        if cone.norm == "l2":
            round_.append((i, cost))
        else:
            rows += active_rows(i, cone, to_array(cone.scaled()) @ x, w)
    rows = independent_rows(rows, len(x))
    with precision(BITS):
        quadratics = [cones[i].H.transpose() * cones[i].scaled() for i, _ in round_]
        start = [*x, *(r[3] for r in rows), *(c for _, c in round_)]
        z = settle(quadratics, rows, functional, start)
        if z is None:
            return None
        m = len(x)
        found = [to_fmpq(e.mid()) for e in z]
    point = fmpq_mat(m, 1, found[:m])
    done = [[fmpq(0)] * cone.rows for cone in cones]
    for (_, _, shares, _), mu in zip(rows, found[m : m + len(rows)], strict=True):
        for i, j, share in shares:
            done[i][j] += mu * share
    for (i, _), factor in zip(round_, found[m + len(rows) :], strict=True):
        done[i] = [factor * e for e in (cones[i].scaled() * point).entries()]
    return Proposal(found[:m], done)


def active_rows(i: int, cone: Cone, y: Array, w: Array) -> list[Any]:
    """Rows ``a x = b`` of a block whose noise is bounded by planes: its faces at x, with their multipliers."""
    scaled, sizes = cone.scaled().tolist(), cone.size.entries()
    row = lambda j: fmpq_mat(1, len(scaled[j]), scaled[j])  # noqa: E731
    signs = [1 if e > 0 else -1 for e in y]
    if cone.norm == "linf":
        heavy = [j for j in range(len(y)) if abs(w[j]) > NEGLIGIBLE * np.abs(w).max()]
        return [
            (row(j) * fmpq(signs[j]), fmpq(1), [(i, j, signs[j] / sizes[j])], abs(w[j]) * whole(sizes[j]))
            for j in heavy
        ]
    most = max(abs(w[j]) * whole(sizes[j]) for j in range(len(y)))
    full = [j for j in range(len(y)) if abs(y[j]) > ACTIVE]
    zero = [j for j in range(len(y)) if abs(y[j]) <= ACTIVE and abs(w[j]) > NEGLIGIBLE * np.abs(w).max()]
    face = sum((row(j) * fmpq(signs[j]) for j in full), row(0) * fmpq(0))
    shares = [(i, j, signs[j] / sizes[j]) for j in full]
    flat = [(row(j), fmpq(0), [(i, j, 1 / sizes[j])], w[j] * whole(sizes[j])) for j in zero]
    return [(face, fmpq(1), shares, most), *flat]


def whole(q: fmpq) -> float:
    """A rational as a double."""
    return int(q.p) / int(q.q)


def independent_rows(rows: Sequence[Any], m: int) -> list[Any]:
    """Rows that are independent of those with larger multipliers, at most m."""
    kept: list[Any] = []
    for row in sorted(rows, key=lambda row: -abs(row[3])):
        block = fmpq_mat(len(kept) + 1, m, [e for r in (*kept, row) for e in r[0].entries()])
        if block.rank() == len(kept) + 1:
            kept.append(row)
    return kept


def settle(
    quadratics: Sequence[fmpq_mat], rows: Sequence[Any], functional: fmpq_mat, start: Sequence[float]
) -> list[arb] | None:
    """Newton's method from doubles; None where the system is singular or the steps do not vanish."""
    m, k = functional.nrows(), len(rows)
    A = arb_mat(k, m, [arb(e) for row in rows for e in row[0].entries()])
    Q = [arb_mat(q) for q in quadratics]
    P, b = arb_mat(functional), arb_mat(k, 1, [arb(row[1]) for row in rows])
    z = [arb(float(e)) for e in start]
    for _ in range(STEPS):
        x, mu, factors = arb_mat(m, 1, z[:m]), arb_mat(k, 1, z[m : m + k]), z[m + k :]
        hessian = arb_mat(m, m)
        for factor, q in zip(factors, Q, strict=True):
            hessian = hessian + q * factor
        slopes = [q * x for q in Q]
        F = [*(hessian * x + A.transpose() * mu - P).entries(), *(A * x - b).entries()]
        F += [((x.transpose() * slope)[0, 0] - 1) / 2 for slope in slopes]
        n = len(z)
        J = arb_mat(n, n)
        for i in range(m):
            for j in range(m):
                J[i, j] = hessian[i, j]
            for j in range(k):
                J[i, m + j] = J[m + j, i] = A[j, i]
            for j, slope in enumerate(slopes):
                J[i, m + k + j] = J[m + k + j, i] = slope[i, 0]
        try:
            step = J.solve(arb_mat(n, 1, F)).entries()
        except ZeroDivisionError:
            return None
        z = [(a - s).mid() for a, s in zip(z, step, strict=True)]
        size = max(float(abs(s).mid()) / max(1.0, abs(float(a))) for s, a in zip(step, z, strict=True))
        if not size < 1e6:
            return None
        if size < GOAL:
            return z
    return None
