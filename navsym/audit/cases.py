"""The cases of a function: every way through it with its conditions, and which conditions exclude each other."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from flint import fmpq

from navsym.audit.form import Function, Unit, head_of
from navsym.audit.values import COMPARE, LIMITS, Index, Value, Variable
from navsym.core.errors import DomainError, TooLargeError
from navsym.language.polynomials import to_polynomial
from navsym.language.tree import NUMBER, Tree, build_sum, list_names, list_parts, negate

CASES = 32
SHARING = ("c", "cpp", "python")  # where two names may be of one array or number
LONGEST = 200  # parts of a condition that is brought into one form
NEGATED = {"<": ">=", ">=": "<", ">": "<=", "<=": ">", "==": "!=", "!=": "=="}
TURNED = {"<": ">", ">": "<", "<=": ">=", ">=": "<="}


@dataclass(frozen=True, slots=True)
class Condition:
    """A comparison of the source, and whether it holds in this case; without sides it is one that is not read."""

    text: str
    line: int
    holds: bool
    sign: str = ""
    left: Tree | None = None
    right: Tree | None = None


@dataclass(slots=True, eq=False)
class Order:
    """Which parameters and members are written before others are read or written: these must not be the same.

    copies  : parameters that nobody else knows
    given   : those that the caller may know by other names
    written : names that have been written, and whether they hold integers
    """

    copies: frozenset[str] = frozenset()
    given: frozenset[str] = frozenset()
    written: dict[str, bool] = field(default_factory=dict)

    def note(self, variable: Variable, language: str, apart: set[frozenset[str]], *, is_write: bool = False) -> None:
        """One more cell that is read or written; a name in capitals is a constant by custom."""
        own, is_whole = head_of(variable.name), variable.number in LIMITS
        is_number = language == "python" and not variable.shape
        if own in self.copies or is_number or language not in SHARING or (own.isupper() and own not in self.given):
            return
        for other, kind in self.written.items():
            if other != own and kind == is_whole and {own, other} & self.given:
                apart.add(frozenset((own, other)))
        if is_write:
            self.written[own] = is_whole


@dataclass(slots=True, eq=False)
class Case:
    """One way through a function.

    variables : what its names hold at the end
    returned  : its value, if it has one
    has_failed : True where it ends in an error, so that it computes nothing
    """

    conditions: tuple[Condition, ...]
    variables: dict[str, Variable]
    returned: Value | None
    has_failed: bool = False


@dataclass(slots=True, eq=False)
class Reading:
    """A function that has been read.

    cases     : every way through it
    refused   : line -> reason
    met       : the statements that were met, by their spans
    valueless : assignments that are read and depend on what is not, with its reason
    ways      : whether conditions that are not read, and maxima, have two ways
    steps     : of its longest case
    written   : formula, variable and place of everything that is assigned -> its line
    functions : all that were entered
    kept      : functions of classes of other files, in whose place none of a derived class is taken to stand
    scalars   : inputs of Python and MATLAB whose sizes nothing says
    apart     : names of which one is written before the other is read or written
    """

    unit: Unit
    function: Function
    cases: list[Case] = field(default_factory=list)
    refused: dict[int, str] = field(default_factory=dict)
    met: set[tuple[int, int]] = field(default_factory=set)
    refused_spans: set[tuple[int, int]] = field(default_factory=set)
    valueless: dict[tuple[int, int], str] = field(default_factory=dict)
    ways: tuple[bool, bool] = (True, True)
    steps: int = 0
    written: dict[tuple[Tree, str, Index], int] = field(default_factory=dict)
    functions: set[Function] = field(default_factory=set)
    kept: set[str] = field(default_factory=set)
    scalars: set[str] = field(default_factory=set)
    apart: set[frozenset[str]] = field(default_factory=set)


def list_cases(start: Any, reading: Reading, function: Function, is_bold: bool, is_split: bool) -> list[Case]:
    """The cases of a function; none where there are more than 32."""
    cases: list[Case] = []
    waiting: list[list[bool]] = [[]]
    for table in (reading.met, reading.refused, reading.refused_spans, reading.valueless, reading.written):
        table.clear()  # type: ignore[attr-defined]
    while waiting:
        machine = start(waiting.pop(), is_bold, is_split)
        cases.append(machine.run(function))
        reading.steps = max(reading.steps, machine.steps)
        if len(cases) + len(waiting) > CASES:
            return []
        waiting += machine.other_ways
    return cases


def is_contradictory(conditions: Iterable[Condition]) -> bool:
    """True for conditions on one formula that no number meets together, such as a > 3 and a < -3."""
    known: dict[Any, list[tuple[str, Any]]] = {(): [("==", fmpq(0))]}
    for condition in conditions:
        if condition.left is None or condition.right is None:
            continue  # what is not read may be two things
        key, number, is_turned = bring_together(condition.left, condition.right)
        sign = condition.sign if condition.holds else NEGATED[condition.sign]
        known.setdefault(key, []).append((TURNED.get(sign, sign) if is_turned else sign, number))
    return any(not is_met(several) for several in known.values())


def is_met(several: list[tuple[str, Any]]) -> bool:
    """True where some number meets all comparisons with numbers: one of these, or one beside or between them."""
    ends = sorted({number for _, number in several})
    between = [(a + b) / 2 for a, b in itertools.pairwise(ends)]
    tried = [*ends, *between, ends[0] - 1, ends[-1] + 1]
    return any(all(COMPARE[sign](x, number) for sign, number in several) for x in tried)


@functools.lru_cache(4096)
def bring_together(left: Tree, right: Tree) -> tuple[Any, Any, bool]:
    """Two sides as a formula without a constant term, the number with which it is compared, and whether < is > now."""
    try:
        if len([*list_parts(left, right)]) > LONGEST:
            raise TooLargeError("expected a short condition; got a long one; shorten it")
        names = sorted(list_names(left, right))
        terms = to_polynomial(build_sum(left, negate(right)), names).to_dict()
    except (DomainError, TooLargeError):
        for one, other, is_turned in ((left, right, False), (right, left, True)):
            if other.head == NUMBER:
                return one, fmpq(other.args[0].numerator, other.args[0].denominator), is_turned
        return (left, right), fmpq(0), False
    constant = terms.pop((0,) * len(names), fmpq(0))
    if not terms:
        return (), -constant, False  # zero is compared
    scale = terms[max(terms)]
    by_name = (({n: k for n, k in zip(names, powers, strict=True) if k}, c / scale) for powers, c in terms.items())
    return frozenset((frozenset(powers.items()), c) for powers, c in by_name), -constant / scale, scale < 0
