"""Banks of models, as checked arrays, and the measurements that they filter.

``x(k) = F_i x(k-1) + w``, ``z(k) = H_i x(k) + r``, where i = I(k) is a Markov chain. Claims (4)-(6).
"""

from __future__ import annotations

import copy
import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.core import arrays
from navsym.core.arrays import Array
from navsym.core.errors import DomainError, EmptyError, NotFiniteError, ShapeError, TooLargeError
from navsym.language.names import only_keys

KEYS_OF_MODEL, KEYS_OF_START = ("F", "Q", "H", "R"), ("mean", "covariance", "probabilities")


@dataclass(frozen=True, slots=True, eq=False, init=False, repr=False)
class Bank:
    """m models of one state x (n,) and one measurement z (p,), over time: ``x' = F_i x + w``, ``z = H_i x + r``.

    models          : one mapping ``{"F", "Q", "H", "R"}`` for each mode; a matrix, or a list of matrices over time
    mode_transition : (m, m), rows = from, or a list over time; rows sum to one
    initial         : ``{"mean": (n,) or (m, n), "covariance": (n, n) or (m, n, n), "probabilities": (m,)}`` at step 0

    Afterwards the attributes are read-only arrays, index 0 of the time axis being the step from time 0 to time 1:

    F, Q  : (T or 1, m, n, n)  transition matrices and covariances of the process noise
    H     : (T or 1, m, p, n)  observation matrices
    R     : (T or 1, m, p, p)  covariances of the measurement noise
    mode_transition : (T or 1, m, m), entry [k, i, j] leads from mode i to mode j in step k
    probabilities   : (m,)     of the mode at step 0
    means, covariances : (m, n), (m, n, n) of the state at step 0, given the mode at step 0
    common          : True when all modes start from one Gaussian
    horizon         : length of the lists over time, or None when nothing depends on time

    All modes explain the same p numbers: densities over different numbers cannot be compared. A mode in
    which a sensor says nothing has a zero row in H and the spread of that sensor in R.

    Raises ShapeError, NotFiniteError, DomainError, EmptyError, each naming the entry. Source: multistructure:4 to :6.

    >>> import navsym as nav
    >>> quiet = {"F": [[1]], "Q": [[0.01]], "H": [[1]], "R": [[1]]}
    >>> bank = nav.Bank([quiet, {**quiet, "Q": [[25]]}], [[0.9, 0.1], [0.2, 0.8]],
    ...                 {"mean": [0], "covariance": [[1]], "probabilities": [0.5, 0.5]})
    >>> bank
    <Bank: 2 modes, 1 states, 1 measurements>
    """

    F: Array
    Q: Array
    H: Array
    R: Array
    mode_transition: Array
    probabilities: Array
    means: Array
    covariances: Array
    common: bool
    horizon: int | None

    def __init__(self, models: Any, mode_transition: Any, initial: Any) -> None:
        rows = checked_models(models)
        check_initial(initial)
        m = len(rows)
        F = stacked(rows, "F", functools.partial(arrays.as_array, why="states by states"))
        n = F.shape[2]
        if F.shape[3] != n:
            raise ShapeError(f"models[0].F: expected a square matrix; got {F.shape[2:]}; give n rows of n numbers")
        H = stacked(rows, "H", functools.partial(arrays.as_array, why="measurements by states"))
        p = H.shape[2]
        if H.shape[3] != n:
            raise ShapeError(f"models[0].H: expected {n} columns, one per state; got {H.shape[3]}; match F")
        Q = stacked(rows, "Q", covariance_of(n, "one row per state"))
        R = stacked(rows, "R", covariance_of(p, "one row per measurement"))
        transition = transitions(mode_transition, m)
        start, spread, common = initial_moments(initial["mean"], initial["covariance"], m, n)
        probabilities = arrays.as_probabilities("initial.probabilities", initial["probabilities"], m)
        steps = length_of_lists([mode_transition, *(model[key] for model in rows for key in KEYS_OF_MODEL)])
        values = (F, Q, H, R, transition, probabilities, start, spread, common, steps)
        for field, value in zip(fields(self), values, strict=True):
            object.__setattr__(self, field.name, value)

    def __repr__(self) -> str:
        return f"<Bank: {self.modes} modes, {self.states} states, {self.channels} measurements>"

    @property
    def modes(self) -> int:
        """Number m of models."""
        return int(self.F.shape[1])

    @property
    def states(self) -> int:
        """Size n of the state."""
        return int(self.F.shape[2])

    @property
    def channels(self) -> int:
        """Size p of the measurement."""
        return int(self.H.shape[2])

    def at(self, name: str, k: int) -> Array:
        """F, Q, H, R (m, ...) or mode_transition (m, m) of step k = 1, 2, ..."""
        stack: Array = getattr(self, name)
        return stack[0 if stack.shape[0] == 1 else k - 1]


def checked_models(models: Any) -> list[Any]:
    """The models as a list of at least one mapping of known keys."""
    if isinstance(models, str | Mapping) or not hasattr(models, "__iter__"):
        raise ShapeError(f"models: expected a list; got {type(models).__name__}; use [ ]")
    rows = list(models)
    if not rows:
        raise EmptyError("models: expected at least one model; got none; give F, Q, H and R of each mode")
    for i, model in enumerate(rows):
        if isinstance(model, Mapping):
            only_keys(model, KEYS_OF_MODEL, f"models[{i}]")
    return rows


def check_initial(initial: Any) -> None:
    """Refuse a start without mean, covariance and probabilities, or with anything else."""
    for key in KEYS_OF_START:
        if not isinstance(initial, Mapping) or key not in initial:
            raise ShapeError(f"initial.{key}: expected mean, covariance and probabilities; got no {key}; add it")
    only_keys(initial, KEYS_OF_START, "initial")


def covariance_of(size: int, why: str) -> Any:
    """A gate for one covariance matrix of the given size."""

    def gate(name: str, value: Any, shape: Any) -> Array:
        arrays.as_array(name, value, (size, size), why)
        return arrays.as_covariance(name, value, size)

    return gate


def stacked(models: Sequence[Any], key: str, gate: Any) -> Array:
    """One matrix of every model, (T or 1, m, a, b); models that do not change are repeated."""
    rows = [over_time(f"models[{i}].{key}", entry(model, i, key), gate) for i, model in enumerate(models)]
    first = rows[0].shape[1:]
    for i, row in enumerate(rows):
        if row.shape[1:] != first:
            raise ShapeError(
                f"models[{i}].{key}: expected shape {first} as in models[0]; got {row.shape[1:]}; "
                "all modes share one state and one measurement vector"
            )
    length = max(len(row) for row in rows)
    if any(len(row) not in (1, length) for row in rows):
        raise ShapeError(
            f"models.{key}: expected lists over time of one length; got "
            f"{sorted({len(row) for row in rows})}; give every step or one matrix"
        )
    return arrays.freeze(np.stack([np.broadcast_to(row, (length, *first)) for row in rows], axis=1))


def entry(model: Any, i: int, key: str) -> Any:
    """Entry of one model, with an error that names it when it is not there."""
    try:
        return model[key]
    except (KeyError, TypeError, IndexError):
        raise ShapeError(f"models[{i}].{key}: expected the matrices F, Q, H and R; got no {key}; add it") from None


def over_time(name: str, value: Any, gate: Any) -> Array:
    """A matrix, or a list of matrices over time, as (T or 1, a, b)."""
    if depth(value) < 3:
        return np.asarray(gate(name, value, (None, None)))[None]
    if len(value) == 0:
        raise EmptyError(f"{name}: expected one matrix per step; got an empty list; give a matrix")
    parts = [np.asarray(gate(f"{name}[{k}]", part, (None, None))) for k, part in enumerate(value)]
    if len({part.shape for part in parts}) > 1:
        raise ShapeError(f"{name}: expected matrices of one shape over time; got several; use missing entries")
    return np.stack(parts)


def depth(value: Any) -> int:
    """How deep lists are nested; arrays count their axes."""
    if isinstance(value, np.ndarray):
        return value.ndim
    if isinstance(value, list | tuple):
        return 1 + max((depth(item) for item in value), default=0)
    return 0


def transitions(value: Any, m: int) -> Array:
    """Transition probabilities as (T or 1, m, m)."""
    rows = over_time("mode_transition", value, lambda name, part, _: arrays.as_transition(name, part, m))
    return arrays.freeze(rows)


def initial_moments(mean: Any, covariance: Any, m: int, n: int) -> tuple[Array, Array, bool]:
    """Means (m, n) and covariances (m, n, n) at step 0, and whether they are one Gaussian."""
    common = depth(mean) < 2 and depth(covariance) < 3
    if depth(mean) < 2:
        means = np.tile(arrays.as_array("initial.mean", mean, (n,), "one entry per state"), (m, 1))
    else:
        means = arrays.as_array("initial.mean", mean, (m, n), "one row per mode")
    gate = covariance_of(n, "one row per state")
    if depth(covariance) < 3:
        spread = np.tile(gate("initial.covariance", covariance, None), (m, 1, 1))
    elif len(covariance) != m:
        raise ShapeError(f"initial.covariance: expected one per mode, {m}; got {len(covariance)}; give all")
    else:
        spread = np.stack([gate(f"initial.covariance[{i}]", c, None) for i, c in enumerate(covariance)])
    return arrays.freeze(means), arrays.freeze(spread), common


def length_of_lists(values: Sequence[Any]) -> int | None:
    """The one length of all lists over time, also when it is 1; None where there is no list."""
    lengths = {len(value) for value in values if depth(value) > 2}
    if len(lengths) > 1:
        raise ShapeError(f"models: expected lists over time of one length; got {sorted(lengths)}; match them")
    return lengths.pop() if lengths else None


def measurements_for(made: Bank, values: Any, *, missing: bool = False) -> Array:
    """Measurements (T, p), NaN where a number is missing.

    With ``missing`` a None or NaN is a number that did not come; otherwise it is a NotFiniteError
    that names the row. Infinities are always refused.
    """
    table = table_of(values, made.channels)
    if len(table) == 0:
        raise EmptyError("measurements: expected at least one row; got none; give the measurement of step 1")
    bad = ~np.isfinite(table)
    if missing:
        bad &= ~np.isnan(table)
    if bad.any():
        k, j = (int(i) for i in np.argwhere(bad)[0])
        raise NotFiniteError(
            f"measurements[{k}]: expected a finite number; got {table[k, j]} in entry {j}; "
            "mend it, or say that none came with --missing, missing=True"
        )
    if made.horizon is not None and len(table) > made.horizon:
        raise ShapeError(
            f"measurements: expected at most {made.horizon} rows, the steps for which models are "
            f"given; got {len(table)}; give models for every step"
        )
    return arrays.freeze(table)


#: Steps that time stamps may span.
MOST_STEPS = 2_000_000


def spaced(table: Any, times: Any, step: Any) -> tuple[list[Any], NDArray[np.intp], float]:
    """Rows at every multiple of a step, None where no measurement came; where the given rows stand; and the step.

    times : one increasing number for each row, whole steps apart (to a millionth of one)
    step  : seconds of one step of the models; None takes the shortest time between two rows

    >>> spaced([[1.0], [2.0]], [10.0, 10.6], 0.2)[1].tolist()
    [0, 3]
    """
    rows = list(table)
    t = arrays.as_array("times", times, (len(rows),), "one for each row of measurements", "s")
    step = arrays.without_units(step, "step", "s")
    gaps = np.diff(t)
    if (gaps <= 0.0).any():
        k = int(np.flatnonzero(gaps <= 0.0)[0])
        raise DomainError(f"times: expected increasing numbers; got {t[k + 1]:g} after {t[k]:g}; sort the rows")
    if step is None:
        step = float(gaps.min()) if gaps.size else 1.0
    if isinstance(step, bool) or not isinstance(step, int | float | np.number) or not 0.0 < float(step) < np.inf:
        raise DomainError(f"step: expected a positive number of seconds; got {step!r:.40}; give the step of the models")
    counts = (t - t[0]) / float(step) if len(t) else t
    off = np.flatnonzero(np.abs(counts - np.round(counts)) > 1e-6 * np.maximum(1.0, counts))
    if off.size:
        k = int(off[0])
        raise DomainError(
            f"times[{k}]: expected a whole number of steps of {float(step):g} s after times[0]; got "
            f"{counts[k]:.9g}; give the key step, or models over time"
        )
    places = np.round(counts).astype(np.intp)
    if len(places) and places[-1] >= MOST_STEPS:
        raise TooLargeError(f"times: expected at most {MOST_STEPS} steps; got {places[-1] + 1}; give a longer step")
    wide: list[Any] = [None] * (int(places[-1]) + 1 if len(places) else 0)
    for place, row in zip(places, rows, strict=True):
        wide[place] = row
    return wide, places, float(step)


def table_of(values: Any, p: int) -> Array:
    """Rows of p numbers as an array of floats, NaN for None."""
    values = arrays.without_units(values.to_numpy() if hasattr(values, "to_numpy") else values, "measurements")
    if isinstance(values, np.ndarray) and values.dtype.kind in "fiu" and values.ndim == 2:
        if values.shape[1] != p:
            raise ShapeError(f"measurements: expected {p} columns, one per row of H; got {values.shape[1]}; match H")
        return np.array(values, dtype=float)
    if isinstance(values, str | bytes | Mapping) or not hasattr(values, "__iter__"):
        raise ShapeError(f"measurements: expected rows of {p} numbers; got {type(values).__name__}; give a list")
    rows = list(values)
    table = np.empty((len(rows), p))
    for k, row in enumerate(rows):
        entries = [None] * p if row is None else list(row) if isinstance(row, list | tuple | np.ndarray) else [row]
        if len(entries) != p:
            raise ShapeError(f"measurements[{k}]: expected {p} numbers, one per row of H; got {len(entries)}; match H")
        table[k] = [np.nan if e is None else number(e, k) for e in entries]
    return table


def number(value: Any, row: int) -> float:
    """One number of a measurement row."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.number):
        raise ShapeError(f"measurements[{row}]: expected numbers; got {value!r}; give a number")
    return float(value)


def forget_modes(made: Bank, steps: int) -> Bank:
    """The bank with transitions that forget: every row of step k is P[I(k) = i], multistructure:14*.

    Printed (14)-(17): the unconditional probabilities of the chain take the place of p^ij(k).
    """
    row = np.array(made.probabilities)
    stack = np.empty((max(steps, 1), made.modes, made.modes))
    for k in range(1, len(stack) + 1):
        row = row @ made.at("mode_transition", min(k, made.mode_transition.shape[0]))
        stack[k - 1] = row
    twin = copy.copy(made)
    object.__setattr__(twin, "mode_transition", arrays.freeze(stack))
    return twin
