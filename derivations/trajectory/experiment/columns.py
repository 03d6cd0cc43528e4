"""The best diagonal scaling of the columns of N_f, to compare unit columns with.

For a matrix whose entries are positive and whose inverse has chessboard signs, the logarithm of the condition
number of N diag(exp(x)) is a convex function of x: each extreme singular value is the Perron root of a positive
matrix with entries exp(linear in x), and such a root is log-convex (Kingman 1961). Its gradient is
v_j^2 - w_j^2, with v and w the right singular vectors of the largest and the smallest singular value, so that
the optimum is where both have entries of equal size. One optimum, found by any descent; the value that is
reported is certified for the scaling rounded to exact numbers.
"""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from navsym.core.arrays import Array
from navsym.core.errors import TooLargeError
from navsym.models.earth import power_rows
from navsym.trajectory.conditioning import condition_number
from navsym.trajectory.enclosure import Enclosure

#: Beyond this order the smallest singular vector drowns in rounding.
LARGEST_SCALED = 12
PLACES = 10**9


@dataclass(frozen=True, slots=True)
class BestScaling:
    """Factors of the columns of N_s (unit columns of N_f) and what they reach.

    factors     : (n,) exact, the first one is 1
    enclosure   : certified condition number of the scaled matrix
    unit        : certified condition number with unit columns
    stationarity: largest |v_j^2 - w_j^2| at the factors; zero at the optimum
    """

    factors: tuple[Fraction, ...]
    enclosure: Enclosure
    unit: Enclosure
    stationarity: float


def best_scaling(n: int, *, digits: int = 20) -> BestScaling:
    """Best scaling of the columns of N_f: least 2-norm condition number over diagonal D of N_f D (trajectory:table).

    n : order of the motion, 2 to 12; digits : of the enclosures. Raises TooLargeError for another order.
    """
    if not 2 <= n <= LARGEST_SCALED:
        raise TooLargeError(f"n: expected 2 to {LARGEST_SCALED}; got {n}; the search works in double precision")
    rows = power_rows(n)
    N_f = np.array(rows, dtype=float)
    lengths = np.linalg.norm(N_f, axis=0)
    x, stationarity = descend(N_f / lengths)
    factors = tuple(Fraction(round(float(f) * PLACES), PLACES) for f in np.exp(x - x[0]))
    scale = [f / Fraction(float(length)) for f, length in zip(factors, lengths, strict=True)]
    scaled = [[entry * s for entry, s in zip(row, scale, strict=True)] for row in rows]
    unit = condition_number(rows, digits=digits, equilibrate=True)
    return BestScaling(factors, condition_number(scaled, digits=digits), unit, stationarity)


def descend(matrix: Array) -> tuple[Array, float]:
    """Minimise log cond(matrix diag(exp(x))) by BFGS; x and the largest entry of the gradient there."""
    from scipy.optimize import minimize

    def value(x: Array) -> tuple[float, Array]:
        _, s, right = np.linalg.svd(matrix * np.exp(x))
        return float(np.log(s[0] / s[-1])), right[0] ** 2 - right[-1] ** 2

    found = minimize(value, np.zeros(matrix.shape[1]), jac=True, method="BFGS", options={"gtol": 1e-10})
    return found.x, float(np.abs(value(found.x)[1]).max())
