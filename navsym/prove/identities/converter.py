"""Expressions as quotients of polynomials over the ring of the normal form, and their reduction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import sympy as sp
from flint import Ordering, fmpq_mpoly, fmpq_mpoly_ctx, fmpz

from navsym.core.errors import NavsymError
from navsym.core.exact import to_fmpq, to_fraction, to_rational
from navsym.prove.identities.ingredients import (
    HYPERBOLIC,
    INVERSE,
    PI,
    ROOT_OF_UNITY_FOR_PRIME,
    TRIGONOMETRIC,
    Ingredients,
    Monomial,
    gather,
    inverse_radicand,
    linear_terms,
    single_function,
)


class UndefinedExpressionError(NavsymError):
    """A divisor that vanishes identically."""

    kind = "domain"


@dataclass(frozen=True, slots=True, eq=False)
class Quotient:
    """numerator / denominator over the ring of one :class:`Converter`."""

    numerator: fmpq_mpoly
    denominator: fmpq_mpoly

    def __add__(self, other: Quotient) -> Quotient:
        if self.denominator == other.denominator:
            return Quotient(self.numerator + other.numerator, self.denominator)
        common = self.denominator.gcd(other.denominator)
        left, right = other.denominator / common, self.denominator / common
        return Quotient(self.numerator * left + other.numerator * right, self.denominator * left)

    def __mul__(self, other: Quotient) -> Quotient:
        return Quotient(self.numerator * other.numerator, self.denominator * other.denominator).reduced()

    def reduced(self) -> Quotient:
        if self.denominator.is_constant() or self.numerator.is_zero():
            return self
        common = self.numerator.gcd(self.denominator)
        if common.is_constant():
            return self
        return Quotient(self.numerator / common, self.denominator / common)

    def __pow__(self, n: int) -> Quotient:
        if n >= 0:
            return Quotient(self.numerator**n, self.denominator**n)
        return Quotient(self.denominator**-n, self.numerator**-n)


class Converter:
    """Turns expressions into quotients over one ring, and decides whether they vanish.

    Divisors, radicands and arguments of logarithms met on the way are kept in ``divisors``,
    ``radicands`` and ``arguments``: they are what a verdict has to assume.
    """

    def __init__(self, expressions: Sequence[sp.Basic]):
        found = Ingredients()
        for expression in expressions:
            gather(expression, found)
        self.found = found
        self.atoms = merge_atoms(list(found.atoms))
        self.roots = list(found.roots)
        self.divisors: dict[sp.Basic, None] = {}
        self.radicands: dict[sp.Basic, None] = {}
        self.arguments: dict[sp.Basic, None] = {}
        self.ring = fmpq_mpoly_ctx.get(self.generator_names(), Ordering.lex)
        self.generators = dict(zip(self.generator_names(), self.ring.gens(), strict=True))
        self.cache: dict[sp.Basic, Quotient] = {}

    def generator_names(self) -> list[str]:
        """Names of the ring's generators, the root of unity last."""
        found = self.found
        names = [f"x{i}" for i in range(len(found.symbols))]
        names += [f"z{i}" for i in range(len(found.angles))]
        names += [f"e{i}" for i in range(len(found.exponents))]
        names += [f"a{i}" for i in range(1 + max(self.atoms.values(), default=-1))]
        names += [f"g{i}" for i in range(len(self.roots))]
        return [*names, "zeta"]

    # -- conversion -------------------------------------------------------------------------

    def constant(self, value: Fraction | int) -> Quotient:
        return Quotient(self.ring.constant(to_fmpq(value)), self.ring.constant(1))

    def generator(self, name: str, power: int = 1) -> Quotient:
        one = self.ring.constant(1)
        return Quotient(self.generators[name], one) ** power

    def unity(self, turns: Fraction) -> Quotient:
        """exp(2 pi i turns) as a power of the root of unity."""
        steps = turns * self.found.unity
        assert steps.denominator == 1, "the root of unity was chosen for every multiple of pi"
        return self.generator("zeta", int(steps) % self.found.unity)

    def convert(self, expression: sp.Basic) -> Quotient:
        if expression not in self.cache:
            self.cache[expression] = self.convert_new(expression)
        return self.cache[expression]

    def convert_new(self, expression: sp.Basic) -> Quotient:
        """One node of the tree; its arguments come from the cache."""
        if isinstance(expression, sp.Rational):
            return self.constant(to_fraction(expression))
        if isinstance(expression, sp.Symbol):
            index = list(self.found.symbols).index(expression)
            return self.generator(f"x{index}", self.found.symbols[expression])
        if isinstance(expression, sp.Add):
            return self.total([self.convert(argument) for argument in expression.args])
        if isinstance(expression, sp.Mul):
            return self.product([self.convert(argument) for argument in expression.args])
        if isinstance(expression, sp.Pow):
            return self.power(expression)
        if isinstance(expression, TRIGONOMETRIC):
            return self.trigonometric(expression)
        if isinstance(expression, sp.exp):
            return self.exponential(expression.args[0])
        if expression is sp.E:
            return self.exponential(sp.Integer(1))
        if isinstance(expression, HYPERBOLIC):
            return self.hyperbolic(expression)
        if isinstance(expression, sp.Abs):
            return self.root(expression.args[0] ** 2, 2)
        if isinstance(expression, sp.log):
            self.arguments.setdefault(expression.args[0])
        return self.generator(f"a{self.atoms[expression]}")

    def total(self, terms: Sequence[Quotient]) -> Quotient:
        value = terms[0]
        for term in terms[1:]:
            value = value + term
        return value

    def product(self, factors: Sequence[Quotient]) -> Quotient:
        value = factors[0]
        for factor in factors[1:]:
            value = value * factor
        return value

    def power(self, expression: sp.Pow) -> Quotient:
        """Powers: of signed bases by integers, of nonnegative ones by rationals, otherwise exp(q log b)."""
        base, exponent = expression.args
        if not isinstance(exponent, sp.Rational):
            self.arguments.setdefault(base)
            return self.exponential(exponent * sp.log(base))
        if exponent < 0:
            self.divide_by(base)
        p, q = int(exponent.p), int(exponent.q)
        if q == 1:
            return self.convert(base) ** p
        if isinstance(base, sp.Symbol) and base.is_nonnegative:
            index = list(self.found.symbols).index(base)
            return self.generator(f"x{index}", p * self.found.symbols[base] // q)
        if isinstance(base, sp.Rational):
            return self.number_root(base, q) ** p
        self.radicands.setdefault(base)
        return self.root(base, q) ** p

    def divide_by(self, divisor: sp.Basic) -> None:
        self.divisors.setdefault(divisor)

    def root(self, radicand: sp.Basic, q: int) -> Quotient:
        return self.generator(f"g{self.roots.index((radicand, q))}")

    def number_root(self, base: sp.Rational, q: int) -> Quotient:
        """The positive q-th root of a positive rational, by primes."""
        exponents = dict(sp.factorint(int(base.p)))
        for prime, exponent in sp.factorint(int(base.q)).items():
            exponents[prime] = exponents.get(prime, 0) - exponent
        value = self.constant(1)
        for prime, exponent in exponents.items():
            if prime == 1:
                continue
            if q == 2 and prime in ROOT_OF_UNITY_FOR_PRIME:
                value = value * self.small_square_root(prime) ** exponent
            else:
                value = value * self.root(sp.Integer(prime), q) ** exponent
        return value

    def small_square_root(self, prime: int) -> Quotient:
        """sqrt 2 = 2 cos(pi/4), sqrt 3 = 2 cos(pi/6), sqrt 5 = 4 cos(pi/5) - 1."""
        turns = {2: Fraction(1, 8), 3: Fraction(1, 12), 5: Fraction(1, 10)}[prime]
        twice_cosine = self.unity(turns) + self.unity(-turns)
        if prime == 5:
            return twice_cosine * self.constant(2) + self.constant(-1)
        return twice_cosine

    # -- exp(i angle), exp(exponent) ----------------------------------------------------------

    def rotation(self, angle: sp.Basic) -> Quotient:
        """exp(i angle)."""
        value = self.constant(1)
        for monomial, coefficient in linear_terms(angle).items():
            if monomial == PI:
                value = value * self.unity(coefficient / 2)
                continue
            power = coefficient * self.found.angles[monomial]
            value = value * self.rotation_generator(monomial) ** int(power)
        return value

    def rotation_generator(self, monomial: Monomial) -> Quotient:
        inverse = single_function(monomial, INVERSE)
        if inverse is not None and self.found.angles[monomial] == 1:
            return self.inverse_rotation(inverse)
        return self.generator(f"z{list(self.found.angles).index(monomial)}")

    def inverse_rotation(self, inverse: sp.Basic) -> Quotient:
        """exp(i asin u) = sqrt(1 - u^2) + i u, and the like."""
        i = self.unity(Fraction(1, 4))
        radicand = inverse_radicand(inverse)
        g = self.root(radicand, 2)
        u = self.convert(inverse.args[0])
        if isinstance(inverse, sp.asin):
            self.radicands.setdefault(radicand)
            return g + i * u
        if isinstance(inverse, sp.acos):
            self.radicands.setdefault(radicand)
            return u + i * g
        self.divide_by(sp.sqrt(radicand) if isinstance(inverse, sp.atan2) else sp.Integer(1))
        if isinstance(inverse, sp.atan):
            return (self.constant(1) + i * u) * g**-1
        return (self.convert(inverse.args[1]) + i * u) * g**-1

    def exponential(self, exponent: sp.Basic) -> Quotient:
        value = self.constant(1)
        for monomial, coefficient in linear_terms(exponent).items():
            logarithm = single_function(monomial, (sp.log,))
            if logarithm is not None:
                self.arguments.setdefault(logarithm.args[0])
                rational = to_rational(coefficient)
                value = value * self.convert(sp.Pow(logarithm.args[0], rational))
                continue
            index = list(self.found.exponents).index(monomial)
            value = value * self.generator(f"e{index}", int(coefficient * self.found.exponents[monomial]))
        return value

    def trigonometric(self, expression: sp.Basic) -> Quotient:
        """The six circular functions of z = exp(i angle)."""
        angle = expression.args[0]
        z, half = self.rotation(angle), self.constant(Fraction(1, 2))
        cosine = (z + z**-1) * half
        sine = (z + z**-1 * self.constant(-1)) * half * self.unity(Fraction(-1, 4))
        if isinstance(expression, sp.cos):
            return cosine
        if isinstance(expression, sp.sin):
            return sine
        if isinstance(expression, (sp.tan, sp.sec)):
            self.divide_by(sp.cos(angle))
            return (sine if isinstance(expression, sp.tan) else self.constant(1)) * cosine**-1
        self.divide_by(sp.sin(angle))
        return (cosine if isinstance(expression, sp.cot) else self.constant(1)) * sine**-1

    def hyperbolic(self, expression: sp.Basic) -> Quotient:
        e, half = self.exponential(expression.args[0]), self.constant(Fraction(1, 2))
        cosh = (e + e**-1) * half
        sinh = (e + e**-1 * self.constant(-1)) * half
        if isinstance(expression, sp.cosh):
            return cosh
        return sinh if isinstance(expression, sp.sinh) else sinh * cosh**-1

    # -- reduction to the normal form -----------------------------------------------------------

    def vanishes(self, quotient: Quotient) -> bool:
        """True when the numerator reduces to zero by the relations of the roots and of zeta."""
        polynomial = quotient.numerator
        for index in reversed(range(len(self.roots))):
            polynomial = self.reduce_root(polynomial, index)
            if polynomial.is_zero():
                return True
        return self.reduce_unity(polynomial).is_zero()

    def reduce_root(self, polynomial: fmpq_mpoly, index: int) -> fmpq_mpoly:
        """Replace g**q by its radicand and clear the denominator."""
        radicand, q = self.roots[index]
        place = self.generator_names().index(f"g{index}")
        parts = split_by_power(polynomial, place)
        if max(parts, default=0) < q:
            return polynomial
        inner = self.convert(radicand)
        top = max(parts) // q
        result = self.ring.constant(0)
        for power, part in parts.items():
            whole, rest = divmod(power, q)
            factor = inner.numerator**whole * inner.denominator ** (top - whole)
            result = result + part * factor * self.generators[f"g{index}"] ** rest
        return result

    def reduce_unity(self, polynomial: fmpq_mpoly) -> fmpq_mpoly:
        """Remainder by the cyclotomic polynomial in zeta."""
        place = len(self.generators) - 1
        order = self.found.unity
        folded = self.ring.constant(0)
        for power, part in split_by_power(polynomial, place).items():
            folded = folded + part * self.generators["zeta"] ** (power % order)
        _, remainder = divmod(folded, self.cyclotomic(order))
        return remainder

    def cyclotomic(self, order: int) -> fmpq_mpoly:
        coefficients = [int(c) for c in reversed(sp.cyclotomic_poly(order, polys=True).all_coeffs())]
        zeta = self.generators["zeta"]
        result = self.ring.constant(0)
        for power, coefficient in enumerate(coefficients):
            result = result + zeta**power * fmpz(coefficient)
        return result

    def check_divisors(self) -> None:
        """Refuse an expression that divides by something identically zero."""
        for divisor in list(self.divisors):
            if vanishes_identically(divisor):
                raise UndefinedExpressionError(
                    f"expected a divisor that is not identically zero; got {divisor}; correct the formula"
                )


def split_by_power(polynomial: fmpq_mpoly, place: int) -> dict[int, fmpq_mpoly]:
    """Coefficients of the powers of one generator."""
    context = polynomial.context()
    parts: dict[int, dict[tuple[int, ...], Any]] = {}
    for exponents, coefficient in polynomial.to_dict().items():
        rest = list(exponents)
        power, rest[place] = int(rest[place]), 0
        parts.setdefault(power, {})[tuple(rest)] = coefficient
    return {power: context.from_dict(terms) for power, terms in parts.items()}


def merge_atoms(atoms: list[sp.Basic]) -> dict[sp.Basic, int]:
    """Number the atoms; two get one number when their arguments are provably the same."""
    numbers: dict[sp.Basic, int] = {}
    for atom in atoms:
        twin = next((known for known in numbers if is_same_atom(known, atom)), None)
        numbers[atom] = numbers[twin] if twin is not None else 1 + max(numbers.values(), default=-1)
    return numbers


def is_same_atom(left: sp.Basic, right: sp.Basic) -> bool:
    if left.func is not right.func or len(left.args) != len(right.args) or not left.args:
        return left == right
    return all(vanishes_identically(a - b) for a, b in zip(left.args, right.args, strict=True))


def vanishes_identically(expression: sp.Expr) -> bool:
    """True when the expression provably vanishes wherever it is defined."""
    if isinstance(expression, sp.Rational):
        return expression == 0
    converter = Converter([expression])
    return converter.vanishes(converter.convert(expression))
