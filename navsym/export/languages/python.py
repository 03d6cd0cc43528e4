"""Python with NumPy: one module, each function over arrays of one shape (numbers are arrays of none)."""

from __future__ import annotations

import math
from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.printing import Spelling, calls
from navsym.export.languages.writer import Writer, calls_table, vectors_json
from navsym.export.parts import ExportedFunction, Output

SPECIAL = {"abs": "np.abs({0})", "max": "np.maximum({0}, {1})", "min": "np.minimum({0}, {1})"}
SPECIAL |= {"atan2": "np.arctan2({0}, {1})", "pow": "np.power({0}, {1})"}
SPECIAL |= {name: f"np.arc{name[1:]}({{0}})" for name in ("asin", "acos", "atan")}
SPELLING = Spelling(calls(prefix="np.", **SPECIAL), "np.nan", "np.inf")


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """The module, its vectors and the program that runs them."""
    real = functions[0].arithmetic.name
    kind, epsilon = ("float32", "2.0**-23") if real == "float" else ("float64", "2.0**-52")
    w = Writer("python", SPELLING, real, f"np.finfo(np.{kind}).max", entry="{0}[..., {1}]")
    table = calls_table(functions, python=True)
    return {
        "navsym_functions.py": w.render(
            "navsym_functions.py",
            functions=functions,
            license=license_,
            kind=kind,
            checks=lambda f: checks(f, w.largest),
            returned=lambda output, first: returned(output, first, kind),
        ),
        "test_vectors.py": w.render("test_vectors.py", license=license_, epsilon=epsilon, calls=table),
        "vectors.json": vectors_json(functions, tests),
    }


def checks(function: ExportedFunction, largest: str) -> list[str]:
    """Lines that check every argument against its range, one for each; entries of an array have one range or theirs."""
    lines = []
    for a in function.called_with:
        entries = function.inputs[a.first : a.first + (a.size or 1)]
        lows = [repr(i.low) if math.isfinite(i.low) else f"-{largest}" for i in entries]
        highs = [repr(i.high) if math.isfinite(i.high) else largest for i in entries]
        low, high = (ends[0] if len(set(ends)) == 1 else f"np.array([{', '.join(ends)}])" for ends in (lows, highs))
        size = f", {a.size}" if a.size else ""
        lines.append(f'{a.name} = _checked("{a.name}", {a.name}, {low}, {high}{size})')
    return lines


def returned(output: Output, first: int, kind: str) -> str:
    """An output as an array; the entries of one that has several stand on the last axes."""
    places = range(first, first + output.size)
    entries = [f"np.broadcast_to(np.asarray(r{k}, dtype=np.{kind}), shape)" for k in places]
    if not output.shape:
        return f"{entries[0]}[()]"
    stacked = f"np.stack([{', '.join(entries)}], axis=-1)"
    return stacked if len(output.shape) == 1 else f"{stacked}.reshape(*shape, *{output.shape})"
