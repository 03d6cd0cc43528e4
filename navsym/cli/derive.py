"""Derive from a model file: F, Phi, H, the observability matrix and the conditions of the contacts."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import navsym as nav
from navsym.cli._settings import values_of
from navsym.cli.output import Told, dumps, write_text
from navsym.core.errors import DomainError


def command(
    file: Path,
    *,
    latex: bool = False,
    set_: list[str] | None = None,
    out: Path | None = None,
    certificate: Path | None = None,
) -> Told:
    """Derive the transition matrix, the regressors and the conditions of optimality from a model.

    Example: navsym derive examples/schuler-velocity.toml
    """
    derivation = nav.derive(file, values=values_of(set_))
    if certificate is not None:
        proofs = derivation.certificates()
        if not proofs:
            message = "expected a system with a transition matrix; got none; give a [model] with F"
            raise DomainError(message, where=str(file))
        write_text(certificate, dumps({"kind": "all", "of": proofs}) + "\n")
    document = derivation.document(latex=latex)
    text = derivation.latex() if latex else as_text(document)
    if out is not None:
        write_text(out, text)
    return Told(document, text)


def as_text(data: dict[str, Any]) -> str:
    """The derivation as a page of text; ``data`` is the document."""
    lines = [f"{data['name']}: {len(data['states'])} unknowns {', '.join(data['states'])}", ""]
    for place, F in enumerate(data["F"]):
        lines += [f"F{piece_name(data, place)}", *aligned(F), ""]
    for place, transition in enumerate(data["transition"]):
        lines += [f"Phi({transition['time']}) = exp(F {transition['time']}){piece_name(data, place)}"]
        lines += [*aligned(transition["matrix"])]
        lines += [
            f"  factor {item['factor']}, multiplicity {item['multiplicity']}: {item['form']}"
            for item in transition["characteristic"]
        ]
        lines.append("")
    for piece in data["regressors"]:
        v = piece["variable"]
        lines.append(f"H({v}) for {piece['from']} <= {v} <= {piece['to']}")
        lines += [f"  {m['name']}: ({', '.join(row)})" for m, row in with_measurements(data, piece["H"])]
        lines.append("")
    if data["observability_matrix"]:
        lines += ["observability matrix", *aligned(data["observability_matrix"]), ""]
    lines += conditions_text(data)
    if data["assumptions"]:
        lines += ["assumed", *(f"  {relation}" for relation in data["assumptions"])]
    return "\n".join(lines).rstrip() + "\n"


def with_measurements(data: dict[str, Any], rows: list[Any]) -> list[tuple[dict[str, str], Any]]:
    """Each measurement beside its row."""
    return list(zip(data["measurements"], rows, strict=True))


def piece_name(data: dict[str, Any], place: int) -> str:
    """The piece that a matrix belongs to, when there are several."""
    if len(data["F"]) == 1:
        return ""
    piece = data["regressors"][place]
    return f", from {piece['from']} to {piece['to']}"


def aligned(rows: list[list[str]]) -> list[str]:
    """A matrix of texts in aligned columns."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  [ " + "  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)) + " ]" for row in rows]


def conditions_text(data: dict[str, Any]) -> list[str]:
    """The conditions of the contacts; the dual polynomials are printed once."""
    if not data["conditions"]:
        return []
    t = data["regressors"][0]["variable"]
    lines = ["conditions of the contacts"]
    first = data["conditions"][0]
    for piece, duals, slopes in zip(data["regressors"], first["dual_polynomial"], first["slope"], strict=True):
        where = f" for {piece['from']} <= {t} <= {piece['to']}" if len(data["regressors"]) > 1 else ""
        for (m, f), slope in zip(with_measurements(data, duals), slopes, strict=True):
            lines += [
                f"  {m['name']}{where}: f({t}) = {f}",
                f"    |f({t})| <= {m['sigma']}, at a contact f = +-{m['sigma']}",
                f"    at a contact inside the interval 0 = {slope}",
            ]
    n = len(data["states"])
    lines.append(f"  at most {n} contacts, weights of the sign of f, sum weight H(contact) = P")
    lines += [
        f"  {c['target']}: P = ({', '.join(c['functional'])}), guaranteed deviation = max {c['value']}"
        for c in data["conditions"]
    ]
    return [*lines, ""]
