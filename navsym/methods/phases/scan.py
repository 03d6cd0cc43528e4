"""Which pattern of contacts belongs to which length of the interval, in double precision.

A pattern is where the optimal dual touches its bound with a weight: measurement, kind of place
(start, inside, end) and sign, in order. Equal neighbours on a scan are taken for one regime, and
changes are bracketed by bisection. Hints only: what is found here is proved afterwards.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
import sympy as sp

from navsym.errors import DomainError
from navsym.methods.phases.alike import Pattern, alike, pattern_of
from navsym.methods.phases.family import Family
from navsym.numeric.exchange.search import Contacts, Panels, find_contacts, rows_at
from navsym.proof.optimality.basis import Basis, DependentError, make_basis

COUNT = 72
BRACKET = 1e-7
#: Regressors on both sides of a cut that differ by less than this part are the same.
SAME = 1e-9
#: A weight below this part of their sum is the rounding of zero.
ROUNDING = 1e-13
#: A span below this part of the range is taken for an accident of contacts that merge.
SHORTEST = Fraction(1, 5000)


@dataclass(frozen=True, slots=True)
class Span:
    """A stretch of lengths with one pattern, and the brackets of its ends."""

    lower: Fraction
    upper: Fraction
    pattern: Pattern


def exact(x: Fraction) -> sp.Rational:
    """A fraction of Python as a rational of sympy."""
    return sp.Rational(x.numerator, x.denominator)


def sample(family: Family, T: Fraction, *wanted: Pattern | None) -> tuple[Basis, Contacts]:
    """Basis and contacts for one length; the contacts in order.

    wanted : patterns to prefer where there are several optimal estimators, the first that is optimal wins
    """
    try:
        basis = make_basis(family.exact(exact(T)))
    except DependentError:
        raise DomainError(
            f"{family.parameter.name}: expected a range inside which the regressors are independent; got dependent "
            f"ones at or next to {float(T):.9g}, which was not foreseen; give a range that ends there"
        ) from None
    found = ordered(at_cuts(find_contacts(basis.panels), basis.panels, family.many), basis.panels)
    for pattern in wanted:
        if pattern is None or pattern_of(found) == pattern:
            continue
        other = alike(basis.panels, found, pattern)
        if other is not None:
            return basis, other
    return basis, found


def at_cuts(found: Contacts, panels: Panels, many: int) -> Contacts:
    """The same contacts; one at the start of a stretch stands at the end of the stretch before where the regressors go
    on without a jump: such a place belongs to both, and a pattern names it in one way."""
    panel, u = found.panel.copy(), found.u.copy()
    for i in np.flatnonzero((found.inner == 0) & (u < 0) & (panel >= many)):
        here = rows_at(panels.coefficients, panel[i : i + 1], u[i : i + 1])
        before = rows_at(panels.coefficients, panel[i : i + 1] - many, -u[i : i + 1])
        twin = ((panel == panel[i] - many) & (u == 1.0)).any()
        if not twin and np.abs(here - before).max() <= SAME * np.abs(here).max():
            panel[i], u[i] = panel[i] - many, 1.0
    return replace(found, panel=panel, u=u)


def ordered(found: Contacts, panels: Panels | None = None) -> Contacts:
    """The same contacts by panel and place; those whose weight is rounding, or has not the sign of the dual
    polynomial there (with panels), are touches only."""
    sizes = np.abs(found.weights)
    idle = sizes <= ROUNDING * sizes.sum()
    if panels is not None:
        against = found.weights * (rows_at(panels.coefficients, found.panel, found.u) @ found.dual) < 0
        idle |= against & ~against.all()
    touches = zip(found.panel[idle].tolist(), found.u[idle].tolist(), strict=True)
    order = np.lexsort((found.u, found.panel))
    order = order[~idle[order]]
    return Contacts(
        found.panel[order],
        found.u[order],
        found.inner[order],
        found.sign[order],
        found.weights[order],
        found.dual,
        found.excess,
        (*found.touching, *touches),
        found.value,
    )


def scan(
    family: Family, lower: Fraction, upper: Fraction, count: int = COUNT, step: Callable[[], bool] = lambda: True
) -> list[Span]:
    """Spans of equal pattern between two positive lengths, from a scan and bisections.

    step : called after each of the ``count - 1`` stretches of the scan; False ends it there, before ``upper``
    """

    def at(T: Fraction, *wanted: Pattern) -> Pattern:
        return pattern_of(sample(family, T, *wanted)[1])

    width = upper - lower
    places = [lower + width * Fraction(2 * k + 1, 2 * count) for k in range(count)]
    pattern = at(places[0])
    spans, edge = [], lower
    for a, b in pairwise(places):
        for cut, after in changes(at, a, b, pattern, at(b, pattern)):
            spans.append(Span(edge, cut, pattern))
            edge, pattern = cut, after
        if not step() and b != places[-1]:
            upper = b
            break
    spans.append(Span(edge, upper, pattern))
    return joined([s for s in spans if s.upper - s.lower > SHORTEST * width])


def changes(
    at: Callable[..., Pattern], a: Fraction, b: Fraction, before: Pattern, after: Pattern
) -> Iterator[tuple[Fraction, Pattern]]:
    """All changes between a and b that bisection sees, each with the pattern after it."""
    if before == after:
        return
    middle = (a + b) / 2
    if b - a < Fraction(BRACKET):
        yield middle, after
        return
    between = at(middle, before, after)
    yield from changes(at, a, middle, before, between)
    yield from changes(at, middle, b, between, after)


def joined(spans: list[Span]) -> list[Span]:
    """Neighbours with one pattern made one."""
    done: list[Span] = []
    for span in spans:
        if done and done[-1].pattern == span.pattern:
            done[-1] = Span(done[-1].lower, span.upper, span.pattern)
        elif done:
            done.append(Span(done[-1].upper, span.upper, span.pattern))
        else:
            done.append(span)
    return done
