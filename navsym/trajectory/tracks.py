"""From positions to velocity and acceleration: tracks with gaps, jitter and outliers.

A track is differentiated in Cartesian axes fixed to the Earth and parallel to East, North, Up at the most central
of its points; velocity and acceleration are then turned to East, North, Up at each row. Poles and the 180th
meridian are ordinary points there. The noise of the positions and of the motion is found from the track
itself by maximum likelihood, East and North together, Up for itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from functools import partial
from itertools import zip_longest

import numpy as np
from numpy.typing import NDArray

from navsym.core.arrays import Array, as_array, freeze
from navsym.core.errors import DomainError, EmptyError, ShapeError
from navsym.models.earth import cartesian, local_axes
from navsym.trajectory.kernels.tracks import misfit

Rows = NDArray[np.int64]
Mask = NDArray[np.bool_]

#: A step longer than this many usual steps is a gap.
GAP = 5.0
#: Interpolation residual, in robust standard deviations, beyond which a row is an isolated outlier.
ISOLATED = 12.0
#: An isolated outlier is also beyond what half of this acceleration does in one step, m/s^2.
PLAUSIBLE = 10.0
#: Positions are never taken to be better than a thousandth of their given standard deviation, or a millimetre.
SMALLEST_SCALE = 1e-6
LARGEST_ORDER = 6
#: Steps in seconds: beyond them powers of the step, up to the eleventh, leave the range of a double.
SHORTEST, LONGEST = 1e-9, 1e9


@dataclass(frozen=True, slots=True, eq=False)
class Positions:
    """Positions in metres and how to turn vectors back.

    t        : (N,) seconds, strictly increasing
    position : (N, 3) East, North, Up axes of the most central row, metres
    variance : (N, 3) variances of the positions up to a common factor, m^2
    turn     : (N, 3, 3) from those axes to East, North, Up of each row
    widest   : deviations of position and speed that are wide in the scale of the track, found at construction
    """

    t: Array
    position: Array
    variance: Array
    turn: Array
    widest: tuple[float, float] = field(init=False)

    def __post_init__(self) -> None:
        N = len(self.t)
        put = partial(object.__setattr__, self)
        put("t", as_array("t", self.t, (N,), "one entry per row"))
        put("position", as_array("position", self.position, (N, 3), "rows by East, North, Up"))
        put("variance", as_array("variance", self.variance, (N, 3), "rows by East, North, Up"))
        put("turn", as_array("turn", self.turn, (N, 3, 3), "one rotation per row"))
        if not (self.variance > 0).all():
            least = float(self.variance.min())
            raise DomainError(f"variance: expected positive numbers; got {least:g}; leave them out if unknown")
        late = np.flatnonzero(np.diff(self.t) <= 0)
        if late.size:
            raise DomainError(
                f"t: expected increasing times; got row {late[0] + 1} not after row {late[0]}; "
                "sort the rows and keep one of equal times"
            )
        steps = np.diff(self.t)
        if steps.size and not (steps.min() >= SHORTEST and steps.max() <= LONGEST):
            raise DomainError(
                f"t: expected steps of {SHORTEST:g} to {LONGEST:g} s; got {steps.min():.9g} to {steps.max():.9g}; "
                "check the unit of the times"
            )
        steps = np.maximum(steps, usual_step(self.t) if N > 1 else 1.0)
        speed = np.abs(np.diff(self.position, axis=0) / steps[:, None]).max(initial=0.0)
        put("widest", (float(np.sqrt(self.variance.max()) * 10 + 1.0), float(10 * speed + 1.0)))


def three(value: float) -> Array:
    """The same number for East, North and Up."""
    return freeze(np.full(3, value))


@dataclass(frozen=True, slots=True, eq=False)
class Noise:
    """Noise found from a track, East, North, Up.

    With the given variance v of a row and their median m, a position has a white error of variance
    ``scale m (v/m)^exponent`` and a coloured one, of variance ``ratio`` times that and correlation exp(-dt/tau). Where
    variances differ it may drift, at a rate of variance ``drift`` times that and correlation exp(-dt/lasting).

    scale    : (3,) factor on the given variances of the positions
    density  : (3,) density of the white noise in the derivative of order n, m^2 / s^(2n-1)
    rate     : (3,) 1/s, at which the last derivative forgets; 0: a polynomial driven by noise
    ratio    : (3,) coloured to white variance ; tau : (3,) s, its correlation time
    exponent : (3,) 1 where the given variances are to scale, more where bad positions are worse than they say
    drift    : (3,) 1/s^2 ; lasting : (3,) s ; fading : (3,) 1 where it fades as coloured errors do, else 0
    """

    scale: Array
    density: Array
    rate: Array = field(default_factory=lambda: three(0.0))
    ratio: Array = field(default_factory=lambda: three(0.0))
    tau: Array = field(default_factory=lambda: three(1.0))
    exponent: Array = field(default_factory=lambda: three(1.0))
    drift: Array = field(default_factory=lambda: three(0.0))
    lasting: Array = field(default_factory=lambda: three(1.0))
    fading: Array = field(default_factory=lambda: three(0.0))

    def model(self, c: int) -> Array:
        """(q, rate, tau, lasting, fading) of a channel, for the loops."""
        return np.array([self.density[c], self.rate[c], self.tau[c], self.lasting[c], self.fading[c]])

    def white(self, track: Positions, c: int) -> Array:
        """(N,) variances of the white errors of a channel."""
        return raised(track.variance[:, c], float(self.exponent[c])) * self.scale[c]

    def error_states(self) -> int:
        """How many states the errors have: one for a coloured error, one more for its drift."""
        return 2 if self.drift.any() else int(self.ratio.any())

    def coloured(self, track: Positions, c: int) -> Array:
        """(N,) standard deviations of the coloured errors of a channel."""
        return np.asarray(np.sqrt(self.white(track, c) * self.ratio[c]))

    def drifting(self, track: Positions, c: int) -> Array:
        """(N,) standard deviations, m/s, of the rates at which the errors of a channel drift."""
        return np.asarray(np.sqrt(self.white(track, c) * self.drift[c]))

    def total(self, track: Positions) -> Array:
        """(N, 3) variances of the positions, white and coloured."""
        return np.stack([self.white(track, c) * (1.0 + self.ratio[c]) for c in range(3)], axis=1)


def raised(variance: Array, exponent: float) -> Array:
    """Variances (N,) whose logarithms are stretched about that of their median."""
    if exponent == 1.0:
        return variance.copy()
    middle = np.median(variance)
    return np.asarray(middle * (variance / middle) ** exponent)


@dataclass(frozen=True, slots=True, eq=False)
class TrackEstimate:
    """Velocity and acceleration of a track in East, North, Up of each row.

    derivatives : velocity, m/s, and acceleration, m/s^2, each (N, 3) with its standard deviation (N, 3); motions of
                  order 2 have no acceleration
    flags       : one word per row: ``used``, ``doubtful`` or ``outlier``
    gains       : channel -> gain of the last step in use (empty for methods without one)
    """

    derivatives: Sequence[tuple[Array, Array]]
    flags: tuple[str, ...]
    gains: dict[str, list[float]]

    @property
    def velocity(self) -> Array:
        """(N, 3) m/s."""
        return self.derivatives[0][0]

    @property
    def velocity_sd(self) -> Array:
        """(N, 3) m/s."""
        return self.derivatives[0][1]


def project_positions(
    t: Array, latitude: Array, longitude: Array, height: Array, sigma: Array | float | None = None
) -> Positions:
    """A track from geodetic coordinates: radians and metres, (N,) each.

    sigma : standard deviations of the positions in metres, (N, 3) East, North, Up, or one number;
            None: equal ones

    Raises EmptyError for fewer than two rows and DomainError for angles off the Earth.
    """
    if (N := np.size(t)) < 2:
        raise EmptyError(f"track: expected at least 2 rows; got {N}; record a longer track")
    columns = {"latitude": latitude, "longitude": longitude, "height": height}
    lat, lon, h = (as_array(name, value, (N,), "one entry per row") for name, value in columns.items())
    if (np.abs(lat) > np.pi / 2 + 1e-12).any() or (np.abs(lon) > 2 * np.pi + 1e-12).any():
        raise DomainError("latitude, longitude: expected radians on the Earth; got larger; convert degrees")
    axes = local_axes(lat, lon)
    point = cartesian(lat, lon, h)
    middle = central(point)
    return Positions(
        t=np.asarray(t, dtype=float),
        position=(point - point[middle]) @ axes[middle].T,
        variance=np.ones((N, 3)) if sigma is None else np.broadcast_to(np.asarray(sigma, float) ** 2, (N, 3)),
        turn=axes @ axes[middle].T,
    )


def central(point: Array) -> int:
    """The row (N, 3) nearest to the median position: a lost fix at latitude and longitude zero is never it."""
    return int(np.argmin(((point - np.median(point, axis=0)) ** 2).sum(axis=1)))


def usual_step(t: Array) -> float:
    """Seconds from row to row; pairs and triples of almost equal times, as of merged receivers, do not shrink it."""
    reach = 4 if len(t) > 8 else 1
    return float(np.median(t[reach:] - t[:-reach])) / reach


def check_order(rows: int, order: int) -> None:
    """DomainError for an order that is not offered; ShapeError, EmptyError below 2 rows, for too few rows for it."""
    if not 2 <= order <= LARGEST_ORDER:
        raise DomainError(f"order: expected 2 to {LARGEST_ORDER} states; got {order}; 3 is usual")
    if rows < order + 1:
        message = f"track: expected at least {order + 1} rows for {order} states; got {rows}"
        remedy = "lower the order or record a longer track" if rows > 2 else "record a longer track"
        raise (ShapeError if rows > 1 else EmptyError)(f"{message}; {remedy}")


def isolated_outliers(track: Positions) -> Mask:
    """(N,) True where a position departs from the cubic through its four neighbours and they do not.

    The scale is the median absolute residual of the neighbourhood, so that a stop does not make
    the motion after it look wild. Ends and rows beside gaps are not judged.
    """
    N = len(track.t)
    wild: Mask = np.zeros(N, dtype=bool)
    if N < 9:
        return wild
    residual = np.abs(interpolation_residuals(track))
    if np.isnan(residual).all():
        return wild
    scale = np.maximum(running_median(residual, 41), np.nanmedian(residual, axis=0)) * 1.4826
    floor = PLAUSIBLE / 2 * usual_step(track.t) ** 2 / ISOLATED
    ratio = np.nan_to_num(residual / np.maximum(scale, floor)).max(axis=1)
    for k in np.flatnonzero(ratio > ISOLATED):
        wild[k] = ratio[k] == ratio[max(0, k - 2) : k + 3].max()
    return wild


def interpolation_residuals(track: Positions) -> Array:
    """Position minus the cubic through rows k-2, k-1, k+1, k+2, (N, 3); NaN at ends and gaps."""
    t, x = track.t, track.position
    residual = np.full(x.shape, np.nan)
    inner = np.arange(2, len(t) - 2)
    nodes = inner[:, None] + np.array([-2, -1, 1, 2])
    weights = np.ones(nodes.shape)
    for i in range(4):
        for j in range(4):
            if i != j:
                weights[:, i] *= (t[inner] - t[nodes[:, j]]) / (t[nodes[:, i]] - t[nodes[:, j]])
    residual[inner] = x[inner] - np.einsum("ki,kic->kc", weights, x[nodes])
    spans = t[inner + 2] - t[inner - 2]
    residual[inner[spans > 4 * GAP * usual_step(t)]] = np.nan
    return residual


def running_median(values: Array, width: int) -> Array:
    """Median over a centred window of rows, (N, 3); NaN is left out."""
    half = width // 2
    padded = np.pad(values, ((half, half), (0, 0)), constant_values=np.nan)
    median = np.empty(values.shape)
    for start in range(0, len(values), LONGEST_FIT):  # windows of all rows at once would be forty copies of a track
        part = padded[start : start + LONGEST_FIT + width - 1]
        windows = np.lib.stride_tricks.sliding_window_view(part, width, axis=0)
        filled = np.where(np.isnan(windows).all(axis=-1, keepdims=True), 0.0, windows)
        median[start : start + LONGEST_FIT] = np.nanmedian(filled, axis=-1)
    return median


def first_spread(track: Positions, order: int, density: float = 0.0, rate: float = 0.0) -> Array:
    """Standard deviations of the state before the first measurement, wide in the scale of the track.

    density, rate : of the motion; one that forgets begins as it goes on, with the variance density / (2 rate)
    """
    spread = np.array([*track.widest, *([50.0] * (order - 2))])
    if rate > 0.0:
        spread[-1] = min(spread[-1], np.sqrt(density / (2.0 * rate)))
    return spread


def noise_of(track: Positions, order: int, use: Rows, *, gate: float = 0.0, fixed_scale: bool = False) -> Noise:
    """Maximum-likelihood noise of a track, white errors and polynomial motion: a pair for East and North, one for Up.

    gate        : innovations beyond so many standard deviations count as if they were at it; 0 for none
    fixed_scale : take the given variances as they are
    """
    check_order(len(track.t), order)
    pairs = [Fit(track, order, use, c, gate, fixed_scale).best() for c in ((0, 1), (2,))]
    scale, density = (np.array([pairs[0][i], pairs[0][i], pairs[1][i]]) for i in (0, 1))
    return Noise(freeze(scale), freeze(density))


@dataclass(frozen=True, slots=True)
class Shape:
    """What else the noise of some channels has: see :class:`Noise`."""

    rate: float = 0.0
    ratio: float = 0.0
    tau: float = 1.0
    exponent: float = 1.0
    drift: float = 0.0
    lasting: float = 1.0
    fading: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """The likelihood of some channels together, as a function of scale and density."""

    track: Positions
    order: int
    use: Rows
    channels: tuple[int, ...]
    gate: float
    fixed_scale: bool
    shape: Shape = Shape()

    def sums(self, scale: float, density: float, gate: float) -> tuple[float, float, int]:
        """Sums of log S and of innovation^2 / S over the channels, and the number of innovations.

        scale : factor of the given variances ; density : of the process noise ; gate : as in :func:`noise_of`
        """
        shape = self.shape
        spread = first_spread(self.track, self.order, density, shape.rate)
        model = np.array([density, shape.rate, shape.tau, shape.lasting, shape.fading])
        total = np.zeros(3)
        for channel in self.channels:
            z = self.track.position[:, channel].copy()
            r = raised(self.track.variance[:, channel], self.shape.exponent) * scale
            c, w = np.sqrt(r * shape.ratio), np.sqrt(r * shape.drift)
            total += misfit(self.track.t, z, r, c, w, self.use, model, spread, gate)
        return float(total[0]), float(total[1]), int(total[2])

    def profile(self, ratio: float) -> tuple[float, float]:
        """Cost and best scale for a ratio density/scale, without a gate: the scale has a closed form."""
        logs, squares, count = self.sums(1.0, ratio, 0.0)
        scale = 1.0 if self.fixed_scale else max(squares / max(count, 1), SMALLEST_SCALE)
        return logs + count * np.log(scale) + squares / scale, scale

    def cost(self, log_scale: float, log_density: float) -> float:
        """Minus twice the log-likelihood, but for a constant, at decimal logarithms of scale and density."""
        logs, squares, _ = self.sums(10.0**log_scale, 10.0**log_density, self.gate)
        return logs + squares

    def best(self) -> tuple[float, float]:
        """Coarse grid over the ratio, golden section, then turns of both logarithms under the gate."""
        step = usual_step(self.track.t)
        unit = float(np.log10(np.median(self.track.variance[:, self.channels[0]])))
        unit -= (2 * self.order - 1) * np.log10(step)
        grid = unit + np.arange(-14.0, 9.0)
        at = grid[int(np.argmin([self.profile(10.0**g)[0] for g in grid]))]
        at = golden(lambda g: self.profile(10.0**g)[0], at - 1.0, at + 1.0, 12)
        x = float(np.log10(self.profile(10.0**at)[1]))
        y = at + x
        for _ in range(3 if self.gate > 0 else 0):
            y = golden(lambda g, x=x: self.cost(x, g), y - 1.5, y + 1.5, 9)  # type: ignore[misc]
            if not self.fixed_scale:
                low = max(x - 1.5, float(np.log10(SMALLEST_SCALE)))
                x = golden(lambda g, y=y: self.cost(g, y), low, max(x + 1.0, low + 0.5), 9)  # type: ignore[misc]
        return 10.0**x, 10.0**y


def golden(f: Callable[[float], float], low: float, high: float, rounds: int) -> float:
    """Minimum of a function on an interval by golden section."""
    ratio = (np.sqrt(5) - 1) / 2
    a, b = high - ratio * (high - low), low + ratio * (high - low)
    fa, fb = f(a), f(b)
    for _ in range(rounds):
        if fa <= fb:
            high, b, fb = b, a, fa
            a = high - ratio * (high - low)
            fa = f(a)
        else:
            low, a, fa = a, b, fb
            b = low + ratio * (high - low)
            fb = f(b)
    return float((low + high) / 2)


#: Rows in which the noise is sought: the most central ones of a long track.
LONGEST_FIT = 10_000
#: Decimal logarithms that a shape may have: coloured variance over the given one, correlation time, rate; exponents.
COLOURS, LONGEST_TAU, RATES, EXPONENTS, DRIFTS = (-6.0, 3.0), 2.5, (-4.0, 1.0), (0.0, 4.0), (-8.0, 3.0)
#: First guesses of (coloured variance over white, tau over a step or in s, rate), and the first steps of the search.
GUESSES = ((0.0, 10.0, 1e-3), (3.0, 30.0, 1.0))
FIRST_STEPS = (0.7, 0.7, 0.7, 0.5, 0.8, 0.5, 0.7, 0.5, 0.0)


def shaped(
    track: Positions, order: int, use: Rows, noise: Noise, *, gate: float, fixed_scale: bool
) -> list[tuple[Array, Noise]]:
    """Noises with weights (3,) of their channels: coloured errors, a motion that forgets, stretched variances.

    Plain noise where the track asks for no more. The first is the likeliest: a shape is taken when minus twice the
    log-likelihood falls by more than the logarithm of the number of innovations for each of its parameters (Schwarz
    1978). The others are :func:`explanations`. East and North have one shape, Up its own.
    """
    if not SHORTEST_FIT <= usual_step(track.t) <= LONGEST_STEP or len(track.t) < 10 * order:
        return [(three(1.0), noise)]
    here = middle_rows(track, use)
    level, up = (
        explanations(fit, search_shape(fit, float(noise.scale[fit.channels[0]]), float(noise.density[fit.channels[0]])))
        for fit in (Fit(here[0], order, here[1], channels, gate, fixed_scale) for channels in ((0, 1), (2,)))
    )
    pairs = zip_longest(level, up)  # what one has no more of is its likeliest, which does not count again
    both = [(a or (0.0, level[0][1]), b or (0.0, up[0][1])) for a, b in pairs]
    return [(np.array([w, w, v]), noise_at((at, at, over))) for (w, at), (v, over) in both]


def noise_at(points: Sequence[Array]) -> Noise:
    """The noise at points (9,) of the region, East, North, Up."""
    columns = [{"scale": 10.0 ** at[0], "density": 10.0 ** at[1], **asdict(shape_at(at))} for at in points]
    return Noise(**{name: freeze(np.array([column[name] for column in columns])) for name in columns[0]})


#: Correlation times of coloured errors that are tried, s; the part of its range in which a parameter of a shape fits;
#: the least weight that counts.
SLOW, FITTING, SMALLEST_WEIGHT = (3.0, 10.0, 30.0, 100.0), 0.2, 0.03


def explanations(fit: Fit, own: Array) -> list[tuple[float, Array]]:
    """The likeliest point (9,) of the region and others, with weights: slow errors and slow motion look alike.

    The others have no coloured error, or one of a given correlation time, or a steady last derivative. Each weighs as
    its likelihood does, times ``FITTING`` for each parameter (Hoeting, Madigan, Raftery, Volinsky 1999). Errors that
    drift have no others.
    """
    if np.isfinite(own[6]):
        return [(1.0, own)]
    region, found = region_of(fit, own[0], own[1]), [(cost_of_shape(fit, own), own)]
    slow = () if fit.fixed_scale else (0.0, *(tau for tau in SLOW if tau > 2 * usual_step(fit.track.t)))
    for tau in slow:
        still, start = own.copy(), own.copy()
        still[2], still[3], still[4] = -np.inf, np.log10(tau or 1.0), -np.inf
        start[2], start[4] = max(own[0], own[2]), max(own[4], -1.5)
        free = np.array([True, True, tau > 0.0, False, fit.order > 2, *[False] * 4])
        simplex = np.vstack([start[free], start[free] + np.diag(np.array(FIRST_STEPS)[free])])
        cost, simplex = (part := replace(region, free=free, still=still)).descend(fit, simplex, ROUNDS[0])
        found.append((cost, part.whole(simplex[0])))
    found += [(cost_of_shape(fit, steady), steady) for _, at in found for steady in steadily(fit, at)]
    costs = np.array([cost - 2.0 * np.isfinite(at[[2, 4]]).sum() * np.log(FITTING) for cost, at in found])
    weights = np.exp((costs.min() - costs) / 2.0)
    weights[1:][weights[1:] < SMALLEST_WEIGHT * weights.sum()] = 0.0
    return [(w / weights.sum(), at) for w, (_, at) in zip(weights, found, strict=True) if w > 0.0 or at is own]


#: Usual steps, s, for which the bounds of a shape make sense.
SHORTEST_FIT, LONGEST_STEP = 1e-3, 100.0


def student(rows: int, order: int, sigma_known: bool) -> Array:
    """(3,) factors on deviations: Student's 97.5 % quantile over the normal one, by what tells of the noise.

    Each channel has as many rows more than states; East and North know theirs together. One where sigma is given.
    """
    from scipy.special import stdtrit

    spare = np.array([2, 2, 1]) * max(rows - order, 1)
    return np.ones(3) if sigma_known else np.asarray(stdtrit(spare, 0.975) / 1.959963984540054)


def middle_rows(track: Positions, use: Rows) -> tuple[Positions, Rows]:
    """At most LONGEST_FIT rows from the middle of a track, and which of them count."""
    start = max(0, (len(track.t) - LONGEST_FIT) // 2)
    part = slice(start, start + LONGEST_FIT)
    return Positions(track.t[part], track.position[part], track.variance[part], track.turn[part]), use[part]


def search_shape(fit: Fit, scale: float, density: float) -> Array:
    """The point (9,) of the likeliest noise with a shape, or of the plain one where that does."""
    x, y = np.log10(scale), np.log10(density)
    plain, count = fit.cost(x, y), max(fit.sums(scale, density, fit.gate)[2], 2)
    region = region_of(fit, x, y)
    found = likeliest(fit, region, plain, region.free[2:].sum() * np.log(count))
    if not fit.fixed_scale and not (fit.track.variance == fit.track.variance[:1]).all():
        # A drift is told from a motion only by the given variances: it is there where they are large.
        cost = plain if found is None else cost_of_shape(fit, found)
        needed = 2 * np.log(count) + DECISIVE
        for fading in (0.0, 1.0):
            drifting = likeliest(fit, region_of(fit, x, y, fading), cost, needed)
            if drifting is not None:
                found, cost, needed = drifting, cost_of_shape(fit, drifting), 0.0
        found = loosest(fit, found) if found is not None and needed == 0.0 else found
    return region.still if found is None else found


#: Twice the logarithm of a Bayes factor that is very strong evidence (Kass and Raftery 1995).
DECISIVE = 10.0
#: The 95 % quantile of chi-squared with one degree of freedom: what costs less more is not excluded.
EXCLUDED = 3.84


def likeliest(fit: Fit, region: Region, cost: float, needed: float) -> Array | None:
    """The point (9,) of least cost, None unless that is below ``cost`` by what is needed."""
    short = [region.descend(fit, simplex, ROUNDS[0]) for simplex in region.simplices]
    best, simplex = min(short, key=lambda result: result[0])
    if not cost - best > needed / 4:
        return None
    best, simplex = region.descend(fit, simplex, ROUNDS[1])
    return region.whole(simplex[0]) if cost - best > needed else None


def loosest(fit: Fit, at: Array) -> Array:
    """The point with the largest density of the motion that is not excluded, where a small one is not excluded either.

    When a drift explains all that was seen, the likeliest motion is none, and its deviations would be zero.
    """

    def rise(lift: float) -> float:
        return cost_of_shape(fit, at + lift * np.eye(9)[1]) - lowest

    lowest = cost_of_shape(fit, at)
    if rise(-1.0) > EXCLUDED:
        return at
    low, high = 0.0, 12.0
    for _ in range(10):
        middle = (low + high) / 2
        low, high = (middle, high) if rise(middle) < EXCLUDED else (low, middle)
    return at + low * np.eye(9)[1]


#: Evaluations of the likelihood: first from each guess, then from the better end.
ROUNDS = (150, 500)


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """Where a shape is sought: logarithms of scale, density, colour, tau, rate; exponent; of drift, lasting; fading.

    free : (9,) which of them vary ; still : (9,) values of the others ; low, high : (9,) bounds
    simplices : where the search starts, (k+1, k) each for k free ones
    """

    free: Mask
    still: Array
    low: Array
    high: Array
    simplices: list[Array]

    def whole(self, point: Array) -> Array:
        """All nine of a point of the free ones, within the bounds."""
        at = self.still.copy()
        at[self.free] = np.clip(point, self.low[self.free], self.high[self.free])
        return at

    def descend(self, fit: Fit, simplex: Array, rounds: int) -> tuple[float, Array]:
        """The lowest cost that a simplex finds (Nelder and Mead 1965), and the last simplex, best point first."""
        from scipy.optimize import minimize

        def cost(point: Array) -> float:
            at = self.whole(point)
            return cost_of_shape(fit, at) + 1e3 * float(np.abs(point - at[self.free]).sum())

        options = {"xatol": 0.02, "fatol": 0.05, "maxfev": rounds, "initial_simplex": simplex}
        found = minimize(cost, simplex[0], method="Nelder-Mead", options=options)
        return float(found.fun), np.asarray(found.final_simplex[0])


def region_of(fit: Fit, x: float, y: float, fading: float | None = None) -> Region:
    """Where to seek a shape about the logarithms x of the plain scale and y of the density.

    fading : of a drift, 0 or 1; None for no drift
    """
    step, found, drift = usual_step(fit.track.t), not fit.fixed_scale, fading is not None
    varied = not (fit.track.variance == fit.track.variance[:1]).all()
    free = np.array([found, True, found, found, fit.order > 2, found and varied, drift, drift, False])
    least, short, longest = np.log10(SMALLEST_SCALE), np.log10(step), max(LONGEST_TAU, np.log10(3 * step))
    seen = seen_density(fit, x)
    top = max(y + 6, seen + 2)  # the plain motion begins unknown, and may need no noise
    low = np.array([least, y - 6, COLOURS[0], short, RATES[0], EXPONENTS[0], DRIFTS[0], short, 0.0])
    high = np.array([max(x + 2, 4.0), top, COLOURS[1], longest, RATES[1], EXPONENTS[1], DRIFTS[1], longest, 1.0])
    simplices = []
    for lift, tau, rate in GUESSES:
        error, slow = x + lift / 6, np.log10(tau * step)
        motion = max(y, seen + np.log10(rate))
        point = [x - lift / 3, motion, error, slow, np.log10(rate), 1.0 + lift / 10, error - 2 * slow, slow, 0.0]
        start = np.clip(np.array(point), low, high)[free]
        simplices.append(np.vstack([start, start + np.diag(np.array(FIRST_STEPS)[free])]))
    return Region(free, np.array([x, y, -np.inf, 0.0, -np.inf, 1.0, -np.inf, 0.0, fading or 0.0]), low, high, simplices)


#: Deviations by least squares of a steady last derivative that the rows just tell from none.
SEEN = 3.0


def seen_density(fit: Fit, x: float) -> float:
    """Logarithm of density over rate of a motion whose last derivative the rows just tell from none.

    Endless below for two states, whose last one is the speed, which no body forgets.
    """
    if fit.order < 3:
        return -math.inf
    t, m = fit.track.t[fit.use > 0], fit.order - 1
    variance = 10.0**x * float(np.median(fit.track.variance[:, fit.channels[0]])) / len(t)
    norm = (2 * m + 1) * (math.factorial(2 * m) / math.factorial(m)) ** 2
    return float(np.log10(2.0 * SEEN**2 * norm * variance) - 2 * m * np.log10(t[-1] - t[0]))


def steadily(fit: Fit, own: Array) -> list[Array]:
    """The point with a steady last derivative that could just be seen, where the likeliest has a smaller one.

    A likeliest derivative of zero would otherwise be taken for known.
    """
    seen = seen_density(fit, own[0])
    if not (np.isfinite(own[4]) and own[1] < seen + own[4]):
        return []
    steady = own.copy()
    steady[4] = RATES[0]
    steady[1] = seen + steady[4]
    return [steady]


def cost_of_shape(fit: Fit, at: Array) -> float:
    """Minus twice the log-likelihood at a point of the region."""
    return replace(fit, shape=shape_at(at)).cost(float(at[0]), float(at[1]))


#: Names of a shape, as in :class:`Noise`.
SHAPE = tuple(field.name for field in fields(Shape))


def shape_at(at: Array) -> Shape:
    """The shape at a point of the region."""
    rate, ratio, tau, drift, lasting = (10.0 ** np.array([at[4], at[2] - at[0], at[3], at[6] - at[0], at[7]])).tolist()
    return Shape(rate, ratio, tau, float(at[5]), drift, lasting, float(at[8]))


def shape_of(noise: Noise, channel: int) -> Shape:
    """The shape of the noise of a channel."""
    return Shape(*(float(getattr(noise, name)[channel]) for name in SHAPE))


def memory(noise: Noise, variance: Array, order: int) -> float:
    """Time over which noise and motion balance, (variance/density)^(1/2n), seconds; East and North."""
    ratio = noise.scale[0] * (1.0 + noise.ratio[0]) * np.median(variance[:, 0]) / noise.density[0]
    return float(ratio ** (1 / (2 * order)))
