"""Octave and MATLAB: one file for each function, which returns its status and the results.

Only numbers of type double enter: integers and singles would round on the way, complex numbers compare by magnitude, a
matrix is no row of entries. Roots, logarithms and powers that are not real are NaN here, as in every other language.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.writer import short_names, vectors_text, writer_of
from navsym.export.parts import Argument, ExportedFunction, Output

#: Functions that leave the real numbers where those of C give NaN: the condition under which they stay real.
REAL = {
    "sqrt": ("x", "x >= 0", "sqrt(x)"),
    "log": ("x", "x >= 0", "log(x)"),
    "asin": ("x", "abs(x) <= 1", "asin(x)"),
    "acos": ("x", "abs(x) <= 1", "acos(x)"),
    "pow": ("x, y", "x >= 0 || y == fix(y)", "x ^ y"),
}
WRITER = writer_of("octave", "double")


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """One file for each function, each helper, each call of a program, and the test."""
    names = short_names(functions)

    def text(template: str, **values: Any) -> str:
        return WRITER.render(template, names=names, license=license_, results=results_text, **values)

    words = {one.__name__: one for one in (counted_from_one, shape_text, rows_and_columns, in_range, entries_text)}
    found = {f"{names[f.name]}.m": text("function.m", f=f, name=names[f.name], **words) for f in functions}
    found |= {f"navsym_{h.name}.m": text("helper.m", h=h) for h in WRITER.helpers(functions)}
    for f in functions:
        if f.state:
            found |= {f"{f.state.program}_{part}.m": text(f"program_{part}.m", f=f) for part in ("init", "step")}
    code = "\n".join(found.values())
    for name, (given, condition, value) in REAL.items():
        if f"navsym_{name}(" in code:
            found[f"navsym_{name}.m"] = text("real.m", name=name, given=given, condition=condition, value=value)
    return found | {
        "navsym_numbers.m": text("navsym_numbers.m"),
        "test_vectors.m": text("test_vectors.m", functions=functions),
        "vectors.txt": vectors_text(functions, tests),
    }


def counted_from_one(line: str) -> str:
    """A formula of an entry with its place as the language counts it."""
    return re.sub(r"^(Formula  \w+)\[(\d+)\] =", lambda found: f"{found[1]}({int(found[2]) + 1}) =", line)


def in_range(function: ExportedFunction, argument: Argument) -> str:
    """The test of one argument; entries of an array have one range or their own."""
    entries = WRITER.ends(function)[argument.first : argument.first + (argument.size or 1)]
    _, *ends = zip(*entries, strict=True)
    low, high = (column[0] if len(set(column)) == 1 else f"[{' '.join(column)}]" for column in ends)
    return f"navsym_numbers({argument.name}, {argument.size or 1}, {low}, {high})"


def results_text(function: ExportedFunction) -> str:
    """The results of a call: status first."""
    return f"[{', '.join(['status', *(o.name for o in function.outputs)])}]"


def rows_and_columns(output: Output) -> tuple[int, int]:
    """A number, a column or a matrix."""
    rows, columns = (*output.shape, 1, 1)[:2] if output.shape else (1, 1)
    return rows, columns


def shape_text(output: Output) -> str:
    """What a caller gets, in words."""
    rows, columns = rows_and_columns(output)
    return "a number" if not output.shape else f"a column of {rows}" if columns == 1 else f"{rows} by {columns}"


def entries_text(output: Output, first: int) -> str:
    """An output made of its entries, row by row."""
    rows, columns = rows_and_columns(output)
    made = [", ".join(f"r{first + i * columns + j}" for j in range(columns)) for i in range(rows)]
    return f"[{'; '.join(made)}]" if output.shape else made[0]
