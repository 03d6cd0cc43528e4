"""Is a number zero? Exactly, by the ways that need no box: normal form, radicals, logarithms, inverse functions."""

from __future__ import annotations

import sympy as sp

from navsym.errors import NavsymError
from navsym.proof.balls import enclose, exact_ball, tape
from navsym.proof.identities.algebraic import is_algebraic_zero
from navsym.proof.identities.inverses import KINDS, solved_for_inverses
from navsym.proof.identities.logarithms import expand_logarithms
from navsym.proof.identities.normal_form import OutsideLanguageError, vanishes_identically

DEPTH = 2


def is_zero(number: sp.Expr, depth: int = DEPTH) -> bool:
    """True when the number is proved to be zero; false when it is not, or when no way decides it."""
    ball = exact_ball(number, 128)
    if not ball.is_finite() or not ball.contains(0):
        return False
    if is_formally_zero(number):
        return True
    algebraic = is_algebraic_zero(number)
    if algebraic is not None:
        return algebraic
    if not number.has(*KINDS):
        return False
    spread = expand_logarithms(number, is_positive_number)
    return is_formally_zero(spread) or (depth > 0 and by_inverses(number, depth))


def is_formally_zero(number: sp.Expr) -> bool:
    """Zero by the normal form; false where the number lies outside its language."""
    try:
        return vanishes_identically(number)
    except OutsideLanguageError:
        return False


def by_inverses(number: sp.Expr, depth: int) -> bool:
    """Zero by the definition of one of its inverse functions."""
    for solved in solved_for_inverses(number):
        try:
            if not is_zero(solved.left - solved.right, depth - 1):
                continue
            if all(is_positive_number(value) for value in solved.positive) and all(
                is_positive_number(value) or is_zero(value, depth - 1) for value in solved.nonnegative
            ):
                return True
        except NavsymError:
            continue
    return False


def is_positive_number(number: sp.Expr) -> bool:
    """True when a ball of 256 bits lies above zero."""
    return bool(not number.free_symbols and enclose(tape(number), {}, 256) > 0)
