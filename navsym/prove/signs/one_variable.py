"""Signs of rational functions of one symbol, and of absolute values of such, exactly: by their real roots.

Between two neighbouring roots of numerator and denominator a rational function keeps its sign, so that its exact
value at one rational number between them decides; at a root of the numerator it is zero. What is decided is
complete: where no sign is proved, there is a place at which it is another one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cmp_to_key, lru_cache
from itertools import pairwise
from typing import TypeAlias

import sympy as sp
from flint import fmpq, fmpq_poly

from navsym.core.balls import UnsupportedError
from navsym.core.errors import NavsymError
from navsym.core.exact import to_rational
from navsym.prove.identities import read_term
from navsym.prove.rooms.goals import player
from navsym.prove.sampling.points import Range
from navsym.prove.signs.real_roots import (
    RealNumber,
    UndecidedError,
    compare_numbers,
    enclose_number,
    find_real_roots,
    is_root,
    number_between,
)

#: Numerator and denominator.
Fraction: TypeAlias = tuple[fmpq_poly, fmpq_poly]

#: Absolute values in one expression; each doubles the cases.
MOST_VALUES = 4


@dataclass(frozen=True, slots=True, eq=False)
class Zero:
    """A zero: a root of the numerator, None within a stretch of zeros; ``at`` is its formula, if it has one."""

    root: RealNumber | None
    at: sp.Expr | None


@dataclass(frozen=True, slots=True, eq=False)
class Survey:
    """The signs of a function on its range.

    above, below : formulas of the symbol at which it is positive and negative, one for every interval between roots
    zeros        : where it is zero; of an interval on which it vanishes one place
    roots        : how many real roots of numerators and denominators were met
    others       : the other expressions as fractions
    """

    above: tuple[sp.Expr, ...] = ()
    below: tuple[sp.Expr, ...] = ()
    zeros: tuple[Zero, ...] = ()
    roots: int = 0
    others: tuple[Fraction, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Interval:
    """A range by its ends, None at infinity, and whether they belong to it."""

    lower: RealNumber | None
    upper: RealNumber | None
    closed: tuple[bool, bool]


@dataclass(frozen=True, slots=True, eq=False)
class Branch:
    """The function where ``sign * test >= 0`` for all tests: absolute values are taken there with these signs."""

    value: Fraction
    tests: tuple[tuple[int, Fraction], ...]

    def holds_at(self, u: fmpq) -> bool:
        """True where all tests have their signs."""
        return all(sign * sign_at_number(test, u) >= 0 for sign, test in self.tests)


def sign_at_number(fraction: Fraction, u: fmpq) -> int:
    """Exact sign of top/bottom at a rational number that is no root of the bottom."""
    value = fraction[0](u) * fraction[1](u)
    return int(value > 0) - int(value < 0)


def survey_signs(expression: sp.Expr, limit: Range, others: tuple[sp.Expr, ...] = ()) -> Survey | None:
    """All signs of an expression in one symbol on its range; None where they are not decided exactly."""
    if len(expression.free_symbols) != 1 or limit.integer:
        return None
    try:
        return remember_survey(expression, limit, others)
    except (UndecidedError, UnsupportedError):
        return None


@lru_cache(maxsize=512)
def remember_survey(expression: sp.Expr, limit: Range, others: tuple[sp.Expr, ...]) -> Survey | None:
    """The survey, kept: proofs by derivatives ask for the same ones again."""
    (symbol,) = expression.free_symbols
    if limit.lower is not None and limit.lower == limit.upper:
        return None
    cases = list(split_branches(expression, MOST_VALUES))
    parts = [part for case, tests in cases for part in (case, *(test for _, test in tests))]
    found = read_fractions([*parts, *others], symbol)
    if found is None:
        return None
    fractions = iter(found)
    branches = [Branch(next(fractions), tuple((sign, next(fractions)) for sign, _ in tests)) for _, tests in cases]
    return survey_range(branches, tuple(fractions), read_interval(limit))


def read_fractions(expressions: Sequence[sp.Expr], symbol: sp.Symbol) -> list[Fraction] | None:
    """Rational functions over Q of a symbol, in lowest terms; None where one is none."""
    if any(part.free_symbols - {symbol} for part in expressions):
        return None
    try:
        pairs = [player.to_fraction(read_term(part)) for part in expressions]
    except (NavsymError, player.Refused, OverflowError, ZeroDivisionError):
        return None
    if any(bottom == 0 for _, bottom in pairs):
        return None
    return [(top / top.gcd(bottom), bottom / top.gcd(bottom)) for top, bottom in pairs]


def read_interval(limit: Range) -> Interval:
    """A range by its ends as real numbers."""
    lower, upper = (None if end is None else enclose_number(end) for end in (limit.lower, limit.upper))
    low = lower is not None and not limit.open_lower and not (limit.nonzero and limit.lower == 0)
    return Interval(lower, upper, (low, upper is not None and not (limit.nonzero and limit.upper == 0)))


def split_branches(expression: sp.Expr, left: int) -> Iterator[tuple[sp.Expr, tuple[tuple[int, sp.Expr], ...]]]:
    """The expression for all signs of its absolute values, inner ones first, with what has these signs."""
    values = sorted((v for v in expression.atoms(sp.Abs) if not v.args[0].has(sp.Abs)), key=sp.default_sort_key)
    if not values:
        yield expression, ()
        return
    if left == 0:
        raise UndecidedError
    inside = values[0].args[0]
    for sign in (1, -1):
        for case, tests in split_branches(expression.xreplace({values[0]: sign * inside}), left - 1):
            yield case, ((sign, inside), *tests)


def survey_range(branches: list[Branch], others: tuple[Fraction, ...], piece: Interval) -> Survey:
    """Signs between the roots, and the zeros."""
    fractions = [f for branch in branches for f in (branch.value, *(test for _, test in branch.tests))]
    places = [root for root in find_real_roots([part for f in fractions for part in f]) if is_root_inside(root, piece)]
    inside = sorted(
        (root for root in places if not any(is_at_end(root, end) for end in (piece.lower, piece.upper))),
        key=cmp_to_key(compare_numbers),
    )
    cells = [number_between(left, right) for left, right in pairwise([piece.lower, *inside, piece.upper])]
    known = [branch_at(branches, u) for u in cells]
    signs: dict[int, list[sp.Expr]] = {1: [], 0: [], -1: []}
    for u, branch in zip(cells, known, strict=True):
        signs[sign_at_number(branch.value, u)].append(to_rational(u))
    # |f| is continuous: at a root the branch of the interval before it has the value, at the lower end that after it.
    before = {id(root): known[k] for k, root in enumerate(inside)}
    low = [root for root in places if id(root) not in before and is_at_end(root, piece.lower)]
    before |= {id(root): known[0] if root in low else known[-1] for root in places if id(root) not in before}
    zeros = [Zero(root, formula_of(root, piece)) for root in places if is_root(before[id(root)].value[0], root)]
    zeros += [Zero(None, value) for value in signs[0]]
    return Survey(tuple(signs[1]), tuple(signs[-1]), tuple(zeros), len(places), others)


def branch_at(branches: list[Branch], u: fmpq) -> Branch:
    """The branch that is valid around a number which is no root of a test."""
    for branch in branches:
        if branch.holds_at(u):
            return branch
    raise UndecidedError


def is_root_inside(root: RealNumber, piece: Interval) -> bool:
    """True for a root in the piece, its closed ends included."""
    low = 1 if piece.lower is None else compare_numbers(root, piece.lower)
    high = -1 if piece.upper is None else compare_numbers(root, piece.upper)
    return (low > 0 or (low == 0 and piece.closed[0])) and (high < 0 or (high == 0 and piece.closed[1]))


def is_at_end(root: RealNumber, end: RealNumber | None) -> bool:
    """True where a root is the end."""
    return end is not None and compare_numbers(root, end) == 0


def formula_of(root: RealNumber, piece: Interval) -> sp.Expr | None:
    """The root as a formula: its own, or that of the end where it lies."""
    return next((end.value for end in (piece.lower, piece.upper) if end and is_at_end(root, end)), root.value)
