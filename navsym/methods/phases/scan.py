"""Which pattern of contacts belongs to which length of the interval, in double precision.

A pattern is where the optimal dual touches its bound with a weight: measurement, kind of place
(start, inside, end) and sign, in order. Equal neighbours on a scan are taken for one regime, and
changes are bracketed by bisection. Hints only: what is found here is proved afterwards.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np
import sympy as sp

from navsym.methods.phases.family import Family
from navsym.numeric.exchange import Contacts, find_contacts
from navsym.proof.optimality_basis import Basis, make_basis

Pattern = tuple[tuple[int, str, int], ...]
COUNT = 72
BRACKET = 1e-7


@dataclass(frozen=True, slots=True)
class Span:
    """A stretch of lengths with one pattern, and the brackets of its ends."""

    lower: Fraction
    upper: Fraction
    pattern: Pattern


def sample(family: Family, T: Fraction) -> tuple[Basis, Contacts]:
    """Basis and contacts for one length; the contacts in order."""
    basis = make_basis(family.exact(sp.Rational(T.numerator, T.denominator)))
    return basis, ordered(find_contacts(basis.panels))


def ordered(found: Contacts) -> Contacts:
    """The same contacts by panel and place."""
    order = np.lexsort((found.u, found.panel))
    return Contacts(
        found.panel[order], found.u[order], found.inner[order], found.sign[order], found.weights[order],
        found.dual, found.excess, found.touching, found.value,
    )  # fmt: skip


def pattern_of(found: Contacts) -> Pattern:
    """Panel, kind of place and sign of every contact."""
    kinds = ["no" if i else ("to" if u > 0 else "from") for i, u in zip(found.inner, found.u, strict=True)]
    return tuple((int(k), kind, int(s)) for k, kind, s in zip(found.panel, kinds, found.sign, strict=True))


def scan(
    family: Family, lower: Fraction, upper: Fraction, count: int = COUNT, step: Callable[[], None] = lambda: None
) -> list[Span]:
    """Spans of equal pattern between two positive lengths, from a scan and bisections.

    step : called after each of the ``count - 1`` stretches of the scan
    """
    known: dict[Fraction, Pattern] = {}

    def at(T: Fraction) -> Pattern:
        if T not in known:
            known[T] = pattern_of(sample(family, T)[1])
        return known[T]

    width = upper - lower
    places = [lower + width * Fraction(2 * k + 1, 2 * count) for k in range(count)]
    cuts: list[tuple[Fraction, Fraction]] = []
    for a, b in pairwise(places):
        changes(at, a, b, cuts)
        step()
    edges = [lower, *((a + b) / 2 for a, b in cuts), upper]
    spans = [Span(a, b, at((a + b) / 2)) for a, b in pairwise(edges)]
    return joined([s for s in spans if s.upper - s.lower > Fraction(1, 20000) * width])


def changes(
    at: Callable[[Fraction], Pattern], a: Fraction, b: Fraction, cuts: list[tuple[Fraction, Fraction]]
) -> None:
    """Brackets of all changes between a and b that bisection sees."""
    if at(a) == at(b):
        return
    if b - a < Fraction(BRACKET):
        cuts.append((a, b))
        return
    middle = (a + b) / 2
    changes(at, a, middle, cuts)
    changes(at, middle, b, cuts)


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
