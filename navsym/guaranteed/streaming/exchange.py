"""The exchange over discrete measurements: doubles say where to look, balls decide every step.

Minimise ``sum_i w_i e_i + sigma_i |w_i|`` subject to ``sum_i w_i v_i = P``. Its dual: maximise ``P d`` over
``|v_i d - e_i| <= sigma_i``. With e = 0 the optimum is the least guaranteed error; with e the residuals of the data at
a reference state, d is the distance of a consistent state from there, and no d at all shows itself as weights with
``sum w_i v_i = 0`` and a negative cost (Farkas). Any m independent rows are a start, because weights may have
either sign (Dantzig; Bland 1977 for the rule against cycles).

Measurements that are bounded together are infinitely many: each combination ``a . z`` with its own bound. Those that a
dual breaks join the others until it breaks none (Kelley 1960).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite

import numpy as np
from flint import arb, arb_mat
from numpy.typing import NDArray

from navsym.core.simplex import independent_rows
from navsym.guaranteed.search.cones import Cone, largest, solve_touching

Array = NDArray[np.float64]

#: Unit roundoff of doubles, with room for the conversions from balls.
ROUNDING = 2.0**-50
MOST_EXCHANGES = 400
#: By how much of itself a bound of several measurements may be broken, and how often combinations join.
BEYOND, MOST_CUTS = arb("1e-24"), 200


@dataclass(slots=True)
class Cloud:
    """The measurements in memory.

    vectors : v_i, (1, m) balls each
    sigma   : noise bounds, balls
    scaled  : (N, m) doubles near v_i / sigma_i, relative error of each entry at most 2**-50
    offset  : e_i, balls; empty where all are zero
    shifted : (N,) doubles near e_i / sigma_i
    wide    : no entry of ``scaled`` is further than this, beside its rounding, from that of the ball
    first   : the rows before are no longer in memory; ``scaled``, ``shifted`` and ``active`` begin with this one
    active  : (N,) rows that may be used, None for all
    cones   : measurements that are bounded together, and their rows
    atoms   : combinations of rows that the exchange has put behind the others: rows and factors
    """

    vectors: Sequence[arb_mat]
    sigma: Sequence[arb]
    scaled: Array
    offset: Sequence[arb] = ()
    shifted: Array | None = None
    wide: float = 0.0
    first: int = 0
    active: NDArray[np.bool_] | None = None
    cones: Sequence[tuple[Cone, Sequence[int]]] = ()
    atoms: list[tuple[Sequence[int], arb_mat]] = field(default_factory=list)

    def combine(self, cone: Cone, places: Sequence[int], factors: arb_mat) -> None:
        """Put a combination of rows behind the others, with the bound that it has by its cone."""
        a, sigma = factors.entries(), cone.cost(factors)
        vector = sum((self.vectors[i] * f for i, f in zip(places, a, strict=True)), self.vectors[places[0]] * 0)
        self.vectors, self.sigma = [*self.vectors, vector], [*self.sigma, sigma]
        scaled = [e / sigma for e in vector.entries()]
        self.scaled = np.vstack([self.scaled, [float(e.mid()) for e in scaled]])
        self.wide = max(self.wide, *(float(e.rad()) for e in scaled))
        if self.offset and self.shifted is not None:
            offset = sum((self.offset[i] * f for i, f in zip(places, a, strict=True)), arb(0))
            self.offset, self.shifted = [*self.offset, offset], np.append(self.shifted, float((offset / sigma).mid()))
        if self.active is not None:
            self.active = np.append(self.active, True)
        self.atoms = [*self.atoms, (places, factors)]

    def parts(self, i: int) -> tuple[Sequence[int], arb_mat]:
        """The rows of a combination with their factors; of a row itself and 1."""
        k = i - len(self.vectors) + len(self.atoms)
        return self.atoms[k] if k >= 0 else ([i], arb_mat([[1]]))

    def may_use(self, i: int) -> bool:
        """Whether a row is active."""
        return self.active is None or bool(self.active[i - self.first])

    def spread(self, found: Optimum) -> dict[int, arb]:
        """Weights of rows, from those of rows and combinations in an optimum or a ray."""
        done: dict[int, arb] = {}
        weights = found.ray or dict(zip(found.basis, found.weights.entries(), strict=True))
        for i, w in weights.items():
            places, factors = self.parts(i)
            for place, factor in zip(places, factors.entries(), strict=True):
                done[place] = done.get(place, arb(0)) + w * factor
        return done

    def start(self) -> list[int] | None:
        """m rows that are far from dependent; None where there are too few."""
        m = self.scaled.shape[1]
        places = np.arange(len(self.scaled)) if self.active is None else np.flatnonzero(self.active)
        if len(places) < m:
            return None
        rows = self.scaled[places]
        size = np.abs(rows).max(axis=0)
        rows = rows / np.where(size > 0.0, size, 1.0)
        rows = rows / np.maximum(np.abs(rows).max(axis=1), 1e-300)[:, None]
        return [int(places[k]) + self.first for k in independent_rows(rows, m)]

    def suspects(self, x: Array, radii: Array, known: Sequence[int] = ()) -> list[int]:
        """Rows, but for those known, whose bound doubles do not see kept by all vectors of a ball; the worst first."""
        rounding, far = ROUNDING * (len(x) + 4), np.abs(x)
        size = np.abs(self.scaled @ x if self.shifted is None else self.scaled @ x - self.shifted)
        slack = np.abs(self.scaled) @ (far * rounding + radii) + (self.wide * float((far + radii).sum()) + 1e-12)
        if self.shifted is not None:
            slack += np.abs(self.shifted) * rounding
        kept = size + slack <= 1.0
        if self.active is not None:
            kept |= ~self.active
        kept[[i - self.first for i in known]] = True
        places = np.flatnonzero(~kept)
        if len(places) > 1:
            places = places[np.argsort(-size[places], kind="stable")]
        return [int(i) + self.first for i in places]

    def gauge(self, x: arb_mat, rows: Sequence[int]) -> arb:
        """The largest part of its bound that an error of some rows, or of rows bounded together, takes at x."""
        parts = [abs(self.excess(i, x)) / self.sigma[i] for i in rows]
        for cone, places in self.cones:
            if self.may_use(places[0]):
                parts.append(cone.gauge(arb_mat([[self.excess(i, x)] for i in places])))
        size = largest(parts or [arb(0)])
        return arb(size.upper()) if size.is_finite() else arb("inf")

    def excess(self, i: int, x: arb_mat) -> arb:
        """``v_i x - e_i``."""
        value = (self.vectors[i] * x)[0, 0]
        return value - self.offset[i] if self.offset else value


@dataclass(slots=True)
class Optimum:
    """A basis with its weights and dual.

    basis, signs : rows, and the signs with which their weights enter
    inverse      : of the matrix with these rows
    weights      : (1, m), ``weights @ rows = P``
    dual         : (m, 1), ``row d = e + sign sigma`` on the basis
    ratio        : at least ``|v_i d - e_i| / sigma_i`` for every row
    ray          : row -> weight where there is no d: ``sum w v = 0``, ``sum w e + sigma |w| < 0``
    """

    basis: list[int]
    signs: list[int]
    inverse: arb_mat
    weights: arb_mat
    dual: arb_mat
    ratio: arb = field(default_factory=lambda: arb(1))
    ray: dict[int, arb] | None = None


def exchange(cloud: Cloud, target: arb_mat, basis: Sequence[int], signs: Sequence[int] = ()) -> Optimum | None:
    """The optimum from a start; None where the rows are not seen to be independent, or the limit is met."""
    found = exchange_rows(cloud, target, basis, signs)
    if not cloud.cones:
        return found
    before = None
    for _ in range(MOST_CUTS):
        if found is None or found.ray is not None:
            break
        support = list_touching(cloud, found)
        if support[:2] == before:
            sharp = sharpen(cloud, target, found.dual, *support)
            if sharp is not None:
                return sharp
        before = support[:2]
        if not cut_cones(cloud, found):
            return found
        found = exchange_rows(cloud, target, found.basis, found.signs)
    if found is not None:
        found.ratio = found.ratio.max(cloud.gauge(found.dual, []))
    return found


def list_touching(cloud: Cloud, found: Optimum) -> tuple[list[int], list[int], list[float]]:
    """Balls and other rows that carry weight in an optimum, by their places, and how much."""
    owner = {i: k for k, (cone, places) in enumerate(cloud.cones) if cone.norm == "l2" for i in places}
    weights = to_doubles(found.weights)
    balls, rows = dict[int, float](), dict[int, float]()
    for i, w in zip(found.basis, weights, strict=True):
        k = owner.get(cloud.parts(i)[0][0])
        if abs(w) > 1e-9 * np.abs(weights).max():
            if k is None:
                rows[i] = w
            else:
                balls[k] = balls.get(k, 0.0) + abs(w) * float(cloud.sigma[i].mid())
    order = sorted(balls), sorted(rows)
    return *order, [*(balls[k] for k in order[0]), *(rows[i] for i in order[1])]


def sharpen(
    cloud: Cloud, target: arb_mat, x: arb_mat, balls: Sequence[int], rows: Sequence[int], start: Sequence[float]
) -> Optimum | None:
    """The optimum where these balls and rows touch, as a basis of their faces and of rows without weight, or None."""
    m, cones = target.ncols(), [cloud.cones[k] for k in balls]
    if not balls or len(balls) + len(rows) > m:
        return None
    signs = [1 if w > 0 else -1 for w in start[len(balls) :]]
    offset = cloud.offset or [arb(0)] * len(cloud.vectors)
    solved = solve_touching(
        [(cone, stack(cloud.vectors[i] for i in at), arb_mat([[offset[i]] for i in at])) for cone, at in cones],
        stack((cloud.vectors[i] for i in rows), m),
        arb_mat(len(rows), 1, [offset[i] + cloud.sigma[i] * s for i, s in zip(rows, signs, strict=True)]),
        target,
        [*to_doubles(x.transpose()), *start],
    )
    if solved is None or not all(u * s > 0 for u, s in zip(solved[m:], [1] * len(balls) + signs, strict=True)):
        return None
    dual = arb_mat([[e] for e in solved[:m]])
    ratio = cloud.gauge(dual, cloud.suspects(to_doubles(dual.transpose()), np.zeros(m))).max(arb(1))
    if not ratio <= 1 + BEYOND:
        return None
    faces = [cone.face(arb_mat([[cloud.excess(i, dual)] for i in at])) for cone, at in cones]
    normals = [
        face.transpose() * stack(cloud.vectors[i] for i in at) for face, (_, at) in zip(faces, cones, strict=True)
    ]
    lines = [*map(to_doubles, normals), *(cloud.scaled[i - cloud.first] for i in rows)]
    more = complete_basis(cloud, np.array(lines), [i for _, places in cones for i in places])
    if len(lines) + len(more) < m:
        return None
    end = len(cloud.vectors)
    for face, (cone, places) in zip(faces, cones, strict=True):
        cloud.combine(cone, places, face)
    found = solve_basis(cloud, target, [*range(end, end + len(cones)), *rows, *more], [])
    return None if found is None else replace(found, dual=dual, ratio=ratio)


def stack(rows: Iterable[arb_mat], m: int = 0) -> arb_mat:
    """Rows (1, m) below each other."""
    entries = [row.entries() for row in rows]
    return arb_mat(entries) if entries else arb_mat(0, m)


def complete_basis(cloud: Cloud, lines: Array, near: Sequence[int]) -> list[int]:
    """Rows that make a basis of some independent lines: of those near, if these are enough; fewer where none do."""
    rows, first = cloud.scaled, cloud.first
    lack, units = rows.shape[1] - len(lines), np.abs(rows).max(axis=0) + 1e-300
    rows, turn = rows / units, np.linalg.qr((lines / units).T)[0]
    for places in (near, [i + first for i in range(len(rows)) if cloud.may_use(i + first)]):
        rest = rows[np.array(places) - first]
        size = np.linalg.norm(rest, axis=1).max()
        chosen = independent_rows(rest - rest @ turn @ turn.T, lack, 1e-9 * size)
        if len(chosen) == lack:
            break
    return [places[int(k)] for k in chosen]


def cut_cones(cloud: Cloud, found: Optimum) -> bool:
    """Put combinations in where the dual breaks bounds of several measurements; whether it does.

    Doubles see most of it; balls look at all where they see none.
    """
    before = len(cloud.atoms)
    cones = [(cone, places) for cone, places in cloud.cones if cloud.may_use(places[0])]
    parts = cloud.scaled @ to_doubles(found.dual.transpose()) - (0.0 if cloud.shifted is None else cloud.shifted)
    beyond = [pair for pair in cones if not pair[0].estimate(parts[np.array(pair[1]) - cloud.first]) < 1.0 + 1e-9]
    for some in (beyond, cones):
        for cone, places in some:
            y = arb_mat([[cloud.excess(i, found.dual)] for i in places])
            size = cone.gauge(y)
            found.ratio = found.ratio.max(arb(size.upper())) if size.is_finite() else arb("inf")
            if size > 1 + BEYOND:
                cloud.combine(cone, places, cone.face(y))
        if len(cloud.atoms) > before:
            return True
    return False


def exchange_rows(cloud: Cloud, target: arb_mat, basis: Sequence[int], signs: Sequence[int] = ()) -> Optimum | None:
    """The optimum over single rows."""
    found = solve_basis(cloud, target, *rehearse(cloud, to_doubles(target), list(basis), list(signs)))
    if found is None:
        found = solve_basis(cloud, target, list(basis), list(signs))
    for count in range(MOST_EXCHANGES):
        if found is None:
            return None
        entering = violated_row(cloud, found, bland=count > MOST_EXCHANGES // 2)
        if entering is None:
            return found
        leave, along = leaving_place(found, cloud, *entering)
        if leave < 0:
            enter, sign = entering
            found.ray = {i: -a * sign for i, a in zip(found.basis, along, strict=True) if not a.is_zero()}
            found.ray[enter] = arb(sign)
            return found if cost_of(cloud, found.ray) < 0 else None
        found.basis[leave], found.signs[leave] = entering
        found = solve_basis(cloud, target, found.basis, found.signs)
    return None


def to_doubles(row: arb_mat) -> Array:
    """The middles of a row of balls."""
    return np.array([float(e) for e in row.entries()])


def rehearse(cloud: Cloud, target: Array, basis: list[int], signs: list[int]) -> tuple[list[int], list[int]]:
    """The same exchange in doubles: a better start, or the same where doubles do not see the way."""
    rows, first, shifted = cloud.scaled, cloud.first, cloud.shifted
    places = [i - first for i in basis]
    try:
        inverse = np.linalg.inv(rows.take(places, axis=0))
    except np.linalg.LinAlgError:
        return basis, signs
    weights, given = target.dot(inverse), signs or [1] * len(basis)
    side = np.array([1.0 if w > 0.0 else -1.0 if w < 0.0 else s for w, s in zip(weights.tolist(), given, strict=True)])
    for _ in range(4 * len(basis) + 8):
        f = rows.dot(inverse.dot(side if shifted is None else side + shifted[places]))
        if shifted is not None:
            f -= shifted
        size = np.abs(f) if cloud.active is None else np.abs(f) * cloud.active
        enter = int(size.argmax())
        if not size[enter] < np.inf:
            return basis, signs
        if size[enter] <= 1.0 + 1e-9 or enter in places:
            break
        along, towards = rows[enter].dot(inverse), 1.0 if f[enter] > 0.0 else -1.0
        leave, least = -1, np.inf
        for k, (a, w, s) in enumerate(zip(along.tolist(), weights.tolist(), side.tolist(), strict=True)):
            slope = s * a * towards
            if slope > 1e-9 and abs(w) / slope < least:
                leave, least = k, abs(w) / slope
        if leave < 0:
            break
        column = inverse[:, leave] / along[leave]
        along[leave] -= 1.0
        inverse -= column[:, None] * along  # Sherman and Morrison
        places[leave], side[leave] = enter, towards
        weights = target.dot(inverse)
    return [k + first for k in places], [int(s) for s in side]


def solve_basis(cloud: Cloud, target: arb_mat, basis: list[int], signs: list[int]) -> Optimum | None:
    """Weights and dual of a basis; a weight of certain sign has that sign, the others keep the one they came with."""
    try:
        inverse = arb_mat([cloud.vectors[i].entries() for i in basis]).inv()
    except ZeroDivisionError:
        return None
    return price_basis(cloud, target, basis, signs, inverse)


def price_basis(cloud: Cloud, target: arb_mat, basis: list[int], signs: list[int], inverse: arb_mat) -> Optimum:
    """The same for an inverse that is known."""
    weights = target * inverse
    entries = weights.entries()
    signs = [1 if w > 0 else -1 if w < 0 else s for w, s in zip(entries, signs or [1] * len(basis), strict=True)]
    side = [[cloud.sigma[i] * s + (cloud.offset[i] if cloud.offset else 0)] for i, s in zip(basis, signs, strict=True)]
    return Optimum(basis, signs, inverse, weights, inverse * arb_mat(side))


def violated_row(cloud: Cloud, found: Optimum, *, bland: bool = False) -> tuple[int, int] | None:
    """The row that breaks its bound most, as doubles order them, or the first; None where none is seen to."""
    entries = found.dual.entries()
    x, radii = [*map(float, entries)], [float(e.rad()) for e in entries]
    found.ratio = arb(1)
    if all(map(isfinite, x + radii)):
        suspects = cloud.suspects(np.array(x), np.array(radii) * (1.0 + ROUNDING), found.basis)
    else:  # doubles see nothing here
        rows = range(cloud.first, len(cloud.vectors))
        suspects = [i for i in rows if cloud.may_use(i) and i not in found.basis]
    for i in sorted(suspects) if bland else suspects:
        value, bound = cloud.excess(i, found.dual), cloud.sigma[i]
        if value > bound or value < -bound:
            return i, 1 if value > 0 else -1
        if not (value <= bound and value >= -bound):
            size = arb((abs(value) / bound).upper())
            found.ratio = found.ratio.max(size) if size.is_finite() else arb("inf")
    return None


def leaving_place(found: Optimum, cloud: Cloud, enter: int, sign: int) -> tuple[int, list[arb]]:
    """The place of the basis whose weight vanishes first; -1 where none does."""
    along = (cloud.vectors[enter] * found.inverse).entries()
    best, least, pivot = -1, np.inf, 0.0
    for k, (a, w, s) in enumerate(zip(along, found.weights.entries(), found.signs, strict=True)):
        slope = s * sign * float(a.mid())
        if slope > 0.0 and not a.contains(0):
            step = max(s * float(w.mid()), 0.0) / slope
            if step < least or (step == least and slope > pivot):
                best, least, pivot = k, step, slope
    return best, along


def cost_of(cloud: Cloud, weights: dict[int, arb]) -> arb:
    """``sum w e + sigma |w|``."""
    return sum(
        ((w * cloud.offset[i] if cloud.offset else arb(0)) + cloud.sigma[i] * abs(w) for i, w in weights.items()),
        arb(0),
    )


def bounds_of(cloud: Cloud, found: Optimum) -> tuple[arb, arb]:
    """Bounds of the optimum with e = 0: ``P d`` of the dual, shrunk to feasible, and the cost of the weights."""
    lower, upper = arb(0), arb(0)
    for i, s, w in zip(found.basis, found.signs, found.weights.entries(), strict=True):
        part = cloud.excess(i, found.dual) if cloud.cones else cloud.sigma[i] * s
        lower, upper = lower + part * w, upper + cloud.sigma[i] * abs(w)
    return lower / found.ratio, upper
