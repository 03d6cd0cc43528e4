"""Rigorous enclosures of expressions: ball arithmetic over points, boxes and Taylor series.

An expression is flattened once into a tape (shared subexpressions once), and the tape is run
over balls (`enclose`) or over truncated power series of balls (`derivatives`). Whatever is
undefined somewhere on the box — a root of something that may be negative, a division by
something that may vanish — comes back as a ball that is not finite, and so decides nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import reduce
from operator import add, methodcaller, mul
from typing import Any

import sympy as sp
from flint import arb, arb_series, ctx

from navsym.core.errors import NavsymError
from navsym.core.exact import raise_by_squaring, to_fmpq

DEFAULT_BITS = 96

#: Roots from here on are taken by logarithms: flint counts them with a machine word.
MOST_ROOT = 2**31


class UnsupportedError(NavsymError):
    """An expression outside the language that balls can enclose."""

    kind = "unsupported"


@contextmanager
def precision(bits: int) -> Iterator[None]:
    """Run with a working precision of ``bits``; flint's precision is global, so it is put back."""
    before = ctx.prec
    ctx.prec = bits
    try:
        yield
    finally:
        ctx.prec = before


@contextmanager
def series_terms(count: int) -> Iterator[None]:
    """Series of ``count`` terms; flint's cap is global, so it is put back."""
    before = ctx.cap
    ctx.cap = count
    try:
        yield
    finally:
        ctx.cap = before


@dataclass(frozen=True, slots=True)
class Instruction:
    """One instruction: an operation, the places of its arguments and a constant."""

    operation: str
    arguments: tuple[int, ...] = ()
    constant: Any = None


@dataclass(frozen=True, slots=True, eq=False)
class Tape:
    """A flattened expression; the last step is its value."""

    expression: sp.Expr
    steps: tuple[Instruction, ...]

    def run(self, values: Mapping[sp.Symbol, Any]) -> Any:
        """Value of the expression; ``values`` are balls or power series of balls."""
        done: list[Any] = []
        for step in self.steps:
            done.append(OPERATIONS[step.operation](step.constant, [done[i] for i in step.arguments], values))
        return done[-1]


def tape(expression: sp.Expr) -> Tape:
    """Flatten an expression of the language; raises :class:`UnsupportedError` outside it."""
    return Tape(expression, flatten([expression])[0])


def flatten(expressions: Sequence[sp.Expr]) -> tuple[tuple[Instruction, ...], tuple[int, ...]]:
    """The steps of some expressions, shared parts once, and the places of their values."""
    steps: list[Instruction] = []
    place: dict[sp.Basic, int] = {}

    def visit(node: sp.Basic) -> int:
        if node not in place:
            operation, arguments, constant = read_instruction(node)
            steps.append(Instruction(operation, tuple(map(visit, arguments)), constant))
            place[node] = len(steps) - 1
        return place[node]

    outputs = tuple(visit(sp.sympify(e, strict=True)) for e in expressions)  # strict: objects of ours, never strings
    return tuple(steps), outputs


SAME_NAME = "sin cos tan cot sec csc exp log asin acos atan atan2 sinh cosh tanh sign".split()
FUNCTIONS = {getattr(sp, name): name for name in SAME_NAME} | {sp.Abs: "abs", sp.Max: "max", sp.Min: "min"}


def read_instruction(node: sp.Basic) -> tuple[str, Sequence[sp.Basic], Any]:
    """Operation, arguments and constant of one node of a sympy tree."""
    if isinstance(node, sp.Rational):
        return "number", (), to_fmpq(node)
    if node is sp.pi:
        return "pi", (), None
    if node is sp.E:
        return "e", (), None
    if isinstance(node, sp.Symbol):
        return "symbol", (), node
    if isinstance(node, sp.Add):
        return "add", node.args, None
    if isinstance(node, sp.Mul):
        return "mul", node.args, None
    if isinstance(node, sp.Pow):
        return power_instruction(node)
    if node.func in FUNCTIONS:
        return FUNCTIONS[node.func], node.args, None
    if hasattr(node, "on_balls"):  # a function that knows its own enclosure
        return "own", node.args, node.on_balls
    raise UnsupportedError(f"expected an expression of the language; got {node.func.__name__}; rewrite it")


def power_instruction(node: sp.Pow) -> tuple[str, Sequence[sp.Basic], Any]:
    if node.base is sp.E:
        return "exp", (node.exp,), None
    if isinstance(node.exp, sp.Integer):
        return "power", (node.base,), int(node.exp)
    if isinstance(node.exp, sp.Rational):
        return "root", (node.base,), (int(node.exp.p), int(node.exp.q))
    return "general_power", (node.base, node.exp), None


# -- the operations, for balls and for power series of balls alike ---------------------------------------


def constant_term(x: Any) -> arb:
    """The first coefficient of a series; a ball itself."""
    return x[0] if isinstance(x, arb_series) else x


def undefined_like(like: Any) -> Any:
    """NaN in every coefficient: a NaN constant term alone would leave finite derivatives behind it."""
    return arb_series([arb("nan")] * ctx.cap) if isinstance(like, arb_series) else arb("nan")


def multiply_all(factors: Sequence[Any]) -> Any:
    """The product of one factor or more, of any kind of number."""
    return reduce(mul, factors)


def integer_power(x: Any, n: int) -> Any:
    """x**n by squaring: a series power with a zero inside its constant term would give NaN."""
    if n < 0:
        return reciprocal(integer_power(x, -n))
    if isinstance(x, arb):
        return ball_power(x, n)
    return raise_by_squaring(x, n, mul) if n else arb_series([arb(1)])


def reciprocal(x: Any) -> Any:
    if constant_term(x).contains(0):
        return undefined_like(x)
    return 1 / x


def ball_power(x: arb, n: int) -> arb:
    """x**n of a ball, n >= 0; flint's own is NaN where the midpoint is exactly zero, and below zero around it."""
    around_zero = n > 0 and x.mid() == 0 and x.is_finite() and not x.is_exact()
    power = arb(0, x.rad() ** n) if around_zero else x**n
    return cut_below_zero(power) if n % 2 == 0 else power


def cut_below_zero(x: arb) -> arb:
    """The part of a ball that is not below zero, for what cannot be negative."""
    return x.nonnegative_part() if x.is_finite() and not x >= 0 else x


def rational_power(x: Any, p: int, q: int) -> Any:
    """x**(p/q) for x >= 0, the real branch; undefined when x may be negative."""
    head = constant_term(x)
    if isinstance(x, arb) and q < MOST_ROOT:
        if not head >= 0:
            return undefined_like(x)
        root = x.sqrt() if q == 2 else x.root(q)
        return integer_power(root, p)
    if not head > 0:
        return undefined_like(x)
    if q == 2:
        return integer_power(x.sqrt(), p)
    return (x.log() * (arb(p) / q)).exp()


def general_power(base: Any, exponent: Any) -> Any:
    """``exp(exponent log base)`` for a base > 0; undefined for others."""
    return (base.log() * exponent).exp() if constant_term(base) > 0 else undefined_like(base)


def absolute_value(x: Any) -> Any:
    if isinstance(x, arb):
        return cut_below_zero(abs(x))
    head = constant_term(x)
    if head > 0:
        return x
    return -x if head < 0 else undefined_like(x)


def sign_function(x: Any) -> Any:
    head = constant_term(x)
    if head > 0:
        return arb(1)
    if head < 0:
        return arb(-1)
    if head == 0:
        return arb(0)
    return arb(0, 1) if head.is_finite() and isinstance(x, arb) else undefined_like(x)


def is_within_unit(x: Any) -> bool:
    head = constant_term(x)
    if isinstance(x, arb_series):
        return bool(head > -1) and bool(head < 1)
    return bool(head >= -1) and bool(head <= 1)


def two_argument_arctangent(y: Any, x: Any) -> Any:
    if isinstance(y, arb) and isinstance(x, arb):
        return undefined_like(y) if y.contains(0) and x.contains(0) else arb.atan2(y, x)
    head = constant_term(x)
    return (y * reciprocal(x)).atan() if head > 0 else undefined_like(y if isinstance(y, arb_series) else x)


def hyperbolic(name: str) -> Callable[[Any], Any]:
    def value(x: Any) -> Any:
        if isinstance(x, arb):
            return getattr(x, name)()
        up, down = x.exp(), (-x).exp()
        if name == "sinh":
            return (up - down) / 2
        if name == "cosh":
            return (up + down) / 2
        return (up - down) * reciprocal(up + down)

    return value


def extreme_of(name: str, arguments: Sequence[Any]) -> Any:
    if not all(isinstance(argument, arb) for argument in arguments):
        return undefined_like(next(a for a in arguments if isinstance(a, arb_series)))
    return reduce(lambda x, y: getattr(x, name)(y), arguments)


def unary(function: Callable[[Any], Any]) -> Callable[[Any, list[Any], Any], Any]:
    return lambda constant, arguments, values: function(arguments[0])


OPERATIONS: dict[str, Callable[[Any, list[Any], Any], Any]] = {
    "number": lambda constant, arguments, values: arb(constant),
    "pi": lambda constant, arguments, values: arb.pi(),
    "e": lambda constant, arguments, values: arb(1).exp(),
    "symbol": lambda constant, arguments, values: values[constant],
    "add": lambda constant, arguments, values: reduce(add, arguments),
    "mul": lambda constant, arguments, values: multiply_all(arguments),
    "power": lambda constant, arguments, values: integer_power(arguments[0], constant),
    "root": lambda constant, arguments, values: rational_power(arguments[0], *constant),
    "general_power": lambda constant, arguments, values: general_power(*arguments),
    "tan": unary(lambda x: x.sin() * reciprocal(x.cos())),
    "cot": unary(lambda x: x.cos() * reciprocal(x.sin())),
    "sec": unary(lambda x: reciprocal(x.cos())),
    "csc": unary(lambda x: reciprocal(x.sin())),
    "log": unary(lambda x: x.log() if constant_term(x) > 0 else undefined_like(x)),
    "abs": unary(absolute_value),
    "sign": unary(sign_function),
    "asin": unary(lambda x: x.asin() if is_within_unit(x) else undefined_like(x)),
    "acos": unary(lambda x: x.acos() if is_within_unit(x) else undefined_like(x)),
    "atan2": lambda constant, arguments, values: two_argument_arctangent(*arguments),
    "max": lambda constant, arguments, values: extreme_of("max", arguments),
    "min": lambda constant, arguments, values: extreme_of("min", arguments),
    "own": lambda constant, arguments, values: constant(*arguments),
}
OPERATIONS |= {name: unary(methodcaller(name)) for name in ("sin", "cos", "exp", "atan")}
OPERATIONS |= {name: unary(hyperbolic(name)) for name in ("sinh", "cosh", "tanh")}


# -- what the other rooms call ---------------------------------------


def enclose(expression: sp.Expr | Tape, values: Mapping[sp.Symbol, arb] | None = None, bits: int = DEFAULT_BITS) -> arb:
    """A ball that contains the expression for every value of the symbols in the given balls.

    Not finite when the expression may be undefined there.
    """
    program = expression if isinstance(expression, Tape) else tape(expression)
    with precision(bits):
        return arb(program.run(values or {}))


def exact_ball(value: Any, bits: int = DEFAULT_BITS) -> arb:
    """A ball around an exact number: a Python or sympy number, or a constant expression."""
    if isinstance(value, sp.Rational):
        with precision(bits):
            return arb(to_fmpq(value))
    return enclose(sp.sympify(value, strict=True), {}, bits)


def hull(lower: Any, upper: Any, bits: int = DEFAULT_BITS) -> arb:
    """The ball that contains the interval between two exact numbers; None is an end at infinity."""
    with precision(bits):
        if lower is None or upper is None:
            return arb(0, "inf")  # a half line has no tighter ball than the whole line
        return exact_ball(lower, bits).union(exact_ball(upper, bits))
