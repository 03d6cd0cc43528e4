"""Studies of many independent jobs: a configuration, a job by its index, a summary.

Every job has a seed sequence of its own, spawned from (seed, index), so that its result does not depend
on who computes it, in what order or beside how many others.

* ``filter``: Monte Carlo of the Schuler bank; one job simulates ``runs`` series and scores one method;
* ``terrain``: Monte Carlo of fixes over matplotlib's map; one job is one flight, matched by every algorithm;
* ``guaranteed``: the guaranteed value of a last coefficient of ``degree`` over lengths T; one job is one T;
* ``phases``: the guaranteed value of a constant beside cos(w t) and sin(w t), with the number of its
  instants, over lengths T and frequencies w; one job is one pair;
* ``two-stage``: position errors after the first fix over the decay rates of the two stages; one job is one pair.

A study over two parameters has ``columns`` values of the second one for each value of the first.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from typing import Annotated, Any, Literal

import msgspec
import numpy as np
from msgspec import Meta

from navsym.claims.paper import import_paper
from navsym.core.errors import DomainError, NavsymError, NotFiniteError
from navsym.core.exact import to_rational
from navsym.core.store import key_of
from navsym.language.structs import fit_struct

Kind = Literal["filter", "terrain", "guaranteed", "phases", "two-stage"]
Method = Literal["pulsating", "imm", "polygaussian", "gpb2", "k-pulsating", "exact"]


class Sweep(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A study: kind, number of jobs, seed, and what the kind needs.

    runs, steps, method : of ``filter``
    degree              : of ``guaranteed``
    start, end          : range of the first parameter, T or lambda_c; equally spaced values
    columns             : number of values of the second parameter, w or lambda_h; it divides jobs
    second_start, second_end : range of the second parameter
    """

    kind: Kind
    jobs: Annotated[int, Meta(ge=1, le=10**6)]
    seed: Annotated[int, Meta(ge=0)] = 0
    runs: Annotated[int, Meta(ge=1, le=10**5)] = 16
    steps: Annotated[int, Meta(ge=1, le=10**5)] = 20
    method: Method = "imm"
    degree: Annotated[int, Meta(ge=1, le=12)] = 1
    start: str = "1"
    end: str = "2"
    columns: Annotated[int, Meta(ge=1, le=10**6)] = 1
    second_start: str = "1"
    second_end: str = "2"

    def __post_init__(self) -> None:
        if self.jobs % self.columns:
            raise DomainError(f"columns: expected a divisor of {self.jobs} jobs; got {self.columns}; correct it")
        for low, high in ((self.start, self.end), (self.second_start, self.second_end)):
            if not 0 < length(low) <= length(high):
                raise DomainError(f"range: expected 0 < start <= end; got {low}, {high}; correct it")

    def parameters(self, index: int) -> tuple[Fraction, Fraction]:
        """The pair of parameters of a job."""
        row, column = divmod(index, self.columns)
        first = spaced(self.start, self.end, row, self.jobs // self.columns)
        return first, spaced(self.second_start, self.second_end, column, self.columns)


def spaced(start: str, end: str, place: int, count: int) -> Fraction:
    """One of ``count`` equally spaced exact values."""
    low, high = length(start), length(end)
    return low + (high - low) * Fraction(place, max(1, count - 1))


def length(text: Any) -> Fraction:
    """An exact length from a text such as ``3/2``."""
    try:
        if not isinstance(text, str) or len(text) > 40 or "e" in text.lower():
            raise ValueError("not a short text")
        return Fraction(text)
    except (ValueError, ZeroDivisionError):
        raise DomainError(f'length: expected a number such as "3/2"; got {text!r:.80}; correct it') from None


def sweep_from(document: Mapping[str, Any]) -> Sweep:
    """The study that a configuration file describes; raises DomainError that names the key."""
    if not isinstance(document, Mapping):
        raise DomainError(f"expected one JSON object; got {type(document).__name__}; see the keys of a sweep")
    return fit_struct(dict(document), Sweep)


def fingerprint(sweep: Sweep) -> str:
    """Digest of the configuration: shards of another study are never mixed in."""
    return key_of("sweep", *(f"{name}={value}" for name, value in sorted(msgspec.structs.asdict(sweep).items())))


def run_job(sweep: Sweep, index: int) -> dict[str, Any]:
    """One job: a row of plain numbers that depends on the sweep and the index only.

    Raises NavsymError that names the job, also where a number of the row is not finite.
    """
    try:
        with np.errstate(all="ignore"):  # what overflows is seen in the row
            job = JOBS.get(sweep.kind) or import_paper(PAPERS[sweep.kind]).sweep_job
            row = job(sweep, index)
    except NavsymError as error:
        raise error.at(f"job {index}") from None
    for name, value in row.items():
        if isinstance(value, float) and not math.isfinite(value):
            message = f"expected a finite {name}; got {value}; take another range of parameters"
            raise NotFiniteError(message, where=f"job {index}")
    return row


def guaranteed_job(sweep: Sweep, index: int) -> dict[str, Any]:
    """Guaranteed estimation of the highest coefficient of a polynomial on [0, T], noise bound one.

    lower, upper : decimal strings that enclose the optimum, to 15 digits
    """
    T, _ = sweep.parameters(index)
    found = solve_on(T, lambda t: [t**k for k in range(sweep.degree + 1)], [0] * sweep.degree + [1])
    return {"index": index, "T": str(T), "lower": found.lower, "upper": found.upper}


def solve_on(T: Fraction, regressors: Callable[[Any], list[Any]], target: list[int]) -> Any:
    """The guaranteed estimator to 15 digits on [0, T], with regressors in the time and a noise bound of one."""
    import sympy as sp

    from navsym.guaranteed.problem import from_regressors
    from navsym.guaranteed.solver import solve

    t = sp.Symbol("t", real=True)
    return solve(from_regressors([regressors(t)], target, t, (0, to_rational(T))), digits=15)


def phases_job(sweep: Sweep, index: int) -> dict[str, Any]:
    """Guaranteed estimation of a constant beside a sine and a cosine of w t on [0, T], noise bound one.

    lower, upper : decimal strings that enclose the optimum, to 15 digits ; instants : size of the support
    """
    import sympy as sp

    T, w = sweep.parameters(index)
    found = solve_on(T, lambda t: [1, sp.cos(to_rational(w) * t), sp.sin(to_rational(w) * t)], [1, 0, 0])
    bounds = {"lower": found.lower, "upper": found.upper, "instants": len(found.support)}
    return {"index": index, "T": str(T), "w": str(w), **bounds}


JOBS: dict[str, Callable[[Sweep, int], dict[str, Any]]] = {"guaranteed": guaranteed_job, "phases": phases_job}
#: Kinds that repeat the experiment of a paper: the module whose ``sweep_job`` computes a row.
PAPERS = {
    "filter": "multistructure.experiment.study",
    "terrain": "terrain_search.experiment.study",
    "two-stage": "joint_correction.experiment.study",
}


def summary(sweep: Sweep, rows: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """The document of ``navsym sweep``: rows in the order of their index, and means for ``filter``."""
    ordered = sorted((dict(row) for row in rows), key=lambda row: row["index"])
    document: dict[str, Any] = {
        **msgspec.structs.asdict(sweep),
        "fingerprint": fingerprint(sweep),
        "done": len(ordered),
    }
    if sweep.kind == "filter" and ordered:
        names = [name for name in ordered[0] if name.startswith("mse")]
        document["rmse"] = [float(np.sqrt(np.mean([row[name] for row in ordered]))) for name in names]
    document["rows"] = ordered
    return document
