"""The decomposition of a model as plain data, as LaTeX and as an HTML page with MathML."""

from __future__ import annotations

import time
from collections.abc import Mapping
from html import escape
from typing import TYPE_CHECKING, Any

import sympy as sp

from navsym.language.expression import to_text
from navsym.observability.certificates import Certifier, list_nested
from navsym.observability.chains import MeasurementObservability
from navsym.observability.inputs import certify_inputs
from navsym.observability.rank_drops import RankDrop
from navsym.observability.splits import Split
from navsym.observability.two_stage import Stage, StageGains

if TYPE_CHECKING:
    from navsym.observability.answer import Observability


#: Of the rank, whose key is None, and of every drop: its certificate, or why there is none.
Proofs = Mapping[RankDrop | None, Mapping[str, Any] | str]
#: Seconds of processor time after which no further certificate is looked for, and what stands in its place.
SECONDS, NO_TIME = 25, "the time ran out"


def document_of_observability(answer: Observability) -> dict[str, Any]:
    """The answer as JSON data; every expression is text of the language of files."""
    proofs = list_proofs(answer)
    data: dict[str, Any] = {
        "n": len(answer.states),
        "states": list(answer.states),
        "observable": answer.observable,
        "measurements": [measurement_data(m) for m in answer.measurements],
        "joint_dimension": answer.rank,
        "unobservable_basis": text_rows(answer.unobservable_basis),
        "unobservable_directions": list(answer.unobservable),
        "observable_functionals": list(answer.observable_functionals),
        "redundant": list(answer.redundant),
        "proved": answer.joint.proved,
        **proof_data(proofs[None]),
        "model": answer.kind,
        "inputs": list(answer.inputs),
        "instant": instant_data(answer, proofs),
        "pieces": [dict(piece) for piece in answer.pieces],
        "rank_drops": [drop_data(drop, proofs) for drop in answer.rank_drops if drop.lasting],
        "rank_drops_complete": dict(answer.rank_drops_complete),
        "rank_drops_open": {name: list(systems) for name, systems in answer.rank_drops_open.items() if systems},
        "assumptions": [f"{to_text(a)} != 0" for a in answer.joint.assumptions],
        "splits": [{"i": s.i, "j": s.j, "det_L": to_text(s.determinant)} for s in answer.splits],
        "best_split": [answer.best_split.i, answer.best_split.j] if answer.best_split else None,
        "split": split_data(answer.split) if answer.split is not None else None,
        "gains": gains_data(answer.gains),
    }
    data |= {"stages": list(map(stage_data, answer.staged))} if answer.staged else {}
    return data | ({"restore": restoration_data(answer)} if answer.restoration is not None else {})


def list_proofs(answer: Observability) -> Proofs:
    """What the checker grants of the rank, whose key is None, and of every drop, or why it grants nothing."""
    if answer.contents is not None and answer.inputs:
        return {None: certify_inputs(answer.contents, answer.joint) or "no feedback or no derivatives were found"}
    chains = answer.joint.chains
    certifier, end = Certifier.of(chains.model), time.process_time() + SECONDS
    found: dict[RankDrop | None, Mapping[str, Any] | str] = {None: certifier.certify_rank(answer.joint)}
    for drop in list_nested(answer.rank_drops):
        found[drop] = certifier.certify_drop(drop, chains.owners) if time.process_time() < end else NO_TIME
    return found


def proof_data(proof: Mapping[str, Any] | str) -> dict[str, Any]:
    """Whether there is a proof, or why there is none."""
    return {"checked": False, "unchecked": proof} if isinstance(proof, str) else {"checked": True}


def describe_proof(proof: Mapping[str, Any] | str) -> str:
    """The same in words."""
    return f"unchecked: {proof}" if isinstance(proof, str) else "granted by the checker"


def instant_data(answer: Observability, proofs: Proofs) -> dict[str, Any] | None:
    """What is known at one instant, from a measurement and its derivatives there; None for a constant model.

    Over an interval the rank is lost where the parameters are such that a drop lasts; at an instant also in passing.
    """
    if answer.joint.written is None or answer.kind in ("constant", "discrete", "pieces"):
        return None
    passing = [drop_data(drop, proofs) for drop in answer.rank_drops if not drop.lasting]
    return {"rank": answer.rank, "rank_drops": passing, "frozen_rank": answer.frozen_rank}


def restoration_data(answer: Observability) -> dict[str, Any]:
    """The fewest further measurements, and what was asked about."""
    restoration = answer.restoration
    assert restoration is not None
    return {
        "hidden": restoration.unobservable,
        "needed": restoration.needed,
        "fewest": restoration.fewest,
        "sets": [list(names) for names in restoration.sets],
        "proved": restoration.proved,
        "candidates": list(answer.candidates),
    }


def measurement_data(measurement: MeasurementObservability) -> dict[str, Any]:
    """Name, dimension, basis and companion coefficients of one measurement."""
    return {
        "name": measurement.name,
        "dimension": measurement.dimension,
        "basis": text_rows(measurement.basis),
        "companion": [to_text(value) for value in measurement.companion],
    }


def drop_data(drop: RankDrop, proofs: Proofs) -> dict[str, Any]:
    """One rank drop, its condition as one polynomial.

    Over real parameters the squares of several sum to zero exactly where all of them vanish; ``zeros`` lists them.
    ``checked`` says that the checker grants the smaller rank on them, ``unchecked`` why it does not.
    """
    zeros = [to_text(zero) for zero in drop.zeros]
    text = zeros[0] if len(zeros) == 1 else " + ".join(f"({zero})**2" for zero in zeros)
    nonzero = [to_text(factor) for factor in drop.nonzero]
    return {
        "subspace": drop.subspace,
        "condition": " and ".join([f"{text} = 0", *(f"{factor} != 0" for factor in nonzero)]),
        "zeros": zeros,
        "complete": drop.complete,
        "excluded_by_declaration": drop.excluded,
        "rank": drop.rank,
        **proof_data(proofs[drop]),
        "lost_basis": text_rows(drop.directions),
        "inside": [drop_data(inner, proofs) for inner in drop.inside],
        "inside_complete": drop.whole,
    } | ({"nonzero": nonzero} if nonzero else {})


def split_data(chosen: Split) -> dict[str, Any]:
    """The matrices of a split as texts."""
    data = {
        "i": chosen.i,
        "j": chosen.j,
        "form": "two-stage" if chosen.i == chosen.m else "u, v, w",
        "L": text_rows(chosen.L),
        "Theta": text_rows(chosen.Theta),
        "Phi_x": text_rows(chosen.Phi_x),
        "Phi_z": text_rows(chosen.Phi_z),
        "det_L": to_text(chosen.determinant),
    }
    if chosen.tail.rows:
        data["v"] = text_rows(chosen.tail)
    return data


def stage_data(stage: Stage) -> dict[str, Any]:
    """A stage of an estimator as texts."""
    listed = {name: [to_text(x) for x in getattr(stage, name)] for name in ("companion", "drive", "K")}
    return {"measurement": stage.measurement, "L": text_rows(stage.rows), **listed, "stable": stage.stable}


def gains_data(gains: StageGains | None) -> dict[str, Any]:
    """Empty lists when no poles were asked for."""
    if gains is None:
        return {"K_x": [], "K_z": [], "stable": []}
    return {
        "K_x": [to_text(value) for value in gains.K_x],
        "K_z": [to_text(value) for value in gains.K_z],
        "stable": list(gains.stable),
    }


def text_rows(matrix: sp.MatrixBase) -> list[list[str]]:
    """Rows of texts."""
    return [[to_text(matrix[r, c]) for c in range(matrix.cols)] for r in range(matrix.rows)]


#: One formula: a caption, a name in LaTeX, and what it equals.
Formula = tuple[str, str, sp.Basic]


def captioned_formulas(answer: Observability, proofs: Proofs) -> list[Formula]:
    """Captions and equations of the answer, in the order in which they are read."""
    chosen, gains = answer.split, answer.gains
    listed: list[Formula] = []
    for k, measurement in enumerate(answer.measurements, start=1):
        listed.append(
            (
                f"{measurement.name} observes {measurement.dimension} of {len(answer.states)}",
                f"A_{k}",
                measurement.basis,
            )
        )
        listed.append(
            (f"{measurement.name}: companion coefficients", rf"\vartheta^{{({k})}}", row_matrix(measurement.companion))
        )
    if answer.unobservable_basis.rows:
        listed.append(("not observed by any measurement", "N", answer.unobservable_basis))
    for drop in answer.rank_drops:
        text = f"{'proved' if drop.complete else 'perhaps not'} complete; {describe_proof(proofs[drop])}"
        but = f" and {', '.join(map(str, drop.nonzero))} do not" if drop.nonzero else ""
        caption = f"the rank of {drop.subspace} drops where all of these vanish{but} ({text})"
        listed.append((caption, "d", row_matrix(drop.zeros)))
    if chosen is not None:
        listed += [
            (f"split i = {chosen.i}, j = {chosen.j}", "L", chosen.L),
            ("determinant of the split", r"\det L", chosen.determinant),
            ("first stage", r"\Theta", chosen.Theta),
            ("drive of the second stage", r"\Phi_x", chosen.Phi_x),
            ("second stage", r"\Phi_z", chosen.Phi_z),
        ]
    if gains is not None:
        listed.append(("gain of the first stage", "K_x", row_matrix(gains.K_x).T))
        if gains.K_z:
            listed.append(("gain of the second stage", "K_z", row_matrix(gains.K_z).T))
    return [item for item in listed if not (isinstance(item[2], sp.MatrixBase) and 0 in item[2].shape)]


def row_matrix(values: tuple[sp.Expr, ...]) -> sp.ImmutableMatrix:
    """Values as a matrix of one row."""
    return sp.ImmutableMatrix(1, len(values), list(values))


def as_latex(answer: Observability) -> str:
    r"""A document fragment: one ``\[ \]`` display for every formula."""
    lines = [f"% states: {', '.join(answer.states)}"]
    for caption, name, value in captioned_formulas(answer, list_proofs(answer)):
        literal = "".join("\\" + c if c in "_%&#$" else c for c in caption)
        lines += [rf"\paragraph{{{literal}}}", rf"\[ {name} = {sp.latex(value)} \]"]
    return "\n".join(lines) + "\n"


def as_html(answer: Observability, title: str) -> str:
    """A page of its own; formulas as MathML, every text escaped."""
    from sympy.printing.mathml import mathml

    verdict, proofs = "observable" if answer.observable else "not observable", list_proofs(answer)
    parts = [
        "<!DOCTYPE html>",
        '<html lang="en"><head><meta charset="utf-8">',
        f"<title>{escape(title)}</title>",
        "<style>body{font-family:sans-serif;max-width:60em;margin:2em auto}math{font-size:1.1em}</style></head><body>",
        f"<h1>{escape(title)}</h1>",
        f"<p>{len(answer.states)} states ({escape(', '.join(answer.states))}): {verdict}, joint dimension "
        f"{answer.rank} ({escape(describe_proof(proofs[None]))}).</p>",
    ]
    parts += [f"<p>Unobservable direction: {escape(direction)}</p>" for direction in answer.unobservable]
    for caption, _, value in captioned_formulas(answer, proofs):
        parts.append(f"<h2>{escape(caption)}</h2>")
        parts.append(f'<math xmlns="http://www.w3.org/1998/Math/MathML">{mathml(value, printer="presentation")}</math>')
    return "\n".join([*parts, "</body></html>", ""])
