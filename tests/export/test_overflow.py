"""An intermediate value that overflows comes back as a status, also where a division would make a zero of it."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

from navsym.claims import Equation
from navsym.errors import DomainError
from navsym.export.accuracy.sweep import compiled_c, sweep_c
from navsym.export.accuracy.vectors import vectors
from navsym.export.functions import ExportedFunction, function_of
from navsym.export.languages.python import files as python_files
from navsym.export.languages.targets import TARGETS

x, y = sp.symbols("x y", real=True)
COMPILER = pytest.mark.skipif(TARGETS["c"].executable() is None, reason="needs a C compiler")
HUGE = sp.Integer(10) ** 300
#: Formula, largest argument, one where nothing overflows and one where a hidden value does.
HIDDEN = {
    "cube": (1 / (1 + x**3 / HUGE), 10**200, 1e90, 1e120),
    "angle": (sp.atan2(sp.Integer(1), x**3 / HUGE + 1), 10**200, 1e90, 1e120),
    "power": ((1 + x**3) ** sp.Rational(-1, 7), 10**200, 1e90, 1e120),
    "quotient": (sp.atan(x**2 + x) / (x**2 + x) + 1 / (2 + x**4), 10**100, 1e70, 1e90),
}


def function(samples, name: str, real: str = "double") -> ExportedFunction:
    formula, most, _, _ = HIDDEN[name]
    return function_of([samples.of_statement(name, Equation(formula, formula, {x: (1, most)}))], real=real)


@COMPILER
@pytest.mark.parametrize("name", HIDDEN)
def test_a_hidden_overflow_is_a_status_and_not_a_number(samples, name: str, tmp_path: Path) -> None:
    made, (_, _, small, large) = function(samples, name), HIDDEN[name]
    (call,) = compiled_c([made], tmp_path)
    statuses, _ = call(np.array([[small, large]]))
    assert statuses.tolist() == [0, 2]
    (found,) = sweep_c([made], 256).values()
    assert found.wrong == 0 and found.undefined


def test_numpy_says_so_as_well(samples, tmp_path: Path) -> None:
    made = function(samples, "cube")
    file = tmp_path / "navsym_functions.py"
    file.write_text(python_files([made], {made.name: vectors(made, 4)}, "")["navsym_functions.py"])
    spec = importlib.util.spec_from_file_location("navsym_functions_of_overflow", file)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    call = getattr(module, made.name)
    with np.errstate(all="ignore"):
        assert float(call(1e90)) == pytest.approx(1 / (1 + 1e270 / 1e300))
        with pytest.raises(ArithmeticError):
            call(1e120)


@pytest.mark.parametrize("real", ["double", "float"])
def test_what_cannot_overflow_is_not_asked_for(samples, real: str) -> None:
    assert not any(piece.graph.guards for f in samples.functions(real) for piece in f.pieces)


def test_the_bound_of_a_declared_range_holds_on_all_of_it(samples) -> None:
    """A finite end is where vectors and bounds end, however far it is; only a missing one is replaced."""
    made = function_of([samples.of_statement("far", Equation(x * y, y * x, {x: (0, 10**9), y: (-(10**7), 5)}))])
    assert [(i.low, i.high) for i in made.inputs] == [(i.test_low, i.test_high) for i in made.inputs]
    assert max(v.inputs[0] for v in vectors(made, 40) if v.status == 0) == 1e9


@pytest.mark.parametrize(("real", "size"), [("double", 400), ("float", 60)])
def test_a_constant_that_the_type_does_not_have_is_refused(samples, real: str, size: int) -> None:
    formula = sp.Integer(10) ** size * x
    with pytest.raises(DomainError, match="rescale"):
        function_of([samples.of_statement("large", Equation(formula, formula, {x: (0, 1)}))], real=real)


#: Formula with no declared range, a point where its value is plain, and one where a hidden value is none.
UNDECLARED = {
    "gain": (x / (x + y), (1.0, 3.0), (1.5e308, 1.5e308)),
    "root": (sp.Max(sp.sqrt(x), 1) + y, (4.0, 0.0), (-1.0, 0.0)),
    "ratio": (1 / (1 + x**2 * y**2), (1.0, 2.0), (1e200, 1e-3)),
}


@COMPILER
@pytest.mark.parametrize("name", UNDECLARED)
def test_far_outside_of_an_undeclared_range_there_is_a_status_and_no_wrong_number(samples, name, tmp_path) -> None:
    """Bounds are stated up to a thousand there, but a call with 1e308 must not give zero for a half."""
    formula, good, bad = UNDECLARED[name]
    made = function_of([samples.of_statement(name, Equation(formula, formula))])
    (call,) = compiled_c([made], tmp_path)
    given = {"x": (good[0], bad[0]), "y": (good[1], bad[1])}
    statuses, _ = call(np.array([given[i.symbol.name] for i in made.inputs]))
    assert statuses.tolist() == [0, 2]
