"""Numbers for the tree of hypotheses: fractions, and the densities of (18) to sixty digits."""

from decimal import Context, Decimal
from fractions import Fraction

import numpy as np

from navsym.multimodel.exact import Kit

#: Digits that :func:`fractions_kit` keeps of exponentials, roots and merged moments.
DIGITS = 60


def rational(rng, *shape):
    """Small random fractions as an object array."""
    numerators, denominators = rng.integers(-6, 7, shape), rng.integers(1, 5, shape)
    return np.vectorize(lambda a, b: Fraction(int(a), int(b)), otypes=[object])(numerators, denominators)


def fractions_kit() -> Kit:
    """Fractions; densities and merged moments rounded to sixty digits."""
    context = Context(prec=DIGITS, Emin=-(10**9), Emax=10**9)
    two_pi = Decimal("6.283185307179586476925286766559005768394338798750211641949889184615632812572")

    def density(distance: Fraction, determinant: Fraction, p: int) -> Fraction:
        exponent = context.exp(as_decimal(-distance / 2, context))
        root = context.sqrt(context.multiply(as_decimal(determinant, context), context.power(two_pi, p)))
        return Fraction(context.divide(exponent, root))

    def tidy(value: Fraction) -> Fraction:
        return Fraction(as_decimal(value, context))

    return Kit(density, tidy)


def as_decimal(value: Fraction, context: Context) -> Decimal:
    """A fraction to the digits of the context."""
    return context.divide(Decimal(value.numerator), Decimal(value.denominator))
