"""What the closed form of a transition matrix is made of: waves, surds and roots.

A wave is a function of time times a constant whose rational and irrational parts are kept apart,
so that constants of one wave add up and cancel exactly.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import sympy as sp

from navsym.core.rational_functions import cancel_fraction, polynomial_sum
from navsym.models.transition.rings import (
    Coefficients,
    Fraction,
    Poly,
    Ring,
    declared_sign,
    split_square_root,
    write_quotient,
)

#: The variable of characteristic polynomials; a name that no parameter has.
LAMBDA = sp.Symbol("eigenvalue")


@dataclass(frozen=True, slots=True, eq=False)
class Surd:
    """An irrational constant; its square is the polynomial ``radicand`` when that is given."""

    value: sp.Expr
    radicand: Poly | None = None


RATIONAL = Surd(sp.S.One)
#: A constant, its rational and its irrational part.
Factor = tuple[Fraction, Surd]


@dataclass(frozen=True, slots=True, eq=False)
class Wave:
    """function(t) * weight * surd: one function of time with its constant factor."""

    function: sp.Expr
    weight: Fraction
    surd: Surd = RATIONAL


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """(sum of waves) * poly(mu)."""

    waves: tuple[Wave, ...]
    poly: Coefficients


@dataclass(frozen=True, slots=True, eq=False)
class Form:
    """Closed form of one factor: the monic factor in mu, its multiplicity, its pieces and conditions."""

    base: Coefficients
    times: int
    kind: str
    factor: sp.Expr
    pieces: tuple[Piece, ...]
    conditions: tuple[sp.Basic, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """The ground that the forms of one matrix share: the ring, d, and the elapsed time t."""

    ring: Ring
    d: Poly
    time: sp.Expr

    def growth(self, alpha: Poly) -> sp.Expr:
        """exp(alpha t / d)."""
        return sp.exp(write_quotient(self.ring, alpha, self.d) * self.time)


@dataclass(frozen=True, slots=True, eq=False)
class Root:
    """A square root, rational * surd, as it enters the functions of time; ``value`` is the product."""

    rational: Fraction
    surd: Surd
    value: sp.Expr

    @property
    def factor(self) -> Factor:
        """The root as a constant factor."""
        return self.rational, self.surd

    @property
    def inverse(self) -> Factor:
        """1 / root as a constant factor; the surd stays as it is."""
        above, below = self.rational
        return (below, above if self.surd.radicand is None else above * self.surd.radicand), self.surd


def in_lambda(frame: Frame, base: Coefficients) -> sp.Expr:
    """The factor as a monic polynomial in the eigenvalue lambda of A."""
    n = len(base) - 1
    return sp.Add(
        *(write_quotient(frame.ring, c, frame.d ** (n - k)) * LAMBDA**k for k, c in enumerate(base) if not c.is_zero())
    )


def root_of_quotient(frame: Frame, value: Poly, degree: int = 2) -> Root:
    """sqrt(value / d^degree), with what can be taken out of the root taken out."""
    ring = frame.ring
    rational, radicand, surd = split_square_root(ring, value, frame.d**degree)
    return Root(rational, RATIONAL if surd == 1 else Surd(surd, radicand), write_quotient(ring, *rational) * surd)


def reality_conditions(ring: Ring, *roots: Root) -> tuple[sp.Basic, ...]:
    """Radicands that must be positive for the roots to be real, unless the declared signs make them so."""
    radicands = [root.surd.radicand for root in roots if root.surd.radicand is not None]
    return tuple(sp.Gt(polynomial_sum(ring.generators, r), 0) for r in radicands if declared_sign(ring, r) == 0)


def scale_piece(piece: Piece, growth: sp.Expr) -> Piece:
    """The piece with every function of time multiplied by one more."""
    return replace(piece, waves=tuple(replace(wave, function=wave.function * growth) for wave in piece.waves))


def multiply_constants(ring: Ring, *factors: Factor) -> Factor:
    """Product of constants, rational and irrational parts apart."""
    above, below, value, radicand = ring.one, ring.one, sp.S.One, ring.one
    for (top, bottom), surd in factors:
        above, below, value = above * top, below * bottom, value * surd.value
        radicand = radicand if surd.radicand is None else radicand * surd.radicand
    return cancel_fraction(above, below), RATIONAL if value == 1 else Surd(value, radicand)


def wave(ring: Ring, function: sp.Expr, *factors: Factor) -> Wave:
    """A wave with the product of some constant factors."""
    return Wave(function, *multiply_constants(ring, *factors))
