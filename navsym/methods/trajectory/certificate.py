"""Proof that minimum-sum weights are what they claim, in exact arithmetic.

The weights w of a derivative at zero satisfy sum w_i t_i^k = d! [k = d], k < n, with least sum |w_i| sigma_i. Both
bounds of that least value are exact rational numbers:

* above: on n nodes the conditions have one solution, the derivative of Lagrange's polynomials, in integers;
* below: every polynomial p of degree n - 1 with |p(t_i)| <= sigma_i at all rows gives d! p_d (weak duality);
  a proposed p is divided by its largest |p(t_i)|/sigma_i, so that no rounding of the proposal matters.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from navsym.numeric.arrays import Array

#: Times are read in this unit, as the windows round them.
UNIT = 10**6


@dataclass(frozen=True, slots=True)
class SumCertificate:
    """Exact bounds of the least sum |w| sigma, 1/s^d for times in seconds."""

    lower: Fraction
    upper: Fraction

    @property
    def gap(self) -> float:
        """Relative distance of the bounds."""
        return float((self.upper - self.lower) / self.upper)


def minimum_sum_certificate(
    dt: Array, sigma: Array, order: int, derivative: int, nodes: Sequence[int], dual: Sequence[float]
) -> SumCertificate:
    """Bounds of the least sum of absolute weights, whatever the solver did.

    dt, sigma : (m,) times (whole microseconds) and standard deviations
    nodes     : ``order`` rows that carry the weights
    dual      : (order,) coefficients of a polynomial in the time in units of the largest |dt|, lowest first
    """
    times = [round(float(t) * UNIT) for t in dt]
    deviations = [Fraction(float(s)) for s in sigma]
    scale = Fraction(math.factorial(derivative) * UNIT**derivative)
    total = sum(
        abs(weight) * deviations[node]
        for node, weight in zip(nodes, lagrange([times[node] for node in nodes], derivative), strict=True)
    )
    longest = max(map(abs, times)) or 1
    value, steepest = dual_value(times, deviations, dual, longest, derivative)
    lower = value / (steepest * longest**derivative)
    return SumCertificate(scale * lower, scale * total)


def lagrange(nodes: Sequence[int], derivative: int) -> list[Fraction]:
    """Coefficients of x^derivative in Lagrange's polynomials of different integer nodes."""
    found = []
    for i, own in enumerate(nodes):
        others = [node for k, node in enumerate(nodes) if k != i]
        coefficients = [1]
        for node in others:
            coefficients = [a - node * b for a, b in zip([0, *coefficients], [*coefficients, 0], strict=True)]
        found.append(Fraction(coefficients[derivative], math.prod(own - node for node in others)))
    return found


def dual_value(
    times: Sequence[int], deviations: Sequence[Fraction], dual: Sequence[float], longest: int, derivative: int
) -> tuple[Fraction, Fraction]:
    """(|p_d|, max |p(t_i)|/sigma_i) of a polynomial in t/longest with floating coefficients, exactly."""
    bits = 80
    whole = [round(Fraction(float(c)) * 2**bits) for c in dual]
    degree = len(whole) - 1
    powers = [longest ** (degree - k) for k in range(degree + 1)]
    steepest = Fraction(0)
    for t, sigma in zip(times, deviations, strict=True):
        value = 0
        for c, power in zip(reversed(whole), reversed(powers), strict=True):
            value = value * t + c * power
        steepest = max(steepest, abs(Fraction(value, longest**degree)) / sigma)
    return Fraction(abs(whole[derivative])), steepest
