"""Studies of many independent jobs: a configuration, a job by its index, a summary.

Every job has a seed sequence of its own, spawned from (seed, index), so that its result does not depend
on who computes it, in what order or beside how many others.

* ``filter``: Monte Carlo of the Schuler bank; one job simulates ``runs`` series and scores one method;
* ``guaranteed``: the guaranteed value of a last coefficient of ``degree`` over lengths T; one job is one T.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from navsym.errors import DomainError
from navsym.store import key_of

KINDS = ("filter", "guaranteed")
METHODS = ("pulsating", "imm", "polygaussian", "gpb2", "k-pulsating", "exact")


@dataclass(frozen=True, slots=True)
class Sweep:
    """A study: kind, number of jobs, seed, and what the kind needs.

    runs, steps, method : of ``filter``
    degree, start, end  : of ``guaranteed``; jobs are equally spaced lengths from start to end
    """

    kind: str
    jobs: int
    seed: int = 0
    runs: int = 16
    steps: int = 20
    method: str = "imm"
    degree: int = 1
    start: str = "1"
    end: str = "2"

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise DomainError(f"kind: expected one of {', '.join(KINDS)}; got {self.kind!r}; correct it")
        if self.method not in METHODS:
            raise DomainError(
                f"method: expected one of {', '.join(METHODS)}; got {self.method!r}; correct it"
            )
        limits = {"jobs": 10**6, "runs": 10**5, "steps": 10**5, "degree": 12}
        for name, limit in limits.items():
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= limit:
                raise DomainError(f"{name}: expected an integer from 1 to {limit}; got {value!r}; correct it")
        if isinstance(self.seed, bool) or not isinstance(self.seed, int) or self.seed < 0:
            raise DomainError(f"seed: expected a nonnegative integer; got {self.seed!r}; correct it")
        if not 0 < length(self.start) <= length(self.end):
            raise DomainError(f"range: expected 0 < start <= end; got {self.start}, {self.end}; correct it")


def length(text: Any) -> Fraction:
    """An exact length from a text such as ``3/2``."""
    try:
        if not isinstance(text, str) or len(text) > 40 or "e" in text.lower():
            raise ValueError("not a short text")
        return Fraction(text)
    except (ValueError, ZeroDivisionError):
        raise DomainError(f'length: expected a number such as "3/2"; got {text!r}; correct it') from None


def sweep_from(document: Mapping[str, Any]) -> Sweep:
    """The study that a configuration file describes."""
    if not isinstance(document, Mapping):
        raise DomainError("expected one JSON object; got something else; see the keys of a sweep")
    unknown = set(document) - set(Sweep.__dataclass_fields__)
    missing = {"kind", "jobs"} - set(document)
    if unknown or missing:
        raise DomainError(
            f"expected the keys of a sweep; got unknown {sorted(unknown)}, missing {sorted(missing)}"
        )
    return Sweep(**document)


def fingerprint(sweep: Sweep) -> str:
    """Digest of the configuration: shards of another study are never mixed in."""
    return key_of("sweep", *(f"{name}={value}" for name, value in sorted(asdict(sweep).items())))


def run_job(sweep: Sweep, index: int) -> dict[str, Any]:
    """One job: a row of plain numbers that depends on the sweep and the index only."""
    return filter_job(sweep, index) if sweep.kind == "filter" else guaranteed_job(sweep, index)


def filter_job(sweep: Sweep, index: int) -> dict[str, Any]:
    from navsym.methods.multimodel_batch import run_batch
    from navsym.methods.multimodel_study import schuler_bank, simulate

    state = np.random.SeedSequence(sweep.seed, spawn_key=(index,)).generate_state(1, np.uint64)[0]
    bank = schuler_bank()
    signals = simulate(bank, sweep.runs, sweep.steps, int(state))
    errors = run_batch(bank, signals.measurements, sweep.method)[0] - signals.states
    squares = [float(value) for value in (errors**2).mean(axis=(0, 1))]
    return {"index": index, "runs": sweep.runs, **{f"mse{k}": value for k, value in enumerate(squares)}}


def guaranteed_job(sweep: Sweep, index: int) -> dict[str, Any]:
    import sympy as sp

    from navsym.methods.guaranteed import solve
    from navsym.methods.guaranteed_problem import from_regressors

    low, high = length(sweep.start), length(sweep.end)
    T = low + (high - low) * Fraction(index, max(1, sweep.jobs - 1))
    t = sp.Symbol("t", real=True)
    end = sp.Rational(T.numerator, T.denominator)
    target = [0] * sweep.degree + [1]
    found = solve(from_regressors([[t**k for k in range(sweep.degree + 1)]], target, t, (0, end)), 15)
    return {"index": index, "T": str(T), "lower": found.lower, "upper": found.upper}


def summary(sweep: Sweep, rows: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """The document of ``navsym sweep``: rows in the order of their index, and means for ``filter``."""
    ordered = sorted((dict(row) for row in rows), key=lambda row: row["index"])
    document: dict[str, Any] = {**asdict(sweep), "fingerprint": fingerprint(sweep), "done": len(ordered)}
    if sweep.kind == "filter" and ordered:
        names = [name for name in ordered[0] if name.startswith("mse")]
        document["rmse"] = [float(np.sqrt(np.mean([row[name] for row in ordered]))) for name in names]
    document["rows"] = ordered
    return document
