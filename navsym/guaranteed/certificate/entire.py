"""What exp, sin and cos leave behind their first Taylor terms, as functions of their own that are regular at zero.

``f_k(x) = sum_j f^(j + k)(0) x**j / (j + k)!`` is f(x) less its terms below x**k, divided by x**k. Regressors of an
interval that vanishes are written with them, so that powers of its length cancel before balls see them.
"""

from __future__ import annotations

from math import factorial
from typing import Any

import sympy as sp
from flint import arb

from navsym.checker import AT_ZERO, TERMS
from navsym.core.balls import constant_term, undefined_like
from navsym.language.expression import to_text


class Remainder(sp.Function):
    """``f_k(x)`` with the arguments k, a whole number, and x; each function f is a class below."""

    nargs = 2
    name = ""

    def fdiff(self, argindex: int = 2) -> sp.Expr:
        """``f_k' = (f')_k - k f_(k + 1)``."""
        k, x = self.args
        sign, slope = SLOPES[self.func]
        return sign * slope(k, x) - k * self.func(k + 1, x)

    def on_balls(self, _: Any, x: Any) -> Any:
        """The value where |x| <= 1, with the terms and the rest that the checker takes."""
        if not abs(constant_term(x)) <= 1:
            return undefined_like(x)
        k = int(self.args[0])
        value: Any = arb(0, 3) / factorial(k + TERMS)
        for j in reversed(range(k, k + TERMS)):
            value = value * x + arb(AT_ZERO[self.name][j % 4]) / factorial(j)
        return value


class ExpRemainder(Remainder):
    """Of exp."""

    name = "exp"


class SinRemainder(Remainder):
    """Of sin."""

    name = "sin"


class CosRemainder(Remainder):
    """Of cos."""

    name = "cos"


SLOPES = {ExpRemainder: (1, ExpRemainder), SinRemainder: (1, CosRemainder), CosRemainder: (-1, SinRemainder)}
REMAINDERS = {sp.exp: ExpRemainder, sp.sin: SinRemainder, sp.cos: CosRemainder}


def write_entire(h: sp.Expr) -> str:
    """Text of an expression that may hold remainders: ``sin_3(2*T*u)``."""
    parts = sorted(h.atoms(Remainder), key=sp.default_sort_key)
    marks = [sp.Symbol(f"part_{i}_") for i in range(len(parts))]
    text = to_text(h.xreplace(dict(zip(parts, marks, strict=True))))
    for f, mark in zip(parts, marks, strict=True):
        text = text.replace(mark.name, f"{f.name}_{f.args[0]}({to_text(f.args[1])})")
    return text
