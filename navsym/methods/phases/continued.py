"""Closed forms of a regime taken over from its neighbours, where several estimators are optimal.

Where the dual polynomial does not move with the parameter, and is its bound on a whole interval, places may be
chosen; those that the search found say nothing. Places and weights of the regime next to it carry the functional
beyond the boundary as well; if their signs are right there, the pair is optimal. A guess, to be proved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import groupby

import sympy as sp

from navsym.claims import OPEN, Verdict
from navsym.methods.phases.closed import Closed, Sample, refined
from navsym.methods.phases.family import Family
from navsym.methods.phases.places import number
from navsym.methods.phases.scan import Span
from navsym.proof.balls import enclose

NEAR = sp.Rational(1, 10**30)
LARGEST = 720
SHARES = tuple(map(Fraction, ("0.03", "0.23", "0.59", "0.97")))


def continued(
    family: Family, spans: Sequence[Span], guesses: Sequence[list[Closed]]
) -> tuple[list[Span], list[list[Closed]]]:
    """Spans and their guesses; neighbours without any are made one when the closed form beside them holds there."""
    runs = [list(run) for _, run in groupby(range(len(spans)), key=lambda k: k if guesses[k] else -1)]
    kept: list[tuple[Span, list[Closed]]] = []
    for run in runs:
        first, last = run[0], run[-1]
        beside = [k for k in (first - 1, last + 1) if 0 <= k < len(spans) and guesses[k]]
        whole = Span(spans[first].lower, spans[last].upper, spans[first].pattern)
        found = None if guesses[first] else taken_over(family, whole, beside, spans, guesses)
        kept += [found] if found else [(spans[k], guesses[k]) for k in run]
    return [span for span, _ in kept], [list(guess) for _, guess in kept]


def taken_over(
    family: Family, span: Span, beside: Sequence[int], spans: Sequence[Span], guesses: Sequence[list[Closed]]
) -> tuple[Span, list[Closed]] | None:
    """A span with the pattern and the closed form of one of the regimes beside it, or None."""
    found = [one for T in inside(span) if (one := refined(family, T, None)) is not None] if beside else []
    dual = still_dual(found)
    if dual is None:
        return None
    for k in beside:
        fits = [pair for closed in guesses[k] if (pair := with_dual(family, closed, dual, found)) is not None]
        if fits:
            signs = signs_at(family, fits[0], found[0])
            pattern = tuple((p, e, sign) for (p, e, _), sign in zip(spans[k].pattern, signs, strict=True))
            return replace(span, pattern=pattern), fits
    return None


def inside(span: Span) -> list[Fraction]:
    """Values inside the span."""
    return [(span.lower + (span.upper - span.lower) * share).limit_denominator(10**6) for share in SHARES]


def signs_at(family: Family, closed: Closed, one: Sample) -> list[int]:
    """Signs of the weights at a value of the parameter."""
    return [1 if bool(enclose(family.at(w, one.T)) > 0) else -1 for w in closed.weights]


def still_dual(found: Sequence[Sample]) -> tuple[sp.Expr, ...] | None:
    """The dual that all samples share, when its entries are short rational numbers."""
    if len(found) < 3:
        return None
    duals = [[number(x) for x in one.polished.dual] for one in found]
    short = tuple(x.limit_denominator(LARGEST) for x in duals[0])
    moves = any(abs(x - y) > NEAR for row in duals for x, y in zip(row, short, strict=True))
    return None if moves else short


def with_dual(family: Family, closed: Closed, dual: tuple[sp.Expr, ...], found: Sequence[Sample]) -> Closed | None:
    """Places and weights of a regime with another dual, when they cost what it reaches at all samples."""
    value = sp.expand(sum((x * p for x, p in zip(dual, family.functional, strict=True)), sp.S.Zero))
    cost = sum((family.sigma[k] * sp.Abs(w) for k, w in zip(closed.panels, closed.weights, strict=True)), sp.S.Zero)
    gap = [enclose(family.at(cost - value, one.T), bits=200) for one in found]
    if not all(bool(abs(size) < 1e-30) for size in gap):
        return None
    return replace(closed, dual=dual, value=value, verdict=Verdict(OPEN, "none"))
