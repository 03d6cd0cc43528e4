"""One small switching model, run exactly: scalar state, two modes, expressions in place of numbers."""

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


#: For what needs nothing of (18), since equal models have equal densities: any function of the residual will do.
ANY_DENSITY = Kit(density=lambda distance, determinant, p: 1 / (determinant * (1 + distance)), tidy=sp.cancel)

#: The same in balls, for what only has to be told apart.
BALLS = Kit(
    density=lambda distance, determinant, p: (-distance / 2).exp() / determinant.sqrt(), tidy=lambda value: value
)
BITS = 400


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


def run(method, models, transitions, measurements, *, depth=None, kit=EXPRESSIONS) -> list[ExactStep]:
    """Steps of a method, exactly."""
    return run_exactly(scheme(method, depth), models, transitions, common_start(0, 1), measurements, kit)


STICKY = [[sp.Rational(9, 10), sp.Rational(1, 10)], [sp.Rational(1, 10), sp.Rational(9, 10)]]
#: Nominal against a jump of the state.
CALM, JUMP = scalar(1, 0, 1, 1), scalar(1, 25, 1, 1)
