"""A file of measurements through a guard: what the verb does."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from navsym.core.errors import DomainError, NavsymError
from navsym.guaranteed.streaming.guard import Guard
from navsym.guaranteed.streaming.table import read_epochs
from navsym.language.files import name_file
from navsym.models.model import Model

#: Rows of certificates up to which every epoch of a document has its own.
MOST_CERTIFIED = 20_000


@dataclass(frozen=True, slots=True)
class Stream:
    """The epochs of a file, in order, as rows of the document; remarks for people."""

    target: str
    radius_kind: str
    rows: tuple[dict[str, Any], ...]
    remarks: tuple[str, ...]

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym guard``."""
        return {"epochs": list(self.rows), "radius_kind": self.radius_kind}

    def summary(self) -> str:
        """One line for people."""
        count = sum(row["estimate"] is not None for row in self.rows)
        words = {
            "bounded": "errors of at most sigma",
            "variance": "standard deviations of at most sigma, any correlation",
            "outliers": "errors of at most sigma, but for a few gross ones",
        }
        told = f"{self.target}: {len(self.rows)} epochs, {count} with an estimate; {words[self.radius_kind]}"
        return told if count else f"{told}\nthese measurements never determine it: navsym observe names what is free"


def run_stream(
    file: str | os.PathLike[str],
    data: str | os.PathLike[str],
    target: str | None,
    bound: str,
    *,
    memory: int | None,
    outliers: int,
    values: Mapping[str, Any] | None,
    step: str | None,
    state: str | os.PathLike[str] | None,
) -> Stream:
    """Every epoch of a CSV through a guard, which comes from a state where there is one and is saved there."""
    model = Model.load(file).with_values(**dict(values or {}))
    guard = Guard(model, target, bound, memory=memory, outliers=outliers, step=step)
    if state is not None and Path(state).exists():
        guard = continue_guard(guard, state)
    epochs = list(read_epochs(data, guard.flow.names))
    every = len(epochs) * min(len(epochs) + guard.remembered, memory or 10**9) * len(guard.flow.names) <= MOST_CERTIFIED
    rows = []
    for k, (place, (t, z, sigma)) in enumerate(epochs):
        try:
            estimate = guard.step(z, t, sigma=sigma)
        except NavsymError as error:
            error.where = place if error.kind != "inconsistent" else f"{place}: {error.where}"
            raise
        rows.append(estimate.document(certificate=every or k == len(epochs) - 1))
    if state is not None:
        guard.save(state)
    remarks = [] if every else [f"certificate of the last epoch only: those of all {len(epochs)} would be large"]
    if any("others" in row for row in rows):
        count = sum("others" in row for row in rows)
        remarks.append(
            f"at {count} epochs several sets of gross errors explain the data: their times stand in 'others'"
        )
    return Stream(guard.target, guard.radius_kind, tuple(rows), tuple(remarks))


def continue_guard(fresh: Guard, state: str | os.PathLike[str]) -> Guard:
    """The guard of a state, where it is one of the same question."""
    kept = Guard.load(state)
    for what in ("model", "target", "bound", "length", "outliers", "pace"):
        if getattr(kept, what) != getattr(fresh, what):
            name = {"length": "memory", "pace": "step"}.get(what, what)
            message = f"expected the state of the same question; got one with another {name}; name another file"
            raise DomainError(message, where=name_file(state))
    return kept
