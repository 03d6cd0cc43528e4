"""What is known about the noise of a model: as little as the user knows, and no more.

A measurement error r(t) is described by one of the kinds below. They differ in what is known
about its correlation, and that decides which estimator is optimal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from navsym.core.errors import DomainError, ShapeError


@dataclass(frozen=True, slots=True)
class Uncorrelated:
    """White noise: E r(t) r(s) = intensity * delta(t - s), intensity in units^2 s."""

    intensity: sp.Expr


@dataclass(frozen=True, slots=True)
class ArbitraryCorrelation:
    """E r(t) = 0, E r(t)^2 <= sigma^2, and nothing known about E r(t) r(s) but |correlation| <= 1."""

    sigma: sp.Expr


@dataclass(frozen=True, slots=True)
class Markov:
    """Exponentially correlated noise: E r(t) r(s) = sigma^2 exp(-rate |t - s|), rate in 1/s."""

    sigma: sp.Expr
    rate: sp.Expr


@dataclass(frozen=True, slots=True)
class Constant:
    """One unknown number with standard deviation sigma: a bias."""

    sigma: sp.Expr


Kind = Uncorrelated | ArbitraryCorrelation | Markov | Constant


@dataclass(frozen=True, slots=True)
class Noise:
    """The noise of a model dx/dt = F x + G w, z = H x + r.

    process     : one kind for each component of w
    measurement : one kind for each component of r
    """

    process: tuple[Kind, ...] = ()
    measurement: tuple[Kind, ...] = ()

    @property
    def sigmas(self) -> tuple[sp.Expr, ...]:
        """Bounds of the standard deviations of r, one per measurement.

        DomainError when a component is white: its standard deviation is infinite.
        """
        for place, kind in enumerate(self.measurement):
            if isinstance(kind, Uncorrelated):
                raise DomainError(
                    f"measurement noise {place}: expected a bounded standard deviation; got white noise, "
                    "whose standard deviation is infinite; give sigma instead of an intensity"
                )
        return tuple(kind.sigma for kind in self.measurement if not isinstance(kind, Uncorrelated))


def arbitrary(sigmas: Sequence[sp.Expr]) -> Noise:
    """No process noise, and measurement errors of unknown correlation with the bounds ``sigmas``."""
    return Noise(measurement=tuple(ArbitraryCorrelation(sp.sympify(sigma, strict=True)) for sigma in exact(sigmas)))


def exact(values: Sequence[object]) -> Sequence[object]:
    """The same values, if none is text or a floating-point number."""
    for value in values:
        if not isinstance(value, int | sp.Expr) or (isinstance(value, sp.Expr) and value.has(sp.Float)):
            raise DomainError(f"sigma: expected exact numbers or symbols; got {value!r}; write sp.Rational")
    return values


def shaping(kind: Kind) -> tuple[sp.Expr, sp.Expr]:
    """Shaping filter of a scalar noise r: dr/dt = f r + g w with unit white w, as (f, g).

    Markov: f = -rate, g = sigma sqrt(2 rate); Constant: (0, 0). The others have none.
    Maybeck, Stochastic Models, Estimation and Control, vol. 1, chapter 4.
    """
    match kind:
        case Markov(sigma, rate):
            return -rate, sigma * sp.sqrt(2 * rate)
        case Constant():
            return sp.Integer(0), sp.Integer(0)
    raise ShapeError(f"noise: expected Markov or Constant; got {kind}; it has no shaping filter of one state")
