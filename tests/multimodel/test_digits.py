"""Banks at which doubles lose their digits, or S is singular, against the definitions in mpmath at sixty digits."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from numpy.testing import assert_allclose

from navsym.core.errors import DomainError, ShapeError
from navsym.multimodel import doubt
from navsym.multimodel.bank import Bank
from navsym.multimodel.digits import run_in_digits
from navsym.multimodel.filters import run_filter
from navsym.multimodel.kalman import FORMS
from navsym.multimodel.schemes import SCHEMES, scheme
from navsym_papers.multistructure.experiment.batch import run_batch
from tests.multimodel import test_filters, test_rational
from tests.sampling import thinned

I2 = np.eye(2)
METHODS = ("pulsating", "imm", "gpb2", "polygaussian", "exact")


def exactly(array):
    return mp.matrix(np.atleast_2d(np.asarray(array, dtype=float)).tolist())


def column(vector):
    return exactly(np.asarray(vector, dtype=float)[:, None])


def kalman_step(mean, P, model, z):
    """Prediction and correction as every textbook has them, and the density of z."""
    F, Q, H, R = model
    mean, P = F * mean, F * P * F.T + Q
    v, S = z - H * mean, H * P * H.T + R
    K = P * H.T * S**-1
    density = mp.exp(-(v.T * S**-1 * v)[0] / 2) / mp.sqrt((2 * mp.pi) ** len(v) * mp.det(S))
    return mean + K * v, P - K * S * K.T, density


def mixture(parts):
    """Weight, mean and covariance of (weight, mean, covariance)s; those of the first where no weight is left."""
    whole = mp.fsum(w for w, _, _ in parts)
    shares = [w / whole if whole else mp.mpf(i == 0) for i, (w, _, _) in enumerate(parts)]
    mean = sum((g * x for g, (_, x, _) in zip(shares, parts, strict=True)), 0 * parts[0][1])
    spread = 0 * parts[0][2]
    for g, (_, x, P) in zip(shares, parts, strict=True):
        spread += g * (P + (x - mean) * (x - mean).T)
    return whole, mean, spread


def sixty_digits(models, switch, start, series, method, *, least=0, digits=60):
    """Mode probabilities (T, m), means and log-likelihoods (T,), from the sentences that define the methods.

    Hypotheses are (weight, last mode, mean, covariance); before the first step all modes share one Gaussian.
    least : variance that every measurement has besides R
    """
    with mp.workdps(digits):
        m, rows = range(len(models)), [[exactly(model[key]) for key in "FQHR"] for model in models]
        for row in rows:
            row[3] += mp.mpf(least) * mp.eye(row[3].rows)
        p = [[mp.mpf(v) for v in row] for row in switch]
        x, P = column(start["mean"]), exactly(start["covariance"])
        tree = [(mp.mpf(g), i, x, P) for i, g in enumerate(start["probabilities"])]
        shares, means, logs, total = [], [], [], mp.mpf(0)
        for z in series:
            if method == "polygaussian":
                ahead = tree
            elif method == "imm":
                mixed = [mixture([(w * p[i][j], x, P) for w, i, x, P in tree]) for j in m]
                ahead = [(w, j, x, P) for j, (w, x, P) in enumerate(mixed)]
            else:
                ahead = [(w * p[i][j], j, x, P) for w, i, x, P in tree for j in m]
            grown = []
            for w, j, x, P in ahead:
                x, P, density = kalman_step(x, P, rows[j], column(z))
                grown.append((w * density, j, x, P))
            whole, mean, spread = mixture([(w, x, P) for w, _, x, P in grown])
            tree = [(w / whole, j, x, P) for w, j, x, P in grown]
            weights = [mp.fsum(w for w, j, _, _ in tree if j == i) for i in m]
            total += mp.log(whole)
            for series_of, value in zip((shares, means, logs), (weights, list(mean), total), strict=True):
                series_of.append(value)
            if method == "pulsating":
                tree = [(w, i, mean, spread) for i, w in enumerate(weights)]
            elif method == "gpb2":
                groups = [mixture([(w, x, P) for w, j, x, P in tree if j == i]) for i in m]
                tree = [(w, i, x, P) for i, (w, x, P) in enumerate(groups)]
        return np.array(shares, dtype=float), np.array(means, dtype=float), np.array(logs, dtype=float)


def nearly_singular(seed):
    """Two models alike but for R, far below the rounding of S; two measurements that differ by the noise."""
    rng = np.random.default_rng([seed, 17])
    unit, delta = 10.0 ** rng.uniform(-19, -13), 10.0 ** rng.uniform(-9, -6)
    F = np.array([[1.0, 1.0], [0.0, 1.0]]) if seed % 2 else np.round(rng.standard_normal((2, 2)), 2)
    H = np.array([[1.0, 0.0], [1.0, delta]]) if seed % 3 else np.array([[1.0, 1.0], [1.0, 1.0 + delta]])
    model = {"F": F, "Q": 10.0 ** rng.uniform(-16, -10) * I2, "H": H}
    models = [{**model, "R": unit * I2}, {**model, "R": rng.uniform(2, 6) * unit * I2}]
    start = {"mean": np.zeros(2), "covariance": I2, "probabilities": [0.5, 0.5]}
    level = rng.standard_normal(3)
    slope = delta * rng.standard_normal(3) if seed % 4 else np.sqrt(2 * unit) * rng.standard_normal(3)
    return models, [[0.9, 0.1], [0.1, 0.9]], start, np.c_[level, level + slope]


def assert_sixty_digits(found, given, method):
    shares, means, logs = sixty_digits(*given, method)
    assert_allclose(found.probabilities, shares, rtol=0, atol=1e-7)
    assert np.all(np.abs(found.mean - means) <= 1e-6 * found.standard_deviations + 1e-13 * np.abs(means))
    assert_allclose(found.log_likelihood, logs, rtol=1e-8)


@pytest.mark.parametrize("part", thinned([(part,) for part in range(8)], 4))
def test_four_hundred_nearly_singular_banks_are_those_of_sixty_digits(part):
    for seed in range(50 * part, 50 * part + 50):
        given, method = nearly_singular(seed), METHODS[seed % 5]
        *parts, z = given
        assert_sixty_digits(run_filter(Bank(*parts), z, method), given, method)


@pytest.mark.parametrize("options", [{"engine": "compiled"}, {"engine": "numpy"}, *({"form": form} for form in FORMS)])
def test_the_engine_and_the_form_do_not_change_the_answer(options):
    for seed in range(20):
        given, method = nearly_singular(seed), METHODS[seed % 5]
        *parts, z = given
        assert_sixty_digits(run_filter(Bank(*parts), z, method, **options), given, method)


@pytest.mark.parametrize("method", ["pulsating", "imm", "polygaussian"])
def test_batches_of_nearly_singular_banks_are_those_of_sixty_digits(method):
    for seed in range(6):
        *parts, z = given = nearly_singular(seed)
        mean, _, probabilities, logs = run_batch(Bank(*parts), np.array([z, z[::-1]]), method)
        for run, series in enumerate((z, z[::-1])):
            shares, means, total = sixty_digits(*given[:3], series, method)
            assert_allclose(probabilities[run], shares, rtol=0, atol=1e-7)
            assert_allclose(logs[run], total, rtol=1e-8)
            assert_allclose(mean[run], means, rtol=1e-6, atol=1e-6)


def test_correlated_noise_that_is_nearly_singular_is_that_of_sixty_digits():
    for seed, method in enumerate(METHODS * 4):
        rng = np.random.default_rng(seed)
        R = np.array([[1.0, 1.0 - 2.0**-50], [1.0 - 2.0**-50, 1.0]])
        model = {"F": I2, "Q": 1e-17 * I2, "H": np.array([[1.0, 0.0], [1.0, 1e-8 * seed]]), "R": R}
        models = [model, {**model, "R": R + np.diag([0.0, 2.0**-49])}]
        start = {"mean": np.zeros(2), "covariance": 1e-2 * I2, "probabilities": [0.5, 0.5]}
        given = (
            models,
            [[0.9, 0.1], [0.1, 0.9]],
            start,
            rng.standard_normal((3, 1)) + 1e-8 * rng.standard_normal((3, 2)),
        )
        for engine in ("numpy", "compiled"):
            assert_sixty_digits(run_filter(Bank(*given[:3]), given[3], method, engine=engine), given, method)


def test_what_is_known_of_a_sum_of_states_is_kept_until_it_is_a_state():
    """x1 + x2 is measured to 3e-9, then becomes the first state: no covariance in doubles shows it in between."""
    sums = {"F": I2, "Q": 0 * I2, "H": [[1.0, 1.0]], "R": [[1e-17]]}
    models = [
        {**sums, "F": [I2, [[1.0, 1.0], [0.0, 1.0]]], "H": [[[1.0, 1.0]], [[1.0, 0.0]]]},
        {**sums, "F": [I2, [[1.0, 1.0], [0.0, 1.0]]], "H": [[[1.0, 1.0]], [[1.0, 0.0]]], "R": [[9e-17]]},
    ]
    start = {"mean": [0.0, 0.0], "covariance": np.eye(2), "probabilities": [0.5, 0.5]}
    z = [[0.7], [0.7 + 2e-9]]
    found = run_filter(Bank(models, np.eye(2), start), z, "polygaussian")
    # With p = x1 + x2 the second number is p again: a scalar with prior variance 2 and noise r in both.
    weights = []
    with mp.workdps(60):
        for r in (mp.mpf(1e-17), mp.mpf(9e-17)):
            S = 2 * mp.ones(2) + r * mp.eye(2)
            v = column([z[0][0], z[1][0]])
            weights.append(mp.exp(-(v.T * S**-1 * v)[0] / 2) / mp.sqrt(mp.det(S)))
        expected = [float(w / mp.fsum(weights)) for w in weights]
    assert_allclose(found.probabilities[-1], expected, rtol=0, atol=1e-9)


def perfect_sensors(seed):
    """Modes whose two sensors see one combination of the states, some without noise, one that they contradict.

    The process noise keeps the states uncertain, so that a noise of R + e I changes them by O(e).
    """
    rng = np.random.default_rng([seed, 3])
    ratio = 2.0 ** int(rng.integers(-2, 3))
    models = []
    for kind in rng.permutation(["perfect", "perfect", "noisy", "contradicted"]):
        h = rng.standard_normal(2)
        H = np.array([h, (3.0 if kind == "contradicted" else 1.0) * ratio * h])
        R = np.diag(rng.uniform(0.5, 2.0, 2)) if kind == "noisy" else np.zeros((2, 2))
        models.append({"F": np.round(rng.standard_normal((2, 2)), 2), "Q": 0.5 * I2, "H": H, "R": R})
    switch = rng.dirichlet(np.ones(4), 4)
    start = {"mean": rng.standard_normal(2), "covariance": I2, "probabilities": rng.dirichlet(np.ones(4))}
    y = rng.standard_normal(3)
    return models, switch / switch.sum(axis=1, keepdims=True), start, np.c_[y, ratio * y]


@pytest.mark.parametrize("method", METHODS[:4])
def test_the_density_on_the_range_of_S_is_the_limit_of_little_noise(method):
    noise = mp.mpf(10) ** -120
    for seed in range(10):
        *parts, z = given = perfect_sensors(seed)
        shares, means, logs = sixty_digits(*given, method, least=noise, digits=400)
        found = run_filter(Bank(*parts), z, method)
        assert found.engine == "digits" and found.left_out == ()
        assert_allclose(found.probabilities, shares, rtol=0, atol=1e-13)
        assert_allclose(found.mean, means, rtol=1e-11, atol=1e-12)
        # Each measurement lacks one dimension: its density there is 1/sqrt(2 pi e), which the range leaves out.
        lacking = np.arange(1, 4) * float(mp.log(2 * mp.pi * noise)) / 2
        assert_allclose(found.log_likelihood, logs + lacking, rtol=0, atol=1e-9)


@pytest.mark.parametrize("options", [{}, {"engine": "compiled"}, *({"form": form} for form in FORMS)])
@pytest.mark.parametrize("method", METHODS)
def test_two_perfect_sensors_that_agree_are_one(options, method):
    one = {"F": [[1.0]], "Q": [[0.3]], "H": [[1.0]], "R": [[0.0]]}
    two = {**one, "H": [[1.0], [1.0]], "R": np.zeros((2, 2))}
    start = {"mean": [0.1], "covariance": [[0.7]], "probabilities": [1.0]}
    y = np.array([0.7, -0.1, 1.3])
    single = run_filter(Bank([one], [[1.0]], start), y, method)
    double = run_filter(Bank([two], [[1.0]], start), np.c_[y, y], method, **options)
    assert double.left_out == double.impossible == ()
    for name in ("mean", "covariance", "probabilities"):
        assert_allclose(getattr(double, name), getattr(single, name), rtol=1e-12, atol=1e-12)
    # On the line v1 = v2 a length is sqrt(2) times that of v1.
    assert_allclose(double.log_likelihood, single.log_likelihood - 0.5 * np.log(2) * np.arange(1, 4), rtol=1e-12)
    apart = run_filter(Bank([two], [[1.0]], start), np.c_[y, y + np.array([0.0, 1e-6, 0.0])], method, **options)
    assert apart.left_out == (2,) and apart.document()["left_out"] == [2]
    assert any("step 2" in remark and "left out" in remark for remark in apart.remarks)
    assert "left_out" not in double.document()


def test_decimals_of_a_file_agree_to_their_rounding():
    model = {"F": [[1.0]], "Q": [[0.0]], "H": [[0.1], [0.3], [0.7]], "R": np.zeros((3, 3))}
    bank = Bank([model], [[1.0]], {"mean": [0.0], "covariance": [[1.0]], "probabilities": [1.0]})
    found = run_filter(bank, [[0.11, 0.33, 0.77], [0.11, 0.33, 0.77], [0.11, 0.33, 0.7700001]])
    assert_allclose(found.mean, 1.1, rtol=1e-14)
    assert found.left_out == (3,)


@pytest.mark.parametrize("method", METHODS)
def test_the_limit_of_a_perfect_mode_is_the_perfect_mode(method):
    """S = R in one mode, 2 in the other, and z = 0 fits both: P = sqrt(2) to sqrt(R), in the limit 1."""
    for R in (1e-8, 1e-16, 1e-24, 1e-40, 1e-80, 0.0):
        exact = {"F": [[1.0]], "Q": [[0.0]], "H": [[0.0]], "R": [[R]]}
        models = [exact, {**exact, "H": [[1.0]], "R": [[1.0]]}]
        start = {"mean": [0.0], "covariance": [[1.0]], "probabilities": [0.5, 0.5]}
        found = run_filter(Bank(models, [[0.5, 0.5]] * 2, start), [[0.0], [1.0], [0.0]], method)
        assert_allclose(found.probabilities[0, 1], np.sqrt(R / 2) / (1.0 + np.sqrt(R / 2)), rtol=1e-9)
        # One is no measurement of nothing: the mode that was out of the question is the only one left.
        assert_allclose(found.probabilities[1], [0.0, 1.0], atol=1e-12)
        assert found.left_out == ()


@pytest.mark.parametrize("method", SCHEMES)
def test_a_hundred_digits_are_the_fractions_and_the_doubles(method):
    for seed in range(8):
        models, switch, start, z = test_rational.changing_bank(seed)
        bank = test_rational.float_bank(models, switch, start)
        series = np.array(test_rational.with_gaps(z), dtype=float)
        exact = test_rational.exact_steps(method, models, switch, start, z)
        test_rational.assert_agrees(run_in_digits(scheme(method), bank, series, 0), exact)
    closed = test_filters.random_bank(12, transition=[[0.5, 0.5, 0.0]] * 3)
    z = test_filters.series(12, 4)
    test_filters.assert_same(run_in_digits(scheme(method), closed, z, 0), run_filter(closed, z, method, engine="numpy"))


def test_too_long_a_series_is_said_to_be_in_doubt_and_a_batch_warns(monkeypatch):
    monkeypatch.setattr(doubt, "WORK", 0)
    *parts, z = nearly_singular(2)
    found = run_filter(Bank(*parts), z, "imm")
    assert found.engine == "numpy" and any("double precision does not suffice" in remark for remark in found.remarks)
    with pytest.warns(UserWarning, match="run 0: step 1: double precision does not suffice"):
        run_batch(Bank(*parts), z[None], "gpb2")


def test_banks_whose_numbers_are_sound_run_once_in_doubles(monkeypatch):
    monkeypatch.setattr(doubt, "disagreements", lambda *_: pytest.fail("sound banks need no second run"))
    for seed in range(5):
        found = run_filter(test_filters.random_bank(seed), test_filters.series(seed, 20), "imm", engine="numpy")
        assert found.engine == "numpy" and found.sound and found.notes == ()


def test_a_list_over_time_of_one_matrix_is_for_one_step():
    unit = [[1.0]]
    model, start = dict.fromkeys("FQHR", unit), {"mean": [0.0], "covariance": unit, "probabilities": [1.0]}
    for key in (*"FQHR", "mode_transition"):
        given = [{**model, key: [unit]} if key in model else model], [unit] if key not in model else unit, start
        assert Bank(*given).horizon == 1
        for method in METHODS:
            assert len(run_filter(Bank(*given), [[1.0]], method).mean) == 1
            with pytest.raises(ShapeError, match="at most 1 rows"):
                run_filter(Bank(*given), [[1.0], [2.0]], method)
        with pytest.raises(ShapeError, match="at most 1 steps"):
            run_batch(Bank(*given), [[[1.0], [2.0]]], "imm")
    with pytest.raises(ShapeError, match=r"one length; got \[1, 3\]"):
        Bank([{**model, "F": [unit], "Q": [unit] * 3}], unit, start)


@pytest.mark.parametrize("key", ["Q", "R", "covariance"])
@pytest.mark.parametrize(
    ("value", "words"),
    [
        ([[1e10, 0.0], [0.0, -5.0]], r"\[1, 1\] = -5"),
        ([[1e10, 1.0], [0.0, 1.0]], r"\[0, 1\] = 1.0 against \[1, 0\] = 0.0"),
        ([[1e10, 1e-3], [1e-3, 1e-18]], "eigenvalue"),
    ],
)
def test_no_covariance_of_a_bank_has_a_negative_variance_or_two_halves(key, value, words):
    model, start = {name: I2 for name in "FQHR"}, {"mean": [0.0, 0.0], "covariance": I2, "probabilities": [1.0]}
    if key == "covariance":
        start[key] = value
    else:
        model[key] = value
    with pytest.raises(DomainError, match=f"{key}.*{words}"):
        Bank([model], [[1.0]], start)


@pytest.mark.parametrize("method", SCHEMES)
def test_perfect_measurements_stay_perfect_through_every_merger(method):
    """A known state, seen without noise in one mode: that mode outweighs the others, and no variance comes back."""
    perfect = {"F": [[1.0]], "Q": [[0.0]], "H": [[-0.38]], "R": [[0.0]]}
    models = [perfect, {**perfect, "R": [[6e-4]]}, {**perfect, "R": [[2e-3]]}]
    start = {"mean": [0.1 / -0.38], "covariance": [[0.0]], "probabilities": [0.2, 0.3, 0.5]}
    steps = 5 if method == "exact" else 12
    found = run_filter(Bank(models, [[0.5, 0.25, 0.25]] * 3, start), np.full((steps, 1), 0.1), method)
    assert found.left_out == ()
    assert_allclose(found.probabilities.sum(axis=1), 1.0, rtol=1e-14)
    assert_allclose(found.probabilities[:, 0], 1.0, rtol=1e-14)
    assert_allclose(found.mean, 0.1 / -0.38, rtol=1e-14)
    assert not found.covariance.any()
