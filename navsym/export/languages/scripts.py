"""What the languages have in common that read their vectors as lines of text: Fortran, Julia, Octave and MATLAB.

Their toolchains are often missing; then the manifest says "not executed", never "verified".
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.printing import Spelling
from navsym.export.parts import ExportedFunction


def vectors_text(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]]) -> str:
    """One line a vector: name, status, arguments, lower, upper, nearest; for languages without JSON."""
    lines = []
    for function in functions:
        for v in tests[function.name]:
            tail = [x for part in (v.lower, v.upper, v.nearest) for x in (part or (0.0,) * function.size)]
            numbers = " ".join("NaN" if math.isnan(x) else repr(x) for x in (*v.inputs, *tail))
            lines.append(f"{function.name} {v.status} {numbers}")
    return "\n".join(lines) + "\n"


def branch(function: ExportedFunction, place: int, first: str, later: str, last: str) -> str:
    """The head of the branch of one regime."""
    piece = function.pieces[place]
    if piece.limit is None:
        return last
    condition = f"{function.inputs[function.switch or 0].name} <= {piece.limit!r}"
    return f"{later if place else first} ({condition})"


def domain(function: ExportedFunction, largest: str, s: Spelling, both: str = " && ", true: str = "true") -> str:
    """Comparisons of every argument with its range, in this language."""
    tests = []
    for i in function.inputs:
        low = f"-{largest}" if math.isinf(i.low) else s.number(i.low)
        high = largest if math.isinf(i.high) else s.number(i.high)
        tests.append(f"({i.name} >= {low}){both}({i.name} <= {high})")
    return both.join(tests) or true


def short_names(functions: Sequence[ExportedFunction]) -> dict[str, str]:
    """Names of functions with at most 63 signs, which is what Fortran and MATLAB tell apart."""
    return {f.name: f"nv{k}_{f.name}"[:63] if len(f.name) > 63 else f.name for k, f in enumerate(functions)}
