"""Read the formulas of a LaTeX, reStructuredText or Markdown document, with declared symbols only."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli.output import Told, remark, write_text

if TYPE_CHECKING:
    from navsym.language.latex.reading import ReadFormula, Reading


def command(
    file: str, *, symbols: Path | None = None, out: Path | None = None, definitions: bool = False, declare: bool = False
) -> Told:
    """Read the formulas of a document. Status 1 when one of them is refused.

    Example: navsym read examples/double-angle.md --symbols examples/double-angle.toml
    """
    reading = nav.read(
        sys.stdin.buffer.read(4_000_001).decode("utf-8", "replace") if file == "-" else Path(file), symbols=symbols
    )
    if out is not None:
        text = reading.claims(definitions=definitions)
        write_text(out, text)
        remark(f"{text.count('[[claim]]')} claims in {out}")
    document = reading.document() | ({"declarations": reading.declarations()} if declare else {})
    status = 0 if len(reading.read) == len(reading.formulas) else 1
    return Told(document, reading.declarations if declare else lambda: as_text(reading), status)


def as_text(reading: Reading) -> str:
    """Each formula with its reading, or with a caret below the trouble."""
    rows = reading.text.split("\n")
    blocks = [line for formula in reading.formulas for line in show_formula(formula, rows)]
    count = f"{len(reading.read)} of {len(reading.formulas)} formulas read"
    missing = f"undeclared: {', '.join(reading.undeclared)}" if reading.undeclared else ""
    return "\n".join([*blocks, count, *filter(None, [missing])])


def show_formula(formula: ReadFormula, rows: list[str]) -> list[str]:
    """The lines of one formula."""
    place = f"{formula.file}:{formula.line}:{formula.column}".lstrip(":")
    if formula.trouble is None:
        return [f"{place}  READ", f"  {formula.source}", f"  {formula.text}", ""]
    line, column = formula.trouble
    row = rows[line - 1] if line <= len(rows) else ""
    start = max(0, column - 60)
    shown = row[start : start + 100].replace("\t", " ")
    return [f"{place}  REFUSED", f"  {shown}", "  " + " " * (column - 1 - start) + "^", f"  {formula.why}", ""]
