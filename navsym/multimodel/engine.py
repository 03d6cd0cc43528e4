"""The readable engine of the multiple-model filters: one step, a line per idea, over stacks of hypotheses.

It is the twin of the compiled loops, and the engine for banks that change their measurements, for trees and for
anything small. Weights are logarithms throughout. Covariances are kept in a form of :mod:`navsym.multimodel.kalman`;
only :class:`Step` shows them as they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.core import arrays
from navsym.core.answers import Answer, named
from navsym.core.tables import Table
from navsym.multimodel.bank import Bank
from navsym.multimodel.kalman import FORMS, Array, Form, logs, normalise, residual, times, variances
from navsym.multimodel.schemes import Scheme


@dataclass(frozen=True, slots=True, eq=False)
class Hypotheses:
    """A mixture of g Gaussians together with what is known about the last mode.

    means (g, n), covariances (g, n, n) as the form keeps them
    log_weights (g, m) : log P[this hypothesis, last mode = j | measurements]; they sum to one
    """

    means: Array
    covariances: Array
    log_weights: Array


@dataclass(frozen=True, slots=True, eq=False)
class Branches:
    """Hypotheses about the next step: b Gaussians before prediction, each with its next mode.

    log_weights (b,) : log P[branch | measurements so far]
    """

    means: Array
    covariances: Array
    modes: NDArray[np.intp]
    log_weights: Array


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """What one step found: hypotheses, moments, mode probabilities, and how likely the measurement was."""

    hypotheses: Hypotheses
    probabilities: Array
    mean: Array
    covariance: Array
    log_likelihood: float
    best: float
    singular: bool
    sound: bool


def first_hypotheses(bank: Bank, rule: Scheme, form: Form = FORMS["joseph"]) -> Hypotheses:
    """The hypotheses at step 0: one Gaussian when all modes share it, else one per mode."""
    kept = form.keep(bank.covariances)
    log_prior = logs(bank.probabilities)
    if bank.common and rule.branching != "own":
        return Hypotheses(bank.means[:1], kept[:1], log_prior[None])
    return Hypotheses(bank.means, kept, on_diagonal(log_prior))


def on_diagonal(log_weights: Array) -> Array:
    """Weights of hypotheses that know their last mode: (m, m) with -inf off the diagonal."""
    table = np.full((len(log_weights), len(log_weights)), -np.inf)
    np.fill_diagonal(table, log_weights)
    return table


def advance(rule: Scheme, k: int, bank: Bank, before: Hypotheses, z: Array, form: Form = FORMS["joseph"]) -> Step:
    """Step k of the filter: branch, predict, correct, weigh, take moments, fold."""
    branches = branch_hypotheses(rule, before, logs(bank.at("mode_transition", k)), form)
    means, kept, log_likelihoods, sound = filter_branches(bank, k, branches, z, form)
    best, singular = float(log_likelihoods.max()), bool(np.isneginf(log_likelihoods).any())
    if best == -np.inf:
        # No mode can have produced this measurement: leave it out, say so, and go on.
        step = advance(rule, k, bank, before, np.full_like(z, np.nan), form)
        return Step(step.hypotheses, step.probabilities, step.mean, step.covariance, 0.0, best, singular, sound)
    weights, log_likelihood = normalise(branches.log_weights + log_likelihoods)
    if log_likelihood == -np.inf:
        weights, log_likelihood = normalise(branches.log_weights)[0], 0.0
    log_weights = branches.log_weights + log_likelihoods - log_likelihood
    merged_mean, merged = form.merge(weights[None], means, kept)  # multistructure:12*, :13
    probabilities = np.bincount(branches.modes, weights, bank.modes).astype(float)
    found = Hypotheses(means, kept, spread_over_modes(log_weights, branches.modes, bank.modes))
    folded = fold_hypotheses(rule, k, found, (merged_mean, merged), form)
    return Step(folded, probabilities, merged_mean[0], form.show(merged[0]), log_likelihood, best, singular, sound)


def branch_hypotheses(rule: Scheme, before: Hypotheses, log_transition: Array, form: Form) -> Branches:
    """Hypotheses about the next mode.

    log_transition : (m, m), rows = from
    """
    log_next = log_matrix_product(before.log_weights, log_transition)  # (g, m): multistructure:10
    g, m = log_next.shape
    if rule.branching == "mixed":
        return mix_hypotheses(before, log_next, form)
    if rule.branching == "own":
        return Branches(before.means, before.covariances, np.arange(m), np.diagonal(before.log_weights))
    source, mode = np.divmod(np.arange(g * m), m)
    return Branches(before.means[source], before.covariances[source], mode, log_next.ravel())


def mix_hypotheses(before: Hypotheses, log_next: Array, form: Form) -> Branches:
    """The interaction of IMM: for every next mode one Gaussian, merged from all by P[source | next mode]."""
    totals = np.array([normalise(column)[1] for column in log_next.T])
    weights = np.stack([shares(column, log_next) for column in log_next.T])
    means, covariances = form.merge(weights, before.means, before.covariances)
    return Branches(means, covariances, np.arange(len(totals)), totals)


def shares(column: Array, table: Array) -> Array:
    """Normalised weights of one group; an impossible group takes those of all, to keep numbers finite."""
    weights, total = normalise(column)
    if total > -np.inf:
        return weights
    everything = np.exp(table - table.max()).sum(axis=1)
    return np.asarray(everything / everything.sum())


def log_matrix_product(A: Array, B: Array) -> Array:
    """``log(exp(A) @ exp(B))`` without leaving logarithms."""
    terms = A[:, :, None] + B[None, :, :]
    top = terms.max(axis=1, keepdims=True)
    safe = np.where(np.isfinite(top), top, 0.0)
    return logs(np.exp(terms - safe).sum(axis=1)) + safe[:, 0, :]


def filter_branches(bank: Bank, k: int, branches: Branches, z: Array, form: Form) -> tuple[Array, Array, Array, bool]:
    """Kalman filter of every branch: means, covariances, log-likelihoods of the numbers that came, and soundness."""
    i = branches.modes
    means, covariances = form.predict(branches.means, branches.covariances, bank.at("F", k)[i], bank.at("Q", k)[i])
    came = ~np.isnan(z)
    before, ahead = form.show(branches.covariances), form.show(covariances)
    sound = is_regular(before) and is_regular(ahead)
    if not came.any():
        return means, covariances, np.zeros(len(i)), sound
    H = bank.at("H", k)[i][:, came, :]
    R = bank.at("R", k)[i][:, came, :][:, :, came]
    S = residual(means, ahead, z[came], H, R)[1]
    size = np.abs(z[came]) + times(np.abs(H), np.abs(means))
    after = form.correct(means, covariances, z[came], H, R)  # multistructure:18*
    sound = sound and is_regular(S) and bool((size * size <= LARGEST * variances(S)).all())
    sound = sound and bool((variances(ahead) <= LARGEST * variances(form.show(after[1]))).all())
    return (*after, sound and bool((after[2] > -LEAST).all()))


#: A bank is sound while correlations keep this far from singular, variances fall by less than LARGEST in one step,
#: measurements are below the root of LARGEST in their standard deviations, and log-likelihoods above -LEAST. Some
#: 1e-9 of every number is then right; elsewhere :mod:`navsym.multimodel.doubt` looks again.
REGULAR, LARGEST, LEAST = 1e-3, 1e10, 1e4


def is_regular(P: Array) -> bool:
    """Whether every correlation matrix of a stack of covariances is far from singular."""
    spread = variances(P)
    if not (spread > 0.0).all():
        return False
    scale = np.sqrt(spread)
    return bool(np.linalg.eigvalsh(P / scale[..., None] / scale[..., None, :]).min() > REGULAR)


def spread_over_modes(log_weights: Array, modes: NDArray[np.intp], m: int) -> Array:
    """Weights (b, m) of branches that know their last mode."""
    table = np.full((len(modes), m), -np.inf)
    table[np.arange(len(modes)), modes] = log_weights
    return table


def fold_hypotheses(rule: Scheme, k: int, found: Hypotheses, whole: tuple[Array, Array], form: Form) -> Hypotheses:
    """Replace groups of Gaussians by one each, as the scheme says; ``whole`` is all of them in one."""
    if rule.folding == "none" or k % rule.period:
        return found
    modes = [normalise(column)[1] for column in found.log_weights.T]
    if rule.folding == "all":
        return Hypotheses(*whole, np.array(modes)[None])
    if found.means.shape[0] == len(modes):
        return found
    weights = np.stack([shares(column, found.log_weights) for column in found.log_weights.T])
    means, covariances = form.merge(weights, found.means, found.covariances)
    return Hypotheses(means, covariances, on_diagonal(np.array(modes)))


#: Sentences of one kind before they become one.
MOST_SENTENCES = 5
#: Log-likelihood below which every likelihood is zero in double precision.
UNDERFLOW = -745.0


@dataclass(frozen=True, slots=True, eq=False)
class Estimates(Answer):
    """Estimates after every step k = 1 .. T; the answer of :func:`navsym.filter`.

    probabilities : (T, m)     of the modes, given the measurements so far
    mean          : (T, n)     of the state
    covariance    : (T, n, n)  of its error
    log_likelihood: (T,)       of all measurements so far
    filters_run   : one-step Kalman filters that ran, all steps together
    impossible    : steps whose measurement has a likelihood below the smallest double under every mode; the
                    weights are right all the same, because they are kept as logarithms
    left_out      : steps whose measurement had to be left out, because it is impossible under every mode: it lies
                    outside the range of S, or even the logarithm of its likelihood has no number
    singular      : steps at which doubles had no density of a branch; empty once digits have decided
    sound         : whether doubles are certain to have kept their digits
    engine        : ``compiled``, ``numpy``, or ``digits`` where doubles did not suffice
    times         : (T,) s, when the file has time stamps; then steps without a measurement are not shown, and a step
                    in a sentence counts multiples of the usual time between two, from 1
    notes         : further sentences for people
    """

    probabilities: Array
    mean: Array
    covariance: Array
    log_likelihood: Array
    filters_run: int
    impossible: tuple[int, ...] = ()
    left_out: tuple[int, ...] = ()
    singular: tuple[int, ...] = ()
    sound: bool = False
    engine: str = "numpy"
    times: Array | None = None
    notes: tuple[str, ...] = ()

    @property
    def modes(self) -> NDArray[np.intp]:
        """(T,) index of the most probable mode."""
        return np.asarray(self.probabilities.argmax(axis=1))

    @property
    def standard_deviations(self) -> Array:
        """(T, n) of the state, in its units."""
        return np.asarray(np.sqrt(np.diagonal(self.covariance, axis1=1, axis2=2).clip(0.0)))

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences about measurements that no mode explains."""
        steps = [k for k in self.impossible if k not in self.left_out]
        if len(steps) > MOST_SENTENCES:
            listed = ", ".join(map(str, steps[:MOST_SENTENCES]))
            unlikely = [
                f"the data contradict every mode at {len(steps)} steps, the first {listed}: each gives a likelihood "
                "below 1e-323; weighed by logarithms"
            ]
        else:
            unlikely = [
                f"step {k}: every mode gives this measurement a likelihood below 1e-323; weighed by logarithms"
                for k in steps
            ]
        left = (f"step {k}: the measurement is impossible under every mode; left out" for k in self.left_out)
        return (*self.notes, *unlikely, *left)

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym filter``; ``left_out`` is there when steps were."""
        more = f"{'left_out' if self.left_out else ''} {'' if self.times is None else 'times'}"
        return named(self, f"probabilities mean covariance log_likelihood filters_run {more} remarks")

    def rows(self) -> list[tuple[str, ...]]:
        """Step, most probable mode, its probability, mean with standard deviations: words for people."""
        lines = zip(self.modes, self.probabilities, self.mean, self.standard_deviations, strict=True)
        return [
            (
                str(k),
                str(mode),
                f"{p.max():.6f}",
                "  ".join(f"{v:.6g} ({s:.2g})" for v, s in zip(x, spread, strict=True)),
            )
            for k, (mode, p, x, spread) in enumerate(lines, start=1)
        ]

    def __repr__(self) -> str:
        T, m, n = len(self.mean), self.probabilities.shape[1], self.mean.shape[1]
        total = self.log_likelihood[-1] if T else 0.0
        return f"<Estimates: {T} steps, {m} modes, {n} states, log-likelihood {total:.9g}, engine {self.engine}>"

    def table(self) -> Table:
        """The first and the last ten steps."""
        rows = self.rows()
        shown = rows if len(rows) <= 20 else [*rows[:10], ("…",) * 4, *rows[-10:]]
        return ("step", "mode", "probability", "mean (standard deviation)"), shown


def run_in_numpy(rule: Scheme, models: Bank, z: Array, count: int, form: Form = FORMS["joseph"]) -> Estimates:
    """The readable engine: one :func:`advance` per row."""
    now = first_hypotheses(models, rule, form)
    found: list[Step] = []
    for k, row in enumerate(z, start=1):
        step = advance(rule, k, models, now, row, form)
        now = step.hypotheses
        found.append(step)
    return stack_steps(found, models, count)


def stack_steps(found: list[Step], models: Bank, count: int) -> Estimates:
    """Stack what the steps found."""
    T, m, n = len(found), models.modes, models.states
    best = [step.best for step in found]
    return Estimates(
        arrays.freeze(np.array([s.probabilities for s in found]).reshape(T, m)),
        arrays.freeze(np.array([s.mean for s in found]).reshape(T, n)),
        arrays.freeze(np.array([s.covariance for s in found]).reshape(T, n, n)),
        arrays.freeze(np.cumsum([s.log_likelihood for s in found])),
        count,
        tuple(k for k, b in enumerate(best, start=1) if b < UNDERFLOW),
        tuple(k for k, b in enumerate(best, start=1) if b == -np.inf),
        tuple(k for k, s in enumerate(found, start=1) if s.singular),
        all(s.sound for s in found),
    )
