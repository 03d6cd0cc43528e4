"""Derived rounding bounds: how far the computed value of a graph may lie from its exact value.

Every operation is ``computed = exact (1 + d) + h`` with ``|d| <= k u`` and ``|h| <= eta`` (underflow):
k = 1 for ``+ - * / sqrt`` (IEEE 754, round to nearest; a fused multiply-add rounds less often), and
twice the stated number of ulps for library functions. The errors of the arguments are carried through
the graph in balls, as an absolute and as a relative bound side by side, each tightened by the other:
relative bounds survive singularities, absolute ones survive zeros.

Higham, Accuracy and Stability of Numerical Algorithms, chapters 2 and 3.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp
from flint import arb

from navsym.core.balls import enclose, precision
from navsym.core.errors import DomainError
from navsym.export.expression_graph import Graph, Node

BITS = 128


@dataclass(frozen=True, slots=True)
class Arithmetic:
    """A floating-point type and its library.

    u       : unit roundoff as a power of two
    eta     : half the smallest subnormal, as a power of two
    top     : every number below this power of two is finite
    library : accuracy of sin, cos, exp, log, expm1, pow in ulps; the other functions have twice this
    """

    name: str
    u: int
    eta: int
    top: int
    library: int = 1

    def unit(self) -> arb:
        """The unit roundoff 2^u as a ball."""
        return arb(2) ** self.u


DOUBLE = Arithmetic("double", -53, -1075, 1023)
FLOAT = Arithmetic("float", -24, -150, 127)
ARITHMETICS = {"double": DOUBLE, "float": FLOAT}

#: Accuracy in units of u; of library functions per ulp of the stated accuracy.
EXACT = frozenset({"input", "neg", "abs", "max", "min"})
ROUNDED = frozenset({"add", "sub", "mul", "div", "sqrt"})
LIBRARY = {"sin": 2, "cos": 2, "exp": 2, "log": 2, "expm1": 2, "pow": 2}


@dataclass(frozen=True, slots=True)
class Bounded:
    """Exact value (a ball), and bounds of the error of the computed one.

    absolute, relative : of the error itself, and over |value|
    scaled             : over the sum of the magnitudes of the terms, which survives cancellation
                         (underflow aside)
    """

    value: arb
    absolute: arb
    relative: arb
    scaled: arb

    def is_finite(self, arithmetic: Arithmetic) -> bool:
        """True for a value that is proved to be finite in code."""
        return bool(up(self.value) + self.absolute < arb(2) ** arithmetic.top)


INFINITE = arb("inf")


def factor(op: str, arithmetic: Arithmetic) -> int:
    """k in ``|d| <= k u`` of one operation."""
    if op in EXACT:
        return 0
    if op in ROUNDED:
        return 1
    return LIBRARY.get(op, 4) * arithmetic.library


Filled = Callable[[Any, Bounded, Arithmetic], Bounded]


def followed(
    graph: Graph, inputs: Sequence[arb], arithmetic: Arithmetic, literals: Sequence[Any], filled: Filled | None = None
) -> list[Bounded]:
    """Value and error bounds of every node over the box of the inputs, which are taken as exact.

    literals : the number that stands in the code for each constant node (None for other nodes)
    filled   : the bounds of a part with a hole (:mod:`navsym.export.accuracy.continuation`), where the graph has some
    """
    with precision(BITS):
        done: list[Bounded] = []
        for node, literal in zip(graph.nodes, literals, strict=True):
            args = [done[a] for a in node.args]
            if node.op == "input":
                done.append(Bounded(inputs[node.value], arb(0), arb(0), arb(0)))
            elif node.op == "const":
                value = enclose(node.value, {}, BITS)
                error = up(value - arb(literal))
                done.append(tightened(value, error, ratio(error, value), INFINITE))
            else:
                done.append(rounded(node, args, arithmetic, filled))
        return done


def rounded(node: Node, args: list[Bounded], arithmetic: Arithmetic, filled: Filled | None) -> Bounded:
    """One operation: errors of the arguments carried through, and its own rounding; none is known if it overflows."""
    if node.op == "filled":
        assert filled is not None, "a branch of a part has no part itself"
        found = filled(node.value, args[0], arithmetic)
    else:
        found = rounded_plainly(node, args, arithmetic)
    return found if found.is_finite(arithmetic) else Bounded(found.value, INFINITE, INFINITE, INFINITE)


def rounded_plainly(node: Node, args: list[Bounded], arithmetic: Arithmetic) -> Bounded:
    """Value and bounds of any other operation: errors of the arguments carried through, and its own rounding."""
    value = exact_value(node, args)
    absolute, relative = propagated(node, args, value)
    absolute, relative = sane(absolute), sane(relative)
    k = factor(node.op, arithmetic) * arithmetic.unit()
    scaled = sane(carried_scale(node, args))
    if k == 0:
        return tightened(value, absolute, relative, scaled)
    eta = arb(0) if node.op in ("add", "sub", "sqrt") else arb(2) ** arithmetic.eta
    carried = tightened(value, absolute, relative, scaled)
    own = k * (up(value) + carried.absolute) + eta
    return tightened(
        value,
        up(carried.absolute + own),
        up(carried.relative + k * (1 + carried.relative) + ratio(eta, value)),
        up(carried.scaled + k * (1 + carried.scaled)),
    )


def carried_scale(node: Node, args: list[Bounded]) -> arb:
    """Errors of the arguments over the magnitudes of their terms, for the operations that keep terms apart."""
    if node.op in ("add", "sub"):
        return args[0].scaled.max(args[1].scaled)
    if node.op == "mul":
        return args[0].scaled + args[1].scaled + args[0].scaled * args[1].scaled
    if node.op == "div":
        a, b = args
        return (a.scaled + b.relative) / (1 - b.relative) if b.relative < 1 else INFINITE
    return args[0].scaled if node.op == "neg" else INFINITE


def tightened(value: arb, absolute: arb, relative: arb, scaled: arb) -> Bounded:
    """Each bound made no worse than the other ones imply."""
    absolute, relative = sane(absolute), sane(relative)
    from_relative = sane(relative * up(value)) if relative.is_finite() else INFINITE
    if from_relative < absolute:
        absolute = from_relative
    implied = ratio(absolute, value)
    if implied < relative:
        relative = implied
    scaled = sane(scaled)
    return Bounded(value, absolute, relative, relative if relative < scaled else scaled)


def up(x: arb) -> arb:
    """An upper bound of |x| without a radius."""
    return arb(x.abs_upper())


def down(x: arb) -> arb:
    """A lower bound of |x| without a radius."""
    return arb(x.abs_lower())


def float_above(x: arb) -> float:
    """The least double that is certainly not below a ball, or the next one; infinity where the ball is not finite."""
    top = x.upper()
    near = float(top) if x.is_finite() else math.inf
    return near if arb(near) >= top else math.nextafter(near, math.inf)


def sane(bound: arb) -> arb:
    """The bound, or infinity when it is not a number."""
    return up(bound) if bound.is_finite() else INFINITE


def ratio(error: arb, value: arb) -> arb:
    """error / |value| rounded up; infinite where the value may vanish."""
    if error == 0:
        return arb(0)
    least = down(value)
    return sane(error / least) if least > 0 else INFINITE


ARITHMETIC_VALUES: dict[str, Callable[..., arb]] = {
    "add": lambda x, y: x + y,
    "sub": lambda x, y: x - y,
    "mul": lambda x, y: by_ends(x, y) if apart(x, y) else x * y,
    "div": lambda x, y: by_ends(x, inverse(y)) if apart(x, y) else x / y,
    "neg": lambda x: -x,
    "abs": abs,
    "sqrt": lambda x: x.sqrt() if x >= 0 else arb("nan"),
    "pow": lambda x, y: (x.log() * y).exp() if x > 0 else arb("nan"),
    "max": lambda x, y: x.max(y),
    "min": lambda x, y: x.min(y),
    "atan2": lambda y, x: arb.atan2(y, x) if not (x.contains(0) and y.contains(0)) else arb("nan"),
    "log": lambda x: x.log() if x > 0 else arb("nan"),
    "asin": lambda x: x.asin() if -1 <= x <= 1 else arb("nan"),
    "acos": lambda x: x.acos() if -1 <= x <= 1 else arb("nan"),
}


def apart(x: arb, y: arb) -> bool:
    """True when both balls are wide and have a sign: then ends are tighter than middle and radius."""
    return not (x.contains(0) or y.contains(0) or (x.rad() == 0 and y.rad() == 0))


def by_ends(x: arb, y: arb) -> arb:
    """The product of two balls with a sign, from the least and the greatest magnitude."""
    size = (down(x) * down(y)).union(up(x) * up(y))
    return size if (x > 0) == (y > 0) else -size


def inverse(x: arb) -> arb:
    """1/x of a ball with a sign, from its ends."""
    size = (1 / up(x)).union(1 / down(x))
    return size if x > 0 else -size


def exact_value(node: Node, args: list[Bounded]) -> arb:
    """The exact value of an operation over the exact values of its arguments."""
    balls = [a.value for a in args]
    if node.op == "mul" and node.args[0] == node.args[1]:
        return (down(balls[0]) ** 2).union(up(balls[0]) ** 2)
    if node.op in ARITHMETIC_VALUES:
        return arb(ARITHMETIC_VALUES[node.op](*balls))
    return arb(getattr(balls[0], node.op)())


def propagated(node: Node, args: list[Bounded], value: arb) -> tuple[arb, arb]:
    """Bounds of the error that the arguments bring, before the operation's own rounding."""
    # Across the cut they bring a turn, also zero by its sign.
    if node.op == "atan2" and not (down(args[0].value) > args[0].absolute or args[1].value > args[1].absolute):
        return 2 * arb.pi(), INFINITE
    if all(a.absolute == 0 for a in args):
        return arb(0), arb(0)
    if node.op in ("add", "sub"):
        return carried_sum(node, args)
    if node.op in PAIRS:
        return PAIRS[node.op](args, value)
    (a,) = args
    wide = a.value + arb(0, a.absolute) if a.absolute.is_finite() else arb("nan")
    slope = up(SLOPES[node.op](wide)) if node.op in SLOPES else INFINITE
    absolute = slope * a.absolute if slope.is_finite() and a.absolute.is_finite() else INFINITE
    return absolute, relative_through(node.op, a, wide)


def carried_sum(node: Node, args: list[Bounded]) -> tuple[arb, arb]:
    """Bounds of the error of a sum or difference; a relative one only where both terms have one sign."""
    a, b = args
    other = b.value if node.op == "add" else -b.value
    same_sign = (a.value >= 0 and other >= 0) or (a.value <= 0 and other <= 0)
    relative = (a.relative if a.relative > b.relative else b.relative) if same_sign else INFINITE
    return a.absolute + b.absolute, relative


def carried_product(args: list[Bounded], value: arb) -> tuple[arb, arb]:
    """Bounds of the error of a b: ``|a| db + |b| da + da db``, and the same of relative errors."""
    a, b = args
    absolute = up(a.value) * b.absolute + up(b.value) * a.absolute + a.absolute * b.absolute
    return absolute, a.relative + b.relative + a.relative * b.relative


def carried_quotient(args: list[Bounded], value: arb) -> tuple[arb, arb]:
    """Bounds of the error of a / b; infinite where the error of b may reach b."""
    a, b = args
    room = down(b.value) - b.absolute if b.absolute.is_finite() else arb(-1)
    absolute = (a.absolute + up(value) * b.absolute) / room if room > 0 else INFINITE
    relative = (a.relative + b.relative) / (1 - b.relative) if b.relative < 1 else INFINITE
    return absolute, relative


def carried_power(args: list[Bounded], value: arb) -> tuple[arb, arb]:
    """x^y by |y| relative errors of x, and log x absolute errors of y."""
    a, b = args
    if not a.relative < arb("0.5"):
        return INFINITE, INFINITE
    exponent = (up(b.value) + b.absolute) * 2 * a.relative + up(a.value.log()) * b.absolute
    return INFINITE, exponent.expm1()


def carried_arctangent(args: list[Bounded], value: arb) -> tuple[arb, arb]:
    """Gradient of atan2 is at most 1/radius long."""
    y, x = args
    least = (down(x.value) ** 2 + down(y.value) ** 2).sqrt() - x.absolute - y.absolute
    return ((x.absolute + y.absolute) / least if least > 0 else INFINITE), INFINITE


def carried_extreme(args: list[Bounded], value: arb) -> tuple[arb, arb]:
    """Bounds of the error of max or min: the larger of the two."""
    a, b = args
    relative = a.relative.max(b.relative)
    return a.absolute.max(b.absolute), relative if relative < 1 else INFINITE


PAIRS = {
    "mul": carried_product,
    "div": carried_quotient,
    "pow": carried_power,
    "atan2": carried_arctangent,
    "max": carried_extreme,
    "min": carried_extreme,
}

#: |f'| over the widened argument.
SLOPES: dict[str, Callable[[arb], arb]] = {
    "neg": lambda w: arb(1),
    "abs": lambda w: arb(1),
    "sin": lambda w: w.cos(),
    "cos": lambda w: w.sin(),
    "exp": lambda w: w.exp(),
    "expm1": lambda w: w.exp(),
    "log": lambda w: 1 / w if w > 0 else arb("inf"),
    "sqrt": lambda w: 1 / (2 * w.sqrt()) if w > 0 else arb("inf"),
    "atan": lambda w: 1 / (1 + w * w),
    "asin": lambda w: 1 / (1 - w * w).sqrt() if abs(w) < 1 else arb("inf"),
    "acos": lambda w: 1 / (1 - w * w).sqrt() if abs(w) < 1 else arb("inf"),
    "sinh": lambda w: w.cosh(),
    "cosh": lambda w: w.sinh(),
    "tanh": lambda w: arb(1),
}


def relative_through(op: str, a: Bounded, wide: arb) -> arb:
    """Relative error of f(x (1 + d)) from that of x, where ``|x f'(x) / f(x)|`` is known.

    x cot x is at most 1 for |x| <= 2, and moving the cosine by d costs another 4.4 d. sqrt halves a small
    relative error.
    """
    r = a.relative
    if op in ("neg", "abs"):
        return r
    if not r < arb("0.01"):
        return INFINITE
    if op == "sqrt":
        return r / 2 * (1 + r)
    if op in ("sin", "atan", "tanh", "asin") and abs(wide) < (2 if op == "sin" else arb("0.5")):
        return r * (1 + 5 * r) if op != "asin" else r * arb("1.2")
    if op in ("sinh", "expm1") and abs(wide) < 1:
        return 3 * r * (1 + 10 * r)
    if op == "exp" and a.absolute.is_finite():
        return arb(a.absolute.expm1())
    return INFINITE


def literals_of(graph: Graph, arithmetic: Arithmetic) -> tuple[float | None, ...]:
    """The number in the code for each constant node: the nearest of the type."""
    return tuple(literal(n.value, arithmetic) if n.op == "const" else None for n in graph.nodes)


def literal(value: sp.Expr, arithmetic: Arithmetic) -> float:
    """The nearest number of the type; raises DomainError for a constant beyond the largest one."""
    try:
        nearest = int(value.p) / int(value.q) if value.is_Rational else float(sp.N(value, 40))
    except OverflowError:
        nearest = math.inf
    with np.errstate(over="ignore"):
        nearest = float(np.float32(nearest)) if arithmetic.name == "float" else nearest
    if not math.isfinite(nearest):
        exponent = int(sp.floor(sp.log(abs(value), 2).evalf(20)))
        message = f"expected constants within the range of {arithmetic.name}; got one of size 2^{exponent}"
        raise DomainError(f"{message}; rescale the formula")
    return nearest
