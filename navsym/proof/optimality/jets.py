"""Power series in two variables: a jet in w whose coefficients are series in s.

``f(w, s) = sum_k f_k(s) w**k`` up to an order in w; every f_k is an ``arb_series`` in s, or a ball. The
functions of the language follow from their differential equations in w, for instance
``k e_k = sum_j j a_j e_{k-j}`` for e = exp(a). Everything is an enclosure when the coefficients are.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from flint import arb_series


class Jet:
    """Coefficients of w**0 … w**order; trailing ones may be left out and are zero."""

    __slots__ = ("_waves", "order", "parts")

    def __init__(self, parts: Sequence[Any], order: int):
        self.parts, self.order = tuple(parts[: order + 1]), order
        self._waves: tuple[Jet, Jet] | None = None

    def __add__(self, other: Any) -> Jet:
        mine, theirs = self.parts, parts_of(other)
        longer, shorter = (mine, theirs) if len(mine) >= len(theirs) else (theirs, mine)
        both = [a + b for a, b in zip(longer, shorter, strict=False)]
        return Jet([*both, *longer[len(shorter) :]], self.order)

    __radd__ = __add__

    def __mul__(self, other: Any) -> Jet:
        theirs = parts_of(other)
        if len(theirs) == 1:
            return Jet([a * theirs[0] for a in self.parts], self.order)
        size = min(len(self.parts) + len(theirs) - 1, self.order + 1)
        return Jet([convolved(self.parts, theirs, k) for k in range(size)], self.order)

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
            done.append(-done[0] * summed(a[j] * done[k - j] for j in range(1, min(k, len(a) - 1) + 1)))
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
            done.append(summed(j * a[j] * done[k - j] for j in range(1, min(k, len(a) - 1) + 1)) / k)
        return Jet(done, self.order)

    def log(self) -> Jet:
        a, below = self.parts, 1 / self.parts[0]
        done = [a[0].log()]
        for k in range(1, self.size()):
            known = [j * done[j] * a[k - j] for j in range(1, k) if k - j < len(a)]
            own = [k * a[k]] if k < len(a) else []
            done.append(summed([*own, *(-x for x in known)]) * below / k)
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
                up = summed(j * a[j] * cosine[k - j] for j in js) / k
                cosine.append(-summed(j * a[j] * sine[k - j] for j in js) / k)
                sine.append(up)
            self._waves = Jet(sine, self.order), Jet(cosine, self.order)
        return self._waves

    def sin(self) -> Jet:
        return self.waves()[0]

    def cos(self) -> Jet:
        return self.waves()[1]


def parts_of(x: Any) -> tuple[Any, ...]:
    return x.parts if isinstance(x, Jet) else (x,)


def convolved(a: Sequence[Any], b: Sequence[Any], k: int) -> Any:
    low, high = max(0, k - len(b) + 1), min(k, len(a) - 1)
    return summed(a[i] * b[k - i] for i in range(low, high + 1))


def summed(terms: Any) -> Any:
    value = None
    for term in terms:
        value = term if value is None else value + term
    return arb_series([0]) if value is None else value
