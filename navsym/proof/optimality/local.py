"""Taylor coefficients of the regressors about several places at once, and polynomials made of them.

Newton's method on the contacts moves them by less and less, the first time by what a double number lacks: the functions
are expanded once, and what the system needs at moved contacts are sums of a few terms.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, arb_mat

from navsym.proof.optimality.enclosure import Panel

#: Terms of a polynomial, and how far contacts in double precision are expected to move.
MOST_TERMS, MOVE = 9, 12


def series_rows(
    panels: Sequence[Panel], places: Sequence[int], v: Sequence[arb], inner: Sequence[bool], order: int
) -> list[arb_mat]:
    """Taylor coefficients 0 … order of H in the fraction at the places, (l, m) each; zeros beyond the first at ends.

    With balls for v they hold for every centre in them.
    """
    rows: list[list[list[arb]]] = [[] for _ in range(order + 1)]
    for k, at, free in zip(places, v, inner, strict=True):
        series = panels[k].series(at, arb(1), order if free else 0)
        still = [arb(0)] * len(series)
        for d, row in enumerate(rows):
            row.append([h[d] for h in series] if free or d == 0 else still)
    return [arb_mat(row) for row in rows]


@dataclass(frozen=True, slots=True, eq=False)
class Local:
    """H about the places ``at``: ``H_j(at_i + s) = sum_k rows[k][i, j] s**k`` up to terms that are left out."""

    at: tuple[arb, ...]
    rows: tuple[arb_mat, ...]

    def reaches(self, v: Sequence[arb], goal: arb) -> bool:
        """What is left out of slopes at the places v is below the goal, as far as the last term tells."""
        far = max((abs(a - b) for a, b in zip(v, self.at, strict=True)), default=arb(0))
        largest = max(map(arb.abs_upper, self.rows[-1].entries()))
        return far == 0 or bool(len(self.rows) * far ** (len(self.rows) - 1) * max(largest, arb(1)) < goal)

    def sums(self, dual: arb_mat, v: Sequence[arb]) -> tuple[list[arb], list[arb]]:
        """``x . H`` and its slope with respect to the fraction, at every place."""
        c = [(row * dual).entries() for row in self.rows]
        values, slopes = c[-1], [arb(0)] * len(v)
        moves = [a - b for a, b in zip(v, self.at, strict=True)]
        for row in reversed(c[:-1]):
            slopes = [s * d + f for s, d, f in zip(slopes, moves, values, strict=True)]
            values = [f * d + a for f, d, a in zip(values, moves, row, strict=True)]
        return values, slopes

    def balance(self, w: Sequence[arb], v: Sequence[arb]) -> arb_mat:
        """``sum w_i H(v_i)`` as a column."""
        moves = [a - b for a, b in zip(v, self.at, strict=True)]
        share, done = list(w), None
        for row in self.rows:
            part = row.transpose() * arb_mat([[s] for s in share])
            done = part if done is None else done + part
            share = [s * d for s, d in zip(share, moves, strict=True)]
        assert done is not None
        return done


def local(panels: Sequence[Panel], places: Sequence[int], v: Sequence[arb], inner: Sequence[bool], goal: arb) -> Local:
    """H about the places v with as many terms as reach the goal, or the most."""
    digits = -float(goal.log() / arb(10).log())
    order = min(MOST_TERMS - 1, max(2, int(digits / MOVE) + 1))
    return Local(tuple(v), tuple(series_rows(panels, places, v, inner, order)))
