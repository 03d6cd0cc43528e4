"""Forms that keep their digits: differences that cancel, and quotients whose singularity is removable.

Each rewriting is exact, and the graph that comes out of them is proved equal to the formula by the
normal form (:func:`navsym.export.functions.tie_to_formula`); nothing here is trusted.

    k - k cos x  =  2 k sin(x/2)^2        k exp x - k  =  k expm1(x)

and what still has a hole or cancels at zero is :func:`navsym.export.holes.filled` there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import sympy as sp

from navsym.export import holes
from navsym.export.atoms import expm1

Ranges = Mapping[sp.Symbol, tuple[Any, Any]]


QUOTIENTS: dict[type, Callable[[sp.Expr], sp.Expr]] = {
    sp.tan: lambda x: sp.sin(x) / sp.cos(x),
    sp.cot: lambda x: sp.cos(x) / sp.sin(x),
    sp.sec: lambda x: 1 / sp.cos(x),
    sp.csc: lambda x: 1 / sp.sin(x),
}


def safe(expression: sp.Expr, ranges: Ranges) -> sp.Expr:
    """The same value in a form that does not cancel near zero.

    ranges : symbol -> (lower, upper), None for no end; a symbol that is not named is any real number
    """
    if not expression.args:
        return expression
    parts = [safe(part, ranges) for part in expression.args]
    if type(expression) in QUOTIENTS:
        return QUOTIENTS[type(expression)](parts[0])
    if isinstance(expression, sp.Add):
        return holes.total(safe_sum(parts), ranges)
    if isinstance(expression, sp.Mul):
        return holes.product(sp.Mul(*parts), ranges)
    return expression.func(*parts)


def safe_sum(terms: list[sp.Expr]) -> sp.Expr:
    """A sum with its cancelling pairs joined."""
    left = list(terms)
    joined: list[sp.Expr] = []
    for term in terms:
        if term not in left:
            continue
        for partner, whole in partners(term):
            if partner in left and partner != term:
                left.remove(term)
                left.remove(partner)
                joined.append(whole)
                break
    return sp.Add(*joined, *left)


def partners(term: sp.Expr) -> list[tuple[sp.Expr, sp.Expr]]:
    """(other term, what the two are together) for the pairs that cancel at zero."""
    found = []
    for function in sp.Mul.make_args(term):
        rest = term / function
        if isinstance(function, sp.cos):
            found.append((-rest, -2 * rest * sp.sin(function.args[0] / 2) ** 2))
        if isinstance(function, sp.cosh):
            found.append((-rest, 2 * rest * sp.sinh(function.args[0] / 2) ** 2))
        if isinstance(function, sp.exp):
            found.append((-rest, rest * expm1(function.args[0])))
    return found


def factored(expression: sp.Expr) -> sp.Expr | None:
    """A candidate form of a rational function of sines and cosines of multiples of one angle.

    With s, c at the base angle and s^2 = 1 - c^2 it is (A + B s)/(C + D s), A … D polynomials in c;
    where two of them vanish the rest is factored, so that 1 - c and 1 + c become squares of half
    angles. None when the expression is not of this kind.
    """
    expression = sp.sympify(expression, strict=True).replace(
        lambda n: type(n) in QUOTIENTS, lambda n: QUOTIENTS[type(n)](*n.args)
    )
    angle = base_angle(expression)
    if angle is None:
        return None
    s, c = sp.symbols("navsym_s navsym_c")  # dummies would order themselves by their history
    whole = expression.replace(lambda n: isinstance(n, (sp.sin, sp.cos)), lambda n: multiple(n, angle, s, c))
    above, below = (reduced(part, s, c) for part in sp.fraction(sp.together(whole)))
    if not (above and below):
        return None
    parity = [(bool(part[0]), bool(part[1])) for part in (above, below)]
    if any(all(pair) for pair in parity) or not any(parity[1]):
        return None
    quotient = sp.factor(sp.cancel(sum(above) / sum(below)))
    power = (1 if parity[0][1] else 0) - (1 if parity[1][1] else 0)
    if any(parity[0]):
        quotient *= s**power
    halves = quotient.replace(lambda n: isinstance(n, sp.Add), lambda n: half_angle(n, angle, c))
    result = halves.subs({s: sp.sin(angle), c: sp.cos(angle)}, simultaneous=True)
    return None if result.has(sp.nan, sp.zoo) else result


def base_angle(expression: sp.Expr) -> sp.Expr | None:
    """The common base of all angles, when they are rational multiples of one; else None."""
    arguments = [node.args[0] for node in expression.atoms(sp.sin, sp.cos)]
    split = [argument.as_coeff_Mul() for argument in arguments]
    if not split or len({rest for _, rest in split}) != 1 or not all(k.is_Rational for k, _ in split):
        return None
    step = common_step([k for k, _ in split])
    most = max(abs(k / step) for k, _ in split)
    return step * split[0][1] if most <= 12 else None


def common_step(numbers: Iterable[sp.Rational]) -> sp.Rational:
    """The largest number of which all the given ones are whole multiples, whatever their order.

    sympy's ``gcd_list`` stops at the first 1: it gives 1 for (1, 1/2) and 1/2 for (1/2, 1).
    """
    found = [abs(sp.Rational(k)) for k in numbers]
    return sp.Rational(math.gcd(*(int(k.p) for k in found)), math.lcm(*(int(k.q) for k in found)))


def multiple(node: sp.Expr, angle: sp.Expr, s: sp.Symbol, c: sp.Symbol) -> sp.Expr:
    """sin or cos of a multiple of the base angle as a polynomial in s and c."""
    n = int(sp.cancel(node.args[0] / angle))
    sign = -1 if n < 0 else 1
    if isinstance(node, sp.cos):
        return sp.chebyshevt(abs(n), c)
    return sign * s * sp.chebyshevu(abs(n) - 1, c) if n else sp.S.Zero


def reduced(part: sp.Expr, s: sp.Symbol, c: sp.Symbol) -> tuple[sp.Expr, sp.Expr] | None:
    """(A, B) with part = A + B s modulo s^2 = 1 - c^2; None when it is no polynomial in s."""
    if not part.is_polynomial(s, c):
        return None
    even, odd = sp.S.Zero, sp.S.Zero
    for (power,), coefficient in sp.Poly(part, s).terms():
        term = coefficient * (1 - c**2) ** (power // 2)
        even, odd = (even, odd + term) if power % 2 else (even + term, odd)
    return sp.expand(even), sp.expand(odd)


def half_angle(node: sp.Add, angle: sp.Expr, c: sp.Symbol) -> sp.Expr:
    """``c - 1`` as ``-2 sin(angle/2)^2``, ``c + 1`` as ``2 cos(angle/2)^2``, c = cos(angle); else the sum."""
    if sp.expand(node - (c - 1)) == 0:
        return -2 * sp.sin(angle / 2) ** 2
    if sp.expand(node - (c + 1)) == 0:
        return 2 * sp.cos(angle / 2) ** 2
    return node
