"""Octave and MATLAB: what their numbers do otherwise than those of C must not come back as a result."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from numpy.testing import assert_allclose

from navsym.claims import Equation
from navsym.export.functions import function_of
from navsym.export.languages.octave import REAL, files
from navsym.export.languages.targets import TARGETS
from navsym.export.parts import ExportedFunction
from navsym.export.roundtrip import run_target
from tests.export import corruption, programs, samples

LICENSE = "SPDX-License-Identifier: Apache-2.0"
pytestmark = pytest.mark.skipif(TARGETS["octave"].executable() is None, reason="octave is not on this machine")
x, y = sp.symbols("x y", real=True)


def said(folder: Path, functions: list[ExportedFunction], lines: list[str]) -> list[str]:
    """What Octave prints for the lines, in one process beside the exported files."""
    for name, text in files(functions, {f.name: [] for f in functions}, LICENSE).items():
        (folder / name).write_text(text)
    (folder / "navsym_calls.m").write_text("\n".join([*lines, ""]))
    command = [str(TARGETS["octave"].executable()), "--norc", "--no-history", "--quiet", "--eval", "navsym_calls"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0 and not done.stderr, done.stderr
    return done.stdout.split("\n")[:-1]


def test_only_one_real_double_enters_a_number(tmp_path: Path) -> None:
    """int32(1)/2 is 1, single(0.1) is another number, 1 + 2i is not below 3, [1 2] is a matrix."""
    call = samples.by_name("versine").name
    values = ["0.5", "int32(1)", "single(0.5)", "true", "0.5 + 2i", "[0.1 0.2]", "[]", "'a'", "NaN", "Inf", "{1}", "2"]
    lines = [f"[s, v] = {call}({value}); printf('%d %d %s\\n', s, isnan(v), class(v));" for value in values]
    found = said(tmp_path, [samples.by_name("versine")], lines)
    assert found == ["0 0 double", *["1 1 double"] * (len(values) - 1)]


def test_an_array_may_be_a_row_or_a_column_but_no_matrix(tmp_path: Path) -> None:
    """A 3 by 3 matrix has its entries in columns: read as a row of nine it would be its transpose."""
    call = "trajectory_filter_start"
    ways = ["[1 2 3], 1:6", "[1; 2; 3], (1:6)'", "[1 2 3], reshape(1:6, 2, 3)", "[1 2 3], 1:5", "[1 2 3], int8(1:6)"]
    lines = [f"[s, f, P] = {call}({way}); printf('%d %d %d\\n', s, size(P));" for way in ways]
    found = said(tmp_path, list(programs.functions("trajectory-filter")), lines)
    assert found == ["0 6 1", "0 6 1", "1 6 1", "1 6 1", "1 6 1"]


def test_a_matrix_comes_back_as_a_matrix(tmp_path: Path) -> None:
    line = f"[s, R] = {samples.by_name('rotation').name}(2, 0.3); printf('%.17g\\n', R.');"
    (found,) = [said(tmp_path, [samples.by_name("rotation")], [line])]
    c, s = np.cos(0.3), np.sin(0.3)
    ways = [[c, s / 2, -2 * s, c], [np.cos(2.0), np.sin(2.0) / 0.3, -0.3 * np.sin(2.0), np.cos(2.0)]]
    assert any(np.allclose(np.array(found, dtype=float), way, rtol=1e-15) for way in ways)


def test_a_program_keeps_its_state_in_a_structure_and_a_refused_step_leaves_it(tmp_path: Path) -> None:
    series = [0.5, float("nan"), -1.25, 3.0]
    lines = ["[s, state] = trajectory_filter_init([0 0 0], [4 0 0 3 0 2]);"]
    for z in series:
        lines += [
            f"[s, state] = trajectory_filter_step(state, [0.25 0.125 0.0625], 0.5, {z});".replace("nan", "NaN"),
            "printf('%d', s); printf(' %.17g', state.f, state.P); printf('\\n');",
        ]
    found = [row.split() for row in said(tmp_path, list(programs.functions("trajectory-filter")), lines)]
    made = programs.module("trajectory-filter").trajectory_filter([0.0] * 3, [4.0, 0.0, 0.0, 3.0, 0.0, 2.0])
    for z, row in zip(series, found, strict=True):
        if np.isnan(z):
            assert row[0] == "1"
        else:
            made.step([0.25, 0.125, 0.0625], 0.5, z)
            assert row[0] == "0"
        assert_allclose([float(v) for v in row[1:]], [*made.f, *made.P], rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize(
    ("formula", "at"),
    [
        (sp.Abs(sp.sqrt(x)), -1.0),
        (sp.Abs(sp.log(x)), -3.0),
        (sp.acos(x) + 1, 1.5),
        (sp.asin(x) ** 2, -1.5),
        (sp.Abs(x ** sp.Rational(1, 3)), -8.0),
        (sp.Abs(x**y), -8.0),
        (1 / x, 0.0),
        (sp.Max(sp.sqrt(x), 1), -1.0),
    ],
)
def test_what_is_not_real_is_a_status_and_never_a_complex_number(formula, at: float, tmp_path: Path) -> None:
    """abs(sqrt(-1)) is 1 in Octave, which is no value of the formula."""
    function = function_of([samples.of_statement("real", Equation(formula, formula))])
    values = {"x": str(at), "y": "0.5"}
    given = ", ".join(values[i.symbol.name] for i in function.inputs)
    (found,) = said(tmp_path, [function], [f"[s, v] = {function.name}({given}); printf('%d %d\\n', s, isnan(v));"])
    assert found == "2 1"


def test_every_function_that_leaves_the_real_numbers_is_one_of_ours() -> None:
    assert set(REAL) == {"sqrt", "log", "asin", "acos", "pow"}


def test_names_of_matlab_become_arguments_and_functions_of_other_names(tmp_path: Path) -> None:
    names = [
        "arguments",
        "end",
        "methods",
        "persistent",
        "realmax",
        "NaN",
        "Inf",
        "all",
        "isfinite",
        "i",
        "e",
        "gamma",
        "nargin",
        "varargin",
        "ans",
        "eps",
        "zeros",
        "endfunction",
        "spmd",
        "otherwise",
        "classdef",
    ]
    symbols = [sp.Symbol(name, real=True) for name in names]
    left, right = sum(k * s for k, s in enumerate(symbols, 1)), sum(-k * -s for k, s in enumerate(symbols, 1))
    function = function_of([samples.of_statement("words", Equation(left, right))])
    order = [names.index(i.symbol.name) + 1 for i in function.inputs]
    given = ", ".join(str(float(k)) for k in order)
    (found,) = said(tmp_path, [function], [f"[s, v] = {function.name}({given}); printf('%d %.17g\\n', s, v);"])
    assert found == f"0 {sum(k * k for k in order)}"


def test_a_vector_that_is_refused_where_it_should_not_be_is_wrong_and_no_error(tmp_path) -> None:
    place = corruption.exported([samples.by_name("versine")], "octave", tmp_path, 8)
    path = place / f"{samples.by_name('versine').name}.m"
    path.write_text(path.read_text().replace("status = 0;", "status = 2; value = NaN;"))
    outcome = run_target(place, TARGETS["octave"])
    assert outcome.status == "failed" and outcome.functions[path.stem][1] > 4
