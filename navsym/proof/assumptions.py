"""What a proof takes for granted, and what of it the box guarantees."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import sympy as sp

from navsym.claims.statement import Box
from navsym.proof.identities.normal_form import (
    Reduction,
    divisors_inside,
    logarithms_inside,
    radicands_inside,
    reduce_to_zero,
)
from navsym.proof.signs.bounds import Sign, prove_sign
from navsym.proof.wording import text_of


def with_sides(reduction: Reduction, *sides: sp.Expr) -> Reduction:
    """Add the divisors and radicands of the sides, which subtraction may have cancelled."""
    parts = [reduction, *(reduce_to_zero(side) for side in sides)]

    def union(name: str) -> tuple[sp.Basic, ...]:
        return tuple(dict.fromkeys(item for part in parts for item in getattr(part, name)))

    return replace(
        reduction, divisors=union("divisors"), radicands=union("radicands"), arguments=union("arguments")
    )


def written_conditions(*sides: sp.Expr) -> Reduction:
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


def is_nonzero(expression: sp.Basic, box: Box) -> bool:
    """True when the expression is proved to keep one sign on the box."""
    return is_positive(expression, box) or is_positive(-expression, box)


def remaining_assumptions(reduction: Reduction, box: Box, nonzero: Sequence[sp.Expr] = ()) -> tuple[str, ...]:
    """What the proof took for granted and the box does not guarantee."""
    found = [f"{text_of(d)} != 0" for d in (*reduction.divisors, *nonzero) if not is_nonzero(d, box)]
    found += [f"{text_of(r)} >= 0" for r in reduction.radicands if not is_nonnegative(r, box)]
    found += [f"{text_of(a)} > 0" for a in reduction.arguments if not is_positive(a, box)]
    return tuple(dict.fromkeys(found))
