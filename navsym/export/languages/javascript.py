"""JavaScript (ECMAScript module): every function returns ``{status, …results}``."""

from __future__ import annotations

from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.helpers import Helper, helper_parts, helpers_used, squares_if_needed
from navsym.export.languages.printing import Spelling, assignments, calls, code_names, result_fields, template
from navsym.export.languages.programs import calls_table, js_program
from navsym.export.languages.python import vectors_json
from navsym.export.languages.summary import summary
from navsym.export.parts import ExportedFunction

SPECIAL = {"abs": "Math.abs({0})", "max": "Math.max({0}, {1})", "min": "Math.min({0}, {1})"}
SPELLING = Spelling(calls(prefix="Math.", **SPECIAL), "NaN", "Infinity")


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """The module, its vectors and the program that runs them."""
    head = [f"// {license_}", "// Status: 0 results are valid, 1 argument outside the proved domain, 2 not finite.", ""]
    helpers = [helper_text(helper) for helper in helpers_used(*functions)]
    return {
        "navsym_functions.mjs": "\n".join(
            [*head, *helpers, *(text for f in functions for text in (source(f), *js_program(f)))]
        ),
        "test_vectors.mjs": template("javascript_test.mjs").format(license=license_, calls=calls_table(functions)),
        "vectors.json": vectors_json(functions, tests),
    }


def source(function: ExportedFunction) -> str:
    """One exported function with its comment."""
    names = code_names(function)
    lines = ["/**", *(f" * {line.replace('*/', '* /')}" for line in summary(function)), " */"]
    arguments = ", ".join(a.name for a in function.called_with)
    lines.append(f"export function {function.name}({arguments}) {{")
    tests = [f"{n} >= {bound(i.low)} && {n} <= {bound(i.high)}" for i, n in zip(function.inputs, names, strict=True)]
    if tests:
        lines.append(f"  if (!({' && '.join(tests)})) {{ return {{ status: 1 }}; }}")
    lines.append(f"  let {', '.join(f'r{k}' for k in range(function.size))};")
    for place, piece in enumerate(function.pieces):
        temporaries, results = assignments(piece, names, SPELLING)
        test = "" if piece.limit is None else f"if ({names[function.switch or 0]} <= {piece.limit!r}) "
        lines.append(f"  {'else ' if place else ''}{test}{{ // {piece.source.claim}")
        lines += [f"    const {name} = {text};" for name, text in temporaries]
        lines += [f"    r{k} = {text};" for k, text in enumerate(results)]
        lines.append("  }")
    finite = " && ".join(f"Number.isFinite(r{k})" for k in range(function.size))
    lines += [
        f"  if (!({finite})) {{ return {{ status: 2 }}; }}",
        f"  return {{ status: 0, {result_fields(function, 'r{}')} }};",
        "}",
    ]
    return "\n".join([*lines, ""])


def bound(x: float) -> str:
    """An end of a range as a number; the largest finite one for infinity."""
    if x in (float("inf"), float("-inf")):
        return "Number.MAX_VALUE" if x > 0 else "-Number.MAX_VALUE"
    return SPELLING.number(x)


def helper_text(helper: Helper) -> str:
    """One function against cancellation."""
    switch, below, above = helper_parts(helper, SPELLING)
    return "\n".join(
        [
            f"function navsym_{helper.name}(x) {{",
            *squares_if_needed(helper, "  const y = x * x;"),
            f"  return Math.abs(x) < {switch} ? {below} : {above};",
            "}",
            "",
        ]
    )
