"""How far a rounded sum of squares may lie from the exact one, so that nothing is dropped that might win.

Let ``Hm`` bound the heights of map and profile, ``u = 2**-24`` (single) or ``2**-53`` (double). One interpolated
difference ``d = z - (a + g (b - a))`` is computed with an error of at most ``16 u Hm``: the inputs a, b, z are
rounded (u Hm each), g is rounded (u), and of the four operations the results are bounded by 2 Hm, 2 Hm,
Hm (1 + u) and 2 Hm; the terms add up to 13 u Hm and less than u Hm for products of errors. By the triangle
inequality the root of a sum of m squares moves by at most ``16 u Hm sqrt(m)``; the summation itself has the relative
error ``gamma = (m + 2) u / (1 - (m + 2) u)`` in any order. Hence

    sqrt(exact) >= sqrt(computed / (1 + gamma)) - parts u Hm sqrt(m),  parts = 16.

Other sums have other parts:

* first interpolation in single precision too: 10 u Hm in the place of u Hm for a and b, 40 in all; BLENDED = 48.
* contrasts of four (``add_four_centred``): three rows of an orthonormal matrix, so the errors of four differences
  have no more weight than before, 16 u Hm sqrt(m); rounding the contrasts adds 2.9, 2.9 and 8 u Hm to each
  four, 9 u Hm in the root, that is 4.5 u Hm sqrt(m): CONTRASTS = 24.
* squares about the mean of m differences (``about_the_mean``): the mean is off by at most (m + 2) u 2.01 Hm, and taking
  off a wrong mean adds its square m times: :func:`parts_about_the_mean`.

Positions are always computed in double by the same expression, so they do not enter the comparison.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

SINGLE, DOUBLE = 2.0**-24, 2.0**-53
#: Error of a difference in units of u Hm: as above, both interpolations single, contrasts of four.
PLAIN, BLENDED, CONTRASTS = 16.0, 48.0, 24.0


def parts_about_the_mean(n: int) -> float:
    """Error, in units of u Hm, of n differences less their computed mean: 16 and 2.01 (n + 2)."""
    return PLAIN + 2.1 * (n + 4)


def ceiling_of(value: float, n: int, bound: float, parts: float = PLAIN) -> float:
    """Upper bound of the exact criterion of any hypothesis whose double sum is at most ``value``."""
    gamma = (n + 4) * DOUBLE
    root = math.sqrt(value) * (1.0 + gamma) + parts * DOUBLE * bound * math.sqrt(n)
    return root * root * (1.0 + 8.0 * DOUBLE)


def single_limit(ceiling: float, m: int, bound: float, parts: float = PLAIN) -> float:
    """A single-precision sum of m squares above this has an exact sum above ``ceiling``."""
    gamma = (m + 2) * SINGLE / (1.0 - (m + 2) * SINGLE)
    root = math.sqrt(ceiling) + parts * SINGLE * bound * math.sqrt(m)
    return root * root * (1.0 + gamma) * (1.0 + 8.0 * DOUBLE)


def double_limit(ceiling: float, n: int, bound: float, parts: float = PLAIN) -> float:
    """A double sum of squares, added in any order to a lower bound, above this exceeds ``ceiling``.

    With e = parts u Hm sqrt(n), g = (n + 4) u and X above (sqrt(c) (1 + 4 g) + 4 e)^2, the exact sum is at
    least X (1 - g) - 2 e sqrt(X), which is above c. Chunks of m_i with e_i = parts u Hm sqrt(m_i) may be added:
    sum e_i sqrt(X_i) <= e sqrt(X) by Cauchy and Schwarz.
    """
    gamma = (n + 4) * DOUBLE
    root = math.sqrt(ceiling) * (1.0 + 4.0 * gamma) + 4.0 * parts * DOUBLE * bound * math.sqrt(n)
    return root * root * (1.0 + 8.0 * DOUBLE)


def floor_of(sums: NDArray[np.float32], m: int, bound: float, parts: float = PLAIN) -> NDArray[np.float64]:
    """Lower bounds of the exact sums of m squares, from their single-precision values."""
    gamma = (m + 2) * SINGLE / (1.0 - (m + 2) * SINGLE)
    roots = np.sqrt(sums.astype(np.float64) / (1.0 + gamma)) - parts * SINGLE * bound * math.sqrt(m)
    return np.maximum(roots, 0.0) ** 2 * (1.0 - 8.0 * DOUBLE)
