"""Monte-Carlo studies: how good the truncations are, and what they cost.

A study simulates switching signals from the bank itself, runs every method on the same series, and scores
the estimates against the truth: errors with confidence intervals, never a single run.
"""

import itertools
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from navsym.core.errors import DomainError
from navsym.multimodel.bank import Bank
from navsym.multimodel.compiled import run_compiled
from navsym.multimodel.filters import run_filter
from navsym.multimodel.schemes import require_room, scheme
from navsym_papers.multistructure.experiment.batch import run_batch
from navsym_papers.multistructure.experiment.modes import MODES, SchulerChannel

Array = NDArray[np.floating[Any]]
#: Steps of the series on which a method is timed.
LONG = 2000
#: Series that are filtered together, between two reports of progress.
BLOCK = 50


@dataclass(frozen=True, slots=True, eq=False)
class Signals:
    """Simulated truth: states (runs, T, n), modes (runs, T), measurements (runs, T, p)."""

    states: Array
    modes: NDArray[np.intp]
    measurements: Array


@dataclass(frozen=True, slots=True)
class Mean:
    """A sample mean with half the width of its 95 % confidence interval by Student.

    Where a few runs carry the mean, as of a NEES, the interval is too narrow: ``docs/measurement_files.md``.
    """

    mean: float
    half_width: float


@dataclass(frozen=True, slots=True)
class Score:
    """How one method did over all runs and the steps that count.

    rmse           : root mean square error of every state
    log_loss       : mean of -log P[true mode], nats
    log_likelihood : mean over runs of the log-likelihood of the whole series
    nees           : mean normalised squared error; its expectation is the number of states
    excess         : mean squared distance of the estimate from the exact one, in units of the exact variance,
                     or None without an exact run
    microseconds_per_step : of one run
    """

    method: str
    depth: int | None
    rmse: tuple[Mean, ...]
    log_loss: Mean
    log_likelihood: Mean
    nees: Mean
    excess: Mean | None
    filters_per_step: float
    microseconds_per_step: float


def simulate(models: Bank, runs: int, steps: int, seed: int) -> Signals:
    """Draw switching signals from a bank; the same seed gives the same signals."""
    rng = np.random.default_rng(seed)
    n, p = models.states, models.channels
    mode = choose(rng, np.tile(models.probabilities, (runs, 1)))
    x = np.stack([rng.multivariate_normal(models.means[i], models.covariances[i]) for i in mode])
    states, modes = np.empty((runs, steps, n)), np.empty((runs, steps), dtype=np.intp)
    measurements = np.empty((runs, steps, p))
    for k in range(1, steps + 1):
        mode = choose(rng, models.at("mode_transition", k)[mode])
        process, noise = roots(models.at("Q", k)), roots(models.at("R", k))
        shocks, errors = rng.standard_normal((runs, n, 1)), rng.standard_normal((runs, p, 1))
        x = (models.at("F", k)[mode] @ x[:, :, None] + process[mode] @ shocks)[:, :, 0]
        measurements[:, k - 1] = (models.at("H", k)[mode] @ x[:, :, None] + noise[mode] @ errors)[:, :, 0]
        states[:, k - 1], modes[:, k - 1] = x, mode
    return Signals(states, modes, measurements)


def choose(rng: np.random.Generator, probabilities: Array) -> NDArray[np.intp]:
    """One category per row of probabilities."""
    drawn = rng.random((len(probabilities), 1))
    picked = (np.cumsum(probabilities, axis=1) < drawn).sum(axis=1)
    return np.asarray(np.minimum(picked, probabilities.shape[1] - 1), dtype=np.intp)


def roots(covariances: Array) -> Array:
    """Symmetric square roots of a stack of covariances."""
    values, vectors = np.linalg.eigh(covariances)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0))[..., None, :])


def mean_of(sample: Array) -> Mean:
    """Mean over runs and half of its confidence interval."""
    freedom = len(sample) - 1
    half = float(stdtrit(freedom, 0.975) * sample.std(ddof=1) / np.sqrt(len(sample))) if freedom else float("inf")
    return Mean(float(sample.mean()), half)


@dataclass(frozen=True, slots=True, eq=False)
class Filtered:
    """Estimates of all runs: means (runs, T, n), covariances, probabilities (runs, T, m), log-likelihood (runs,)."""

    mean: Array
    covariance: Array
    probabilities: Array
    log_likelihood: Array
    microseconds: float
    filters_per_step: float


def filter_all(
    models: Bank, signals: Signals, method: str, depth: int | None = None, step: Callable[[], None] = lambda: None
) -> Filtered:
    """One method on every series, and its time per step; ``step`` is called for each series."""
    run_filter(models, signals.measurements[0], method, depth=depth, engine="compiled")  # load the loops first
    began = time.perf_counter()
    found = []
    for start in range(0, len(signals.measurements), BLOCK):
        block = signals.measurements[start : start + BLOCK]
        found.append(run_batch(models, block, method, depth=depth))
        for _ in block:
            step()
    elapsed = time.perf_counter() - began
    runs, steps, _ = signals.measurements.shape
    mean, covariance, probabilities, logs = (np.concatenate(parts) for parts in zip(*found, strict=True))
    each = elapsed / (runs * steps) if method == "exact" else seconds_of_long_run(models, signals, method, depth)
    roots = 1 if models.common else models.modes
    count = require_room(scheme(method, depth), models.modes, models.states, roots, steps)
    return Filtered(mean, covariance, probabilities, logs[:, -1], each * 1e6, count / steps)


def seconds_of_long_run(models: Bank, signals: Signals, method: str, depth: int | None) -> float:
    """Seconds per step of the compiled loops in one long series, where starting a run does not count."""
    z = np.resize(signals.measurements, (LONG, models.channels))
    rule = scheme(method, depth)
    run_compiled(rule, models, z[:1], 0)  # load the loops first
    began = time.perf_counter()
    run_compiled(rule, models, z, 0)
    return (time.perf_counter() - began) / LONG


def score(method: str, depth: int | None, found: Filtered, signals: Signals, exact: Filtered | None = None) -> Score:
    """Score a method against the truth and, where there is one, the exact filter."""
    error = found.mean - signals.states
    squared = np.mean(error**2, axis=1)
    rmse = tuple(root_of(mean_of(squared[:, a])) for a in range(squared.shape[1]))
    true = np.take_along_axis(found.probabilities, signals.modes[:, :, None], axis=2)[:, :, 0]
    loss = -np.log(np.maximum(true, 1e-300)).mean(axis=1)
    nees = normalised(error, found.covariance).mean(axis=1)
    excess = None
    if exact is not None:
        excess = mean_of(normalised(found.mean - exact.mean, exact.covariance).mean(axis=1))
    return Score(
        method,
        depth,
        rmse,
        mean_of(loss),
        mean_of(found.log_likelihood),
        mean_of(nees),
        excess,
        found.filters_per_step,
        found.microseconds,
    )


def root_of(mean: Mean) -> Mean:
    """Root of a mean square, and its confidence interval by the derivative of the root."""
    root = float(np.sqrt(mean.mean))
    return Mean(root, mean.half_width / (2.0 * root) if root > 0.0 else 0.0)


def normalised(error: Array, covariance: Array) -> Array:
    """``e^T P^-1 e`` for stacks."""
    return np.asarray((error * np.linalg.solve(covariance, error[..., None])[..., 0]).sum(axis=-1))


def compare(
    models: Bank,
    methods: Sequence[tuple[str, int | None]],
    runs: int,
    steps: int,
    seed: int,
    *,
    exact: bool,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> list[Score]:
    """Score methods on the same simulated signals; with ``exact`` the full tree comes first in the list.

    progress : called with (finished, all) series of all methods
    """
    signals = simulate(models, runs, steps, seed)
    done, of = itertools.count(1), runs * (len(methods) + exact)

    def step() -> None:
        progress(next(done), of)

    reference = filter_all(models, signals, "exact", step=step) if exact else None
    scores = [score("exact", None, reference, signals, reference)] if reference is not None else []
    for method, depth in methods:
        scores.append(score(method, depth, filter_all(models, signals, method, depth, step), signals, reference))
    return scores


METHODS: tuple[tuple[str, int | None], ...] = (
    ("pulsating", None),
    ("k-pulsating", 2),
    ("k-pulsating", 3),
    ("k-pulsating", 4),
    ("gpb2", None),
    ("imm", None),
    ("polygaussian", None),
)


def switching_study(stays: Sequence[float], runs: int, steps: int, seed: int = 1) -> dict[float, list[Score]]:
    """The Schuler channel with ever longer lasting modes: who wins as switching becomes rare.

    stays : probability that a mode lasts another step, the same for all modes
    """
    out = {}
    for stay in stays:
        switch = np.full((3, 3), (1.0 - stay) / 2.0)
        np.fill_diagonal(switch, stay)
        channel = SchulerChannel()
        models = Bank(channel.models(), switch, channel.start() | {"probabilities": np.full(3, 1.0 / 3.0)})
        out[stay] = compare(models, METHODS[:-1], runs, steps, seed, exact=False)
    return out


def schuler_bank(channel: SchulerChannel | None = None) -> Bank:
    """The Schuler channel with its three modes as a bank."""
    channel = channel or SchulerChannel()
    return Bank(channel.models(), channel.mode_transition(), channel.start())


def study(
    runs: int = 1000, seed: int = 1, steps: int = 7, *, progress: Callable[[int, int], None] = lambda done, of: None
) -> dict[str, Any]:
    """`navsym simulate multistructure`: the Schuler channel, K = 1..4, GPB2, IMM, polygaussian against exact.

    progress : called with (finished, all) series of all methods
    Raises DomainError for fewer than two runs, TooLargeError when the exact tree of ``steps`` does not fit.
    """
    if runs < 2 or steps < 1:
        raise DomainError(f"runs: expected at least 2 runs and 1 step; got {runs} and {steps}; give more")
    models = schuler_bank()
    require_room(scheme("exact"), models.modes, models.states, 1, steps)
    scores = compare(models, METHODS, runs, steps, seed, exact=True, progress=progress)
    return {
        "experiment": "multistructure",
        "modes": list(MODES),
        "states": ["velocity", "tilt", "drift"],
        "units": ["m/s", "rad", "rad/s"],
        "runs": runs,
        "steps": steps,
        "seed": seed,
        "methods": [asdict(item) | {"rmse": [*map(asdict, item.rmse)]} for item in scores],
    }


def show(pair: dict[str, float] | None, scale: float) -> str:
    """A mean and half of its confidence interval."""
    return "" if pair is None else f"{pair['mean'] * scale:.4g} ± {pair['half_width'] * scale:.2g}"


def as_table(document: dict[str, Any]) -> tuple[list[str], list[list[str]]]:
    """Headings and rows for people."""
    heads = ["method", "K", "velocity, m/s", "drift, deg/h", "log loss", "log-likelihood", "NEES", "excess", "us/step"]
    hour = 180.0 / np.pi * 3600.0
    rows = []
    for row in document["methods"]:
        rows.append(
            [
                row["method"],
                str(row["depth"] or ""),
                show(row["rmse"][0], 1.0),
                show(row["rmse"][2], hour),
                show(row["log_loss"], 1.0),
                show(row["log_likelihood"], 1.0),
                show(row["nees"], 1.0),
                show(row["excess"], 1.0),
                f"{row['microseconds_per_step']:.1f}",
            ]
        )
    return heads, rows


def sweep_job(sweep: Any, index: int) -> dict[str, Any]:
    """Mean squared error of each state, ``mse0`` and on, over all runs and steps of the Schuler bank under one filter.

    The signals are drawn with a seed of their own, from the sweep's seed and the index.
    """
    state = np.random.SeedSequence(sweep.seed, spawn_key=(index,)).generate_state(1, np.uint64)[0]
    bank = schuler_bank()
    signals = simulate(bank, sweep.runs, sweep.steps, int(state))
    errors = run_batch(bank, signals.measurements, sweep.method)[0] - signals.states
    squares = [float(value) for value in (errors**2).mean(axis=(0, 1))]
    return {"index": index, "runs": sweep.runs, **{f"mse{k}": value for k, value in enumerate(squares)}}
