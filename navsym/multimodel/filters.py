"""Filters for a signal whose model switches: exact, pulsating, K-pulsating, polygaussian, GPB2 and IMM.

One function, :func:`run_filter`, whatever the method; :mod:`navsym.multimodel.schemes` says how the
methods differ. Paper: module ``multistructure``.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from navsym.core import arrays
from navsym.core.errors import DomainError, NotFiniteError, ShapeError
from navsym.language.files import file_in_errors
from navsym.language.jsonfile import read_json
from navsym.language.names import only_keys
from navsym.multimodel.bank import Bank, check_initial, forget_modes, measurements_for, spaced
from navsym.multimodel.doubt import Rerun, moments, settle
from navsym.multimodel.engine import MOST_SENTENCES, Estimates, run_in_numpy
from navsym.multimodel.kalman import FORMS, form_of
from navsym.multimodel.schemes import require_room, scheme

Engine = Literal["auto", "numpy", "compiled"]

KEYS = ("models", "mode_transition", "initial", "measurements", "memoryless", "missing", "times", "step")

UNUSED = "mode_transition is not used: polygaussian takes modes that never switch, equation (19)"
#: What an estimate has for each step.
SERIES = ("probabilities", "mean", "covariance", "log_likelihood")
#: Below this many one-step filters the compiled loops do not pay for being loaded.
WORTH_COMPILING = 200_000
#: In a shorter series two runs of the compiled loops may err alike; the readable engine errs in another way.
WORTH_REPEATING = 2_000


def filter(
    bank: str | os.PathLike[str] | Mapping[str, Any] | Bank,
    z: Any = None,
    method: str = "pulsating",
    *,
    depth: int | None = None,
    memoryless: bool = False,
    missing: bool = False,
    form: str = "joseph",
    engine: Engine = "auto",
) -> Estimates:
    """Mode probabilities, mean, covariance and log-likelihood of a signal whose model switches, after every step.

    bank       : file of a bank (JSON), its document, or a :class:`Bank`
    z          : measurements (T, p), the first row at step 1: an array, lists, or a DataFrame; default: the file's
    method     : ``exact``, ``pulsating``, ``k-pulsating``, ``gpb2``, ``imm`` or ``polygaussian``
    depth      : K of k-pulsating, steps between two mergers; default 2
    memoryless : the printed (14)-(17): the unconditional P[I(k) = i] in the place of p^ij(k)
    missing    : NaN or None is a number that did not come, instead of an error
    form       : of covariances: ``joseph``, or the factors ``qr``, ``potter``, ``ud``, which keep twice the digits
    engine     : ``auto``, ``numpy`` or ``compiled``

    The exact posterior is a mixture with one Gaussian for every sequence of modes. Every method branches it, weighs
    the branches by the likelihoods of their innovations, and merges groups of them; the groups tell methods apart.

    Where doubles may lose their digits, the bank is run twice; where the runs disagree, a hundred digits decide, and a
    remark says so. A singular innovation covariance S (perfect sensors) has its density on the range of S,
    ``(2 pi)^(-r/2) pdet(S)^(-1/2) exp(-v^T S^+ v / 2)``, r its rank, pdet the product of its other eigenvalues. As in
    the limit R -> 0, a mode of lower rank that fits outweighs others; ``left_out`` names steps that fit no mode.

    Returns :class:`Estimates`. Raises NavsymError: ``shape``, ``domain``, ``not-finite``, ``empty``, ``too-large``
    (a tree that does not fit), ``unknown-symbol`` (a key). Source: multistructure:10 to :19.

    >>> import navsym as nav
    >>> nav.filter("examples/switching.json", method="imm")
    <Estimates: 30 steps, 2 modes, 1 states, log-likelihood 13.5329349, engine numpy>
    >>> model = {"F": [[1]], "Q": [[0.1]], "H": [[1]], "R": [[1]]}
    >>> bank = nav.Bank([model, {**model, "R": [[100]]}], [[0.9, 0.1], [0.2, 0.8]],
    ...                 {"mean": [0], "covariance": [[1]], "probabilities": [0.5, 0.5]})
    >>> nav.filter(bank, [[0.1], [30.0]], method="gpb2").modes.tolist()
    [0, 1]
    """
    with file_in_errors(bank, "filter"):
        for name, value in (("memoryless", memoryless), ("missing", missing)):
            switch({name: value}, name)
        if isinstance(bank, Bank):
            given = BankFile(bank, z, memoryless, missing)
        else:
            document = read_json(bank) if isinstance(bank, str | os.PathLike) else bank
            given = read_bank(document, z)
        said: dict[str, Any] = {"memoryless": memoryless or given.memoryless, "missing": missing or given.missing}
        run = functools.partial(run_filter, given.bank, method=method, depth=depth, form=form, engine=engine)
        return run(given.measurements, **said) if given.times is None else run_with_gaps(run, given, said)


def run_with_gaps(run: Callable[..., Estimates], given: BankFile, said: dict[str, bool]) -> Estimates:
    """The estimates at the time stamps: steps without a measurement are predicted, and gaps remarked."""
    table = measurements_for(given.bank, given.measurements, missing=said["missing"])
    wide, places, step = spaced(table, given.times, given.step)
    found = run(wide, memoryless=said["memoryless"], missing=True)
    empty = np.diff(places) - 1
    gaps = [f"gap after time {given.times[k]:g}: {empty[k]} steps without a measurement" for k in np.flatnonzero(empty)]
    if len(gaps) > MOST_SENTENCES:
        gaps = [f"{len(gaps)} gaps, {empty.sum()} steps of {step:g} s without a measurement; the first {gaps[0]}"]
    series: dict[str, Any] = {name: arrays.freeze(getattr(found, name)[places]) for name in SERIES}
    times = arrays.freeze(np.array(given.times, dtype=float))
    return replace(found, **series, times=times, notes=(*gaps, *found.notes))


def run_filter(
    models: Bank,
    measurements: Any,
    method: str = "pulsating",
    *,
    depth: int | None = None,
    memoryless: bool = False,
    missing: bool = False,
    engine: Engine = "auto",
    form: str = "joseph",
) -> Estimates:
    """Filter a series of measurements (T, p), the first row at step 1; arguments as those of :func:`filter`.

    Raises the errors of the bank, DomainError for a method that does not exist, TooLargeError for a tree
    that does not fit.
    """
    rule, kept = scheme(method, depth), form_of(form)
    z = measurements_for(models, measurements, missing=missing)
    if memoryless:
        if rule.branching == "own":
            raise DomainError(
                "memoryless: expected a method that switches modes; got polygaussian, whose modes "
                "never switch; choose another method"
            )
        models = forget_modes(models, len(z))
    roots = 1 if models.common else models.modes
    notes = (UNUSED,) if rule.branching == "own" and (models.mode_transition != np.eye(models.modes)).any() else ()
    count = require_room(rule, models.modes, models.states, roots, len(z))
    run: Rerun = functools.partial(run_in_numpy, rule, count=count, form=kept)
    twin: Rerun = functools.partial(run, form=FORMS["ud" if form == "qr" else "qr"])
    if compiled_fits(count, engine, form):
        from navsym.multimodel.compiled import run_compiled

        run = functools.partial(run_compiled, rule, count=count)
        twin = run if count >= WORTH_REPEATING else twin
    with np.errstate(over="ignore", invalid="ignore"):  # what leaves the range is refused, with its step
        estimate = require_range(settle(require_range(run(models, z=z)), twin, rule, models, z))
    is_blind = models.modes > 1 and method != "exact" and not np.isnan(z).all()
    if is_blind and is_chain(estimate.probabilities, models):
        notes = (*notes, BLIND)
    return replace(estimate, notes=(*notes, *estimate.notes))


#: The remark on mode probabilities that no measurement has changed.
BLIND = (
    "the mode probabilities are those of the chain alone: no measurement tells the modes apart as this method looks "
    "back; ask for one that looks further back, gpb2 or k-pulsating"
)


def is_chain(probabilities: NDArray[np.floating[Any]], models: Bank) -> bool:
    """Whether mode probabilities (T, m) of more than one step are those of the Markov chain without a measurement."""
    alone, now = [], models.probabilities
    for k in range(1, len(probabilities) + 1):
        now = now @ models.at("mode_transition", k)
        alone.append(now)
    return len(alone) > 1 and bool(np.abs(np.array(alone) - probabilities).max() < 1e-12)


def require_range(estimate: Estimates) -> Estimates:
    """The same estimate; NotFiniteError with the first step at which a number left the range of a double."""
    lost = [~np.isfinite(values.reshape(len(values), -1)).all(axis=1) for values in moments(estimate)]
    steps = np.flatnonzero(np.any(lost, axis=0))
    if steps.size:
        raise NotFiniteError(
            f"models: expected estimates below 1.8e308; got larger ones at step {steps[0] + 1}; choose units in "
            "which F, Q and the covariances are moderate"
        )
    return estimate


def compiled_fits(count: int, engine: Engine, form: str) -> bool:
    """Whether to use the compiled loops, which know Joseph's form: asked for, or worth their start-up time."""
    if not isinstance(engine, str) or engine not in ("auto", "numpy", "compiled"):
        raise DomainError(f"engine: expected auto, numpy or compiled; got {engine!r}; choose one")
    if form != "joseph":
        if engine == "compiled":
            raise DomainError(f"engine: expected numpy with the form {form}; got compiled; leave it out")
        return False
    return engine == "compiled" or (engine == "auto" and count >= WORTH_COMPILING)


@dataclass(frozen=True, slots=True, eq=False)
class BankFile:
    """A bank file as data.

    memoryless : the printed (14)-(17)
    missing    : null is a number that did not come
    times, step : time stamps of the rows in s, and the time of one step of the models; None without
    """

    bank: Bank
    measurements: Any
    memoryless: bool
    missing: bool
    times: Any = None
    step: Any = None


def read_bank(document: Mapping[str, Any], z: Any = None) -> BankFile:
    """Read the keys of a bank file: m models of n states, mode_transition (m, m) with rows = from, measurements (T, p).

    Raises DomainError and ShapeError that name the key.
    """
    if not isinstance(document, Mapping):
        raise ShapeError(
            "expected an object with models, mode_transition, initial and measurements; got "
            f"{type(document).__name__}; correct the file"
        )
    only_keys(document, KEYS)
    needed = KEYS[:4] if z is None else KEYS[:3]
    for key in needed:
        if key not in document:
            raise ShapeError(
                f"{key}: expected the keys models, mode_transition, initial and measurements; got no {key}; add it"
            )
    check_initial(document["initial"])
    for key in ("models", "measurements"):
        if not isinstance(document.get(key, []), list | tuple | np.ndarray):
            raise ShapeError(f"{key}: expected a list; got {type(document[key]).__name__}; use [ ]")
    for key in KEYS[:3]:
        no_truth_values(document[key], key)
    made = Bank(document["models"], document["mode_transition"], document["initial"])
    measurements = document["measurements"] if z is None else z
    if "step" in document and "times" not in document:
        raise ShapeError("step: expected times beside it; got none; add one time for each row of measurements")
    switches = switch(document, "memoryless"), switch(document, "missing")
    return BankFile(made, measurements, *switches, document.get("times"), document.get("step"))


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
