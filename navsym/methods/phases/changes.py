"""Where the pattern changes, from closed forms that are proved between the changes.

A change is located from closed forms as they are guessed, and they are proved between the changes. Where a proof fails
a change that rests on the guess is located again without it, and what is proved on either side is proved anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import sympy as sp

from navsym.methods.phases.answer import end_text
from navsym.methods.phases.closed import Closed, prove
from navsym.methods.phases.events import Boundary, boundary, nowhere
from navsym.methods.phases.family import Family
from navsym.methods.phases.limit import Limit
from navsym.methods.phases.scan import Span

Forms = Sequence[Closed | None]
Ends = tuple[sp.Expr, sp.Expr]


def located(
    family: Family, spans: Sequence[Span], closed: Sequence[Closed | None], limit: Limit
) -> tuple[Boundary, ...]:
    """The changes from each span to the next, as exactly as they are had within the limit."""
    found = []
    for k, (left, right) in enumerate(pairwise(spans)):
        part = limit.share(1 / (len(spans) - 1 - k))
        found.append(change(family, left, right, part, closed[k], closed[k + 1]) or nowhere(left.upper))
    return tuple(found)


def change(
    family: Family, left: Span, right: Span, limit: Limit, before: Closed | None = None, after: Closed | None = None
) -> Boundary | None:
    """The change from one span to the next; None when it is not had within the limit."""
    return limit.within(
        f"the change of pattern near {float(left.upper):.6g}", boundary, family, left, right, before, after
    )  # type: ignore[no-any-return]


def firm(
    family: Family,
    spans: Sequence[Span],
    guesses: Sequence[Sequence[Closed]],
    changes: Sequence[Boundary],
    ends: Ends,
    limit: Limit,
) -> tuple[list[Boundary], list[Closed | None]]:
    """The changes and the closed forms proved between them, each in agreement with the other.

    changes : located from the first guess of every span
    After the first round a form only stays or falls, and no change moves unless one beside it fell.
    """
    rest: list[Closed | None] = [g[0] if g else None for g in guesses]
    parts = pieces_of(changes, ends)
    forms = [
        proved_form(family, g, part, limit.share(1 / (len(spans) - k)))
        for k, (g, part) in enumerate(zip(guesses, parts, strict=True))
    ]
    while not all(map(same, rest, forms)):
        changes, before = relocated(family, spans, changes, rest, forms, limit), parts
        rest, parts = forms, pieces_of(changes, ends)
        forms = [
            form if form is None or part == old else proved_form(family, [form], part, limit.share(1 / 2))
            for form, part, old in zip(rest, parts, before, strict=True)
        ]
    return list(changes), forms


def relocated(
    family: Family, spans: Sequence[Span], changes: Sequence[Boundary], rest: Forms, forms: Forms, limit: Limit
) -> list[Boundary]:
    """The changes, those located again that rest on another closed form than is proved beside them."""
    found = []
    for k, b in enumerate(changes):
        if b.at is not None and not (same(rest[k], forms[k]) and same(rest[k + 1], forms[k + 1])):
            b = change(family, spans[k], spans[k + 1], limit, forms[k], forms[k + 1]) or nowhere(spans[k].upper)
        found.append(b)
    return found


def proved_form(family: Family, guesses: Sequence[Closed], ends: Ends, limit: Limit) -> Closed | None:
    """The closed form that is proved between the ends within the limit."""
    found = prove(family, guesses, *ends, seconds=limit.left()) if guesses and not limit.met() else None
    if found is not None and found.verdict.status.holds:
        return found
    if guesses and limit.met():
        limit.gives_up(f"the proof of a closed form from {end_text(ends[0])} to {end_text(ends[1])}")
    return None


def same(one: Closed | None, other: Closed | None) -> bool:
    """True for the same estimator and dual, whatever the verdicts."""
    if one is None or other is None:
        return one is other
    return (one.panels, one.places, one.weights, one.dual) == (other.panels, other.places, other.weights, other.dual)


def pieces_of(changes: Sequence[Boundary], ends: Ends) -> list[Ends]:
    """The range between its ends, cut at the changes."""
    return list(pairwise([ends[0], *map(middle_of, changes), ends[1]]))


def middle_of(b: Boundary) -> sp.Expr:
    """The exact value of a boundary, or the middle of its bracket."""
    return b.at if b.at is not None else (sp.Rational(b.lower) + sp.Rational(b.upper)) / 2


__all__ = ["change", "firm", "located", "middle_of"]
