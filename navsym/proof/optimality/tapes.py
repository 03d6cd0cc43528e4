"""Several expressions as one tape: shared parts once, constants once for each precision, run over balls and series."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from operator import add, methodcaller, mul
from typing import Any

import numpy as np
import sympy as sp
from flint import ctx

from navsym.proof.balls import OPERATIONS, Step, instruction


@dataclass(frozen=True, slots=True, eq=False)
class Program:
    """Several expressions flattened into one tape, shared parts once; ``outputs`` are their places."""

    steps: tuple[Step, ...]
    outputs: tuple[int, ...]

    def run(self, values: Mapping[sp.Symbol, Any]) -> list[Any]:
        fixed, symbols, moving = prepared(self, ctx.prec)
        done = list(fixed)
        for place, symbol in symbols:
            done[place] = values[symbol]
        for place, operation, first, second in moving:
            if second is None:
                done[place] = operation(done[first])
            elif second >= 0:
                done[place] = operation(done[first], done[second])
            else:
                done[place] = operation([done[i] for i in first])
        return [done[i] for i in self.outputs]

    def numbers(self, values: Mapping[sp.Symbol, Any]) -> list[Any]:
        """The same in double precision, over numpy arrays: a hint, never a bound."""
        done: list[Any] = []
        for step in self.steps:
            arguments = [done[i] for i in step.arguments]
            done.append(FLOATS[step.operation](step.constant, arguments, values))
        return [done[i] for i in self.outputs]


#: Where it goes, what is done, and the arguments: one (None), two, or a tuple of them (-1).
Moving = tuple[int, Callable[..., Any], Any, int | None]
#: Operations that are one call of an object or of two: what OPERATIONS does, without its lists.
UNARY = {name: methodcaller(name) for name in ("sin", "cos", "exp")}
TWO: dict[str, Callable[[Any, Any], Any]] = {"add": add, "mul": mul}


@lru_cache(maxsize=256)
def prepared(tape: Program, bits: int) -> tuple[list[Any], list[tuple[int, sp.Symbol]], list[Moving]]:
    """The steps without a symbol, done at a precision, those that are symbols, and the others."""
    done: list[Any] = []
    symbols: list[tuple[int, sp.Symbol]] = []
    moving: list[Moving] = []
    for place, step in enumerate(tape.steps):
        if step.operation == "symbol":
            symbols.append((place, step.constant))
        elif any(done[i] is None for i in step.arguments):
            moving.append((place, *called(step)))
        else:
            done.append(OPERATIONS[step.operation](step.constant, [done[i] for i in step.arguments], {}))
            continue
        done.append(None)
    return done, symbols, moving


def called(step: Step) -> tuple[Callable[..., Any], Any, int | None]:
    """How a step is called."""
    if step.operation in UNARY:
        return UNARY[step.operation], step.arguments[0], None
    if step.operation in TWO and len(step.arguments) == 2:
        return TWO[step.operation], *step.arguments
    operation = OPERATIONS[step.operation]
    return (lambda arguments: operation(step.constant, arguments, {})), step.arguments, -1


def program(expressions: Sequence[sp.Expr]) -> Program:
    """Flatten expressions; raises :class:`~navsym.proof.balls.UnsupportedError` outside the language."""
    steps: list[Step] = []
    place: dict[sp.Basic, int] = {}

    def visit(node: sp.Basic) -> int:
        if node not in place:
            operation, arguments, constant = instruction(node)
            steps.append(Step(operation, tuple(visit(a) for a in arguments), constant))
            place[node] = len(steps) - 1
        return place[node]

    outputs = tuple(visit(sp.sympify(e, strict=True)) for e in expressions)
    return Program(tuple(steps), outputs)


FLOATS: dict[str, Any] = {
    "number": lambda c, a, v: float(int(c.p)) / float(int(c.q)),
    "pi": lambda c, a, v: np.pi,
    "e": lambda c, a, v: np.e,
    "symbol": lambda c, a, v: v[c],
    "add": lambda c, a, v: sum(a[1:], a[0]),
    "mul": lambda c, a, v: np.prod(a, axis=0) if all(np.ndim(x) == 0 for x in a) else product(a),
    "power": lambda c, a, v: a[0] ** c if c >= 0 else 1.0 / a[0] ** (-c),
    "root": lambda c, a, v: a[0] ** (c[0] / c[1]),
    "general_power": lambda c, a, v: a[0] ** a[1],
    "tan": lambda c, a, v: np.tan(a[0]),
    "cot": lambda c, a, v: 1.0 / np.tan(a[0]),
    "sec": lambda c, a, v: 1.0 / np.cos(a[0]),
    "csc": lambda c, a, v: 1.0 / np.sin(a[0]),
    "asin": lambda c, a, v: np.arcsin(a[0]),
    "acos": lambda c, a, v: np.arccos(a[0]),
    "atan": lambda c, a, v: np.arctan(a[0]),
    "atan2": lambda c, a, v: np.arctan2(a[0], a[1]),
    "max": lambda c, a, v: np.maximum.reduce(a),
    "min": lambda c, a, v: np.minimum.reduce(a),
} | {
    name: (lambda f: lambda c, a, v: f(a[0]))(getattr(np, name))
    for name in ("sin", "cos", "exp", "log", "abs", "sign", "sinh", "cosh", "tanh")
}


def product(factors: Sequence[Any]) -> Any:
    value = factors[0]
    for factor in factors[1:]:
        value = value * factor
    return value
