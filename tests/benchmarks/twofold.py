"""The value of an exchange in twofold precision: sums of two doubles, with the error of every step kept.

The search of :mod:`navsym.guaranteed.search` gives contacts, weights and a dual in doubles; what it is worth shows
against a peer when its value is right to the last bits.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from weakref import WeakKeyDictionary

import numpy as np
from flint import arb, arb_mat

from navsym.core.balls import precision
from navsym.core.loops import kernel, part
from navsym.guaranteed.certificate.basis import (
    NODE_BITS,
    RESOLVED,
    Basis,
    first_count,
    sample_panels,
    tail_share,
    to_doubles,
)
from navsym.guaranteed.certificate.enclosure import PanelProblem
from navsym.guaranteed.search.exchange import Contacts, Panels
from navsym.guaranteed.search.kernels import Array, Ints

#: Up to so many points a panel the functions are computed in balls and resolved beyond the digits of a double.
SHARP, SHARP_RESOLVED = 96, 1e-19


@dataclass(frozen=True, eq=False)
class SharpPanels:
    """Panels, and what the doubles of their coefficients and functional lack."""

    panels: Panels
    coefficients_low: Array
    functional_low: Array

    def value(self, found: Contacts) -> float:
        """Of the optimum with these contacts, to the last bits."""
        C, p = self.panels.coefficients, self.panels.functional
        places = (found.panel, found.u, found.sign, found.weights, found.dual)
        return lagrangian(C, self.coefficients_low, p, self.functional_low, *places)


def exact_panels(panels: Panels) -> SharpPanels:
    """Panels whose doubles lack nothing."""
    return SharpPanels(panels, np.zeros_like(panels.coefficients), np.zeros_like(panels.functional))


#: What was made for a basis, as long as that is there.
MADE: WeakKeyDictionary[Basis, SharpPanels] = WeakKeyDictionary()


def sharp_panels(basis: Basis, problem: PanelProblem) -> SharpPanels:
    """The panels of the basis of a problem with what their doubles lack, made at the first use."""
    if basis not in MADE:
        MADE[basis] = make_sharp(basis, problem)
    return MADE[basis]


def make_sharp(basis: Basis, problem: PanelProblem) -> SharpPanels:
    """The panels made; with doubles that lack nothing where more would take too many points."""
    count = first_count(problem)
    while count <= SHARP:
        with precision(basis.bits):
            q = sample_panels(problem.panels, count, basis.bits) * basis.transform.transpose()
            high, low = twofold_coefficients(q, len(problem.panels), count)
            p_high, p_low = to_twofold(basis.functional * (1 / basis.size))
        if tail_share(high) < (SHARP_RESOLVED if 2 * count <= SHARP else RESOLVED):
            size = np.abs(high).max(axis=(0, 2))
            used = max(int(np.flatnonzero(size > SHARP_RESOLVED * size.max()).max()) + 1, 3)
            return SharpPanels(Panels(high[:, :used], p_high[:, 0]), low[:, :used], p_low[:, 0])
        count *= 2
    return exact_panels(basis.panels)


def to_twofold(matrix: arb_mat) -> tuple[Array, Array]:
    """The midpoints as doubles, and what these lack."""
    high = to_doubles(matrix)
    low = [float(e - h) for e, h in zip(matrix.entries(), high.ravel().tolist(), strict=True)]
    return high, np.array(low).reshape(high.shape)


def twofold_coefficients(q: arb_mat, panels: int, count: int) -> tuple[Array, Array]:
    """Coefficients (panels, count, m) from values at the points of the first kind, and what their doubles lack."""
    rows = q.tolist()
    with precision(NODE_BITS):
        parts = [to_twofold(ball_cosines(count) * arb_mat(rows[i * count : (i + 1) * count])) for i in range(panels)]
    return np.stack([high for high, _ in parts]), np.stack([low for _, low in parts])


@lru_cache(maxsize=8)
def ball_cosines(count: int) -> arb_mat:
    """``2/n cos(pi k (j + 1/2) / n)``, the first row halved."""
    with precision(NODE_BITS):
        cosines = [arb.cos_pi(arb(j) / (2 * count)) * 2 / count for j in range(4 * count)]
        rows = [[cosines[k * (2 * j + 1) % (4 * count)] for j in range(count)] for k in range(count)]
        rows[0] = [c / 2 for c in rows[0]]
        return arb_mat(rows)


# For contacts u, weights w and a dual x that are right to half of the digits, the Lagrangian
# ``x . p - sum w_i (f(u_i) - s_i)``, with ``f = x . q``, is right to all of them: it is stationary in x, in w and
# in the inner contacts. What remains is to compute it without loss. Knuth's sum, Dekker's product.


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
