"""Regressors of a problem whose parameter moves: series in s, with two derivatives by the place.

In a piece of a range ``p = middle + half s`` with |s| <= 1. A place is a fraction v of its panel,
``t = start(p) + (end(p) - start(p)) v``, and ``q = A H / sigma`` with a rational matrix A.
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
    weights : times their noise bounds
    """

    dual: Sequence[fmpq]
    places: Sequence[fmpq]
    weights: Sequence[fmpq]


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
        return Member(x.entries(), places, weights)

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


def rational_functional(problem: PanelProblem) -> list[fmpq]:
    """P as rational numbers."""
    return [to_fmpq(sp.sympify(p, strict=True)) for p in problem.functional]
