"""Rust: one file without dependencies; results come back as ``Result``."""

from __future__ import annotations

from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.printing import Spelling, result_fields
from navsym.export.languages.writer import Writer
from navsym.export.parts import ExportedFunction


def spelling(real: str) -> Spelling:
    """Functions of the primitive type, written out in full, so that no method precedence matters."""
    kind = "f32" if real == "float" else "f64"
    special = {"log": "ln", "expm1": "exp_m1", "pow": "powf"}
    one = "sin cos exp log sqrt asin acos atan sinh cosh tanh expm1 abs".split()
    table = {name: f"{kind}::{special.get(name, name)}({{0}})" for name in one}
    table |= {name: f"{kind}::{special.get(name, name)}({{0}}, {{1}})" for name in ("atan2", "pow", "max", "min")}
    return Spelling(table, f"{kind}::NAN", f"{kind}::INFINITY", f"_{kind}")


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """The module and the test program with its vectors."""
    real = functions[0].arithmetic.name
    kind = "f32" if real == "float" else "f64"
    w = Writer("rust", spelling(real), real, f"{kind}::MAX", f"{kind}::MIN")
    columns = [(f, w.columns(f, tests[f.name], spelling("double"))) for f in functions]
    given = {"license": license_, "kind": kind}
    epsilon = "f64::EPSILON" if real == "double" else "f64::from(f32::EPSILON)"
    return {
        "navsym_functions.rs": w.render("navsym_functions.rs", functions=functions, results=result_fields, **given),
        "test_main.rs": w.render("test_main.rs", vectors=columns, epsilon=epsilon, **given),
    }
