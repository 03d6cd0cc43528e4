"""One step of the pulsating filter without storing partial estimates, and what memory that takes.

The paper promises that partial estimates go through one rebuilt Kalman filter into averaging adders. This
is that step, with every array that outlives a line taken from a :class:`Workspace` that counts them.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.multimodel import kalman
from navsym.multimodel import kalman as mixture
from navsym.multimodel.bank import Bank

Array = NDArray[np.floating[Any]]


@dataclass(frozen=True, slots=True, eq=False)
class Moments:
    """Running sums of a mixture: what the paper's averaging adders hold.

    log_weight : log of the sum of the weights so far
    mean       : (n,)   mean so far
    covariance : (n, n) covariance so far, already divided by the sum of the weights
    """

    log_weight: float
    mean: Array
    covariance: Array


def nothing(n: int) -> Moments:
    """Moments before the first component."""
    return Moments(-np.inf, np.zeros(n), np.zeros((n, n)))


def accumulate(sums: Moments, log_weight: float, mean: Array, P: Array) -> Moments:
    """Add one component and forget it: multistructure:accumulate.

    With g the share of the newcomer in the new total and d = mean - old mean:
    ``m + g d`` and ``(1 - g) C + g P + g (1 - g) d d^T``. Every term is semidefinite, nothing is subtracted,
    so no digits are lost where second moments about zero would lose all of them. Weights stay unnormalised
    logarithms until the last component has come.
    """
    if log_weight == -np.inf:
        return sums
    total = float(np.logaddexp(sums.log_weight, log_weight))
    share = float(np.exp(log_weight - total))
    rest = float(np.exp(sums.log_weight - total))
    d = mean - sums.mean
    covariance = rest * sums.covariance + share * P + share * rest * np.outer(d, d)
    return Moments(total, sums.mean + share * d, covariance)


@dataclass(slots=True)
class Workspace:
    """Arrays by name, taken once, and the number of floats they hold."""

    arrays: dict[str, Array] = field(default_factory=dict)

    def put(self, name: str, value: Any) -> Array:
        """Keep a copy of a value under a name, in place of what was there; the copy, an array of floats."""
        self.arrays[name] = np.array(value, dtype=float)
        return self.arrays[name]

    @property
    def floats(self) -> int:
        """Floats that all arrays hold together."""
        return sum(array.size for array in self.arrays.values())


def kalman_step(bank: Bank, k: int, z: Array, space: Workspace) -> None:
    """One Kalman filter, in place: mean and covariance of the step before are overwritten."""
    mean, P = kalman.predict(space.arrays["mean"], space.arrays["P"], bank.at("F", k)[0], bank.at("Q", k)[0])
    mean, P, _ = kalman.correct(mean, P, z, bank.at("H", k)[0], bank.at("R", k)[0])
    space.put("mean", mean)
    space.put("P", P)


def pulsating_step(bank: Bank, k: int, z: Array, space: Workspace) -> float:
    """One step of (12), (13), (17) in one pass over the models; returns the log-likelihood of z.

    Alive at once: the estimate before (every model starts from it), the partial estimate of the model at
    work, the adders, and one probability per mode.
    """
    prior = space.put("probabilities", space.arrays["probabilities"] @ bank.at("mode_transition", k))
    sums = nothing(bank.states)
    for i in range(bank.modes):
        mean, P = kalman.predict(space.arrays["mean"], space.arrays["P"], bank.at("F", k)[i], bank.at("Q", k)[i])
        mean, P, log_likelihood = kalman.correct(mean, P, z, bank.at("H", k)[i], bank.at("R", k)[i])
        space.put("partial mean", mean)
        space.put("partial P", P)
        log_weight = float(mixture.logs(prior[i]) + log_likelihood)
        sums = accumulate(sums, log_weight, mean, P)  # multistructure:accumulate
        space.put("sum of weights", sums.log_weight)
        space.put("sum of means", sums.mean)
        space.put("sum of P", sums.covariance)
        prior[i] = log_weight
    space.put("probabilities", mixture.normalise(prior)[0])  # multistructure:17
    space.put("mean", sums.mean)
    space.put("P", sums.covariance)
    return sums.log_weight


def floats_in_use(bank: Bank, z: Array) -> tuple[int, int]:
    """Floats that one Kalman filter and the one-pass pulsating filter keep through a step."""
    single = Workspace({"mean": bank.means[0], "P": bank.covariances[0]})
    kalman_step(bank, 1, z, single)
    start = {"mean": bank.means[0], "P": bank.covariances[0], "probabilities": bank.probabilities}
    pulsating = Workspace(dict(start))
    pulsating_step(bank, 1, z, pulsating)
    return single.floats, pulsating.floats
