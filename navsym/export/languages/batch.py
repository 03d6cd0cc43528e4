"""Batches: C over many points at once, vectorised by the compiler, called from NumPy through ctypes.

One loop for each call of the library, one for the arithmetic between them and one for each result, over blocks that
stay in the cache, so that the compiler finds vectors in all of them. Large results go past the cache, which they would
only push other numbers out of, and memory of a result that nobody holds any more is used again. The C library's vector
forms of sin, cos, exp, log and pow are taken as accurate to 4 ulp; the bounds in the vectors allow for that.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.c import source, writer
from navsym.export.languages.printing import Spelling, assignments
from navsym.export.languages.writer import vectors_json
from navsym.export.parts import ExportedFunction

BLOCK = 512
CACHE = 4e6  # bytes
LIBRARY = frozenset([*"sin cos exp log pow expm1 asin acos atan atan2 sinh cosh tanh filled".split()])


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """The C of all functions, the module that compiles and calls it, vectors and test."""
    functions = [f for f in functions if f.inputs]
    w = writer(functions[0].arithmetic.name if functions else "double")
    given = {"functions": functions, "license": license_}
    code = w.render(
        "batch/navsym_batch.c",
        block=BLOCK,
        cache=CACHE,
        plain=plain_function,
        loops_in=lambda f: loops_in(f, w.spelling),
        **given,
    )
    kind = "float32" if w.real == "float" else "float64"
    return {
        "navsym_batch.c": code,
        "navsym_batch.py": w.render("batch/navsym_batch.py", kind=kind, rows_in=rows_in, **given),
        "vectors.json": vectors_json(functions, tests),
        "test_vectors.py": w.render("batch/test_vectors.py", license=license_, many=3 * BLOCK - 7),
    }


def rows_in(function: ExportedFunction) -> str:
    """What the rows of points are."""
    return ", ".join(i.symbol.name for i in function.inputs).replace("\\", "/").replace('"', "'")


@dataclass(frozen=True, slots=True)
class Loops:
    """The loops over a block: arrays, assignments that share a loop, and each result with the array that holds it.

    A result that is no array yet is computed into ``w``.
    """

    names: list[str]
    groups: list[list[tuple[str, str]]]
    results: list[tuple[str, str]]


def loops_in(function: ExportedFunction, s: Spelling) -> Loops:
    """Consecutive arithmetic in one loop; every call of the library in a loop of its own."""
    entries = [f"in[({k} * n) + b + k]" for k in range(len(function.inputs))]
    temporaries, results = assignments(function.pieces[0], entries, s, LIBRARY)
    names = [name for name, _, _ in temporaries]
    groups: list[list[tuple[str, str]]] = []
    before = True  # a call of the library, or nothing
    for name, text, called in temporaries:
        if called or before:
            groups.append([])
        groups[-1].append((name, in_arrays(text, names)))
        before = called
    ready = [(text, in_arrays(text, names)) for text in results]
    return Loops(names, groups, [(text if text in names else "w", written) for text, written in ready])


def in_arrays(text: str, names: Sequence[str]) -> str:
    """The text with every temporary as an entry of its array."""
    return re.sub(r"\w+", lambda word: f"{word[0]}[k]" if word[0] in names else word[0], text)


def plain_function(function: ExportedFunction) -> str:
    """The function at one point, for regimes: they go point by point."""
    head = f"navsym_status {function.name}("
    text = source(function, "")
    return text[text.index(head) :].replace(head, f"static int {function.name}_at(", 1)
