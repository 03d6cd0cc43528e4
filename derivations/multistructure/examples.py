"""One small switching model, run exactly: scalar state, two modes, expressions in place of numbers."""

from dataclasses import dataclass
from fractions import Fraction

import sympy as sp
from flint import arb, ctx, fmpq

from navsym.claims import state
from navsym.language.expression import to_text
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


def convert(number, models, transitions, measurements, roots) -> tuple:
    """What :func:`run_exactly` takes, in another kind of numbers."""
    rows = [[Model(*([[number(value) for value in part[0]]] for part in parts_of(m))) for m in row] for row in models]
    switches = [[[number(value) for value in row] for row in matrix] for matrix in transitions]
    return rows, switches, roots, [[number(sp.Integer(value)) for value in row] for row in measurements]


def parts_of(model: Model) -> tuple:
    return model.F, model.Q, model.H, model.R


def enclosures(models, transitions, measurements, period) -> list[ExactStep]:
    """Steps in balls of a filter that folds after every ``period`` steps."""
    before, ctx.prec = ctx.prec, BITS
    try:
        roots = [Leaf((arb(1) / 2, arb(1) / 2), [arb(0)], [[arb(1)]])]
        return run_exactly(
            scheme("k-pulsating", period), *convert(ball, models, transitions, measurements, roots), BALLS
        )
    finally:
        ctx.prec = before


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """The last estimate of a filter: a ball; a text; ranges of the symbols in it, and statements that these are met."""

    ball: arb
    text: str
    box: dict[str, list]
    said: list[dict]


def estimate(models, transitions, measurements, period, tag="") -> Estimate:
    """What a filter ends with that folds all hypotheses into one Gaussian after every ``period`` steps.

    The numbers of that Gaussian are enclosed, wider from fold to fold, and are symbols in the next steps. Weights are
    not divided by their sum before a fold.
    """
    found, folded, box, said = enclosures(models, transitions, measurements, period), (), {}, []
    leaves, unit = common_start(0, 1), Fraction(1, 10**13)
    for k in range(len(measurements)):
        step_of = slice(k, k + 1)
        given = convert(sp.sympify, models[step_of], transitions[step_of], measurements[step_of], leaves)
        (step,) = run_exactly(scheme("exact"), *given, EXPRESSIONS)
        weights = [[x * step.likelihood for x in leaf.weights] for leaf in step.leaves]
        leaves = [Leaf(tuple(w), leaf.mean, leaf.covariance) for w, leaf in zip(weights, step.leaves, strict=True)]
        last = k + 1 == len(measurements)
        if (k + 1) % period and not last:
            continue
        folded = [to_text(value) for value in fold(leaves)]
        if last:
            return Estimate(found[-1].mean[0], folded[1], box, said)
        balls, symbols = found[k], sp.symbols(f"g{tag}{k} X{tag}{k} P{tag}{k}", real=True)
        own, ranges = (balls.probabilities[0], balls.mean[0], balls.covariance[0][0]), {}
        for symbol, text, value in zip(symbols, folded, own, strict=True):
            low = int((value / ball(unit)).floor().unique_fmpz()) * unit
            ends = str(low - unit), str(low + 2 * unit)
            ranges[symbol.name] = [*ends, []]
            said += [state(ends[0], "<=", text, box), state(text, "<=", ends[1], box)]
        g, X, P = symbols
        unit *= 100_000
        box, leaves = ranges, [Leaf((g, 1 - g), [X], [[P]])]
    raise ValueError("no measurements")


def fold(leaves: list[Leaf]) -> tuple:
    """The share of the first mode, mean and variance of a sum of Gaussians."""
    rows = [(sum(leaf.weights), leaf.mean[0], leaf.covariance[0][0]) for leaf in leaves]
    whole = sum(w for w, _, _ in rows)
    mean = sum(w * x for w, x, _ in rows) / whole
    return (
        sum(leaf.weights[0] for leaf in leaves) / whole,
        mean,
        sum(w * (v + (x - mean) ** 2) for w, x, v in rows) / whole,
    )


def run(method, models, transitions, measurements, *, depth=None, kit=EXPRESSIONS) -> list[ExactStep]:
    """Steps of a method, exactly."""
    return run_exactly(scheme(method, depth), models, transitions, common_start(0, 1), measurements, kit)


STICKY = [[sp.Rational(9, 10), sp.Rational(1, 10)], [sp.Rational(1, 10), sp.Rational(9, 10)]]
#: Nominal against a jump of the state.
CALM, JUMP = scalar(1, 0, 1, 1), scalar(1, 25, 1, 1)


def list_leaves(leaves) -> str:
    """Weights, means and variances of hypotheses as a text."""
    return f"[{', '.join(str(x) for leaf in leaves for x in (*leaf.weights, leaf.mean[0], leaf.covariance[0][0]))}]"
