"""Conditions and words between the equations: why estimates are weighed, what is known when, which noise is meant."""

import sympy as sp

from navsym.claims import Equation, claim, claims
from navsym.multimodel.exact import Kit, run_exactly
from navsym.multimodel.schemes import scheme
from navsym_papers.multistructure import examples
from navsym_papers.multistructure.moments import mixture

SERIES = ([[3], [1]], [[3], [5]])
MODELS, SWITCHING = [[examples.CALM, examples.JUMP]], [examples.STICKY]


@claim("12.optimal")
def weighing_is_needed():
    """Below (13): the optimal estimate has to weigh: any other kappa adds (kappa - X)^2 [1 to 6 components]."""
    kappa = sp.Symbol("kappa", real=True)
    for size in range(1, 7):
        g, a, _, c = mixture(size)
        mean = sum(w * x for w, x in zip(g, a, strict=True))

        def mean_square(estimate: sp.Expr, g=g, a=a, c=c) -> sp.Expr:
            return sum(w * (v + (x - estimate) ** 2) for w, x, v in zip(g, a, c, strict=True))

        yield (kappa - mean) ** 2, mean_square(kappa) - mean_square(mean)


@claim("12.selection")
def what_selection_costs():
    """Taking the estimate of the likelier of two models instead adds (1 - g)^2 (X^1 - X^2)^2 to the mean square."""
    g, a, _, c = mixture(2)
    mean = g[0] * a[0] + g[1] * a[1]
    selected, weighed = (
        sum(w * (v + (x - estimate) ** 2) for w, x, v in zip(g, a, c, strict=True)) for estimate in (a[0], mean)
    )
    return Equation((1 - g[0]) ** 2 * (a[0] - a[1]) ** 2, selected - weighed)


def covariance_at(step: int, series: list[list[int]], kit: Kit = examples.EXPRESSIONS) -> sp.Expr:
    """P of a step of the pulsating filter, one model of two modes."""
    count, start = len(series), examples.common_start(0, 1)
    steps = run_exactly(scheme("pulsating", None), MODELS * count, SWITCHING * count, start, series, kit)
    return steps[step - 1].covariance[0][0]


CLAIMS = claims(
    "18.next | Below (18): (12) and (13) at step k give P(k+1), which does not depend on Y(k+1) (3 or 1, k = 0). | "
    "undecidable: (12) and (13) at step k give X(k) and P(k), or those of k+1 at the next step: + 1 is lost once "
    "or stands there once too often; P(k+1) of a switching signal depends on the measurement Y(k+1), through the "
    "weights; in the example P(1) is 0.574 larger for Y(1) = 3 than for Y(1) = 1",
    lambda: Equation(covariance_at(1, [[3]]), covariance_at(1, [[1]])),
)


@claim("18.next*")
def covariance_of_the_step():
    """Below (18): (12) and (13) at step k give P(k): it does not depend on Y(k+1) (1 or 5 after 3, any density)."""
    first, second = (covariance_at(1, series, examples.ANY_DENSITY) for series in SERIES)
    return Equation(first, second)


@claim("17.same")
def equal_models_are_one():
    """If all models are the same the pulsating filter is the Kalman filter, whatever p^ij is (2 steps, 2 modes)."""
    chain = [list(sp.symbols(f"p{i}1 p{i}2", positive=True)) for i in (1, 2)]
    one = examples.scalar(1, 2, 1, 3)
    variance, mean, printed = sp.Integer(1), sp.Integer(0), []
    for (measured,) in SERIES[0]:
        ahead = variance + 2
        gain = ahead / (ahead + 3)
        mean, variance = mean + gain * (measured - mean), (1 - gain) * ahead
        printed += [mean, variance]
    steps = run_exactly(
        scheme("pulsating", None),
        [[one, one]] * 2,
        [chain] * 2,
        examples.common_start(0, 1),
        SERIES[0],
        examples.ANY_DENSITY,
    )
    return Equation(printed, [x for step in steps for x in (step.mean[0], step.covariance[0][0])])
