"""A model checks itself once, copies what it was given, and refuses what is not exact."""

import pytest
import sympy as sp

from navsym.core.errors import DomainError, DuplicateError, EmptyError, NotFiniteError, ShapeError
from navsym.models.linear import LinearModel, observability_matrix

w, t = sp.Symbol("w", positive=True), sp.Symbol("t", real=True)


def oscillator(**changes):
    given = {"F": [[0, 1], [-(w**2), 0]], "H": [[1, 0]], "states": ("x", "v")}
    return LinearModel(**(given | changes))


def test_a_model_from_lists_has_immutable_matrices_and_names():
    model = oscillator()
    assert model.F.tolist() == [[0, 1], [-(w**2), 0]]
    assert model.G.shape == (2, 0)
    assert (model.size, model.measurements, model.parameters, model.constant) == (2, ("z1",), (w,), True)
    with pytest.raises(TypeError):
        model.F[0, 0] = 1


def test_the_callers_matrix_stays_the_callers():
    F = sp.Matrix([[0, 1], [0, 0]])
    model = LinearModel(F)
    F[0, 0] = 5
    assert model.F[0, 0] == 0
    assert model.states == ("x1", "x2")


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"F": [[0, 1]]}, ShapeError, "F: expected shape"),
        ({"F": [[0, 1], [2]]}, ShapeError, "rows of one length"),
        ({"F": []}, EmptyError, "no rows"),
        ({"F": sp.Matrix.zeros(0, 0)}, EmptyError, "no rows"),
        ({"H": [[1, 0, 0]]}, ShapeError, "H: expected shape"),
        ({"G": [[1]]}, ShapeError, "G: expected shape"),
        ({"states": ("x",)}, ShapeError, "expected 2 names"),
        ({"states": ("x", "x")}, DuplicateError, "'x' twice"),
        ({"F": [[0, 0.1], [0, 0]]}, DomainError, "sp.Rational"),
        ({"F": [[0, sp.Float("0.1") * w], [0, 0]]}, DomainError, "sp.Rational"),
        ({"F": [[0, "1"], [0, 0]]}, DomainError, "exact number"),
        ({"F": [[0, "__import__('os')"], [0, 0]]}, DomainError, "exact number"),
        ({"F": [[0, object()], [0, 0]]}, DomainError, "expected a number"),
        ({"F": [[0, sp.oo], [0, 0]]}, NotFiniteError, r"F\[0, 1\]"),
        ({"F": [[0, sp.nan], [0, 0]]}, NotFiniteError, "finite"),
    ],
)
def test_what_makes_no_model_is_refused_with_its_place(changes, error, message):
    with pytest.raises(error, match=message):
        oscillator(**changes)


def test_substitution_comes_before_derivation():
    assert oscillator().at({w: 0}).F.tolist() == [[0, 1], [0, 0]]
    with pytest.raises(NotFiniteError):
        oscillator(F=[[0, 1 / w], [0, 0]]).at({w: 0})
    with pytest.raises(DomainError):
        oscillator().at({w: 0.5})


def test_the_observability_matrix_of_a_constant_model_is_kalmans():
    model = oscillator(F=[[0, 1], [-(w**2), -2]])
    F, H = model.F, model.H
    assert observability_matrix(model) == sp.Matrix.vstack(H, H * F)


def test_the_observability_matrix_of_a_varying_model_holds_the_derivatives_of_the_measurement():
    model = LinearModel([[0, t], [1, sp.sin(t)]], H=[[1, t**2]], time=t)
    x = sp.Matrix([sp.Function("x1")(t), sp.Function("x2")(t)])
    motion = dict(zip(x.diff(t), model.F * x, strict=True))
    z = (model.H * x)[0]
    rate = z.diff(t).subs(motion)
    assert (observability_matrix(model) * x - sp.Matrix([z, rate])).applyfunc(sp.expand) == sp.zeros(2, 1)
