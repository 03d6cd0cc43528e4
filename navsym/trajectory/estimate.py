"""Five ways from a track to velocity and acceleration, each with standard deviations.

differences : neighbours only           window     : least squares over a sliding window
filter      : Kalman, past data only    smoother   : Rauch, Tung and Striebel, all data
guaranteed  : least sum of absolute weights over the window, whose figure bounds the standard deviation
              under every correlation of the errors
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, Literal

import numpy as np

from navsym.core.arrays import Array, freeze
from navsym.core.errors import DomainError, ShapeError
from navsym.core.simplex import independent_rows, simplex
from navsym.trajectory.kernels.tracks import DOUBTED, backward, forward
from navsym.trajectory.tracks import (
    GAP,
    LONGEST_FIT,
    PLAUSIBLE,
    Fit,
    Mask,
    Noise,
    Positions,
    Rows,
    TrackEstimate,
    check_order,
    first_spread,
    isolated_outliers,
    memory,
    middle_rows,
    noise_of,
    shape_of,
    shaped,
    student,
    usual_step,
)

# Proof that minimum-sum weights are what they claim, in exact arithmetic.
#
# The weights w of a derivative at zero satisfy sum w_i t_i^k = d! [k = d], k < n, with least sum |w_i| sigma_i. Both
# bounds of that least value are exact rational numbers:
#
# * above: on n nodes the conditions have one solution, the derivative of Lagrange's polynomials, in integers;
# * below: every polynomial p of degree n - 1 with |p(t_i)| <= sigma_i at all rows gives d! p_d (weak duality);
#   a proposed p is divided by its largest |p(t_i)|/sigma_i, so that no rounding of the proposal matters.


#: Times are read in this unit, as the windows round them.
UNIT = 10**6


@dataclass(frozen=True, slots=True)
class SumCertificate:
    """Exact bounds of the least sum |w| sigma, 1/s^d for times in seconds."""

    lower: Fraction
    upper: Fraction

    @property
    def gap(self) -> float:
        """Relative distance of the bounds."""
        return float((self.upper - self.lower) / self.upper)


def minimum_sum_certificate(
    dt: Array, sigma: Array, order: int, derivative: int, nodes: Sequence[int], dual: Sequence[float]
) -> SumCertificate:
    """Bounds of the least sum of absolute weights, whatever the solver did.

    dt, sigma : (m,) times (whole microseconds) and standard deviations
    nodes     : ``order`` rows that carry the weights
    dual      : (order,) coefficients of a polynomial in the time in units of the largest |dt|, lowest first
    """
    times = [round(float(t) * UNIT) for t in dt]
    deviations = [Fraction(float(s)) for s in sigma]
    scale = Fraction(math.factorial(derivative) * UNIT**derivative)
    total = sum(
        abs(weight) * deviations[node]
        for node, weight in zip(nodes, lagrange([times[node] for node in nodes], derivative), strict=True)
    )
    longest = max(map(abs, times)) or 1
    value, steepest = dual_value(times, deviations, dual, longest, derivative)
    lower = value / (steepest * longest**derivative)
    return SumCertificate(scale * lower, scale * total)


def lagrange(nodes: Sequence[int], derivative: int) -> list[Fraction]:
    """Coefficients of x^derivative in Lagrange's polynomials of different integer nodes."""
    found = []
    for i, own in enumerate(nodes):
        others = [node for k, node in enumerate(nodes) if k != i]
        coefficients = [1]
        for node in others:
            coefficients = [a - node * b for a, b in zip([0, *coefficients], [*coefficients, 0], strict=True)]
        found.append(Fraction(coefficients[derivative], math.prod(own - node for node in others)))
    return found


def dual_value(
    times: Sequence[int], deviations: Sequence[Fraction], dual: Sequence[float], longest: int, derivative: int
) -> tuple[Fraction, Fraction]:
    """(|p_d|, max |p(t_i)|/sigma_i) of a polynomial in t/longest with floating coefficients, exactly."""
    bits = 80
    whole = [round(Fraction(float(c)) * 2**bits) for c in dual]
    degree = len(whole) - 1
    powers = [longest ** (degree - k) for k in range(degree + 1)]
    steepest = Fraction(0)
    for t, sigma in zip(times, deviations, strict=True):
        value = 0
        for c, power in zip(reversed(whole), reversed(powers), strict=True):
            value = value * t + c * power
        steepest = max(steepest, abs(Fraction(value, longest**degree)) / sigma)
    return Fraction(abs(whole[derivative])), steepest


# Standard deviations that know that the noise of a track was only estimated.
#
# The noise parameters (logarithms of scale and density) have the information ½ d²cost, cost = -2 log likelihood,
# at their maximum-likelihood values. With weights w_i at points around them that have this covariance,
#
#     mean = sum w_i m_i,    variance = sum w_i (P_i + (m_i - mean)^2),
#
# m_i, P_i the estimate and its variance for the noise of the point: the law of total variance with Laplace's
# posterior. Taking the most likely noise for the true one leaves the second term out and is optimistic.


#: Step of the second differences and largest standard deviation, in powers of ten.
STEP, WIDEST = 0.15, 0.3
#: Distance of the outer points in standard deviations; weights are then exact for polynomials of degree three.
REACH = 3.0


def noise_points(
    track: Positions, order: int, use: Rows, noise: Noise, *, gate: float = 0.0, fixed_scale: bool = False
) -> list[tuple[float, Noise]]:
    """Points around the most likely noise with the covariance of its estimate, and weights that sum to one.

    The first is the noise itself, and the only one on a track of more than ``LONGEST_FIT`` rows, which know it well.

    East and North share one pair of parameters, Up has its own; point k moves both.
    """
    if len(track.t) > LONGEST_FIT:
        return [(1.0, noise)]
    roots = [
        covariance_root(
            Fit(track, order, use, channels, gate, fixed_scale, shape_of(noise, channels[0])), noise, channels[0]
        )
        for channels in ((0, 1), (2,))
    ]
    axes = 1 if fixed_scale else 2
    points = [(1.0 - axes / REACH, noise)]
    for axis in range(axes):
        for sign in (-1.0, 1.0):
            moves = [10.0 ** (sign * np.sqrt(REACH) * root[:, axis]) for root in roots]
            factors = np.array([moves[0], moves[0], moves[1]]).T
            moved = replace(noise, scale=freeze(noise.scale * factors[0]), density=freeze(noise.density * factors[1]))
            points.append((1.0 / (2.0 * REACH), moved))
    return points


def covariance_root(fit: Fit, noise: Noise, channel: int) -> Array:
    """(2, 2): columns whose squares sum to the covariance of (log10 scale, log10 density).

    With a fixed scale the only column is the first one, along the density. Directions that the track says
    nothing about are capped.
    """
    x, y = (float(np.log10(value[channel])) for value in (noise.scale, noise.density))
    if fit.fixed_scale:
        below, middle, above = (fit.cost(x, y + d * STEP) for d in (-1, 0, 1))
        spread = deviation((below - 2 * middle + above) / (2 * STEP**2))
        return np.array([[0.0, 0.0], [spread, 0.0]])
    cost = {(i, j): fit.cost(x + i * STEP, y + j * STEP) for i in (-1, 0, 1) for j in (-1, 0, 1)}
    both = (cost[1, 1] - cost[1, -1] - cost[-1, 1] + cost[-1, -1]) / 4
    second = [cost[1, 0] - 2 * cost[0, 0] + cost[-1, 0], cost[0, 1] - 2 * cost[0, 0] + cost[0, -1]]
    information = np.array([[second[0], both], [both, second[1]]]) / (2 * STEP**2)
    values, vectors = np.linalg.eigh(information)
    return vectors * np.array([deviation(float(value)) for value in values])


def deviation(information: float) -> float:
    """Standard deviation for an information, capped where there is none."""
    return min(WIDEST, 1.0 / np.sqrt(information)) if information > 1.0 / WIDEST**2 else WIDEST


Method = Literal["differences", "window", "filter", "smoother", "guaranteed"]
METHODS = ("differences", "window", "filter", "smoother", "guaranteed")
CHANNELS = ("east", "north", "up")
#: How often the track is smoothed again without the worst positions.
DEPARTURE_ROUNDS = 12
#: Usual steps in a window whose length was not asked for, at most.
LONGEST_WINDOW = 1000
#: So many different windows of the guaranteed method are certified.
EXAMINED = 400

#: Weights and deviation of a derivative at zero: times, standard deviations, order, which derivative.
Weights = Callable[[Array, Array, int, int], tuple[Array, float]]


@dataclass(frozen=True, slots=True)
class Settings:
    """What to do with a track.

    method : one of METHODS; order : states, 2 (constant speed) to 6
    window : seconds, for the two window methods; None takes four times the memory of the filter, at most 1000 steps
    gate   : largest innovation in standard deviations; 0 switches the gate off
    """

    method: Method = "smoother"
    order: int = 3
    window: float | None = None
    gate: float = 5.0
    fixed_scale: bool = False

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise DomainError(f"expected one of {', '.join(METHODS)}; got {self.method!r}; choose one", where="method")
        if self.window is not None and not (math.isfinite(self.window) and self.window > 0):
            raise DomainError(f"expected a positive number of seconds; got {self.window}; omit it", where="window")
        if not (math.isfinite(self.gate) and self.gate >= 0):
            raise DomainError(f"expected a number of standard deviations; got {self.gate}; 5 is usual", where="gate")


#: Told of a step: how many are done, of how many as far as is known, and what is done.
Progress = Callable[[int, int, str], None]


def tell_nobody(done: int, of: int, doing: str) -> None:
    """Let a step pass in silence."""


def estimate(track: Positions, settings: Settings, progress: Progress | None = None) -> tuple[TrackEstimate, Noise]:
    """Velocity and acceleration of a track, and the noise that was found in it."""
    tell = progress or tell_nobody
    check_order(len(track.t), settings.order)
    use = np.ones(len(track.t), dtype=np.int64)
    if settings.gate > 0:
        use[isolated_outliers(track)] = 0
    tell(0, 4, "noise")
    here = middle_rows(track, use)
    noise = noise_of(here[0], settings.order, here[1], gate=settings.gate, fixed_scale=settings.fixed_scale)
    tell(1, 4, "outliers")
    # The filter stands for what can be known at the time; the others may look at the whole track.
    if settings.gate > 0 and settings.method != "filter":
        for _ in range(DEPARTURE_ROUNDS):
            found = departures(track, noise, settings, use)
            if not found.any():
                break
            use[found] = 0
        use[agreeing(track, noise, settings, use)] = 1
    if use.sum() < settings.order + 1:
        message = f"track: expected at least {settings.order + 1} rows that agree; got {use.sum()} of {len(use)}"
        raise ShapeError(f"{message}; lower the order, or set the gate to 0")
    tell(2, 4, "coloured errors")
    noises = shaped(track, settings.order, use, noise, gate=settings.gate, fixed_scale=settings.fixed_scale)
    tell(3, 4, settings.method)
    if settings.method in ("filter", "smoother"):
        answer = marginal(track, noises, settings, use, tell)
    else:
        answer = by_method(track, noises[0][1], settings, use)
    factors = student(int(use.sum()), settings.order, settings.fixed_scale)
    derivatives = [(value, spread * factors) for value, spread in answer.derivatives]
    return replace(answer, derivatives=derivatives), noises[0][1]


def marginal(
    track: Positions, noises: list[tuple[Array, Noise]], settings: Settings, use: Rows, tell: Progress = tell_nobody
) -> TrackEstimate:
    """Filter or smoother, averaged over what the noise may be; gains and flags are those of the likeliest.

    noises : with weights (3,) of their channels that sum to one, the likeliest first; each stands for all about it

    The noises of Up have nothing to do with those of East and North, the points about two noises move together.
    Nothing but the means of a run is kept: on a track of a million rows its roots are half a gigabyte.
    """
    orders, N, done = range(1, min(settings.order, 3)), len(track.t), 3
    within, values = np.zeros((len(orders), 3, N)), list[Any]()
    for weights, noise in noises:
        points = noise_points(track, settings.order, use, noise, gate=settings.gate, fixed_scale=settings.fixed_scale)
        factors = local_scales(track, noise, settings, use)
        values.append([])
        for share, moved in points:
            tell(done := done + 1, 4 + len(noises) * len(points), settings.method)
            run = passed(track, moved, settings, use)
            if done == 4:
                words, gains = words_of(use, run), gains_of(run, settings.order)
            values[-1].append([run.states[:, :, i].copy() for i in orders])
            for i in orders:
                within[i - 1] += (weights * share)[:, None] * variance(run, i) * factors
            del run
    shares, whole = np.array([share for share, _ in points]), np.array([weights for weights, _ in noises])
    mean, covariance = np.empty_like(within), np.empty((len(orders), 3, 3, N))
    for start in range(0, N, LONGEST_FIT):
        part = slice(start, start + LONGEST_FIT)
        block = np.array([[[value[:, part] for value in run] for run in runs] for runs in values])
        mean[..., part], covariance[..., part] = mixture(whole, shares, block, within[..., part])
    return turned(track, list(zip(mean, covariance, strict=True)), words, gains)


def mixture(weights: Array, shares: Array, values: Array, within: Array) -> tuple[Array, Array]:
    """Means (d, 3, N) and covariances (d, 3, 3, N) of d derivatives.

    weights : (I, 3) of noises in each channel ; shares : (K,) of the points about each noise
    values : (I, K, d, 3, N) ; within : (d, 3, N) means of their variances
    """
    mean = np.einsum("ic,k,ikdcn->dcn", weights, shares, values)
    away = values - mean
    common = np.einsum("ic,ikdcn->kdcn", weights, away)
    covariance = np.einsum("k,kdcn,kden->dcen", shares, common, common)
    for group in (slice(0, 2), slice(2, 3)):
        own = away[:, :, :, group]
        covariance[:, group, group] = np.einsum("i,k,ikdcn,ikden->dcen", weights[:, group.start], shares, own, own)
    return mean, covariance + on_diagonal(within)


def on_diagonal(variances: Array) -> Array:
    """Covariances (..., 3, 3, N) of variances (..., 3, N)."""
    return np.asarray(np.einsum("...cn,ce->...cen", variances, np.eye(3)))


#: Rows to each side over which squared innovations are averaged (deviation of a bell), what the model itself weighs
#: in rows, and the largest squared innovation that counts.
NEAR, TRUSTED, WILDEST = 10, 8.0, 100.0


def local_scales(track: Positions, noise: Noise, settings: Settings, use: Rows) -> Array:
    """(3, N) factors on the variances: how large squared innovations are about each row, to what the noise predicts.

    A recording is rarely as good, or as calm, all along. East and North share their factors, Up has its own. They are
    one unless they predict: each innovation is predicted by those about it without itself (for the filter, by those
    before it), and the log-likelihood of all has to rise by more than half the logarithm of their number.
    """
    run = filtered(track, noise, settings, use)
    squares = np.minimum(run.innovations**2 / run.variances, WILDEST)
    counted = use.astype(float)
    counted[np.flatnonzero(use)[: settings.order]] = 0.0
    factors = np.ones(squares.shape)
    for channels in ([0, 1], [2]):
        factor, predicted = (
            (TRUSTED + bell(squares[channels].mean(axis=0) * counted, settings.method, own))
            / (TRUSTED + bell(counted, settings.method, own))
            for own in (True, False)
        )
        rise = squares[channels] * (1.0 - 1.0 / predicted) - np.log(predicted)
        if (rise * counted).sum() > np.log(max(counted.sum(), 2.0)):
            factors[channels] = factor
    return factors


def bell(values: Array, method: str, own: bool) -> Array:
    """Sums (N,) of values (N,) about each row, weighted by a bell; of past rows only for the filter."""
    away = np.arange(-3 * NEAR, 3 * NEAR + 1)
    weights = np.exp(-0.5 * (away / NEAR) ** 2)
    if method == "filter":
        weights[away < 0] = 0.0
    if not own:
        weights[away == 0] = 0.0
    whole = np.convolve(values, weights)
    return np.asarray(whole[3 * NEAR : 3 * NEAR + len(values)])


def departures(track: Positions, noise: Noise, settings: Settings, use: Rows) -> Mask:
    """(N,) True where a position contradicts all others, further than its neighbours do.

    Baarda's test on the linear smoother: the residual e has the variance r - P, and without its own vote the
    position would be off by e r / (r - P). Both count: the test has to exceed the gate, and the offset what
    a plausible acceleration does in a step, so that a manoeuvre passes. The worst of a neighbourhood goes
    first, because it draws the track away from the others.
    """
    run = filtered(track, noise, replace(settings, gate=0.0), use)
    smoothed(track, noise, run)
    r, P = noise.total(track).T, variance(run, 0)
    share = np.maximum(1.0 - P / r, 1e-6)
    residual = np.abs(track.position.T - run.states[:, :, 0])
    test = residual / np.sqrt(r * share) / settings.gate
    offset = residual / share / (PLAUSIBLE / 2 * usual_step(track.t) ** 2)
    score = np.where(use, np.minimum(test, offset), 0.0).max(axis=0)
    highest = np.lib.stride_tricks.sliding_window_view(np.pad(score, 4), 9).max(axis=1)
    away: Mask = (score > 1.0) & (score == highest)
    return away


def agreeing(track: Positions, noise: Noise, settings: Settings, use: Rows) -> Mask:
    """(N,) True for rows left out that agree with the track of the others: an outlier had blamed them."""
    run = filtered(track, noise, replace(settings, gate=0.0), use)
    smoothed(track, noise, run)
    deviation = np.sqrt(noise.total(track).T + variance(run, 0))
    test = np.abs(track.position.T - run.states[:, :, 0]) / deviation
    fits: Mask = (use == 0) & (test < settings.gate).all(axis=0)
    return fits


def by_method(track: Positions, noise: Noise, settings: Settings, use: Rows) -> TrackEstimate:
    """Velocity and acceleration by the method of the settings, for one noise.

    use : (N,) 1 for rows that count, 0 for outliers
    """
    run = passed(track, noise, settings, use)
    words = words_of(use, run)
    if settings.method in ("filter", "smoother"):
        derivatives = [(run.states[:, :, i], on_diagonal(variance(run, i))) for i in range(1, min(settings.order, 3))]
        return turned(track, derivatives, words, gains_of(run, settings.order))
    if settings.method == "differences":
        windows = nearest_windows(track, use, 3)
        return from_weights(track, noise, windows, settings.order, least_squares, words)
    span = window_of(track, noise, settings)
    windows = sliding_windows(track, use, span, settings.order)
    weights = minimum_sum if settings.method == "guaranteed" else least_squares
    return from_weights(track, noise, windows, settings.order, weights, words)


def window_of(track: Positions, noise: Noise, settings: Settings) -> float:
    """Seconds of the window: what was asked for, or four memories of the filter, at most ``LONGEST_WINDOW`` steps.

    A track without manoeuvres has a memory as long as itself, and every row would then look at all others.
    """
    if settings.window is not None:
        return settings.window
    return min(4 * memory(noise, track.variance, settings.order), LONGEST_WINDOW * usual_step(track.t))


def passed(track: Positions, noise: Noise, settings: Settings, use: Rows) -> FilterRun:
    """The filter's run, and the smoother's where that is the method."""
    run = filtered(track, noise, settings, use)
    if settings.method == "smoother":
        smoothed(track, noise, run)
    return run


def words_of(use: Rows, run: FilterRun) -> tuple[str, ...]:
    """What happened to each row: ``outlier`` (left out), ``doubtful`` (believed less) or ``used``."""
    doubted = (run.flags == DOUBTED).any(axis=1)
    return tuple(np.where(use == 0, "outlier", np.where(doubted, "doubtful", "used")).tolist())


@dataclass(slots=True, eq=False)
class FilterRun:
    """Arrays of a run, channel first: states, gains (3, N, m), roots of covariances (3, N, m, m), flags (N, 3).

    The first of the n states of the motion is the position with its errors. Where errors are coloured or drift, the
    coloured error and the rate of the drift follow.
    """

    states: Array
    roots: Array
    gains: Array
    innovations: Array
    variances: Array
    jumps: Array
    flags: Rows


def filtered(track: Positions, noise: Noise, settings: Settings, use: Rows) -> FilterRun:
    """Forward run of the three channels; every root is kept for the smoother."""
    N, n = len(track.t), settings.order
    m = n + noise.error_states()
    run = FilterRun(
        states=np.empty((3, N, m)),
        roots=np.empty((3, N, m, m)),
        gains=np.empty((3, N, m)),
        innovations=np.empty((3, N)),
        variances=np.empty((3, N)),
        jumps=np.empty((3, N)),
        flags=np.empty((N, 3), dtype=np.int64),
    )
    for c in range(3):
        spread = first_spread(track, n, float(noise.density[c]), float(noise.rate[c]))
        z, r, b = track.position[:, c].copy(), noise.white(track, c), noise.coloured(track, c)
        out = (run.states[c], run.roots[c], run.gains[c], run.innovations[c], run.variances[c], run.jumps[c])
        flags = np.empty(N, dtype=np.int64)
        forward(track.t, z, r, b, noise.drifting(track, c), use, noise.model(c), spread, settings.gate, *out, flags)
        run.flags[:, c] = flags
    return run


def smoothed(track: Positions, noise: Noise, run: FilterRun) -> None:
    """Replace the filtered states and roots of a run by the smoothed ones."""
    for c in range(3):
        errors = noise.coloured(track, c), noise.drifting(track, c)
        n = run.states.shape[2] - noise.error_states()
        backward(track.t, *errors, run.jumps[c], n, run.states[c], run.roots[c], noise.model(c))


def variance(run: FilterRun, i: int) -> Array:
    """Variance of the i-th derivative of the position, (3, N)."""
    found: Array = (run.roots[:, :, :, i] ** 2).sum(axis=2)
    return found


def gains_of(run: FilterRun, order: int) -> dict[str, list[float]]:
    """Gains of the last row at which the first channel used its measurement."""
    last = int(np.flatnonzero((run.gains[0] != 0).any(axis=1))[-1])
    return {name: run.gains[c, last, :order].tolist() for c, name in enumerate(CHANNELS)}


def turned(
    track: Positions, derivatives: list[tuple[Array, Array]], words: tuple[str, ...], gains: dict[str, list[float]]
) -> TrackEstimate:
    """East, North, Up of each row from channels: values (3, N) and covariances (3, 3, N) of each derivative."""
    turn = axes_of(track, words)
    parts = [
        (np.einsum("kij,jk->ki", turn, values), np.sqrt(np.einsum("kij,kil,jlk->ki", turn, turn, covariances)))
        for values, covariances in derivatives
    ]
    return TrackEstimate(parts, words, gains)


def axes_of(track: Positions, words: tuple[str, ...]) -> Array:
    """East, North, Up of each row (N, 3, 3); where a position is not believed, those of the nearest one that is.

    A lost fix at latitude and longitude zero would otherwise turn a good velocity into the axes of that place.
    """
    believed = np.flatnonzero([word == "used" for word in words])
    if not believed.size:
        return track.turn
    after = np.clip(np.searchsorted(believed, np.arange(len(words))), 0, len(believed) - 1)
    before = np.maximum(after - 1, 0)
    waits = [np.abs(track.t[believed[near]] - track.t) for near in (before, after)]
    axes: Array = track.turn[believed[np.where(waits[0] < waits[1], before, after)]]
    return axes


def nearest_windows(track: Positions, use: Rows, count: int) -> list[Rows]:
    """For each row the ``count`` rows in use that surround it, as evenly as the ends allow."""
    kept = np.flatnonzero(use)
    count = min(count, len(kept))
    first = np.clip(np.searchsorted(kept, np.arange(len(track.t))) - count // 2, 0, len(kept) - count)
    return [kept[f : f + count] for f in first]


def sliding_windows(track: Positions, use: Rows, span: float, order: int) -> list[Rows]:
    """Rows in use within half a span; where they are fewer than order + 2, the nearest ones."""
    kept = np.flatnonzero(use)
    times = track.t[kept]
    first = np.searchsorted(times, track.t - span / 2, side="left")
    last = np.searchsorted(times, track.t + span / 2, side="right")
    near = nearest_windows(track, use, order + 2)
    ends = zip(first, last, near, strict=True)
    return [kept[a:b] if b - a >= order + 2 else nearest for a, b, nearest in ends]


def from_weights(
    track: Positions, noise: Noise, windows: list[Rows], order: int, weights: Weights, words: tuple[str, ...]
) -> TrackEstimate:
    """Derivatives as weighted sums of positions; the weights depend on times and variances only."""
    N = len(track.t)
    wanted = range(1, min(order, 3))
    values, variances = np.zeros((len(wanted), 3, N)), np.zeros((len(wanted), 3, N))
    same = (track.variance == track.variance[:1, :1]).all()
    cache: dict[tuple[bytes, int], tuple[Array, float]] = {}
    grain = grain_of(track)
    for k, rows in enumerate(windows):
        dt = distances(track, rows, k, grain)
        for c in range(3):
            sigma = np.sqrt(track.variance[rows, c])
            for d in wanted:
                key = (dt.tobytes(), d)
                if not same or key not in cache:
                    cache[key] = weights(dt, sigma, min(order, len(rows)), d)
                w, deviation = cache[key]
                values[d - 1, c, k] = w @ track.position[rows, c]
                variances[d - 1, c, k] = deviation**2 * noise.scale[c] * (1.0 + noise.ratio[c])
        if not same:
            cache.clear()
    return turned(track, list(zip(values, on_diagonal(variances), strict=True)), words, {})


def grain_of(track: Positions) -> float:
    """Seconds that move no weight: a microsecond, or a millionth of a usual step where steps are short."""
    return 1e-6 * min(1.0, usual_step(track.t))


def distances(track: Positions, rows: Rows, k: int, grain: float) -> Array:
    """Times of rows from row k in whole grains, so that they repeat where the clock does."""
    rounded: Array = np.round((track.t[rows] - track.t[k]) / grain) * grain
    return rounded


def design(dt: Array, order: int) -> tuple[Array, float]:
    """Powers of time in a unit that keeps them near one, (m, order), and the unit in seconds."""
    unit = float(np.abs(dt).max()) or 1.0
    return np.vander(dt / unit, order, increasing=True), unit


def least_squares(dt: Array, sigma: Array, order: int, derivative: int) -> tuple[Array, float]:
    """Weights of the derivative at zero of the least-squares polynomial, and their standard deviation.

    The deviation is sqrt(sum (w sigma)^2): independent errors.
    """
    V, unit = design(dt, order)
    solved = np.linalg.pinv(V / sigma[:, None]) / sigma
    w = solved[derivative] * math.factorial(derivative) / unit**derivative
    return w, float(np.sqrt(((w * sigma) ** 2).sum()))


def minimum_sum(dt: Array, sigma: Array, order: int, derivative: int) -> tuple[Array, float]:
    """Weights of least sum |w| sigma that are exact for polynomials, and that sum.

    The guaranteed estimator on the samples: the sum bounds the standard deviation whatever the correlation.
    """
    w, value, _, _ = minimum_sum_solution(dt, sigma, order, derivative)
    return w, value


def minimum_sum_solution(dt: Array, sigma: Array, order: int, derivative: int) -> tuple[Array, float, list[int], Array]:
    """(weights, sum, rows that carry them, dual polynomial in the time over the largest |dt|).

    Without a solution in the allowed number of exchanges: the weights of least squares and no rows.
    """
    V, unit = design(dt, order)
    # Orthonormal columns, so that the exchange meets no nearly dependent rows.
    Q, R = np.linalg.qr(V)
    target = np.zeros(order)
    target[derivative] = math.factorial(derivative) / unit**derivative
    functional = np.linalg.solve(R.T, target)
    scale = float(np.abs(functional).max())
    rows = np.ascontiguousarray(Q / sigma[:, None])
    basis, found, dual, count = simplex(rows, functional / scale, independent_rows(rows, order), 50 * order)
    if count < 0:
        w, _ = least_squares(dt, sigma, order, derivative)
        return w, float(np.abs(w * sigma).sum()), [], np.zeros(order)
    w = np.zeros(len(dt))
    w[basis] = found * scale / sigma[basis]
    return w, float(np.abs(w * sigma).sum()), basis.tolist(), np.linalg.solve(R, dual)


def largest_gap(track: Positions, settings: Settings, use: Rows, span: float) -> dict[str, float | int]:
    """Certificates of the weights in use: how many were examined, and the largest relative gap of their sums.

    Windows of equal times and deviations share their weights and are examined once.
    """
    seen: dict[tuple[bytes, bytes, int], float] = {}
    grain = grain_of(track)
    for k, rows in enumerate(sliding_windows(track, use, span, settings.order)):
        dt = distances(track, rows, k, grain)
        sigma = np.sqrt(track.variance[rows, 0])
        for d in (1, 2):
            key = (dt.tobytes(), sigma.tobytes(), d)
            if d < min(settings.order, len(rows)) and key not in seen and len(seen) < EXAMINED:
                seen[key] = certified_gap(dt, sigma, min(settings.order, len(rows)), d)
    return {"examined": len(seen), "largest_gap": max(seen.values(), default=0.0)}


def certified_gap(dt: Array, sigma: Array, order: int, derivative: int) -> float:
    """Relative distance of exact bounds of the least sum; one when there is no solution to certify."""
    _, _, nodes, dual = minimum_sum_solution(dt, sigma, order, derivative)
    return minimum_sum_certificate(dt, sigma, order, derivative, nodes, dual.tolist()).gap if nodes else 1.0


def gaps(track: Positions) -> Rows:
    """Rows after which the next one is late by more than GAP usual steps."""
    return np.flatnonzero(np.diff(track.t) > GAP * usual_step(track.t))
