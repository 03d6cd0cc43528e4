"""Add a claim to a derivation module: both sides as formulas, decided at once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import navsym as nav
from navsym.cli._settings import values_of
from navsym.cli.diff import read_ranges
from navsym.cli.output import Told
from navsym.language.tomlfile import parse_toml


def command(
    module: str,
    number: str,
    *,
    printed: str = "",
    derived: str = "",
    formula: str = "",
    relation: str = "=",
    ranges: list[str] | None = None,
    declare: list[str] | None = None,
    given: list[str] | None = None,
    title: str = "",
    positive: str = "",
    tolerance: str | None = None,
    corrects: str = "",
    reason: str = "",
    slip: str = "paper",
    folder: Path | None = None,
) -> Told:
    """Decide printed = derived, or a formula, and append the claim to its module, with the verdict.

    Example: navsym new-claim schuler_pendulum 1 --printed "2*pi*sqrt(R/g)" --derived "2*pi/sqrt(g/R)" --positive R,g

    Example: navsym new-claim schuler_pendulum 2 --formula "sin(a) <= a" --range a=0,pi
    """
    claim = nav.new_claim(
        module,
        number,
        printed=printed,
        derived=derived,
        formula=formula,
        relation=relation,
        given=given or [],
        symbols=read_ranges(ranges) | read_words(declare or []),
        title=title,
        positive=positive,
        tolerance=tolerance,
        corrects=corrects,
        reason=reason,
        slip=slip,
        folder=folder,
    )
    is_numeral = tolerance is None and printed.strip("+-").replace(".", "", 1).isdigit()
    return Told(claim.document, lambda: as_text(claim.document(), number, is_numeral))


def read_words(settings: list[str]) -> dict[str, Any]:
    """Declarations ``NAME=WORD`` or ``NAME=`` and a value of TOML."""
    words = values_of(settings, "--declare", "NAME=WORD or NAME={ TABLE }", "u={ vector = 3 }", "expected {} once")
    tables = {name: text for name, text in words.items() if text.startswith(("[", "{", '"'))}
    return words | {name: parse_toml(f"x = {text}", "--declare")["x"] for name, text in tables.items()}


def as_text(document: dict[str, Any], number: str, is_numeral: bool) -> str:
    """The verdict, the file, and the next step."""
    lines = [f"{document['id']}  {document['status']}  {document['evidence']}", document["path"]]
    module = document["id"].partition(":")[0]
    if document["equation"] is None:
        lines.append(f"note: {number} is none of the numbered equations of {module}; it counts as a remark")
    if document["status"] == "REFUTED":
        command = f"navsym new-claim {module} '{number}*' --corrects {number} --printed … --derived …"
        lines.append(f"next: its correction, {command}")
        if is_numeral:
            lines.append("a rounded numeral needs --tolerance: take the claim out of the file and add it with one")
    return "\n".join(lines)
