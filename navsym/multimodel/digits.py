"""A bank over numbers of a hundred digits: the tree of :mod:`navsym.multimodel.exact` on the range of S."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from flint import arb, fmpz
from numpy.typing import NDArray

from navsym.core import arrays
from navsym.core.balls import precision
from navsym.multimodel.bank import Bank
from navsym.multimodel.engine import UNDERFLOW, Estimates
from navsym.multimodel.exact import Kit, Leaf, Model, run_exactly
from navsym.multimodel.kalman import Array
from navsym.multimodel.schemes import Scheme

BITS = 340
#: Binary exponent of the weight of a dimension that S lacks: beyond every density of doubles.
DIMENSION = 2**1100


def run_in_digits(rule: Scheme, models: Bank, z: Array, count: int) -> Estimates:
    """The same estimates as the other engines, over numbers of a hundred digits."""
    times = range(1, len(z) + 1)
    with precision(BITS), np.errstate(over="ignore"):
        steps = run_exactly(
            rule,
            [[Model(*(many(models.at(key, k)[i]) for key in "FQHR")) for i in range(models.modes)] for k in times],
            [many(models.at("mode_transition", k)) for k in times],
            first_leaves(rule, models),
            [[None if math.isnan(value) else arb(value) for value in row] for row in z.tolist()],
            Kit(density, arb.mid, rounded=True, weight=arb((fmpz(1), fmpz(DIMENSION)))),
        )
        logs = [log_of(step.likelihood) for step in steps]
        return Estimates(
            doubles([step.probabilities for step in steps]),
            doubles([step.mean for step in steps]),
            doubles([step.covariance for step in steps]),
            arrays.freeze(np.cumsum([0.0 if value == -np.inf else value for value in logs])),
            count,
            tuple(k for k, value in enumerate(logs, start=1) if value < UNDERFLOW),
            tuple(k for k, value in enumerate(logs, start=1) if value == -np.inf),
            engine="digits",
        )


def many(values: Array) -> Any:
    """Doubles as numbers of many digits, in nested lists."""
    return [many(row) for row in values] if values.ndim > 1 else [arb(value) for value in values.tolist()]


def first_leaves(rule: Scheme, models: Bank) -> list[Leaf]:
    """The hypotheses at step 0, as in :func:`navsym.multimodel.engine.first_hypotheses`."""
    prior = many(models.probabilities)
    if models.common and rule.branching != "own":
        return [Leaf(tuple(prior), many(models.means[0]), many(models.covariances[0]))]
    return [
        Leaf(
            tuple(g if i == j else arb(0) for j in range(models.modes)),
            many(models.means[i]),
            many(models.covariances[i]),
        )
        for i, g in enumerate(prior)
    ]


def density(distance: Any, determinant: Any, rank: int) -> Any:
    """(18) on the range of S; 0 where not even its logarithm is a double, and whole powers of two far out."""
    half = arb(distance) / 2
    if not half < 2.0**1022:
        return arb(0)
    far = half > 1e60
    exponential = arb((fmpz(1), -(half / arb.const_log2()).floor().mid().fmpz())) if far else (-half).exp()
    return exponential / ((2 * arb.pi()) ** rank * determinant).sqrt()


def log_of(likelihood: Any) -> float:
    """Log-likelihood of a step, without the weights of missing dimensions; -inf for a measurement that was left out."""
    if likelihood == 0:
        return -np.inf
    if not likelihood.is_finite():
        return np.nan
    _, exponent = likelihood.mid().man_exp()
    dimensions = (int(exponent) + DIMENSION // 2) // DIMENSION
    return float((likelihood * arb((fmpz(1), fmpz(-dimensions * DIMENSION)))).log())


def doubles(values: Any) -> NDArray[np.float64]:
    """Numbers in nested lists as an array of doubles."""

    def nested(value: Any) -> Any:
        return [nested(item) for item in value] if isinstance(value, list) else float(value)

    return arrays.freeze(np.array(nested(values)))
