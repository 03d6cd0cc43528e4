"""Exact arithmetic of the entries of a matrix: polynomials over Q in its parameters.

The parameters of a model, and other constants such as sin(latitude) or sqrt(2), become the
generators of one polynomial ring; ``mu`` is a further variable for characteristic polynomials.
A rational function is a pair (numerator, denominator). Everything here is python-flint, and
the two ways between it and sympy.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from math import lcm
from typing import Any

import sympy as sp
from flint import fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from navsym.core.errors import DomainError
from navsym.core.exact import to_rational
from navsym.core.rational_functions import (
    Quotient,
    cancel_fraction,
    factor_exactly,
    polynomial_sum,
    powers_apart,
    read_arithmetic,
    replace_square,
)

Poly = fmpq_mpoly
Fraction = tuple[Poly, Poly]

QUOTIENTS = {sp.tan: (sp.sin, sp.cos), sp.cot: (sp.cos, sp.sin), sp.sec: (None, sp.cos), sp.csc: (None, sp.sin)}


@dataclass(frozen=True, slots=True, eq=False)
class Ring:
    """Q[generators, mu].

    context    : the ring of python-flint; its last generator is mu
    generators : what each variable stands for, a sympy expression
    powers     : symbol -> (variable, q) when the variable is the q-th root of that symbol
    relations  : variable -> polynomial equal to its square, for sines and square roots
    """

    context: Any
    generators: tuple[sp.Expr, ...]
    powers: dict[sp.Expr, tuple[int, int]]
    relations: dict[int, Poly] = field(default_factory=dict)

    @property
    def one(self) -> Poly:
        """1 as a polynomial of the ring."""
        return self.context.constant(1)

    @property
    def zero(self) -> Poly:
        """0 as a polynomial of the ring."""
        return self.context.constant(0)

    @property
    def mu(self) -> Poly:
        """The variable of characteristic polynomials."""
        return self.context.gens()[-1]


def ring_of(entries: Iterable[sp.Expr]) -> Ring:
    """The smallest ring of this kind in which all entries are rational functions."""
    roots: dict[sp.Expr, int] = {}
    for entry in entries:
        collect_generators(entry, roots)
    bases = sorted(roots, key=lambda base: (not base.is_Symbol, str(base)))
    context = fmpq_mpoly_ctx.get([*(f"g{k}" for k in range(len(bases))), "mu"], "degrevlex")
    generators = tuple(base ** sp.Rational(1, roots[base]) for base in bases)
    powers = {base: (k, roots[base]) for k, base in enumerate(bases)}
    ring = Ring(context, generators, powers)
    for k, generator in enumerate(generators):
        relation = square_of(ring, generator)
        if relation is not None:
            ring.relations[k] = relation
    return ring


def collect_generators(expression: sp.Expr, roots: dict[sp.Expr, int]) -> None:
    """Gather the generators that an expression needs, with the order of the root taken of each."""
    if expression.is_Rational:
        return
    if isinstance(expression, sp.Add | sp.Mul):
        for part in expression.args:
            collect_generators(part, roots)
    elif isinstance(expression, sp.Pow) and expression.exp.is_Rational:
        base, order = expression.base, expression.exp.q
        if order == 1:
            collect_generators(base, roots)
        else:
            note_root(base, order, roots)
            if not base.is_Symbol:
                collect_generators(base, roots)
    elif isinstance(expression, sp.sin | sp.cos | sp.tan | sp.cot | sp.sec | sp.csc):
        note_root(sp.sin(expression.args[0]), 1, roots)
        note_root(sp.cos(expression.args[0]), 1, roots)
    elif expression.is_Atom and expression.is_number and expression is not sp.pi and expression is not sp.E:
        raise DomainError(f"matrix: expected real exact entries; got {expression}; write real numbers")
    else:
        note_root(expression, 1, roots)


def note_root(base: sp.Expr, order: int, roots: dict[sp.Expr, int]) -> None:
    """Remember that a root of this order of the base is needed."""
    roots[base] = lcm(order, roots.get(base, 1))


def square_of(ring: Ring, generator: sp.Expr) -> Poly | None:
    """The square of a sine or of a square root as a polynomial in the others."""
    if isinstance(generator, sp.sin):
        cosine = ring_fraction(ring, sp.cos(generator.args[0]))[0]
        return ring.one - cosine * cosine
    if isinstance(generator, sp.Pow) and generator.exp == sp.Rational(1, 2) and not generator.base.is_Symbol:
        number, divisor = ring_fraction(ring, generator.base)
        return number if divisor == ring.one else None
    return None


def ring_fraction(ring: Ring, expression: sp.Expr) -> Quotient:
    """An expression as a quotient of polynomials of the ring."""
    if isinstance(expression, sp.Pow) and expression.exp.is_Rational and expression.base in ring.powers:
        place, order = ring.powers[expression.base]
        generator, times = ring.context.gens()[place], int(expression.exp * order)
        return Quotient(generator**times, ring.one) if times >= 0 else Quotient(ring.one, generator**-times)
    arithmetic = read_arithmetic(expression, ring.context, lambda part: ring_fraction(ring, part))
    if arithmetic is not None:
        return arithmetic
    quotient = QUOTIENTS.get(type(expression))
    if quotient is not None:
        above, below = (ring.one if f is None else generator_of(ring, f(expression.args[0])) for f in quotient)
        return Quotient(above, below)
    return Quotient(generator_of(ring, expression), ring.one)


def generator_of(ring: Ring, base: sp.Expr) -> Poly:
    """The polynomial that stands for a generator."""
    place, order = ring.powers[base]
    return ring.context.gens()[place] ** order


def reduce_squares(ring: Ring, poly: Poly) -> Poly:
    """The polynomial with every square of a sine or square root replaced by what it equals."""
    for place, square in ring.relations.items():
        if poly.degrees()[place] > 1:
            poly = replace_square(poly, place, square)
    return poly


def factor_polynomial(ring: Ring, poly: Poly) -> sp.Expr:
    """A polynomial as a sympy product of its irreducible factors."""
    if len(poly) <= 1:
        return polynomial_sum(ring.generators, poly)
    content, factors = factor_exactly(poly)
    return sp.Mul(
        to_rational(content), *(polynomial_sum(ring.generators, base) ** int(times) for base, times in factors)
    )


def write_quotient(ring: Ring, above: Poly, divisor: Poly) -> sp.Expr:
    """A rational function as a sympy expression in factored form."""
    top, bottom = (factor_polynomial(ring, part) for part in cancel_fraction(above, divisor))
    return top / bottom


def declared_sign(ring: Ring, poly: Poly) -> int:
    """+1 or -1 when the declared signs of the parameters decide it factor by factor and term by term, else 0."""
    if poly.is_zero():
        return 0
    content, factors = factor_exactly(poly)
    result = 1 if content > 0 else -1
    for base, times in factors:
        if int(times) % 2:
            signs = {sign_of_term(ring, exponents, c) for exponents, c in base.to_dict().items()}
            result *= signs.pop() if len(signs) == 1 else 0
    return result


def sign_of_term(ring: Ring, exponents: tuple[int, ...], coefficient: fmpq) -> int:
    """Sign of one monomial, 0 when the declarations do not decide it."""
    result = 1 if coefficient > 0 else -1
    for generator, exponent in zip(ring.generators, exponents, strict=False):
        if exponent == 0 or generator.is_positive or (generator.is_real and exponent % 2 == 0):
            continue
        if not generator.is_negative:
            return 0
        result = -result if exponent % 2 else result
    return result


def split_square_root(ring: Ring, number_: Poly, divisor: Poly) -> tuple[Quotient, Poly, sp.Expr]:
    """sqrt(number / divisor) = (rational function) * sqrt(radicand), as (fraction, radicand, sqrt(radicand)).

    Squares are taken out without absolute values: the callers use even functions of the root only,
    for which its sign does not matter. The radicand is a polynomial.
    """
    content, factors = factor_exactly(number_ * divisor)  # sqrt(n / d) = sqrt(n d) / d
    outer, inner = ring.one, ring.one
    for base, times in factors:
        outer *= base ** (int(times) // 2)
        inner *= base ** (int(times) % 2)
    if content < 0:
        inner, content = -inner, -content
    whole, surd = sp.sqrt(to_rational(content)).as_coeff_Mul()
    outer *= fmpq(int(whole.p), int(whole.q))
    radicand = inner * ring_fraction(ring, surd**2)[0]
    return cancel_fraction(outer, divisor), radicand, surd * sp.sqrt(polynomial_sum(ring.generators, inner))


# Polynomials in one variable whose coefficients are polynomials in the parameters.
#
# Lists of coefficients, lowest power first. Divisors are monic, so that no step needs a fraction.


Coefficients = list[Poly]


def mu_coefficients(ring: Ring, poly: Poly) -> Coefficients:
    """Coefficients of a polynomial of the ring in powers of its last variable mu."""
    parts = powers_apart(poly, ring.context.nvars() - 1)
    return [parts.get((power,), ring.zero) for power in range(poly.degrees()[-1] + 1)]


def monic_division(ring: Ring, a: Coefficients, b: Coefficients) -> tuple[Coefficients, Coefficients]:
    """Quotient and remainder by a monic b; the remainder has exactly deg b coefficients."""
    rest, n = list(a), len(b) - 1
    quotient = [ring.zero] * max(len(a) - n, 1)
    for k in range(len(a) - n - 1, -1, -1):
        lead = rest[k + n]
        quotient[k] = lead
        if not lead.is_zero():
            for j in range(n):
                rest[k + j] = rest[k + j] - lead * b[j]
    return quotient, (rest + [ring.zero] * n)[:n]


def monic_remainder(ring: Ring, a: Coefficients, b: Coefficients) -> Coefficients:
    """Remainder by a monic divisor, with exactly as many coefficients as its degree."""
    return monic_division(ring, a, b)[1]


def companion_inverse(ring: Ring, a: Coefficients, q: Coefficients) -> tuple[Coefficients, Poly]:
    """v and r with a v = r modulo the monic q, r free of the variable and in lowest terms with v.

    Column k of the linear system is x^k a modulo q; its determinant is the resultant of q and a.
    """
    n = len(q) - 1
    if all(c.is_zero() for c in a[1:]):  # a constant, as for the only factor of q
        return cancel_common([ring.one], a[0])
    columns = [a]
    for _ in range(n - 1):
        columns.append(monic_remainder(ring, [ring.zero, *columns[-1]], q))
    rows = [[columns[k][i] for k in range(n)] + [ring.one if i == 0 else ring.zero] for i in range(n)]
    return cancel_common(*solve_square(ring, rows))


def solve_square(ring: Ring, rows: list[Coefficients]) -> tuple[Coefficients, Poly]:
    """Solution of a square system as numerators and their common denominator, without fractions (Bareiss)."""
    n, last = len(rows), ring.one
    for k in range(n):
        pivot = next(i for i in range(k, n) if not rows[i][k].is_zero())
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for i in range(n):
            if i != k:
                rows[i] = [(rows[k][k] * x - rows[i][k] * y) / last for x, y in zip(rows[i], rows[k], strict=True)]
        last = rows[k][k]
    # Every diagonal entry is now the determinant (up to the sign of the row exchanges, which cancels).
    return [row[-1] for row in rows], last


def cancel_common(numerators: Coefficients, divisor: Poly) -> tuple[Coefficients, Poly]:
    """Numerators and divisor without their common factor."""
    common = divisor
    for numerator in numerators:
        common = common.gcd(numerator)
    return [numerator / common for numerator in numerators], divisor / common
