"""The decomposition as LaTeX and as an HTML page with MathML."""

from __future__ import annotations

from html import escape

import sympy as sp

from navsym.methods.observability.chains import direction_names
from navsym.methods.observability.document import Examination

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
