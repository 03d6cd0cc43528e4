"""The value of an exchange in twofold precision: sums of two doubles, with the error of every step kept.

For contacts u, weights w and a dual x that are right to half of the digits, the Lagrangian
``x . p - sum w_i (f(u_i) - s_i)``, with ``f = x . q``, is right to all of them: it is stationary in x, in w and
in the inner contacts. What remains is to compute it without loss. Knuth's sum, Dekker's product.
"""

from __future__ import annotations

import numpy as np

from navsym.numeric.exchange.kernels import Array, Ints
from navsym.numeric.tiers import kernel, part


@part
def two_sum(a: float, b: float) -> tuple[float, float]:
    """a + b as a double and what it lacks."""
    total = a + b
    part_of_b = total - a
    return total, (a - (total - part_of_b)) + (b - part_of_b)


@part
def two_product(a: float, b: float) -> tuple[float, float]:
    """a b as a double and what it lacks."""
    product = a * b
    c = 134217729.0 * a
    a_high = c - (c - a)
    c = 134217729.0 * b
    b_high = c - (c - b)
    a_low, b_low = a - a_high, b - b_high
    return product, a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low)


@part
def twofold_dot(high: Array, low: Array, x: Array) -> tuple[float, float]:
    """``(high + low) . x``."""
    total, rest = 0.0, 0.0
    for k in range(x.shape[0]):
        product, error = two_product(high[k], x[k])
        total, lost = two_sum(total, product)
        rest += error + lost + low[k] * x[k]
    return two_sum(total, rest)


@part
def twofold_sum(high: Array, low: Array, u: float) -> tuple[float, float]:
    """``sum (high_k + low_k) T_k(u)`` by Clenshaw's recurrence."""
    b1, b2, l1, l2 = 0.0, 0.0, 0.0, 0.0
    for k in range(high.shape[0] - 1, 0, -1):
        product, error = two_product(2.0 * u, b1)
        total, lost = two_sum(product, -b2)
        total, more = two_sum(total, high[k])
        rest = 2.0 * u * l1 - l2 + low[k] + (error + lost + more)
        b2, l2 = b1, l1
        b1, l1 = two_sum(total, rest)
    product, error = two_product(u, b1)
    total, lost = two_sum(product, -b2)
    total, more = two_sum(total, high[0])
    return two_sum(total, u * l1 - l2 + low[0] + (error + lost + more))


@kernel
def lagrangian(
    C: Array, C_low: Array, p: Array, p_low: Array, panel: Ints, u: Array, sign: Array, weights: Array, x: Array
) -> float:
    """``x . p - sum w_i (f(u_i) - s_i)`` to the last bit or two."""
    panels, K, _ = C.shape
    high, low = np.empty((panels, K)), np.empty((panels, K))
    for j in range(panels):
        for k in range(K):
            high[j, k], low[j, k] = twofold_dot(C[j, k], C_low[j, k], x)
    total, rest = twofold_dot(p, p_low, x)
    for i in range(u.shape[0]):
        f, f_low = twofold_sum(high[panel[i]], low[panel[i]], u[i])
        miss = (f - sign[i]) + f_low
        product, error = two_product(-weights[i], miss)
        total, lost = two_sum(total, product)
        rest += error + lost
    return total + rest
