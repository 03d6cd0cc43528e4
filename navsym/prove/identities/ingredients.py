"""Which generators an expression needs: a walk before the ring of the normal form can be made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from math import lcm

import sympy as sp

from navsym.core.errors import NavsymError
from navsym.core.exact import to_fraction, to_rational

# Sums of monomials with rational coefficients: what angles and exponents are made of.


#: An angle, exponent or radicand monomial: base -> rational exponent.
Monomial = frozenset[tuple[sp.Basic, Fraction]]


UNIT: Monomial = frozenset()


PI: Monomial = frozenset({(sp.pi, Fraction(1))})


def linear_terms(expression: sp.Basic) -> dict[Monomial, Fraction]:
    """The expression expanded as a sum: monomial -> rational coefficient."""
    if isinstance(expression, sp.Rational):
        value = to_fraction(expression)
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
    exponent = to_fraction(expression.exp)
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


def single_function(monomial: Monomial, kinds: tuple[type, ...]) -> sp.Basic | None:
    """The base of a monomial that is one function of the given kinds to the first power."""
    if len(monomial) == 1:
        ((base, exponent),) = monomial
        if exponent == 1 and isinstance(base, kinds):
            return base
    return None


class OutsideLanguageError(NavsymError):
    """An expression that the normal form does not cover."""

    kind = "unsupported"


TRIGONOMETRIC = (sp.sin, sp.cos, sp.tan, sp.cot, sp.sec, sp.csc)


HYPERBOLIC = (sp.sinh, sp.cosh, sp.tanh)


INVERSE = (sp.asin, sp.acos, sp.atan, sp.atan2)


ROOT_OF_UNITY_FOR_PRIME = {2: 8, 3: 12, 5: 20}

#: Order of the root of unity beyond which its cyclotomic polynomial is not made.
MOST_UNITY = 20_000


@dataclass(slots=True)
class Ingredients:
    """What was met while walking an expression, before the ring can be made."""

    symbols: dict[sp.Symbol, int] = field(default_factory=dict)  # -> root index q, x = s**q
    angles: dict[Monomial, int] = field(default_factory=dict)  # -> common denominator d
    exponents: dict[Monomial, int] = field(default_factory=dict)
    roots: dict[tuple[sp.Basic, int], None] = field(default_factory=dict)  # (radicand, q), inner first
    atoms: dict[sp.Basic, None] = field(default_factory=dict)
    unity: int = 1  # order of the root of unity


def gather(expression: sp.Basic, found: Ingredients) -> None:
    """Walk the expression and note the generators that it needs."""
    if isinstance(expression, sp.Rational):
        return
    if isinstance(expression, sp.Symbol):
        found.symbols.setdefault(expression, 1)
    elif isinstance(expression, (sp.Add, sp.Mul)):
        for argument in expression.args:
            gather(argument, found)
    elif isinstance(expression, sp.Pow):
        gather_power(expression, found)
    elif isinstance(expression, TRIGONOMETRIC):
        gather_angle(expression.args[0], found)
    elif isinstance(expression, (sp.exp, *HYPERBOLIC)):
        gather_exponent(expression.args[0], found)
    elif expression is sp.E:
        gather_exponent(sp.Integer(1), found)
    elif isinstance(expression, sp.Abs):
        gather(expression.args[0], found)
        found.roots.setdefault((expression.args[0] ** 2, 2))
    elif expression is sp.pi or isinstance(expression, (sp.log, sp.sign, sp.Max, sp.Min, *INVERSE)):
        found.atoms.setdefault(expression)
    else:
        raise OutsideLanguageError(
            f"expected an expression of the language; got {expression.func.__name__}; rewrite it"
        )


def gather_power(expression: sp.Pow, found: Ingredients) -> None:
    base, exponent = expression.args
    if not isinstance(exponent, sp.Rational):
        gather_exponent(exponent * sp.log(base), found)
        return
    gather(base, found)
    q = int(exponent.q)
    if q == 1:
        return
    if isinstance(base, sp.Symbol) and base.is_nonnegative:
        found.symbols[base] = lcm(found.symbols.get(base, 1), q)
    elif isinstance(base, sp.Rational):
        gather_number_root(base, q, found)
    else:
        found.roots.setdefault((base, q))


def gather_number_root(base: sp.Rational, q: int, found: Ingredients) -> None:
    if base < 0:
        raise OutsideLanguageError(f"expected a root of a nonnegative number; got {base}; use real roots")
    for prime in sp.factorint(int(base.p) * int(base.q)):
        if q == 2 and prime in ROOT_OF_UNITY_FOR_PRIME:
            found.unity = lcm(found.unity, ROOT_OF_UNITY_FOR_PRIME[prime])
        elif prime > 1:
            found.roots.setdefault((sp.Integer(prime), q))


def gather_angle(angle: sp.Basic, found: Ingredients) -> None:
    found.unity = lcm(found.unity, 4)
    for monomial, coefficient in linear_terms(angle).items():
        if monomial == PI:
            found.unity = lcm(found.unity, 2 * coefficient.denominator)
            if found.unity > MOST_UNITY:
                raise OutsideLanguageError(
                    f"expected turns with a common denominator below {MOST_UNITY}; got {angle}; round it"
                )
            continue
        found.angles[monomial] = lcm(found.angles.get(monomial, 1), coefficient.denominator)
        inverse = single_function(monomial, INVERSE)
        if inverse is not None and found.angles[monomial] == 1:
            for argument in inverse.args:
                gather(argument, found)
            found.roots.setdefault((inverse_radicand(inverse), 2))


def inverse_radicand(inverse: sp.Basic) -> sp.Expr:
    """The radicand that exp(i asin u) and its kin bring along."""
    if isinstance(inverse, (sp.asin, sp.acos)):
        return 1 - inverse.args[0] ** 2
    if isinstance(inverse, sp.atan):
        return 1 + inverse.args[0] ** 2
    return inverse.args[0] ** 2 + inverse.args[1] ** 2


def gather_exponent(exponent: sp.Basic, found: Ingredients) -> None:
    for monomial, coefficient in linear_terms(exponent).items():
        logarithm = single_function(monomial, (sp.log,))
        if logarithm is not None:
            power = to_rational(coefficient)
            gather(sp.Pow(logarithm.args[0], power), found)
            continue
        found.exponents[monomial] = lcm(found.exponents.get(monomial, 1), coefficient.denominator)
