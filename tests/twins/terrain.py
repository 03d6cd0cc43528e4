"""Plain twins of the terrain search: one hypothesis at a time, the double sums of the paper."""

from __future__ import annotations

from typing import Any

import numpy as np

from navsym.core.loops import njit
from navsym.terrain.centre import Array
from navsym.terrain.kernels.criteria import COMPILE, criterion_one, shift_of


def quadratic_slowly(gx: Array, gy: Array, times: Array) -> tuple[float, float, float]:
    """Twin of :attr:`Information.quadratic`: the double sums of the paper, corrected (terrain_search:12*)."""
    A2 = A1 = A0 = 0.0
    for i, t in enumerate(times):
        for j in range(len(times)):
            cross = gx[i] * gy[j] - gy[i] * gx[j]
            A2 += t * gx[i] * gx[j] * cross
            A1 += t * ((gx[i] * gy[j]) ** 2 - (gy[i] * gx[j]) ** 2)
            A0 += t * gy[i] * gy[j] * cross
    return A2, A1, A0


@njit(**COMPILE)
def dense_slowly(case: Any, steps: Any, counts: Any, out: np.ndarray) -> None:
    """Twin of :func:`slab` for all Vi, one hypothesis at a time. out : flat, in the order Vi, Vj, j, i."""
    for index in range(out.shape[0]):
        out[index] = criterion_one(case, shift_of(index, counts, steps), np.inf)
