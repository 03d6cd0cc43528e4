"""Python with NumPy: one module, each function over arrays of one shape (numbers are arrays of none)."""

from __future__ import annotations

import math
from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.helpers import Helper, helper_parts, helpers_used, squares_if_needed
from navsym.export.languages.printing import Spelling, assignments, calls, code_names, template
from navsym.export.languages.programs import calls_table, python_program
from navsym.export.languages.summary import summary
from navsym.export.parts import ExportedFunction

SPECIAL = {"abs": "np.abs({0})", "max": "np.maximum({0}, {1})", "min": "np.minimum({0}, {1})"}
SPECIAL |= {"atan2": "np.arctan2({0}, {1})", "pow": "np.power({0}, {1})"}
SPECIAL |= {name: f"np.arc{name[1:]}({{0}})" for name in ("asin", "acos", "atan")}
SPELLING = Spelling(calls(prefix="np.", **SPECIAL), "np.nan", "np.inf")


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """The module, its vectors and the program that runs them."""
    real = "float32" if functions[0].arithmetic.name == "float" else "float64"
    texts = [
        template("python_head.py").format(license=license_, real=real),
        *map(helper_text, helpers_used(*functions)),
    ]
    texts += [text for f in functions for text in (source(f), *python_program(f))]
    epsilon = "2.0**-52" if real == "float64" else "2.0**-23"
    return {
        "navsym_functions.py": "\n\n".join(texts),
        "test_vectors.py": (template("python_test.py") + template("python_test_ending.py")).format(
            license=license_, epsilon=epsilon, calls=calls_table(functions, python=True)
        ),
        "vectors.json": vectors_json(functions, tests),
    }


def helper_text(helper: Helper) -> str:
    """One function against cancellation, over arrays: both forms, each where it holds."""
    switch, below, above = helper_parts(helper, SPELLING, "far")
    return "\n".join(
        [
            f"def navsym_{helper.name}(x):",
            *squares_if_needed(helper, "    y = x * x"),
            f"    near = np.abs(x) < {switch}",
            "    far = np.where(near, 1.0, x)",
            f"    return np.where(near, {below}, {above})",
            "",
        ]
    )


def vectors_json(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]]) -> str:
    """All vectors as JSON; numbers that JSON does not have are strings."""
    blocks = []
    for function in functions:
        rows = ",\n".join(f"    {row_text(v)}" for v in tests[function.name])
        blocks.append(f'  "{function.name}": [\n{rows}\n  ]')
    return "{\n" + ",\n".join(blocks) + "\n}\n"


def row_text(v: Vector) -> str:
    """A vector as one JSON object; numbers that are not finite stand in quotes."""

    def plain(values: Sequence[float]) -> str:
        shown = (repr(x) if math.isfinite(x) else f'"{x}"' for x in values)
        return f"[{', '.join(shown)}]"

    parts = ", ".join(f'"{k}": {plain(getattr(v, k))}' for k in ("lower", "upper", "nearest"))
    return f'{{"in": {plain(v.inputs)}, "status": {v.status}, {parts}}}'


def source(function: ExportedFunction) -> str:
    """One function: arrays in, arrays out, one mask for each regime."""
    names, arguments = code_names(function, "{0}[..., {1}]"), function.called_with
    signature = ", ".join(a.name for a in arguments)
    lines = [f"def {function.name}({signature}):", *docstring(function), *checks(function)]
    shapes = ", ".join(f"{a.name}.shape{'[:-1]' if a.size else ''}" for a in arguments)
    shape = f"np.broadcast_shapes({shapes})" if names else "()"
    kind = "np.float32" if function.arithmetic.name == "float" else "np.float64"
    lines.append(f"    shape = {shape}")
    if len(function.pieces) == 1:
        temporaries, results = assignments(function.pieces[0], names, SPELLING)
        lines += [f"    {name} = {text}" for name, text in temporaries]
        lines += [f"    r{k} = {text}" for k, text in enumerate(results)]
    else:
        lines += regimes(function, names, kind)
    return "\n".join([*lines, *returned(function, kind), ""])


def docstring(function: ExportedFunction) -> list[str]:
    """Lines of the docstring of an exported function: its title, then the summary."""
    text = [line.replace("\\", "/").replace('"""', "'''") for line in summary(function)]
    title = function.sources[0].title or function.name
    return [f'    """{title.replace(chr(34) * 3, "")}', "", *(f"    {line}" for line in text), '    """']


def checks(function: ExportedFunction) -> list[str]:
    """Lines that check every argument against its range, one for each."""
    largest = "np.finfo(np.float32).max" if function.arithmetic.name == "float" else "np.finfo(np.float64).max"
    lines = []
    for a in function.called_with:
        entries = function.inputs[a.first : a.first + (a.size or 1)]
        lows = [repr(i.low) if math.isfinite(i.low) else f"-{largest}" for i in entries]
        highs = [repr(i.high) if math.isfinite(i.high) else largest for i in entries]
        low, high = (ends[0] if len(set(ends)) == 1 else f"np.array([{', '.join(ends)}])" for ends in (lows, highs))
        size = f", {a.size}" if a.size else ""
        lines.append(f'    {a.name} = _checked("{a.name}", {a.name}, {low}, {high}{size})')
    return lines


def regimes(function: ExportedFunction, names: list[str], kind: str) -> list[str]:
    """Every regime on the points that belong to it."""
    assert function.switch is not None, "several pieces need the input that switches"
    lines = [f"    {n} = np.broadcast_to({n}, shape)" for n in names]
    lines += [f"    r{k} = np.empty(shape, dtype={kind})" for k in range(function.size)]
    lines += [f"    every = ({', '.join(names)},)", "    left = np.ones(shape, dtype=bool)"]
    for piece in function.pieces:
        temporaries, results = assignments(piece, names, SPELLING)
        test = "" if piece.limit is None else f" & (every[{function.switch}] <= {piece.limit!r})"
        lines.append(f"    here = left{test}  # {piece.source.claim}")
        lines.append(f"    {', '.join(names)}, = (x[here] for x in every)")
        lines += [f"    {name} = {text}" for name, text in temporaries]
        lines += [f"    r{k}[here] = {text}" for k, text in enumerate(results)]
        lines.append("    left = left & ~here")
    return lines


def returned(function: ExportedFunction, kind: str) -> list[str]:
    """The line that returns the results; the entries of an output that has several stand on the last axes."""
    parts, k = [], 0
    for output in function.outputs:
        entries = [f"np.broadcast_to(np.asarray(r{k + e}, dtype={kind}), shape)" for e in range(output.size)]
        if output.shape:
            stacked = f"np.stack([{', '.join(entries)}], axis=-1)"
            parts.append(stacked if len(output.shape) == 1 else f"{stacked}.reshape(*shape, *{output.shape})")
        else:
            parts.append(f"{entries[0]}[()]")
        k += output.size
    joined = ", ".join(parts)
    return [f"    return _finite(({joined},))" + ("[0]" if len(parts) == 1 else "")]
