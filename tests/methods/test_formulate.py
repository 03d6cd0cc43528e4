"""The grid problem in files, read back by the solvers that they are written for."""

from __future__ import annotations

import highspy
import numpy as np
import pytest
import sympy as sp

from navsym.errors import DomainError
from navsym.methods.guaranteed.formulate import FORMATS, KINDS, formulate, grid_of
from navsym.methods.guaranteed.problem import from_regressors

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
    path.write_text(formulate(parabola(), "mps", count=41))
    assert value_of(path) == pytest.approx(8.0, rel=1e-7)


def test_the_quadratic_mps_file_has_the_variance_of_least_squares(tmp_path):
    path = tmp_path / "q.mps"
    path.write_text(formulate(parabola(), "mps", kind="qp", count=41))
    grid = grid_of(parabola(), 41)
    gram = (grid.regressors * grid.spacing) @ grid.regressors.T
    assert 2 * value_of(path) == pytest.approx(np.linalg.inv(gram)[2, 2], rel=1e-5)


@pytest.mark.parametrize("to", FORMATS)
@pytest.mark.parametrize("kind", KINDS)
def test_every_format_and_kind_is_written(to, kind):
    text = formulate(parabola(), to, kind=kind, count=5)
    assert text.endswith("\n")
    if to != "mps":
        compile(text, "formulated", "exec")


def test_unknown_formats_and_empty_grids_are_refused():
    with pytest.raises(DomainError, match="expected one of"):
        formulate(parabola(), "gams")
    with pytest.raises(DomainError, match="2 to 100000"):
        formulate(parabola(), "mps", count=1)
