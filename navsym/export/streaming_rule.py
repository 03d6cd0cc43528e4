"""The streaming rule of a guard in doubles: the twin of the exported C, the same operations in the same order.

At every epoch it gives estimate, radius and least. For errors of at most sigma, |estimate - target| <= radius, and no
linear unbiased estimate from the measurements in memory has a guaranteed radius below ``least``. Both hold for the
doubles that are returned: all rounding errors are bounded, those of the tables included.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

OK, INVALID, NOT_ESTIMABLE, NOT_CERTIFIED = 0, 1, 2, 3
#: Sums of up to a hundred rounded terms of one sign are below their value times UP, and above it times DOWN.
UP, DOWN = 1.0 + 5.6843418860808015e-14, 1.0 - 5.6843418860808015e-14
SMALLEST, LARGEST = 2.0**-1022, 1.7976931348623157e308
#: Exchanges of one epoch; a search that ends here has bounds that are further apart, and not wrong.
MOST_EXCHANGES = 60

Row = Sequence[float]
Matrix = list[list[float]]
Step = tuple[int, float, float, float]
NOTHING = (math.nan, math.nan, math.nan)


@dataclass(slots=True)
class Support:
    """Inverse of the rows of a support, weights, dual, and the row that breaks its bound most; -1 where none does."""

    inverse: Matrix
    columns: Matrix
    weight: list[float]
    dual: list[float]
    ratio: float = 1.0
    enter: int = -1
    side: float = 1.0


@dataclass(slots=True)
class StreamingRule:
    """The memory of a stream, and the support of its last optimum, where the next search begins.

    table  : regressors of every lag and measurement, row lag * measurements + measurement
    target : functional at the time of the epoch
    sigma  : bounds of the measurements
    tiny   : errors of table and target beyond half a unit of the last place
    lags   : epochs in memory
    """

    table: Sequence[Row]
    target: Row
    sigma: Row
    tiny: float
    lags: int
    epochs: list[tuple[Row, Row]] = field(default_factory=list)  # the newest first
    support: list[int] = field(default_factory=list)
    sign: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.support, self.sign = [-1] * len(self.target), [1.0] * len(self.target)

    @property
    def gamma(self) -> float:
        """Bound of a sum of products and of the rounding of its table, relative to the sum of magnitudes."""
        return (len(self.target) + 8) * 1.1102230246251565e-16

    def step(self, z: Sequence[float | None], sigma: Row | None = None) -> Step:
        """(status, estimate, radius, least) of an epoch; None or NaN is no measurement.

        Of a status other than OK the numbers are NaN, and an INVALID epoch is not taken.
        """
        values = [math.nan if value is None else float(value) for value in z]
        bounds = [float(bound) for bound in sigma or self.sigma]
        for value, bound in zip(values, bounds, strict=True):
            if not math.isnan(value) and not (abs(value) <= LARGEST and SMALLEST <= bound <= LARGEST):
                return INVALID, *NOTHING
        self.epochs = [(values, bounds), *self.epochs[: self.lags - 1]]
        answer = self.certify(self.exchange()) if self.keep() else None
        if answer is None:
            if not self.spread():
                self.support[0] = -1
                return NOT_ESTIMABLE, *NOTHING
            answer = self.certify(self.exchange())
        if answer is None:
            self.support[0] = -1
            return NOT_CERTIFIED, *NOTHING
        return (OK, *answer)

    # Rows of the table that were measured

    def has(self, row: int) -> bool:
        """Whether a row was measured."""
        lag, j = divmod(row, len(self.sigma))
        return 0 <= lag < len(self.epochs) and not math.isnan(self.epochs[lag][0][j])

    def measured(self) -> list[int]:
        """All rows that were."""
        return [row for row in range(len(self.epochs) * len(self.sigma)) if self.has(row)]

    def bound(self, row: int) -> float:
        """The sigma of a row."""
        return self.epochs[row // len(self.sigma)][1][row % len(self.sigma)]

    # The search

    def keep(self) -> bool:
        """The last support at the lags that it had, or moved on with its epochs; False where neither is in memory."""
        for shift in (0, len(self.sigma)):
            if all(row >= 0 and self.has(row + shift) for row in self.support):
                self.support = [row + shift for row in self.support]
                return True
        return False

    def exchange(self) -> Support | None:
        """The worst row enters until none breaks its bound; None where a support is singular."""
        found = self.solve()
        for _ in range(MOST_EXCHANGES):
            if found is None or found.enter < 0:
                return found
            leave = self.leave(found)
            if leave < 0:
                return found
            self.support[leave], self.sign[leave] = found.enter, found.side
            found = self.solve()
        return found

    def solve(self) -> Support | None:
        """Weights and dual of the present support."""
        inverse = invert([self.table[row] for row in self.support])
        if inverse is None:
            return None
        columns = [list(column) for column in zip(*inverse, strict=True)]
        weight, wanted = [], []
        for k, column in enumerate(columns):
            weight.append(add_products(self.target, column)[0])
            if abs(weight[k]) > 0.0:
                self.sign[k] = 1.0 if weight[k] > 0.0 else -1.0
            wanted.append(self.sign[k] * self.bound(self.support[k]))
        found = Support(inverse, columns, weight, [add_products(row, wanted)[0] for row in inverse])
        self.price(found)
        return found

    def price(self, found: Support) -> None:
        """The row that breaks its bound most, by more than rounding; ratio encloses the largest break from above."""
        worst, total, gamma = 1.0 + 1e-12, 0.0, self.gamma
        for x in found.dual:
            total += abs(x)
        for row in self.measured():
            bound = self.bound(row)
            value, size = add_products(self.table[row], found.dual)
            high = (abs(value) + (gamma * size) + (self.tiny * total) + SMALLEST) / bound
            found.ratio = found.ratio if high <= found.ratio else high
            sure = abs(value) - (4.0 * gamma * size)
            if sure > worst * bound:
                worst = sure / bound
                found.enter, found.side = row, 1.0 if value > 0.0 else -1.0

    def leave(self, found: Support) -> int:
        """The place of the support whose weight vanishes first as the row enters; -1 where none does."""
        least, steepest, best = LARGEST, 0.0, -1
        for k, column in enumerate(found.columns):
            along, size = add_products(self.table[found.enter], column)
            slope = self.sign[k] * found.side * along
            if slope > 1e-11 * size:
                step = abs(found.weight[k]) / slope
                if step < least or (step <= least and slope > steepest):
                    best, least, steepest = k, step, slope
        return best

    def spread(self) -> bool:
        """A first support: each row is as far as possible from the span of those before."""
        q: Matrix = []
        for k in range(len(self.target)):
            most, best, chosen = 1e-20, -1, [0.0]
            for row in self.measured():
                v = list(self.table[row])
                whole = add_products(v, v)[0]
                for other in q:
                    part = add_products(v, other)[0]
                    v = [a - part * b for a, b in zip(v, other, strict=True)]
                rest = add_products(v, v)[0]
                if rest > most * whole:
                    most, best = rest / whole, row
                    chosen = [a / math.sqrt(rest) for a in v]
            if best < 0:
                return False
            q.append(chosen)
            self.support[k], self.sign[k] = best, 1.0
        return True

    # The bounds

    def certify(self, found: Support | None) -> tuple[float, float, float] | None:
        """Estimate, radius and least; None where rounding errors leave no bound.

        With E = 1 - V A and the rest r = P - w V the exact weights are w + r A (1 - E)**-1, so that
        sum u |exact - w| <= sum u |r A| / (1 - q) with u = sigma + |z|, q the norm of E with weights u.
        """
        if found is None:
            return None
        cost = value = values = 0.0
        both = []
        for w, row in zip(found.weight, self.support, strict=True):
            lag, j = divmod(row, len(self.sigma))
            z, bound = self.epochs[lag][0][j], self.epochs[lag][1][j]
            cost += bound * abs(w)
            value += w * z
            values += abs(w) * abs(z)
            both.append(bound + abs(z))
        q = self.defect(found, both)
        if not q < 0.5:
            return None
        rest, drift = self.bias(found), 0.0
        for i, u in enumerate(both):
            for j, r in enumerate(rest):
                drift += r * abs(found.inverse[j][i]) * u
        drift = (drift + SMALLEST) / (0.999 - q)
        radius = (cost + drift + (self.gamma * values) + SMALLEST) * UP
        low, size = add_products(self.target, found.dual)
        total = 0.0
        for x in found.dual:
            total += abs(x)
        low -= ((self.gamma * size) + (self.tiny * total) + SMALLEST) * UP
        least = (low / found.ratio) * DOWN if low > 0.0 else 0.0
        good = radius <= LARGEST and least >= 0.0 and abs(value) <= LARGEST
        return (value, radius, least) if good else None

    def defect(self, found: Support, size: Sequence[float]) -> float:
        """Bound of the norm of 1 - V A with weights."""
        q, gamma = 0.0, self.gamma
        for i, row in enumerate(self.support):
            norm = 0.0
            for j, column in enumerate(found.columns):
                one, total = 1.0 if i == j else 0.0, 0.0
                for entry in column:
                    total += abs(entry)
                value, sizes = add_products(self.table[row], column)
                error = abs(one - value) + (gamma * (sizes + one)) + (self.tiny * total) + SMALLEST
                norm += error * (size[j] / size[i])
            q = q if norm <= q else norm
        return q

    def bias(self, found: Support) -> list[float]:
        """Bounds of the entries of P - w V."""
        rest, weights = [], 0.0
        for w in found.weight:
            weights += abs(w)
        for j, p in enumerate(self.target):
            total, size = 0.0, abs(p)
            for w, row in zip(found.weight, self.support, strict=True):
                term = w * self.table[row][j]
                total += term
                size += abs(term)
            rest.append(abs(p - total) + (self.gamma * size) + (self.tiny * (1.0 + weights)) + SMALLEST)
        return rest


def add_products(a: Row, b: Row) -> tuple[float, float]:
    """Sum of the products, and that of their magnitudes."""
    total = size = 0.0
    for x, y in zip(a, b, strict=True):
        term = x * y
        total += term
        size += abs(term)
    return total, size


def invert(rows: Sequence[Row]) -> Matrix | None:
    """Gauss and Jordan with pivots relative to their rows; None where a pivot vanishes."""
    m = len(rows)
    a = [list(row) for row in rows]
    inverse = [[1.0 if i == j else 0.0 for j in range(m)] for i in range(m)]
    scale = [max(map(abs, row)) for row in a]
    for k in range(m):
        best = k
        for i in range(k + 1, m):
            if abs(a[i][k]) * scale[best] > abs(a[best][k]) * scale[i]:
                best = i
        pivot = a[best][k]
        if not abs(pivot) > 0.0:
            return None
        for table in (a, inverse):
            table[best], table[k] = table[k], [x / pivot for x in table[best]]
        scale[best] = scale[k]
        for i in range(m):
            factor = a[i][k]
            if i != k and abs(factor) > 0.0:
                a[i] = [x - factor * y for x, y in zip(a[i], a[k], strict=True)]
                inverse[i] = [x - factor * y for x, y in zip(inverse[i], inverse[k], strict=True)]
    return inverse
