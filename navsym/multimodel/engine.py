"""The readable engine of the multiple-model filters, and the estimates that every engine returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.claims.display import table
from navsym.core import arrays
from navsym.core.answers import Answer
from navsym.multimodel import steps
from navsym.multimodel.bank import Bank
from navsym.multimodel.kalman.forms import FORMS, Form
from navsym.multimodel.steps import Scheme

Array = NDArray[np.floating[Any]]

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
    left_out      : steps whose measurement had to be left out, because even its logarithm has no number
    engine        : ``compiled`` or ``numpy``, whichever ran
    notes         : further sentences for people
    """

    probabilities: Array
    mean: Array
    covariance: Array
    log_likelihood: Array
    filters_run: int
    impossible: tuple[int, ...] = ()
    left_out: tuple[int, ...] = ()
    engine: str = "numpy"
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
        unlikely = (
            f"step {k}: every mode gives this measurement a likelihood below 1e-323; weighed by logarithms"
            for k in self.impossible
            if k not in self.left_out
        )
        left = (f"step {k}: the measurement is impossible under every mode; left out" for k in self.left_out)
        return (*self.notes, *unlikely, *left)

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym filter``."""
        return {
            "probabilities": self.probabilities.tolist(),
            "mean": self.mean.tolist(),
            "covariance": self.covariance.tolist(),
            "log_likelihood": self.log_likelihood.tolist(),
            "filters_run": self.filters_run,
        }

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

    def _repr_html_(self) -> str:
        rows = self.rows()
        shown = rows if len(rows) <= 20 else [*rows[:10], ("…",) * 4, *rows[-10:]]
        return table(("step", "mode", "probability", "mean (standard deviation)"), shown)


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
