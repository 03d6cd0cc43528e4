"""Rust: one file without dependencies; results come back as ``Result``."""

from __future__ import annotations

import math
from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.helpers import Helper, helper_parts, helpers_used, squares_if_needed
from navsym.export.languages.printing import Spelling, assignments, code_names, result_fields, template
from navsym.export.languages.programs import rust_program, rust_through_state, through_accessors
from navsym.export.languages.summary import summary
from navsym.export.parts import Argument, ExportedFunction, Output


def spelling(real: str) -> Spelling:
    """Functions of the primitive type, written out in full, so that no method precedence matters."""
    kind = rust_type(real)
    special = {"log": "ln", "expm1": "exp_m1", "pow": "powf"}
    one = "sin cos exp log sqrt asin acos atan sinh cosh tanh expm1 abs".split()
    table = {name: f"{kind}::{special.get(name, name)}({{0}})" for name in one}
    table |= {name: f"{kind}::{special.get(name, name)}({{0}}, {{1}})" for name in ("atan2", "pow", "max", "min")}
    return Spelling(table, f"{kind}::NAN", f"{kind}::INFINITY", f"_{kind}")


def rust_type(real: str) -> str:
    """f32 for float, f64 for double."""
    return "f32" if real == "float" else "f64"


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """The module and the test program with its vectors."""
    return {"navsym_functions.rs": module(functions, license_), "test_main.rs": program(functions, tests, license_)}


def module(functions: Sequence[ExportedFunction], license_: str) -> str:
    """The text of the module: status, helpers, functions."""
    real = functions[0].arithmetic.name
    s, kind = spelling(real), rust_type(real)
    lines = [
        f"// {license_}",
        "//! Functions exported by navsym.",
        "#![allow(non_snake_case, non_camel_case_types, dead_code)]",
        "",
    ]
    lines += ["/// Why there is no result.", "#[derive(Clone, Copy, Debug, PartialEq, Eq)]"]
    lines += ["pub enum Status {", "    Domain = 1,", "    NotFinite = 2,", "}", ""]
    lines += [helper_text(helper, kind, s) for helper in helpers_used(*functions)]
    return "\n".join([*lines, *(text for f in functions for text in (source(f, s, kind), *rust_program(f, kind)))])


def source(function: ExportedFunction, s: Spelling, kind: str) -> str:
    """Result structure and function."""
    names = code_names(function)
    lines = ["#[derive(Clone, Copy, Debug)]", f"pub struct {function.name}_result {{"]
    lines += [f"    pub {o.name}: {member(o, kind)}," for o in function.outputs] + ["}", ""]
    lines += [f"/// {line}" for line in ("```text", *summary(function), "```")]
    arguments = ", ".join(parameter(a, kind) for a in function.called_with)
    lines.append(f"pub fn {function.name}({arguments}) -> Result<{function.name}_result, Status> {{")
    tests = [
        f"({n} >= {bound(i.low, s, kind)}) && ({n} <= {bound(i.high, s, kind)})"
        for i, n in zip(function.inputs, names, strict=True)
    ]
    if tests:
        lines += [f"    if !({' && '.join(tests)}) {{", "        return Err(Status::Domain);", "    }"]
    lines.append(f"    let nv_r: [{kind}; {function.size}];")
    for place, piece in enumerate(function.pieces):
        temporaries, results = assignments(piece, names, s)
        test = "" if piece.limit is None else f"if {names[function.switch or 0]} <= {s.number(piece.limit)} "
        lines.append(f"    {'else ' if place else ''}{test}{{ // {piece.source.claim}")
        lines += [f"        let {name}: {kind} = {text};" for name, text in temporaries]
        lines += ["        nv_r = [", *(f"            {text}," for text in results), "        ];", "    }"]
    lines += ["    if !nv_r.iter().all(|x| x.is_finite()) {", "        return Err(Status::NotFinite);", "    }"]
    return "\n".join([*lines, f"    Ok({function.name}_result {{ {result_fields(function, 'nv_r[{}]')} }})", "}", ""])


def parameter(argument: Argument, kind: str) -> str:
    """An argument of the Rust function: a number, or a reference to an array."""
    return f"{argument.name}: &[{kind}; {argument.size}]" if argument.size else f"{argument.name}: {kind}"


def member(output: Output, kind: str) -> str:
    """Type of a result in the structure that is returned."""
    return f"[{kind}; {output.size}]" if output.shape else kind


def bound(x: float, s: Spelling, kind: str) -> str:
    """An end of a range as a number; the largest or smallest finite one for infinity."""
    if math.isinf(x):
        return f"{kind}::MAX" if x > 0 else f"{kind}::MIN"
    return s.number(x)


def helper_text(helper: Helper, kind: str, s: Spelling) -> str:
    """One function against cancellation."""
    switch, below, above = helper_parts(helper, s)
    return "\n".join(
        [
            f"fn navsym_{helper.name}(x: {kind}) -> {kind} {{",
            *squares_if_needed(helper, "    let y = x * x;"),
            f"    if {kind}::abs(x) < {switch} {{",
            f"        return {below};",
            "    }",
            f"    {above}",
            "}",
            "",
        ]
    )


def program(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> str:
    """The test program."""
    lines = [f"// {license_}", "#![allow(non_snake_case, unused_variables, clippy::all)]", "mod navsym_functions;"]
    lines += ["use navsym_functions::*;", ""]
    lines += [test_function(f, tests[f.name]) for f in functions]
    lines += ["fn main() {", "    let mut failed = 0;"]
    lines += [f"    failed += test_{f.name}();" for f in functions]
    return "\n".join([*lines, "    std::process::exit(failed);", "}", ""])


def test_function(function: ExportedFunction, found: list[Vector]) -> str:
    """Rust source that runs one function on its vectors."""
    real = function.arithmetic.name
    s, d, n, kind = spelling(real), spelling("double"), len(function.inputs), rust_type(real)

    def wide(part: str) -> str:
        return ", ".join(d.number(x) for v in found for x in (getattr(v, part) or (0.0,) * function.size))

    accessors = through_accessors(function)
    return template("rust_test_function.rs").format(
        name=function.name,
        kind=kind,
        size=function.size,
        count=len(found),
        total=len(found) * function.size,
        inputs_size=len(found) * n,
        inputs=", ".join(s.number(x) for v in found for x in v.inputs),
        status=", ".join(str(v.status) for v in found),
        lower=wide("lower"),
        upper=wide("upper"),
        nearest=wide("nearest"),
        call=rust_through_state(function) if function.state else rust_call(function),
        found="(result, s)" if function.state else "result",
        values=", ".join(f"f64::from({a})" if real == "float" else a for a in accessors),
        epsilon="f64::EPSILON" if real == "double" else "f64::from(f32::EPSILON)",
    )


def rust_call(function: ExportedFunction) -> str:
    """The call of one vector; arrays are filled from the row."""
    n = len(function.inputs)
    words = []
    for a in function.called_with:
        entries = [f"input[k * {n} + {a.first + e}]" for e in range(a.size or 1)]
        words.append(f"&[{', '.join(entries)}]" if a.size else entries[0])
    return f"{function.name}({', '.join(words)})"
