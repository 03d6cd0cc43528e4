"""``|x . H| <= sigma`` on a whole panel: one polynomial with a proved remainder for all coarse cells.

About the middle of the panel, with ``v = (1 + u) / 2`` and u in [-1, 1], Taylor's formula with Lagrange's
remainder holds for f and each of its derivatives with one and the same ball R around ``f^(n)(xi) / n!``, xi
anywhere on the panel: ``f^(d)(u) / d! = sum_k<n binom(k, d) c_k u^(k-d) + binom(n, d) R u^(n-d)`` for d < n. So
the polynomial with the coefficients ``c_0 … c_(n-1), R`` encloses every Taylor coefficient at every place, and
shifted to a cell it does what a new expansion of all functions does, for a fifth of the time.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from flint import arb, arb_poly, fmpq

from navsym.guaranteed.certificate.enclosure import (
    Expansion,
    Panel,
    PanelCell,
    Touch,
    interval_ball,
    prove_by_cells,
    taylor_order,
)

HALF = fmpq(1, 2)
#: Orders of the polynomial that are tried, and how small R must be, as a part of the bound.
LARGEST, SMALL = 48, arb(2) ** -20
#: What varies by less than so many times that is called constant.
FLAT = 16
#: Cells shorter than this part of the panel are expanded on their own: R may be too much for them.
SHORTEST_CELL = fmpq(1, 1 << 16)


def prove_panel_bound(panel: Panel, x: Sequence[arb], touches: Sequence[Touch], limit: int = 4000) -> int | None:
    """Number of cells that prove ``|x . H| <= sigma`` on the whole panel, or None."""
    anew: Expansion = partial(expand_cell, panel, x)
    model = panel_polynomial(panel, x)
    expand = anew if model is None else partial(shift_polynomial, model, anew)
    return prove_by_cells(panel.bound(), touches, limit, expand)


def panel_polynomial(panel: Panel, x: Sequence[arb]) -> arb_poly | None:
    """The coefficients ``c_0 … c_(n-1), R`` of f in u, or None where they do not help.

    No R may be small; balls in the data may make the coefficients wide, each on its own, while f is not; or f is
    almost constant, so that all of it may lie nearer to the bound than R.
    """
    wide = panel.dual_polynomial(x, interval_ball(fmpq(0), fmpq(1)), HALF, LARGEST)
    small = SMALL * panel.bound()
    order = next((k for k in range(3, LARGEST + 1) if bool(abs(wide[k]) < small)), None)
    if order is None:
        return None
    thin = panel.dual_polynomial(x, arb(HALF), HALF, order - 1)
    wavering = sum((abs(c) for c in thin[1:]), abs(wide[order]))
    if bool(wavering < FLAT * small) or not bool(sum((c.rad() for c in thin), arb(0)) < small):
        return None
    return arb_poly([*thin, wide[order]])


def shift_polynomial(model: arb_poly, anew: Expansion, cell: PanelCell, centre: fmpq, radius: fmpq) -> list[arb]:
    """What :func:`expand_cell` gives, from the polynomial of the panel; where that is too coarse, anew.

    Near a touch that is not exact a bound is met up to the last digits, which R does not have.
    """
    fine = cell.touch is not None and not cell.touch.exact
    if fine or cell.upper - cell.lower < SHORTEST_CELL:
        return anew(cell, centre, radius)
    taylor: list[arb] = model(arb_poly([arb(2 * centre - 1), arb(2 * radius)])).coeffs()
    return taylor + [arb(0)] * (3 - len(taylor))


def expand_cell(panel: Panel, x: Sequence[arb], cell: PanelCell, centre: fmpq, radius: fmpq) -> list[arb]:
    """Taylor coefficients of f in w, fraction ``centre + radius w``; the last one holds over the whole cell."""
    order = taylor_order(len(x))
    point = panel.dual_polynomial(x, arb(centre), radius, order - 1)
    wide = panel.dual_polynomial(x, interval_ball(cell.lower, cell.upper), radius, order)
    return [*point, wide[order]]
