"""Julia: one module; every function returns its status and the results."""

from __future__ import annotations

from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.printing import Spelling, calls
from navsym.export.languages.writer import Writer, vectors_text
from navsym.export.parts import ExportedFunction

SPELLING = Spelling(
    calls(abs="abs({0})", atan2="atan({0}, {1})", pow="({0})^({1})", max="max({0}, {1})", min="min({0}, {1})"),
    "NaN",
    "Inf",
)
WRITER = Writer("julia", SPELLING, "double", "floatmax(Float64)", arrays=False)


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """Module and test script."""
    return {
        "NavsymFunctions.jl": WRITER.render("NavsymFunctions.jl", functions=functions, license=license_),
        "test_vectors.jl": WRITER.render("test_vectors.jl", license=license_),
        "vectors.txt": vectors_text(functions, tests),
    }
