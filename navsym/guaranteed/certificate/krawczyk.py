"""Krawczyk's test in balls: a box that contains exactly one solution of the optimality system, whole or by blocks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, arb_mat, ctx, fmpq

from navsym.core.balls import precision
from navsym.guaranteed.certificate.enclosure import PanelProblem, interval_ball
from navsym.guaranteed.certificate.polish import ContactSolution, series_rows

# Krawczyk's test: a box that contains exactly one exact solution of a square system.


def krawczyk(centre: Sequence[arb], radius: Sequence[arb], value: Sequence[arb], jacobian: arb_mat) -> list[arb] | None:
    """Balls around the only zero of F in ``centre +- radius``, or None when the test fails.

    centre   : exact midpoint of the box
    value    : F(centre), enclosed
    jacobian : F' enclosed over the whole box

    With any matrix Y the set ``K = z - Y F(z) + (I - Y F'(Z)) (Z - z)`` contains every zero in Z;
    when K lies inside Z a zero exists and is the only one. Krawczyk 1969; Neumaier, Interval
    Methods for Systems of Equations, section 5.1.
    """
    for bits in (ctx.prec // 2 + 32, ctx.prec):
        image = krawczyk_step(centre, radius, value, jacobian, bits)
        if image is not None and image_inside(image, centre, radius) is not None:
            return image
    return None


def image_inside(image: list[arb], centre: Sequence[arb], radius: Sequence[arb]) -> list[arb] | None:
    """The image when it lies in the interior of the box, else None; a ball that is not finite lies nowhere."""
    return image if all(bool(abs(k - z) < r) for k, z, r in zip(image, centre, radius, strict=True)) else None


def krawczyk_step(
    centre: Sequence[arb], radius: Sequence[arb], value: Sequence[arb], jacobian: arb_mat, bits: int
) -> list[arb] | None:
    """The set K with a matrix Y of some bits; only ``I - Y F'(Z)`` is computed with so few."""
    n = len(centre)
    with precision(bits):
        try:
            Y = jacobian.mid().inv().mid()
        except ZeroDivisionError:
            return None
        spread = (arb_mat(n, n, 1) - Y * jacobian) * arb_mat(n, 1, [r * arb(0, 1) for r in radius])
    shift = Y * arb_mat(n, 1, list(value))
    return [z - s + d for z, s, d in zip(centre, shift.entries(), spread.entries(), strict=True)]


# Krawczyk's test of a full alternance, by blocks: as many contacts as unknowns of the problem.
#
# The optimality system in (x, inner places v, weights w) is ``B x = s sigma``, ``S x = 0``, ``B^T w = P``, B with the
# rows ``H(v_i)``, S with their slopes. Its derivative is triangular by blocks but for the slopes f'(v_i), which vanish
# at the solution. So the matrix Y of the test is applied and never made: with C near B^-1, D near 1/f'' and G near
# diag(w) S
#
#     Y (r1, r2, r3) = (dx, dv, dw),   dx = C r1,   dv = D (r2 - S_0 dx),   dw = C^T (r3 - G^T dv),
#
# S_0 near S. The only products of matrices are those of C and B, a third as large as the whole system.


@dataclass(frozen=True, slots=True, eq=False)
class JacobianBlocks:
    """Over a box: B, S and diag(w) S (l, m), and ``f'``, ``f''`` (l, 1) at the places; zeros at ends."""

    values: arb_mat
    slopes: arb_mat
    weighted: arb_mat
    slope: arb_mat
    bend: arb_mat


@dataclass(frozen=True, slots=True, eq=False)
class BlockInverse:
    """Exact midpoints: C, D, S_0 and G of the head of this file."""

    values: arb_mat
    bend: arb_mat
    slopes: arb_mat
    weighted: arb_mat

    def applied(self, r1: arb_mat, r2: arb_mat, r3: arb_mat) -> tuple[arb_mat, arb_mat, arb_mat]:
        """Y r."""
        dx = self.values * r1
        dv = entrywise(self.bend, r2 - self.slopes * dx)
        return dx, dv, self.values.transpose() * (r3 - self.weighted.transpose() * dv)

    def defect(self, J: JacobianBlocks, x: arb_mat, v: arb_mat, w: arb_mat) -> tuple[arb_mat, arb_mat, arb_mat]:
        """``(I - Y J) d`` for the step d = (x, v, w), with everything that cancels taken out by hand."""
        C, one = self.values, arb_mat(self.values.nrows(), self.values.nrows(), 1)
        ex = (one - C * J.values) * x - C * entrywise(J.slope, v)
        turn = column([1 - d * b for d, b in zip(self.bend.entries(), J.bend.entries(), strict=True)])
        ev = entrywise(turn, v) - entrywise(self.bend, (J.slopes - self.slopes) * x + self.slopes * ex)
        rest = (J.weighted - self.weighted).transpose() * v + self.weighted.transpose() * ev
        return ex, ev, (one - J.values * C).transpose() * w - C.transpose() * rest


def alternance_image(
    problem: PanelProblem, found: ContactSolution, centre: Sequence[arb], radius: Sequence[arb]
) -> list[arb] | None:
    """Balls around the only exact solution in ``centre +- radius``, or None when the test fails.

    The unknowns are x, the inner places and the weights, in this order; the contacts are as many as the x.
    Y and I - Y J need only be good for contraction: few bits first, and bounds of whole panels.
    """
    thin = block_rows(problem, found, centre, 2)
    F, around = block_residual(problem, found, centre, thin), [r * arb(0, 1) for r in radius]
    box = [c + r for c, r in zip(centre, around, strict=True)]
    within = all(bool(at >= 0) and bool(at <= 1) for at in split_unknowns(found, box)[1].entries())
    for bits, whole in ((ctx.prec // 2 + 32, within), (ctx.prec, False)):
        with precision(bits):
            rows = rows_around(problem, found, thin, around) if whole else block_rows(problem, found, box, 2)
            step = block_step(found, F, jacobian_blocks(found, rows, box), around)
        image = (
            None if step is None else image_inside([c + d for c, d in zip(centre, step, strict=True)], centre, radius)
        )
        if image is not None:
            return image
    return None


def block_step(
    found: ContactSolution, F: tuple[arb_mat, arb_mat, arb_mat], J: JacobianBlocks, around: Sequence[arb]
) -> list[arb] | None:
    """``-Y F + (I - Y J) d`` for all d in the balls ``around`` zero; None where Y cannot be made."""
    Y = block_inverse(J)
    if Y is None:
        return None
    shift, spread = (
        join_unknowns(found, Y.applied(*F)),
        join_unknowns(found, Y.defect(J, *split_unknowns(found, around))),
    )
    return [d - s for s, d in zip(shift, spread, strict=True)]


def split_unknowns(found: ContactSolution, z: Sequence[arb]) -> tuple[arb_mat, arb_mat, arb_mat]:
    """(x, v, w) as columns, zero for the places at ends, which are no unknowns."""
    m, l = len(found.dual), len(found.v)
    free = iter(z[m : len(z) - l])
    return column(z[:m]), column([next(free) if inner else arb(0) for inner in found.inner]), column(z[len(z) - l :])


def join_unknowns(found: ContactSolution, parts: tuple[arb_mat, arb_mat, arb_mat]) -> list[arb]:
    """The unknowns in a list."""
    x, v, w = (part.entries() for part in parts)
    return [*x, *(at for at, inner in zip(v, found.inner, strict=True) if inner), *w]


def block_rows(problem: PanelProblem, found: ContactSolution, z: Sequence[arb], order: int) -> list[arb_mat]:
    """Taylor coefficients 0 … order of H at the places in z."""
    free = iter(z[len(found.dual) :])
    at = [next(free) if inner else v for v, inner in zip(found.v, found.inner, strict=True)]
    return series_rows(problem.panels, found.panel, at, found.inner, order)


def rows_around(
    problem: PanelProblem, found: ContactSolution, thin: list[arb_mat], around: Sequence[arb]
) -> list[arb_mat]:
    """Taylor coefficients 0 … 2 of H for every place within ``around`` of those of ``thin`` and on its panel.

    ``c_k(v + d)`` lies in ``c_k(v) + d (k + 1) C_(k+1)`` where C holds for the whole panel (mean value theorem).
    """
    used = sorted(set(found.panel))
    whole = {k: problem.panels[k].series(interval_ball(fmpq(0), fmpq(1)), arb(1), 3) for k in used}
    d, size = split_unknowns(found, around)[1].entries(), len(found.v)
    shifts = arb_mat([[d[i] if i == j else 0 for j in range(size)] for i in range(size)])
    bounds = [arb_mat([[h[k + 1] for h in whole[place]] for place in found.panel]) for k in range(3)]
    return [row + shifts * bound * (k + 1) for k, (row, bound) in enumerate(zip(thin, bounds, strict=True))]


def block_residual(
    problem: PanelProblem, found: ContactSolution, z: Sequence[arb], rows: Sequence[arb_mat]
) -> tuple[arb_mat, arb_mat, arb_mat]:
    """``B x - s sigma, S x, B^T w - P`` at z, from H and its slopes there."""
    x, _, w = split_unknowns(found, z)
    B, S = rows[:2]
    bounds = [s * problem.panels[k].bound() for k, s in zip(found.panel, found.sign, strict=True)]
    return B * x - column(bounds), S * x, B.transpose() * w - column(problem.target())


def jacobian_blocks(found: ContactSolution, rows: Sequence[arb_mat], z: Sequence[arb]) -> JacobianBlocks:
    """The parts of the derivative over a box z, from the Taylor coefficients of H over it."""
    x, _, w = split_unknowns(found, z)
    B, S, bends = rows
    weighted = arb_mat([[a * h for h in row] for a, row in zip(w.entries(), S.tolist(), strict=True)])
    return JacobianBlocks(B, S, weighted, S * x, bends * x * 2)


def block_inverse(J: JacobianBlocks) -> BlockInverse | None:
    """C, D, S_0 and G from midpoints; None where B is singular."""
    try:
        C = J.values.mid().inv().mid()
    except ZeroDivisionError:
        return None
    D = [arb(0) if b == 0 else (1 / b.mid()).mid() for b in J.bend.entries()]
    return BlockInverse(C, column(D), J.slopes.mid(), J.weighted.mid())


def column(entries: Sequence[arb]) -> arb_mat:
    return arb_mat(len(entries), 1, list(entries))


def entrywise(a: arb_mat, b: arb_mat) -> arb_mat:
    """Entry by entry."""
    return column([p * q for p, q in zip(a.entries(), b.entries(), strict=True)])
