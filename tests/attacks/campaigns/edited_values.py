"""Values of a formula and of all its one-token mutants at exact points, without building the mutants.

The value of every node of the tree is computed once; a changed token is then carried up its own path
to the root. What comes out is a ball around the literal value of the mutant, so that a ball which
excludes the derived value refutes it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import sympy as sp
from flint import arb

from navsym.core.balls import OPERATIONS, exact_ball, precision, read_instruction
from navsym.prove.sampling.points import Point
from tests.attacks.campaigns.edits import Edit

BITS = 128


@dataclass(slots=True, eq=False)
class Values:
    """Balls of all nodes met so far at one exact point."""

    point: Mapping[sp.Symbol, arb]
    known: dict[sp.Basic, arb] = field(default_factory=dict)

    def of(self, node: sp.Basic, bits: int = BITS) -> arb:
        """Ball of an expression; raises UnsupportedError outside the language of balls."""
        with precision(bits):
            return self.value(node)

    def value(self, node: sp.Basic) -> arb:
        if node not in self.known:
            operation, arguments, constant = read_instruction(node)
            balls = [self.value(argument) for argument in arguments]
            self.known[node] = arb(OPERATIONS[operation](constant, balls, self.point))
        return self.known[node]

    def evaluate_edited(self, root: sp.Basic, edit: Edit, bits: int = BITS) -> arb:
        """Ball of the formula ``root`` with one token changed."""
        above = ancestors(root, edit.path)
        replacement: sp.Basic = edit.replacement
        if above and isinstance(above[-1][0], sp.Pow) and replacement.is_Rational and above[-1][1] == 1:
            power, _ = above.pop()  # a rational exponent is part of the instruction, not an argument
            replacement = sp.Pow(power.args[0], replacement)
        with precision(bits):
            return self.carry_up(above, Values(self.point, Overlay(self.known)).value(replacement))

    def carry_up(self, above: Sequence[tuple[sp.Basic, int]], ball: arb) -> arb:
        """The value at the root when the argument at the end of the path has this value."""
        for node, place in reversed(above):
            operation, arguments, constant = read_instruction(node)
            balls = [self.value(argument) for argument in arguments]
            balls[place] = ball
            ball = arb(OPERATIONS[operation](constant, balls, self.point))
        return ball


def ancestors(root: sp.Basic, path: Sequence[int]) -> list[tuple[sp.Basic, int]]:
    """The nodes above the end of a path, from the root, each with the place of the next one."""
    found = []
    for place in path:
        found.append((root, place))
        root = root.args[place]
    return found


class Overlay(dict[sp.Basic, arb]):
    """A dictionary that reads through to another one and never writes to it."""

    def __init__(self, below: dict[sp.Basic, arb]):
        super().__init__()
        self.below = below

    def __contains__(self, key: object) -> bool:
        return super().__contains__(key) or key in self.below

    def __missing__(self, key: sp.Basic) -> arb:
        return self.below[key]


def values_at(point: Point, bits: int = BITS) -> Values:
    """An empty table of values at an exact point."""
    return Values({symbol: exact_ball(value, bits) for symbol, value in point.items()})
