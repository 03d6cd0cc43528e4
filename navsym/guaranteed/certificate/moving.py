"""Regressors of a problem whose parameter moves: series in s, jets in the place.

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

# Power series in two variables: a jet in w whose coefficients are series in s.
#
# ``f(w, s) = sum_k f_k(s) w**k`` up to an order in w; every f_k is an ``arb_series`` in s, or a ball. The
# functions of the language follow from their differential equations in w, for instance
# ``k e_k = sum_j j a_j e_{k-j}`` for e = exp(a). Everything is an enclosure when the coefficients are.


class Jet:
    """Coefficients of w**0 … w**order; trailing ones may be left out and are zero."""

    __slots__ = ("_waves", "order", "parts")

    def __init__(self, parts: Sequence[Any], order: int):
        self.parts, self.order = tuple(parts[: order + 1]), order
        self._waves: tuple[Jet, Jet] | None = None

    def __add__(self, other: Any) -> Jet:
        mine, theirs = self.parts, jet_parts(other)
        longer, shorter = (mine, theirs) if len(mine) >= len(theirs) else (theirs, mine)
        both = [a + b for a, b in zip(longer, shorter, strict=False)]
        return Jet([*both, *longer[len(shorter) :]], self.order)

    __radd__ = __add__

    def __mul__(self, other: Any) -> Jet:
        theirs = jet_parts(other)
        if len(theirs) == 1:
            return Jet([a * theirs[0] for a in self.parts], self.order)
        size = min(len(self.parts) + len(theirs) - 1, self.order + 1)
        return Jet([convolve_at(self.parts, theirs, k) for k in range(size)], self.order)

    __rmul__ = __mul__

    def __neg__(self) -> Jet:
        return Jet([-a for a in self.parts], self.order)

    def __sub__(self, other: Any) -> Jet:
        return self + (-other)

    def __truediv__(self, other: Any) -> Jet:
        return self * (1 / other)

    def __rtruediv__(self, other: Any) -> Jet:
        a = self.parts
        done = [1 / a[0]]
        for k in range(1, self.size()):
            done.append(-done[0] * add_up(a[j] * done[k - j] for j in range(1, min(k, len(a) - 1) + 1)))
        return Jet(done, self.order) * other

    def size(self) -> int:
        """Terms of a function of the jet: one for a jet that does not depend on w."""
        return 1 if len(self.parts) == 1 else self.order + 1

    # What the tapes ask of an argument before they divide or take a logarithm.

    def head(self) -> Any:
        first = self.parts[0]
        return first[0] if isinstance(first, arb_series) else first

    def contains(self, value: int) -> bool:
        return bool(self.head().contains(value))

    def __gt__(self, value: Any) -> bool:
        return bool(self.head() > value)

    def __lt__(self, value: Any) -> bool:
        return bool(self.head() < value)

    def exp(self) -> Jet:
        a, done = self.parts, [self.parts[0].exp()]
        for k in range(1, self.size()):
            done.append(add_up(j * a[j] * done[k - j] for j in range(1, min(k, len(a) - 1) + 1)) / k)
        return Jet(done, self.order)

    def log(self) -> Jet:
        a, below = self.parts, 1 / self.parts[0]
        done = [a[0].log()]
        for k in range(1, self.size()):
            known = [j * done[j] * a[k - j] for j in range(1, k) if k - j < len(a)]
            own = [k * a[k]] if k < len(a) else []
            done.append(add_up([*own, *(-x for x in known)]) * below / k)
        return Jet(done, self.order)

    def sqrt(self) -> Jet:
        return (self.log() / 2).exp()

    def waves(self) -> tuple[Jet, Jet]:
        """sin and cos, computed together and kept."""
        if self._waves is None:
            a = self.parts
            sine, cosine = [a[0].sin()], [a[0].cos()]
            for k in range(1, self.size()):
                js = range(1, min(k, len(a) - 1) + 1)
                up = add_up(j * a[j] * cosine[k - j] for j in js) / k
                cosine.append(-add_up(j * a[j] * sine[k - j] for j in js) / k)
                sine.append(up)
            self._waves = Jet(sine, self.order), Jet(cosine, self.order)
        return self._waves

    def sin(self) -> Jet:
        return self.waves()[0]

    def cos(self) -> Jet:
        return self.waves()[1]


def jet_parts(x: Any) -> tuple[Any, ...]:
    return x.parts if isinstance(x, Jet) else (x,)


def convolve_at(a: Sequence[Any], b: Sequence[Any], k: int) -> Any:
    low, high = max(0, k - len(b) + 1), min(k, len(a) - 1)
    return add_up(a[i] * b[k - i] for i in range(low, high + 1))


def add_up(terms: Any) -> Any:
    value = None
    for term in terms:
        value = term if value is None else value + term
    return arb_series([0]) if value is None else value


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

    def rows(self, k: int, v: Any, r: Any, s: arb, order: int) -> list[list[Any]]:
        """Coefficients 0 … order in w of every q on panel k, at the fraction ``v + r w``."""
        return self.mixed(self.mix, *self.functions(k, v, r, s, order), order)

    def functions(self, k: int, v: Any, r: Any, s: arb, order: int) -> tuple[list[list[Any]], Any]:
        """Coefficients of every H, and ``1 / sigma``."""
        panel, p = self.problem.panels[k], self.value(s)
        start, end, sigma = panel.ends.run({self.parameter: p})
        t = Jet([start + (end - start) * v, (end - start) * r], order)
        H = panel.program.run({panel.variable: t, self.parameter: Jet([p], order)})
        return [pad_jet(h, order) for h in H], 1 / sigma

    def mixed(self, matrix: arb_mat, H: Sequence[Sequence[Any]], scale: Any, order: int) -> list[list[Any]]:
        n = ctx.cap
        flat = arb_mat([[series_coefficient(part, j) for part in h for j in range(n)] for h in H])
        q = (matrix * flat).tolist()
        return [[arb_series(row[n * k : n * (k + 1)]) * scale for k in range(order + 1)] for row in q]

    def target(self, s: arb) -> list[Any]:
        """``A P`` about s."""
        P = self.problem.functional_program.run({self.parameter: self.value(s)})
        return [row[0] for row in self.mixed(self.mix, [[p] for p in P], arb(1), 0)]


def pad_jet(h: Any, order: int) -> list[Any]:
    parts = list(h.parts) if isinstance(h, Jet) else [h]
    return parts + [arb(0)] * (order + 1 - len(parts))


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

    def rows(self, k: int, v: Any, r: Any, s: arb, order: int) -> list[list[Any]]:
        p = self.value(s)
        place = Jet([v, arb_series([r])], order)
        u, done = place * p, []
        for low, c in zip(self.lows, self.local[k], strict=True):
            value: Any = Jet([arb_series([c[-1]])], order)
            for a in reversed(c[low:-1]):
                value = value * u + a
            for _ in range(low):
                value = value * place
            done.append(pad_jet(value, order))
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
