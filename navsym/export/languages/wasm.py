"""WebAssembly: the C folder with a runner, and a page that calls the functions in a browser."""

from __future__ import annotations

import base64
import importlib.util
import json
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from navsym.core.answers import named
from navsym.core.errors import MissingEngineError
from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.c import files as c_files
from navsym.export.languages.c import writer
from navsym.export.languages.summary import function_record
from navsym.export.parts import ExportedFunction
from navsym.export.processes import run

FLAGS = ("-target", "wasm32-wasi", "-mexec-model=reactor", "-O2", "-s", "-std=c99", "-ffp-contract=off")


def wasm_files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """The C folder with a runner for its WebAssembly."""
    runner = writer(functions[0].arithmetic.name).render("wasm/run_wasi.py", license=license_)
    return c_files(functions, tests, license_) | {"run_wasi.py": runner}


def page_files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """One self-contained page: the compiled functions, their vectors, bounds and verdicts; no network."""
    module = base64.b64encode(compiled(functions, tests, license_)).decode("ascii")
    data = json.dumps([record(f, tests[f.name]) for f in functions], allow_nan=False)
    safe = data.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")
    w = writer(functions[0].arithmetic.name)
    return {"index.html": w.render("wasm/index.html", license=license_, data=safe, module=module)}


def compiled(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> bytes:
    """The module; raises MissingEngineError without ziglang."""
    if importlib.util.find_spec("ziglang") is None:
        raise MissingEngineError("expected ziglang, which compiles to WebAssembly; got none; run pip install ziglang")
    with tempfile.TemporaryDirectory(prefix="navsym-wasm-") as folder:
        for name, text in c_files(functions, tests, license_).items():
            if not name.startswith("test_"):
                (Path(folder) / name).write_text(text, encoding="utf-8")
        # Calls without arguments over one array of numbers: inputs first, results behind them.
        w, widest = writer(functions[0].arithmetic.name), max(len(f.inputs) + f.size for f in functions)
        calls = w.render("wasm/calls.c", functions=functions, widest=widest)
        (Path(folder) / "calls.c").write_text(calls, encoding="utf-8")
        sources = ["calls.c", *(f"{f.name}.c" for f in functions)]
        exports = ["demo_numbers", *(f"demo_{f.name}" for f in functions)]
        words = [*FLAGS, *sources, *(f"-Wl,--export={name}" for name in exports), "-o", "module.wasm", "-lm"]
        status, said = run([sys.executable, "-m", "ziglang", "cc", *words], Path(folder))
        if status != 0:
            raise MissingEngineError(f"expected a working ziglang; got {said.strip()[-160:]!r}; install it again")
        return (Path(folder) / "module.wasm").read_bytes()


def record(function: ExportedFunction, tests: Sequence[Vector]) -> dict[str, Any]:
    """A function as data of the page: what the manifest says of it, a first point, its bounds and its vectors."""
    found, u = function_record(function), 2.0**function.arithmetic.u
    for piece, row in zip(function.pieces, found["pieces"], strict=True):
        row |= {"relative": finite(piece.bound.relative, u), "absolute": finite(piece.bound.absolute, 1.0)}
    return found | {
        "real": function.arithmetic.name,
        "switch": function.switch,
        "start": [i.test_low / 2 + i.test_high / 2 for i in function.inputs],
        "vectors": [named(v, "inputs lower upper nearest") for v in tests if v.status == 0],
    }


def finite(values: Sequence[float], scale: float) -> list[float | None]:
    """Bounds times a scale, rounded up; null where one is not finite."""
    return [x * scale * (1 + 2.0**-40) if x < 1e9 else None for x in values]
