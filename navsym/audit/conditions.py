"""Conditions of the source: decided by numbers, or two ways of a run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar

from navsym.audit.evaluate import CASES, Condition, Evaluator
from navsym.audit.form import Part
from navsym.audit.values import LIMITS, Cell, Scalar, Unread, Unreadable, constant_of, map_cell, require_fit
from navsym.language.tree import NUMBER, build_number


@dataclass(slots=True, eq=False)
class Decider(Evaluator):
    """Takes the ways of ``choices`` at undecided conditions, and then the first of both."""

    refuse: ClassVar[Any]

    def decide(self, test: Part) -> bool:
        """Whether a condition holds in this case; one that is not read has two ways, of which nothing is known."""
        try:
            return self.decide_known(test)
        except Unreadable as refusal:
            if self.choices is None or not self.is_bold:
                raise
            self.refuse(test, Unread(refusal.line or test.line, refusal.why))
            return self.choose(Condition(self.unit.text(test), test.line, True, f"?{len(self.conditions)}"))

    def decide_known(self, test: Part) -> bool:
        """Whether a condition holds that can be read."""
        if test.kind == "both":
            return self.decide(test.parts[0]) and self.decide(test.parts[1])
        if test.kind == "either":
            return self.decide(test.parts[0]) or self.decide(test.parts[1])
        if test.kind == "not":
            return not self.decide(test.parts[0])
        sign, left, right = "", None, None
        if test.kind == "compare":
            sign = test.parts[0]
            if is_finiteness(test):
                return True  # numbers are real numbers here
            a, b = self.value(test.parts[1]), self.value(test.parts[2])
            if not (isinstance(a, Scalar) and isinstance(b, Scalar)):
                raise Unreadable(test.line, "a condition on what is not read")
            require_fit(self.unit, map_cell(lambda x, _: x, a, b), test.line)  # -1 < 1U does not hold
            require_fit(self.unit, map_cell(lambda x, _: x, b, a), test.line)
            left, right = a.tree, b.tree
            if left.head == right.head == NUMBER:
                return COMPARE[sign](left.args[0], right.args[0])
        elif test.kind not in ("refused", "list"):
            value = self.value(test)
            exact = constant_of(value)
            if exact is not None:
                return exact != 0
            if not isinstance(value, Scalar):
                raise Unreadable(test.line, "a condition on what is not read")
            sign, left, right = "!=", value.tree, build_number(0)
        else:
            raise Unreadable(test.line, "a condition outside the language of audit")
        return self.choose(Condition(self.unit.text(test), test.line, True, sign, left, right))

    def choose(self, condition: Condition) -> bool:
        """The way of this run at an undecided condition."""
        for known in self.conditions:
            if (known.sign, known.left, known.right) == (condition.sign, condition.left, condition.right):
                return known.holds
        if self.choices is None:
            raise Unreadable(condition.line, f"one of more than {CASES} cases")
        place = len(self.conditions)
        holds = self.choices[place] if place < len(self.choices) else True
        if place >= len(self.choices):
            self.other_ways.append([*(known.holds for known in self.conditions), False])
        self.conditions.append(
            Condition(condition.text, condition.line, holds, condition.sign, condition.left, condition.right)
        )
        return holds


def is_finiteness(test: Part) -> bool:
    """True for ``fabs(x) <= DBL_MAX``."""
    sign, left, right = test.parts
    is_bound = right.kind == "name" and right.parts[0] in ("DBL_MAX", "FLT_MAX")
    return sign == "<=" and is_bound and left.kind == "call" and left.parts[0] in ("fabs", "fabsf")


def is_integer(cell: Cell) -> bool:
    """True for a cell that holds an integer of the source."""
    return isinstance(cell, Scalar) and cell.number in LIMITS


COMPARE: Mapping[str, Callable[[Fraction, Fraction], bool]] = {
    "<": lambda a, b: a < b,
    "<=": lambda a, b: a <= b,
    ">": lambda a, b: a > b,
    ">=": lambda a, b: a >= b,
    "==": lambda a, b: a == b,
    "!=": lambda a, b: a != b,
}
