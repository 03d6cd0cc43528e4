"""C++17: one header-only file; results come back in a structure with their status."""

from __future__ import annotations

import math
from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.c import helper_text, safe_comment
from navsym.export.languages.helpers import helpers_used
from navsym.export.languages.printing import Spelling, assignments, calls, code_names, template
from navsym.export.languages.programs import cpp_program, cpp_through_state, through_accessors
from navsym.export.languages.summary import summary
from navsym.export.parts import Argument, ExportedFunction, Output


def spelling(real: str) -> Spelling:
    """std:: functions are overloaded for float; literals carry the suffix."""
    table = calls(prefix="std::") | {"abs": "std::fabs({0})"}
    nan, inf = (f"static_cast<{real}>({word})" for word in ("NAN", "INFINITY"))
    return Spelling(table, nan, inf, "f" if real == "float" else "")


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """The header, the test program with its vectors, and the build file."""
    return {
        "navsym_functions.hpp": header(functions, license_),
        "test_main.cpp": program(functions, tests, license_),
        "CMakeLists.txt": template("cpp_CMakeLists").format(license=license_),
    }


def header(functions: Sequence[ExportedFunction], license_: str) -> str:
    """The text of the header: helpers and functions in the namespace navsym."""
    real = functions[0].arithmetic.name
    s = spelling(real)
    helpers = [helper_text(helper, real, s, "inline") for helper in helpers_used(*functions)]
    return "\n".join(
        [
            f"// {license_}",
            "#ifndef NAVSYM_FUNCTIONS_HPP",
            "#define NAVSYM_FUNCTIONS_HPP",
            "",
            "#include <array>",
            "#include <cmath>",
            "#include <limits>",
            "",
            "namespace navsym {",
            "",
            "enum class Status { ok = 0, domain = 1, not_finite = 2 };",
            "",
            *helpers,
            "",
            *(text for f in functions for text in (source(f, s), *cpp_program(f))),
            "}  // namespace navsym",
            "",
            "#endif",
            "",
        ]
    )


def source(function: ExportedFunction, s: Spelling) -> str:
    """Result structure and function."""
    real, names = function.arithmetic.name, code_names(function)
    targets = [f"result.{o.name}{f'[{e}]' if o.shape else ''}" for o in function.outputs for e in range(o.size)]
    lines = [f"struct {function.name}_result {{", "    Status status = Status::not_finite;"]
    lines += [f"    {member(o, real)};" for o in function.outputs] + ["};", ""]
    lines += ["/**", *(f" * {safe_comment(line)}" for line in summary(function)), " */"]
    arguments = ", ".join(parameter(a, real) for a in function.called_with)
    lines += [f"inline {function.name}_result {function.name}({arguments}) noexcept"]
    lines += ["{", f"    {function.name}_result result;", *domain_test(function, names, s)]
    lines += regimes(function, names, targets, s)
    finite = "\n        && ".join(f"std::isfinite({t})" for t in targets)
    lines += [f"    if ({finite}) {{", "        result.status = Status::ok;", "    }", "    return result;", "}"]
    return "\n".join([*lines, ""])


def domain_test(function: ExportedFunction, names: list[str], s: Spelling) -> list[str]:
    """Comparisons that NaN fails."""
    largest = f"std::numeric_limits<{function.arithmetic.name}>::max()"
    tests = [
        f"({n} >= {bound(i.low, s, largest)}) && ({n} <= {bound(i.high, s, largest)})"
        for i, n in zip(function.inputs, names, strict=True)
    ]
    if not tests:
        return []
    joined = "\n          && ".join(tests)
    return [f"    if (!({joined})) {{", "        result.status = Status::domain;", "        return result;", "    }"]


def regimes(function: ExportedFunction, names: list[str], targets: list[str], s: Spelling) -> list[str]:
    """The formulas of every regime."""
    lines = []
    for place, piece in enumerate(function.pieces):
        temporaries, results = assignments(piece, names, s)
        test = "" if piece.limit is None else f"if ({names[function.switch or 0]} <= {s.number(piece.limit)}) "
        lines.append(f"    {'else ' if place else ''}{test}{{  // {piece.source.claim}")
        lines += [f"        const {function.arithmetic.name} {name} = {text};" for name, text in temporaries]
        lines += [f"        {target} = {text};" for target, text in zip(targets, results, strict=True)]
        lines.append("    }")
    return lines


def parameter(argument: Argument, real: str) -> str:
    """An argument of the C++ function: a number, or a reference to a constant std::array."""
    kind = f"const std::array<{real}, {argument.size}>& " if argument.size else f"{real} "
    return f"{kind}{argument.name}"


def member(output: Output, real: str) -> str:
    """A result as a member of the structure that is returned, zero at first."""
    return f"std::array<{real}, {output.size}> {output.name}{{}}" if output.shape else f"{real} {output.name} = 0"


def bound(x: float, s: Spelling, largest: str) -> str:
    """An end of a range as a number; the largest finite one for infinity."""
    if math.isinf(x):
        return largest if x > 0 else f"-{largest}"
    return s.number(x)


def program(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> str:
    """The program that ctest runs."""
    lines = [f"// {license_}", '#include "navsym_functions.hpp"', "", "#include <cmath>", "#include <cstdio>", ""]
    lines += [test_function(f, tests[f.name]) for f in functions]
    lines += ["int main()", "{", "    int failed = 0;"]
    lines += [f"    failed += test_{f.name}();" for f in functions]
    return "\n".join([*lines, "    return failed;", "}", ""])


def test_function(function: ExportedFunction, found: list[Vector]) -> str:
    """C++ source that runs one function on its vectors."""
    s, n, real = spelling(function.arithmetic.name), len(function.inputs), function.arithmetic.name
    d = spelling("double")

    def wide(part: str) -> str:
        return rows([d.number(x) for v in found for x in (getattr(v, part) or (0.0,) * function.size)])

    accessors = through_accessors(function)
    cast = "static_cast<double>({})" if real == "float" else "{}"
    text = template("cpp_test_function.cpp")
    text = text if n else text.replace("    static const {real} in[] = {{{inputs}}};\n", "")
    return text.format(
        name=function.name,
        real=real,
        size=function.size,
        count=len(found),
        inputs=rows([s.number(x) for v in found for x in v.inputs] or [s.number(0.0)]),
        status=", ".join(str(v.status) for v in found),
        lower=wide("lower"),
        upper=wide("upper"),
        nearest=wide("nearest"),
        call=cpp_through_state(function, real) if function.state else cpp_call(function, real),
        values=", ".join(cast.format(a) for a in accessors),
        epsilon="2.220446049250313e-16" if real == "double" else "1.1920928955078125e-07",
    )


def cpp_call(function: ExportedFunction, real: str) -> str:
    """The call of one vector; arrays are filled from the row."""
    n = len(function.inputs)
    words = []
    for a in function.called_with:
        entries = [f"in[(k * {n}) + {a.first + e}]" for e in range(a.size or 1)]
        words.append(f"std::array<{real}, {a.size}>{{{', '.join(entries)}}}" if a.size else entries[0])
    return f"        const auto result = navsym::{function.name}({', '.join(words)});"


def rows(numbers: list[str]) -> str:
    """Numbers separated by commas, four in a line."""
    return ",\n        ".join(", ".join(numbers[k : k + 4]) for k in range(0, len(numbers), 4))
