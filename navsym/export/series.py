"""Exact power series over the rational numbers: the order to which a formula vanishes at zero, without a doubt."""

from __future__ import annotations

from collections.abc import Callable
from operator import methodcaller
from typing import Any

import sympy as sp
from flint import fmpq, fmpq_series

from navsym.core.balls import series_terms

TERMS = 48  # coefficients that are computed; a formula that vanishes to a higher order is left alone

NAMES = "exp sin cos tan sinh cosh tanh log asin atan".split()
FUNCTIONS: dict[type, Callable[[Any], Any]] = {getattr(sp, name): methodcaller(name) for name in NAMES}


class NoSeriesError(ArithmeticError):
    """The formula has no power series with rational coefficients around zero, or none that is found here."""


def taylor(expression: sp.Expr, t: sp.Symbol, terms: int = TERMS) -> tuple[fmpq, ...]:
    """The first coefficients of a formula in t around zero, exactly; raises NoSeriesError."""
    with series_terms(terms):
        try:
            found = series(expression, t)
        except (ValueError, ZeroDivisionError) as error:
            raise NoSeriesError(str(error)) from error
    return tuple(found[k] for k in range(min(terms, found.prec)))


def order(expression: sp.Expr, t: sp.Symbol) -> int:
    """The exponent of the first power of t that a formula has; negative at a pole; raises NoSeriesError.

    A quotient is taken as numerator over denominator, each with its own order.
    """
    above, below = sp.fraction(sp.together(expression))
    return first_power(taylor(above, t)) - first_power(taylor(below, t))


def first_power(coefficients: tuple[fmpq, ...]) -> int:
    """Place of the first coefficient that is not zero; raises NoSeriesError when all are."""
    for place, coefficient in enumerate(coefficients):
        if coefficient != 0:
            return place
    raise NoSeriesError("expected a coefficient that is not zero; got none among those computed")


def series(e: sp.Expr, t: sp.Symbol) -> fmpq_series:
    """Recursion over the formula; ValueError where an operation has no rational series."""
    if e == t:
        return fmpq_series([0, 1])
    if isinstance(e, sp.Rational):
        return fmpq_series([fmpq(int(e.p), int(e.q))])
    if isinstance(e, (sp.Add, sp.Mul)):
        result = series(e.args[0], t)
        for part in e.args[1:]:
            other = series(part, t)
            result = result + other if isinstance(e, sp.Add) else result * other
        return result
    if isinstance(e, sp.Pow) and isinstance(e.exp, sp.Rational):
        return power(series(e.base, t), fmpq(int(e.exp.p), int(e.exp.q)))
    if type(e) in FUNCTIONS:
        return FUNCTIONS[type(e)](series(e.args[0], t))
    raise NoSeriesError(f"expected a function with a rational series; got {type(e).__name__}")


def power(base: fmpq_series, exponent: fmpq) -> fmpq_series:
    """A whole power by products, a fractional one of a series that begins with 1."""
    if exponent.q != 1:
        return (base.log() * fmpq_series([exponent])).exp()
    result = fmpq_series([1])
    for _ in range(abs(int(exponent.p))):
        result = result * base
    return result if exponent > 0 else fmpq_series([1]) / result
