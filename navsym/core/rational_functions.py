"""Rational functions as quotients of flint's polynomials: from sympy, their arithmetic, and back.

The rings of the callers differ (over the integers or the rationals, angles by halves or by relations); what is
common to all stands here. A generator of a ring stands for an expression, its name.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import sympy as sp
from flint import fmpq_mpoly, fmpq_mpoly_ctx

from navsym.core.errors import DomainError
from navsym.core.exact import to_rational

Poly = Any  # fmpz_mpoly or fmpq_mpoly


class Quotient(NamedTuple):
    """``top / bottom``; the bottom is not the zero polynomial."""

    top: Poly
    bottom: Poly


def cancel_fraction(top: Poly, bottom: Poly) -> Quotient:
    """The quotient in lowest terms.

    The leading coefficient below is positive over the integers and one over the rationals.
    """
    if top == 0:
        return Quotient(top, bottom.context().constant(1))
    if bottom != 1:
        common = top.gcd(bottom)
        top, bottom = top / common, bottom / common
    lead = bottom.leading_coefficient()
    if isinstance(bottom, fmpq_mpoly):
        return Quotient(top / lead, bottom / lead)
    return Quotient(-top, -bottom) if lead < 0 else Quotient(top, bottom)


def factor_exactly(poly: Poly) -> tuple[Any, list[tuple[Poly, int]]]:
    """Content and irreducible factors with their multiplicities; the one call of flint's factorisation.

    Over the integers flint 0.9 sorts the factors through a machine integer and overflows for two with equal monomials
    whose coefficients differ by 2^31 or more, such as ``x - 7292115`` and ``x + 7292115`` beside a scale of 1e11.
    The factors are the same over the rationals, where it does not.

    >>> from flint import Ordering, fmpz_mpoly_ctx
    >>> x = fmpz_mpoly_ctx.get(("x",), Ordering.lex).gen(0)
    >>> factor_exactly(3 * (10**12 * x - 7) * (10**12 * x + 7))
    (3, [(1000000000000*x - 7, 1), (1000000000000*x + 7, 1)])
    """
    try:
        content, parts = poly.factor()
    except OverflowError:
        context = poly.context()
        wider = fmpq_mpoly_ctx.get(context.names(), context.ordering())
        parts = [
            (context.from_dict({e: int(c) for e, c in base.to_dict().items()}).primitive()[1], power)
            for base, power in wider.from_dict(poly.to_dict()).factor()[1]
        ]
        whole = context.constant(1)
        for base, power in parts:
            whole = whole * base ** int(power)
        content = (poly / whole).leading_coefficient()
    return content, [(base, int(power)) for base, power in parts]


def add_fractions(first: Quotient, *others: Quotient) -> Quotient:
    """Sum of quotients in lowest terms."""
    top, bottom = first
    for part in others:
        if part.bottom == bottom:
            top = top + part.top
        else:
            rest = part.bottom / part.bottom.gcd(bottom)  # a product of all bottoms could grow without end
            top, bottom = top * rest + part.top * (bottom * rest / part.bottom), bottom * rest
    return cancel_fraction(top, bottom)


def multiply_fractions(first: Quotient, *others: Quotient) -> Quotient:
    """Product of quotients in lowest terms."""
    top, bottom = first
    for part in others:
        top, bottom = top * part.top, bottom * part.bottom
    return cancel_fraction(top, bottom)


class Ratio:
    """A quotient with the operations of numbers; a number beside it is lifted.

    >>> x = fmpq_mpoly_ctx.get(("x",), "lex").gen(0)
    >>> (1 / Ratio(Quotient(x, x * 0 + 1)) - 1).quotient
    Quotient(top=-x + 1, bottom=x)
    """

    __slots__ = ("quotient",)

    def __init__(self, quotient: Quotient):
        self.quotient = quotient

    def lift(self, other: Any) -> Ratio:
        """A number as a quotient."""
        top, bottom = self.quotient
        return other if isinstance(other, Ratio) else type(self)(Quotient(top * 0 + other, bottom * 0 + 1))

    def __add__(self, other: Any) -> Ratio:
        return type(self)(add_fractions(self.quotient, self.lift(other).quotient))

    def __mul__(self, other: Any) -> Ratio:
        return type(self)(multiply_fractions(self.quotient, self.lift(other).quotient))

    __radd__, __rmul__ = __add__, __mul__

    def __neg__(self) -> Ratio:
        return self * -1

    def __sub__(self, other: Any) -> Ratio:
        return self + self.lift(other) * -1

    def __truediv__(self, other: Any) -> Ratio:
        top, bottom = self.lift(other).quotient
        return type(self)(multiply_fractions(self.quotient, cancel_fraction(bottom, top)))

    def __rtruediv__(self, other: Any) -> Ratio:
        return self.lift(other) / self

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Ratio):
            return self.quotient == other.quotient
        return bool(self.quotient.top == other and self.quotient.bottom == 1)

    __hash__ = None  # type: ignore[assignment]


def raise_fraction(base: Quotient, exponent: int) -> Quotient:
    """Integer power of a quotient; DomainError for a negative power of zero."""
    if exponent >= 0:
        return Quotient(base.top**exponent, base.bottom**exponent)
    if base.top == 0:
        raise DomainError("expected a nonzero divisor; got 0; mend the entry")
    return cancel_fraction(base.bottom**-exponent, base.top**-exponent)


def read_arithmetic(expression: sp.Basic, context: Any, convert: Callable[[sp.Basic], Quotient]) -> Quotient | None:
    """The quotient of a number, sum, product or integer power; None for anything else.

    context : the ring of flint; convert : how the caller reads the parts
    """
    if isinstance(expression, sp.Rational):
        return cancel_fraction(context.constant(int(expression.p)), context.constant(int(expression.q)))
    if isinstance(expression, sp.Add):
        return add_fractions(*map(convert, expression.args))
    if isinstance(expression, sp.Mul):
        return multiply_fractions(*map(convert, expression.args))
    if isinstance(expression, sp.Pow) and isinstance(expression.exp, sp.Integer):
        return raise_fraction(convert(expression.base), int(expression.exp))
    return None


def clear_denominators(rows: Sequence[Sequence[Quotient]], one: Poly) -> tuple[list[list[Poly]], Poly]:
    """Entries times their least common denominator, and that denominator."""
    bottom = one
    for q in (q for row in rows for q in row if q.bottom != 1):
        bottom = bottom * (q.bottom / q.bottom.gcd(bottom))
    return [[q.top if q.bottom == bottom else q.top * (bottom / q.bottom) for q in row] for row in rows], bottom


def powers_apart(poly: Poly, *places: int) -> dict[tuple[int, ...], Poly]:
    """Coefficients of a polynomial by the powers of some of its generators."""
    parts: dict[tuple[int, ...], dict[tuple[int, ...], Any]] = {}
    for powers, coefficient in poly.to_dict().items():
        rest = tuple(0 if k in places else power for k, power in enumerate(powers))
        parts.setdefault(tuple(int(powers[k]) for k in places), {})[rest] = coefficient
    return {powers: poly.context().from_dict(terms) for powers, terms in parts.items()}


def multiply_coefficients(left: Sequence[Poly], right: Sequence[Poly]) -> list[Poly]:
    """Product of two polynomials in one variable given by their coefficients, in either order of powers."""
    result = [0 * left[0]] * (len(left) + len(right) - 1)
    for i, a in enumerate(left):
        for j, b in enumerate(right):
            result[i + j] = result[i + j] + a * b
    return result


def replace_square(poly: Poly, place: int, square: Poly) -> Poly:
    """The polynomial with the square of one generator replaced."""
    total, generator = 0 * poly, poly.context().gen(place)
    for (power,), rest in powers_apart(poly, place).items():
        total += rest * square ** (power // 2) * generator ** (power % 2)
    return total


def polynomial_sum(names: Sequence[sp.Basic], poly: Poly, divisor: int = 1) -> sp.Expr:
    """A polynomial, divided by a number, as a sympy sum of monomials in the names of its generators.

    Generators behind the last name do not occur in the polynomial.
    """
    return sp.Add(
        *(
            sp.Mul(to_rational(coefficient) / divisor, *(g ** int(e) for g, e in zip(names, powers, strict=False) if e))
            for powers, coefficient in poly.to_dict().items()
        )
    )
