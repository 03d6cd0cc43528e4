"""Sums of sines and cosines as products, so that their signs can be read off exactly.

``2 cos(t - T/2) - 2 cos(T/2)`` becomes ``4 sin(t/2) sin((T - t)/2)``. In the generators
``z = exp(i angle)`` a trigonometric polynomial is an ordinary one: factor it there, and bring
every factor back to real form about its middle power. The product is returned only when the
normal form proves it equal to the sum, so that the factoring itself need not be trusted.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import sympy as sp
from flint import fmpq_mpoly

from navsym.core.exact import to_fraction, to_rational
from navsym.core.rational_functions import factor_exactly
from navsym.prove.identities.converter import Converter, vanishes_identically
from navsym.prove.identities.ingredients import Monomial, OutsideLanguageError

Exponents = tuple[int, ...]


def as_product(expression: sp.Expr) -> sp.Expr | None:
    """The expression as a product of real factors, or None when no factoring was found."""
    try:
        converter = Converter([expression])
    except OutsideLanguageError:
        return None
    if converter.roots or converter.atoms or not converter.found.angles:
        return None
    quotient = converter.convert(expression)
    top = real_factors(converter, quotient.numerator)
    bottom = real_factors(converter, quotient.denominator)
    if top is None or bottom is None or len(top) + len(bottom) < 2:
        return None
    product = sp.Mul(*top) / sp.Mul(*bottom)
    # The phases left out of the factors multiply to a rational constant.
    product *= constant_ratio(expression, product)
    return product if vanishes_identically(expression - product) else None


def as_squares(expression: sp.Expr, symbol: sp.Symbol) -> sp.Expr | None:
    """``a cos x + b sin x + c`` with ``a**2 + b**2 = c**2``, zero at one angle, as ``((a + c cos x)**2 + …) / (2 c)``.

    None for others, and for what has the symbol in other ways.
    """
    angles = {wave.args[0] for wave in expression.atoms(sp.sin, sp.cos) if wave.has(symbol)}
    if len(angles) != 1:
        return None
    cosine, sine = sp.cos(*angles), sp.sin(*angles)
    whole = sp.expand(expression)
    a, b = whole.coeff(cosine), whole.coeff(sine)
    c = sp.expand(whole - a * cosine - b * sine)
    if c == 0 or any(part.has(symbol) for part in (a, b, c)) or not vanishes_identically(c**2 - a**2 - b**2):
        return None
    return ((a + c * cosine) ** 2 + (b + c * sine) ** 2) / (2 * c)


def constant_ratio(expression: sp.Expr, product: sp.Expr) -> sp.Rational:
    """Guess the constant from one point, or 1; the guess is proved afterwards."""
    symbols = sorted(expression.free_symbols, key=str)
    point = {symbol: sp.Rational(7 + 4 * k, 10 + 3 * k) for k, symbol in enumerate(symbols)}
    value, base = complex(expression.subs(point).evalf(30)), complex(product.subs(point).evalf(30))
    ratio = Fraction((value / base).real).limit_denominator(4096) if base else 0
    return to_rational(ratio or Fraction(1))


def real_factors(converter: Converter, polynomial: fmpq_mpoly) -> list[sp.Expr] | None:
    """Real forms of the irreducible factors, without their phases and constants."""
    reduced = converter.reduce_unity(polynomial)
    if reduced.is_zero():
        return None
    real = [(real_form(converter, factor), multiplicity) for factor, multiplicity in factor_exactly(reduced)[1]]
    if any(form is None for form, _ in real):
        return None
    return [sp.Pow(form, multiplicity) for form, multiplicity in real if form != 1]


def real_form(converter: Converter, factor: fmpq_mpoly) -> sp.Expr | None:
    """A factor divided by its middle power: a sum of cosines, or i times a sum of sines."""
    terms = {tuple(int(e) for e in k): to_fraction(c) for k, c in factor.to_dict().items()}
    places = range(start := len(converter.found.symbols), start + len(converter.found.angles))
    if len(terms) == 1 and all(p in places or p == len(k) - 1 for k in terms for p, e in enumerate(k) if e):
        return sp.Integer(1)  # of modulus one: only z and the root of unity occur
    if any(exponents[-1] for exponents in terms):
        return None  # a root of unity inside the factor
    centre = {p: Fraction(min(k[p] for k in terms) + max(k[p] for k in terms), 2) for p in places}
    for parity in (1, -1):
        if is_symmetric(converter, terms, centre, parity):
            return rebuild_product(converter, terms, centre, parity)
    return None


def is_symmetric(
    converter: Converter, terms: Mapping[Exponents, Fraction], centre: Mapping[int, Fraction], parity: int
) -> bool:
    """Reflection of all angles about the middle power keeps (or negates) the coefficients."""
    mirrored = (tuple(int(2 * centre[p] - e) if p in centre else e for p, e in enumerate(powers)) for powers in terms)
    return all(terms.get(m) == parity * coefficient for m, coefficient in zip(mirrored, terms.values(), strict=True))


def rebuild_product(
    converter: Converter, terms: Mapping[Exponents, Fraction], centre: Mapping[int, Fraction], parity: int
) -> sp.Expr:
    function = sp.cos if parity == 1 else sp.sin
    total = sp.Integer(0)
    for exponents, coefficient in terms.items():
        angle = sum((angle_of(converter, p, exponents[p] - centre[p]) for p in centre), sp.Integer(0))
        total += to_rational(coefficient) * real_generators(converter, exponents) * function(angle)
    return total


def angle_of(converter: Converter, place: int, power: Fraction) -> sp.Expr:
    monomial, denominator = list(converter.found.angles.items())[place - len(converter.found.symbols)]
    share = sp.Rational(power.numerator, power.denominator * denominator)
    return share * monomial_expression(monomial)


def monomial_expression(monomial: Monomial) -> sp.Expr:
    """The monomial as a product of powers."""
    return sp.Mul(*(sp.Pow(base, to_rational(e)) for base, e in monomial))


def real_generators(converter: Converter, exponents: Exponents) -> sp.Expr:
    """Product of the powers of symbols and real exponentials in one term."""
    found, value = converter.found, sp.Integer(1)
    for place, (symbol, q) in enumerate(found.symbols.items()):
        value *= sp.Pow(symbol, sp.Rational(exponents[place], q))
    start = len(found.symbols) + len(found.angles)
    for place, (monomial, denominator) in enumerate(found.exponents.items()):
        power = sp.Rational(exponents[start + place], denominator)
        value *= sp.exp(power * monomial_expression(monomial))
    return value
