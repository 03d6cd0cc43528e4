"""Real numbers between rational ones: the real roots of a polynomial, the ends of a range, and their order.

The roots of the irreducible factors of a polynomial over Q are enclosed by flint, and counted again here: every
enclosure of a real root has a change of sign at its ends, no two meet, and together with those that are not
real they are as many as the degree. Distinct factors have no root in common, so that all roots can be ordered.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import sympy as sp
from flint import fmpq, fmpq_poly, fmpz_poly

from navsym.core.balls import exact_ball, precision
from navsym.core.exact import to_fmpq, to_rational
from navsym.prove.identities import is_zero

#: Bits of a first enclosure, and those beyond which two numbers stay undecided.
FIRST_BITS, MOST_BITS = 64, 8192
MOST_DEGREE = 400
#: Ends of a range are fractions with at most about so many bits: exp(10**12) is none.
LONGEST = 10**5


class UndecidedError(Exception):
    """Two numbers are not told apart, or a polynomial is too large."""


@dataclass(slots=True, eq=False)
class RealNumber:
    """A real number from ``lower`` to ``upper``, which are equal for a rational one.

    factor  : the irreducible polynomial of which it is the only root between them, None for an end of a range
    value   : the exact number, where it has a formula
    sharper : a nearer enclosure of an end
    """

    lower: fmpq
    upper: fmpq
    factor: fmpq_poly | None = None
    value: sp.Expr | None = None
    sharper: Callable[[int], tuple[fmpq, fmpq]] | None = None
    bits: int = FIRST_BITS
    exact: bool = field(init=False, default=False)

    def __post_init__(self) -> None:
        self.exact = self.lower == self.upper

    def sharpen(self) -> None:
        """A narrower enclosure: many halvings by the sign of the polynomial, or more bits of the formula."""
        if self.bits > MOST_BITS:
            raise UndecidedError
        self.bits *= 2
        if self.factor is not None:
            self.halve()
        elif self.sharper is not None:
            self.lower, self.upper = self.sharper(self.bits)

    def halve(self) -> None:
        """Halve down to 2**-bits of where it began."""
        assert self.factor is not None
        below, width = self.factor(self.lower), fmpq(1, 2) ** self.bits
        while self.upper - self.lower > width:
            middle = (self.lower + self.upper) / 2
            if self.factor(middle) * below > 0:
                self.lower = middle
            else:
                self.upper = middle


def rational_number(number: fmpq) -> RealNumber:
    """A rational number."""
    return RealNumber(number, number, value=to_rational(number))


def enclose_number(value: sp.Expr) -> RealNumber:
    """An exact real number of the language. Raises UndecidedError where it has no finite ball, or is too long."""
    if isinstance(value, sp.Rational):
        return rational_number(to_fmpq(value))

    def enclosure(bits: int) -> tuple[fmpq, fmpq]:
        ball = exact_ball(value, bits)
        if not ball.is_finite() or abs(int(ball.mid().man_exp()[1])) > LONGEST:
            raise UndecidedError
        with precision(2 * bits):
            return (to_fmpq(ball.lower()), to_fmpq(ball.upper()))

    return RealNumber(*enclosure(FIRST_BITS), value=value, sharper=enclosure)


# -- roots ---------------------------------------


def find_real_roots(polynomials: Iterable[fmpq_poly]) -> list[RealNumber]:
    """All real roots of the polynomials other than zero, each once, in no order."""
    found: dict[tuple[int, ...], fmpz_poly] = {}
    for polynomial in polynomials:
        if polynomial.degree() > MOST_DEGREE:
            raise UndecidedError
        if polynomial.degree() > 0:
            found |= {tuple(map(int, f.coeffs())): f for f, _ in polynomial.numer().factor()[1]}
    return [root for factor in found.values() for root in roots_of_factor(factor)]


def is_root(polynomial: fmpq_poly, root: RealNumber) -> bool:
    """True when a polynomial is zero at a root: it has its irreducible factor, or is zero at the rational number."""
    if polynomial.degree() < 0:
        return True
    return bool(polynomial % root.factor == 0 if root.factor is not None else polynomial(root.lower) == 0)


def roots_of_factor(factor: fmpz_poly) -> Iterator[RealNumber]:
    """The real roots of an irreducible polynomial."""
    if factor.degree() == 1:
        yield rational_number(fmpq(-int(factor[0]), int(factor[1])))
        return
    bits = FIRST_BITS
    while (found := isolate_roots(factor, bits)) is None:
        bits *= 2
        if bits > MOST_BITS:
            raise UndecidedError
    for lower, upper in found:
        yield RealNumber(lower, upper, factor=fmpq_poly(factor), value=surd(factor, lower, upper), bits=bits)


def isolate_roots(factor: fmpz_poly, bits: int) -> list[tuple[fmpq, fmpq]] | None:
    """Intervals with one root each, as many as there are real roots; None where that is not shown by so many bits."""
    with precision(bits):
        found = [pair[0] for pair in factor.complex_roots()]  # type: ignore[index]
        intervals = sorted((to_fmpq(r.real.lower()), to_fmpq(r.real.upper())) for r in found if r.imag == 0)
    others = sum(1 for root in found if not root.imag.contains(0))
    if len(intervals) + others != factor.degree():
        return None
    curve = fmpq_poly(factor)
    crossed = all(curve(low) * curve(high) < 0 for low, high in intervals)
    apart = all(left[1] < right[0] for left, right in pairwise(intervals))
    return intervals if crossed and apart else None


def surd(factor: fmpz_poly, lower: fmpq, upper: fmpq) -> sp.Expr | None:
    """The root of a quadratic factor, or of a x**n + c, between two numbers as a formula; None for others."""
    n, (c, b, *_, a) = factor.degree(), [sp.Integer(int(k)) for k in factor.coeffs()]
    if not any(factor.coeffs()[1:-1]):
        return (1 if lower + upper > 0 else -1) * sp.root(abs(c / a), n)
    if n != 2:
        return None
    middle = sp.Rational(-b, 2 * a)
    right = lower + upper > 2 * to_fmpq(middle)
    return middle + (1 if right else -1) * sp.sqrt(b**2 - 4 * a * c) / (2 * sp.Abs(a))


# -- order ---------------------------------------


def compare_numbers(left: RealNumber, right: RealNumber) -> int:
    """-1, 0 or 1 as the left number is less than, equal to or greater than the right one; exact."""
    if order_by_enclosures(left, right) == 0 and are_equal(left, right):
        return 0
    while (found := order_by_enclosures(left, right)) == 0:
        sharpen(left, right)
    return found


def order_by_enclosures(left: RealNumber, right: RealNumber) -> int:
    """The order by the enclosures; 0 while they meet."""
    return int(left.lower > right.upper) - int(left.upper < right.lower)


def sharpen(*places: RealNumber) -> None:
    """Narrower enclosures of all that are not rational. Raises UndecidedError where none is left."""
    moving = [place for place in places if not place.exact]
    if not moving:
        raise UndecidedError
    for place in moving:
        place.sharpen()


def are_equal(left: RealNumber, right: RealNumber) -> bool:
    """True when two numbers whose enclosures meet are proved to be the same."""
    if left.exact and right.exact:
        return True
    if left.factor is not None and right.factor is not None:
        return left.factor == right.factor and hold_one_root(left, right)
    if left.factor is None and right.factor is None:
        return left.value is not None and right.value is not None and is_zero(left.value - right.value)
    root, end = (left, right) if left.factor is not None else (right, left)
    assert root.factor is not None
    if end.exact or end.value is None or not is_zero(polynomial_at(root.factor, end.value)):
        return False  # a rational number is no root of an irreducible factor
    while not (root.lower < end.lower and end.upper < root.upper) and order_by_enclosures(root, end) == 0:
        end.sharpen()  # a root of the factor: this one, which lies inside, or another one, which does not
    return order_by_enclosures(root, end) == 0


def hold_one_root(left: RealNumber, right: RealNumber) -> bool:
    """True when two enclosures of roots of one polynomial hold the same root: it changes its sign where they meet."""
    low, high = max(left.lower, right.lower), min(left.upper, right.upper)
    assert left.factor is not None
    return bool(low < high and left.factor(low) * left.factor(high) < 0)


def polynomial_at(polynomial: fmpq_poly, at: sp.Expr) -> sp.Expr:
    """The value of a polynomial at an exact number."""
    total = sp.Integer(0)
    for c in reversed(polynomial.coeffs()):
        total = total * at + to_rational(c)
    return total


def number_between(left: RealNumber | None, right: RealNumber | None) -> fmpq:
    """The simplest rational number strictly between two places of which the left is less; None is infinity."""
    if left is None and right is None:
        return fmpq(0)
    if left is None or right is None:
        place = left or right
        assert place is not None
        return fmpq(place.upper.floor() + 1) if right is None else fmpq(place.lower.ceil() - 1)
    while order_by_enclosures(left, right) == 0:
        sharpen(left, right)
    return simplest_between(left.upper, right.lower)


def simplest_between(low: fmpq, high: fmpq) -> fmpq:
    """The fraction with the least denominator strictly between two numbers, by continued fractions."""
    whole = low.floor()
    if whole + 1 < high:
        return fmpq(0) if low < 0 < high else fmpq(whole + 1) if low >= 0 else fmpq(high.ceil() - 1)
    low, high = low - whole, high - whole  # 0 <= low < high <= 1
    if low == 0:
        return whole + 1 / fmpq((1 / high).floor() + 1)
    return whole + 1 / simplest_between(1 / high, 1 / low)
