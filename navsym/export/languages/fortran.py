"""Fortran 2008: one module of pure subroutines; names up to 63 characters, lines continued at 120."""

from __future__ import annotations

from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.writer import PrintedPiece, short_names, vectors_text, writer_of
from navsym.export.parts import ExportedFunction

WRITER = writer_of("fortran", "double")


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """Module and test program."""
    given = {"functions": functions, "names": short_names(functions), "license": license_}
    widest = max(len(f.inputs) + 3 * f.size for f in functions)
    test = WRITER.render(
        "test_vectors.f90",
        widest=widest,
        most=max(f.size for f in functions),
        longest=max(20000, 26 * widest + 300),
        **given,
    )
    module = WRITER.render("navsym_functions.f90", calls_expm1=False, locals=local_names, **given)
    if "navsym_expm1(" in module:  # the language has no such function
        module = WRITER.render("navsym_functions.f90", calls_expm1=True, locals=local_names, **given)
    return {
        "navsym_functions.f90": continued(module),
        "test_vectors.f90": continued(test),
        "vectors.txt": vectors_text(functions, tests),
    }


def local_names(pieces: Sequence[PrintedPiece]) -> list[str]:
    """The named values of all regimes, each once."""
    return list(dict.fromkeys(name for piece in pieces for name, _ in piece.lets))


def continued(text: str) -> str:
    """The text with long statements over several lines; comments are cut."""
    return "\n".join(part for line in text.split("\n") for part in continued_line(line))


def continued_line(line: str) -> list[str]:
    """A statement as lines that are short enough."""
    if line.lstrip().startswith("!"):
        return [line[:130]]
    parts = []
    while len(line) > 110:
        cut = line.rfind(" ", 40, 110)
        if cut < 0:
            break
        parts.append(line[:cut] + " &")
        line = "      " + line[cut:]
    return [*parts, line]
