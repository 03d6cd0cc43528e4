"""Trees as polynomials over the rational numbers: an expanded text needs no arithmetic, only its exponents."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from navsym.core.errors import DomainError, TooLargeError
from navsym.core.exact import to_fmpq
from navsym.language.names import quote
from navsym.language.tree import NUMBER, POWER, PRODUCT, SUM, SYMBOL, Tree, list_names, list_parts

TERMS = 1_000_000  # of a power that is multiplied out
DEGREE = 2**31

#: Place of a symbol -> its exponent, and the coefficient.
Monomial = tuple[dict[int, int], fmpq]


def to_polynomial(tree: Tree, names: Sequence[str] | None = None) -> fmpq_mpoly:
    """The polynomial that the tree means, in the symbols ``names`` or in those of the tree by the alphabet.

    Raises DomainError for what is no polynomial, TooLargeError for powers of sums with over a million terms.

    >>> from navsym.language.expression import read_tree
    >>> to_polynomial(read_tree("(x + y)**2 - x*y/2"))
    x^2 + 3/2*x*y + y^2
    """
    names = sorted(list_names(tree)) if names is None else list(names)
    ring = fmpq_mpoly_ctx.get(names, Ordering.lex)
    build = PolynomialBuilder(ring, {name: place for place, name in enumerate(names)})
    for part in list_parts(tree):
        build.add(part)
    return build.polynomial(tree)


@dataclass(slots=True, eq=False)
class PolynomialBuilder:
    """Monomials stay exponents and a coefficient; only what is none becomes a polynomial on the way."""

    ring: fmpq_mpoly_ctx
    places: Mapping[str, int]
    monomials: dict[Tree, Monomial] = field(default_factory=dict)
    polynomials: dict[Tree, fmpq_mpoly] = field(default_factory=dict)

    def add(self, part: Tree) -> None:
        """Take up a part whose own parts have been taken up."""
        if part.head == NUMBER:
            self.monomials[part] = {}, to_fmpq(part.args[0])
        elif part.head == SYMBOL and part.args[0] in self.places:
            self.monomials[part] = {self.places[part.args[0]]: 1}, fmpq(1)
        elif part.head == SUM:
            self.polynomials[part] = self.sum(part)
        elif part.head == PRODUCT:
            self.multiply(part)
        elif part.head == POWER:
            self.raise_to(part)
        else:
            raise refuse_part(part)

    def polynomial(self, part: Tree) -> fmpq_mpoly:
        """The polynomial of a part that has been taken up."""
        return self.from_terms([self.monomials[part]]) if part in self.monomials else self.polynomials[part]

    def from_terms(self, terms: Sequence[Monomial]) -> fmpq_mpoly:
        """The sum of monomials."""
        coefficients: dict[tuple[int, ...], fmpq] = {}
        empty = [0] * len(self.places)
        for exponents, coefficient in terms:
            row = empty.copy()
            for place, exponent in exponents.items():
                row[place] = exponent
            key = tuple(row)
            coefficients[key] = coefficients[key] + coefficient if key in coefficients else coefficient
        return self.ring.from_dict(coefficients)

    def sum(self, part: Tree) -> fmpq_mpoly:
        """Monomials in one step, other terms one by one."""
        total = self.from_terms([self.monomials[term] for term in part.args if term in self.monomials])
        for term in part.args:
            if term not in self.monomials:
                total += self.polynomials[term]
        return total

    def multiply(self, part: Tree) -> None:
        """A product of monomials is one."""
        exponents: dict[int, int] = {}
        coefficient, others = fmpq(1), []
        for factor in part.args:
            if factor not in self.monomials:
                others.append(self.polynomials[factor])
                continue
            inner, scale = self.monomials[factor]
            coefficient *= scale
            for place, exponent in inner.items():
                exponents[place] = exponents.get(place, 0) + exponent
        self.monomials[part] = exponents, coefficient
        if others:
            product = self.from_terms([self.monomials.pop(part)])
            for other in others:
                product *= other
            self.polynomials[part] = product

    def raise_to(self, part: Tree) -> None:
        """A whole power; of a number also a negative one."""
        base, exponent = part.args
        n = exponent.args[0] if exponent.head == NUMBER else Fraction(1, 2)
        inner, coefficient = self.monomials.get(base, ({}, fmpq(1)))
        has_symbols = bool(inner) or base not in self.monomials
        vanishes = not self.polynomials[base] if base in self.polynomials else coefficient == 0
        if n.denominator != 1 or (n < 0 and has_symbols) or (n <= 0 and vanishes):
            raise refuse_part(part)
        n = n.numerator
        degree = max(inner.values(), default=0)
        bits = int(max(abs(coefficient.p), coefficient.q)).bit_length() - 1
        terms = math.comb(len(self.polynomials[base]) + n - 1, n) if base in self.polynomials else 1
        if degree * n > DEGREE or bits * abs(n) > TERMS or terms > TERMS:
            message = f"expected at most {TERMS} terms and digits; got {quote(repr(part))}; split the expression"
            raise TooLargeError(message)
        if base in self.polynomials:
            self.polynomials[part] = self.polynomials[base] ** n
        else:
            self.monomials[part] = {place: e * n for place, e in inner.items()}, coefficient**n


def refuse_part(part: Tree) -> DomainError:
    """The error for a part that makes the whole no polynomial."""
    message = f"expected a polynomial with rational coefficients; got {quote(repr(part))} in it; rewrite it"
    return DomainError(message)
