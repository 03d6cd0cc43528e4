"""Polynomials over the integers in the parameters of a model, and their quotients.

The exact observability of a symbolic system needs nothing but sums, products, exact divisions
and greatest common divisors of polynomials. This file is the only one of the methods that
touches the polynomial engine; matrices come in as sympy and go out as sympy.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp
from flint import Ordering, fmpz_mpoly, fmpz_mpoly_ctx

from navsym.errors import DomainError, TooLargeError

Poly = fmpz_mpoly

#: Largest integer exponent that is multiplied out.
EXPONENT = 64


@dataclass(frozen=True, slots=True)
class Quotient:
    """``top / bottom`` in lowest terms; the bottom is not the zero polynomial."""

    top: Poly
    bottom: Poly


@dataclass(frozen=True, slots=True, eq=False)
class Ring:
    """Z[symbols], graded reverse lexicographic."""

    symbols: tuple[sp.Basic, ...]
    context: Any

    @classmethod
    def of(cls, expressions: Iterable[sp.Basic]) -> Ring:
        """The ring of all symbols of the expressions, in the order of their names.

        The number pi is a symbol too: it is transcendental, so no relation is lost.
        """
        found: set[sp.Basic] = set()
        for expression in expressions:
            found |= expression.atoms(sp.Symbol)
            found |= {sp.pi} if expression.has(sp.pi) else set()
        return cls.over(sorted(found, key=str))

    @classmethod
    def over(cls, symbols: Sequence[sp.Basic]) -> Ring:
        """The ring of the given symbols."""
        names = tuple(f"g{place}" for place in range(len(symbols)))
        return cls(tuple(symbols), fmpz_mpoly_ctx.get(names, Ordering.degrevlex))

    def constant(self, value: int) -> Poly:
        """An integer as a polynomial."""
        return self.context.constant(value)

    def quotient(self, expression: sp.Basic) -> Quotient:
        """A rational function with rational coefficients; DomainError for anything else."""
        if isinstance(expression, sp.Rational):
            return Quotient(self.constant(int(expression.p)), self.constant(int(expression.q)))
        if expression in self.symbols:
            return Quotient(self.context.gen(self.symbols.index(expression)), self.constant(1))
        if isinstance(expression, sp.Add):
            return self.total([self.quotient(part) for part in expression.args])
        if isinstance(expression, sp.Mul):
            return self.product([self.quotient(part) for part in expression.args])
        if isinstance(expression, sp.Pow) and isinstance(expression.exp, sp.Integer):
            return self.power(self.quotient(expression.base), int(expression.exp))
        raise DomainError(
            f"expected a rational function of the parameters; got {str(expression)[:60]}; "
            "name such a function as a parameter of its own"
        )

    def lowest(self, top: Poly, bottom: Poly) -> Quotient:
        """The quotient in lowest terms, with a positive leading coefficient below."""
        if top == 0:
            return Quotient(top, self.constant(1))
        if bottom.leading_coefficient() < 0:
            top, bottom = -top, -bottom
        if bottom == 1:
            return Quotient(top, bottom)
        common = top.gcd(bottom)
        return Quotient(divide(top, common), divide(bottom, common))

    def total(self, parts: Sequence[Quotient]) -> Quotient:
        """Sum of quotients."""
        top, bottom = self.constant(0), self.constant(1)
        for part in parts:
            if part.bottom == bottom:
                top = top + part.top
            else:
                top, bottom = top * part.bottom + part.top * bottom, bottom * part.bottom
        return self.lowest(top, bottom)

    def product(self, parts: Sequence[Quotient]) -> Quotient:
        """Product of quotients."""
        top, bottom = self.constant(1), self.constant(1)
        for part in parts:
            top, bottom = top * part.top, bottom * part.bottom
        return self.lowest(top, bottom)

    def power(self, base: Quotient, exponent: int) -> Quotient:
        """Integer power of a quotient, also a negative one."""
        if abs(exponent) > EXPONENT:
            raise TooLargeError(
                f"expected exponents up to {EXPONENT}; got {exponent}; name the power as a parameter"
            )
        if exponent >= 0:
            return Quotient(base.top**exponent, base.bottom**exponent)
        if base.top == 0:
            raise DomainError("expected a nonzero divisor; got 0; mend the entry")
        return self.lowest(base.bottom**-exponent, base.top**-exponent)

    def expression(self, value: Poly | Quotient) -> sp.Expr:
        """Back to sympy, expanded above and below."""
        if isinstance(value, Quotient):
            return self.expression(value.top) / self.expression(value.bottom)
        return sp.Add(*(self.monomial(powers, int(c)) for powers, c in value.to_dict().items()))

    def monomial(self, powers: Sequence[int], coefficient: int) -> sp.Expr:
        """One term in sympy."""
        pairs = zip(self.symbols, powers, strict=True)
        return sp.Mul(sp.Integer(coefficient), *(s ** int(power) for s, power in pairs if power))

    def factored(self, value: Poly | Quotient) -> sp.Expr:
        """Back to sympy as a product of irreducible factors."""
        if isinstance(value, Quotient):
            return self.factored(value.top) / self.factored(value.bottom)
        if value == 0:
            return sp.Integer(0)
        content, factors = value.factor()
        parts = [self.expression(factor) ** int(power) for factor, power in factors]
        return sp.Mul(sp.Integer(int(content)), *parts)


def divide(top: Poly, bottom: Poly) -> Poly:
    """Exact quotient; a remainder is a defect of the caller."""
    quotient, remainder = divmod(top, bottom)
    if remainder != 0:
        raise ArithmeticError(f"{bottom} does not divide {top}")
    return quotient


def divides(bottom: Poly, top: Poly) -> bool:
    """True when the division leaves no remainder."""
    return divmod(top, bottom)[1] == 0


def gcd_all(values: Iterable[Poly], zero: Poly) -> Poly:
    """Greatest common divisor; zero when all values vanish."""
    common = zero
    for value in values:
        common = common.gcd(value) if common != 0 else value
        if common == 1:
            break
    return common


def irreducible_factors(value: Poly) -> list[Poly]:
    """Different irreducible factors that are not numbers."""
    return [factor for factor, _ in value.factor()[1]]
