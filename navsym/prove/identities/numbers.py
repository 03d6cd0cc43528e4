"""Is a number zero? Exactly, by the ways that need no box: normal form, radicals, logarithms, inverse functions."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from math import ceil, lcm, prod

import sympy as sp

from navsym.core.balls import enclose, exact_ball, tape
from navsym.core.errors import NavsymError
from navsym.prove.identities.ingredients import TRIGONOMETRIC
from navsym.prove.identities.normal_form import OutsideLanguageError, vanishes_identically
from navsym.prove.identities.transcendental import KINDS, expand_logarithms, solve_for_inverses

# Numbers given by radicals and by sines and cosines of rational turns: zero or not, decided exactly.
#
# Such a number is beta/gamma with algebraic integers of a field of degree D. Bounds u of all conjugates of
# beta and l of gamma follow from the expression, step by step; a nonzero beta has a norm of at least one,
# hence ``|beta/gamma| >= u**(1 - D) / l`` unless it is zero. A ball below that bound which contains zero
# therefore is zero (Burnikel, Fleischer, Mehlhorn and Schirra 2001, in its simplest form).


#: More bits are not spent on one number; what needs them stays undecided.
MOST_BITS = 200_000
FIRST_BITS = 128
ZERO = Fraction(0)


class NotAlgebraicError(Exception):
    """The number is not given by radicals and rational turns."""


@dataclass(frozen=True, slots=True)
class Size:
    """log2 of bounds of all conjugates of a numerator and of a denominator, both algebraic integers."""

    top: Fraction
    bottom: Fraction


@dataclass(slots=True)
class Field:
    """What generates the field: distinct roots, and one root of unity."""

    roots: dict[tuple[sp.Basic, int], None] = field(default_factory=dict)
    unity: int = 1

    def degree(self) -> int:
        """An upper bound of the degree over the rationals."""
        return int(sp.totient(self.unity)) * prod(q for _, q in self.roots)


def is_algebraic_zero(number: sp.Expr) -> bool | None:
    """True or false when the number is provably zero or provably not; None when this cannot tell."""
    first = enclose(tape(number), {}, FIRST_BITS)
    if not first.is_finite():
        return None
    if not first.contains(0):
        return False
    bits = separation_bits(number)
    if bits is None or bits > MOST_BITS:
        return None
    for spare in (64, 512):
        ball = enclose(tape(number), {}, bits + spare)
        if not ball.contains(0):
            return False
        if abs(ball).upper() * 2**bits < 1:
            return True
    return None


def separation_bits(number: sp.Expr) -> int | None:
    """b with ``|number| >= 2**-b`` unless it is zero; None for what is not algebraic."""
    known: dict[sp.Basic, Size] = {}
    base = Field()
    try:
        size = measure(number, base, known)
    except NotAlgebraicError:
        return None
    return ceil(size.top) * (base.degree() - 1) + ceil(size.bottom)


def measure(node: sp.Basic, base: Field, known: dict[sp.Basic, Size]) -> Size:
    """Size of a node; the field grows by what it needs."""
    if node not in known:
        known[node] = measure_new(node, base, known)
    return known[node]


def measure_new(node: sp.Basic, base: Field, known: dict[sp.Basic, Size]) -> Size:
    if isinstance(node, sp.Rational):
        return Size(Fraction(abs(int(node.p)).bit_length()), Fraction(int(node.q - 1).bit_length()))
    if isinstance(node, sp.Add):
        return sum_size([measure(argument, base, known) for argument in node.args])
    if isinstance(node, sp.Mul):
        sizes = [measure(argument, base, known) for argument in node.args]
        return Size(sum((s.top for s in sizes), ZERO), sum((s.bottom for s in sizes), ZERO))
    if isinstance(node, sp.Pow) and isinstance(node.exp, sp.Rational) and node.base is not sp.E:
        return power_size(measure(node.base, base, known), node, base)
    if isinstance(node, sp.Abs):
        return measure(node.args[0], base, known)
    if isinstance(node, TRIGONOMETRIC):
        return turn_size(node, base)
    raise NotAlgebraicError


def sum_size(sizes: list[Size]) -> Size:
    """beta_1/gamma_1 + ... over the product of the denominators."""
    bottom = sum((s.bottom for s in sizes), ZERO)
    top = max(s.top + bottom - s.bottom for s in sizes)
    return Size(top + (len(sizes) - 1).bit_length(), bottom)


def power_size(size: Size, node: sp.Pow, base: Field) -> Size:
    """(beta/gamma)**(1/q) = (beta gamma**(q-1))**(1/q) / gamma, then a whole power."""
    p, q = int(node.exp.p), int(node.exp.q)
    if q > 1:
        base.roots.setdefault((node.base, q))
        size = Size((size.top + (q - 1) * size.bottom) / q, size.bottom)
    if p < 0:
        size = Size(size.bottom, size.top)
    return Size(size.top * abs(p), size.bottom * abs(p))


def turn_size(node: sp.Basic, base: Field) -> Size:
    """2 cos and 2 sin of a rational turn are algebraic integers with all conjugates in [-2, 2]."""
    turns = node.args[0] / sp.pi
    if not isinstance(turns, sp.Rational):
        raise NotAlgebraicError
    base.unity = lcm(base.unity, 4, 2 * int(turns.q))
    return Size(Fraction(1), Fraction(1))


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
    return is_formally_zero(spread) or (depth > 0 and is_zero_by_inverses(number, depth))


def is_formally_zero(number: sp.Expr) -> bool:
    """Zero by the normal form; false where the number lies outside its language."""
    try:
        return vanishes_identically(number)
    except OutsideLanguageError:
        return False


def is_zero_by_inverses(number: sp.Expr, depth: int) -> bool:
    """Zero by the definition of one of its inverse functions."""
    for solved in solve_for_inverses(number):
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
