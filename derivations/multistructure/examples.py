"""One small switching model, run exactly: scalar state, two modes, expressions in place of numbers."""

from decimal import Context, Decimal
from fractions import Fraction

import sympy as sp
from flint import arb, ctx, fmpq

from navsym.multimodel.exact import ExactStep, Kit, Leaf, Model, run_exactly
from navsym.multimodel.schemes import scheme

HALF = sp.Rational(1, 2)

#: Densities as exact expressions; the factor 2 pi is common to all and left out of the weights.
EXPRESSIONS = Kit(
    density=lambda distance, determinant, p: sp.exp(-sp.sympify(distance) / 2) / sp.sqrt(determinant),
    tidy=lambda value: value,
)


#: The same in balls, for what only has to be told apart.
BALLS = Kit(
    density=lambda distance, determinant, p: (-distance / 2).exp() / determinant.sqrt(), tidy=lambda value: value
)
BITS = 400
#: Digits that :func:`fractions_kit` keeps of exponentials, roots and merged moments.
DIGITS = 60


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


def ball(value) -> arb:
    """A rational number as a ball."""
    return arb(fmpq(value.numerator, value.denominator)) if not isinstance(value, arb) else value


def scalar(F, Q, H, R) -> Model:
    """A mode of a scalar state."""
    return Model(*([[sp.Rational(value)]] for value in (F, Q, H, R)))


def common_start(mean, variance) -> list[Leaf]:
    """Both modes equally likely, one Gaussian."""
    return [Leaf((HALF, HALF), [sp.Rational(mean)], [[sp.Rational(variance)]])]


def in_balls(matrix):
    return [[ball(value) for value in row] for row in matrix]


def enclosures(method, models, transitions, measurements, *, depth=None) -> list[arb]:
    """Balls around the estimates of the scalar state after every step."""
    before, ctx.prec = ctx.prec, BITS
    try:
        steps = run_exactly(
            scheme(method, depth),
            [[Model(*map(in_balls, (m.F, m.Q, m.H, m.R))) for m in row] for row in models],
            [in_balls(matrix) for matrix in transitions],
            [Leaf((arb(1) / 2, arb(1) / 2), [arb(0)], [[arb(1)]])],
            [[arb(value) for value in row] for row in measurements],
            BALLS,
        )
        return [step.mean[0] for step in steps]
    finally:
        ctx.prec = before


def run(method, models, transitions, measurements, *, depth=None, roots=None) -> list[ExactStep]:
    """Steps of a method, exactly."""
    return run_exactly(
        scheme(method, depth), models, transitions, roots or common_start(0, 1), measurements, EXPRESSIONS
    )


STICKY = [[sp.Rational(9, 10), sp.Rational(1, 10)], [sp.Rational(1, 10), sp.Rational(9, 10)]]
#: Nominal against a jump of the state.
CALM, JUMP = scalar(1, 0, 1, 1), scalar(1, 25, 1, 1)


def in_fractions(method, models, transitions, measurements, *, depth=None) -> list[ExactStep]:
    """Steps of a method in fractions, the densities to sixty digits."""
    half = Fraction(1, 2)
    return run_exactly(
        scheme(method, depth),
        [[Model(*map(fractions, (m.F, m.Q, m.H, m.R))) for m in row] for row in models],
        [fractions(matrix) for matrix in transitions],
        [Leaf((half, half), [Fraction(0)], [[Fraction(1)]])],
        [[Fraction(value) for value in row] for row in measurements],
        fractions_kit(),
    )


def fractions(matrix):
    return [[Fraction(int(value.numerator), int(value.denominator)) for value in row] for row in matrix]
