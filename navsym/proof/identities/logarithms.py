"""Logarithms of products and powers, written out: log(p**2 q/4) = 2 log p + log q - 2 log 2 for positive p, q."""

from __future__ import annotations

from collections.abc import Callable

import sympy as sp

from navsym.proof.identities.normal_form import vanishes_identically

Test = Callable[[sp.Expr], bool]

#: Powers beyond which nothing is factored: it would take for ever.
MOST_DEGREE = 1000


def expand_logarithms(expression: sp.Expr, is_positive: Test) -> sp.Expr:
    """Every logarithm as a sum over the factors of its argument that are proved to be positive.

    The argument itself is positive wherever the logarithm exists, so that a rest with no proof is positive too.
    """
    found = {node: expanded(node.args[0], is_positive) for node in expression.atoms(sp.log)}
    return expression.xreplace({node: value for node, value in found.items() if value != node})


def expanded(argument: sp.Expr, is_positive: Test) -> sp.Expr:
    total, rest = sp.Integer(0), sp.Integer(1)
    for factor in sp.Mul.make_args(factored(argument)):
        value = one_factor(factor, is_positive)
        if value is None:
            rest *= factor
        else:
            total += value
    return total + (sp.log(rest) if rest != 1 else 0)


def one_factor(factor: sp.Expr, is_positive: Test) -> sp.Expr | None:
    """Logarithm of a positive number, or of a power of something positive; None without a proof."""
    if isinstance(factor, sp.Rational):
        return rational_logarithm(factor) if factor > 0 else None
    base, exponent = factor.as_base_exp()
    if base is sp.E:
        return exponent
    if base == factor:
        return sp.log(factor) if is_positive(factor) else None
    for value in (base, -base) if exponent.is_even else (base,):
        inner = one_factor(value, is_positive)
        if inner is not None:
            return exponent * inner
    return None


def rational_logarithm(number: sp.Rational) -> sp.Expr:
    """By primes, so that logarithms of rationals become combinations of independent ones."""
    parts = ((int(number.p), 1), (int(number.q), -1))
    return sp.Add(*(sign * k * sp.log(prime) for n, sign in parts for prime, k in sp.factorint(n).items()))


def factored(argument: sp.Expr) -> sp.Expr:
    """The argument as a product; a factoring is taken only when the normal form proves it."""
    if argument.is_number or not argument.has(sp.Add) or degree_bound(argument) > MOST_DEGREE:
        return argument
    product = sp.factor(argument)
    return product if vanishes_identically(argument - product) else argument


def degree_bound(argument: sp.Expr) -> int:
    """The largest number in an exponent: exp(12345/67891) is a power of 12345 to the algebra."""
    exponents = [power.exp for power in argument.atoms(sp.Pow)] + [node.args[0] for node in argument.atoms(sp.exp)]
    numbers = set().union(*(exponent.atoms(sp.Rational) for exponent in exponents))
    return max((max(abs(int(number.p)), int(number.q)) for number in numbers), default=1)
