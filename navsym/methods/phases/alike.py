"""Where several estimators are optimal: the one with a given pattern, if it is among them.

Every optimal estimator stands on the places where an optimal dual polynomial touches its bound. A pattern is
optimal as well when some of these places have it and carry the functional with weights of the right signs.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, islice

import numpy as np

from navsym.numeric.exchange.kernels import Array, Ints
from navsym.numeric.exchange.search import NEGLIGIBLE, Contacts, Panels, rows_at

Pattern = tuple[tuple[int, str, int], ...]
MOST_CHOICES = 3000
#: Residual of the balance, relative to the functional, up to which weights are taken for a solution.
BALANCED = 1e-7
AT_END = 1e-9


def pattern_of(found: Contacts) -> Pattern:
    """Panel, kind of place and sign of every contact."""
    return marks(found.panel, np.where(found.inner == 1, 0.0, np.sign(found.u)), found.sign)


def marks(panel: Ints, end: Array, sign: Array) -> Pattern:
    """The pattern of contacts, all (l,): panel, kind of place, sign; end is -1, 1 at an end of the panel, 0 inside."""
    kinds = {-1: "from", 0: "no", 1: "to"}
    return tuple((int(k), kinds[int(e)], int(s)) for k, e, s in zip(panel, end, sign, strict=True))


def alike(panels: Panels, found: Contacts, pattern: Pattern) -> Contacts | None:
    """Contacts of the pattern with the same dual, the earliest places first; None when there are none."""
    if not found.touching:
        return None
    panel, u = every_place(found)
    rows = rows_at(panels.coefficients, panel, u)
    sign = np.sign(rows @ found.dual)
    here = marks(panel, np.where(np.abs(u) > 1.0 - AT_END, np.sign(u), 0.0), sign)
    choices = combinations([i for i, mark in enumerate(here) if mark in pattern], len(pattern))
    for choice in islice(choices, MOST_CHOICES):
        if tuple(here[i] for i in choice) != pattern:
            continue
        chosen = np.array(choice)
        weights = balanced(rows[chosen], panels.functional)
        if weights is not None and (weights * sign[chosen] > NEGLIGIBLE * np.abs(weights).sum()).all():
            return with_places(found, panel, u, sign, chosen, weights)
    return None


def every_place(found: Contacts) -> tuple[Ints, Array]:
    """Contacts and further touches in order."""
    panel = np.concatenate([found.panel, np.array([k for k, _ in found.touching], dtype=np.int64)])
    u = np.concatenate([found.u, np.array([v for _, v in found.touching])])
    order = np.lexsort((u, panel))
    return panel[order], u[order]


def balanced(rows: Array, functional: Array) -> Array | None:
    """The weights that carry the functional on the rows, or None."""
    weights: Array = np.linalg.lstsq(rows.T, functional, rcond=1e-11)[0].astype(np.float64)
    rest = np.abs(weights @ rows - functional).max()
    return weights if rest <= BALANCED * np.abs(functional).max() else None


def with_places(found: Contacts, panel: Ints, u: Array, sign: Array, chosen: Ints, weights: Array) -> Contacts:
    """The same dual with other contacts; the places left over are touches."""
    left = [(int(panel[i]), float(u[i])) for i in range(panel.size) if i not in chosen]
    at = u[chosen]
    return replace(
        found,
        panel=panel[chosen],
        u=at,
        inner=(np.abs(at) <= 1.0 - AT_END).astype(np.int64),
        sign=sign[chosen],
        weights=weights,
        touching=tuple(left),
    )
