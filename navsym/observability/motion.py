"""How observed functionals move along a model: D(a) = a' + a F, one rule for all models.

A functional a x of the state that is known on an interval gives its derivative (a' + a F) x as well. For a constant
model a' is zero; where F and h hold the time or parameters with rates, a' differentiates them; a nonlinear model is
linearised along its own motion, F = df/dx and h = dz/dx, and its states are symbols whose rates are f: the rows are the
gradients of the Lie derivatives of z. What is observed is the span of h, D h, D^2 h, ... in every case.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import sympy as sp
from flint import nmod_mat, nmod_poly

from navsym.core.errors import DomainError
from navsym.core.rational_functions import Quotient, clear_denominators, replace_square
from navsym.models.linear import LinearModel
from navsym.observability.atoms import Atoms
from navsym.observability.linear import PRIME, Matrix, integer_points, residue, transposed_times
from navsym.observability.ring import Poly, Ring


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """D, over a ring of polynomials.

    matrix : numerators of F, (n, n); ``F = matrix / clock``
    rates  : place of a generator -> numerator of its rate, ``rate / clock``; the others are constant
    roots  : place of a generator -> polynomial that is its square
    """

    ring: Ring
    matrix: Matrix
    clock: Poly
    rates: Mapping[int, Poly] = field(default_factory=dict)
    roots: Mapping[int, Poly] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """n, the number of states."""
        return len(self.matrix)

    def reduced(self, value: Poly) -> Poly:
        """The polynomial with the squares of the roots replaced: zero exactly where it vanishes on all of them."""
        for place, square in self.roots.items():
            if value != 0 and int(value.degrees()[place]) > 1:
                value = replace_square(value, place, square)
        return value

    def derivative(self, value: Poly) -> Poly:
        """clock times the derivative of a polynomial along the motion."""
        total = self.ring.constant(0)
        if value == 0 or value.is_constant():
            return total
        for place, rate in self.rates.items():
            if int(value.degrees()[place]):
                total = total + rate * value.derivative(place)
        return self.reduced(total)

    def advance(self, row: list[Poly]) -> list[Poly]:
        """clock times D of a row: what the derivative of a known functional shows."""
        moved = transposed_times(self.matrix, row, self.ring)
        if not self.rates:
            return moved
        return [self.reduced(x + self.derivative(own)) for x, own in zip(moved, row, strict=True)]

    def retreat(self, column: list[Poly]) -> list[Poly]:
        """clock times (F N - N'): where this lies in the span of all N, and h N = 0, no derivative ever shows N."""
        zero = self.ring.constant(0)
        moved = [
            sum((a * b for a, b in zip(row, column, strict=True) if a != 0 and b != 0), zero) for row in self.matrix
        ]
        return [self.reduced(x - self.derivative(own)) for x, own in zip(moved, column, strict=True)]

    def points(self, count: int = 3) -> list[tuple[int, ...]]:
        """Points modulo the prime at which the clock does not vanish and every root is a root."""
        found: list[tuple[int, ...]] = []
        for point in integer_points(self.ring, 60 * count):
            here = self.lifted(point)
            if here is not None and residue(self.clock, here):
                found.append(here)
            if len(found) == count:
                return found
        raise DomainError(
            "expected roots that are real somewhere; got none at the points tried; square the measurement"
        )

    def lifted(self, point: tuple[int, ...]) -> tuple[int, ...] | None:
        """The point with the roots put in; None where a radicand is no square modulo the prime."""
        here = list(point)
        for place, square in self.roots.items():
            value = residue(square, here)
            here[place] = pow(value, (PRIME + 1) // 4, PRIME)
            if here[place] ** 2 % PRIME != value:
                return None
        return tuple(here)


def motion_of(model: LinearModel, others: Sequence[sp.MatrixBase] = ()) -> tuple[Motion, list[tuple[list[Poly], Poly]]]:
    """The motion of a model, and the rows of H with their denominators; ``others`` have rows of their own behind.

    Raises DomainError for functions that cannot be generators, and TooLargeError.
    """
    atoms = Atoms.of(model, others)
    entries = [*(entry for row in atoms.rows for entry in row), *atoms.rates.values()]
    ring = Ring.of([atoms.F, *entries, *atoms.squares.values(), *atoms.squares], atoms.meaning)
    known = {entry: ring.quotient(entry) for entry in dict.fromkeys([*atoms.F, *atoms.rates.values()])}
    rates = rates_of_generators(ring, {s: known[rate] for s, rate in atoms.rates.items()})
    n = model.size
    entries = [[known[entry] for entry in atoms.F[i, :]] for i in range(n)]
    cleared, clock = clear_denominators([*entries, list(rates.values())], ring.constant(1))
    roots = {ring.places[g]: ring.quotient(square).top for g, square in atoms.squares.items()}
    found = [clear_denominators([[ring.quotient(entry) for entry in row]], ring.constant(1)) for row in atoms.rows]
    ring = ring.with_units([clock, *(bottom for _, bottom in found)])
    motion = Motion(ring, cleared[:n], clock, dict(zip(rates, cleared[n], strict=True)), roots)
    return motion, [([motion.reduced(x) for x in numerators], bottom) for (numerators,), bottom in found]


def rates_of_generators(ring: Ring, rates: Mapping[sp.Symbol, Quotient]) -> dict[int, Quotient]:
    """Rates by place; the sine S and cosine C of a/(2 k) have the rates C a'/(2 k) and -S a'/(2 k)."""
    found = {ring.places[s]: rate for s, rate in rates.items() if s in ring.places and rate.top != 0}
    for angle, (sine, cosine) in zip(ring.angles, ring.pairs(), strict=True):
        rate = rates.get(angle.symbol)
        if rate is not None and rate.top != 0:
            S, C, bottom = ring.context.gen(sine), ring.context.gen(cosine), rate.bottom * (2 * angle.parts)
            found[sine], found[cosine] = Quotient(C * rate.top, bottom), Quotient(-S * rate.top, bottom)
    return found


# Series along the motion, modulo the prime


class Terms:
    """Polynomials to be evaluated at series many times: read once."""

    def __init__(self, entries: Sequence[Poly]):
        self.entries = [[(tuple(map(int, e)), int(c) % PRIME) for e, c in entry.to_dict().items()] for entry in entries]

    def at(self, series: Sequence[nmod_poly], order: int) -> list[nmod_poly]:
        """The entries at the series of the generators, up to the order."""
        powers: dict[tuple[int, int], nmod_poly] = {}
        found = []
        for entry in self.entries:
            total = nmod_poly([0], PRIME)
            for exponents, c in entry:
                term = nmod_poly([c], PRIME)
                for place, e in enumerate(exponents):
                    if e:
                        if (place, e) not in powers:
                            powers[place, e] = series[place].pow_trunc(e, order)
                        term = term.mul_low(powers[place, e], order)
                total = total + term
            found.append(total)
        return found


def generator_series(motion: Motion, point: Sequence[int], order: int) -> list[nmod_poly]:
    """The generators along the motion from a point: power series of the time, so many coefficients."""
    series = [nmod_poly([value], PRIME) for value in point]
    if not motion.rates:
        return series
    terms = Terms([motion.clock, *motion.rates.values()])
    for k in range(order - 1):
        clock, *rates = terms.at(series, k + 1)
        inverse, share = clock.inverse_series_trunc(k + 1), pow(k + 1, -1, PRIME)
        for place, rate in zip(motion.rates, rates, strict=True):
            series[place][k + 1] = int(rate.mul_low(inverse, k + 1)[k]) * share % PRIME
    return series


def residue_chains(rows: Matrix, motion: Motion, point: Sequence[int]) -> list[list[int]]:
    """h, D h, ..., D^(n-1) h / (n-1)! of every row at a point, modulo the prime, one chain after the other.

    They are the coefficients of h(t) X(t), where X' = F X from the identity: the sensitivity of the flow.
    """
    n, count = motion.size, motion.size
    series = generator_series(motion, point, count)
    flat = Terms([motion.clock, *(entry for row in (*motion.matrix, *rows) for entry in row)]).at(series, count)
    inverse = flat[0].inverse_series_trunc(count)
    F = coefficients([entry.mul_low(inverse, count) for entry in flat[1 : n * n + 1]], n, count)
    H = coefficients(flat[n * n + 1 :], len(rows), count)
    X = [nmod_mat(n, n, [int(i == j) for i in range(n) for j in range(n)], PRIME)]
    zero = nmod_mat(n, n, [0] * (n * n), PRIME)
    for k in range(count - 1):
        total = sum((F[j] * X[k - j] for j in F if j <= k), zero)
        X.append(total * pow(k + 1, -1, PRIME))
    start = nmod_mat(len(rows), n, [0] * (len(rows) * n), PRIME)
    shown = [sum((H[j] * X[k - j] for j in H if j <= k), start).tolist() for k in range(count)]
    return [[int(x) for x in shown[k][r]] for r in range(len(rows)) for k in range(count)]


def coefficients(entries: Sequence[nmod_poly], rows: int, order: int) -> dict[int, nmod_mat]:
    """Matrices of the coefficients of every order that are not zero."""
    longest = min(order, max((entry.length() for entry in entries), default=0))
    width = len(entries) // rows
    return {
        k: nmod_mat(rows, width, [int(entry[k]) for entry in entries], PRIME)
        for k in range(longest)
        if any(int(entry[k]) for entry in entries)
    }
