"""Where a tree is defined: what every part asks of its own parts, as written; and trees in balls."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import Any, NamedTuple

from navsym.core.balls import Instruction, Tape, enclose
from navsym.core.exact import to_fmpq
from navsym.language.arithmetic import BITS
from navsym.language.tree import (
    NUMBER,
    ONE,
    POWER,
    PRODUCT,
    SUM,
    SYMBOL,
    TWO,
    Tree,
    build_call,
    build_power,
    build_sum,
    list_names,
    list_parts,
    negate,
    parts_of,
)

#: The functions with poles, and what their sides are divided by.
POLES = {"tan": "cos", "sec": "cos", "cot": "sin", "csc": "sin"}

EXPONENT_BITS = 64  # to see the sign of an exponent such as 1 - pi


class Condition(NamedTuple):
    """What must hold of a part for the whole to have a real value; relation is ``!= 0``, ``>= 0`` or ``> 0``."""

    part: Tree
    relation: str


def list_conditions(*trees: Tree) -> list[Condition]:
    """What every part asks, each condition once, in the order of writing; constants are listed, too.

    Divisors, cosines under tan and sec, sines under cot and csc, ``y**2 + x**2`` of atan2 and bases of the power 0 are
    not zero; radicands and ``1 - u**2`` of asin and acos are not negative; arguments of log and bases of symbolic
    powers are positive. A positive number that is written as such asks nothing.

    >>> from navsym.language.expression import read_tree
    >>> list_conditions(read_tree("sqrt(x)/(x*y) + x**0", {"x", "y"}))
    [Condition(part=<x>, relation='>= 0'), Condition(part=<x*y>, relation='!= 0'), Condition(part=<x>, relation='!= 0')]
    """
    found = [condition for part in list_parts(*trees) for condition in conditions_of(part)]
    return [c for c in dict.fromkeys(found) if c.part.head != NUMBER or c.part.args[0] <= 0]


def conditions_of(part: Tree) -> list[Condition]:
    """What one part asks of its own parts."""
    if part.head == POWER:
        base, exponent = part.args
        return [Condition(base, relation) for relation in relations_of_exponent(exponent)]
    if part.head == "sqrt":
        return [Condition(part.args[0], ">= 0")]
    if part.head == "log":
        return [Condition(part.args[0], "> 0")]
    if part.head in ("asin", "acos"):
        return [Condition(build_sum(ONE, negate(build_power(part.args[0], TWO))), ">= 0")]
    if part.head in POLES:
        return [Condition(build_call(POLES[part.head], *part.args), "!= 0")]
    if part.head == "atan2":
        return [Condition(build_sum(*(build_power(side, TWO) for side in part.args)), "!= 0")]
    return []


def relations_of_exponent(exponent: Tree) -> tuple[str, ...]:
    """What a base must be under an exponent: positive when the exponent has symbols."""
    value = rational_value(exponent)
    if value is not None:
        return ("!= 0",) * (value <= 0) + (">= 0",) * (value.denominator != 1)
    if list_names(exponent):
        return ("> 0",)
    return (">= 0",) if enclose_tree(exponent, {}, EXPONENT_BITS) > 0 else ("!= 0", ">= 0")


def rational_value(tree: Tree) -> Fraction | None:
    """The value of sums, products and whole powers of numbers; None for anything else and where there is none.

    >>> from navsym.language.expression import read_tree
    >>> rational_value(read_tree("1/(2 + 1) - 2**3")), rational_value(read_tree("1/(2 - 2)"))
    (Fraction(-23, 3), None)
    """
    values: dict[Tree, Fraction] = {}
    for part in list_parts(tree):
        value = rational_step(part, [values[argument] for argument in parts_of(part)])
        if value is None or max(value.numerator.bit_length(), value.denominator.bit_length()) > BITS:
            return None
        values[part] = value
    return values[tree]


def rational_step(part: Tree, inner: list[Fraction]) -> Fraction | None:
    """The value of a part from those of its own parts, when it has one of bounded size."""
    if part.head == NUMBER:
        number: Fraction = part.args[0]
        return number
    if part.head == SUM:
        return sum(inner, Fraction(0))
    if part.head == PRODUCT:
        return math.prod(inner, start=Fraction(1))
    if part.head != POWER or inner[1].denominator != 1 or (inner[0] == 0 and inner[1] <= 0):
        return None
    base, exponent = inner[0], inner[1].numerator
    size = max(base.numerator.bit_length(), base.denominator.bit_length()) - 1
    return base**exponent if size * abs(exponent) <= BITS and abs(exponent) <= BITS else None


# -- in balls ---------------------------------------------------------------------------


def flatten(tree: Tree) -> Tape:
    """The tree as a list of instructions for balls and series, each distinct part once."""
    parts = list_parts(tree)
    place = {part: at for at, part in enumerate(parts)}
    steps = []
    for part in parts:
        operation, arguments, constant = instruction_of(part)
        steps.append(Instruction(operation, tuple(place[argument] for argument in arguments), constant))
    return Tape(tree, tuple(steps))


def instruction_of(part: Tree) -> tuple[str, tuple[Tree, ...], Any]:
    """Operation, arguments and constant of one part."""
    if part.head == NUMBER:
        return "number", (), to_fmpq(part.args[0])
    if part.head == SYMBOL:
        return "symbol", (), part.args[0]
    if part.head in (SUM, PRODUCT):
        return ("add" if part.head == SUM else "mul"), part.args, None
    value = part.args[1].args[0] if part.head == POWER and part.args[1].head == NUMBER else None
    value = Fraction(1, 2) if part.head == "sqrt" else value
    if value is None:
        return "general_power" if part.head == POWER else part.head, part.args, None
    if value.denominator == 1:
        return "power", part.args[:1], value.numerator
    return "root", part.args[:1], (value.numerator, value.denominator)


def enclose_tree(tree: Tree, values: Mapping[str, Any], bits: int) -> Any:
    """A ball that contains the tree for all values of its symbols, name -> ball; not finite where it may be undefined.

    >>> from navsym.language.expression import read_tree
    >>> enclose_tree(read_tree("1/(pi - pi)"), {}, 64).is_finite(), enclose_tree(read_tree("2*pi"), {}, 64) > 6
    (False, True)
    """
    return enclose(flatten(tree), values, bits)
