"""Where a rational function of one symbol, with absolute values of such, takes all of its signs: by its real roots.

Between two neighbouring roots of numerators and denominators it keeps its sign, so that one number between them tells.
The roots of irreducible factors are enclosed by flint, with as many bits as hold them apart. A search, which proves
nothing: a statement that no place breaks is still to be proved.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain, pairwise
from typing import Any

import sympy as sp
from flint import fmpq, fmpq_poly, fmpz_poly

from navsym.core.balls import exact_ball, precision
from navsym.core.exact import to_fmpq, to_rational
from navsym.prove.identities import read_term
from navsym.prove.rooms.goals import player
from navsym.prove.sampling.points import Range

BITS = (128, 512, 2048, 8192)
MOST_DEGREE = 400
#: Absolute values in one expression; each doubles the cases.
MOST_VALUES = 6
#: Ends of a range are fractions with at most about so many bits: exp(10**12) is none.
LONGEST = 10**5
SHARES = ((1, 2), (1, 16), (15, 16), (1, 256), (255, 256))


@dataclass(frozen=True, slots=True, eq=False)
class Root:
    """A real number between two rational ones; ``at`` is its formula, if it has one."""

    lower: fmpq
    upper: fmpq
    at: sp.Expr | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """Places that tell all signs of a function on its range.

    between  : for each interval between neighbouring roots some rational numbers of it, the simplest first
    roots    : the roots in the range, and its ends
    complete : whether all that has to exist is a rational function, too
    """

    between: tuple[tuple[sp.Rational, ...], ...]
    roots: tuple[Root, ...]
    complete: bool


def list_places(expression: sp.Expr, sides: Iterable[sp.Expr], limit: Range) -> Places | None:
    """The places of an expression in one symbol on its range, where sides have to exist; None for other functions."""
    one_point = limit.lower is not None and limit.lower == limit.upper
    if limit.integer or one_point or len(expression.atoms(sp.Abs)) > MOST_VALUES:
        return None
    terms = [read_term(part) for part in list_cases(expression)]
    needed = player.set_union(player.conditions(read_term(side)) for side in (expression, *sides))
    pairs = [*map(read_fraction, terms)]
    others = [read_fraction(part) for _, part in needed]
    if None in pairs:
        return None
    known = [polynomial for pair in (*pairs, *others) for polynomial in pair or ()]
    if any(polynomial.degree() > MOST_DEGREE for polynomial in known):
        return None
    placed = place_roots(known, limit)
    if placed is None:
        return None
    low, inside, high = placed
    between = tuple(tuple(numbers_between(*gap)) for gap in pairwise([low, *inside, high]))
    ends = (end for end in (low, high) if end is not None)
    return Places(between, (*inside, *ends), None not in others)


def list_cases(expression: sp.Expr) -> Iterator[sp.Expr]:
    """The expression for all signs of its absolute values, inner ones first, and what has these signs."""
    values = sorted((v for v in expression.atoms(sp.Abs) if not v.args[0].has(sp.Abs)), key=sp.default_sort_key)
    if not values:
        yield expression
        return
    inside = values[0].args[0]
    yield inside
    for sign in (1, -1):
        yield from list_cases(expression.xreplace({values[0]: sign * inside}))


def read_fraction(term: Any) -> tuple[fmpq_poly, fmpq_poly] | None:
    """A rational function over Q of one symbol, in lowest terms; None for other terms."""
    try:
        top, bottom = player.to_fraction(term)
    except (player.Refused, OverflowError):
        return None
    common = top.gcd(bottom)
    return (top / common, bottom / common) if bottom != 0 else None


def place_roots(polynomials: Iterable[fmpq_poly], limit: Range) -> tuple[Root | None, list[Root], Root | None] | None:
    """The ends of a range, None at infinity, and the real roots strictly between; None where they stay together.

    A root that 8,192 bits do not hold apart from an end is taken for that end.
    """
    factors = {tuple(map(int, f.coeffs())): f for p in polynomials if p.degree() > 0 for f, _ in p.numer().factor()[1]}
    for bits in BITS:
        low, high = (None if end is None else enclose_number(end, bits) for end in (limit.lower, limit.upper))
        if (low is None and limit.lower is not None) or (high is None and limit.upper is not None):
            return None
        found = sorted(chain(*(enclose_roots(f, bits) for f in factors.values())), key=lambda root: root.lower)
        ends = [end for end in (low, high) if end is not None]
        apart = all(left.upper < right.lower for left, right in pairwise(found))
        if apart and (bits == BITS[-1] or not any(is_near(root, end) for root in found for end in ends)):
            above = (root for root in found if low is None or root.lower > low.upper)
            return low, [root for root in above if high is None or root.upper < high.lower], high
    return None


def is_near(root: Root, end: Root) -> bool:
    """Whether the enclosures meet of numbers that are not both rational."""
    return bool(root.lower <= end.upper and end.lower <= root.upper and not root.lower == root.upper == end.upper)


def enclose_number(value: sp.Expr, bits: int) -> Root | None:
    """An exact real number; None where it has no finite ball, or is too long."""
    if isinstance(value, sp.Rational):
        return Root(to_fmpq(value), to_fmpq(value), value)
    ball = exact_ball(value, bits)
    if not ball.is_finite() or abs(int(ball.mid().man_exp()[1])) > LONGEST:
        return None
    with precision(2 * bits):
        return Root(to_fmpq(ball.lower()), to_fmpq(ball.upper()), value)


def enclose_roots(factor: fmpz_poly, bits: int) -> Iterator[Root]:
    """The real roots of an irreducible polynomial."""
    if factor.degree() == 1:
        root = fmpq(-int(factor[0]), int(factor[1]))
        yield Root(root, root, to_rational(root))
        return
    with precision(bits):
        for root in (pair[0] for pair in factor.complex_roots()):  # type: ignore[index]
            if root.imag == 0:
                lower, upper = to_fmpq(root.real.lower()), to_fmpq(root.real.upper())
                yield Root(lower, upper, find_surd(factor, lower + upper))


def find_surd(factor: fmpz_poly, twice: fmpq) -> sp.Expr | None:
    """The root of a quadratic factor, or of a x**n + c, near half a number as a formula; None for others."""
    n, (c, b, *_, a) = factor.degree(), [sp.Integer(int(k)) for k in factor.coeffs()]
    if not any(factor.coeffs()[1:-1]):
        return (1 if twice > 0 else -1) * sp.root(abs(c / a), n)
    if n != 2:
        return None
    middle = sp.Rational(-b, 2 * a)
    return middle + (1 if twice > 2 * to_fmpq(middle) else -1) * sp.sqrt(b**2 - 4 * a * c) / (2 * sp.Abs(a))


def numbers_between(left: Root | None, right: Root | None) -> Iterator[sp.Rational]:
    """Rational numbers strictly between two places of which the left is less, the simplest first; None is infinity."""
    if left is None and right is None:
        yield from (sp.Integer(n) for n in (0, 1, -1, 1000, -1000))
    elif left is None or right is None:
        sign = 1 if left is not None else -1
        end = left.upper.floor() if left is not None else right.lower.ceil()  # type: ignore[union-attr]
        yield from (sp.Integer(int(end) + sign * step) for step in (1, 2, 10, 1000, 10**6))
    elif left.upper < right.lower:
        low, high = left.upper, right.lower
        yield to_rational(simplest_between(low, high))
        yield from (to_rational(low + (high - low) * fmpq(*share)) for share in SHARES)


def simplest_between(low: fmpq, high: fmpq) -> fmpq:
    """The fraction with the least denominator strictly between two numbers, by continued fractions."""
    whole = low.floor()
    if whole + 1 < high:
        return fmpq(0) if low < 0 < high else fmpq(whole + 1) if low >= 0 else fmpq(high.ceil() - 1)
    low, high = low - whole, high - whole  # 0 <= low < high <= 1
    if low == 0:
        return whole + 1 / fmpq((1 / high).floor() + 1)
    return whole + 1 / simplest_between(1 / high, 1 / low)
