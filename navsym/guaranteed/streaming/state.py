"""A guard as a JSON file: model, options and measurements exact; the last support as a hint that decides nothing."""

from __future__ import annotations

import json
import os
from collections import Counter
from collections.abc import Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from flint import arb, fmpq

from navsym.core.balls import precision
from navsym.core.errors import DomainError, ExpressionSyntaxError
from navsym.guaranteed.streaming.flow import BITS
from navsym.guaranteed.streaming.memory import MOST_ROWS, Row
from navsym.guaranteed.streaming.numbers import read_exact
from navsym.language.files import name_file, write_text
from navsym.language.jsonfile import check_document, read_json
from navsym.language.names import quote, require_path
from navsym.models.model import Model

if TYPE_CHECKING:
    from navsym.guaranteed.streaming.guard import Guard

FORMAT = "navsym guard 1"
#: Bytes of a state: a full memory of long numbers.
LARGEST = 100_000_000


def write_state(guard: Guard, path: str | os.PathLike[str] | None) -> dict[str, Any]:
    """The plain data of a guard; written whole or not at all where a path is given."""
    memory = guard.memory
    step, own = guard.pattern or (None, [])
    document = {
        "format": FORMAT,
        "model": guard.model.document(),
        "target": guard.target,
        "bound": guard.bound,
        "memory": guard.length,
        "outliers": guard.outliers,
        "step": write_optional(guard.pace),
        "epochs": guard.epochs,
        "reference": write_optional(memory.reference),
        "stride": str(guard.flow.stride),
        "gone": memory.gone,
        "since": write_optional(memory.since),
        "times": [str(t) for t in memory.times[memory.oldest :]],
        "counts": list(memory.counts[memory.oldest :]),
        "rows": [[row.j, str(row.z), write_optional(row.own)] for row in memory.rows[memory.first :]],
        "alike": guard.alike,
        "pattern": [write_optional(step), [[j, write_optional(s)] for j, s in own]],
        "hint": {"basis": [i - memory.first for i in guard.basis], "signs": list(guard.signs)},
    }
    if path is not None:
        write_text(require_path(path, "Guard.save: path"), json.dumps(document, separators=(",", ":")) + "\n")
    return document


def write_optional(q: fmpq | None) -> str | None:
    """A rational number as text; None stays."""
    return None if q is None else str(q)


def read_state(source: str | os.PathLike[str] | Mapping[str, Any]) -> Guard:
    """The guard of a state; every measurement is read and referred again."""
    if isinstance(source, Mapping):
        where, document = "Guard.load", dict(source)
        check_document(document, where)
    elif isinstance(source, str | os.PathLike):
        where, document = name_file(source), read_json(source, limit=LARGEST)
    else:
        message = f"expected a path or the data of Guard.save; got {quote(source)}; name the file"
        raise DomainError(message, where="Guard.load: source")
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        message = f"expected a state with the format {quote(FORMAT)}; got another document; write it with Guard.save"
        raise ExpressionSyntaxError(message, where=where)
    try:
        return fill_guard(document, where)
    except (KeyError, TypeError, ValueError, OverflowError, IndexError, AttributeError, StopIteration) as error:
        got = f"one that cannot be used ({type(error).__name__})"
        message = f"expected a state as Guard.save writes it; got {got}; save it again"
        raise ExpressionSyntaxError(message, where=where) from None


def fill_guard(document: dict[str, Any], where: str) -> Guard:
    """A guard with the epochs of a state; ValueError and its like where the state does not fit."""
    from navsym.guaranteed.streaming.guard import Guard

    guard = Guard(
        Model.from_document(document["model"], f"{where}: model"),
        document["target"],
        document["bound"],
        memory=document["memory"],
        outliers=document["outliers"],
        step=document["step"],
    )
    memory, flow = guard.memory, guard.flow
    times = [read_exact(t, f"{where}: times") for t in document["times"]]
    counts = [need_count(c) for c in document["counts"]]
    if len(times) != len(counts) or sum(counts) != len(document["rows"]) or len(document["rows"]) > MOST_ROWS:
        raise ValueError("counts")
    if any(a >= b for a, b in pairwise(times)):
        raise ValueError("times")
    reference = document["reference"]
    with precision(BITS):
        flow.stride = read_exact(document["stride"], f"{where}: stride")
        memory.reference = None if reference is None else read_exact(reference, f"{where}: reference")
        if flow.stride < 0 or bool(times) != (memory.reference is not None):
            raise ValueError("reference")
        entries = iter(document["rows"])
        rows = [
            read_row(guard, at, next(entries), where)
            for at, count in zip(times, counts, strict=True)
            for _ in range(count)
        ]
        memory.seen = Counter(row.j for row in rows)
        guard.choose_kinds()
        memory.widen()
        memory.fill(times, counts, rows)
    memory.gone, guard.epochs, guard.alike = (need_count(document[k]) for k in ("gone", "epochs", "alike"))
    memory.since = read_optional(document.get("since"), where)
    step, own = document["pattern"]
    guard.pattern = (read_optional(step, where), [(need_count(j), read_optional(s, where)) for j, s in own])
    take_hint(guard, document["hint"])
    return guard


def read_row(guard: Guard, at: fmpq, entry: Any, where: str) -> Row:
    """One measurement."""
    j, z, own = entry
    if need_count(j) >= len(guard.flow.names):
        raise ValueError("measurement")
    bound = read_optional(own, where)
    if bound is not None and not bound > 0:
        raise ValueError("sigma")
    sigma, text = guard.flow.sigma(j, at) if bound is None else (arb(bound), str(bound))
    return Row(at, j, read_exact(z, f"{where}: rows"), sigma, text, bound)


def take_hint(guard: Guard, hint: Any) -> None:
    """The last support, where the search begins."""
    basis = [i if i in range(-MOST_ROWS, 0) else need_count(i) for i in hint["basis"]]  # rows may have left the memory
    signs = [int(s) for s in hint["signs"]]
    fits = len(basis) in (0, guard.flow.size) and len(set(basis)) == len(basis)
    if not fits or any(i >= len(guard.memory) for i in basis) or not set(signs) <= {1, -1}:
        raise ValueError("hint")
    guard.basis, guard.signs = basis, signs if len(signs) == len(basis) else []


def read_optional(value: Any, where: str) -> fmpq | None:
    """A rational number or None."""
    return None if value is None else read_exact(value, where)


def need_count(value: Any) -> int:
    """A whole number that is not negative."""
    if type(value) is not int or value < 0:
        raise ValueError("count")
    return value
