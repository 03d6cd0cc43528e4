"""The readable engine of the multiple-model filters, and what every engine returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.core import arrays
from navsym.multimodel import steps
from navsym.multimodel.bank import Bank
from navsym.multimodel.kalman.forms import FORMS, Form
from navsym.multimodel.steps import Scheme

Array = NDArray[np.floating[Any]]

#: Log-likelihood below which every likelihood is zero in double precision.
UNDERFLOW = -745.0


@dataclass(frozen=True, slots=True, eq=False)
class Estimates:
    """What a filter says after every step k = 1 .. T.

    probabilities : (T, m)     of the modes, given the measurements so far
    mean          : (T, n)     of the state
    covariance    : (T, n, n)  of its error
    log_likelihood: (T,)       of all measurements so far
    filters_run   : one-step Kalman filters that ran, all steps together
    impossible    : steps whose measurement has a likelihood below the smallest double under every mode; the
                    weights are right all the same, because they are kept as logarithms
    left_out      : steps whose measurement had to be left out, because even its logarithm has no number
    """

    probabilities: Array
    mean: Array
    covariance: Array
    log_likelihood: Array
    filters_run: int
    impossible: tuple[int, ...] = ()
    left_out: tuple[int, ...] = ()


def run_in_numpy(rule: Scheme, models: Bank, z: Array, count: int, form: Form = FORMS["joseph"]) -> Estimates:
    """The readable engine: one :func:`multimodel_steps.advance` per row."""
    now = steps.start(models, rule, form)
    found: list[steps.Step] = []
    for k, row in enumerate(z, start=1):
        step = steps.advance(rule, k, models, now, row, form)
        now = step.hypotheses
        found.append(step)
    return collected(found, models, count)


def collected(found: list[steps.Step], models: Bank, count: int) -> Estimates:
    """Stack what the steps found."""
    T, m, n = len(found), models.modes, models.states
    best = [step.best for step in found]
    return Estimates(
        arrays.frozen(np.array([s.probabilities for s in found]).reshape(T, m)),
        arrays.frozen(np.array([s.mean for s in found]).reshape(T, n)),
        arrays.frozen(np.array([s.covariance for s in found]).reshape(T, n, n)),
        arrays.frozen(np.cumsum([s.log_likelihood for s in found])),
        count,
        tuple(k for k, b in enumerate(best, start=1) if b < UNDERFLOW),
        tuple(k for k, b in enumerate(best, start=1) if b == -np.inf),
    )
