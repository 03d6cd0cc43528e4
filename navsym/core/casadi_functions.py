"""Fast numerical functions from derived expressions: sympy in, casadi out, no text in between.

The expression is walked node by node, so that no name or string is ever evaluated, every number is
rounded once, and the differences that lose all digits near zero are written in the form that does not:

    k cos x - k  =  -2 k sin(x/2)^2        k cosh x - k  =  2 k sinh(x/2)^2        k exp x - k  =  k expm1(x)

Without this (1 - cos w)/w^2 comes out as 0 at w = 1e-9 instead of 1/2. Other cancellations remain the
caller's: x - sin x keeps 1e-16 absolutely, not relatively, and needs a series where x is small.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import reduce
from operator import add, mul
from typing import Any, TypeAlias

import casadi as ca
import numpy as np
import sympy as sp

from navsym.core.errors import DomainError, NotFiniteError, ShapeError, UnknownSymbolError
from navsym.core.exact import raise_by_squaring

Argument: TypeAlias = sp.Symbol | Sequence[sp.Symbol]
Memo = dict[sp.Basic, Any]

SAME_NAME = "sin cos tan asin acos atan sinh cosh tanh exp log sign".split()
UNARY = {getattr(sp, name): getattr(ca, name) for name in SAME_NAME} | {
    sp.Abs: ca.fabs,
    sp.cot: lambda x: ca.cos(x) / ca.sin(x),
    sp.sec: lambda x: 1 / ca.cos(x),
    sp.csc: lambda x: 1 / ca.sin(x),
    sp.acot: lambda x: ca.atan(1 / x),
}
CONSTANTS = {sp.pi: np.pi, sp.E: np.e}
#: f(x) - 1 without cancellation, for the functions with f(0) = 1.
LESS_ONE = {sp.cos: lambda x: -2 * ca.sin(x / 2) ** 2, sp.cosh: lambda x: 2 * ca.sinh(x / 2) ** 2, sp.exp: ca.expm1}


def casadi_function(name: str, arguments: Sequence[Argument], expression: Any) -> ca.Function:
    """A casadi function of the given arguments.

    name       : an identifier; it also names the function in code that casadi generates
    arguments  : symbols, or sequences of symbols for vector arguments, in the order of the inputs
    expression : a scalar or a matrix; its shape is the shape of the output

    Raises UnknownSymbolError (a symbol that is no argument), DomainError (a function that has no
    counterpart, a name that is no identifier), NotFiniteError (a number beyond double precision).
    """
    inputs, memo = declare_inputs(arguments)
    return ca.Function(check_identifier(name), inputs, [translate_output(expression, memo)])


def column_function(name: str, inputs: Sequence[Any], outputs: Sequence[Any]) -> ca.Function:
    """A casadi function of expressions that are translated already; its output is the column of them."""
    return ca.Function(check_identifier(name), list(inputs), [ca.densify(ca.vertcat(*outputs))])


def by_distance(x: Any, limit: float, below: Any, above: Any) -> Any:
    """``below`` where |x| < limit, ``above`` elsewhere; what the other one comes to, NaN also, does not matter."""
    return ca.if_else(ca.fabs(x) < limit, below, above)


def check_identifier(name: str) -> str:
    """The name, if it may stand in generated code."""
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*", name):
        raise DomainError(f"name: expected letters, digits and single underscores; got {name!r}; rename it")
    return name


def declare_inputs(arguments: Sequence[Argument]) -> tuple[list[Any], Memo]:
    """casadi's variables, and the first entries of the table of known subexpressions."""
    inputs, memo = [], {}
    for place, argument in enumerate(arguments):
        symbols = [argument] if isinstance(argument, sp.Symbol) else list(argument)
        if not symbols:
            raise ShapeError(f"argument {place}: expected at least one symbol; got none; leave it out")
        vector = ca.SX.sym(f"a{place}", len(symbols))  # names of the user never reach the engine
        inputs.append(vector)
        for k, symbol in enumerate(symbols):
            if symbol in memo:
                raise DomainError(f"argument {place}: expected different symbols; got {symbol} twice")
            memo[symbol] = vector[k]
    return inputs, memo


def translate_output(expression: Any, memo: Memo) -> Any:
    """A scalar or a dense matrix of casadi expressions."""
    if not isinstance(expression, sp.MatrixBase):
        return ca.SX(translate(sp.sympify(expression, strict=True), memo))
    rows = [ca.horzcat(*(translate(entry, memo) for entry in row)) for row in expression.tolist()]
    return ca.densify(ca.vertcat(*rows))


def translate(expression: sp.Expr, memo: Memo) -> Any:
    """One node; common subexpressions are translated once."""
    known = memo.get(expression)
    if known is None:
        known = memo[expression] = translate_node(expression, memo)
    return known


def translate_node(expression: sp.Expr, memo: Memo) -> Any:
    """One node of the expression, its parts translated first."""
    if isinstance(expression, sp.Rational):
        return round_once(expression)
    if expression in CONSTANTS:
        return ca.SX(CONSTANTS[expression])
    if isinstance(expression, sp.Add):
        return translate_sum(expression, memo)
    if isinstance(expression, sp.Mul):
        return translate_product(expression, memo)
    if isinstance(expression, sp.Pow):
        return translate_power(expression, memo)
    if isinstance(expression, sp.atan2):
        return ca.atan2(*(translate(part, memo) for part in expression.args))
    if isinstance(expression, (sp.Min, sp.Max)):
        pick = ca.fmin if isinstance(expression, sp.Min) else ca.fmax
        return reduce(pick, [translate(part, memo) for part in expression.args])
    function = UNARY.get(type(expression))
    if function is not None:
        return function(translate(expression.args[0], memo))
    if isinstance(expression, sp.Symbol):
        raise UnknownSymbolError(f"expression: expected only its arguments; got {expression}; name it as one")
    raise DomainError(f"expression: expected functions of the language; got {type(expression).__name__}; rewrite it")


def round_once(number: sp.Rational) -> Any:
    """The nearest double of an exact number; the quotient of two integers is rounded once."""
    try:
        return ca.SX(int(number.p) / int(number.q))
    except OverflowError:
        raise NotFiniteError("expression: expected numbers below 1.8e308; got a larger one; rescale") from None


def translate_sum(expression: sp.Add, memo: Memo) -> Any:
    """A sum, with pairs k f(x), -k joined where f(0) = 1."""
    terms = list(expression.args)
    parts = []
    for term in expression.args:
        coefficient, function = unit_function(term)
        if function is not None and term in terms and -coefficient in terms:
            terms.remove(term)
            terms.remove(-coefficient)
            less_one = LESS_ONE[type(function)](translate(function.args[0], memo))
            parts.append(less_one if coefficient == 1 else translate(coefficient, memo) * less_one)
    parts += [translate(term, memo) for term in terms]
    return reduce(add, parts)


def unit_function(term: sp.Expr) -> tuple[sp.Expr, sp.Expr | None]:
    """The term as (k, f(x)) with one function f of the kind f(0) = 1, or (term, None)."""
    factors = sp.Mul.make_args(term)
    functions = [factor for factor in factors if isinstance(factor, tuple(LESS_ONE))]
    if len(functions) != 1:
        return term, None
    return sp.Mul(*(factor for factor in factors if factor is not functions[0])), functions[0]


def translate_product(expression: sp.Mul, memo: Memo) -> Any:
    """Numerator over denominator: one division, and the rational coefficient in its two parts."""
    above, below = expression.as_numer_denom() if expression.is_commutative else (expression, sp.S.One)
    if below == 1:
        return reduce(mul, (translate(factor, memo) for factor in sp.Mul.make_args(above)))
    return translate(above, memo) / translate(below, memo)


def translate_power(expression: sp.Pow, memo: Memo) -> Any:
    """A power: whole exponents by multiplication, halves by the square root, others as they are."""
    base, exponent = expression.args
    x = translate(base, memo)
    if exponent.is_Rational and exponent.q <= 2:
        power = raise_by_squaring(x if exponent.q == 1 else ca.sqrt(x), abs(int(exponent.p)), mul)
        return power if exponent.p > 0 else 1 / power
    return ca.power(x, translate(exponent, memo))
