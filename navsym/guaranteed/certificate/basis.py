"""A well-conditioned basis for the optimum: sampled in balls, orthonormalised, made double.

The functions of a problem may be as close to dependent as monomials of degree 19 or sines on a
short interval. Their Gram matrix on Chebyshev points is factorised in balls with as many bits as
that needs; the orthonormal functions are then safe in double precision.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import chain
from typing import Any

import numpy as np
from flint import arb, arb_mat, fmpq
from numpy.typing import NDArray

from navsym.core.balls import precision
from navsym.core.errors import NotFiniteError, TooLargeError
from navsym.core.exact import to_fmpq
from navsym.guaranteed.certificate.enclosure import Panel, PanelProblem
from navsym.guaranteed.search.exchange import Panels

#: Trailing coefficients below this part of the largest: the functions are resolved.
RESOLVED = 3e-13
NODE_BITS = 128


def to_doubles(matrix: arb_mat) -> NDArray[np.float64]:
    """The midpoints as doubles."""
    return np.array(list(map(float, matrix.entries()))).reshape(matrix.nrows(), matrix.ncols())


def double_coefficients(q: arb_mat, panels: int, count: int) -> NDArray[np.float64]:
    """Coefficients (panels, count, m) from values at the points of the first kind, in doubles."""
    values, cosines = to_doubles(q), double_cosines(count)
    return np.stack([cosines @ values[i * count : (i + 1) * count] for i in range(panels)])


@lru_cache(maxsize=8)
def double_cosines(count: int) -> NDArray[np.float64]:
    """``2/n cos(pi k (j + 1/2) / n)``, the first row halved."""
    k = np.arange(count)
    quarters = np.outer(k, 2 * k + 1) % (4 * count)  # whole turns off before anything is rounded
    cosines: NDArray[np.float64] = np.cos(np.pi * quarters / (2 * count)) * (2.0 / count)
    cosines[0] *= 0.5
    return cosines


def tail_share(high: NDArray[np.float64]) -> float:
    """The last coefficients as a part of the largest."""
    return float(np.abs(high[:, -3:, :]).max() / np.abs(high).max())


def resolved_count(high: NDArray[np.float64]) -> int:
    """How many coefficients are above their rounding."""
    size = np.abs(high).max(axis=(0, 2))
    return max(int(np.flatnonzero(size > 1e-15 * size.max()).max()) + 1, 3)


#: Points a panel that are tried first; even numbers.
COUNTS = (24, 32, 40, 48, 64, 96)
LARGEST = 3072
BITS, MOST_BITS = 192, 6000
#: Bits of a pivot that must be known.
KNOWN = 64
#: Part of a function that its last coefficients may be in doubles, which say nothing below.
GUESSED = 1e-13
#: Places between the points, and what is called zero there.
ELSEWHERE, SAME = (fmpq(2, 7), fmpq(5, 11), fmpq(9, 13)), arb(2) ** -400
#: Functions whose triangular factor has a condition below the inverse of this are made orthonormal in doubles, when
#: their sizes allow.
APART, RANGE = 1e-8, (1e-100, 1e100)


class DependentError(Exception):
    """The functions are dependent as far as ``bits`` can tell: row ``index`` on the rows before it."""

    def __init__(self, index: int, relation: list[arb], bits: int):
        super().__init__(index)
        self.index, self.relation, self.bits = index, relation, bits


@dataclass(frozen=True, eq=False)
class Basis:
    """Orthonormal functions ``q = A H`` with an exact matrix A, and what the search needs.

    transform  : A (m, m), exact entries; A^-1 exists
    functional : A P as balls
    size       : the exact number by which ``A P`` was divided for the search; any power of ten
    panels     : Chebyshev coefficients of q / sigma in double precision
    loss       : digits that cancel in ``x . H`` when x is written in the basis of the problem
    """

    transform: arb_mat
    functional: arb_mat
    size: arb
    panels: Panels
    bits: int
    loss: int

    @property
    def scale(self) -> float:
        """The size as a double number, infinite or zero where it is none."""
        return float(self.size)


@lru_cache(maxsize=16)
def chebyshev_fractions(count: int) -> tuple[fmpq, ...]:
    """Chebyshev points of the first kind as exact dyadic fractions of [0, 1]."""
    with precision(NODE_BITS):
        cosines = [arb.cos_pi(arb(2 * k + 1) / (2 * count)) for k in range(count)]
        return tuple((1 + to_fmpq(c)) / 2 for c in cosines)


def sample_panels(panels: Sequence[Panel], count: int, bits: int) -> arb_mat:
    """H / sigma at the Chebyshev points of every panel, (panels * count, m)."""
    fractions = chebyshev_fractions(count)
    rows: list[list[arb]] = []
    with precision(bits):
        for panel in panels:
            sigma, mine = panel.bound(), [panel.rows(arb(v)) for v in fractions]
            rows += mine if panel.sigma == 1 else [[h / sigma for h in row] for row in mine]
            if not sum(map(abs, chain(*mine)), arb(0)).is_finite():
                raise NotFiniteError(
                    f"regressors: expected functions that are finite on the interval; got {panel.functions} between "
                    f"{panel.start} and {panel.end}; change the interval"
                )
        return arb_mat(rows)


def ball_cholesky(gram: arb_mat, bits: int) -> list[list[arb]]:
    """Lower factor of the Gram matrix in balls; raises DependentError at a pivot that is not known well enough."""
    m = gram.nrows()
    L = [[arb(0)] * m for _ in range(m)]
    for i in range(m):
        for j in range(i + 1):
            rest = gram[i, j]
            for k in range(j):
                rest = rest - L[i][k] * L[j][k]
            if i == j:
                if not bool(rest > 0) or rest.rel_accuracy_bits() < KNOWN:
                    raise DependentError(i, fit_relation(gram, i), bits)
                L[i][i] = rest.sqrt()
            else:
                L[i][j] = rest / L[j][j]
    return L


def fit_relation(gram: arb_mat, index: int) -> list[arb]:
    """Coefficients c with ``H_index = sum c_k H_k`` over the rows before, from the normal equations."""
    if index == 0:
        return []
    block = arb_mat([[gram[i, j].mid() for j in range(index)] for i in range(index)])
    right = arb_mat([[gram[i, index].mid()] for i in range(index)])
    solved = block.solve(right)
    return [solved[i, 0].mid() for i in range(index)]


def orthonormal_transform(values: arb_mat, bits: int) -> tuple[arb_mat, int]:
    """A = L^-1 for the Gram matrix ``L L^T`` of the rows, as exact midpoints; the digits that A and L span.

    Any regular A near it will do: one of doubles, where the functions are far from dependent.
    """
    rounded = double_transform(to_doubles(values))
    if rounded is not None:
        return rounded
    gram = values.transpose() * values
    count = values.nrows()
    L = arb_mat(ball_cholesky(gram * (arb(1) / count), bits)).mid()
    inverse = L.inv()
    A = arb_mat(L.nrows(), L.ncols(), [e.mid() for e in inverse.entries()])
    digits = [(max(map(arb.abs_upper, matrix.entries())).log() / arb(10).log()).mid() for matrix in (A, L)]
    return A, max(0, int(float(sum(digits, arb(0)))) + 1)


def double_transform(values: NDArray[np.float64]) -> tuple[arb_mat, int] | None:
    """:func:`orthonormal_transform` in doubles; None where these do not tell the functions apart for certain."""
    sizes = np.abs(values).max(axis=0)
    if not np.isfinite(sizes).all() or sizes.min() < RANGE[0] or sizes.max() > RANGE[1]:
        return None
    scale = np.exp2(np.round(np.log2(sizes)))
    factor = np.linalg.qr(values / scale, mode="r") / np.sqrt(len(values))
    factor *= np.where(np.diag(factor) < 0, -1.0, 1.0)[:, None]
    if not np.abs(np.diag(factor)).min() > APART:
        return None
    inverse = np.linalg.inv(factor)
    if np.linalg.norm(inverse) * np.linalg.norm(factor) > 1 / APART:
        return None
    A = inverse.T / scale
    span = np.log10(np.abs(A).max()) + np.log10(np.abs(factor * scale).max())
    return arb_mat([[arb(a) for a in row] for row in A.tolist()]), max(0, int(span) + 1)


def make_basis(problem: PanelProblem, bits: int = BITS) -> Basis:
    """Orthonormal basis of a problem, with points and bits increased until both suffice.

    The last ones are kept: the same exact expressions have the same basis.

    Raises DependentError when the functions look dependent at ``MOST_BITS``, TooLargeError when
    ``LARGEST`` points a panel do not resolve them.
    """
    if any(panel.values or panel.mix is not None for panel in problem.panels):
        return compute_basis(problem, bits)
    panels = tuple((p.measurement, p.functions, p.variable, p.start, p.end, p.sigma) for p in problem.panels)
    return cached_basis(ExactKey((panels, problem.functional), problem), bits)


@dataclass(frozen=True, slots=True)
class ExactKey:
    """A problem that is compared by its exact expressions."""

    expressions: tuple[Any, ...]
    problem: PanelProblem = field(compare=False)


@lru_cache(maxsize=64)
def cached_basis(exact: ExactKey, bits: int) -> Basis:
    """:func:`compute_basis` for exact expressions, which are compared as a whole."""
    return compute_basis(exact.problem, bits)


def compute_basis(problem: PanelProblem, bits: int) -> Basis:
    """The basis, computed."""
    panels, least = problem.panels, bits
    count = first_count(problem)
    while True:
        try:
            with precision(bits):
                values = sample_panels(panels, count, bits)
                A, loss = orthonormal_transform(values, bits)
                q = values * A.transpose()
                P = A * arb_mat([[p] for p in problem.target()])
        except DependentError as found:
            if bits < MOST_BITS:
                bits *= 2
            elif count < LARGEST and differs_between_points(problem, found):
                count, bits = 2 * count, least
            else:
                raise
            continue
        high = double_coefficients(q, len(panels), count)
        if tail_share(high) < RESOLVED:
            break
        if count >= LARGEST:
            raise TooLargeError(
                f"expected functions that {LARGEST} points a piece resolve; got a tail of {tail_share(high):.1e}; "
                "shorten the interval, or keep poles and kinks out of it"
            )
        count *= 2
    with precision(bits):
        size = sum((p * p for p in P.entries()), arb(0)).sqrt().mid()
        search = Panels(high[:, : resolved_count(high)], to_doubles(P * (1 / size))[:, 0])
    return Basis(A, P, size, search, bits, loss)


def first_count(problem: PanelProblem) -> int:
    """Points a panel to begin with: no fewer than functions, and where doubles say so what resolves the functions.

    Only a guess: what is too few shows itself in balls later.
    """
    enough = [count for count in COUNTS if count >= len(problem.functional)]
    if not enough:
        return COUNTS[-1] * -(-len(problem.functional) // COUNTS[-1])
    smooth_at = (n for n in enough[:-1] if all(is_smooth(panel, n) for panel in problem.panels))
    return next(smooth_at, enough[-1])


@lru_cache(maxsize=8)
def last_cosines(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Chebyshev points in [0, 1], and what takes values there to the last three coefficients."""
    angles = np.pi * (np.arange(count) + 0.5) / count
    return (1 + np.cos(angles)) / 2, np.cos(np.outer(angles, np.arange(count - 3, count))) * (2 / count)


def is_smooth(panel: Panel, count: int) -> bool:
    """The last coefficients of every function of a panel are small in doubles, or doubles say nothing."""
    inputs: dict[Any, Any] = {symbol: float(arb(value).mid()) for symbol, value in panel.values.items()}
    start, end, _ = (float(edge.mid()) for edge in panel.edges())
    shares, cosines = last_cosines(count)
    inputs[panel.variable] = start + (end - start) * shares
    rows = np.empty((len(panel.functions), count))
    with np.errstate(all="ignore"):
        try:
            values = panel.program.numbers(inputs)
        except (ArithmeticError, ValueError):  # a number beyond the range of a double
            return True
        for row, h in zip(rows, values, strict=True):
            row[:] = h
        tail = np.abs(rows @ cosines).max(axis=1)
        return not bool((tail > GUESSED * np.abs(rows).max(axis=1)).any())


def differs_between_points(problem: PanelProblem, found: DependentError) -> bool:
    """True when functions that look dependent at the Chebyshev points are not so between them.

    ``T_{n+k} = -T_{n-k}`` at n of these points.
    """
    with precision(found.bits):
        for panel in problem.panels:
            for v in ELSEWHERE:
                rows = panel.rows(arb(v))
                parts = [c * h for c, h in zip(found.relation, rows, strict=False)]
                away = abs(rows[found.index] - sum(parts, arb(0)))
                if bool(away > SAME * sum((abs(p) for p in parts), abs(rows[found.index]))):
                    return True
    return False


def unit_fraction(u: float) -> fmpq:
    """The fraction in [0, 1] of a local coordinate in [-1, 1], exactly."""
    if u <= -1.0:
        return fmpq(0)
    return fmpq(1) if u >= 1.0 else (1 + to_fmpq(arb(u))) / 2
