"""Sets of noise of several measurements: how far a vector is outside, and what weights cost there."""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb, arb_mat


@dataclass(frozen=True, slots=True, eq=False)
class Cone:
    """Noise r that is bounded together, in balls.

    norm : "l2" with a positive definite size (p, p): ``r' size^-1 r <= 1``; with sizes (p, 1) "linf": ``|r_j| <= s_j``,
           or "l1": ``sum |r_j|/s_j <= 1``
    """

    norm: str
    size: arb_mat

    def gauge(self, y: arb_mat) -> arb:
        """How many times the allowed noise a vector y (p, 1) is."""
        if self.norm == "l2":
            return root((y.transpose() * self.size.solve(y))[0, 0])
        parts = [abs(e) / s for e, s in zip(y.entries(), self.size.entries(), strict=True)]
        return sum(parts, arb(0)) if self.norm == "l1" else largest(parts)

    def cost(self, w: arb_mat) -> arb:
        """The largest ``w . r`` of allowed noise r."""
        if self.norm == "l2":
            return root((w.transpose() * self.size * w)[0, 0])
        costs = [abs(e) * s for e, s in zip(w.entries(), self.size.entries(), strict=True)]
        return sum(costs, arb(0)) if self.norm == "linf" else largest(costs)

    def face(self, y: arb_mat) -> arb_mat:
        """Weights a (p, 1) near those that cost 1 and have ``a . y`` equal to the gauge of y, as exact numbers."""
        if self.norm == "l2":
            return self.size.solve(y / self.gauge(y)).mid()
        sides = [side_of(e) / s for e, s in zip(y.entries(), self.size.entries(), strict=True)]
        parts = [abs(float(e.mid())) / float(s.mid()) for e, s in zip(y.entries(), self.size.entries(), strict=True)]
        keep = range(len(parts)) if self.norm == "l1" else [parts.index(max(parts))]
        return arb_mat([[a if j in keep else arb(0)] for j, a in enumerate(sides)]).mid()

    def worst(self, w: arb_mat) -> list[arb]:
        """Allowed noise r with ``w . r`` equal to the cost of w, which is not zero."""
        if self.norm == "l2":
            return (self.size * w / self.cost(w)).entries()  # type: ignore[no-any-return]
        sides = [s * side_of(e) for e, s in zip(w.entries(), self.size.entries(), strict=True)]
        costs = [abs(float(e.mid())) * float(s.mid()) for e, s in zip(w.entries(), self.size.entries(), strict=True)]
        keep = range(len(costs)) if self.norm == "linf" else [costs.index(max(costs))]
        return [r if j in keep else arb(0) for j, r in enumerate(sides)]


def root(square: arb) -> arb:
    """The square root of a square, or a number above it where the ball reaches zero."""
    return (square if square > 0 else arb(abs(square).upper())).sqrt()


def largest(balls: list[arb]) -> arb:
    """The largest of some balls."""
    found = balls[0]
    for ball in balls[1:]:
        found = found.max(ball)
    return found


def side_of(x: arb) -> int:
    """The sign of the middle of a ball, 1 for zero."""
    return -1 if x.mid() < 0 else 1
