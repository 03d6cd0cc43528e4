"""Languages of one module and one test program, filled in from a table of their words (``spellings.toml``).

Vectors stand in a file of their own, or in the test program where the table names none.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.c import safe_comment
from navsym.export.languages.printing import result_fields
from navsym.export.languages.writer import calls_table, read_words, vectors_json, vectors_text, writer_of
from navsym.export.parts import ExportedFunction, Output

VECTORS = {"vectors.json": vectors_json, "vectors.txt": vectors_text}


def files(
    language: str, functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str
) -> dict[str, str]:
    """The module, the program that runs its vectors, and the vectors."""
    real = functions[0].arithmetic.name
    words, w, wide = read_words(language, real), writer_of(language, real), writer_of(language, "double").spelling
    given: dict[str, Any] = {"functions": functions, "license": license_, "results": result_fields}
    given |= {"kind": words["kind"], "epsilon": words.get("epsilon"), "safe": safe_comment}
    given["calls"] = calls_table(functions, python=language == "python")
    given["checks"] = lambda f: checks(f, w.largest)
    given["returned"] = lambda output, first: returned(output, first, words["kind"])
    if "vectors" not in words:
        given["vectors"] = [(f, w.columns(f, tests[f.name], wide)) for f in functions]
    found = {name: w.render(name, **given) for name in words["files"]}
    return found | ({words["vectors"]: VECTORS[words["vectors"]](functions, tests)} if "vectors" in words else {})


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
