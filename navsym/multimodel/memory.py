"""One step of the pulsating filter without storing partial estimates, and what memory that takes.

The paper promises that partial estimates go through one rebuilt Kalman filter into averaging adders. This
is that step, with every array that outlives a line taken from a :class:`Workspace` that counts them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.multimodel import moments as mixture
from navsym.multimodel.bank import Bank
from navsym.multimodel.kalman import steps as kalman

Array = NDArray[np.floating[Any]]


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
    sums = mixture.nothing(bank.states)
    for i in range(bank.modes):
        mean, P = kalman.predict(space.arrays["mean"], space.arrays["P"], bank.at("F", k)[i], bank.at("Q", k)[i])
        mean, P, log_likelihood = kalman.correct(mean, P, z, bank.at("H", k)[i], bank.at("R", k)[i])
        space.put("partial mean", mean)
        space.put("partial P", P)
        log_weight = float(mixture.logs(prior[i]) + log_likelihood)
        sums = mixture.accumulate(sums, log_weight, mean, P)  # multistructure:accumulate
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
