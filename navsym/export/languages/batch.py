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
from navsym.export.languages.printing import Spelling, loops_of, template
from navsym.export.languages.python import vectors_json
from navsym.export.languages.summary import summary
from navsym.export.parts import ExportedFunction

BLOCK = 512
CACHE = 4e6  # bytes
LIBRARY = frozenset([*"sin cos exp log pow expm1 asin acos atan atan2 sinh cosh tanh filled".split()])


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """The C of all functions, the module that compiles and calls it, vectors and test."""
    functions = [f for f in functions if f.inputs]
    real = functions[0].arithmetic.name if functions else "double"
    kind = "float32" if real == "float" else "float64"
    head = template("batch_head.c").format(license=license_, block=BLOCK, real=real, cache=CACHE)
    module = [template("batch_module.py").format(license=license_, real=kind), *(wrapper(f) for f in functions)]
    return {
        "navsym_batch.c": "\n".join([head, *helper_texts(*functions), *(batch(f) for f in functions)]),
        "navsym_batch.py": "\n".join(module),
        "vectors.json": vectors_json(functions, tests),
        "test_vectors.py": (template("batch_test.py") + template("python_test_ending.py")).format(
            license=license_, many=3 * BLOCK - 7
        ),
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
