"""Inverse functions by their definition: ``A = B`` for A = asin(u) says that sin B = u with B in [-pi/2, pi/2].

A sum that contains inverse functions with rational coefficients is solved for one of them at a time;
what is left are equations and inequalities without it, which others prove.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import lcm

import sympy as sp

from navsym.core.exact import to_rational
from navsym.prove.identities.ingredients import linear_terms, single_function
from navsym.prove.identities.normal_form import vanishes_identically

MOST_POWERS = 400
KINDS = (sp.log, sp.asin, sp.acos, sp.atan, sp.atan2)


@dataclass(frozen=True, slots=True)
class Solution:
    """A sum vanishes when ``left = right`` and the others have their signs."""

    atom: sp.Expr
    left: sp.Expr
    right: sp.Expr
    nonnegative: tuple[sp.Expr, ...] = ()
    positive: tuple[sp.Expr, ...] = ()


def solve_for_inverses(difference: sp.Expr) -> Iterator[Solution]:
    """The sum solved for each of its inverse functions, and what that leaves to prove."""
    for factor in sp.Mul.make_args(sp.factor_terms(difference)):
        terms = linear_terms(factor)
        atoms = {m: single_function(m, KINDS) for m in terms}
        if len(terms) < 2 and factor is not difference:
            continue
        for monomial, atom in sorted(atoms.items(), key=lambda item: str(item[1])):
            if atom is not None:
                coefficient = terms[monomial]
                share = to_rational(coefficient)
                value = sp.expand_mul(atom - factor / share)
                if not isinstance(atom, sp.log) or largest_power(value) <= MOST_POWERS:
                    yield replace_by_definition(atom, value)


def largest_power(value: sp.Expr) -> int:
    """The largest whole power that a sum of logarithms turns into."""
    shares = list(linear_terms(value).values())
    n = lcm(*(share.denominator for share in shares), 1)
    return max([n, *(abs(int(share * n)) for share in shares)])


def replace_by_definition(atom: sp.Expr, value: sp.Expr) -> Solution:
    """``atom = value`` without the inverse function."""
    half = sp.pi / 2
    if isinstance(atom, sp.log):
        # u > 0 wherever the logarithm exists, so whole powers of the two sides may be compared.
        n = lcm(*(c.denominator for c in linear_terms(value).values()), 1)
        return Solution(atom, atom.args[0] ** n, sp.exp(sp.expand_mul(n * value)))
    if isinstance(atom, sp.asin):
        return Solution(atom, atom.args[0], sp.sin(value), (half - value, half + value))
    if isinstance(atom, sp.acos):
        return Solution(atom, atom.args[0], sp.cos(value), (value, sp.pi - value))
    if isinstance(atom, sp.atan):
        return Solution(atom, atom.args[0] * sp.cos(value), sp.sin(value), (), (half - value, half + value))
    y, x = atom.args
    along = x * sp.cos(value) + y * sp.sin(value)
    return Solution(atom, x * sp.sin(value), y * sp.cos(value), (sp.pi - value,), (sp.pi + value, along))


# Logarithms of products and powers, written out: log(p**2 q/4) = 2 log p + log q - 2 log 2 for positive p, q.


Test = Callable[[sp.Expr], bool]

#: Powers beyond which nothing is factored: it would take for ever.
MOST_DEGREE = 1000


def expand_logarithms(expression: sp.Expr, is_positive: Test) -> sp.Expr:
    """Every logarithm as a sum over the factors of its argument that are proved to be positive.

    The argument itself is positive wherever the logarithm exists, so that a rest with no proof is positive too.
    """
    found = {node: expand_argument(node.args[0], is_positive) for node in expression.atoms(sp.log)}
    return expression.xreplace({node: value for node, value in found.items() if value != node})


def expand_argument(argument: sp.Expr, is_positive: Test) -> sp.Expr:
    total, rest = sp.Integer(0), sp.Integer(1)
    for factor in sp.Mul.make_args(factor_exactly(argument)):
        value = logarithm_of_factor(factor, is_positive)
        if value is None:
            rest *= factor
        else:
            total += value
    return total + (sp.log(rest) if rest != 1 else 0)


def logarithm_of_factor(factor: sp.Expr, is_positive: Test) -> sp.Expr | None:
    """Logarithm of a positive number, or of a power of something positive; None without a proof."""
    if isinstance(factor, sp.Rational):  # by primes, so that logarithms become combinations of independent ones
        parts = ((int(factor.p), 1), (int(factor.q), -1)) if factor > 0 else ()
        logs = [sign * k * sp.log(prime) for n, sign in parts for prime, k in sp.factorint(n).items()]
        return sp.Add(*logs) if factor > 0 else None
    base, exponent = factor.as_base_exp()
    if base is sp.E:
        return exponent
    if base == factor:
        return sp.log(factor) if is_positive(factor) else None
    for value in (base, -base) if exponent.is_even else (base,):
        inner = logarithm_of_factor(value, is_positive)
        if inner is not None:
            return exponent * inner
    return None


def factor_exactly(argument: sp.Expr) -> sp.Expr:
    """The argument as a product; a factoring is taken only when the normal form proves it."""
    if argument.is_number or not argument.has(sp.Add) or largest_exponent(argument) > MOST_DEGREE:
        return argument
    product = sp.factor(argument)
    return product if vanishes_identically(argument - product) else argument


def largest_exponent(argument: sp.Expr) -> int:
    """The largest number in an exponent: exp(12345/67891) is a power of 12345 to the algebra."""
    exponents = [power.exp for power in argument.atoms(sp.Pow)] + [node.args[0] for node in argument.atoms(sp.exp)]
    numbers = set().union(*(exponent.atoms(sp.Rational) for exponent in exponents))
    return max((max(abs(int(number.p)), int(number.q)) for number in numbers), default=1)
