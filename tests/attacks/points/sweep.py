"""Many points: every output of compiled code inside the ball enclosure of its formula, widened by the derived bound.

The enclosures come from the fast twin (:mod:`tests.attacks.points.twin`); what it does not decide is decided in
balls. The code is the C of the export, compiled with the flags of its own test program and called on rows of numbers.
What is believed: that compiler and the C library, IEEE arithmetic of NumPy, the theorems named in
:mod:`tests.attacks.points.bands`, flint's balls, and the stated accuracy of the library's functions.
"""

from __future__ import annotations

import ctypes
import itertools
import random
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from navsym.core.errors import MissingEngineError
from navsym.export.accuracy.rounding import Arithmetic
from navsym.export.accuracy.vectors import LARGEST, cast, edge_values, piece_at, points, sample, vector_at
from navsym.export.languages.c import files as c_files
from navsym.export.languages.targets import TARGETS, WARNINGS
from navsym.export.parts import ExportedFunction
from navsym.export.processes import run
from tests.attacks.points.bands import Array, Band, Flags
from tests.attacks.points.twin import SLACK, formula_values, rounding_bounds

BLOCK = 2048
CORNERED = 0.1  # part of the points with several arguments at an edge
LEAST_BOUND = 2.0**-800  # below it half a subnormal, which no double is, may be much of the bound

Points = list[tuple[float, ...]]
Call = Callable[[Array], tuple[Array, Array]]


@dataclass(frozen=True, slots=True)
class Swept:
    """What came of one function.

    points    : inside the domain, with a finite enclosure
    by_balls  : those of them that the twin left to ball arithmetic
    undefined : points without an enclosure (overflow, or no error bound), which are not counted
    wrong     : outputs outside, or a status that is not OK
    worst     : largest distance from the exact value in ulp, where the bound is below a thousand ulp
    example   : the first point that is wrong
    """

    points: int
    by_balls: int
    undefined: int
    wrong: int
    worst: float
    example: tuple[float, ...] | None = None


def sweep(function: ExportedFunction, call: Call, count: int, *, library: int = 1, widen: int = 1) -> Swept:
    """Compare ``count`` points of a function; ``call`` maps (inputs, n) to (statuses, (results, n))."""
    arithmetic = replace(function.arithmetic, library=library)
    total = Swept(0, 0, 0, 0, 0.0)
    waiting = many_points(function, count)
    while total.points < count and (block := list(itertools.islice(waiting, min(BLOCK, count)))):
        total = joined(total, compare(function, block, call, arithmetic, widen))
    return total


def joined(a: Swept, b: Swept) -> Swept:
    """What came of two sets of points together."""
    return Swept(
        a.points + b.points,
        a.by_balls + b.by_balls,
        a.undefined + b.undefined,
        a.wrong + b.wrong,
        max(a.worst, b.worst),
        a.example or b.example,
    )


def many_points(function: ExportedFunction, count: int) -> Iterator[tuple[float, ...]]:
    """The points of the vectors, many more of their kind, and points with several arguments at an edge."""
    yield from points(function, count)
    generator = random.Random(f"{function.name} at corners")
    edges = [edge_values(function, k) for k in range(len(function.inputs))]
    for _ in range(2 * count if function.inputs else 0):
        corner = generator.random() < CORNERED
        yield cast(
            function,
            [
                generator.choice(ends)
                if corner and generator.random() < 0.5
                else sample(i.test_low, i.test_high, generator)
                for i, ends in zip(function.inputs, edges, strict=True)
            ],
        )


# -- comparison ---------------------------------------


def compare(function: ExportedFunction, block: Points, call: Call, arithmetic: Arithmetic, widen: int) -> Swept:
    """One block, regime by regime."""
    columns = np.array(block, dtype=float).reshape(len(block), -1).T
    statuses, results = call(np.ascontiguousarray(columns))
    total = Swept(0, 0, 0, 0, 0.0)
    pieces = [piece_at(function, point) for point in block]
    for piece in function.pieces:
        here = [k for k, other in enumerate(pieces) if other is piece]
        if not here:
            continue
        with np.errstate(all="ignore"):
            given = [column[here] for column in columns]
            values = formula_values(piece, given)
            bounds, doubt = rounding_bounds(piece, given, arithmetic)
            fine, worst = accepted(function, results[:, here], values, bounds, widen)
        fine &= ~np.broadcast_to(doubt, fine.shape) & (statuses[here] == 0)
        left = [here[k] for k in np.flatnonzero(~fine)]
        decided = by_balls(function, [(block[k], int(statuses[k]), results[:, k]) for k in left], arithmetic, widen)
        top = float(worst[fine].max(initial=0.0))
        total = joined(joined(total, Swept(int(fine.sum()), 0, 0, 0, top)), decided)
    return total


def accepted(
    function: ExportedFunction, results: Array, values: Sequence[Band], bounds: Sequence[Array], widen: int
) -> tuple[Flags, Array]:
    """Points whose outputs are all inside beyond doubt, and the largest error of each in ulp.

    Inside is: nearer to the exact value than the bound less SLACK of itself, or nearer than the next double.
    """
    n, unit = results.shape[1], 2.0 ** (function.arithmetic.u + 1)
    fine, worst = np.ones(n, dtype=bool), np.zeros(n)
    for output, value, bound in zip(results, values, bounds, strict=True):
        far = np.abs((output - value.high) - value.low) * (1 + 2.0**-40) + value.error
        room = np.where(bound > LEAST_BOUND, bound * widen * (1 - SLACK), 0.0)
        near = (far <= room) | (far <= 2.0**-54 * np.abs(output)) | (far == 0)
        size = np.abs(value.high)
        fine &= near & (size + bound * widen < LARGEST[function.arithmetic.name])
        counted = (size > 0) & (bound * widen < 1000 * unit * size)
        worst = np.maximum(worst, np.where(counted, far / np.where(size > 0, size * unit, 1.0), 0.0))
    return fine, worst


def by_balls(
    function: ExportedFunction, rows: Sequence[tuple[tuple[float, ...], int, Array]], arithmetic: Arithmetic, widen: int
) -> Swept:
    """The slow twin on the points that are left."""
    total = Swept(0, 0, 0, 0, 0.0)
    for point, status, outputs in rows:
        vector = vector_at(function, point, arithmetic, widen)
        if vector is None:
            total = joined(total, Swept(0, 0, 1, 0, 0.0))
            continue
        ends = zip(map(float, outputs), vector.lower, vector.upper, strict=True)
        wrong = status != 0 or any(not low <= x <= high for x, low, high in ends)
        total = joined(total, Swept(1, 1, 0, int(wrong), 0.0, point if wrong else None))
    return total


# -- the compiled code ---------------------------------------

LOOP = """
int rows_{name}(long n, const {real} *in, {real} *out, int *status);
int rows_{name}(long n, const {real} *in, {real} *out, int *status)
{{
    long k;
    (void)in;
    for (k = 0; k < n; k++) {{
        status[k] = (int){name}({arguments});
    }}
    return 0;
}}
"""


def compiled_c(functions: Sequence[ExportedFunction], folder: Path) -> list[Call]:
    """The exported C as calls over columns: compiled with the flags of its own test program."""
    tool = TARGETS["c"].executable()
    if tool is None:
        raise MissingEngineError("expected gcc, which compiles the exported C; got none; install it")
    for name, text in c_files(functions, {f.name: [] for f in functions}, "").items():
        (folder / name).write_text(text, encoding="utf-8")
    head = [f'#include "{f.name}.h"' for f in functions]
    (folder / "rows.c").write_text("\n".join([*head, *(loop(f) for f in functions)]), encoding="utf-8")
    sources = ["rows.c", *(f"{f.name}.c" for f in functions)]
    flags = ["-std=c99", "-O2", "-ffp-contract=off", *WARNINGS, "-shared", "-fPIC"]
    status, said = run([tool, *flags, *sources, "-o", "rows.so", "-lm"], folder)
    if status != 0:
        raise MissingEngineError(f"expected a compiler that takes the exported C; got {said.strip()[-160:]!r}")
    library = ctypes.CDLL(str(folder / "rows.so"))
    return [caller(library, f) for f in functions]


def loop(function: ExportedFunction) -> str:
    """C source of a loop that calls the function at row after row."""
    n, size = len(function.inputs), function.size
    words = [f"{'&' if a.size else ''}in[(k * {n}) + {a.first}]" for a in function.called_with]
    words += [f"&out[(k * {size}) + {place}]" for _, place in function.placed]
    return LOOP.format(name=function.name, real=function.arithmetic.name, arguments=", ".join(words))


def caller(library: ctypes.CDLL, function: ExportedFunction) -> Call:
    """A function of the library over columns of doubles."""
    kind = np.float32 if function.arithmetic.name == "float" else np.float64
    routine = getattr(library, f"rows_{function.name}")

    def call(columns: Array) -> tuple[Array, Array]:
        n = columns.shape[1] if columns.size else 1
        given = np.ascontiguousarray(columns.T, dtype=kind)
        results, statuses = np.zeros((n, function.size), dtype=kind), np.zeros(n, dtype=np.int32)
        pointers = (x.ctypes.data_as(ctypes.c_void_p) for x in (given, results, statuses))
        routine(ctypes.c_long(n), *pointers)
        return statuses, results.T.astype(float)

    return call


def sweep_c(functions: Sequence[ExportedFunction], count: int) -> dict[str, Swept]:
    """Every function's C at ``count`` points."""
    with tempfile.TemporaryDirectory(prefix="navsym-sweep-") as folder:
        calls = compiled_c(functions, Path(folder))
        return {f.name: sweep(f, call, count) for f, call in zip(functions, calls, strict=True)}
