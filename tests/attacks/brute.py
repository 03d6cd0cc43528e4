"""Random inputs of ``condition``, ``design`` and ``track``, judged by brute force from their definitions.

The judges use fractions, mpmath, numpy and scipy, and nothing of navsym. ``python -m tests.attacks.brute COUNT SEED``
prints what each verb got wrong.
"""

from __future__ import annotations

import itertools
import math
import random
import sys
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
from scipy.optimize import linprog

import navsym as nav

VERBS: dict[str, Callable[[random.Random], str | None]] = {}


def verb(attack: Callable[[random.Random], str | None]) -> Callable[[random.Random], str | None]:
    """Register an attack: what is wrong with one random answer, None if nothing."""
    VERBS[attack.__name__] = attack
    return attack


def draw(rng: random.Random, exponents: Sequence[int]) -> Fraction:
    """A positive fraction of small numbers times a power of ten."""
    return Fraction(rng.randint(1, 99), rng.randint(1, 99)) * Fraction(10) ** rng.choice(exponents)


# -- Condition numbers: singular values with enough digits ----------------------------------------------------------
def condition_of(rows: list[list[Fraction]], unit: bool, digits: int) -> mpmath.mpf:
    """The largest over the smallest singular value, of unit columns if asked for."""
    sizes = [abs(x) for row in rows for x in row]
    with mpmath.workdps(2 * len(str(int(max(sizes) / min(sizes)))) + 4 * len(rows) + digits + 30):
        matrix = mpmath.matrix([[mpmath.mpf(x.numerator) / x.denominator for x in row] for row in rows])
        for j in range(len(rows)):
            length = mpmath.norm(matrix[:, j]) if unit else 1
            matrix[:, j] = matrix[:, j] / length
        values = mpmath.svd_r(matrix, compute_uv=False)
        return max(values) / min(values)


@verb
def condition(rng: random.Random) -> str | None:
    """Enclosures hold the number and are narrow, the error of the double is right, the certificates are accepted."""
    n, digits = rng.choice((1, 1, 2, 2, 3, 4, 5, 6, 7)), rng.choice((1, 2, 3, 6, 15, 30, 50))
    tau, rho = draw(rng, (0, 0, 0, -3, 3, -20, 20)), rng.choice((1, -1)) * draw(rng, (0, 0, -7, -7, 7, -30, 40))
    found, asked = nav.condition(n, tau=tau, rho=str(rho), digits=digits), f"n {n}, tau {tau}, rho {rho}, {digits}"
    measured = [
        [Fraction(1), *(rho * (i * tau) ** j / math.factorial(j) for j in range(1, n))] for i in range(1, n + 1)
    ]
    powers = [[Fraction(i) ** j for j in range(n)] for i in range(1, n + 1)]
    for part, rows, unit in zip(found, (measured, measured, powers, powers), (False, True, False, True), strict=True):
        value = condition_of(rows, unit, digits)
        with mpmath.workdps(digits + 30):
            lower, upper = (mpmath.mpf(end) for end in (part.value.lower, part.value.upper))
            slack = value * mpmath.mpf(10) ** (-digits - 20)
            if not lower - slack <= value <= upper + slack:
                return f"{asked}: {part.name} is {mpmath.nstr(value, 30)}, said to lie in {lower} to {upper}"
            if upper - lower > 3 * value * mpmath.mpf(10) ** (1 - digits):
                return f"{asked}: {part.name} has fewer digits than were asked for"
            error = part.double / value - 1 if part.double is not None else None
            if error is not None and abs(error - part.relative_error) > 1e-6 * abs(error) + 1e-19:
                return f"{asked}: the double of {part.name} is off by {error}, not {part.relative_error}"
    return None if found.check().accepted else f"{asked}: the checker refuses a certificate"


# -- Designs: every purchase, every basic solution, in fractions -----------------------------------------------------
def solved(columns: list[list[Fraction]], wanted: list[Fraction]) -> list[Fraction] | None:
    """The weights with sum w_i H_i = wanted, None if the H_i are dependent or do not reach it."""
    k, rows = len(columns), [[c[j] for c in columns] + [wanted[j]] for j in range(len(wanted))]
    for c in range(k):
        pivot = next((i for i in range(c, len(rows)) if rows[i][c]), None)
        if pivot is None:
            return None
        rows[c], rows[pivot] = rows[pivot], rows[c]
        rows[c] = [x / rows[c][c] for x in rows[c]]
        rows = [r if i == c else [x - r[c] * y for x, y in zip(r, rows[c], strict=True)] for i, r in enumerate(rows)]
    return None if any(row[k] for row in rows[k:]) else [row[k] for row in rows[:k]]


def least_error(rows: list[tuple[list[Fraction], Fraction]], wanted: list[Fraction]) -> Fraction | None:
    """The least sum of sigma |w| with sum w H = wanted: some basic solution has it."""
    errors = []
    for size in range(1, len(wanted) + 1):
        for chosen in itertools.combinations(rows, size):
            weights = solved([H for H, _ in chosen], wanted)
            if weights is not None:
                errors.append(sum(abs(w) * s for w, (_, s) in zip(weights, chosen, strict=True)))
    return min(errors, default=None)


def least_of_purchases(
    rows: list[tuple[list[Fraction], Fraction, set[str]]],
    costs: dict[str, Fraction],
    budget: Fraction,
    P: list[Fraction],
) -> Fraction | None:
    """The least error of all selections within a budget; a row may be used if all that it needs is bought."""
    errors: list[Fraction | None] = []
    for bought in itertools.chain.from_iterable(itertools.combinations(costs, k) for k in range(len(costs) + 1)):
        if sum(costs[name] for name in bought) <= budget:
            errors.append(least_error([(H, s) for H, s, needs in rows if needs <= set(bought)], P))
    return min((e for e in errors if e is not None), default=None)


def flow(F: list[list[Fraction]], t: Fraction) -> list[list[Fraction]]:
    """exp(F t) of a strictly triangular F: a finite sum."""
    n = len(F)
    whole = power = [[Fraction(int(i == j)) for j in range(n)] for i in range(n)]
    for k in range(1, n):
        power = [[sum(row[m] * F[m][j] for m in range(n)) * t / k for j in range(n)] for row in power]
        whole = [[a + b for a, b in zip(*pair, strict=True)] for pair in zip(whole, power, strict=True)]
    return whole


def draw_offer(rng: random.Random, p: int, scale: Fraction) -> dict[str, Any]:
    """Some of p sensors, each with a cost or with grades."""
    offer: dict[str, Any] = {}
    for j in range(p):
        if rng.random() < 0.15 and offer:
            continue
        bounds = rng.sample((Fraction(1), Fraction(2), Fraction(3), Fraction(1, 2), Fraction(1, 4)), rng.randint(1, 2))
        grades = [(bound * scale, Fraction(rng.randint(0, 5), rng.choice((1, 3)))) for bound in bounds]
        offer[f"z{j + 1}"] = grades if rng.random() < 0.5 else Fraction(rng.randint(0, 4), rng.choice((1, 2)))
    return offer


@verb
def design(rng: random.Random) -> str | None:
    """The value holds the least error of all purchases, and no selection is missed or invented."""
    n, p = rng.choice((1, 2, 2, 3)), rng.choice((1, 1, 2, 2, 3))

    def entry() -> Fraction:
        return Fraction(rng.randint(-4, 4), rng.choice((1, 1, 2, 3)))

    F = [[entry() if j > i and rng.random() < 0.6 else Fraction(0) for j in range(n)] for i in range(n)]
    H, scale = [[entry() for _ in range(n)] for _ in range(p)], Fraction(10) ** rng.choice((0, 0, 0, -9, 9, -20, 15))
    if p > 1 and rng.random() < 0.3:
        H[1] = [rng.choice((0, 2)) * x for x in H[0]]  # one direction seen twice, or a sensor that sees nothing
    P, sigma = [entry() for _ in range(n)], [Fraction(rng.randint(1, 6), 2) * scale for _ in range(p)]
    P[rng.randrange(n)] = Fraction(rng.choice((1, -2)))
    unit = Fraction(10) ** rng.choice((0, 0, 0, -6, 6))
    times = sorted({Fraction(rng.randint(-4, 12), rng.choice((1, 2, 4))) * unit for _ in range(rng.randint(1, 4))})
    offer, instant = draw_offer(rng, p, scale), Fraction(rng.choice((0, 1, 1, 2)), rng.choice((1, 2)))
    budget, costs = Fraction(rng.randint(-1, 14), rng.choice((1, 2))), {f"t {t}": instant for t in times}
    rows = []
    for name, what in offer.items():
        j = int(name[1:]) - 1
        for bound, cost in what if isinstance(what, list) else [(sigma[j], what)]:
            costs[f"{name} {bound}"] = cost
            for t in times:
                turned = flow(F, t - times[-1])
                row = [sum(H[j][m] * turned[m][i] for m in range(n)) for i in range(n)]
                rows.append((row, bound, {f"t {t}", f"{name} {bound}"}))
    best = least_of_purchases(rows, costs, budget, P)
    model = nav.Model(
        states=[f"x{i}" for i in range(n)],
        F=[[*map(str, row)] for row in F],
        H=[[*map(str, row)] for row in H],
        sigma=[*map(str, sigma)],
        targets={"goal": [*map(str, P)]},
    )
    try:
        digits = rng.choice((1, 10, 40))
        found = nav.design(model, times=times, budget=budget, instant=instant, sensors=offer, digits=digits)
    except nav.NavsymError as error:
        return None if best is None and error.kind == "not-estimable" else f"{best}: {error} for {model.document()}"
    if best is None or not Fraction(found.value.lower) <= best <= Fraction(found.value.upper):
        return f"the least error is {best}, not {found}"
    return None if found.check().accepted and Fraction(found.cost) <= budget else f"{found} is refused or too dear"


# -- Tracks: polynomials by least squares and by linear programmes, on the ellipsoid ---------------------------------
LONG, FLAT = 6378137.0, 1 / 298.257223563  # WGS 84
SQUARED = FLAT * (2 - FLAT)  # of the eccentricity


def cartesian(latitude: float, longitude: float, height: float) -> np.ndarray:
    """A place in axes fixed to the Earth."""
    lat, lon = math.radians(latitude), math.radians(longitude)
    N = LONG / math.sqrt(1 - SQUARED * math.sin(lat) ** 2)
    level = (N + height) * math.cos(lat)
    return np.array([level * math.cos(lon), level * math.sin(lon), (N * (1 - SQUARED) + height) * math.sin(lat)])


def geodetic(place: np.ndarray) -> tuple[float, float, float]:
    """Latitude, longitude in degrees, and height, by iteration."""
    level = math.hypot(place[0], place[1])
    lat = math.atan2(place[2], level * (1 - SQUARED))
    for _ in range(30):
        N = LONG / math.sqrt(1 - SQUARED * math.sin(lat) ** 2)
        lat = math.atan2(place[2] + SQUARED * N * math.sin(lat), level)
    height = level * math.cos(lat) + place[2] * math.sin(lat) - LONG * math.sqrt(1 - SQUARED * math.sin(lat) ** 2)
    return math.degrees(lat), math.degrees(math.atan2(place[1], place[0])), height


def axes(latitude: float, longitude: float) -> np.ndarray:
    """East, North, Up as rows."""
    lat, lon = math.radians(latitude), math.radians(longitude)
    east = np.array([-math.sin(lon), math.cos(lon), 0.0])
    up = np.array([math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)])
    return np.stack([east, np.cross(up, east), up])


def draw_rows(rng: random.Random) -> tuple[np.ndarray, float, np.ndarray]:
    """Rows of a straight track with white errors, their deviation, and places in axes fixed to the Earth."""
    n, step, sigma = rng.choice((5, 6, 8, 12, 30)), rng.choice((1, 1, 0.1, 10, 0.02, 100)), rng.choice((0.01, 1, 30))
    numbers = np.random.default_rng(rng.getrandbits(32))
    t = np.arange(n) * step + (numbers.uniform(-0.3, 0.3, n) * step if rng.random() < 0.4 else 0.0)
    t = np.round(t, 6) + rng.choice((0, 0, 1e6, -50))
    lat, lon = rng.choice((0, 45, -33, 80, -90, 90, 89.9999)), rng.choice((0, 10, 179.9999, -179.99, 359, -180))
    speed = axes(lat, lon).T @ (numbers.normal(size=3) * [10, 10, 1])
    places = cartesian(lat, lon, rng.choice((0, 1e4, -50))) + np.outer(t - t[0], speed)
    places += numbers.normal(size=(n, 3)) * sigma
    rows = np.array([(time, *geodetic(place)) for time, place in zip(t, places, strict=True)])
    return rows, sigma, np.array([cartesian(*row[1:]) for row in rows])


def weigh(dt: np.ndarray, order: int, guaranteed: bool) -> tuple[np.ndarray | None, float]:
    """Weights of the speed at zero, exact for polynomials, and the deviation for errors of one metre.

    Of least squares; or the least sum of absolute weights, whose weights may be more than one solution.
    """
    unit = float(np.abs(dt).max())
    powers, m = np.vander(dt / unit, order, increasing=True), len(dt)
    if guaranteed:
        wanted = np.eye(order)[1]
        found = linprog(np.ones(2 * m), A_eq=np.hstack([powers.T, -powers.T]), b_eq=wanted, method="highs")
        return None, float(found.fun) / unit
    weights = np.linalg.pinv(powers)[1] / unit
    return weights, float(np.sqrt((weights**2).sum()))


@verb
def track(rng: random.Random) -> str | None:
    """Speeds and deviations of ``differences``, ``window`` and ``guaranteed`` are those of the definitions."""
    (rows, sigma, places), order = draw_rows(rng), rng.choice((2, 3, 4))
    step, n = float(np.median(np.diff(rows[:, 0]))), len(rows)
    for method in ("differences", "window", "guaranteed"):
        span = None if method == "differences" else rng.choice((5, 9, 100)) * step
        found = nav.track(rows, method=method, order=order, sigma=sigma, gate=0.0, window=span)
        for i in range(n):
            away = rows[:, 0] - rows[i, 0]
            first = min(max(i - 1, 0), n - 3)
            use = np.arange(first, first + 3) if span is None else np.flatnonzero(np.abs(away) <= span / 2)
            edge = span is not None and (np.abs(np.abs(away) - span / 2) < 1e-6 * step).any()
            if edge or (span is not None and len(use) < order + 2):
                continue
            weights, deviation = weigh(away[use], min(order, len(use)), method == "guaranteed")
            asked = f"{method} of order {order}, row {i} of {rows.tolist()}, {span} s"
            if np.abs(found.velocity_sd[i] / (deviation * sigma) - 1).max() > 1e-4:
                return f"{asked}: deviations {found.velocity_sd[i]}, not {deviation * sigma}"
            if weights is not None:
                speed = axes(*rows[i, 1:3]) @ (weights @ places[use])
                if np.abs(found.velocity[i] - speed).max() > 1e-4 * (np.abs(speed).max() + deviation * sigma):
                    return f"{asked}: speed {found.velocity[i]}, not {speed}"
    return None


def list_faults(name: str, numbers: range, seed: int) -> list[str]:
    """What is wrong with the answers to these random inputs of a verb."""
    answers = (VERBS[name](random.Random(f"{seed} {name} {number}")) for number in numbers)
    return [answer for answer in answers if answer is not None]


if __name__ == "__main__":
    count, start = map(int, sys.argv[1:])
    for verb_name in VERBS:
        faults = list_faults(verb_name, range(count), start)
        print(f"{verb_name}: {count} asked, {len(faults)} wrong", *faults, sep="\n  ")
