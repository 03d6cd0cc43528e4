"""Regressors of a problem whose parameter moves: series in s, with two derivatives by the place.

In a piece of a range ``p = middle + half s`` with |s| <= 1. A place is a fraction v of its panel,
``t = start(p) + (end(p) - start(p)) v``, and ``q = A H / sigma`` with a rational matrix A. Near p = 0,
where the regressors of a growing interval [0, p] become dependent, row i of q is divided by p**k_i.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy as sp
from flint import arb, arb_mat, arb_series, ctx, fmpq, fmpq_mat

from navsym.core.exact import to_fmpq
from navsym.guaranteed.certificate.enclosure import PanelProblem

EVERY = arb(0, 1)


def expand_polynomial(coefficients: Sequence[Any], s: arb) -> arb_series:
    """The polynomial expanded about s."""
    at = arb_series([s, arb(1)])
    value = arb_series([arb(0)])
    for c in reversed(coefficients):
        value = value * at + c
    return value


def series_coefficient(value: Any, k: int) -> arb:
    """Coefficient k of a series or of a constant; NaN when the series lost it."""
    if isinstance(value, arb_series):
        return value[k] if value.prec > k else arb("nan")
    return arb(value) if k == 0 else arb(0)


@dataclass(frozen=True, slots=True, eq=False)
class Member:
    """Solution for one value of the parameter, with many digits.

    dual    : x, in the basis of the problem
    places  : fractions of the contacts
    weights : sigma times the weights
    """

    dual: tuple[fmpq, ...]
    places: tuple[fmpq, ...]
    weights: tuple[fmpq, ...]


@dataclass(frozen=True)
class MovingProblem:
    """The problem on one piece: rows of regressors and the functional as series in s."""

    problem: PanelProblem
    parameter: sp.Symbol
    basis: fmpq_mat
    middle: fmpq
    half: fmpq

    @property
    def size(self) -> int:
        return int(self.basis.nrows())

    @property
    def slack(self) -> int:
        """How many times Newton's step here a checker may need, whose balls come from texts."""
        return 2

    @cached_property
    def mix(self) -> arb_mat:
        m = self.size
        return arb_mat(m, m, [arb(a) for a in self.basis.entries()])

    def local_member(self, member: Member) -> list[fmpq]:
        """(y, places, weights) in the basis of the piece: ``A^T y = x``."""
        m = self.size
        y = self.basis.transpose().inv() * fmpq_mat(m, 1, list(member.dual))
        return [*(y[i, 0] for i in range(m)), *member.places, *member.weights]

    def global_member(self, y: Sequence[fmpq], places: Sequence[fmpq], weights: Sequence[fmpq]) -> Member:
        """The same in the basis of the problem: ``x = A^T y``."""
        x = self.basis.transpose() * fmpq_mat(self.size, 1, list(y))
        return Member(tuple(x[i, 0] for i in range(self.size)), tuple(places), tuple(weights))

    def value(self, s: arb) -> arb_series:
        """The parameter about s."""
        return arb_series([arb(self.middle) + arb(self.half) * s, arb(self.half)])

    def rows(self, k: int, v: Any, s: arb) -> list[list[Any]]:
        """q, q' and q''/2 by the fraction v of panel k, for every q."""
        panel, p = self.problem.panels[k], self.value(s)
        start, end, sigma = panel.ends.run({self.parameter: p})
        length = end - start
        found = panel.slopes.run({panel.variable: start + length * v, self.parameter: p})
        m = len(panel.functions)
        H = [[found[j], found[m + j] * length, found[2 * m + j] * length * length] for j in range(m)]
        return self.mixed(H, 1 / sigma)

    def mixed(self, H: Sequence[Sequence[Any]], scale: Any) -> list[list[Any]]:
        """A H times a series."""
        n, parts = ctx.cap, range(len(H[0]))
        flat = arb_mat([[series_coefficient(part, j) for part in h for j in range(n)] for h in H])
        q = (self.mix * flat).tolist()
        return [[arb_series(row[n * k : n * (k + 1)]) * scale for k in parts] for row in q]

    def target(self, s: arb) -> list[Any]:
        """``A P`` about s."""
        P = self.problem.functional_program.run({self.parameter: self.value(s)})
        return [row[0] for row in self.mixed([[p] for p in P], arb(1))]


# -- next to a vanishing interval -------------------------------------------------------------------


@dataclass(frozen=True)
class VanishingProblem(MovingProblem):
    """The same on [0, p] with p near 0: row i of ``A H`` starts with u**k_i and is divided by p**k_i.

    lows  : k_i, different from each other
    shift : the functional is multiplied by p**shift, so that all of it stays finite
    local : Taylor coefficients of the rows at u = 0, the last over the whole interval; see :func:`expanded`
    """

    lows: tuple[int, ...] = ()
    shift: int = 0
    local: tuple[tuple[tuple[arb, ...], ...], ...] = ()

    @property
    def slack(self) -> int:
        """More than elsewhere: here the series are exact, there powers cancel."""
        return 5

    def local_member(self, member: Member) -> list[fmpq]:
        """Scaled for the middle of the piece: ``y_i = p**k_i (A^-T x)_i``, weights times p**shift."""
        plain, m, p = super().local_member(member), self.size, self.middle
        y = [c * p**low for c, low in zip(plain[:m], self.lows, strict=True)]
        l = len(member.places)
        return [*y, *plain[m : m + l], *(w * p**self.shift for w in plain[m + l :])]

    def global_member(self, y: Sequence[fmpq], places: Sequence[fmpq], weights: Sequence[fmpq]) -> Member:
        """At the upper end of the piece; the lower one may be p = 0, where the unscaled solution is not finite."""
        p = self.middle + self.half
        plain = [c / p**low for c, low in zip(y, self.lows, strict=True)]
        return super().global_member(plain, places, [w / p**self.shift for w in weights])

    def rows(self, k: int, v: Any, s: arb) -> list[list[Any]]:
        p, done = self.value(s), []
        for low, c in zip(self.lows, self.local[k], strict=True):
            power, factors = arb_series([1]), [arb_series([0])] * low
            for a in c[low:]:
                factors.append(power * a)
                power = power * p
            value, slope, half = (arb_series([0]) for _ in range(3))
            for factor in reversed(factors):  # Horner's scheme with two derivatives
                value, slope, half = value * v + factor, slope * v + value, half * v + slope
            done.append([value, slope, half])
        return done

    def target(self, s: arb) -> list[Any]:
        p, P = self.value(s), rational_functional(self.problem)
        image = self.basis * fmpq_mat(len(P), 1, P)
        done = []
        for i, low in enumerate(self.lows):
            value: Any = arb_series([arb(image[i, 0])])
            for _ in range(self.shift - low):
                value = value * p
            done.append(value)
        return done


def rational_functional(problem: PanelProblem) -> list[fmpq]:
    """P as rational numbers."""
    return [to_fmpq(sp.sympify(p, strict=True)) for p in problem.functional]
