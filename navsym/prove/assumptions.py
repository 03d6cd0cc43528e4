"""What a proof takes for granted, and what of it the box guarantees."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import sympy as sp

from navsym.claims.statement import Box
from navsym.prove.identities.normal_form import (
    Reduction,
    divisors_inside,
    logarithms_inside,
    radicands_inside,
    reduce_to_zero,
)
from navsym.prove.sampling.points import ranges_of
from navsym.prove.signs.bounds import Sign, prove_sign
from navsym.prove.signs.one_variable import survey_signs
from navsym.prove.wording import expression_text


def add_sides(reduction: Reduction, *sides: sp.Expr) -> Reduction:
    """Add the divisors and radicands of the sides, which subtraction may have cancelled."""
    parts = [reduction, *(reduce_to_zero(side) for side in sides)]

    def union(name: str) -> tuple[sp.Basic, ...]:
        return tuple(dict.fromkeys(item for part in parts for item in getattr(part, name)))

    return replace(reduction, divisors=union("divisors"), radicands=union("radicands"), arguments=union("arguments"))


def conditions_as_written(*sides: sp.Expr) -> Reduction:
    """Divisors, radicands and arguments of logarithms as they stand in the sides; nothing is reduced."""
    whole = sp.Tuple(*sides)

    def found(walk: Callable[[sp.Expr], list[sp.Basic]]) -> tuple[sp.Basic, ...]:
        return tuple(dict.fromkeys(walk(whole)))

    parts = (found(divisors_inside), found(radicands_inside), found(logarithms_inside))
    return Reduction(False, *parts, ring="", complete=False)


def is_positive(expression: sp.Basic, box: Box) -> bool:
    """True when the expression is proved to be positive on the box."""
    return prove_sign(expression, box, Sign.POSITIVE).at_least(Sign.POSITIVE)


def is_nonnegative(expression: sp.Basic, box: Box) -> bool:
    """True when the expression is proved not to be negative on the box."""
    return prove_sign(expression, box).at_least(Sign.NONNEGATIVE)


def has_no_zeros(expression: sp.Basic, box: Box) -> bool:
    """True when exact real roots show that an expression in one symbol is zero nowhere in its range."""
    found = list(ranges_of(list(expression.free_symbols), box).values())
    known = survey_signs(expression, found[0]) if len(found) == 1 else None
    return known is not None and all(found[0].nonzero and zero.at == 0 for zero in known.zeros)


def is_nonzero(expression: sp.Basic, box: Box) -> bool:
    """True when the expression is proved to vanish nowhere on the box."""
    if has_no_zeros(expression, box):
        return True
    return is_positive(expression, box) or is_positive(-expression, box)


#: What is taken for granted of the parts of a reduction: in words, and when the box guarantees it.
KINDS: tuple[tuple[str, str, Callable[[sp.Expr, Box], bool]], ...] = (
    ("divisors", "!= 0", is_nonzero),
    ("radicands", ">= 0", is_nonnegative),
    ("arguments", "> 0", is_positive),
)


def remaining_assumptions(
    reduction: Reduction,
    box: Box,
    nonzero: Sequence[sp.Expr] = (),
    at: Callable[[sp.Expr], sp.Expr] = lambda part: part,
) -> tuple[str, ...]:
    """What the proof took for granted and the box does not guarantee.

    at : what stands for a part on the box, where its variables are written by others there
    """
    whole = replace(reduction, divisors=(*reduction.divisors, *nonzero))
    found = [
        f"{expression_text(part)} {sign}"
        for name, sign, holds in KINDS
        for part in getattr(whole, name)
        if not holds(at(part), box)
    ]
    return tuple(dict.fromkeys(found))
