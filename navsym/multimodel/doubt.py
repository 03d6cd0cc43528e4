"""Doubt: where doubles lose their digits a bank is filtered again with a hundred of them.

A bank does not change when its states are measured in other units, but its rounding does, and factors round
differently from covariances. Where two such runs disagree, or where an innovation covariance is singular, doubles
cannot tell, and :mod:`navsym.multimodel.digits` decides.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from navsym.core import arrays
from navsym.multimodel.bank import Bank
from navsym.multimodel.engine import Estimates
from navsym.multimodel.kalman import Array
from navsym.multimodel.schemes import Scheme

Moments = tuple[Array, Array, Array, Array]
Rerun = Callable[..., Estimates]

#: Disagreement of two runs, in probability or standard deviations, that passes for rounding.
ROUNDING = 1e-9
#: Products of numbers for which a hundred digits are worth the wait: about half a minute.
WORK = 15_000_000


def settle(estimate: Estimates, rerun: Rerun, rule: Scheme, models: Bank, z: Array) -> Estimates:
    """The estimate where ``rerun``, in other units, agrees with it; else the one of a hundred digits, with a note.

    An estimate that is sound needs no rerun.
    """
    if estimate.sound:
        return estimate
    units = other_units(models)
    twin = moments(rerun(in_units(models, *units), z=arrays.freeze(z * units[1])))
    doubt = disagreements(moments(estimate), twin, z, *units)
    doubtful = np.flatnonzero(doubt > ROUNDING)
    if not (doubtful.size or estimate.singular):
        return estimate
    first = min([*estimate.singular[:1], *(int(k) + 1 for k in doubtful[:1])])
    lost = f"step {first}: double precision does not suffice from here on"
    n, p = models.states, models.channels
    work = estimate.filters_run * (2 * n**3 + 3 * n * n * p + n * p * p + p**3 + 100)
    if work <= WORK:
        from navsym.multimodel.digits import run_in_digits

        note = f"{lost}; filtered with a hundred digits instead of any form"
        return replace(run_in_digits(rule, models, z, estimate.filters_run), notes=(note,))
    reason = f"two runs differ by {np.max(doubt):.1g}" if doubtful.size else "an innovation covariance is singular"
    remedy = "ask for a form that keeps twice the digits (qr, ud), or filter fewer steps"
    note = f"{lost}: {reason}; {remedy}"
    return replace(estimate, notes=(note,))


def moments(estimate: Estimates) -> Moments:
    """Mean, covariance, probabilities and log-likelihood, as a batch has them."""
    return estimate.mean, estimate.covariance, estimate.probabilities, estimate.log_likelihood


def other_units(models: Bank) -> tuple[Array, Array]:
    """Units of the states (n,) and of the measurements (p,) that no double scales exactly."""
    parts = np.modf(np.arange(1, models.states + models.channels + 1) * (math.sqrt(5.0) - 1.0) / 2.0)[0]
    return 1.0 + parts[: models.states], 1.0 + parts[models.states :]


def in_units(models: Bank, states: Array, measured: Array) -> Bank:
    """The same bank with ``states x`` for x and ``measured z`` for z."""
    other = copy.copy(models)
    for name, left, right in (
        ("F", states, 1.0 / states),
        ("Q", states, states),
        ("H", measured, 1.0 / states),
        ("R", measured, measured),
        ("covariances", states, states),
    ):
        object.__setattr__(other, name, arrays.freeze(getattr(models, name) * (left[:, None] * right)))
    object.__setattr__(other, "means", arrays.freeze(models.means * states))
    return other


def disagreements(a: Moments, b: Moments, z: Array, states: Array, measured: Array) -> Array:
    """The largest difference (..., T) of estimates a and, in other units, b: in probability or standard deviations.

    A mean may differ by its own last places, and a log-likelihood counts relative to its size.
    """
    volume = np.cumsum((np.log(measured) * ~np.isnan(z)).sum(axis=-1), axis=-1)
    with np.errstate(all="ignore"):
        mean, covariance, log_likelihood = b[0] / states, b[1] / (states[:, None] * states), b[3] + volume
        spread = np.sqrt(np.diagonal(covariance, axis1=-2, axis2=-1).clip(0.0))
        shift = np.maximum(np.abs(a[0] - mean) - 1e-14 * np.abs(mean), 0.0)
        scale = spread[..., :, None] * spread[..., None, :]
        parts = (
            quotient(shift, spread).max(axis=-1),
            quotient(np.abs(a[1] - covariance), scale).max(axis=(-2, -1)),
            np.abs(a[2] - b[2]).max(axis=-1),
            np.abs(a[3] - log_likelihood) / (1.0 + np.abs(log_likelihood)),
        )
        worst = np.max(parts, axis=0)
    return np.where(np.isnan(worst), np.inf, worst)


def quotient(part: Array, whole: Array) -> Array:
    """``part / whole``, zero for nothing of nothing."""
    return np.where(part == 0.0, 0.0, part / np.where(part == 0.0, 1.0, whole))
