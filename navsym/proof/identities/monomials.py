"""Sums of monomials with rational coefficients: what angles and exponents are made of."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import sympy as sp

#: An angle, exponent or radicand monomial: base -> rational exponent.
Monomial = frozenset[tuple[sp.Basic, Fraction]]


UNIT: Monomial = frozenset()


PI: Monomial = frozenset({(sp.pi, Fraction(1))})


def linear_terms(expression: sp.Basic) -> dict[Monomial, Fraction]:
    """The expression expanded as a sum: monomial -> rational coefficient."""
    if isinstance(expression, sp.Rational):
        value = Fraction(int(expression.p), int(expression.q))
        return {UNIT: value} if value else {}
    if isinstance(expression, sp.Add):
        total: dict[Monomial, Fraction] = {}
        for term in expression.args:
            add_terms(total, linear_terms(term))
        return total
    if isinstance(expression, sp.Mul):
        product: dict[Monomial, Fraction] = {UNIT: Fraction(1)}
        for factor in expression.args:
            product = multiply_terms(product, linear_terms(factor))
        return product
    if isinstance(expression, sp.Pow) and isinstance(expression.exp, sp.Rational):
        return power_terms(expression)
    return {frozenset({(expression, Fraction(1))}): Fraction(1)}


def power_terms(expression: sp.Pow) -> dict[Monomial, Fraction]:
    exponent = Fraction(int(expression.exp.p), int(expression.exp.q))
    base = linear_terms(expression.base)
    if exponent.denominator == 1 and 0 < exponent <= 64:
        product: dict[Monomial, Fraction] = {UNIT: Fraction(1)}
        for _ in range(exponent.numerator):
            product = multiply_terms(product, base)
        return product
    if exponent.denominator == 1 and len(base) == 1:
        ((monomial, coefficient),) = base.items()
        scaled = frozenset((b, e * exponent) for b, e in monomial)
        return {scaled: coefficient**exponent.numerator}
    return {frozenset({(expression.base, exponent)}): Fraction(1)}


def add_terms(total: dict[Monomial, Fraction], terms: Mapping[Monomial, Fraction]) -> None:
    for monomial, coefficient in terms.items():
        value = total.get(monomial, Fraction(0)) + coefficient
        if value:
            total[monomial] = value
        else:
            total.pop(monomial, None)


def multiply_terms(left: Mapping[Monomial, Fraction], right: Mapping[Monomial, Fraction]) -> dict[Monomial, Fraction]:
    product: dict[Monomial, Fraction] = {}
    for m1, c1 in left.items():
        for m2, c2 in right.items():
            add_terms(product, {multiply_monomials(m1, m2): c1 * c2})
    return product


def multiply_monomials(left: Monomial, right: Monomial) -> Monomial:
    exponents = dict(left)
    for base, exponent in right:
        exponents[base] = exponents.get(base, Fraction(0)) + exponent
    return frozenset((b, e) for b, e in exponents.items() if e)


def single(monomial: Monomial, kinds: tuple[type, ...]) -> sp.Basic | None:
    """The base of a monomial that is one function of the given kinds to the first power."""
    if len(monomial) == 1:
        ((base, exponent),) = monomial
        if exponent == 1 and isinstance(base, kinds):
            return base
    return None
