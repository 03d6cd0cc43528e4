"""Filters say how uncertain they are, and are right: ten thousand runs, Q and R over time included.

The normalised squared errors of the estimate (NEES) and of the innovation (NIS) follow chi-square laws, whose
99 % bounds are taken from scipy. Every linear case is also solved by least squares over the whole series.
"""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.stats import binom, chi2

from navsym.multimodel import kalman
from navsym.multimodel.bank import Bank
from navsym.multimodel.filters import run_filter
from tests.honesty.linear_cases import CASES, STEPS, batch_least_squares, simulate
from tests.sampling import thinned

RUNS = 10_000
METHODS = ("exact", "pulsating", "k-pulsating", "gpb2", "imm", "polygaussian")


def filtered(case, measured):
    """Means (T, runs, n), covariances (T, n, n), squared normalised innovations (T, runs)."""
    mean = np.broadcast_to(case.mean, (measured.shape[1], case.mean.size))
    P, means, covariances, nis = case.P, [], [], []
    for k, z in enumerate(measured):
        mean, P = kalman.predict(mean, P, case.F[k], case.Q[k])
        innovation, S = kalman.residual(mean, P, z, case.H[k], case.R[k])
        nis.append(squared(innovation, S))
        Ps = np.broadcast_to(P, (len(mean), *P.shape))
        mean, Ps, _ = kalman.correct(mean, Ps, z, case.H[k], case.R[k])
        P = Ps[0]
        means.append(mean)
        covariances.append(P)
    return np.array(means), np.array(covariances), np.array(nis)


def squared(error, covariance):
    return np.einsum("ri,ri->r", error, np.linalg.solve(covariance, error.T).T)


def inside(total, freedom):
    """Whether a chi-square total lies inside its 99 % bounds."""
    low, high = chi2.ppf([0.005, 0.995], freedom)
    return low <= total <= high


@pytest.mark.parametrize("name", CASES)
def test_errors_are_as_large_as_the_filter_says(name):
    case = CASES[name]
    states, measured = simulate(case, RUNS, seed=7)
    means, covariances, nis = filtered(case, measured)
    n, p = case.F.shape[1], case.H.shape[1]
    nees = [squared(states[k] - means[k], covariances[k]).sum() for k in range(STEPS)]
    outside = sum(not inside(total, RUNS * n) for total in nees)
    assert outside <= binom.ppf(0.999, STEPS, 0.01), outside
    assert inside(nees[-1], RUNS * n)
    # Innovations are white: all of them together are one chi-square number.
    assert inside(nis.sum(), RUNS * STEPS * p)
    assert sum(not inside(row.sum(), RUNS * p) for row in nis) <= binom.ppf(0.999, STEPS, 0.01)


def test_a_filter_told_the_wrong_noise_is_noticed():
    case = CASES["constant velocity"]
    states, measured = simulate(case, RUNS, seed=7)
    sure = type(case)(case.F, case.Q, case.H, 0.9 * case.R, case.mean, case.P)
    means, covariances, nis = filtered(sure, measured)
    assert not inside(nis.sum(), RUNS * STEPS)
    assert not inside(squared(states[-1] - means[-1], covariances[-1]).sum(), RUNS * 2)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("form", ["joseph", "qr", "potter", "ud"])
def test_every_form_agrees_with_least_squares_over_the_whole_series(name, form):
    case = CASES[name]
    _, measured = simulate(case, 1, seed=3)
    estimate = run_filter(one_mode(case), measured[:, 0], "pulsating", form=form)
    agree(case, measured[:, 0], estimate)


@pytest.mark.parametrize(("name", "method", "engine"), thinned(product(CASES, METHODS, ("numpy", "compiled")), 5))
def test_every_method_with_one_mode_agrees_with_least_squares(name, method, engine):
    case = CASES[name]
    _, measured = simulate(case, 1, seed=5)
    estimate = run_filter(
        one_mode(case), measured[:, 0], method, depth=2 if method == "k-pulsating" else None, engine=engine
    )
    agree(case, measured[:, 0], estimate)


def one_mode(case):
    model = {key: list(getattr(case, key)) for key in "FQHR"}
    return Bank([model], [[1.0]], {"mean": case.mean, "covariance": case.P, "probabilities": [1.0]})


def agree(case, measurements, estimate):
    mean, P = batch_least_squares(case, measurements)
    scale = np.sqrt(np.diag(P))
    assert_allclose(estimate.mean[-1] / scale, mean / scale, rtol=0, atol=1e-10)
    assert_allclose(estimate.covariance[-1] / np.outer(scale, scale), P / np.outer(scale, scale), rtol=0, atol=1e-10)
