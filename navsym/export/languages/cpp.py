"""C++17: one header-only file; results come back in a structure with their status."""

from __future__ import annotations

from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.c import safe_comment
from navsym.export.languages.printing import Spelling, calls
from navsym.export.languages.writer import Writer
from navsym.export.parts import ExportedFunction


def spelling(real: str) -> Spelling:
    """std:: functions are overloaded for float; literals carry the suffix."""
    table = calls(prefix="std::") | {"abs": "std::fabs({0})"}
    nan, inf = (f"static_cast<{real}>({word})" for word in ("NAN", "INFINITY"))
    return Spelling(table, nan, inf, "f" if real == "float" else "")


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """The header, the test program with its vectors, and the build file."""
    real = functions[0].arithmetic.name
    w = Writer("cpp", spelling(real), real, f"std::numeric_limits<{real}>::max()")
    columns = [(f, w.columns(f, tests[f.name], spelling("double"))) for f in functions]
    epsilon = repr(2.0**-52 if real == "double" else 2.0**-23)
    return {
        "navsym_functions.hpp": w.render(
            "navsym_functions.hpp", functions=functions, license=license_, safe=safe_comment
        ),
        "test_main.cpp": w.render("test_main.cpp", vectors=columns, license=license_, epsilon=epsilon),
        "CMakeLists.txt": w.render("CMakeLists.txt", license=license_),
    }
