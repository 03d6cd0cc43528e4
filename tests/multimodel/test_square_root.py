"""Factored covariances against Joseph's form where that is accurate, and against fractions where it is not."""

from fractions import Fraction

import numpy as np
import pytest
from numpy.testing import assert_allclose

from navsym.core.errors import DomainError
from navsym.multimodel.exact import Kit, Leaf, Model, filter_leaf
from navsym.multimodel.kalman import FORMS, bierman, form_of, potter, root_of, square, triangular, ud_of

FACTORED = [name for name in FORMS if name != "joseph"]


def stack(seed, size=4, n=4, p=2, diagonal=False):
    """Means, covariances, a measurement and models for a stack of estimates."""
    rng = np.random.default_rng(seed)
    A, C = rng.standard_normal((size, n, n)), rng.standard_normal((size, p, p))
    R = C @ C.swapaxes(1, 2) + 0.1 * np.eye(p)
    R = R * np.eye(p) if diagonal else R
    F, B = rng.standard_normal((size, n, n)), rng.standard_normal((size, n, n))
    return (
        rng.standard_normal((size, n)),
        A @ A.swapaxes(1, 2) + 0.1 * np.eye(n),
        F,
        0.1 * B @ B.swapaxes(1, 2),
        rng.standard_normal(p),
        rng.standard_normal((size, p, n)),
        R,
    )


@pytest.mark.parametrize("name", FACTORED)
@pytest.mark.parametrize("diagonal", [False, True])
@pytest.mark.parametrize("seed", range(5))
def test_a_factored_form_is_josephs_on_well_conditioned_problems(name, seed, diagonal):
    mean, P, F, Q, z, H, R = stack(seed, diagonal=diagonal)
    form, joseph = FORMS[name], FORMS["joseph"]
    x, kept = form.predict(mean, form.keep(P), F, Q)
    x, kept, ll = form.correct(x, kept, z, H, R)
    X, full = joseph.predict(mean, P, F, Q)
    X, full, LL = joseph.correct(X, full, z, H, R)
    scale = np.abs(full).max()
    assert_allclose(x, X, atol=1e-12 * max(1.0, np.abs(X).max()))
    assert_allclose(form.show(kept), full, atol=1e-12 * scale)
    assert_allclose(ll, LL, rtol=1e-12, atol=1e-12)
    weights = np.random.default_rng(seed).dirichlet(np.ones(4), 3)
    (mx, mk), (MX, MP) = form.merge(weights, x, kept), joseph.merge(weights, X, full)
    assert_allclose(mx, MX, atol=1e-12 * np.abs(MX).max())
    assert_allclose(form.show(mk), MP, atol=1e-12 * np.abs(MP).max())


def fraction_of(P, z, H, R):
    """Corrected mean and covariance of a zero prior mean, in fractions."""
    rows = [[[Fraction(float(v)) for v in row] for row in matrix] for matrix in (P, H, R)]
    n = len(P)
    zero = [[Fraction(0)] * n for _ in range(n)]
    unit = [[Fraction(int(a == b)) for b in range(n)] for a in range(n)]
    leaf = Leaf((Fraction(1),), [Fraction(0)] * n, rows[0])
    kit = Kit(lambda distance, determinant, p: Fraction(1), lambda value: value)
    _, found = filter_leaf(leaf, Model(unit, zero, rows[1], rows[2]), 0, [Fraction(float(v)) for v in z], kit)
    return np.array(found.mean, dtype=float), np.array(found.covariance, dtype=float)


@pytest.mark.parametrize("name", FACTORED)
@pytest.mark.parametrize("delta", [1e-6, 1e-7, 1e-8, 1e-9])
def test_a_factored_form_keeps_the_digits_that_josephs_loses(name, delta):
    """Two nearly equal accurate measurements of two poorly known states: Bierman's example, a few times."""
    errors = {name: 0.0, "joseph": 0.0}
    for seed in range(6):
        rng = np.random.default_rng(seed)
        (a, b), z = rng.uniform(0.5, 1.5, 2), np.ones(2)
        P, H, R = np.diag(rng.uniform(0.5, 2.0, 2)), np.array([[a, b], [a, b + delta]]), delta**2 * np.eye(2)
        exact = fraction_of(P, z, H, R)[1]
        for key in errors:
            form = FORMS[key]
            _, kept, _ = form.correct(np.zeros(2), form.keep(P), z, H, R)
            errors[key] = max(errors[key], np.abs(form.show(kept) - exact).max() / np.abs(exact).max())
    assert errors[name] < 1e-15 / delta
    assert errors[name] < 0.01 * errors["joseph"]


@pytest.mark.parametrize("name", FACTORED)
def test_a_factored_covariance_stays_positive_over_many_nearly_exact_measurements(name):
    form = FORMS[name]
    rng = np.random.default_rng(1)
    x, kept = np.zeros(3), form.keep(1e12 * np.eye(3))
    for _ in range(200):
        x, kept = form.predict(x, kept, np.array([[1.0, 1e-3, 0.0], [0, 1, 1e-3], [0, 0, 1]]), np.zeros((3, 3)))
        h = np.array([[1.0, rng.normal(0, 1e-6), 0.0]])
        x, kept, ll = form.correct(x, kept, rng.normal(size=1), h, np.array([[1e-12]]))
        values = np.linalg.eigvalsh(form.show(kept))
        assert np.isfinite(ll) and values[0] >= -1e-15 * values[-1]


@pytest.mark.parametrize("name", FORMS)
def test_a_perfect_measurement_of_a_known_state_is_impossible_in_every_form(name):
    form = FORMS[name]
    kept = form.keep(np.diag([0.0, 2.0]))
    x, after, ll = form.correct(np.ones(2), kept, np.array([3.0]), np.array([[1.0, 0.0]]), np.zeros((1, 1)))
    assert ll == -np.inf
    assert_allclose(x, [1.0, 1.0])
    assert_allclose(form.show(after), np.diag([0.0, 2.0]), atol=1e-15)
    x, after, ll = form.correct(np.ones(2), kept, np.array([3.0]), np.array([[0.0, 1.0]]), np.zeros((1, 1)))
    assert np.isfinite(ll)
    assert_allclose(x, [1.0, 3.0])
    assert_allclose(form.show(after), np.zeros((2, 2)), atol=1e-15)


@pytest.mark.parametrize("name", FORMS)
def test_an_innovation_too_large_to_square_is_impossible_in_every_form(name):
    form = FORMS[name]
    x, _, ll = form.correct(np.zeros(1), form.keep(np.eye(1)), np.array([1e200]), np.eye(1), np.eye(1))
    assert ll == -np.inf and x == 0.0


def test_scalar_updates_leave_the_same_covariance():
    mean, P, _, _, _, H, _ = stack(3, size=1, p=1)
    S = FORMS["potter"].keep(P)
    d, cross, made = potter(S, H[:, 0], np.array([0.5]))
    alpha, same, UD = bierman(ud_of(S), H[:, 0], np.array([0.5]))
    assert_allclose(d, alpha, rtol=1e-13)
    assert_allclose(cross, same, rtol=1e-11)
    assert_allclose(FORMS["ud"].show(UD), square(made), atol=1e-13 * np.abs(P).max())


def test_triangles_are_triangles_of_the_same_square():
    rng = np.random.default_rng(0)
    for shape in ((3, 2), (3, 3), (3, 7)):
        A = rng.standard_normal((5, *shape))
        S = triangular(A)
        assert not np.tril(S, -1).any() and (np.diagonal(S, axis1=1, axis2=2) >= 0.0).all()
        assert_allclose(square(S), A @ A.swapaxes(1, 2), atol=1e-14)
    assert_allclose(square(root_of(np.zeros((2, 2)))), 0.0)


def test_an_unknown_form_is_refused_with_the_known_ones():
    with pytest.raises(DomainError, match="joseph, qr, potter, ud"):
        form_of("cholesky")
