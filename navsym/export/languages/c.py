"""C99: one header and one source for each function, freestanding-friendly, without state or allocation."""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.summary import unit_of
from navsym.export.languages.writer import environment, writer_of
from navsym.export.parts import ExportedFunction, Output
from navsym.export.tools import DEVIATIONS

writer = functools.partial(writer_of, "c")


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """File name -> text of the whole C folder."""
    w, given = writer(functions[0].arithmetic.name), {"license": license_, "functions": functions}
    found = {"navsym_status.h": w.render("navsym_status.h", **given)}
    for f in functions:
        found[f"{f.name}.h"] = header(f, license_)
        found[f"{f.name}.c"] = source(f, license_)
        if f.state:
            found[f"{f.state.program}.h"] = w.render("program.h", license=license_, f=f)
    columns = [(f, w.columns(f, tests[f.name], writer("double").spelling)) for f in functions]
    found["test_vectors.h"] = w.render("test_vectors.h", vectors=columns, **given)
    unit, epsilon = ("2^-52", 2.0**-52) if w.real == "double" else ("2^-23", 2.0**-23)
    found["test_main.c"] = w.render("test_main.c", unit=unit, epsilon=repr(epsilon), **given)
    return found | {
        "CMakeLists.txt": w.render("CMakeLists.txt", **given),
        "MISRA_DEVIATIONS.md": w.render("MISRA_DEVIATIONS.md", license=license_, deviations=DEVIATIONS),
    }


def header(function: ExportedFunction, license_: str) -> str:
    """Declaration with everything a reader must know before calling it."""
    return writer(function.arithmetic.name).render(
        "header.h",
        f=function,
        license=license_,
        signature=signature(function),
        called=called(function),
        arguments=argument_texts(function),
        safe=safe_comment,
        shape_text=shape_text,
    )


def source(function: ExportedFunction, license_: str) -> str:
    """Definition: domain test, the formulas of each regime, finiteness test, results."""
    w = writer(function.arithmetic.name)
    tests = [  # comparisons that NaN fails, one for each argument; |x| alone where the range has no end
        f"({w.absolute(name)} <= {w.largest})"
        if math.isinf(i.low) and math.isinf(i.high)
        else f"({name} >= {low}) && ({name} <= {high})"
        for i, (name, low, high) in zip(function.inputs, w.ends(function), strict=True)
    ]
    return w.render("source.c", f=function, license=license_, signature=signature(function), tests=tests)


def signature(function: ExportedFunction) -> str:
    """The head of the C function, arguments and a pointer for each result, broken where it is long."""
    parts, real = environment().get_template("c/parts.j2").module, function.arithmetic.name
    given = [parts.parameter(a, real) for a in function.called_with]  # type: ignore[attr-defined]
    given += [parts.result(o, real) for o in function.outputs]  # type: ignore[attr-defined]
    line = f"navsym_status {function.name}({', '.join(given) or 'void'})"
    return line if len(line) < 100 else line.replace("(", "(\n    ", 1).replace(", ", ",\n    ")


def called(function: ExportedFunction) -> str:
    """Which functions of the C library the code calls; it needs nothing else of it."""
    known = {text.partition("(")[0] for text in writer(function.arithmetic.name).spelling.calls.values()}
    code = re.sub(r"/\*.*?\*/", "", source(function, ""), flags=re.S)
    found = sorted(set(re.findall(r"\b(\w+)\(", code)) & {n for n in known if "navsym" not in n})
    return f"Calls    {', '.join(found) or 'nothing'}{' of math.h' if found else ''}; no allocation, no state"


def argument_texts(function: ExportedFunction) -> list[tuple[str, str]]:
    """Name, and meaning with unit, of every argument."""
    found = []
    for a in function.called_with:
        entries = function.inputs[a.first : a.first + (a.size or 1)]
        text = ", ".join(i.symbol.name for i in entries) if a.size else entries[0].text
        found.append((a.name, f"{text} [{unit_of(entries[0].unit)}]"))
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
