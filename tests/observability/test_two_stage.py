"""Gains and running observers, against characteristic polynomials and equations."""

from __future__ import annotations

import random

import numpy as np
import pytest
import sympy as sp

import navsym as nav
from navsym.core.errors import DomainError, ShapeError
from navsym.models.linear import LinearModel
from navsym.observability.chains import observe_jointly
from navsym.observability.splits import choose_split, companion
from navsym.observability.two_stage import (
    POLE,
    companion_gains,
    gains_by_poles,
    hurwitz_minors,
    monic_coefficients,
    stability,
)
from navsym_papers.joint_correction.experiment.observer import (
    hold_measurements,
    observer_loop,
    observer_of,
    two_stage_blocks,
)
from navsym_papers.joint_correction.matrices import unit_row

p = POLE
lam, nu = sp.symbols("lam nu", positive=True)
a, b = sp.symbols("a b", real=True)
OVERLAP = LinearModel([[0, 1, 0, 0], [0, 0, 1, 0], [a, b, 0, 0], [0, 0, 1, -1]], None, [[1, 0, 0, 0], [0, 0, 0, 1]])


def polynomial(matrix: sp.MatrixBase) -> sp.Expr:
    return sp.expand((p * sp.eye(matrix.rows) - matrix).det(method="berkowitz"))


@pytest.mark.parametrize("m", [1, 2, 3, 4, 5])
def test_gains_by_recursion_give_the_wanted_polynomial_for_every_theta(m):
    theta, wanted = sp.symbols(f"theta1:{m + 1}"), sp.symbols(f"c1:{m + 1}")
    gains = companion_gains(theta, wanted)
    error = companion(theta) - sp.Matrix(gains) * unit_row(m)
    assert polynomial(error) == sp.expand(p**m + sum(c * p ** (m - 1 - k) for k, c in enumerate(wanted)))


def test_both_stages_get_their_polynomials_and_the_whole_their_product():
    chosen = choose_split(observe_jointly(OVERLAP))
    found = gains_by_poles(chosen, (p + lam) ** 3, p + nu)
    assert found.stable == (True, True)
    blocks = two_stage_blocks(chosen)
    assert polynomial(blocks.G_x - sp.Matrix(found.K_x) * blocks.g_x) == sp.expand((p + lam) ** 3)
    assert polynomial(blocks.G_z2 - sp.Matrix(found.K_z) * blocks.g_z2) == p + nu


def test_errors_of_the_running_observer_decay_as_prescribed_and_a_held_step_is_exact():
    A, B = observer_loop(running())
    roots = np.sort(np.linalg.eigvals(A).real)
    assert np.abs(roots - np.sort([-2.0, -2.0, -2.0, -3.0])).max() < 1e-4
    Phi, Gamma = hold_measurements(A, B, 0.2)
    fine_Phi, fine_Gamma = hold_measurements(A, B, 0.1)
    assert np.abs(Phi - fine_Phi @ fine_Phi).max() < 1e-12
    assert np.abs(Gamma - fine_Phi @ fine_Gamma - fine_Gamma).max() < 1e-12
    assert np.abs(A @ Gamma - (Phi - np.eye(4)) @ B).max() < 1e-12


@pytest.mark.parametrize(
    ("text", "stable"),
    [
        ((p + 1) ** 3, True),
        (p**2 + 1, False),
        (p**2 - p + 1, False),
        ((p + lam) ** 2, True),
        ((p - lam) ** 2, False),
        (p * (p + 1), False),
        (p**2 + a * p + 1, None),
        (p**3 + p**2 + p + 1, False),
        ((p + lam) * (p + nu) ** 2, True),
    ],
)
def test_stability_is_decided_by_hurwitz_and_declared_signs(text, stable):
    degree = sp.degree(sp.expand(text), p)
    assert stability(monic_coefficients(sp.expand(text), degree)) is stable


def test_hurwitz_agrees_with_the_roots_of_random_polynomials():
    source = random.Random(3)
    for _ in range(60):
        values = [sp.Rational(source.randint(-4, 9), source.randint(1, 3)) for _ in range(source.randint(1, 5))]
        roots = np.roots([1.0, *map(float, values)])
        if np.abs(roots.real).min() < 1e-6:
            continue
        assert stability(values) is bool((roots.real < 0).all())


def test_minors_of_a_cubic_are_the_classical_ones():
    c1, c2, c3 = sp.symbols("c1:4")
    assert [sp.expand(m) for m in hurwitz_minors((c1, c2, c3))] == [
        c1,
        sp.expand(c1 * c2 - c3),
        sp.expand(c3 * (c1 * c2 - c3)),
    ]


def test_wrong_poles_are_refused():
    chosen = choose_split(observe_jointly(OVERLAP))
    with pytest.raises(ShapeError, match="degree 3"):
        gains_by_poles(chosen, (p + lam) ** 2, p + nu)
    with pytest.raises(DomainError, match="left half-plane"):
        gains_by_poles(chosen, (p + lam) ** 3, p - 1)
    with pytest.raises(DomainError, match="polynomial in p"):
        gains_by_poles(chosen, (p + lam) ** 3, 1 / (p + nu))
    with pytest.raises(ShapeError, match="two polynomials"):
        gains_by_poles(chosen, (p + lam) ** 3, None)


VALUES = {a: -1, b: sp.Rational(-1, 2), lam: 2, nu: 3}


def running() -> object:
    chosen = choose_split(observe_jointly(OVERLAP))
    found = gains_by_poles(chosen, (p + lam) ** 3, p + nu)
    return observer_of(two_stage_blocks(chosen), found.K_x, found.K_z, VALUES)


def test_a_symbol_without_a_value_is_named():
    chosen = choose_split(observe_jointly(OVERLAP))
    found = gains_by_poles(chosen, (p + lam) ** 3, p + nu)
    with pytest.raises(DomainError, match="nu"):
        observer_of(two_stage_blocks(chosen), found.K_x, found.K_z, {a: 1, b: 1, lam: 1})


def observer_matrix(model, stages):
    """L F L^-1 minus the gains: the error of the running estimator in the coordinates of all stages."""
    L = sp.Matrix.vstack(*(stage.rows for stage in stages))
    moved = sp.Matrix((L * model.F * L.inv()).applyfunc(sp.cancel))
    first = 0
    for stage in stages:
        for k, gain in enumerate(stage.K):
            moved[first + k, first] -= gain
        first += len(stage.companion)
    return L, moved


@pytest.mark.parametrize("seed", range(6))
def test_three_measurements_get_three_stages_and_the_whole_the_product_of_their_polynomials(seed):
    source = random.Random(seed)
    a, p = sp.Symbol("a", real=True), sp.Symbol("p", real=True)
    F = sp.zeros(6, 6)
    for block in range(3):  # each pair of states is seen by one measurement; the later ones feel the earlier
        for i in range(2):
            for j in range(2 * block + 2):
                F[2 * block + i, j] = source.randint(-3, 3)
        F[2 * block, 2 * block + 1] = source.choice((1, 2, a))
    H = sp.Matrix(3, 6, lambda i, j: int(j == 2 * i))
    H[2, 0] = sp.Rational(1, 3)
    model = LinearModel(F, None, H)
    answer = nav.observe(model, poles="(p + 1)**2; (p + 2)*(p + 3); p**2 + 4*p + 5")
    assert [len(stage.companion) for stage in answer.staged] == [2, 2, 2] and not answer.document()["splits"]
    L, error = observer_matrix(model, answer.staged)
    first = 0
    for stage in answer.staged:  # measurement i is the first coordinate of its stage
        assert (
            sp.Matrix([answer.model.H.row(answer.model.measurements.index(stage.measurement))]) - L[first, :]
        ).is_zero_matrix
        last = first + len(stage.companion) - 1
        shown = [*stage.drive, *stage.companion, *[0] * (5 - last)]
        row = (L * F * L.inv())[last, :]
        assert all(sp.cancel(x - y) == 0 for x, y in zip(row, shown, strict=True))
        first = last + 1
    wanted = (p + 1) ** 2 * (p + 2) * (p + 3) * (p**2 + 4 * p + 5)
    assert error.charpoly(p).all_coeffs() == sp.Poly(wanted, p, domain="QQ[a]").all_coeffs()


def test_two_measurements_have_the_stages_of_their_split():
    F = [[0, 1, 0, 0], [0, 0, "a", 0], [0, 0, 0, 1], ["b", 0, 0, 0]]
    answer = nav.observe(nav.Model("x v f g", F=F, H=["x + f", "g"], a="nonzero", b="real"), split=(4, 0))
    (stage,) = answer.stages()
    assert stage.rows == answer.split.L and stage.companion == answer.split.theta


def test_each_leg_has_stages_of_its_own():
    leg = lambda f: [[0, f, 1], [0, 0, 0], [0, 0, 0]]  # noqa: E731
    model = nav.Model("v q b", pieces=[("0", "1", leg("2")), ("1", "3", leg("5"))], H=["v", "q"])
    answer = nav.observe(model)
    for piece, force in ((1, 2), (2, 5)):
        stages = answer.stages("(p + 1)**2; p + 2", piece=piece)
        whole = sp.Matrix.vstack(*(stage.rows for stage in stages))
        assert whole == sp.Matrix([[1, 0, 0], [0, force, 1], [0, 1, 0]])
        assert [stage.K for stage in stages] == [(2, 1), (2,)]
    for wrong in (None, 0, 3):
        with pytest.raises(nav.NavsymError, match="number of a piece"):
            answer.stages(piece=wrong)
    with pytest.raises(nav.NavsymError, match="of degrees 2, 1"):
        answer.stages("(p + 1)**3", piece=1)
