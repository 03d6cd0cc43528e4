"""The paper's experiment, run again: a ship or aircraft on a straight and a yawing course, positions to 1 m.

Northern motion only, as in the paper: s(t) is the integral of |V| cos(heading), measured every 0.2 s with an
error uniform on [-sqrt(3), sqrt(3)] m. Lengths in metres: an angle is s over the Earth radius.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from navsym.core.arrays import Array
from navsym.core.errors import DomainError
from navsym_papers.trajectory.experiment import inversion

Heading = Literal["printed", "consistent"]
HEADINGS: tuple[Heading, ...] = ("printed", "consistent")

TAU, ORDER, PERIOD, END = 0.2, 5, 360.0, 3600.0
YAWING = (1000.0, 2080.0)
TUNED = 168.8
RADIUS = 6371000.0
#: The printed gain; as D_p variables in metres, m/s, ... (trajectory:experiment.gain*).
PRINTED_GAIN = (9.19e-2, 6.55e-3, 2.26e-4, 4.04e-6, 3.2e-8)
#: |V| -> printed figures: position (m), speed straight and yawing (m/s), acceleration (m/s^2).
PRINTED: dict[int, dict[str, float]] = {
    100: {
        "position": 0.06,
        "speed_straight": 0.019,
        "speed_yawing": 0.090,
        "acceleration_straight": 0.003,
        "acceleration_yawing": 0.01,
    },
    2: {"position": 0.1, "speed_straight": 0.06, "speed_yawing": 0.07},
    300: {"position": 0.1, "speed_straight": 0.08, "speed_yawing": 0.09},
}


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """Truth at times k tau, k = 0..N: position (m), speed (m/s), acceleration (m/s^2), each (N + 1,)."""

    t: Array
    position: Array
    speed: Array
    acceleration: Array


def heading(t: Array, programme: Heading) -> Array:
    """Heading in radians: 45 degrees, and 5 degrees of yawing from 1000 to 2080 s.

    ``printed``    : 45 + 5 cos(2 pi t / T), which jumps by 0.87 degrees at both ends
    ``consistent`` : 45 + 5 sin(2 pi (t - 1000) / T), which does not
    """
    if programme not in ("printed", "consistent"):
        raise DomainError(f"heading: expected printed or consistent; got {programme!r}; choose one")
    phase = 2 * np.pi * t / PERIOD if programme == "printed" else 2 * np.pi * (t - YAWING[0]) / PERIOD
    wave = np.cos(phase) if programme == "printed" else np.sin(phase)
    angle: Array = np.radians(45.0 + 5.0 * wave * ((t >= YAWING[0]) & (t <= YAWING[1])))
    return angle


def course(speed: float, programme: Heading, fine: int = 20) -> Course:
    """The northern motion at |V| = speed, m/s; the integral by Simpson's rule on steps of tau / fine.

    Raises DomainError for a programme that is not one of :data:`HEADINGS`.
    """
    N = round(END / TAU)
    t = np.linspace(0.0, END, N + 1)
    north = speed * np.cos(heading(t, programme))
    grid = np.linspace(0.0, END, 2 * fine * N + 1)
    v = speed * np.cos(heading(grid, programme))
    pieces = (v[0:-2:2] + 4 * v[1:-1:2] + v[2::2]) * (TAU / fine / 6)
    position = np.concatenate(([0.0], np.cumsum(pieces)))[::fine]
    phase = 2 * np.pi * (t if programme == "printed" else t - YAWING[0]) / PERIOD
    slope = -np.sin(phase) if programme == "printed" else np.cos(phase)
    turn = np.radians(5.0) * 2 * np.pi / PERIOD * slope * ((t >= YAWING[0]) & (t <= YAWING[1]))
    return Course(t, position, north, -speed * np.sin(heading(t, programme)) * turn)


def measured(truth: Course, seed: int) -> Array:
    """Positions (N,) in metres at steps 1..N with the uniform error of standard deviation 1 m."""
    noise = np.random.default_rng(seed).uniform(-math.sqrt(3), math.sqrt(3), len(truth.t) - 1)
    return truth.position[1:] + noise


def metric_model(form: Literal["printed", "corrected"] = "corrected") -> inversion.SteppedModel:
    """The motion in metres, m/s, m/s^2, ... (variables D_p x times the Earth radius)."""
    return inversion.scaled_model(inversion.first_stage_model(ORDER, form), inversion.metric_scale(ORDER, TAU))


def with_printed_gain(truth: Course, z: Array) -> Array:
    """States (N, 3) in metric units with the printed constant gain, from the true state at zero."""
    start = np.array([truth.position[0], truth.speed[0], truth.acceleration[0], 0.0, 0.0])
    return inversion.fixed_gain_filter(z, metric_model(), np.array(PRINTED_GAIN), start)[:, :3]


def with_adaptive_filter(truth: Course, z: Array, form: Literal["printed", "corrected"]) -> Array:
    """States (N, 3) with Q tuned up to 168.8 s, the gain constant afterwards.

    The paper gives neither the first Q and P nor the step of the field; here 1e-12 and 1 in normalised
    variables and 2. The corrected form keeps the likeliest candidate of windows of 40 steps.
    """
    scale = inversion.normalised_scale(ORDER)
    model = inversion.scaled_model(inversion.first_stage_model(ORDER, form), scale)
    first = np.array([truth.position[0], truth.speed[0] * TAU, 0.0, 0.0, 0.0]) * scale
    start = inversion.Start(first, np.eye(ORDER), np.full(ORDER, 1e-12))
    stop = round(TUNED / TAU)
    if form == "printed":
        tuning = inversion.Tuning(1.0, criterion="predicted", weights=(1.0, TAU, TAU**2), stop=stop)
        states = inversion.adaptive_filter(z, model, start, tuning).states
    else:
        tuned = inversion.windowed_filter(z[:stop], model, start, inversion.Tuning(1.0), window=40)
        gain = inversion.steady_gain(model, 1.0, np.maximum(tuned.diagonals[-1], 1e-30))[0]
        rest = inversion.fixed_gain_filter(z[stop:], model, gain, tuned.states[-1])
        states = np.vstack([tuned.states, rest])
    # A run that diverges overflows; that is its result.
    with np.errstate(over="ignore", invalid="ignore"):
        return (states / scale * inversion.metric_scale(ORDER, TAU))[:, :3]


def figures(truth: Course, states: Array) -> dict[str, float]:
    """RMS errors after tuning: position, speed and acceleration on the first straight part and while yawing.

    The part after 2080 s is left out of ``straight``: with the printed heading it starts with a jump.
    """
    t = truth.t[1:]
    errors = states - np.column_stack([truth.position, truth.speed, truth.acceleration])[1:]
    straight = (t > TUNED) & (t < YAWING[0])
    yawing = (t >= YAWING[0]) & (t <= YAWING[1])

    def rms(column: int, rows: NDArray[np.bool_]) -> float:
        if not np.abs(errors[rows, column]).max() < 1e9:
            return math.inf  # it diverges
        return float(np.sqrt(np.mean(errors[rows, column] ** 2)))

    return {
        "position": rms(0, straight | yawing),
        "position_straight": rms(0, straight),
        "speed_straight": rms(1, straight),
        "speed_yawing": rms(1, yawing),
        "acceleration_straight": rms(2, straight),
        "acceleration_yawing": rms(2, yawing),
    }


ALGORITHMS = {
    "printed gain": with_printed_gain,
    "tuned as printed": lambda truth, z: with_adaptive_filter(truth, z, "printed"),
    "tuned, corrected": lambda truth, z: with_adaptive_filter(truth, z, "corrected"),
}


def experiment(
    runs: int = 10, seed: int = 1, progress: Callable[[int, int], None] = lambda done, of: None
) -> list[dict[str, Any]]:
    """One row for each speed, heading and algorithm: printed figures beside means over some runs.

    progress : called with (finished, all) runs of all rows
    Raises DomainError for less than one run.
    """
    if runs < 1:
        raise DomainError(f"expected at least one run; got {runs}; give more", where="--runs")
    cases = [(speed, programme, name) for speed in PRINTED for programme in HEADINGS for name in ALGORITHMS]
    rows: list[dict[str, Any]] = []
    for number, (speed, programme, name) in enumerate(cases):
        truth = course(speed, programme)
        found = []
        for k in range(runs):
            found.append(figures(truth, ALGORITHMS[name](truth, measured(truth, seed + k))))
            progress(number * runs + k + 1, len(cases) * runs)
        mean = {key: float(np.mean([f[key] for f in found])) for key in found[0]}
        spread = {key: float(np.std([f[key] for f in found])) for key in found[0]}
        rows.append(
            {
                "speed": speed,
                "heading": programme,
                "algorithm": name,
                "runs": runs,
                "printed": PRINTED[speed],
                "obtained": mean,
                "spread": spread,
            }
        )
    return rows


# -- what a change of variables does to a filter ------------------------------------------------------------


def scaling_changes_rounding(n: int = ORDER, steps: int = 2000, seed: int = 1) -> bool:
    """Whether a Kalman filter computes anything else in variables scaled by powers of two.

    Physical variables (radian, m/s, ...) against the same variables times D rounded to powers of two, with P, Q
    and R carried over. Every product and sum then rounds alike, so that the estimates agree bit for bit.
    """
    rho = 1 / RADIUS
    to_f = np.array([1.0, *(rho * TAU**j / math.factorial(j) for j in range(1, n))])
    model = inversion.scaled_model(inversion.first_stage_model(n), 1 / to_f)
    D = np.exp2(np.round(np.log2(to_f * inversion.normalised_scale(n))))  # nearest powers of two
    rng = np.random.default_rng(seed)
    z = 1e-5 * np.sin(np.arange(steps) / 300.0) + rng.normal(size=steps) * rho
    P, Q = np.diag(rho**2 / to_f**2), np.diag((1e-3 * rho / to_f) ** 2)
    plain = kalman_estimates(z, model, P, Q, rho**2)
    scaled = kalman_estimates(z, inversion.scaled_model(model, D), P * D[:, None] * D, Q * D[:, None] * D, rho**2)
    return not np.array_equal(plain * D, scaled)


def kalman_estimates(z: Array, model: inversion.SteppedModel, P: Array, Q: Array, R: float) -> Array:
    """Estimates (N, n) of the textbook filter; sums in a fixed order, so that scaling is the only difference."""
    y, out = np.zeros(model.order), []
    Phi, h = model.Phi, model.gain_row[0]
    for value in z:
        y = np.sum(Phi * y, axis=1)
        P = ordered(ordered(Phi, P), Phi.T) + Q
        gain = P[:, 0] * h / (h * h * P[0, 0] + R)
        y = y + gain * (value - h * y[0])
        P = P - gain[:, None] * (h * P[0])
        out.append(y)
    return np.array(out)


def ordered(left: Array, right: Array) -> Array:
    """Matrix product with the terms of each sum added from first to last."""
    total = left[:, :1] * right[:1]
    for k in range(1, left.shape[1]):
        total = total + left[:, k : k + 1] * right[k : k + 1]
    return total
