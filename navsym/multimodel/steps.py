"""One step of every multiple-model filter, a line per idea, over stacks of hypotheses.

This is the readable twin of the compiled loops, and the engine for banks that change their measurements,
for trees and for anything small. Weights are logarithms throughout. Covariances are kept in a form of
:mod:`navsym.multimodel.kalman.forms`; only :class:`Step` shows them as they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from navsym.core.errors import DomainError, TooLargeError
from navsym.multimodel import moments as mixture
from navsym.multimodel.bank import Bank
from navsym.multimodel.kalman.forms import FORMS, Form

# The filters as truncations of one exact recursion.
#
# The exact posterior after k steps is a mixture with one Gaussian for every sequence of modes. Every filter
# here branches that mixture, weighs the branches by their likelihoods, and then *folds*: it replaces groups
# of Gaussians by one with the same mean and covariance. The groups are all that tells the filters apart:
#
# =============  ==============================  =============================  ======================
# method         branches                        fold                           filters per step
# =============  ==============================  =============================  ======================
# exact          every hypothesis, every mode    none                           m^k
# k-pulsating    every hypothesis, every mode    all into one, every K steps    m, m^2, ..., m^K
# pulsating      every hypothesis, every mode    all into one, every step       m        (GPB1, K = 1)
# gpb2           every hypothesis, every mode    by last mode, every step       m^2
# imm            one per mode, mixed beforehand  by last mode (nothing to do)   m
# polygaussian   one per mode, never mixed       none                           m        (static bank)
# =============  ==============================  =============================  ======================


Branching = Literal["cross", "mixed", "own"]
Folding = Literal["none", "all", "by mode"]

#: Bytes that the hypotheses of one step may take.
MEMORY_LIMIT = 2**30


@dataclass(frozen=True, slots=True)
class Scheme:
    """How a filter truncates.

    branching : "cross" every Gaussian with every mode; "mixed" one Gaussian per next mode, mixed from all;
                "own" each Gaussian keeps its mode
    folding   : "none", "all" into one, "by mode" into one per last mode
    period    : steps between folds
    """

    name: str
    branching: Branching
    folding: Folding
    period: int = 1


SCHEMES = {
    "exact": Scheme("exact", "cross", "none"),
    "pulsating": Scheme("pulsating", "cross", "all"),
    "k-pulsating": Scheme("k-pulsating", "cross", "all", 2),
    "gpb2": Scheme("gpb2", "cross", "by mode"),
    "imm": Scheme("imm", "mixed", "by mode"),
    "polygaussian": Scheme("polygaussian", "own", "none"),
}


def scheme(method: str, depth: int | None = None) -> Scheme:
    """The scheme of a method; ``depth`` is K and belongs to k-pulsating (default 2).

    Raises DomainError for an unknown method, a depth below one, or a depth where none belongs.
    """
    if not isinstance(method, str) or method not in SCHEMES:
        raise DomainError(f"method: expected one of {', '.join(SCHEMES)}; got {method!r}; choose one")
    known = SCHEMES[method]
    if depth is None:
        return known
    if method != "k-pulsating":
        raise DomainError(f"depth: expected none with {method}; got {depth}; it belongs to k-pulsating")
    if isinstance(depth, bool) or not isinstance(depth, int) or depth < 1:
        raise DomainError(f"depth: expected a whole number of steps from 1 on; got {depth!r}; give K >= 1")
    return Scheme("k-pulsating", "cross", "all", depth)


def filters_at(rule: Scheme, modes: int, roots: int, step: int) -> int:
    """One-step Kalman filters that run in step ``step`` = 1, 2, ..., starting from ``roots`` Gaussians.

    multistructure:count.sequences and multistructure:count.K
    """
    if rule.branching != "cross":
        return modes
    if rule.folding == "none":
        return roots * modes**step
    if rule.folding == "by mode":
        return (roots if step == 1 else modes) * modes
    inside = (step - 1) % rule.period + 1
    return (roots if step <= rule.period else 1) * modes**inside


def require_room(rule: Scheme, modes: int, states: int, roots: int, steps: int) -> int:
    """Filters run in all steps together; TooLargeError when the widest step does not fit in memory.

    The error names the count, so that K or the number of steps can be chosen.
    """
    widest = max((filters_at(rule, modes, roots, k) for k in widest_steps(rule, steps)), default=0)
    need = widest * 8 * (4 * states * states + 2 * states + 2 * modes)
    if need > MEMORY_LIMIT:
        raise TooLargeError(
            f"{rule.name}: expected hypotheses that fit in {MEMORY_LIMIT // 2**20} MiB; got {short(widest)} "
            f"hypotheses of {states} states; choose a smaller depth, fewer steps, or a folding method"
        )
    return sum(filters_at(rule, modes, roots, k) for k in range(1, steps + 1))


def widest_steps(rule: Scheme, steps: int) -> list[int]:
    """Steps among which the widest is: the last of an exact tree, the last of the first fold, the second."""
    last = min(steps, rule.period) if rule.folding == "all" else steps
    return [k for k in sorted({1, 2, last, steps}) if 1 <= k <= steps]


def short(count: int) -> str:
    """A count for people: in full up to 20 digits, then as a power of ten."""
    text = str(count) if count < 10**4000 else ""
    if text and len(text) <= 20:
        return text
    digits = count.bit_length() * 30103 // 100000
    return f"about 10^{digits}"


Array = NDArray[np.floating[Any]]


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


def start(bank: Bank, rule: Scheme, form: Form = FORMS["joseph"]) -> Hypotheses:
    """The hypotheses at step 0: one Gaussian when all modes share it, else one per mode."""
    kept = form.keep(bank.covariances)
    log_prior = mixture.logs(bank.probabilities)
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
    branches = branch(rule, before, mixture.logs(bank.at("mode_transition", k)), form)
    means, kept, log_likelihoods = filtered(bank, k, branches, z, form)
    best = float(log_likelihoods.max())
    if best == -np.inf:
        # No mode can have produced this measurement: leave it out, say so, and go on.
        step = advance(rule, k, bank, before, np.full_like(z, np.nan), form)
        return Step(step.hypotheses, step.probabilities, step.mean, step.covariance, 0.0, best)
    weights, log_likelihood = mixture.normalise(branches.log_weights + log_likelihoods)
    if log_likelihood == -np.inf:
        weights, log_likelihood = mixture.normalise(branches.log_weights)[0], 0.0
    log_weights = branches.log_weights + log_likelihoods - log_likelihood
    merged_mean, merged = form.merge(weights[None], means, kept)  # multistructure:12*, :13
    probabilities = by_mode(weights, branches.modes, bank.modes)
    found = Hypotheses(means, kept, spread_over_modes(log_weights, branches.modes, bank.modes))
    folded = fold(rule, k, found, (merged_mean, merged), form)
    return Step(folded, probabilities, merged_mean[0], form.show(merged[0]), log_likelihood, best)


def branch(rule: Scheme, before: Hypotheses, log_transition: Array, form: Form) -> Branches:
    """Hypotheses about the next mode.

    log_transition : (m, m), rows = from
    """
    log_next = log_matrix_product(before.log_weights, log_transition)  # (g, m): multistructure:10
    g, m = log_next.shape
    if rule.branching == "mixed":
        return mixed(before, log_next, form)
    if rule.branching == "own":
        return Branches(before.means, before.covariances, np.arange(m), np.diagonal(before.log_weights))
    source, mode = np.divmod(np.arange(g * m), m)
    return Branches(before.means[source], before.covariances[source], mode, log_next.ravel())


def mixed(before: Hypotheses, log_next: Array, form: Form) -> Branches:
    """The interaction of IMM: for every next mode one Gaussian, merged from all by P[source | next mode]."""
    totals = np.array([mixture.normalise(column)[1] for column in log_next.T])
    weights = np.stack([shares(column, log_next) for column in log_next.T])
    means, covariances = form.merge(weights, before.means, before.covariances)
    return Branches(means, covariances, np.arange(len(totals)), totals)


def shares(column: Array, table: Array) -> Array:
    """Normalised weights of one group; an impossible group takes those of all, to keep numbers finite."""
    weights, total = mixture.normalise(column)
    if total > -np.inf:
        return weights
    everything = np.exp(table - table.max()).sum(axis=1)
    return np.asarray(everything / everything.sum())


def log_matrix_product(A: Array, B: Array) -> Array:
    """``log(exp(A) @ exp(B))`` without leaving logarithms."""
    terms = A[:, :, None] + B[None, :, :]
    top = terms.max(axis=1, keepdims=True)
    safe = np.where(np.isfinite(top), top, 0.0)
    return mixture.logs(np.exp(terms - safe).sum(axis=1)) + safe[:, 0, :]


def filtered(bank: Bank, k: int, branches: Branches, z: Array, form: Form) -> tuple[Array, Array, Array]:
    """Kalman filter of every branch: means, covariances and log-likelihoods of the numbers that came."""
    i = branches.modes
    means, covariances = form.predict(branches.means, branches.covariances, bank.at("F", k)[i], bank.at("Q", k)[i])
    came = ~np.isnan(z)
    if not came.any():
        return means, covariances, np.zeros(len(i))
    H = bank.at("H", k)[i][:, came, :]
    R = bank.at("R", k)[i][:, came, :][:, :, came]
    return form.correct(means, covariances, z[came], H, R)  # multistructure:18*


def by_mode(weights: Array, modes: NDArray[np.intp], m: int) -> Array:
    """Probability of each last mode."""
    return np.bincount(modes, weights=weights, minlength=m).astype(float)


def spread_over_modes(log_weights: Array, modes: NDArray[np.intp], m: int) -> Array:
    """Weights (b, m) of branches that know their last mode."""
    table = np.full((len(modes), m), -np.inf)
    table[np.arange(len(modes)), modes] = log_weights
    return table


def fold(rule: Scheme, k: int, found: Hypotheses, whole: tuple[Array, Array], form: Form) -> Hypotheses:
    """Replace groups of Gaussians by one each, as the scheme says; ``whole`` is all of them in one."""
    if rule.folding == "none" or k % rule.period:
        return found
    modes = [mixture.normalise(column)[1] for column in found.log_weights.T]
    if rule.folding == "all":
        return Hypotheses(*whole, np.array(modes)[None])
    if found.means.shape[0] == len(modes):
        return found
    weights = np.stack([shares(column, found.log_weights) for column in found.log_weights.T])
    means, covariances = form.merge(weights, found.means, found.covariances)
    return Hypotheses(means, covariances, on_diagonal(np.array(modes)))
