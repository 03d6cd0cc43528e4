"""Batches: C over many points at once, vectorised by the compiler, called from NumPy through ctypes.

One loop for each call of the library, one for the arithmetic between them and one for each result, over blocks that
stay in the cache, so that the compiler finds vectors in all of them. Large results go past the cache, which they would
only push other numbers out of, and memory of a result that nobody holds any more is used again. The C library's vector
forms of sin, cos, exp, log and pow are taken as accurate to 4 ulp; the bounds in the vectors allow for that.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.c import helper_texts, source, spelling
from navsym.export.languages.printing import Spelling, loops_of
from navsym.export.languages.python import ENDING, vectors_json
from navsym.export.languages.summary import summary
from navsym.export.parts import ExportedFunction

BLOCK = 512
CACHE = 4e6  # bytes
LIBRARY = frozenset([*"sin cos exp log pow expm1 asin acos atan atan2 sinh cosh tanh filled".split()])

HEAD = """/* {license} */
/* Many points at once. Inputs and results are rows of n numbers; all rows lie one behind the other. */
#include <float.h>
#include <stddef.h>
/* glibc offers its vector functions only when asked in this way; nothing else of fast-math is wanted. */
#if defined(__GNUC__) && !defined(__FAST_MATH__)
#define __FAST_MATH__ 1
#include <math.h>
#undef __FAST_MATH__
#else
#include <math.h>
#endif

typedef enum {{ NAVSYM_OK = 0, NAVSYM_DOMAIN = 1, NAVSYM_NOT_FINITE = 2 }} navsym_status;
enum {{ NAVSYM_BLOCK = {block} }};

/* The widest store that goes past the cache; without one the numbers are copied. */
#if defined(__AVX512F__)
#include <immintrin.h>
enum {{ NAVSYM_WIDE = 64 }};
#define NAVSYM_STREAM(to, from) _mm512_stream_si512((__m512i *)(void *)(to), _mm512_loadu_si512((const void *)(from)))
#elif defined(__AVX__)
#include <immintrin.h>
enum {{ NAVSYM_WIDE = 32 }};
#define NAVSYM_STREAM(to, from) _mm256_stream_si256((__m256i *)(to), _mm256_loadu_si256((const __m256i *)(from)))
#elif defined(__SSE2__)
#include <emmintrin.h>
enum {{ NAVSYM_WIDE = 16 }};
#define NAVSYM_STREAM(to, from) _mm_stream_si128((__m128i *)(to), _mm_loadu_si128((const __m128i *)(from)))
#endif

/* Results of a block to their place, past the cache when there are more bytes in all than it holds. */
static void navsym_put({real} *to, const {real} *from, long m, double bytes)
{{
    long k = 0;
#if defined(NAVSYM_STREAM)
    const long lanes = NAVSYM_WIDE / (long)sizeof({real});
    if (bytes > {cache}) {{
        for (; (k < m) && (((size_t)&to[k] % NAVSYM_WIDE) != 0); k++) {{ to[k] = from[k]; }}
        for (; (k + lanes) <= m; k += lanes) {{ NAVSYM_STREAM(&to[k], &from[k]); }}
    }}
#endif
    for (; k < m; k++) {{ to[k] = from[k]; }}
}}

/* Stores past the cache are seen by every reader from here on: once for all blocks, since each fence drains them. */
static void navsym_done(void)
{{
#if defined(NAVSYM_STREAM)
    _mm_sfence();
#endif
}}
"""

MODULE = '''# {license}
"""Exported functions over batches: compiled once into a temporary folder, called without a copy.

Every function takes an array (inputs, n) and returns (results, n), in ``out`` when that is given. The memory of
the last two results is kept, and used again for a later one when nobody holds them any more.
Outside the proved domain it raises ValueError.
"""

import atexit
import ctypes
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading

import numpy as np

REAL = np.{real}
FLAGS = ["-std=gnu11", "-O3", "-march=native", "-mprefer-vector-width=512", "-ffp-contract=off", "-fno-math-errno",
         "-shared", "-fPIC"]
NUMBERS = np.ctypeslib.ndpointer(REAL, ndim=2, flags="C_CONTIGUOUS")


def _library():
    folder = tempfile.mkdtemp(prefix="navsym-batch-")
    atexit.register(shutil.rmtree, folder, True)
    made = pathlib.Path(folder) / "batch.so"
    source = pathlib.Path(__file__).with_name("navsym_batch.c")
    flags = FLAGS
    while True:
        command = ["gcc", *flags, str(source), "-o", str(made), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300)
        if done.returncode == 0:
            return ctypes.CDLL(str(made))
        if "-march=native" not in flags:
            raise RuntimeError("gcc: " + done.stderr[:300])
        flags = [flag for flag in flags if not flag.startswith("-m")]  # an older or another processor


_LIBRARY = _library()
_LOCK = threading.Lock()
_KEPT = [np.empty(0, dtype=REAL)]
_FREE = sys.getrefcount(_KEPT[0])  # of memory that only the list holds


def _room(results, n):
    """An array (results, n). Its memory is that of an earlier result when nobody holds that one any more: pages
    fresh from the system cost more than most computations. Two are kept: one for ``r = f(points)`` while the old
    r is still held."""
    size = results * n
    with _LOCK:
        for k in range(len(_KEPT)):
            if size <= _KEPT[k].size <= 2 * size + 100000 and sys.getrefcount(_KEPT[k]) == _FREE:
                return _KEPT[k][:size].reshape(results, n)
        _KEPT[:] = [np.empty(size, dtype=REAL), *_KEPT[:1]]
        return _KEPT[0][:size].reshape(results, n)


def _call(name, inputs, results, points, out):
    points = np.ascontiguousarray(points, dtype=REAL)
    if points.ndim != 2 or points.shape[0] != inputs:
        raise ValueError(f"{{name}}: expected an array ({{inputs}}, n); got {{points.shape}}")
    n = points.shape[1]
    if out is None:
        out = _room(results, n)
    if out.shape != (results, n) or out.dtype != REAL or not out.flags.c_contiguous or np.shares_memory(out, points):
        raise ValueError(f"{{name}}: expected out as an array ({{results}}, {{n}}) of its own; got another")
    function = getattr(_LIBRARY, name)
    function.argtypes, function.restype = (ctypes.c_ssize_t, NUMBERS, NUMBERS), ctypes.c_int
    status = function(n, points, out)
    if status == 1:
        raise ValueError(f"{{name}}: expected points in the proved domain; got others")
    if status:
        raise ArithmeticError(f"{{name}}: a result would overflow or is undefined at one of the points")
    return out

'''

TEST = '''# {license}
"""Runs every function on its vectors; the exit status is the number of functions that failed."""

import itertools
import json
import pathlib
import sys

import numpy as np

import navsym_batch as module

MANY = {many}  # several blocks, the last one not full


def attempt(call, points):
    try:
        return call(points)
    except (ValueError, ArithmeticError):
        return None


def main():
    tests = json.loads((pathlib.Path(__file__).parent / "vectors.json").read_text(encoding="utf-8"))
    failed = 0
    for name, rows in tests.items():
        call, wrong, worst = getattr(module, name), 0, 0.0
        good = [row for row in rows if row["status"] == 0]
        for row in rows:
            if row["status"] == 0:
                continue
            point = np.array([[float(x)] * 9 for x in row["in"]])
            try:
                call(point)
                wrong += 1
            except ValueError:
                wrong += row["status"] != 1
            except ArithmeticError:
                wrong += row["status"] != 2
        points = np.array([row["in"] for row in good], dtype=module.REAL).T.reshape(-1, len(good))
        results = attempt(call, points[:, np.arange(max(MANY, len(good))) % len(good)])
        wrong += results is None
        for column, row in zip([] if results is None else results.T, itertools.cycle(good)):
            for value, low, high, nearest in zip(map(float, column), row["lower"], row["upper"], row["nearest"]):
                wrong += not low <= value <= high
                size = abs(nearest) * float(np.finfo(module.REAL).eps)
                if size and high - nearest < 1000.0 * size:
                    worst = max(worst, abs(value - nearest) / size)
'''


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """The C of all functions, the module that compiles and calls it, vectors and test."""
    functions = [f for f in functions if f.inputs]
    real = functions[0].arithmetic.name if functions else "double"
    kind = "float32" if real == "float" else "float64"
    head = HEAD.format(license=license_, block=BLOCK, real=real, cache=CACHE)
    module = [MODULE.format(license=license_, real=kind), *(wrapper(f) for f in functions)]
    return {
        "navsym_batch.c": "\n".join([head, *helper_texts(*functions), *(batch(f) for f in functions)]),
        "navsym_batch.py": "\n".join(module),
        "vectors.json": vectors_json(functions, tests),
        "test_vectors.py": (TEST + ENDING).format(license=license_, many=3 * BLOCK - 7),
    }


def wrapper(function: ExportedFunction) -> str:
    """Python source of the function that hands rows of points to the library."""
    rows = ", ".join(i.symbol.name for i in function.inputs).replace("\\", "/").replace('"', "'")
    results = ", ".join(f"{o.name}[{o.size}]" if o.shape else o.name for o in function.outputs)
    return "\n".join(
        [
            "",
            f"def {function.name}(points, out=None):",
            f'    """Rows in: {rows}. Rows out: {results}."""',
            f'    return _call("{function.name}", {len(function.inputs)}, {function.size}, points, out)',
            "",
        ]
    )


def batch(function: ExportedFunction) -> str:
    """The loops of one function; one with regimes goes point by point."""
    return vectorised(function) if len(function.pieces) == 1 else pointwise(function)


def signature(function: ExportedFunction) -> list[str]:
    """The lines up to the opening brace: summary as comments, prototype, head of the definition."""
    real = function.arithmetic.name
    lines = [f"/* {line.replace('*/', '* /').replace('/*', '/ *')} */" for line in summary(function)]
    lines += [f"int {function.name}(long n, const {real} *restrict in, {real} *restrict out);"]
    return [*lines, f"int {function.name}(long n, const {real} *restrict in, {real} *restrict out)", "{"]


def vectorised(function: ExportedFunction) -> str:
    """Domain test, then blocks of loops, then the test of the results."""
    real, s = function.arithmetic.name, spelling(function.arithmetic.name)
    largest = "FLT_MAX" if real == "float" else "DBL_MAX"
    names = [f"in[({k} * n) + b + k]" for k in range(len(function.inputs))]
    temporaries, results = loops_of(function.pieces[0], names, s, LIBRARY)
    arrays = {name: f"{name}[k]" for name, _, _ in temporaries}
    lines = [*signature(function), "    long b, k;", "    int bad = 0;"]
    for place, i in enumerate(function.inputs):
        x = f"in[({place} * n) + k]"
        low = f"-{largest}" if i.low == -float("inf") else s.number(i.low)
        high = largest if i.high == float("inf") else s.number(i.high)
        lines += [f"    for (k = 0; k < n; k++) {{ bad |= !({x} >= {low}) | !({x} <= {high}); }}"]
    lines += [
        "    if (bad) { return NAVSYM_DOMAIN; }",
        "    for (b = 0; b < n; b += NAVSYM_BLOCK) {",
        "        const long m = ((n - b) < NAVSYM_BLOCK) ? (n - b) : NAVSYM_BLOCK;",
    ]
    lines += [f"        {real} {name}[NAVSYM_BLOCK];" for name in (*arrays, "w")]
    for group in grouped(temporaries):
        lines += ["        for (k = 0; k < m; k++) {"]
        lines += [f"            {arrays[name]} = {in_arrays(text, arrays)};" for name, text, _ in group] + ["        }"]
    for j, text in enumerate(results):
        lines += stored(function, j, in_arrays(text, arrays), s)
    lines += ["    }", "    navsym_done();", "    return bad ? NAVSYM_NOT_FINITE : NAVSYM_OK;", "}", ""]
    return "\n".join(lines)


def stored(function: ExportedFunction, j: int, text: str, s: Spelling) -> list[str]:
    """One result of a block: computed into the cache, tested there where it may overflow, and put in its place."""
    real = function.arithmetic.name
    ready = re.fullmatch(r"(\w+)\[k\]", text)  # a temporary, which is there already
    row = ready[1] if ready else "w"
    lines = [] if ready else ["        for (k = 0; k < m; k++) {", f"            w[k] = {text};", "        }"]
    if not function.always_finite:
        largest = "FLT_MAX" if real == "float" else "DBL_MAX"
        lines += [f"        for (k = 0; k < m; k++) {{ bad |= !({s.calls['abs'].format(f'{row}[k]')} <= {largest}); }}"]
    bytes_ = f"{float(function.size)} * (double)n * (double)sizeof({real})"
    return [*lines, f"        navsym_put(&out[({j} * n) + b], {row}, m, {bytes_});"]


def grouped(temporaries: Sequence[tuple[str, str, bool]]) -> list[list[tuple[str, str, bool]]]:
    """Consecutive arithmetic in one loop; every call of the library in a loop of its own."""
    groups: list[list[tuple[str, str, bool]]] = []
    for item in temporaries:
        if not groups or item[2] or groups[-1][-1][2]:
            groups.append([])
        groups[-1].append(item)
    return groups


def in_arrays(text: str, arrays: dict[str, str]) -> str:
    """The text with every temporary as an entry of its array."""
    words, word = [], ""
    for char in [*text, " "]:
        if char.isalnum() or char == "_":
            word += char
            continue
        words += [arrays.get(word, word), char]
        word = ""
    return "".join(words)[:-1]


def pointwise(function: ExportedFunction) -> str:
    """A loop around the plain function, for regimes."""
    real = function.arithmetic.name
    head = f"navsym_status {function.name}("
    text = source(function, "")
    plain = text[text.index(head) :].replace(head, f"static int {function.name}_at(", 1)
    n = len(function.inputs)
    words = [f"&x[{a.first}]" if a.size else f"x[{a.first}]" for a in function.called_with]
    at = 0
    for output in function.outputs:
        words.append(f"&r[{at}]")
        at += output.size
    lines = [plain, *signature(function), f"    {real} x[{n}], r[{function.size}];"]
    lines += ["    long k;", "    int j, status;"]
    lines += ["    for (k = 0; k < n; k++) {", f"        for (j = 0; j < {n}; j++) {{ x[j] = in[(j * n) + k]; }}"]
    lines += [f"        status = {function.name}_at({', '.join(words)});"]
    lines += ["        if (status != 0) { return status; }"]
    lines += [f"        for (j = 0; j < {function.size}; j++) {{ out[(j * n) + k] = r[j]; }}", "    }"]
    return "\n".join([*lines, "    return NAVSYM_OK;", "}", ""])
