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
#: The search over balls is for a target that differs from the true one by this part of its cost.
NEAR = 1e-11
#: A search from the last support that leaves the bounds further apart than this part of them begins anew.
FAR = 1e-6

Row = Sequence[float]
Matrix = list[list[float]]
#: Measurements that are bounded together: their places; the shape of a ball, or () where their sizes add up to one; and
#: the largest root of an entry of the diagonal of its inverse.
Group = tuple[Sequence[int], Sequence[Row], float]
#: A combination of measurements: lag, group, and factors of its members.
Atom = tuple[int, int, list[float]]
Step = tuple[int, float, float, float]
NOTHING = (math.nan, math.nan, math.nan)


@dataclass(slots=True)
class Support:
    """Rows of a support with their magnitudes, inverse, weights, dual, and what breaks its bound most."""

    atoms: list[Atom]
    rows: Matrix
    sizes: Matrix
    inverse: Matrix
    columns: Matrix
    weight: list[float] = field(default_factory=list)
    dual: list[float] = field(default_factory=list)
    ratio: float = 1.0
    enter: Atom | None = None


@dataclass(slots=True)
class StreamingRule:
    """The memory of a stream, and the support of its last optimum, where the next search begins.

    table  : regressors of every lag and measurement, row lag * measurements + measurement
    target : functional at the time of the epoch
    sigma  : bounds of the measurements
    tiny   : errors of table and target beyond half a unit of the last place
    lags   : epochs in memory
    groups : all measurements, each once; one by itself is a group of one
    """

    table: Sequence[Row]
    target: Row
    sigma: Row
    tiny: float
    lags: int
    groups: Sequence[Group]
    epochs: list[tuple[Row, Row]] = field(default_factory=list)  # the newest first
    support: list[Atom] = field(default_factory=list)
    sign: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.support, self.sign = [(-1, 0, [])] * len(self.target), [1.0] * len(self.target)

    @property
    def wide(self) -> int:
        """The most measurements of a group."""
        return max(len(members) for members, *_ in self.groups)

    @property
    def gamma(self) -> float:
        """Bound of a sum of products and of the rounding of its table, relative to the sum of magnitudes."""
        return (len(self.target) * self.wide + 8) * 1.1102230246251565e-16

    @property
    def near(self) -> float:
        """Bounds are broken by more than this part of themselves where a search goes on."""
        return 1e-10 if any(shape for _, shape, _ in self.groups) else 1e-12

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
        if answer is None or answer[1] - answer[2] > FAR * answer[1]:
            if not self.spread():
                self.support[0] = (-1, 0, [])
                return NOT_ESTIMABLE, *NOTHING
            answer = self.certify(self.exchange())
        if answer is None:
            self.support[0] = (-1, 0, [])
            return NOT_CERTIFIED, *NOTHING
        return (OK, *answer)

    # Combinations of measurements

    def has(self, lag: int, j: int) -> bool:
        """Whether a measurement was made."""
        return 0 <= lag < len(self.epochs) and not math.isnan(self.epochs[lag][0][j])

    def row(self, lag: int, j: int) -> Row:
        """Its regressor."""
        return self.table[lag * len(self.sigma) + j]

    def combine(self, lag: int, group: int, factors: Row) -> tuple[list[float], list[float]]:
        """The regressor of a combination, and the magnitudes of what it is added up from."""
        total, size = [0.0] * len(self.target), [0.0] * len(self.target)
        for factor, j in zip(factors, self.groups[group][0], strict=True):
            for k, h in enumerate(self.row(lag, j)):
                term = factor * h
                total[k] += term
                size[k] += abs(term)
        return total, size

    def cost(self, lag: int, group: int, factors: Row) -> float:
        """The largest error of a combination, rounding included but for a few units."""
        members, shape, _ = self.groups[group]
        largest = total = size = 0.0
        parts = [f * self.epochs[lag][1][j] if abs(f) > 0.0 else 0.0 for f, j in zip(factors, members, strict=True)]
        for part in parts:
            largest = abs(part) if abs(part) > largest else largest
        for part, row in zip(parts, shape, strict=bool(shape)):
            value, sizes = add_products(row, parts)
            total += part * value
            size += abs(part) * sizes
        return math.sqrt((total if total > 0.0 else 0.0) + (self.gamma * size)) if shape else largest

    def gauge(self, lag: int, group: int, found: Support, total: float, worst: float) -> tuple[float, float]:
        """(largest, least) part of its bound that the errors of a group take at a dual; beyond worst its face enters.

        total : sum of the magnitudes of the dual
        """
        members, shape, reach = self.groups[group]
        y, c = [0.0] * len(members), [0.0] * len(members)
        root = slack = largest = 0.0
        least = LARGEST
        for k, j in enumerate(members):
            if self.has(lag, j):
                bound = self.epochs[lag][1][j]
                value, size = add_products(self.row(lag, j), found.dual)
                y[k], c[k] = value / bound, 1.0 if value >= 0.0 else -1.0
                root += abs(y[k])
                slack += ((self.gamma * size) + (self.tiny * total) + SMALLEST) / bound
                least = bound if bound < least else least
        if shape:
            use = [1.0 if self.has(lag, j) else 0.0 for j in members]
            c, quad, quads = solve_shape(shape, use, y), 0.0, 0.0
            for k, one in enumerate(use):
                if one > 0.0:
                    value, size = add_products(shape[k], c)
                    slack += abs(y[k] - value) + (self.gamma * (size + abs(y[k])))
                    quad += c[k] * value
                    quads += abs(c[k]) * size
            root = math.sqrt((quad if quad > 0.0 else 0.0) + (self.gamma * quads))
        slack *= reach
        sure = root - (4.0 * slack)
        if sure > worst:
            for x in c:
                largest = abs(x) if abs(x) > largest else largest
            face = [0.0] * len(members)
            for k, j in enumerate(members):
                if abs(c[k]) > 0.0:
                    face[k] = (c[k] / largest) * (least / self.epochs[lag][1][j])
            found.enter = (lag, group, face)
        return root + slack, sure

    # The search

    def keep(self) -> bool:
        """The last support at the lags that it had, or moved on with its epochs; False where neither is in memory."""
        for shift in (0, 1):
            if self.support[0][0] >= 0 and all(self.can_shift(*atom, shift) for atom in self.support):
                self.support = [(lag + shift, group, factors) for lag, group, factors in self.support]
                return True
        return False

    def can_shift(self, lag: int, group: int, factors: Row, shift: int) -> bool:
        """Whether all measurements of a combination were made so many epochs before as well."""
        pairs = zip(factors, self.groups[group][0], strict=True)
        return all(self.has(lag + shift, j) for factor, j in pairs if abs(factor) > 0.0)

    def exchange(self) -> Support | None:
        """The worst combination enters until none breaks its bound; None where a support is singular."""
        found = self.solve(self.target)
        goal = self.target if self.wide == 1 or found is None else self.perturb(found)
        found = found if self.wide == 1 else self.solve(goal)
        for _ in range(MOST_EXCHANGES * self.wide * self.wide):
            if found is None or found.enter is None:
                return found
            leave = self.leave(found)
            if leave < 0:
                return found
            self.support[leave], self.sign[leave] = found.enter, 1.0
            found = self.solve(goal)
        return found

    def perturb(self, found: Support) -> list[float]:
        """A target near the true one without weights that are zero: among these a search goes in circles."""
        goal, cost = list(self.target), 0.0
        for w, atom in zip(found.weight, found.atoms, strict=True):
            cost += abs(w) * self.cost(*atom)
        for k, (row, atom) in enumerate(zip(found.rows, found.atoms, strict=True)):
            part = self.sign[k] * NEAR * (k + 1.0) * (cost / self.cost(*atom))
            for i, h in enumerate(row):
                goal[i] += part * h
        return goal

    def solve(self, goal: Row) -> Support | None:
        """Weights and dual of the present support for a target."""
        found = self.invert()
        if found is None:
            return None
        wanted = []
        for k, column in enumerate(found.columns):
            found.weight.append(add_products(goal, column)[0])
            if abs(found.weight[k]) > 0.0:
                self.sign[k] = 1.0 if found.weight[k] > 0.0 else -1.0
            wanted.append(self.sign[k] * self.cost(*self.support[k]))
        found.dual = [add_products(row, wanted)[0] for row in found.inverse]
        self.price(found)
        return found

    def invert(self) -> Support | None:
        """The rows of the present support and their inverse; None where they are not seen to be independent."""
        pairs = [self.combine(*atom) for atom in self.support]
        inverse = invert([row for row, _ in pairs])
        if inverse is None:
            return None
        columns = [list(column) for column in zip(*inverse, strict=True)]
        return Support([*self.support], [row for row, _ in pairs], [size for _, size in pairs], inverse, columns)

    def price(self, found: Support) -> None:
        """What breaks its bound most, by more than rounding; ratio encloses the largest break from above."""
        worst, total = 1.0 + self.near, 0.0
        for x in found.dual:
            total += abs(x)
        for lag in range(len(self.epochs)):
            for group in range(len(self.groups)):
                high, sure = self.gauge(lag, group, found, total, worst)
                high = high if high <= LARGEST else math.inf  # also where it is no number
                found.ratio = found.ratio if high <= found.ratio else high
                worst = sure if sure > worst else worst

    def leave(self, found: Support) -> int:
        """The place of the support whose weight vanishes first as the row enters; -1 where none does."""
        least, steepest, best = LARGEST, 0.0, -1
        row = self.combine(*found.enter)[0]  # type: ignore[misc]
        for k, column in enumerate(found.columns):
            along, size = add_products(row, column)
            slope = self.sign[k] * along
            if slope > 1e-11 * size:
                step = abs(found.weight[k]) / slope
                if step < least or (step <= least and slope > steepest):
                    best, least, steepest = k, step, slope
        return best

    def spread(self) -> bool:
        """A first support: each row is as far as possible from the span of those before."""
        q: Matrix = []
        for k in range(len(self.target)):
            most, best, chosen = 1e-20, None, [0.0]
            for lag in range(len(self.epochs)):
                for group, (members, *_) in enumerate(self.groups):
                    for place, j in enumerate(members):
                        if not self.has(lag, j):
                            continue
                        v = list(self.row(lag, j))
                        whole = add_products(v, v)[0]
                        for other in q:
                            part = add_products(v, other)[0]
                            v = [a - part * b for a, b in zip(v, other, strict=True)]
                        rest = add_products(v, v)[0]
                        if rest > most * whole:
                            most = rest / whole
                            best = lag, group, [1.0 if i == place else 0.0 for i in range(len(members))]
                            chosen = [a / math.sqrt(rest) for a in v]
            if best is None:
                return False
            q.append(chosen)
            self.support[k], self.sign[k] = best, 1.0
        return True

    # The bounds

    def certify(self, found: Support | None) -> tuple[float, float, float] | None:
        """Estimate, radius and least; None where rounding errors leave no bound.

        With E = 1 - V A and the rest r = P - w V the exact weights are w + r A (1 - E)**-1, so that
        sum u |exact - w| <= sum u |r A| / (1 - q) with u = sigma + |z|, q the norm of E with weights u. Combinations of
        one group are nearly dependent where a ball is touched: V is then a support that is far from it.
        """
        base = self.spread_basis() if found is not None and self.wide > 1 else found
        if found is None or base is None:
            return None
        weight = [add_products(self.target, column)[0] for column in found.columns]
        cost = value = values = weights = 0.0
        sums, sizes, done = [0.0] * len(self.target), [abs(p) for p in self.target], set[tuple[int, int]]()
        for lag, group, factors in found.atoms:
            if (lag, group) in done:
                continue
            done.add((lag, group))
            own = [0.0] * len(factors)
            for w, (at, other, more) in zip(weight, found.atoms, strict=True):
                if (at, other) == (lag, group):
                    own = [a + w * b for a, b in zip(own, more, strict=True)]
            cost += self.cost(lag, group, own)
            for w, j in zip(own, self.groups[group][0], strict=True):
                if abs(w) > 0.0:
                    z = self.epochs[lag][0][j]
                    value += w * z
                    values += abs(w) * abs(z)
                    weights += abs(w)
                    for i, h in enumerate(self.row(lag, j)):
                        sums[i] += w * h
                        sizes[i] += abs(w * h)
        both = [self.reach(*atom) for atom in base.atoms]
        q = self.defect(base, both)
        if not q < 0.5:
            return None
        drift, gamma, tiny = 0.0, self.gamma, self.tiny * (1.0 + weights)
        rest = [
            abs(p - total) + (gamma * size) + tiny + SMALLEST
            for p, total, size in zip(self.target, sums, sizes, strict=True)
        ]
        for i, u in enumerate(both):
            for j, r in enumerate(rest):
                drift += r * abs(base.inverse[j][i]) * u
        drift = (drift + SMALLEST) / (0.999 - q)
        radius = (cost + drift + (gamma * values) + SMALLEST) * UP
        low, size = add_products(self.target, found.dual)
        total = 0.0
        for x in found.dual:
            total += abs(x)
        low -= ((gamma * size) + (self.tiny * total) + SMALLEST) * UP
        least = (low / found.ratio) * DOWN if low > 0.0 else 0.0
        good = radius <= LARGEST and least >= 0.0 and abs(value) <= LARGEST
        return (value, radius, least) if good else None

    def spread_basis(self) -> Support | None:
        """The first support of the present memory."""
        kept = [*self.support], [*self.sign]
        found = self.invert() if self.spread() else None
        self.support, self.sign = kept
        return found

    def reach(self, lag: int, group: int, factors: Row) -> float:
        """sum of sigma + |z| of a combination, times its factors."""
        total = 0.0
        for factor, j in zip(factors, self.groups[group][0], strict=True):
            if abs(factor) > 0.0:
                total += abs(factor) * (self.epochs[lag][1][j] + abs(self.epochs[lag][0][j]))
        return total

    def defect(self, found: Support, size: Sequence[float]) -> float:
        """Bound of the norm of 1 - V A with weights."""
        q, gamma = 0.0, self.gamma
        for i, (row, sizes) in enumerate(zip(found.rows, found.sizes, strict=True)):
            norm, factors = 0.0, 0.0
            for factor in found.atoms[i][2]:
                factors += abs(factor)
            for j, column in enumerate(found.columns):
                one, total = 1.0 if i == j else 0.0, 0.0
                for entry in column:
                    total += abs(entry)
                value, whole = add_products(row, column)[0], add_products(sizes, column)[1]
                error = abs(one - value) + (gamma * (whole + one)) + (self.tiny * factors * total) + SMALLEST
                norm += error * (size[j] / size[i])
            q = q if norm <= q else norm
        return q


def solve_shape(shape: Sequence[Row], use: Row, y: Row) -> list[float]:
    """A vector near the inverse of the shape of the members in use times y, by elimination; zero elsewhere."""
    a, c = [list(row) for row in shape], list(y)
    for k in range(len(c)):
        if use[k] > 0.0:
            for i in range(k + 1, len(c)):
                factor = (use[i] * a[i][k]) / a[k][k]
                for j in range(k, len(c)):
                    a[i][j] -= factor * a[k][j]
                c[i] -= factor * c[k]
    for k in reversed(range(len(c))):
        for j in range(k + 1, len(c)):
            c[k] -= a[k][j] * c[j]
        c[k] = (use[k] * c[k]) / a[k][k]
    return c


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
