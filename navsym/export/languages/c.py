"""C99: one header and one source for each function, freestanding-friendly, without state or allocation."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.helpers import Helper, helper_about, helper_parts, helpers_used, squares_if_needed
from navsym.export.languages.printing import Spelling, assignments, calls, code_names, template
from navsym.export.languages.programs import c_header, c_through_state, output_places
from navsym.export.languages.summary import summary, unit_of
from navsym.export.parts import Argument, ExportedFunction, Output
from navsym.export.tools import deviations_page


def spelling(real: str) -> Spelling:
    """C with ``double`` or ``float``; float has its own functions, so that nothing is promoted (NAN is a float)."""
    suffix = "f" if real == "float" else ""
    return Spelling(calls(suffix=suffix), f"({real})NAN", f"({real})INFINITY", suffix)


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """File name -> text of the whole C folder."""
    found = {"navsym_status.h": template("c_status.h").format(license=license_)}
    for function in functions:
        found[f"{function.name}.h"] = header(function, license_)
        found[f"{function.name}.c"] = source(function, license_)
        if function.state:
            found[f"{function.state.program}.h"] = c_header(function, license_)
    found["test_vectors.h"] = vectors_header(functions, tests, license_)
    found["test_main.c"] = test_program(functions, tests, license_)
    found["CMakeLists.txt"] = cmake([f.name for f in functions], license_)
    found["MISRA_DEVIATIONS.md"] = deviations_page(license_)
    return found


def parameters(function: ExportedFunction) -> str:
    """Parameters of the C function: arguments, then a pointer for each result."""
    real = function.arithmetic.name
    values = [value_parameter(a, real) for a in function.called_with]
    return ", ".join([*values, *(result_parameter(o, real) for o in function.outputs)]) or "void"


def value_parameter(argument: Argument, real: str) -> str:
    """An argument of the C function: a number, or a constant array."""
    return f"const {real} {argument.name}[{argument.size}]" if argument.size else f"{real} {argument.name}"


def result_parameter(output: Output, real: str) -> str:
    """Where the C function writes a result: a pointer, or an array."""
    return f"{real} {output.name}[{output.size}]" if output.shape else f"{real} *{output.name}"


def signature(function: ExportedFunction) -> str:
    """The head of the C function, broken where it is long."""
    line = f"navsym_status {function.name}({parameters(function)})"
    return line if len(line) < 100 else line.replace("(", "(\n    ", 1).replace(", ", ",\n    ")


def header(function: ExportedFunction, license_: str) -> str:
    """Declaration with everything a reader must know before calling it."""
    params = [f" * @param[in]  {text}" for text in argument_texts(function)]
    params += [f" * @param[out] {o.name}  {shape_text(o)} [{unit_of(o.unit)}]" for o in function.outputs]
    return template("c_header.h").format(
        license=license_,
        guard=f"NAVSYM_{function.name.upper()}_H",
        signature=signature(function),
        title=safe_comment(function.sources[0].title or function.name),
        summary="\n".join(safe_comment(f" * {line}") for line in (*summary(function), called(function))),
        parameters="\n".join(map(safe_comment, params)),
    )


def called(function: ExportedFunction) -> str:
    """Which functions of the C library the code calls; it needs nothing else of it."""
    known = {text.partition("(")[0] for text in spelling(function.arithmetic.name).calls.values()}
    code = re.sub(r"/\*.*?\*/", "", source(function, ""), flags=re.S)
    found = sorted(set(re.findall(r"\b(\w+)\(", code)) & {n for n in known if "navsym" not in n})
    return f"Calls    {', '.join(found) or 'nothing'}{' of math.h' if found else ''}; no allocation, no state"


def argument_texts(function: ExportedFunction) -> list[str]:
    """Name, meaning and unit of every argument."""
    found = []
    for a in function.called_with:
        entries = function.inputs[a.first : a.first + (a.size or 1)]
        text = ", ".join(i.symbol.name for i in entries) if a.size else entries[0].text
        found.append(f"{a.name}  {text} [{unit_of(entries[0].unit)}]")
    return found


def safe_comment(text: str) -> str:
    """Text that cannot end a comment, printable ASCII only."""
    ascii_text = text.encode("ascii", "backslashreplace").decode()
    return ascii_text.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?").replace("\\", "/")


def shape_text(output: Output) -> str:
    """The shape of a result in words, for the documentation."""
    if not output.shape:
        return "scalar"
    return "x".join(map(str, output.shape)) + (", row by row" if len(output.shape) > 1 else " entries")


def source(function: ExportedFunction, license_: str) -> str:
    """Definition: domain test, the formulas of each regime, finiteness test, results."""
    s = spelling(function.arithmetic.name)
    lines = [f"/* {license_} */", f'#include "{function.name}.h"', "", "#include <float.h>", "#include <math.h>", ""]
    for text in helper_texts(function):
        lines += [text, ""]
    lines += [signature(function), "{", *body(function, s), "}", ""]
    return "\n".join(lines)


def helper_texts(*functions: ExportedFunction) -> list[str]:
    """The helper functions that the code needs."""
    real = functions[0].arithmetic.name if functions else "double"
    return [helper_text(helper, real, spelling(real)) for helper in helpers_used(*functions)]


def body(function: ExportedFunction, s: Spelling) -> list[str]:
    """Lines of the definition: test of the domain, pieces, test of the results where it is needed, stores."""
    real = function.arithmetic.name
    largest = "FLT_MAX" if real == "float" else "DBL_MAX"
    lines = [f"    {real} r{k};" for k in range(function.size)]
    lines += ["", *domain_test(function, s, largest)]
    for place, piece in enumerate(function.pieces):
        condition = "" if piece.limit is None else f"if ({switch_name(function)} <= {s.number(piece.limit)}) "
        temporaries, results = assignments(piece, code_names(function), s)
        lines.append(f"    {'else ' if place else ''}{condition}{{ /* {piece.source.claim} */")
        lines += [f"        const {real} {name} = {text};" for name, text in temporaries]
        lines += [f"        r{k} = {text};" for k, text in enumerate(results)]
        lines.append("    }")
    if function.always_finite:
        lines.append("    /* Proved: no operation overflows in the domain, so that the results need no test. */")
    else:
        tests = (f"({s.calls['abs'].format(f'r{k}')} <= {largest})" for k in range(function.size))
        finite = "\n          && ".join(tests)
        lines += [f"    if (!({finite})) {{", "        return NAVSYM_NOT_FINITE;", "    }"]
    return [*lines, *stores(function), "    return NAVSYM_OK;"]


def switch_name(function: ExportedFunction) -> str:
    """Name of the input that decides between the pieces."""
    assert function.switch is not None, "a limit needs the input that switches"
    return function.inputs[function.switch].name


def domain_test(function: ExportedFunction, s: Spelling, largest: str) -> list[str]:
    """Comparisons that NaN fails; one line for each argument."""
    tests = []
    for i, name in zip(function.inputs, code_names(function), strict=True):
        if math.isinf(i.low) and math.isinf(i.high):
            tests.append(f"({s.calls['abs'].format(name)} <= {largest})")
            continue
        low = s.number(i.low) if math.isfinite(i.low) else f"-{largest}"
        high = s.number(i.high) if math.isfinite(i.high) else largest
        tests.append(f"({name} >= {low}) && ({name} <= {high})")
    if not tests:
        return []
    joined = "\n          && ".join(tests)
    return [f"    if (!({joined})) {{", "        return NAVSYM_DOMAIN;", "    }"]


def stores(function: ExportedFunction) -> list[str]:
    """Lines that write the local results r0, r1, ... to where the caller wants them."""
    lines, k = [], 0
    for output in function.outputs:
        for entry in range(output.size):
            target = f"{output.name}[{entry}]" if output.shape else f"*{output.name}"
            lines.append(f"    {target} = r{k};")
            k += 1
    return lines


def helper_text(helper: Helper, real: str, s: Spelling, kind: str = "static") -> str:
    """One helper; ``kind`` is ``inline`` in a header of C++."""
    switch, below, above = helper_parts(helper, s)
    return "\n".join(
        [
            f"/* {helper_about(helper, s)} */",
            f"{kind} {real} navsym_{helper.name}({real} x)",
            "{",
            *squares_if_needed(helper, f"    const {real} y = x * x;"),
            f"    if ({s.calls['abs'].format('x')} < {switch}) {{",
            f"        return {below};",
            "    }",
            f"    return {above};",
            "}",
        ]
    )


# -- vectors, test program, build ---------------------------------------


def vectors_header(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> str:
    """Constant arrays: arguments, status, lower and upper bounds, nearest values."""
    lines = [f"/* {license_} */", "/* Bounds are rigorous enclosures widened by the derived rounding error. */"]
    lines += ["#ifndef NAVSYM_TEST_VECTORS_H", "#define NAVSYM_TEST_VECTORS_H", "", "#include <math.h>", ""]
    for function in functions:
        found, n = tests[function.name], len(tests[function.name])
        lines.append(f"#define {function.name}_COUNT {n}")
        if function.inputs:
            inputs = [x for v in found for x in v.inputs]
            lines += array_text(
                function.arithmetic.name, f"{function.name}_in", inputs, spelling(function.arithmetic.name)
            )
        lines.append(f"static const int {function.name}_status[] = {{{', '.join(str(v.status) for v in found)}}};")
        for part in ("lower", "upper", "nearest"):
            values = [x for v in found for x in (getattr(v, part) or (0.0,) * function.size)]
            lines += array_text("double", f"{function.name}_{part}", values, spelling("double"))
        lines.append("")
    return "\n".join([*lines, "#endif", ""])


def array_text(kind: str, name: str, values: Sequence[float], s: Spelling) -> list[str]:
    """A constant array, four numbers on a line."""
    numbers = [s.number(x) for x in values] or ["0" + (".0f" if s.suffix else ".0")]
    rows = [", ".join(numbers[k : k + 4]) for k in range(0, len(numbers), 4)]
    return [f"static const {kind} {name}[] = {{", ",\n".join(f"    {row}" for row in rows), "};"]


def test_program(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> str:
    """The program that ctest runs."""
    real = functions[0].arithmetic.name
    return template("c_test_main.c").format(
        license=license_,
        includes="\n".join(f'#include "{f.state.program if f.state else f.name}.h"' for f in functions),
        unit="2^-52" if real == "double" else "2^-23",
        epsilon="2.220446049250313e-16" if real == "double" else "1.1920928955078125e-07",
        tests="\n".join(text for f in functions for text in (*c_through_state(f), test_function(f))),
        calls="\n".join(f"    failed += test_{f.name}();" for f in functions),
    )


def test_function(function: ExportedFunction) -> str:
    """C source that runs one function on its vectors."""
    n, real = len(function.inputs), function.arithmetic.name
    arguments = []
    for a in function.called_with:
        arguments.append(f"{'&' if a.size else ''}{function.name}_in[(k * {n}) + {a.first}]")
    arguments += [f"&r[{place}]" for place in output_places(function)]
    zero = "0.0f" if real == "float" else "0.0"
    return template("c_test_function.c").format(
        name=function.name,
        size=function.size,
        real=real,
        zero=zero,
        arguments=", ".join(arguments),
        call=f"through_{function.name}" if function.state else function.name,
    )


def cmake(names: Sequence[str], license_: str) -> str:
    """Library and test with all warnings as errors."""
    sources = "\n".join(f"    {name}.c" for name in names)
    return f"""# {license_}
cmake_minimum_required(VERSION 3.10)
project(navsym_export C)

set(CMAKE_C_STANDARD 99)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)

add_library(navsym_export STATIC
{sources}
)
target_include_directories(navsym_export PUBLIC ${{CMAKE_CURRENT_SOURCE_DIR}})
if(CMAKE_C_COMPILER_ID MATCHES "GNU|Clang")
    target_compile_options(navsym_export PRIVATE
        -Wall -Wextra -Wconversion -Wdouble-promotion -pedantic -Werror)
    target_link_libraries(navsym_export PUBLIC m)
endif()

enable_testing()
add_executable(test_main test_main.c)
target_link_libraries(test_main navsym_export)
add_test(NAME vectors COMMAND test_main)
"""
