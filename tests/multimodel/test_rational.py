"""Every filter, engine and form against rational arithmetic on banks that change with time.

F, Q, H, R and the transitions have their own matrices at every step; each mode may be deaf to one of the sensors
(a zero row in H); numbers, and whole rows, are missing. The reference is the tree in fractions.
"""

from fractions import Fraction

import numpy as np
import pytest
from numpy.testing import assert_allclose

from navsym.multimodel.bank import Bank
from navsym.multimodel.exact import Leaf, Model, run_exactly
from navsym.multimodel.filters import run_filter
from navsym.multimodel.kalman import FORMS
from navsym.multimodel.schemes import SCHEMES, scheme
from navsym_papers.multistructure.experiment.batch import run_batch
from tests.multimodel.fractions_of_banks import fractions_kit, rational

STEPS = 3


def spd(rng, n):
    A = rational(rng, n, n)
    return A @ A.T + np.vectorize(Fraction, otypes=[object])(np.eye(n, dtype=int))


def rows_of(rng, count, m):
    raw = rng.integers(1, 9, (count, m))
    return [[Fraction(int(v), int(row.sum())) for v in row] for row in raw]


def changing_bank(seed):
    """Models per mode and step, transitions per step, means and covariances per mode, measurements with gaps."""
    rng = np.random.default_rng([seed, 5])
    m, n, p = int(rng.integers(2, 4)), int(rng.integers(1, 3)), int(rng.integers(1, 3))
    models = []
    for mode in range(m):
        model = {
            "F": [rational(rng, n, n) / 4 for _ in range(STEPS)],
            "Q": [spd(rng, n) for _ in range(STEPS)],
            "H": [rational(rng, p, n) for _ in range(STEPS)],
            "R": [spd(rng, p) for _ in range(STEPS)],
        }
        if rng.random() < 0.5:
            for H in model["H"]:
                H[mode % p] = Fraction(0)
        models.append(model)
    switch = [rows_of(rng, m, m) for _ in range(STEPS)]
    start = ([rational(rng, n) for _ in range(m)], [spd(rng, n) for _ in range(m)], rows_of(rng, 1, m)[0])
    z = (rational(rng, STEPS, p) * 2).tolist()
    for k, c in zip(rng.integers(0, STEPS, 2), rng.integers(0, p, 2), strict=True):
        z[k][c] = None
    if rng.random() < 0.3:
        z[1] = [None] * p
    return models, switch, start, z


def floats(value):
    return np.array(value, dtype=float).tolist()


def with_gaps(z):
    return [[None if value is None else float(value) for value in row] for row in z]


def float_bank(models, switch, start):
    return Bank(
        [{key: [floats(a) for a in model[key]] for key in model} for model in models],
        [floats(matrix) for matrix in switch],
        dict(zip(("mean", "covariance", "probabilities"), map(floats, start), strict=True)),
    )


def exact_steps(method, models, switch, start, z, depth=None):
    per_step = [[Model(*(model[key][k].tolist() for key in "FQHR")) for model in models] for k in range(STEPS)]
    means, covariances, prior = start
    roots = [
        Leaf(tuple(g if i == j else Fraction(0) for j in range(len(models))), list(means[i]), covariances[i].tolist())
        for i, g in enumerate(prior)
    ]
    return run_exactly(scheme(method, depth), per_step, switch, roots, z, fractions_kit())


def assert_agrees(found, exact):
    assert_allclose(found.probabilities, floats([s.probabilities for s in exact]), atol=1e-12)
    mean, covariance = floats([s.mean for s in exact]), floats([s.covariance for s in exact])
    assert_allclose(found.mean, mean, rtol=1e-11, atol=1e-12 * max(1.0, np.abs(mean).max()))
    assert_allclose(found.covariance, covariance, rtol=1e-10, atol=1e-12 * np.abs(covariance).max())
    logs = np.cumsum([float(np.log(float(s.likelihood))) for s in exact])
    assert_allclose(found.log_likelihood, logs, rtol=1e-12, atol=1e-11)


@pytest.mark.long
@pytest.mark.parametrize("method", SCHEMES)
def test_fifty_changing_banks_with_gaps_agree_with_rational_arithmetic_in_every_engine_and_form(method):
    for seed in range(50):
        models, switch, start, z = changing_bank(seed)
        depth = 3 if method == "k-pulsating" and seed % 2 else None
        exact = exact_steps(method, models, switch, start, z, depth)
        made, series = float_bank(models, switch, start), with_gaps(z)
        for engine in ("numpy", "compiled"):
            assert_agrees(run_filter(made, series, method, depth=depth, missing=True, engine=engine), exact)
        for form in FORMS if seed < 10 else ():
            assert_agrees(run_filter(made, series, method, depth=depth, missing=True, form=form), exact)


@pytest.mark.parametrize("method", SCHEMES)
def test_batches_of_changing_banks_agree_with_rational_arithmetic(method):
    for seed in range(4):
        models, switch, start, z = changing_bank(seed)
        z = [[Fraction(1, 3) if value is None else value for value in row] for row in z]
        mean, covariance, probabilities, total = run_batch(float_bank(models, switch, start), [floats(z)] * 9, method)
        exact = exact_steps(method, models, switch, start, z)
        for one in (0, 8):
            assert_allclose(probabilities[one], floats([s.probabilities for s in exact]), atol=1e-12)
            assert_allclose(mean[one], floats([s.mean for s in exact]), rtol=1e-11, atol=1e-11)
            assert_allclose(covariance[one], floats([s.covariance for s in exact]), rtol=1e-10, atol=1e-10)
        assert np.ptp(total[:, -1]) == 0.0
