"""The language of files evaluated by other means: Python's own reader of expressions and mpmath, nothing of navsym.

Real arithmetic only: what is not a real number, or divides by zero, has no value and raises Undefined.
"""

from __future__ import annotations

import ast
import functools
import re
from fractions import Fraction

import mpmath

DIGITS = 50


class Undefined(Exception):
    """No real value here."""


def real(value):
    if isinstance(value, mpmath.mpc):
        if value.imag != 0:
            raise Undefined
        value = value.real
    if not mpmath.isfinite(value):
        raise Undefined
    return value


def inside(value, low, high):
    if not low <= value <= high:
        raise Undefined
    return value


def wave(function):
    """sin or cos, and zero where nothing but rounding is left of it: sin(pi) has no sign."""

    def value_of(x):
        y = function(x)
        return mpmath.mpf(0) if abs(y) < (1 + abs(x)) * mpmath.mpf(10) ** (12 - mpmath.mp.dps) and x != 0 else y

    return value_of


def divided(top, bottom):
    if abs(bottom) < mpmath.mpf(10) ** (12 - mpmath.mp.dps):
        raise Undefined  # zero, or not to be told from it
    return top / bottom


def positive(value):
    if value <= 0:
        raise Undefined
    return value


def power(base, exponent, whole):
    if whole is not None:
        return divided(mpmath.mpf(1), base**-whole) if whole < 0 else base**whole
    if base < 0 or (base == 0 and exponent <= 0):
        raise Undefined
    return base**exponent


FUNCTIONS = {
    "sin": wave(mpmath.sin),
    "cos": wave(mpmath.cos),
    "exp": mpmath.exp,
    "abs": abs,
    "atan": mpmath.atan,
    "sinh": mpmath.sinh,
    "cosh": mpmath.cosh,
    "tanh": mpmath.tanh,
    "tan": lambda x: divided(mpmath.sin(x), mpmath.cos(x)),
    "cot": lambda x: divided(mpmath.cos(x), mpmath.sin(x)),
    "sec": lambda x: divided(mpmath.mpf(1), mpmath.cos(x)),
    "csc": lambda x: divided(mpmath.mpf(1), mpmath.sin(x)),
    "log": lambda x: mpmath.log(positive(x)),
    "sqrt": lambda x: power(x, mpmath.mpf(1) / 2, None),
    "asin": lambda x: mpmath.asin(inside(x, -1, 1)),
    "acos": lambda x: mpmath.acos(inside(x, -1, 1)),
}


NAME = re.compile(r"(?<![0-9A-Za-z_.])[A-Za-z][A-Za-z0-9_]*")
KNOWN = {*FUNCTIONS, "atan2", "pi"}


def value(text, point, digits=DIGITS):
    """The number that the text means at a point (name -> text or number)."""
    with mpmath.workdps(digits):
        known = {
            name: entry if isinstance(entry, mpmath.mpf) else value(str(entry), {}, digits)
            for name, entry in point.items()
        }
        return real(evaluate(tree_of(text), known))


@functools.cache
def tree_of(text):
    """Python's tree of the text; names get a mark, since lambda is one of ours."""
    marked = NAME.sub(lambda m: m[0] if m[0] in KNOWN else f"v_{m[0]}", text.strip())
    return ast.parse(marked, mode="eval").body


def evaluate(node, point):
    if isinstance(node, ast.Constant):
        fraction = Fraction(str(node.value))
        return mpmath.mpf(fraction.numerator) / fraction.denominator
    if isinstance(node, ast.Name):
        return mpmath.pi + 0 if node.id == "pi" else point[node.id.removeprefix("v_")]
    if isinstance(node, ast.UnaryOp):
        inner = evaluate(node.operand, point)
        return -inner if isinstance(node.op, ast.USub) else inner
    if isinstance(node, ast.Call):
        arguments = [real(evaluate(part, point)) for part in node.args]
        if node.func.id == "atan2":
            if not any(arguments):
                raise Undefined
            return mpmath.atan2(*arguments)
        return FUNCTIONS[node.func.id](*arguments)
    left, right = real(evaluate(node.left, point)), real(evaluate(node.right, point))
    if isinstance(node.op, ast.Pow):
        return power(left, right, whole_number(node.right))
    if isinstance(node.op, ast.Div):
        return divided(left, right)
    return {ast.Add: left + right, ast.Sub: left - right, ast.Mult: left * right}[type(node.op)]


def whole_number(node):
    """The integer that stands as an exponent, or None."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        inner = whole_number(node.operand)
        return None if inner is None else -inner
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, int) else None
