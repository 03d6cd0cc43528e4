"""Julia: one module; every function returns its status and the results."""

from __future__ import annotations

from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.helpers import Helper, helper_parts, helpers_used, squares_if_needed
from navsym.export.languages.printing import Spelling, assignments, calls, template
from navsym.export.languages.scripts import branch, domain, vectors_text
from navsym.export.languages.summary import summary
from navsym.export.parts import ExportedFunction

SPELLING = Spelling(
    calls(abs="abs({0})", atan2="atan({0}, {1})", pow="({0})^({1})", max="max({0}, {1})", min="min({0}, {1})"),
    "NaN",
    "Inf",
)


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """Module and test script."""
    head = [
        f"# {license_}",
        "# Every function returns (status, results...); results are there when status == 0.",
        "module NavsymFunctions",
        "",
    ]
    head += [line for h in helpers_used(*functions) for line in helper_text(h)]
    body = [line for f in functions for line in source(f)]
    return {
        "NavsymFunctions.jl": "\n".join([*head, *body, "end", ""]),
        "test_vectors.jl": template("julia_test.jl").format(license=license_),
        "vectors.txt": vectors_text(functions, tests),
    }


def helper_text(helper: Helper) -> list[str]:
    """One function against cancellation."""
    switch, below, above = helper_parts(helper, SPELLING)
    return [
        f"function navsym_{helper.name}(x)",
        *squares_if_needed(helper, "    y = x * x"),
        f"    return abs(x) < {switch} ? {below} : {above}",
        "end",
        "",
    ]


def source(function: ExportedFunction) -> list[str]:
    """Lines of a function: (status, results...), with the status alone where there are none."""
    names = [i.name for i in function.inputs]
    lines = [*(f"# {line}" for line in summary(function)), f"function {function.name}({', '.join(names)})"]
    lines += [f"    if !({domain(function, 'floatmax(Float64)', SPELLING)})", "        return (1,)", "    end"]
    for place, piece in enumerate(function.pieces):
        temporaries, results = assignments(piece, names, SPELLING)
        word = branch(function, place, "if", "elseif", "else")
        lines += [f"    {word}"] if len(function.pieces) > 1 else []
        lines += [f"        {name} = {text}" for name, text in temporaries]
        lines += [f"        r{k} = {text}" for k, text in enumerate(results)]
    lines += ["    end"] if len(function.pieces) > 1 else []
    entries = ", ".join(f"r{k}" for k in range(function.size))
    lines += [f"    if !all(isfinite, ({entries},))", "        return (2,)", "    end"]
    return [*lines, f"    return (0, {entries})", "end", ""]
