"""casadi: the independent second source. Its own translator and its own C generator, no printer of ours.

The order of its operations is not ours, so the rounding error in its vectors is multiplied by a stated factor
(``targets.py``). A part with a hole at zero is ``if_else`` of its proved polynomial and its plain form; a constant is
left out.
"""

from __future__ import annotations

import contextlib
import json
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import sympy as sp

from navsym.core.casadi_functions import Memo, by_distance, column_function, declare_inputs, translate
from navsym.export.accuracy.continuation import continuation, horner
from navsym.export.accuracy.vectors import Vector
from navsym.export.atoms import expm1, filled
from navsym.export.holes import Part, T, part_of
from navsym.export.languages.writer import environment, vectors_json
from navsym.export.parts import ExportedFunction, Piece


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """Serialised functions, their generated C, vectors and test."""
    found: dict[str, str] = {}
    index = {}
    functions = [f for f in functions if f.inputs]
    tests = {f.name: [v for v in tests[f.name] if v.status == 0] for f in functions}
    for function in functions:
        pieces = []
        for place, piece in enumerate(function.pieces):
            name = f"f{place}_{function.name.strip('_')}"[:60].replace("__", "_").rstrip("_")
            made = function_of_piece(name, [i.symbol for i in function.inputs], piece)
            found[f"{name}.casadi"] = made.serialize()
            found[f"{name}.c"] = generated(made, name)
            pieces.append({"file": f"{name}.casadi", "limit": piece.limit})
        index[function.name] = {"switch": function.switch, "pieces": pieces}
    return found | {
        "pieces.json": json.dumps(index, indent=2) + "\n",
        "vectors.json": vectors_json(functions, tests),
        "test_vectors.py": environment().get_template("casadi/test_vectors.py.j2").render(license=license_),
    }


def function_of_piece(name: str, symbols: Sequence[sp.Symbol], piece: Piece) -> Any:
    """One regime in casadi's own operations, from its formulas."""
    inputs, memo = declare_inputs(symbols)
    for symbol, _, form in piece.lets:
        memo[symbol] = in_casadi(form, memo)
    return column_function(name, inputs, [in_casadi(form, memo) for form in piece.forms])


def in_casadi(form: sp.Expr, memo: Memo) -> Any:
    """A formula in casadi's operations; its parts with a hole are put into the table first, inner ones before outer."""
    form = form.replace(expm1, lambda x: sp.exp(x) - 1)
    for part in sp.postorder_traversal(form):
        if isinstance(part, filled) and part not in memo:
            memo[part] = without_hole(part_of(part), translate(part.args[2], memo))
    return translate(form, memo)


def without_hole(part: Part, t: Any) -> Any:
    """The polynomial of the part below its switch, its plain form above it."""
    proved = continuation(part, "double")
    below = t**proved.power * horner([int(c.p) / int(c.q) for c in proved.polynomial], t)
    above = translate(part.plain, {T: t})
    for _ in range(part.divided):
        above = above / t
    return by_distance(t, proved.switch, below, above)


def generated(function: Any, name: str) -> str:
    """The C that casadi generates; it writes into the working directory and nowhere else."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        function.generate(f"{name}.c")
        return Path(f"{name}.c").read_text(encoding="utf-8")
