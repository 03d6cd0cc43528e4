"""Sets of noise of several measurements: how far a vector is outside, and what weights cost there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import arb, arb_mat

#: Steps of Newton's method, and the size of a step, beside the solution, that ends it.
STEPS, TINY = 14, 1e-40


@dataclass(frozen=True, eq=False)
class Cone:
    """Noise r that is bounded together, in balls.

    norm : "l2" with a positive definite size (p, p): ``r' size^-1 r <= 1``; with sizes (p, 1) "linf": ``|r_j| <= s_j``,
           or "l1": ``sum |r_j|/s_j <= 1``
    """

    norm: str
    size: arb_mat

    @cached_property
    def inverse(self) -> arb_mat:
        """Of a positive definite size."""
        return self.size.inv()

    def square(self) -> arb_mat:
        """K of ``r' K r``, the square of the gauge, or where that is none the sum of squares of all parts."""
        if self.norm == "l2":
            return self.inverse
        sizes = self.size.entries()
        return arb_mat([[1 / s**2 if i == j else arb(0) for i in range(len(sizes))] for j, s in enumerate(sizes)])

    @cached_property
    def shape(self) -> np.ndarray:
        """The inverse of the size for errors in parts of their largest, in doubles."""
        reach = np.sqrt([float(self.size[k, k].mid()) for k in range(self.size.nrows())])
        return to_array(self.inverse) * np.outer(reach, reach)

    def estimate(self, parts: np.ndarray) -> float:
        """The gauge in doubles of errors (p,) that are given in parts of their largest."""
        if self.norm == "l2":
            return float(np.sqrt(max(parts @ self.shape @ parts, 0.0)))
        return float(np.abs(parts).sum() if self.norm == "l1" else np.abs(parts).max())

    def gauge(self, y: arb_mat) -> arb:
        """How many times the allowed noise a vector y (p, 1) is."""
        if self.norm == "l2":
            return root((y.transpose() * self.inverse * y)[0, 0])
        parts = [abs(e) / s for e, s in zip(y.entries(), self.size.entries(), strict=True)]
        return sum(parts, arb(0)) if self.norm == "l1" else largest(parts)

    def cost(self, w: arb_mat) -> arb:
        """The largest ``w . r`` of allowed noise r."""
        if self.norm == "l2":
            return root((w.transpose() * self.size * w)[0, 0])
        costs = [abs(e) * s for e, s in zip(w.entries(), self.size.entries(), strict=True)]
        return sum(costs, arb(0)) if self.norm == "linf" else largest(costs)

    def face(self, y: arb_mat) -> arb_mat:
        """Weights a (p, 1) near those that cost 1 and have ``a . y`` equal to the gauge of y, as exact numbers."""
        if self.norm == "l2":
            return (self.inverse * y / self.gauge(y)).mid()
        sides = [side_of(e) / s for e, s in zip(y.entries(), self.size.entries(), strict=True)]
        parts = [abs(float(e.mid())) / float(s.mid()) for e, s in zip(y.entries(), self.size.entries(), strict=True)]
        keep = range(len(parts)) if self.norm == "l1" else [parts.index(max(parts))]
        return arb_mat([[a if j in keep else arb(0)] for j, a in enumerate(sides)]).mid()

    def worst(self, w: arb_mat) -> list[arb]:
        """Allowed noise r with ``w . r`` equal to the cost of w, which is not zero."""
        if self.norm == "l2":
            return (self.size * w / self.cost(w)).entries()  # type: ignore[no-any-return]
        sides = [s * side_of(e) for e, s in zip(w.entries(), self.size.entries(), strict=True)]
        costs = [abs(float(e.mid())) * float(s.mid()) for e, s in zip(w.entries(), self.size.entries(), strict=True)]
        keep = range(len(costs)) if self.norm == "linf" else [costs.index(max(costs))]
        return [r if j in keep else arb(0) for j, r in enumerate(sides)]


def solve_touching(
    cones: Sequence[tuple[Cone, arb_mat, arb_mat]],
    rows: arb_mat,
    sides: arb_mat,
    target: arb_mat,
    start: Sequence[float],
) -> list[arb] | None:
    """Newton's method for a state x at which balls and rows touch their bounds, and multipliers that carry a target.

    With y = H x - e: ``y' size^-1 y = 1`` for each ball, ``rows x = sides``, and the sum of ``u H' size^-1 y`` and
    ``v rows`` is the target. Residuals are balls, and steps are doubles, the shortest where several states do so.

    cones : (cone, H, e) of norm "l2"
    start : x, u, v
    """
    m, k, size = target.ncols(), len(cones), len(start)
    kernels = [to_array(H.transpose() * cone.inverse * H) for cone, H, _ in cones]
    z, J = arb_mat(size, 1, start), np.zeros((size, size))
    J[m + k :, :m] = to_array(rows)
    for _ in range(STEPS):
        entries = z.entries()
        x, u, v = arb_mat(m, 1, entries[:m]), entries[m : m + k], arb_mat(1, size - m - k, entries[m + k :])
        errors = [H * x - e for _, H, e in cones]
        faces = [y.transpose() * cone.inverse for (cone, *_), y in zip(cones, errors, strict=True)]
        normals = [a * H for a, (_, H, _) in zip(faces, cones, strict=True)]
        rest = sum((n * f for n, f in zip(normals, u, strict=True)), v * rows - target)
        touch = [((a * y)[0, 0] - 1) / 2 for a, y in zip(faces, errors, strict=True)]
        F = np.array([float(e.mid()) for e in (*rest.entries(), *touch, *(rows * x - sides).entries())])
        if not np.abs(F).max() < 1e100:
            return None
        J[m : m + k, :m] = np.vstack([to_array(n) for n in normals])
        J[:m, m:], J[:m, :m] = J[m:, :m].T, sum(float(f) * K for f, K in zip(u, kernels, strict=True))
        high = np.abs(J).max(axis=1)  # units of unknowns may be far apart
        high[high == 0.0] = 1.0
        wide = (np.abs(J) / high[:, None]).max(axis=0)
        wide[wide == 0.0] = 1.0
        move = np.linalg.lstsq(J / np.outer(high, wide), F / high, rcond=1e-11)[0]
        z = (z - arb_mat(size, 1, (move / wide).tolist())).mid()
        if np.abs(move).max() <= TINY * np.abs(to_array(z).ravel() * wide).max():
            return z.entries()  # type: ignore[no-any-return]
    return None


def to_array(matrix: arb_mat) -> np.ndarray:
    """The middles of the balls of a matrix."""
    return np.array([float(e.mid()) for e in matrix.entries()]).reshape(matrix.nrows(), matrix.ncols())


def root(square: arb) -> arb:
    """The square root of a square, or a number above it where the ball reaches zero."""
    return (square if square > 0 else arb(abs(square).upper())).sqrt()


def largest(balls: list[arb]) -> arb:
    """The largest of some balls."""
    found = balls[0]
    for ball in balls[1:]:
        found = found.max(ball)
    return found


def side_of(x: arb) -> int:
    """The sign of the middle of a ball, 1 for zero."""
    return -1 if x.mid() < 0 else 1
