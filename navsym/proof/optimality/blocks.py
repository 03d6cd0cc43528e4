"""Krawczyk's test of a full alternance, by blocks: as many contacts as unknowns of the problem.

The optimality system in (x, inner places v, weights w) is ``B x = s sigma``, ``S x = 0``, ``B^T w = P``, B with the
rows ``H(v_i)``, S with their slopes. Its derivative is triangular by blocks but for the slopes f'(v_i), which vanish
at the solution. So the matrix Y of the test is applied and never made: with C near B^-1, D near 1/f'' and G near
diag(w) S

    Y (r1, r2, r3) = (dx, dv, dw),   dx = C r1,   dv = D (r2 - S_0 dx),   dw = C^T (r3 - G^T dv),

S_0 near S. The only products of matrices are those of C and B, a third as large as the whole system.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, arb_mat, ctx

from navsym.proof.balls import precision
from navsym.proof.optimality.enclosure import Problem
from navsym.proof.optimality.existence import inside
from navsym.proof.optimality.polish import Polished


@dataclass(frozen=True, slots=True, eq=False)
class Blocks:
    """Over a box: B, S and diag(w) S (l, m), and ``f'``, ``f''`` (l, 1) at the places; zeros at ends."""

    values: arb_mat
    slopes: arb_mat
    weighted: arb_mat
    slope: arb_mat
    bend: arb_mat


@dataclass(frozen=True, slots=True, eq=False)
class Inverse:
    """Exact midpoints: C, D, S_0 and G of the head of this file."""

    values: arb_mat
    bend: arb_mat
    slopes: arb_mat
    weighted: arb_mat

    def applied(self, r1: arb_mat, r2: arb_mat, r3: arb_mat) -> tuple[arb_mat, arb_mat, arb_mat]:
        """Y r."""
        dx = self.values * r1
        dv = times(self.bend, r2 - self.slopes * dx)
        return dx, dv, self.values.transpose() * (r3 - self.weighted.transpose() * dv)

    def defect(self, J: Blocks, x: arb_mat, v: arb_mat, w: arb_mat) -> tuple[arb_mat, arb_mat, arb_mat]:
        """``(I - Y J) d`` for the step d = (x, v, w), with everything that cancels taken out by hand."""
        C, one = self.values, unit(self.values.nrows())
        ex = (one - C * J.values) * x - C * times(J.slope, v)
        turn = column([1 - d * b for d, b in zip(self.bend.entries(), J.bend.entries(), strict=True)])
        ev = times(turn, v) - times(self.bend, (J.slopes - self.slopes) * x + self.slopes * ex)
        rest = (J.weighted - self.weighted).transpose() * v + self.weighted.transpose() * ev
        return ex, ev, (one - J.values * C).transpose() * w - C.transpose() * rest


def alternance_image(
    problem: Problem, found: Polished, centre: Sequence[arb], radius: Sequence[arb]
) -> list[arb] | None:
    """Balls around the only exact solution in ``centre +- radius``, or None when the test fails.

    The unknowns are x, the inner places and the weights, in this order; the contacts are as many as the x.
    """
    F = residual(problem, found, centre)
    for bits in (ctx.prec // 2 + 32, ctx.prec):  # Y and I - Y J need only be good for contraction
        with precision(bits):
            step = newton_step(problem, found, F, centre, radius)
        image = None if step is None else inside([c + d for c, d in zip(centre, step, strict=True)], centre, radius)
        if image is not None:
            return image
    return None


def newton_step(
    problem: Problem, found: Polished, F: tuple[arb_mat, arb_mat, arb_mat], centre: Sequence[arb],
    radius: Sequence[arb],
) -> list[arb] | None:  # fmt: skip
    """``-Y F + (I - Y J)(Z - z)`` over the box Z around z; None where Y cannot be made."""
    around = [r * arb(0, 1) for r in radius]
    J = blocks(problem, found, [c + r for c, r in zip(centre, around, strict=True)])
    Y = inverse(J)
    if Y is None:
        return None
    shift, spread = gathered(found, Y.applied(*F)), gathered(found, Y.defect(J, *parted(found, around)))
    return [d - s for s, d in zip(shift, spread, strict=True)]


def parted(found: Polished, z: Sequence[arb]) -> tuple[arb_mat, arb_mat, arb_mat]:
    """(x, v, w) as columns, zero for the places at ends, which are no unknowns."""
    m, l = len(found.dual), len(found.v)
    free = iter(z[m : len(z) - l])
    return column(z[:m]), column([next(free) if inner else arb(0) for inner in found.inner]), column(z[len(z) - l :])


def gathered(found: Polished, parts: tuple[arb_mat, arb_mat, arb_mat]) -> list[arb]:
    """The unknowns in a list."""
    x, v, w = (part.entries() for part in parts)
    return [*x, *(at for at, inner in zip(v, found.inner, strict=True) if inner), *w]


def series_rows(problem: Problem, found: Polished, v: Sequence[arb], order: int) -> list[arb_mat]:
    """Taylor coefficients 0 … order of H at the places, (l, m) each; zeros beyond the first at ends."""
    rows: list[list[list[arb]]] = [[] for _ in range(order + 1)]
    still = [arb(0)] * len(found.dual)
    for k, at, exact_at, inner in zip(found.panel, v, found.v, found.inner, strict=True):
        series = problem.panels[k].series(at if inner else exact_at, arb(1), order if inner else 0)
        for d, row in enumerate(rows):
            row.append([h[d] for h in series] if inner or d == 0 else still)
    return [arb_mat(row) for row in rows]


def residual(problem: Problem, found: Polished, z: Sequence[arb]) -> tuple[arb_mat, arb_mat, arb_mat]:
    """``B x - s sigma, S x, B^T w - P`` at z."""
    x, v, w = parted(found, z)
    B, S = series_rows(problem, found, v.entries(), 1)
    bounds = [s * problem.panels[k].bound() for k, s in zip(found.panel, found.sign, strict=True)]
    return B * x - column(bounds), S * x, B.transpose() * w - column(problem.target())


def blocks(problem: Problem, found: Polished, z: Sequence[arb]) -> Blocks:
    """The parts of the derivative over a box z."""
    x, v, w = parted(found, z)
    B, S, bends = series_rows(problem, found, v.entries(), 2)
    weighted = arb_mat([[a * h for h in row] for a, row in zip(w.entries(), S.tolist(), strict=True)])
    return Blocks(B, S, weighted, S * x, bends * x * 2)


def inverse(J: Blocks) -> Inverse | None:
    """C, D, S_0 and G from midpoints; None where B is singular."""
    try:
        C = J.values.mid().inv().mid()
    except ZeroDivisionError:
        return None
    D = [arb(0) if b == 0 else (1 / b.mid()).mid() for b in J.bend.entries()]
    return Inverse(C, column(D), J.slopes.mid(), J.weighted.mid())


def column(entries: Sequence[arb]) -> arb_mat:
    return arb_mat(len(entries), 1, list(entries))


def unit(size: int) -> arb_mat:
    return arb_mat(size, size, 1)


def times(a: arb_mat, b: arb_mat) -> arb_mat:
    """Entry by entry."""
    return column([p * q for p, q in zip(a.entries(), b.entries(), strict=True)])
