"""Guaranteed deviations for many lengths of the interval, in double precision.

Neighbouring lengths have neighbouring contacts, so one general search starts each stretch of equal
pattern and compiled Newton steps do the rest. Without certificates: solve the lengths that matter
with :func:`navsym.guaranteed.solver.solve`.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from navsym.core.errors import DomainError
from navsym.core.exact import to_rational
from navsym.guaranteed.certificate.basis import Basis, make_basis
from navsym.guaranteed.phases.family import Family
from navsym.guaranteed.phases.patterns import ordered
from navsym.guaranteed.search.exchange import Contacts, find_contacts
from navsym.guaranteed.search.lengths import follow_lengths

#: The search basis of a length serves lengths down to this part of it.
REACH = 0.25


def values_for_lengths(family: Family, lengths: Sequence[float]) -> NDArray[np.float64]:
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
        at += fill(family, T, block, values)
    return values


def fill(family: Family, T: NDArray[np.float64], block: NDArray[np.int64], values: NDArray[np.float64]) -> int:
    """Values for the first lengths of a descending block; how many were done, at least one."""
    top = Fraction(float(T[block[0]]))
    basis = make_basis(family.exact(to_rational(top)))
    found = ordered(find_contacts(basis.sharp))
    values[block[0]] = found.value * basis.scale
    if block.size == 1 or not regular(basis, found):
        return 1
    ends = 2.0 * T[block[1:]] / float(top) - 1.0
    kind = np.where(found.inner == 1, 1, np.where(found.u < 0, 0, 2)).astype(np.int64)
    followed, _, _ = follow_lengths(basis.sharp, ends, found.u, kind, found.sign)
    done = int(np.isfinite(followed).argmin()) if not np.isfinite(followed).all() else followed.size
    values[block[1 : done + 1]] = followed[:done] * basis.scale
    return 1 + done


def regular(basis: Basis, found: Contacts) -> bool:
    """One panel, as many contacts as unknowns."""
    return basis.sharp.coefficients.shape[0] == 1 and found.u.size == basis.sharp.functional.size
