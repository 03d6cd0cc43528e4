"""One small switching model, run exactly: scalar state, two modes, expressions in place of numbers."""

from dataclasses import dataclass
from fractions import Fraction

import sympy as sp
from flint import arb

from navsym.claims import state
from navsym.core.balls import enclose, exact_ball, hull
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


def scalar(F, Q, H, R) -> Model:
    """A mode of a scalar state."""
    return Model(*([[sp.Rational(value)]] for value in (F, Q, H, R)))


def common_start(mean, variance) -> list[Leaf]:
    """Both modes equally likely, one Gaussian."""
    return [Leaf((HALF, HALF), [sp.Rational(mean)], [[sp.Rational(variance)]])]


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
    leaves, unit, box, values, said = common_start(0, 1), Fraction(1, 10**13), {}, {}, []
    for k, row in enumerate(measurements, start=1):
        given = [models[k - 1]], [transitions[k - 1]], leaves, [[sp.Integer(value) for value in row]]
        (step,) = run_exactly(scheme("exact"), *given, EXPRESSIONS)
        weights = [[x * step.likelihood for x in leaf.weights] for leaf in step.leaves]
        leaves = [Leaf(tuple(w), leaf.mean, leaf.covariance) for w, leaf in zip(weights, step.leaves, strict=True)]
        if k % period and k < len(measurements):
            continue
        folded = fold(leaves)
        balls, texts = [enclose(value, values) for value in folded], [*map(to_text, folded)]
        if k == len(measurements):
            break
        g, X, P = symbols = sp.symbols(f"g{tag}{k} X{tag}{k} P{tag}{k}", real=True)
        before, box, values = box, {}, {}
        for symbol, text, value in zip(symbols, texts, balls, strict=True):
            low = int((value.mid() / exact_ball(unit)).floor().unique_fmpz()) * unit
            ends = str(low - unit), str(low + 2 * unit)
            box[symbol.name], values[symbol] = [*ends, []], hull(*map(sp.Rational, ends))
            said += [state(ends[0], "<=", text, before), state(text, "<=", ends[1], before)]
        unit, leaves = unit * 100_000, [Leaf((g, 1 - g), [X], [[P]])]
    return Estimate(balls[1], texts[1], box, said)


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
