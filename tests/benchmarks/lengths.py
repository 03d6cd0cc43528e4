"""Guaranteed deviations for many lengths of the interval, in double precision.

Neighbouring lengths have neighbouring contacts: one general search starts each interval of lengths with one pattern,
and compiled Newton steps do the rest. The functions are Chebyshev sums on the longest interval; a shorter one ends
at u < 1 of the same panel. Without certificates: solve the lengths that matter with :func:`navsym.solve`.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from navsym.core.errors import DomainError
from navsym.core.exact import to_rational
from navsym.core.loops import kernel
from navsym.core.simplex import invert_matrix, rows_times, times_rows
from navsym.guaranteed.certificate.basis import make_basis
from navsym.guaranteed.phases.family import Family
from navsym.guaranteed.phases.patterns import order_contacts
from navsym.guaranteed.search.exchange import find_contacts
from navsym.guaranteed.search.kernels import Array, Ints, chebyshev_derivative, chebyshev_rows, chebyshev_sum
from tests.benchmarks.twofold import sharp_panels

#: The search basis of a length serves lengths down to this part of it.
REACH = 0.25
#: Places on which a dual polynomial is looked at.
CHECKS = 24


def values_for_lengths(family: Family, lengths: Sequence[float]) -> Array:
    """Guaranteed deviations (N,) for N lengths of the interval, in the order given, in double precision.

    Raises DomainError for a length that is not positive and finite.
    """
    T = np.array(lengths, dtype=float)
    if T.size == 0 or not np.isfinite(T).all() or T.min() <= 0.0:
        raise DomainError("lengths: expected positive finite numbers; got another; remove it")
    order = np.argsort(-T)
    values = np.empty(T.size)
    at = 0
    while at < T.size:
        block = order[at:]
        block = block[T[block] >= REACH * T[block[0]]]
        at += fill_values(family, T, block, values)
    return values


def fill_values(family: Family, T: Array, block: Ints, values: Array) -> int:
    """Values for the first lengths of a descending block; how many were done, at least one."""
    top = Fraction(float(T[block[0]]))
    problem = family.exact(to_rational(top))
    basis = make_basis(problem)
    sharp = sharp_panels(basis, problem)
    C, p = sharp.panels.coefficients, sharp.panels.functional
    contacts = order_contacts(find_contacts(sharp.panels))
    values[block[0]] = sharp.value(contacts) * basis.scale
    alternates = C.shape[0] == 1 and contacts.u.size == p.size
    if block.size == 1 or not alternates:
        return 1
    ends = 2.0 * T[block[1:]] / float(top) - 1.0
    kind = np.where(contacts.inner == 1, 1, np.where(contacts.u < 0, 0, 2)).astype(np.int64)
    C1 = chebyshev_derivative(C[0])
    C2 = chebyshev_derivative(C1)
    rest = follow_lengths(C[0], C1, C2, p, ends, contacts.u, kind, contacts.sign)
    count = rest.size if np.isfinite(rest).all() else int(np.isfinite(rest).argmin())
    values[block[1 : count + 1]] = rest[:count] * basis.scale
    return 1 + count


@kernel
def follow_lengths(C: Array, C1: Array, C2: Array, p: Array, ends: Array, u: Array, kind: Ints, sign: Array) -> Array:
    """Values for every end; NaN from the first length on where the full alternance fails.

    kind : 0 at the start of the panel, 1 inside, 2 at the moving end
    """
    m, n = u.shape[0], ends.shape[0]
    values = np.full(n, np.nan)
    u = u.copy()
    before = u[m - 1] if kind[m - 1] == 2 else 1.0
    for i in range(n):
        ratio = (ends[i] + 1.0) / (before + 1.0)
        for k in range(m):
            if kind[k] == 1:
                u[k] = (u[k] + 1.0) * ratio - 1.0
            elif kind[k] == 2:
                u[k] = ends[i]
        before = ends[i]
        x = np.zeros(m)
        inverse = np.eye(m)
        move = 1.0
        for _ in range(8):
            B = np.empty((m, m))
            for k in range(m):
                B[k] = chebyshev_rows(C, u[k])
            inverse, regular = invert_matrix(B)
            if not regular:
                return values
            x = rows_times(inverse, sign)
            move = 0.0
            slopes, bends = rows_times(C1, x), rows_times(C2, x)
            for k in range(m):
                if kind[k] == 1:
                    bend = chebyshev_sum(bends, u[k])
                    if bend * sign[k] >= 0.0:
                        return values
                    step = -chebyshev_sum(slopes, u[k]) / bend
                    u[k] += step
                    move = max(move, abs(step))
            if move < 1e-8:
                break
        weights = times_rows(inverse, p)
        total = 0.0
        for k in range(m):
            if not (weights[k] * sign[k] > 0.0 and -1.0 <= u[k] <= ends[i]):
                return values
            total += abs(weights[k])
        f = rows_times(C, x)
        for j in range(CHECKS):
            if abs(chebyshev_sum(f, -1.0 + (ends[i] + 1.0) * j / (CHECKS - 1.0))) > 1.0 + 1e-7:
                return values
        values[i] = total
    return values
