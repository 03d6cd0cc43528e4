"""Least errors of a derivative that positions can guarantee, and the rules that reach them.

Errors of position are anything within +-noise; of the motion one derivative is known to stay within +-bound. The
least error that any algorithm can guarantee, and the two or three ages of positions that reach it, are closed
forms (trajectory:limit.velocity.acceleration.lower, .upper, and the same for the jerk).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from navsym.core.answers import Answer, named
from navsym.core.arrays import Array, as_array, freeze, without_units
from navsym.core.errors import DomainError, TooLargeError
from navsym.core.tables import Table
from navsym.language.names import quote

#: (derivative, order): factor of noise^(1 - d/m) bound^(d/m) in the least error.
CONSTANTS = {(1, 2): 2.0, (1, 3): (243 / 8) ** (1 / 3), (2, 3): 24 ** (1 / 3)}

#: The same least error as a formula of the language of files.
FORMULAS = {
    (1, 2): "2*sqrt(noise*acceleration)",
    (1, 3): "(243/8*noise**2*jerk)**(1/3)",
    (2, 3): "(24*noise*jerk**2)**(1/3)",
}
#: Order of the derivative that is bounded -> its name and unit; derivative that is asked for -> its name and unit.
BOUNDED = {2: ("acceleration", "m/s^2"), 3: ("jerk", "m/s^3")}
ASKED = {1: ("velocity", "m/s"), 2: ("acceleration", "m/s^2")}

#: Samples that are looked at on either side of an optimal age.
NEAR = 3
MOST_POSITIONS = 1_000_000
#: Noise and bound lie between this and its inverse, so that no power of them leaves the range of a double.
LEAST = 1e-50


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

    @property
    def error(self) -> float:
        """The guaranteed error."""
        return self.noise + self.motion

    def document(self) -> dict[str, Any]:
        """The rule as plain data."""
        return named(self, "ages weights error noise motion")


@dataclass(frozen=True, slots=True, eq=False)
class Limit:
    """The least error of one derivative, and a rule that reaches it.

    derivative : ``velocity`` or ``acceleration``; unit : of the error
    least_error, formula, claims : None, None and () for a rule of sampled positions
    """

    derivative: str
    unit: str
    rule: Rule
    least_error: float | None = None
    formula: str | None = None
    claims: tuple[str, ...] = ()

    def document(self) -> dict[str, Any]:
        """The limit as plain data; a sampled rule has no formula of its own."""
        formula = "" if self.formula is None else "least_error formula"
        return named(self, f"derivative unit {formula} rule {'claims' if self.claims else ''}")


@dataclass(frozen=True, slots=True, eq=False)
class Sampled:
    """The best rules among positions that come every ``step`` seconds; positions : how many are at hand."""

    step: float
    positions: int
    limits: tuple[Limit, ...]

    def document(self) -> dict[str, Any]:
        """The sampled rules as plain data."""
        return named(self, "step positions limits")


@dataclass(frozen=True, slots=True, eq=False)
class Limits(Answer):
    """Least guaranteed errors of the derivatives below the bounded one; the answer of :func:`limits`.

    noise   : largest error of a position, m; bounded, bound : the bounded derivative and its bound
    limits  : one :class:`Limit` for each derivative; sampled : None without a step
    """

    noise: float
    bounded: str
    bound: float
    limits: tuple[Limit, ...]
    sampled: Sampled | None = None

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym limits``."""
        return named(self, "noise bounded bound limits sampled")

    def __repr__(self) -> str:
        errors = ", ".join(f"{part.derivative} {part.rule.error:.6g} {part.unit}" for part in self.limits)
        return f"<Limits: {errors}>"

    def table(self) -> Table:
        """What can be guaranteed of each derivative."""
        rows = [(part.derivative, f"{part.rule.error:.6g} {part.unit}", part.formula) for part in self.limits]
        return ("derivative", "least guaranteed error", "formula"), rows


def limits(
    noise: float,
    *,
    acceleration: float | None = None,
    jerk: float | None = None,
    step: float | None = None,
    memory: float | None = None,
) -> Limits:
    """The least errors of velocity and acceleration that any algorithm can guarantee from positions.

    noise        : largest error of a position, m
    acceleration : largest acceleration of the motion, m/s^2; or
    jerk         : largest rate of the acceleration, m/s^3
    step         : positions come every so many seconds; adds the best rules among them
    memory       : seconds of positions at hand, with ``step``; default: as many as help

    A velocity under a bounded acceleration has the least error ``2 sqrt(noise acceleration)``, reached by two
    positions ``2 sqrt(noise/acceleration)`` seconds apart; a bounded jerk has two limits, reached by three positions.

    Returns :class:`Limits`. Raises NavsymError of the kinds ``domain`` and ``too-large``. Source: the claims that the
    answer names, trajectory:limit.velocity.acceleration.lower and its like.

    >>> import navsym as nav
    >>> nav.limits(5, acceleration=0.5)
    <Limits: velocity 3.16228 m/s>
    >>> nav.limits(5, acceleration=0.5, step=1).sampled.limits[0].rule.ages.tolist()
    [0.0, 6.0]
    """
    order, bound = bounded_derivative(acceleration, jerk)
    noise, bound = real_number(noise, "noise", "m"), real_number(bound, BOUNDED[order][0], f"m/s^{order}")
    step, memory = (v if v is None else real_number(v, name, "s") for v, name in ((step, "step"), (memory, "memory")))
    for name, value in (("noise", noise), (BOUNDED[order][0], bound)):
        if not LEAST < value < 1 / LEAST:
            between = f"a positive number between {LEAST:g} and {1 / LEAST:g}"
            message = f"expected {between}; got {value:g}; give the largest absolute value"
            raise DomainError(message, where=f"limits: {name}")
    rows = tuple(limit_of(noise, bound, derivative, order) for derivative in range(1, order))
    return Limits(noise, BOUNDED[order][0], bound, rows, sampled_limits(noise, bound, order, step, memory))


def real_number(value: Any, name: str, unit: str) -> float:
    """The number itself, a quantity of pint in a unit; DomainError for what is none, with the name of the argument."""
    value = without_units(value, f"limits: {name}", unit)
    if isinstance(value, bool) or not isinstance(value, int | float | np.number):
        raise DomainError(f"expected a number; got {quote(value)}; give one", where=f"limits: {name}")
    return float(value)


def bounded_derivative(acceleration: float | None, jerk: float | None) -> tuple[int, float]:
    """Order of the derivative that is known to stay within a bound, and the bound."""
    if acceleration is not None and jerk is None:
        return 2, acceleration
    if jerk is not None and acceleration is None:
        return 3, jerk
    got = "neither" if jerk is None else "both"
    message = f"expected one of acceleration and jerk; got {got}; bound one derivative of the motion"
    raise DomainError(message, where="limits: acceleration, jerk")


def limit_of(noise: float, bound: float, derivative: int, order: int) -> Limit:
    """The least error of a derivative, and the rule that reaches it."""
    name, unit = ASKED[derivative]
    claims = f"trajectory:limit.{name}.{BOUNDED[order][0]}"
    return Limit(
        name,
        unit,
        rule(best_ages(noise, bound, order), noise, bound, derivative),
        least_error(noise, bound, derivative, order),
        FORMULAS[derivative, order],
        (f"{claims}.lower", f"{claims}.upper"),
    )


def sampled_limits(noise: float, bound: float, order: int, step: float | None, memory: float | None) -> Sampled | None:
    """The best rules among positions that come at a rate; None without one."""
    if step is None:
        if memory is not None:
            message = "expected a step with it; got a memory alone; give the seconds between positions"
            raise DomainError(message, where="limits: memory")
        return None
    ages = available_ages(noise, bound, order, step, memory)
    rules = tuple(Limit(*ASKED[d], best_rule(ages, noise, bound, d, order)) for d in range(1, order))
    return Sampled(step, len(ages), rules)


def available_ages(noise: float, bound: float, order: int, step: float, memory: float | None) -> Array:
    """Ages of the positions at hand, (n,) seconds: no more of them than can help."""
    for name, value in (("step", step), ("memory", memory)):
        if value is not None and not (math.isfinite(value) and value > 0):
            message = f"expected a positive number of seconds; got {value}; correct it"
            raise DomainError(message, where=f"limits: {name}")
    useful = float(best_ages(noise, bound, order)[-1]) / step + NEAR
    count = min(useful, math.inf if memory is None else memory / step * (1 + 1e-12))
    if count >= MOST_POSITIONS:
        message = f"expected at most {MOST_POSITIONS} positions; got about {count:.3g}; give a longer step"
        raise TooLargeError(message, where="limits: step")
    if count < order - 1:
        message = f"expected at least {order} positions; got {math.floor(count) + 1}; remember more of them"
        raise DomainError(message, where="limits: memory")
    return np.arange(math.floor(count) + 1, dtype=float) * step


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
    ages = as_array("ages", ages, (None,), "one for each position")
    check(noise, bound, derivative, len(ages))
    if ages[0] != 0 or not (np.diff(ages) > 0).all():
        raise DomainError(f"ages: expected ages that rise from 0; got {ages.tolist()}; give the newest position first")
    weights = freeze(np.array([cardinal(ages, i, derivative) for i in range(len(ages))]))
    older = ages[1:]
    integral = older.sum() / 3 if derivative == 2 else older.prod() / math.factorial(len(ages))
    return Rule(ages, weights, noise * float(np.abs(weights).sum()), bound * float(integral))


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
    available = as_array("available", available, (None,), "one for each position")
    if len(available) < order:
        raise DomainError(f"available: expected at least {order} positions; got {len(available)}; wait for more")
    near = set(range(len(available) - order + 1, len(available)))
    for age in best_ages(noise, bound, order)[1:]:
        middle = int(np.searchsorted(available, age))
        near.update(range(max(1, middle - NEAR), min(len(available), middle + NEAR)))
    choices = (available[[0, *others]] for others in combinations(sorted(near), order - 1))
    return min((rule(ages, noise, bound, derivative) for ages in choices), key=lambda choice: choice.error)


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
