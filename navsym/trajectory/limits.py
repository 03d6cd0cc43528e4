"""What positions can guarantee about a derivative, and the rule that guarantees it.

Errors of position are anything within +-noise; of the motion one derivative is known to stay within +-bound. The
least error that any algorithm can guarantee, and the two or three ages of positions that reach it, are closed
forms (trajectory:limit.velocity.acceleration.lower, .upper, and the same for the jerk).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from navsym.core.arrays import Array, named
from navsym.core.errors import DomainError

#: (derivative, order): factor of noise^(1 - d/m) bound^(d/m) in the least error.
CONSTANTS = {(1, 2): 2.0, (1, 3): (243 / 8) ** (1 / 3), (2, 3): 24 ** (1 / 3)}

#: Samples that are looked at on either side of an optimal age.
NEAR = 3


@dataclass(frozen=True, slots=True, eq=False)
class Rule:
    """A derivative now as a sum of weighted positions.

    ages    : (k,) seconds before now, the first is 0
    weights : (k,) in 1/s^derivative
    noise   : what errors of position contribute at most
    motion  : what the unknown motion contributes at most
    """

    ages: Array
    weights: Array
    noise: float
    motion: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "ages", named("ages", self.ages, (None,), "one for each position"))
        object.__setattr__(self, "weights", named("weights", self.weights, np.shape(self.ages), "one for each age"))

    @property
    def error(self) -> float:
        """The guaranteed error."""
        return self.noise + self.motion


def least_error(noise: float, bound: float, derivative: int = 1, order: int = 2) -> float:
    """The least error of x^(derivative) now that any algorithm guarantees, from positions of any number and age.

    noise : abs(error) of every position; bound : abs(x^(order)), order 2 (acceleration) or 3 (jerk), derivative
    below the order. 2 sqrt(noise bound) for the velocity under a bounded acceleration. Raises DomainError.
    """
    check(noise, bound, derivative, order)
    share = derivative / order
    return CONSTANTS[derivative, order] * noise ** (1 - share) * bound**share


def best_ages(noise: float, bound: float, order: int = 2) -> Array:
    """Ages (order,) of the positions that reach the least error; the last one is the longest memory that helps.

    Order 2: 0 and 2 sqrt(noise/bound). Order 3: 0, a third of, and (81 noise/bound)^(1/3). For each derivative alike.
    Raises DomainError.
    """
    check(noise, bound, 1, order)
    if order == 2:
        return np.array([0.0, 2 * math.sqrt(noise / bound)])
    return np.array([0.0, 1 / 3, 1.0]) * math.cbrt(81 * noise / bound)


def rule(ages: Array, noise: float, bound: float, derivative: int = 1) -> Rule:
    """The derivative of the polynomial through positions of these ages, with its guaranteed error.

    ages : (2,) or (3,), rising from 0; their number is the order of the bounded derivative. Peano's kernel is a
    divided difference's, hence positive, and its integral an elementary symmetric function of the ages.
    Raises DomainError when the ages do not rise from 0.
    """
    ages = named("ages", ages, (None,), "one for each position")
    check(noise, bound, derivative, len(ages))
    if ages[0] != 0 or not (np.diff(ages) > 0).all():
        raise DomainError(f"ages: expected ages that rise from 0; got {ages.tolist()}; give the newest position first")
    found = np.array([cardinal(ages, i, derivative) for i in range(len(ages))])
    older = ages[1:]
    integral = older.sum() / 3 if derivative == 2 else older.prod() / math.factorial(len(ages))
    return Rule(ages, found, noise * float(np.abs(found).sum()), bound * float(integral))


def cardinal(ages: Array, own: int, derivative: int) -> float:
    """Derivative at age 0 of the polynomial that is one at an age and zero at the others."""
    others = np.delete(ages, own)
    coefficients = np.poly(-others)[::-1] / np.prod(others - ages[own])
    return float(coefficients[derivative] * math.factorial(derivative))


def best_rule(available: Array, noise: float, bound: float, derivative: int = 1, order: int = 2) -> Rule:
    """The best rule among positions that exist: ages (n,) rising from 0, at least ``order`` of them.

    Samples next to the optimal ages, and the oldest, are tried in all combinations; the answer says what it guarantees.
    Raises DomainError.
    """
    available = named("available", available, (None,), "one for each position")
    if len(available) < order:
        raise DomainError(f"available: expected at least {order} positions; got {len(available)}; wait for more")
    near = set(range(len(available) - order + 1, len(available)))
    for age in best_ages(noise, bound, order)[1:]:
        middle = int(np.searchsorted(available, age))
        near.update(range(max(1, middle - NEAR), min(len(available), middle + NEAR)))
    choices = (available[[0, *others]] for others in combinations(sorted(near), order - 1))
    return min((rule(ages, noise, bound, derivative) for ages in choices), key=lambda found: found.error)


def check(noise: float, bound: float, derivative: int, order: int) -> None:
    """Refuse what has no closed form, and bounds that are not positive numbers."""
    if (derivative, order) not in CONSTANTS:
        raise DomainError(
            f"derivative, order: expected one of {sorted(CONSTANTS)}; got {(derivative, order)}; "
            "bound a derivative above the one that is asked for"
        )
    for name, value in (("noise", noise), ("bound", bound)):
        if not (math.isfinite(value) and value > 0):
            raise DomainError(f"{name}: expected a positive number; got {value}; give the largest absolute value")
