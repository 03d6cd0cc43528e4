"""Whether a formula vanishes identically, and whether a number is zero: by the algebra of the checker."""

from __future__ import annotations

import functools

import sympy as sp

from navsym.core.balls import exact_ball
from navsym.core.errors import NavsymError
from navsym.prove.rooms.goals import Term, from_sympy, player

#: Of these, each normal form is unique: where it is not zero, the function is not zero throughout.
UNIQUE = (sp.sin, sp.cos, sp.tan, sp.cot, sp.sec, sp.csc, sp.exp, sp.sinh, sp.cosh, sp.tanh)


def read_term(expression: sp.Expr) -> Term:
    """The expression as the checker reads it. Raises NavsymError for what is not in its language."""
    return player.parse(from_sympy(expression))


@functools.lru_cache(maxsize=1024)
def vanishes_identically(expression: sp.Expr) -> bool:
    """True when exact algebra shows that the expression is zero wherever it is defined; false when it does not."""
    try:
        return bool(player.is_identity(read_term(sp.sympify(expression, strict=True))))
    except (NavsymError, player.Refused, OverflowError):
        return False


def has_unique_form(expression: sp.Expr) -> bool:
    """Whether :func:`vanishes_identically` decides: no roots, logarithms or inverse functions occur."""
    powers = (power.exp for power in expression.atoms(sp.Pow))
    return all(isinstance(f, UNIQUE) for f in expression.atoms(sp.Function)) and all(q.is_Integer for q in powers)


@functools.lru_cache(maxsize=1024)
def is_zero(number: sp.Expr, seconds: float = 2.0) -> bool:
    """True when a proof shows that the number is zero; false when it is not, or when none is found."""
    from navsym.prove.search import find_proof

    ball = exact_ball(number, 128)
    if not ball.is_finite() or not ball.contains(0):
        return False
    try:
        return find_proof(player.Goal(read_term(number), "=", {}), seconds) is not None
    except (NavsymError, player.Refused):
        return False
