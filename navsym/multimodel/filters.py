"""Filters for a signal whose model switches: exact, pulsating, K-pulsating, polygaussian, GPB2 and IMM.

One function, :func:`run`, whatever the method; :mod:`navsym.multimodel.steps` says how the
methods differ. Paper: module ``multistructure``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from navsym.core.errors import DomainError, NotFiniteError, ShapeError
from navsym.language.names import only_keys
from navsym.multimodel.bank import Bank, bank, measurements_for, memoryless
from navsym.multimodel.engine import Estimates, run_in_numpy
from navsym.multimodel.kalman.forms import form_of
from navsym.multimodel.steps import require_room, scheme

Array = NDArray[np.floating[Any]]
Engine = Literal["auto", "numpy", "compiled"]

KEYS = ("models", "mode_transition", "initial", "measurements", "memoryless", "missing")
KEYS_OF_MODEL, KEYS_OF_START = ("F", "Q", "H", "R"), ("mean", "covariance", "probabilities")

#: Below this many one-step filters the compiled loops do not pay for being loaded.
WORTH_COMPILING = 200_000


def run(
    models: Bank,
    measurements: Any,
    method: str = "pulsating",
    *,
    depth: int | None = None,
    forget: bool = False,
    missing: bool = False,
    engine: Engine = "auto",
    form: str = "joseph",
) -> Estimates:
    """Filter a series of measurements (T, p); the first row is at step 1.

    method  : exact, pulsating, k-pulsating, gpb2, imm or polygaussian
    depth   : K of k-pulsating
    forget  : the printed (14)-(17): the unconditional P[I(k) = i] in place of p^ij(k)
    missing : NaN or None is a number that did not come, instead of an error
    engine  : compiled loops, numpy, or whichever fits
    form    : how covariances are kept: joseph, or the factors qr, potter, ud (numpy only), which keep twice the
              digits where covariances are nearly singular

    Raises the errors of the bank, DomainError for a method that does not exist, TooLargeError for a tree
    that does not fit.
    """
    rule, kept = scheme(method, depth), form_of(form)
    z = measurements_for(models, measurements, missing=missing)
    if forget:
        if rule.branching == "own":
            raise DomainError(
                "memoryless: expected a method that switches modes; got polygaussian, whose modes "
                "never switch; choose another method"
            )
        models = memoryless(models, len(z))
    roots = 1 if models.common else models.modes
    count = require_room(rule, models.modes, models.states, roots, len(z))
    if compiled_fits(count, engine, form):
        from navsym.multimodel import fast as multimodel_fast

        return in_range(multimodel_fast.run_compiled(rule, models, z, count))
    with np.errstate(over="ignore", invalid="ignore"):  # what leaves the range is refused, with its step
        return in_range(run_in_numpy(rule, models, z, count, kept))


def in_range(estimate: Estimates) -> Estimates:
    """The same estimate; NotFiniteError with the first step at which a number left the range of a double."""
    series = (estimate.mean, estimate.covariance, estimate.probabilities, estimate.log_likelihood)
    lost = [~np.isfinite(values.reshape(len(values), -1)).all(axis=1) for values in series]
    steps = np.flatnonzero(np.any(lost, axis=0))
    if steps.size:
        raise NotFiniteError(
            f"models: expected estimates below 1.8e308; got larger ones at step {steps[0] + 1}; choose units in "
            "which F, Q and the covariances are moderate"
        )
    return estimate


def compiled_fits(count: int, engine: Engine, form: str) -> bool:
    """Whether to use the compiled loops, which know Joseph's form: asked for, or worth their start-up time."""
    if engine not in ("auto", "numpy", "compiled"):
        raise DomainError(f"engine: expected auto, numpy or compiled; got {engine!r}; choose one")
    if form != "joseph":
        if engine == "compiled":
            raise DomainError(f"engine: expected numpy with the form {form}; got compiled; leave it out")
        return False
    return engine == "compiled" or (engine == "auto" and count >= WORTH_COMPILING)


@dataclass(frozen=True, slots=True, eq=False)
class BankFile:
    """A bank file as data.

    forget  : ``"memoryless": true``, the printed (14)-(17)
    missing : ``"missing": true``, null is a number that did not come
    """

    bank: Bank
    measurements: Any
    forget: bool
    missing: bool


def read_bank(document: Mapping[str, Any]) -> BankFile:
    """Read the keys of a bank file: m models of n states, mode_transition (m, m) with rows = from, measurements (T, p).

    Raises DomainError and ShapeError that name the key.
    """
    if not isinstance(document, Mapping):
        raise ShapeError(
            "expected an object with models, mode_transition, initial and measurements; got "
            f"{type(document).__name__}; see the interfaces"
        )
    only_keys(document, KEYS)
    for key in KEYS[:4]:
        if key not in document:
            raise ShapeError(
                f"{key}: expected the keys models, mode_transition, initial and measurements; got no {key}; add it"
            )
    start = document["initial"]
    for key in ("mean", "covariance", "probabilities"):
        if not isinstance(start, Mapping) or key not in start:
            raise ShapeError(f"initial.{key}: expected mean, covariance and probabilities; got no {key}; add it")
    for key in ("models", "measurements"):
        if not isinstance(document[key], list):
            raise ShapeError(f"{key}: expected a list; got {type(document[key]).__name__}; use [ ]")
    only_keys(start, KEYS_OF_START, "initial")
    for i, model in enumerate(document["models"]):
        if isinstance(model, Mapping):
            only_keys(model, KEYS_OF_MODEL, f"models[{i}]")
    for key in KEYS[:3]:
        no_truth_values(document[key], key)
    made = bank(
        document["models"], document["mode_transition"], start["mean"], start["covariance"], start["probabilities"]
    )
    return BankFile(made, document["measurements"], switch(document, "memoryless"), switch(document, "missing"))


def no_truth_values(value: Any, place: str) -> None:
    """ShapeError for a true or false among numbers, which would pass for 1 or 0."""
    if isinstance(value, bool):
        raise ShapeError(f"{place}: expected numbers; got {value!r}; give a number")
    items = value.items() if isinstance(value, Mapping) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        if not isinstance(inner, int | float) or isinstance(inner, bool):
            no_truth_values(inner, f"{place}.{key}" if isinstance(key, str) else f"{place}[{key}]")


def switch(document: Mapping[str, Any], key: str) -> bool:
    """An optional true or false."""
    value = document.get(key, False)
    if not isinstance(value, bool):
        raise DomainError(f"{key}: expected true or false; got {value!r}; write true or false")
    return value
