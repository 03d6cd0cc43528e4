"""Compiled criteria of all hypotheses, one at a time: for tracks that may leave the map or cross voids.

Where every node is known these loops give the values of the vector loops of
:mod:`navsym.numeric.search.criteria`; where one is missing the criterion is infinite.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from navsym.numeric.compiled import njit
from navsym.numeric.search.sample import COMPILE, criterion_masked, height_or_nan, offset_free_masked, shift_of


@njit(**COMPILE)
def dense_masked(case: Any, steps: Any, counts: Any, centred: bool, out: np.ndarray) -> None:
    """Criteria of all hypotheses, infinite where the track leaves the map.

    centred : take the mean difference off first, which makes the criterion free of a constant height error
    out     : flat, in the order Vi, Vj, j, i
    """
    d = np.empty(case[3].shape[0])
    for index in range(out.shape[0]):
        shift = shift_of(index, counts, steps)
        out[index] = offset_free_masked(case, shift, d) if centred else criterion_masked(case, shift)


@njit(**COMPILE)
def profile(H: np.ndarray, u: np.ndarray, w: np.ndarray, out: np.ndarray) -> None:
    """Heights along the positions (u, w), in cells; NaN off the map or without data."""
    for k in range(u.shape[0]):
        out[k] = height_or_nan(H, u[k], w[k])


@njit(**COMPILE)
def velocity_criteria(case: Any, centre: np.ndarray, steps: Any, counts: Any, centred: bool, out: np.ndarray) -> None:
    """Criteria of velocity hypotheses turning about one point: the track moved by (tau - centre) v.

    case   : with the times tau (n,) in the place of both wx and wy
    centre : (2, 2) matrix of times, in the axes of the map cells
    steps  : (svx, svy) velocity steps in cells per unit of time ; counts : (Mvx, Mvy)
    out    : (Mvx, Mvy), infinite where the track leaves the map
    """
    d = np.empty(case[3].shape[0])
    for Vi in range(counts[0]):
        for Vj in range(counts[1]):
            vx, vy = (Vi - counts[0] // 2) * steps[0], (Vj - counts[1] // 2) * steps[1]
            cx = centre[0, 0] * vx + centre[0, 1] * vy
            cy = centre[1, 0] * vx + centre[1, 1] * vy
            shift = (-cx, -cy, vx, vy)
            out[Vi, Vj] = offset_free_masked(case, shift, d) if centred else criterion_masked(case, shift)
