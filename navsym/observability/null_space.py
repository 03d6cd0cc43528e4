"""Whether the Jacobians of an implementation keep the directions that the model never shows.

A filter linearises where its estimates are: with ``H_k`` at step k and ``Phi_k`` from there to the next step, it sees a
direction N of its first state through ``H_k Phi_(k-1) ... Phi_0 N``. Where that differs from zero the filter gains
information about what no measurement shows (Huang, Mourikis and Roumeliotis 2010). First estimates keep it at zero.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any

import sympy as sp

from navsym.claims.verdict import OPEN, PROVED, REFUTED, Status, Verdict
from navsym.core.answers import Answer
from navsym.core.errors import ShapeError, UnknownSymbolError, UnobservableError
from navsym.language.expression import parse, symbol, to_text
from navsym.language.files import name_file
from navsym.language.names import join_place, quote, suggest_nearest
from navsym.language.schema import as_list, as_table, expect_keys, require_key
from navsym.language.tomlfile import read_toml
from navsym.language.values import write_entries, write_value
from navsym.prove.formulas import prove, symbols_in


@dataclass(frozen=True, slots=True, eq=False)
class KeptDirection:
    """One direction of the first state.

    name    : by its components at the first linearisation
    status  : PROVED where all listed steps are blind to it, REFUTED where one is not, else OPEN
    step    : the first step, from 1, that sees it, or at which nothing was decided; None where all are blind
    verdicts : of the steps that were asked
    """

    name: str
    status: Status
    step: int | None
    verdicts: tuple[Verdict, ...]

    def document(self) -> dict[str, Any]:
        """The direction as plain data, with the point at which a step sees it."""
        point = next((v.counterexample for v in self.verdicts if v.status == REFUTED), None)
        found = dict(point) if point is not None else None
        return {"direction": self.name, "status": self.status.value, "step": self.step, "counterexample": found}


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class NullSpace(Answer):
    """The directions that a model never shows, in the Jacobians of an implementation."""

    directions: tuple[KeptDirection, ...]

    @property
    def holds(self) -> bool:
        """True when all directions are proved to be kept at the listed steps."""
        return all(direction.status == PROVED for direction in self.directions)

    def document(self) -> dict[str, Any]:
        """The key ``null_space`` of the document of ``navsym observe``."""
        return {"directions": [direction.document() for direction in self.directions]}

    def certificates(self) -> list[Mapping[str, Any]]:
        """One for each step and direction that was decided."""
        return [v.certificate for d in self.directions for v in d.verdicts if v.certificate is not None]

    def __repr__(self) -> str:
        words = (f"{d.name} {d.status.value}{f' at step {d.step}' if d.step else ''}" for d in self.directions)
        return f"NullSpace({'; '.join(words)})"


def follow_directions(
    directions: Mapping[str, Sequence[sp.Expr]],
    H: Sequence[Any],
    Phi: Sequence[Any],
    first: Mapping[sp.Symbol, sp.Expr],
    symbols: Mapping[str, Any],
) -> NullSpace:
    """The directions through all steps, each product a statement of its own for the prover.

    directions : name -> n components;  H, Phi : p rows of n entries, and n rows, for each step
    first      : state -> point at which the first step is linearised
    """
    where = "null_space"
    if not directions:
        message = "expected a model with directions that are not shown; got none; every state is observed"
        raise UnobservableError(message, where=where)
    measured = [write_entries(rows, f"{where}: H") for rows in H]
    moved = [write_entries(rows, f"{where}: Phi") for rows in Phi]
    n = len(next(iter(directions.values())))
    if not measured or len(moved) < len(measured) - 1:
        message = f"expected H of each step and Phi between two; got {len(measured)} and {len(moved)}; complete them"
        raise ShapeError(message, where=where)
    for name, listed in (("H", measured), ("Phi", moved)):
        for rows in listed:
            if not isinstance(rows, list) or not all(isinstance(row, list) and len(row) == n for row in rows):
                raise ShapeError(f"expected rows of {n} entries; got others; correct them", where=f"{where}: {name}")
    columns = {name: [to_text(e.subs(first, simultaneous=True)) for e in d] for name, d in directions.items()}
    return NullSpace(tuple(follow(name, column, measured, moved, symbols) for name, column in columns.items()))


def read_points(first: Mapping[str, Any], states: Sequence[str]) -> dict[sp.Symbol, sp.Expr]:
    """State -> formula. Raises UnknownSymbolError for a name that is no state."""
    found = {}
    for name, value in first.items():
        if name not in states:
            remedy = suggest_nearest(str(name), states)
            raise UnknownSymbolError(f"expected a state; got {quote(str(name))}; {remedy}", where="null_space: first")
        text = write_value(value, f"null_space: first.{name}")
        found[symbol(name)] = parse(text, {s: symbol(s) for s in symbols_in([text], {})}, where=f"first: {name}")
    return found


def follow(
    name: str, column: Sequence[str], H: Sequence[list[list[str]]], Phi: Sequence[list[list[str]]], symbols: Any
) -> KeptDirection:
    """One direction, as far as the first step that is not proved to be blind to it."""
    product, verdicts = f"[{', '.join(column)}]", list[Verdict]()
    for k, rows in enumerate(H):
        text = f"{write_matrix(rows)} @ ({product}) = {'0' if len(rows) == 1 else [0] * len(rows)}"
        known = symbols_in([text], symbols)
        verdicts.append(prove(text, **{s: meaning for s, meaning in symbols.items() if s in known}))
        if verdicts[-1].status != PROVED:
            status = REFUTED if verdicts[-1].status == REFUTED else OPEN
            return KeptDirection(name, status, k + 1, tuple(verdicts))
        product = f"{write_matrix(Phi[k])} @ ({product})" if k < len(Phi) else product
    return KeptDirection(name, PROVED, None, tuple(verdicts))


def write_matrix(rows: Sequence[Sequence[str]]) -> str:
    """Rows as text of the language."""
    return "[" + ", ".join(f"[{', '.join(row)}]" for row in rows) + "]"


def read_jacobians(path: str | PathLike[str]) -> dict[str, Any]:
    """The arguments of ``Observability.null_space`` in a TOML file: [symbols], [first], and [[step]] with H and Phi."""
    document, where = read_toml(path), name_file(path)
    expect_keys(document, ("symbols", "first", "step"), where)
    blocks = as_list(require_key(document, "step", where), join_place(where, "step"))
    steps = [as_table(step, join_place(where, f"step[{k}]")) for k, step in enumerate(blocks)]
    for k, step in enumerate(steps):
        place = join_place(where, f"step[{k}]")
        expect_keys(step, ("H", "Phi"), place)
        for key in ("H", "Phi")[: 2 if k + 1 < len(steps) else 1]:  # nothing follows the last step
            require_key(step, key, place)
    return {
        "H": [step["H"] for step in steps],
        "Phi": [step["Phi"] for step in steps if "Phi" in step],
        **{key: dict(as_table(document.get(key, {}), join_place(where, key))) for key in ("first", "symbols")},
    }
