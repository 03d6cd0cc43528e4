"""The grid problem in files, read back by the solvers that they are written for."""

from __future__ import annotations

import ast
import runpy

import highspy
import numpy as np
import pytest
import sympy as sp

from navsym.core.errors import DomainError
from navsym.guaranteed.convex import grid_problem
from navsym.guaranteed.formulate import FORMATS, KINDS, formulation_text
from navsym.guaranteed.problem import from_regressors

t = sp.Symbol("t", real=True)


def parabola():
    return from_regressors([[1, t, t**2]], [0, 0, 1], t, (0, 1))


def value_of(path):
    solver = highspy.Highs()
    solver.setOptionValue("output_flag", False)
    solver.readModel(str(path))
    solver.run()
    return solver.getInfo().objective_function_value


def test_the_mps_file_has_the_optimum_of_the_parabola(tmp_path):
    path = tmp_path / "p.mps"
    path.write_text(formulation_text(parabola(), "mps", count=41))
    assert value_of(path) == pytest.approx(8.0, rel=1e-7)


def test_the_quadratic_mps_file_has_the_variance_of_least_squares(tmp_path):
    path = tmp_path / "q.mps"
    path.write_text(formulation_text(parabola(), "mps", kind="qp", count=41))
    grid = grid_problem(parabola(), 41)
    gram = (grid.regressors * grid.spacing) @ grid.regressors.T
    assert 2 * value_of(path) == pytest.approx(np.linalg.inv(gram)[2, 2], rel=1e-5)


@pytest.mark.parametrize("to", FORMATS)
@pytest.mark.parametrize("kind", KINDS)
def test_every_format_and_kind_is_written(to, kind):
    text = formulation_text(parabola(), to, kind=kind, count=5)
    assert text.endswith("\n")
    if to != "mps":
        compile(text, "formulated", "exec")


@pytest.mark.parametrize("to", ["casadi", "cvxpy"])
@pytest.mark.parametrize(("kind", "value"), [("lp", 8.0), ("qp", None)])
def test_a_written_program_runs_and_prints_the_value_and_the_weights_as_plain_numbers(to, kind, value, tmp_path, capfd):
    path = tmp_path / "program.py"
    path.write_text(formulation_text(parabola(), to, kind=kind, count=21))
    runpy.run_path(str(path), run_name="__main__")
    number, _, rows = capfd.readouterr().out.strip().splitlines()[-1].partition(" ")
    if value is None:
        grid = grid_problem(parabola(), 21)
        value = np.linalg.inv((grid.regressors * grid.spacing) @ grid.regressors.T)[2, 2] / 2
    assert float(number) == pytest.approx(value, rel=1e-6)
    weights = ast.literal_eval(rows)
    assert sum(t**2 * w for t, w in weights) == pytest.approx(1.0, rel=1e-4)


def test_unknown_formats_and_empty_grids_are_refused():
    with pytest.raises(DomainError, match="expected one of"):
        formulation_text(parabola(), "gams")
    with pytest.raises(DomainError, match="2 to 100000"):
        formulation_text(parabola(), "mps", count=1)
