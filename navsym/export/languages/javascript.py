"""JavaScript (ECMAScript module): every function returns ``{status, …results}``."""

from __future__ import annotations

from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.printing import Spelling, calls, result_fields
from navsym.export.languages.writer import Writer, calls_table, vectors_json
from navsym.export.parts import ExportedFunction

SPECIAL = {"abs": "Math.abs({0})", "max": "Math.max({0}, {1})", "min": "Math.min({0}, {1})"}
SPELLING = Spelling(calls(prefix="Math.", **SPECIAL), "NaN", "Infinity")
WRITER = Writer("javascript", SPELLING, "double", "Number.MAX_VALUE")


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """The module, its vectors and the program that runs them."""
    module = WRITER.render("navsym_functions.mjs", functions=functions, license=license_, results=result_fields)
    return {
        "navsym_functions.mjs": module,
        "test_vectors.mjs": WRITER.render("test_vectors.mjs", calls=calls_table(functions), license=license_),
        "vectors.json": vectors_json(functions, tests),
    }
