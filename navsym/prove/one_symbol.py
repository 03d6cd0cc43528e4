"""Relations in one symbol, decided by real roots: PROVED, or REFUTED at a place where all sides exist.

The statement is about the points of the range where its sides exist. What holds between all roots and at all
zeros therefore holds; what does not is refuted at a point of an interval between two roots, or at a root.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import sympy as sp
from flint import arb

from navsym.claims.statement import Box
from navsym.claims.verdict import PROVED, REFUTED, Verdict
from navsym.core.balls import UnsupportedError, exact_ball, tape
from navsym.core.exact import to_fraction, to_rational
from navsym.core.numbers import Number
from navsym.prove.assumptions import divisors_inside, logarithms_inside, radicands_inside, remaining_assumptions
from navsym.prove.sampling.points import Point, Range, ranges_of, value_at
from navsym.prove.sampling.second_look import exists_at
from navsym.prove.signs.one_variable import Survey, Zero, survey_signs
from navsym.prove.signs.real_roots import is_root
from navsym.prove.wording import refute_at_point

#: Relation -> the signs of printed - derived that contradict it.
CONTRADICTED = {"<": (0, 1), "<=": (1,), ">": (0, -1), ">=": (-1,), "!=": (0,), "=": (1, -1)}
BITS = (128, 2048, 32768)
DENOMINATORS = (1, 10, 1000, 10**6, 10**12, 10**24, 10**48, 10**96)


def decide_by_roots(
    difference: sp.Expr, relation: str, box: Box, scope: str, sides: Sequence[sp.Expr] = ()
) -> Verdict | None:
    """Verdict of ``difference relation 0`` with one symbol, or None where exact roots do not decide it.

    sides : expressions that have to exist at a point of the statement
    """
    whole = sp.Tuple(difference, *sides)
    if len(whole.free_symbols) != 1 or whole.free_symbols != difference.free_symbols:
        return None
    ((symbol, limit),) = ranges_of(list(whole.free_symbols), box).items()
    try:
        divisors = tuple(d for d in dict.fromkeys(divisors_inside(whole)) if d.free_symbols)
        found = survey_signs(difference, limit, divisors)
        complete = found is not None
        found = survey_signs(difference, limit) if found is None else found
        if found is None:
            return None
        statement = RootStatement(symbol, box, limit, (difference, *sides), found, complete)
        return verdict_of(statement, CONTRADICTED[relation], scope)
    except UnsupportedError:
        return None


@dataclass(frozen=True, slots=True, eq=False)
class RootStatement:
    """What has to exist at a place of the statement, the difference first; ``complete`` with all its divisors."""

    symbol: sp.Symbol
    box: Box
    limit: Range
    sides: tuple[sp.Expr, ...]
    found: Survey
    complete: bool

    def assumptions(self) -> tuple[str, ...]:
        """Where the sides exist, as far as the range does not guarantee it."""
        return remaining_assumptions(self.sides, self.box)

    def exist_at(self, value: sp.Expr) -> bool:
        """True where all sides are shown to exist, at a value that is shown to lie in the range."""
        return self.limit.contains(value) and all(exists_at(side, {self.symbol: value}) for side in self.sides)

    def exist_at_zero(self, zero: Zero) -> bool | None:
        """Whether the sides exist at a zero; None where that is not known."""
        if self.limit.nonzero and zero.at == 0:
            return False
        if self.complete and zero.root is not None and any(is_root(top, zero.root) for top, _ in self.found.others):
            return False
        if zero.at is not None:
            return True if self.exist_at(zero.at) else None
        whole = sp.Tuple(*self.sides)
        plain = self.complete and not radicands_inside(whole) and not logarithms_inside(whole)
        if not plain or zero.root is None or any(is_root(bottom, zero.root) for _, bottom in self.found.others):
            return None
        return True


def verdict_of(statement: RootStatement, contradicted: tuple[int, ...], scope: str) -> Verdict | None:
    """REFUTED by a sign between two roots or by a zero, else PROVED; None where what breaks it may not exist."""
    found = statement.found
    broken = [v for sign, values in ((1, found.above), (-1, found.below)) if sign in contradicted for v in values]
    for value in broken:
        refuted = refute_near(statement, value, contradicted)
        if refuted is not None:
            return refuted
    if broken:
        return None
    if 0 in contradicted:
        known = [(zero, statement.exist_at_zero(zero)) for zero in found.zeros]
        for zero, there in known:
            if there:
                return refute_at_zero(statement, zero)
        if any(there is None for _, there in known):
            return None
    words = f"exact signs between {found.roots} real roots of numerator and denominator"
    return Verdict(PROVED, "real roots", scope, statement.assumptions(), words)


# -- what refutes ---------------------------------------


def refute_near(statement: RootStatement, value: sp.Expr, contradicted: tuple[int, ...]) -> Verdict | None:
    """REFUTED at a simple number near a value between two roots; None where the sides exist at none of those tried."""
    for number in numbers_near(value):
        ball = find_sign_ball(statement.sides[0], {statement.symbol: number})
        if ball is not None and int(ball > 0) - int(ball < 0) in contradicted and statement.exist_at(number):
            return refute_at_point({statement.symbol: number}, ball)
    return None


def numbers_near(value: sp.Expr) -> Iterator[sp.Expr]:
    """Rational numbers near a value, simple ones first, and the value itself."""
    middle = to_fraction(exact_ball(value, BITS[1]))
    shorter = (middle.limit_denominator(d) for d in DENOMINATORS)
    beside = (middle + sign * Fraction(1, 2**k) for k in (4, 16, 64, 256) for sign in (1, -1))
    numbers = [to_rational(n) for n in (*shorter, *beside)]
    yield from dict.fromkeys([value, *numbers] if value.is_Rational else [*numbers, value])


def find_sign_ball(difference: sp.Expr, point: Point) -> arb | None:
    """A ball of the difference that tells its sign; None where it has none, or none is found."""
    program = tape(difference)
    for bits in BITS:
        ball = value_at(program, point, bits)
        if ball.is_finite() and not ball.contains(0):
            return ball
    return None


def refute_at_zero(statement: RootStatement, zero: Zero) -> Verdict:
    """REFUTED where the sides are equal: at a formula, or at a root that has none."""
    if zero.at is not None:
        return refute_at_point({statement.symbol: zero.at}, arb(0), exact=True)
    assert zero.root is not None
    ends = " and ".join(str(to_rational(end)) for end in (zero.root.lower, zero.root.upper))
    words = f"the difference is exactly zero at a root that has no formula, of the polynomial {zero.root.factor}"
    words += f" between {ends}"
    return Verdict(REFUTED, "real roots", "one point", evidence=words, counterexample={}, difference=Number("0", "0"))
