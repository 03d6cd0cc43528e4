"""The decomposition as LaTeX and as an HTML page with MathML."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import sympy as sp

from navsym.core.errors import ShapeError
from navsym.language.expression import to_text
from navsym.models.linear import LinearModel
from navsym.observability.chains import (
    MeasurementObservability,
    Observability,
    direction_names,
    need_observable,
    observe,
)
from navsym.observability.rank_drops import RankDrop, drops_and_completeness
from navsym.observability.splits import FeasibleSplit, Split, best_split, split, splits
from navsym.observability.two_stage.gains import POLE, StageGains, gains_by_poles, stage_gains

# The whole answer about one model as plain data: what ``navsym observe`` prints.


@dataclass(frozen=True, slots=True, eq=False)
class Examination:
    """Everything about one model.

    drops_complete : subspace -> whether its list of drops is proved to hold all of them
    splits, best, chosen are None when there are not two measurements or the pair is unobservable;
    gains is None unless poles were asked for.
    """

    found: Observability
    drops: tuple[RankDrop, ...]
    drops_complete: dict[str, bool]
    splits: tuple[FeasibleSplit, ...]
    best: FeasibleSplit | None
    chosen: Split | None
    gains: StageGains | None


def examine(
    model: LinearModel,
    request: tuple[int, int] | None = None,
    poles: Sequence[sp.Expr] = (),
    variable: sp.Symbol = POLE,
) -> Examination:
    """Observability, rank drops, splits, and gains when poles are given.

    request : (i, j), by default the two-stage split (m, n - m)
    poles   : one characteristic polynomial per stage, in ``variable``

    Raises UnobservableError when a split or poles are asked for and the pair is not observable,
    ShapeError and DomainError as the functions that do the parts.
    """
    found = observe(model)
    if request is not None or poles:
        need_observable(found)
    two = len(found.measurements) == 2 and found.observable
    if request is not None and not two:
        raise ShapeError(f"split: expected two measurements; got {len(found.measurements)}; choose two of them")
    chosen = split(found, *(request or ())) if two else None
    drops, complete = drops_and_completeness(found)
    return Examination(
        found=found,
        drops=drops,
        drops_complete=complete,
        splits=splits(found) if two else (),
        best=best_split(found) if two else None,
        chosen=chosen,
        gains=gains_for(found, chosen, poles, variable) if poles else None,
    )


def gains_for(found: Observability, chosen: Split | None, poles: Sequence[sp.Expr], variable: sp.Symbol) -> StageGains:
    """Gains of one stage for one measurement, of two stages for two."""
    if chosen is not None:
        if len(poles) > 2:
            raise ShapeError(f"poles: expected at most two polynomials; got {len(poles)}; one per stage")
        return gains_by_poles(chosen, poles[0], poles[1] if len(poles) == 2 else None, variable)
    if len(found.measurements) != 1 or len(poles) != 1:
        raise ShapeError(
            "poles: expected one polynomial for one measurement or two for two; "
            f"got {len(poles)} for {len(found.measurements)}; change the file or --poles"
        )
    K_x, stable = stage_gains(found.measurements[0].companion, poles[0], "first", variable)
    return StageGains(K_x, (), (stable, True))


def document(examination: Examination) -> dict[str, Any]:
    """The examination as JSON data; every expression is text of the language of files."""
    found, chosen = examination.found, examination.chosen
    data: dict[str, Any] = {
        "n": len(found.states),
        "states": list(found.states),
        "observable": found.observable,
        "measurements": [measurement_data(m) for m in found.measurements],
        "joint_dimension": found.joint_dimension,
        "unobservable_basis": table(found.unobservable),
        "unobservable_directions": [
            direction_names(found.unobservable[k, :], found.states) for k in range(found.unobservable.rows)
        ],
        "rank_drops": [drop_data(drop) for drop in examination.drops],
        "rank_drops_complete": examination.drops_complete,
        "assumptions": [f"{to_text(a)} != 0" for a in found.assumptions],
        "splits": [{"i": s.i, "j": s.j, "det_L": to_text(s.determinant)} for s in examination.splits],
        "best_split": [examination.best.i, examination.best.j] if examination.best else None,
        "split": split_data(chosen) if chosen is not None else None,
        "gains": gains_data(examination.gains),
    }
    return data


def measurement_data(measurement: MeasurementObservability) -> dict[str, Any]:
    """Name, dimension, basis and companion coefficients of one measurement."""
    return {
        "name": measurement.name,
        "dimension": measurement.dimension,
        "basis": table(measurement.basis),
        "companion": [to_text(value) for value in measurement.companion],
    }


def drop_data(drop: RankDrop) -> dict[str, Any]:
    """One rank drop. The condition is one polynomial: over real parameters the squares of several sum to zero
    exactly where all of them vanish; ``zeros`` lists them one by one.
    """
    zeros = [to_text(zero) for zero in drop.zeros]
    text = zeros[0] if len(zeros) == 1 else " + ".join(f"({zero})**2" for zero in zeros)
    return {
        "subspace": drop.subspace,
        "condition": f"{text} = 0",
        "zeros": zeros,
        "complete": drop.complete,
        "excluded_by_declaration": drop.allowed is False,
    }


def split_data(chosen: Split) -> dict[str, Any]:
    """The matrices of a split as texts."""
    data = {
        "i": chosen.i,
        "j": chosen.j,
        "form": "two-stage" if chosen.i == chosen.m else "u, v, w",
        "L": table(chosen.L),
        "Theta": table(chosen.Theta),
        "Phi_x": table(chosen.Phi_x),
        "Phi_z": table(chosen.Phi_z),
        "det_L": to_text(chosen.determinant),
    }
    if chosen.tail.rows:
        data["v"] = table(chosen.tail)
    return data


def gains_data(gains: StageGains | None) -> dict[str, Any]:
    """Empty lists when no poles were asked for."""
    if gains is None:
        return {"K_x": [], "K_z": [], "stable": []}
    return {
        "K_x": [to_text(value) for value in gains.K_x],
        "K_z": [to_text(value) for value in gains.K_z],
        "stable": list(gains.stable),
    }


def table(matrix: sp.MatrixBase) -> list[list[str]]:
    """Rows of texts."""
    return [[to_text(matrix[r, c]) for c in range(matrix.cols)] for r in range(matrix.rows)]


#: One formula: a caption, a name in LaTeX, and what it equals.
Formula = tuple[str, str, sp.Basic]


def formulas(examination: Examination) -> list[Formula]:
    """Captions and equations of an examination, in the order in which they are read."""
    found, chosen, gains = examination.found, examination.chosen, examination.gains
    listed: list[Formula] = []
    for k, measurement in enumerate(found.measurements, start=1):
        listed.append(
            (f"{measurement.name} observes {measurement.dimension} of {len(found.states)}", f"A_{k}", measurement.basis)
        )
        listed.append(
            (f"{measurement.name}: companion coefficients", rf"\vartheta^{{({k})}}", row(measurement.companion))
        )
    if found.unobservable.rows:
        listed.append(("not observed by any measurement", "N", found.unobservable))
    for drop in examination.drops:
        text = "proved complete" if drop.complete else "perhaps not complete"
        listed.append((f"the rank of {drop.subspace} drops where all of these vanish ({text})", "d", row(drop.zeros)))
    if chosen is not None:
        listed += [
            (f"split i = {chosen.i}, j = {chosen.j}", "L", chosen.L),
            ("determinant of the split", r"\det L", chosen.determinant),
            ("first stage", r"\Theta", chosen.Theta),
            ("drive of the second stage", r"\Phi_x", chosen.Phi_x),
            ("second stage", r"\Phi_z", chosen.Phi_z),
        ]
    if gains is not None:
        listed.append(("gain of the first stage", "K_x", row(gains.K_x).T))
        if gains.K_z:
            listed.append(("gain of the second stage", "K_z", row(gains.K_z).T))
    return [item for item in listed if not (isinstance(item[2], sp.MatrixBase) and 0 in item[2].shape)]


def row(values: tuple[sp.Expr, ...]) -> sp.ImmutableMatrix:
    """Values as a matrix of one row."""
    return sp.ImmutableMatrix(1, len(values), list(values))


def as_latex(examination: Examination) -> str:
    r"""A document fragment: one ``\[ \]`` display for every formula."""
    lines = [f"% states: {', '.join(examination.found.states)}"]
    for caption, name, value in formulas(examination):
        lines += [rf"\paragraph{{{plain(caption)}}}", rf"\[ {name} = {sp.latex(value)} \]"]
    return "\n".join(lines) + "\n"


def plain(text: str) -> str:
    """Text that LaTeX takes literally."""
    return "".join("\\" + c if c in "_%&#$" else c for c in text)


def as_html(examination: Examination, title: str) -> str:
    """A page of its own; formulas as MathML, every text escaped."""
    from sympy.printing.mathml import mathml

    found = examination.found
    verdict = "observable" if found.observable else "not observable"
    parts = [
        "<!DOCTYPE html>",
        '<html lang="en"><head><meta charset="utf-8">',
        f"<title>{escape(title)}</title>",
        "<style>body{font-family:sans-serif;max-width:60em;margin:2em auto}math{font-size:1.1em}</style></head><body>",
        f"<h1>{escape(title)}</h1>",
        f"<p>{len(found.states)} states ({escape(', '.join(found.states))}): {verdict}, joint dimension "
        f"{found.joint_dimension}.</p>",
    ]
    for k in range(found.unobservable.rows):
        parts.append(f"<p>Hidden direction: {escape(direction_names(found.unobservable[k, :], found.states))}</p>")
    for caption, _, value in formulas(examination):
        parts.append(f"<h2>{escape(caption)}</h2>")
        parts.append(f'<math xmlns="http://www.w3.org/1998/Math/MathML">{mathml(value, printer="presentation")}</math>')
    return "\n".join([*parts, "</body></html>", ""])
