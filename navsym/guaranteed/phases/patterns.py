"""Which pattern of contacts belongs to which length of the interval, in double precision.

A pattern is where the optimal dual touches its bound with a weight: measurement, kind of place
(start, inside, end) and sign, in order. Equal neighbours on a scan are taken for one regime, and
changes are bracketed by bisection. Hints only: what is found here is proved afterwards.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations, islice, pairwise

import numpy as np

from navsym.core.errors import DomainError
from navsym.core.exact import to_rational
from navsym.guaranteed.certificate.basis import Basis, DependentError, make_basis
from navsym.guaranteed.phases.family import Family
from navsym.guaranteed.search.exchange import (
    NEGLIGIBLE,
    Contacts,
    Panels,
    add_places,
    find_contacts,
    pick_contacts,
    regressor_rows,
)
from navsym.guaranteed.search.kernels import Array

# Where several estimators are optimal: the one with a given pattern, if it is among them.
#
# Every optimal estimator stands on the places where an optimal dual polynomial touches its bound. A pattern is
# optimal as well when some of these places have it and carry the functional with weights of the right signs.


Pattern = tuple[tuple[int, str, int], ...]
MOST_CHOICES = 3000
#: Residual of the balance, relative to the functional, up to which weights are taken for a solution.
BALANCED = 1e-7
AT_END = 1e-9


def contact_pattern(found: Contacts) -> Pattern:
    """Panel, kind of place and sign of every contact."""
    ends = np.where(found.inner == 1, 0.0, np.sign(found.u))
    kinds = {-1: "from", 0: "no", 1: "to"}
    return tuple((int(k), kinds[int(e)], int(s)) for k, e, s in zip(found.panel, ends, found.sign, strict=True))


def match_pattern(panels: Panels, found: Contacts, pattern: Pattern) -> Contacts | None:
    """Contacts of the pattern with the same dual, the earliest places first; None when there are none."""
    if not found.touching:
        return None
    every = add_places(panels, found, found.touching)
    every = pick_contacts(every, np.lexsort((every.u, every.panel)), ())
    every = replace(every, inner=(np.abs(every.u) <= 1.0 - AT_END).astype(np.int64))
    rows, here = regressor_rows(panels.coefficients, every.panel, every.u), contact_pattern(every)
    choices = combinations([i for i, mark in enumerate(here) if mark in pattern], len(pattern))
    for choice in islice(choices, MOST_CHOICES):
        if tuple(here[i] for i in choice) != pattern:
            continue
        chosen = np.array(choice)
        weights = solve_balance(rows[chosen], panels.functional)
        if weights is not None and (weights * every.sign[chosen] > NEGLIGIBLE * np.abs(weights).sum()).all():
            pairs = zip(every.panel.tolist(), every.u.tolist(), strict=True)
            left = tuple(pair for i, pair in enumerate(pairs) if i not in choice)
            return replace(pick_contacts(every, chosen, left), weights=weights)
    return None


def solve_balance(rows: Array, functional: Array) -> Array | None:
    """The weights that carry the functional on the rows, or None."""
    weights: Array = np.linalg.lstsq(rows.T, functional, rcond=1e-11)[0].astype(np.float64)
    rest = np.abs(weights @ rows - functional).max()
    return weights if rest <= BALANCED * np.abs(functional).max() else None


COUNT = 72
#: Changes nearer than this are not told apart by bisection.
BRACKET = Fraction(1, 10**7)
#: Regressors on both sides of a cut that differ by less than this part are the same.
SAME = 1e-9
#: A weight below this part of their sum is the rounding of zero.
ROUNDING = 1e-13
#: A span below this part of the range is taken for an accident of contacts that merge.
SHORTEST = Fraction(1, 5000)


@dataclass(frozen=True, slots=True)
class PatternInterval:
    """A stretch of lengths with one pattern, and the brackets of its ends."""

    lower: Fraction
    upper: Fraction
    pattern: Pattern


def sample_contacts(family: Family, T: Fraction, *wanted: Pattern | None) -> tuple[Basis, Contacts]:
    """Basis and contacts for one length; the contacts in order.

    wanted : patterns to prefer where there are several optimal estimators, the first that is optimal wins
    """
    try:
        basis = make_basis(family.exact(to_rational(T)))
    except DependentError:
        raise DomainError(
            f"{family.parameter.name}: expected a range inside which the regressors are independent; got dependent "
            f"ones at or next to {float(T):.9g}, which was not foreseen; give a range that ends there"
        ) from None
    found = center_on_constants(find_contacts(basis.panels), basis.panels)
    found = order_contacts(move_to_cuts(found, basis.panels, family.many), basis.panels)
    for pattern in wanted:
        if pattern is None or contact_pattern(found) == pattern:
            continue
        other = match_pattern(basis.panels, found, pattern)
        if other is not None:
            return basis, other
    return basis, found


def center_on_constants(found: Contacts, panels: Panels) -> Contacts:
    """The same contacts, in the middle of panels whose regressors do not change.

    There one place is as good as another, and rounding alone would choose it.
    """
    sizes = np.abs(panels.coefficients).max(axis=2)
    constant = sizes[:, 1:].max(axis=1) <= SAME * sizes[:, 0]
    here = constant[found.panel]
    touching = tuple(place for place in found.touching if not constant[place[0]])
    return replace(found, u=np.where(here, 0.0, found.u), inner=np.where(here, 1, found.inner), touching=touching)


def move_to_cuts(found: Contacts, panels: Panels, many: int) -> Contacts:
    """The same contacts; one at the start of a piece stands at the end of the piece before.

    It does where the regressors go on without a jump: such a place belongs to both, and a pattern names it in one way.
    """
    panel, u = found.panel.copy(), found.u.copy()
    for i in np.flatnonzero((found.inner == 0) & (u < 0) & (panel >= many)):
        here = regressor_rows(panels.coefficients, panel[i : i + 1], u[i : i + 1])
        before = regressor_rows(panels.coefficients, panel[i : i + 1] - many, -u[i : i + 1])
        twin = ((panel == panel[i] - many) & (u == 1.0)).any()
        if not twin and np.abs(here - before).max() <= SAME * np.abs(here).max():
            panel[i], u[i] = panel[i] - many, 1.0
    return replace(found, panel=panel, u=u)


def order_contacts(found: Contacts, panels: Panels | None = None) -> Contacts:
    """The same contacts by panel and place.

    Those whose weight is rounding, or has not the sign of the dual polynomial there (with panels), are touches only.
    """
    sizes = np.abs(found.weights)
    idle = sizes <= ROUNDING * sizes.sum()
    if panels is not None:
        against = found.weights * (regressor_rows(panels.coefficients, found.panel, found.u) @ found.dual) < 0
        idle |= against & ~against.all()
    touches = zip(found.panel[idle].tolist(), found.u[idle].tolist(), strict=True)
    order = np.lexsort((found.u, found.panel))
    order = order[~idle[order]]
    return pick_contacts(found, order, (*found.touching, *touches))


def scan_patterns(
    family: Family, lower: Fraction, upper: Fraction, count: int = COUNT, step: Callable[[], bool] = lambda: True
) -> list[PatternInterval]:
    """Spans of equal pattern between two positive lengths, from a scan and bisections.

    step : called after each of the ``count - 1`` stretches of the scan; False ends it there, before ``upper``
    """

    def at(T: Fraction, *wanted: Pattern) -> Pattern:
        return contact_pattern(sample_contacts(family, T, *wanted)[1])

    width = upper - lower
    places = [lower + width * Fraction(2 * k + 1, 2 * count) for k in range(count)]
    pattern = at(places[0])
    spans, edge = [], lower
    for a, b in pairwise(places):
        for cut, after in bisect_changes(at, a, b, pattern, at(b, pattern)):
            spans.append(PatternInterval(edge, cut, pattern))
            edge, pattern = cut, after
        if not step() and b != places[-1]:
            upper = b
            break
    spans.append(PatternInterval(edge, upper, pattern))
    return join_equal_patterns([s for s in spans if s.upper - s.lower > SHORTEST * width])


def bisect_changes(
    at: Callable[..., Pattern], a: Fraction, b: Fraction, before: Pattern, after: Pattern
) -> Iterator[tuple[Fraction, Pattern]]:
    """All changes between a and b that bisection sees, each with the pattern after it."""
    if before == after:
        return
    middle = (a + b) / 2
    if b - a < BRACKET:
        yield middle, after
        return
    between = at(middle, before, after)
    yield from bisect_changes(at, a, middle, before, between)
    yield from bisect_changes(at, middle, b, between, after)


def join_equal_patterns(spans: list[PatternInterval]) -> list[PatternInterval]:
    """Neighbours with one pattern made one."""
    done: list[PatternInterval] = []
    for span in spans:
        if done and done[-1].pattern == span.pattern:
            done[-1] = PatternInterval(done[-1].lower, span.upper, span.pattern)
        elif done:
            done.append(PatternInterval(done[-1].upper, span.upper, span.pattern))
        else:
            done.append(span)
    return done
