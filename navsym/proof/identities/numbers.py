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


def denested(root: sp.Expr) -> sp.Expr:
    """sqrt(a + sqrt(b)) = sqrt((a + d)/2) + sqrt((a - d)/2) for d**2 = a**2 - b, and the same with minus.

    The root as it was where d is not rational, or where the two are not proved to be the same number.
    """
    if not root.is_Pow or root.exp != sp.S.Half or not root.base.is_Add:
        return root
    a, surd = root.base.as_two_terms()
    if not (a.is_Rational and a > 0 and (surd**2).is_Rational and surd**2 > 0):
        return root
    d = sp.sqrt(a**2 - surd**2)
    if not d.is_Rational:
        return root
    sign = 1 if exact_ball(surd) > 0 else -1
    simpler = sp.sqrt((a + d) / 2) + sign * sp.sqrt((a - d) / 2)
    return simpler if is_zero(root - simpler) else root


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
