"""The filters against the rational tree, against each other, and at the edges."""

from fractions import Fraction

import numpy as np
import pytest
from numpy.testing import assert_allclose

from navsym.core.errors import DomainError, EmptyError, NavsymError, NotFiniteError, ShapeError, TooLargeError
from navsym.multimodel import engine as engine_module
from navsym.multimodel import kalman
from navsym.multimodel.bank import Bank
from navsym.multimodel.exact import Leaf, Model, run_exactly
from navsym.multimodel.filters import read_bank, run_filter
from navsym.multimodel.schemes import SCHEMES, filters_at, scheme
from tests.multimodel.fractions_of_banks import fractions_kit, rational

METHODS = tuple(SCHEMES)
FIELDS = ("probabilities", "mean", "covariance", "log_likelihood")


def rational_spd(rng, n):
    A = rational(rng, n, n)
    return A @ A.T + np.vectorize(Fraction, otypes=[object])(np.eye(n, dtype=int))


def rational_bank(seed):
    """A random bank in fractions: models, transitions, start, measurements."""
    rng = np.random.default_rng(seed)
    m, n, p = int(rng.integers(1, 4)), int(rng.integers(1, 3)), int(rng.integers(1, 3))
    models = [
        {"F": rational(rng, n, n) / 4, "Q": rational_spd(rng, n), "H": rational(rng, p, n), "R": rational_spd(rng, p)}
        for _ in range(m)
    ]
    raw = rng.integers(1, 9, (m + 1, m))
    rows = [[Fraction(int(v), int(row.sum())) for v in row] for row in raw]
    start = {"mean": rational(rng, n), "covariance": rational_spd(rng, n), "probabilities": rows[m]}
    return models, rows[:m], start, rational(rng, 3, p) * 2


def in_floats(models, transition, start):
    floats = [{key: np.array(value, dtype=float) for key, value in model.items()} for model in models]
    return Bank(
        floats,
        np.array(transition, dtype=float),
        {
            "mean": np.array(start["mean"], dtype=float),
            "covariance": np.array(start["covariance"], dtype=float),
            "probabilities": np.array(start["probabilities"], dtype=float),
        },
    )


def in_fractions(method, models, transition, start, z):
    rows = [Model(*(model[key].tolist() for key in "FQHR")) for model in models]
    if method == "polygaussian":
        roots = [
            Leaf(
                tuple(g if i == j else Fraction(0) for j in range(len(models))),
                list(start["mean"]),
                start["covariance"].tolist(),
            )
            for i, g in enumerate(start["probabilities"])
        ]
    else:
        roots = [Leaf(tuple(start["probabilities"]), list(start["mean"]), start["covariance"].tolist())]
    steps = len(z)
    return run_exactly(scheme(method), [rows] * steps, [transition] * steps, roots, z.tolist(), fractions_kit())


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("seed", range(50))
def test_fifty_random_banks_agree_with_rational_arithmetic(method, seed):
    models, transition, start, z = rational_bank(seed)
    exact = in_fractions(method, models, transition, start, z)
    found = run_filter(in_floats(models, transition, start), z.astype(float), method, engine="numpy")
    assert_allclose(found.probabilities, [[float(v) for v in s.probabilities] for s in exact], atol=1e-12)
    assert_allclose(found.mean, [[float(v) for v in s.mean] for s in exact], rtol=1e-11, atol=1e-12)
    truth = [[[float(v) for v in row] for row in s.covariance] for s in exact]
    assert_allclose(found.covariance, truth, rtol=1e-10, atol=1e-11)
    logs = np.cumsum([float(np.log(float(s.likelihood))) if s.likelihood > 1e-300 else np.nan for s in exact])
    reached = np.isfinite(logs)
    assert_allclose(found.log_likelihood[reached], logs[reached], rtol=1e-12, atol=1e-11)


def random_bank(seed, modes=3, states=3, channels=2, **options):
    rng = np.random.default_rng(seed)
    models = []
    for _ in range(modes):
        F = rng.standard_normal((states, states))
        F /= 1.1 * np.abs(np.linalg.eigvals(F)).max()
        A, C = rng.standard_normal((states, states)), rng.standard_normal((channels, channels))
        R = C @ C.T + 0.2 * np.eye(channels)
        models.append(
            {
                "F": F,
                "Q": 0.1 * A @ A.T,
                "H": rng.standard_normal((channels, states)),
                "R": np.diag(np.diag(R)) if options.get("diagonal") else R,
            }
        )
    transition = rng.random((modes, modes)) + 0.1
    transition /= transition.sum(axis=1, keepdims=True)
    prior = rng.random(modes) + 0.1
    return Bank(
        models,
        options.get("transition", transition),
        {"mean": rng.standard_normal(states), "covariance": 2 * np.eye(states), "probabilities": prior / prior.sum()},
    )


def series(seed, steps, channels=2):
    return 2.0 * np.random.default_rng(seed + 99).standard_normal((steps, channels))


def assert_same(a, b, atol=1e-12, fields=FIELDS):
    for name in fields:
        assert_allclose(getattr(a, name), getattr(b, name), rtol=1e-11, atol=atol, err_msg=name)


@pytest.mark.parametrize("seed", range(4))
def test_k_pulsating_over_the_whole_series_is_exact(seed):
    models, z = random_bank(seed), series(seed, 5)
    assert_same(
        run_filter(models, z, "k-pulsating", depth=5), run_filter(models, z, "exact"), fields=(*FIELDS, "filters_run")
    )


def test_k_pulsating_with_one_step_is_pulsating():
    models, z = random_bank(1), series(1, 12)
    assert_same(
        run_filter(models, z, "k-pulsating", depth=1),
        run_filter(models, z, "pulsating"),
        fields=(*FIELDS, "filters_run"),
    )


@pytest.mark.parametrize("method", METHODS)
def test_one_mode_is_the_kalman_filter(method):
    models, z = random_bank(2, modes=1), series(2, 8)
    found = run_filter(models, z, method)
    mean, P, total = models.means[0], models.covariances[0], 0.0
    for k, row in enumerate(z):
        mean, P = kalman.predict(mean, P, models.F[0, 0], models.Q[0, 0])
        mean, P, part = kalman.correct(mean, P, row, models.H[0, 0], models.R[0, 0])
        total += part
        assert_allclose(found.mean[k], mean, rtol=1e-12)
        assert_allclose(found.covariance[k], P, rtol=1e-11, atol=1e-13)
        assert_allclose(found.log_likelihood[k], total, rtol=1e-12)


def test_without_switching_exact_imm_and_gpb2_are_polygaussian():
    models, z = random_bank(3, transition=np.eye(3)), series(3, 6)
    reference = run_filter(models, z, "polygaussian")
    for method in ("exact", "imm", "gpb2"):
        assert_same(run_filter(models, z, method), reference)


def test_modes_that_are_equal_change_nothing():
    models, z = random_bank(4, modes=1), series(4, 6)
    twins = Bank(
        [{"F": models.F[0, 0], "Q": models.Q[0, 0], "H": models.H[0, 0], "R": models.R[0, 0]}] * 3,
        np.full((3, 3), 1 / 3),
        {"mean": models.means[0], "covariance": models.covariances[0], "probabilities": [0.2, 0.3, 0.5]},
    )
    single = run_filter(models, z, "exact")
    for method in METHODS:
        found = run_filter(twins, z, method)
        assert_same(found, single, fields=("mean", "covariance", "log_likelihood"))


def test_memoryless_weights_are_the_printed_formula():
    models, z = random_bank(5), series(5, 4)
    found = run_filter(models, z, "pulsating", memoryless=True)
    mean, P, prior = models.means[0], models.covariances[0], models.probabilities
    for k, row in enumerate(z):
        prior = prior @ models.mode_transition[0]
        means, covariances = kalman.predict(mean, P, models.F[0], models.Q[0])
        means, covariances, logs = kalman.correct(means, covariances, row, models.H[0], models.R[0])
        weights = prior * np.exp(logs)
        weights /= weights.sum()
        mean = weights @ means
        P = sum(g * (C + np.outer(x - mean, x - mean)) for g, x, C in zip(weights, means, covariances, strict=True))
        assert_allclose(found.probabilities[k], weights, atol=1e-12)
        assert_allclose(found.mean[k], mean, atol=1e-12)
        assert_allclose(found.covariance[k], P, atol=1e-11)


def test_memoryless_and_markov_differ_from_the_second_step_on():
    models, z = random_bank(6), series(6, 3)
    a, b = run_filter(models, z, "pulsating"), run_filter(models, z, "pulsating", memoryless=True)
    assert_allclose(a.probabilities[0], b.probabilities[0], atol=1e-14)
    assert np.abs(a.probabilities[1] - b.probabilities[1]).max() > 1e-6


@pytest.mark.parametrize("diagonal", [True, False])
@pytest.mark.parametrize("method", METHODS)
def test_compiled_loops_equal_their_twin(method, diagonal):
    steps = 5 if method == "exact" else 40
    models, z = random_bank(7, diagonal=diagonal), series(7, steps)
    assert_same(
        run_filter(models, z, method, engine="compiled"),
        run_filter(models, z, method, engine="numpy"),
        fields=(*FIELDS, "filters_run", "impossible"),
    )


def test_compiled_loops_take_gaps_and_models_over_time():
    rng, steps = np.random.default_rng(8), 10
    models = [
        {
            "F": 0.4 * rng.standard_normal((steps, 2, 2)),
            "Q": [[0.1, 0.0], [0.0, 0.2]],
            "H": rng.standard_normal((steps, 2, 2)),
            "R": [[1.0 + i, 0.0], [0.0, 0.5]],
        }
        for i in range(9)
    ]
    rows = rng.random((steps, 9, 9)) + 0.1
    made = Bank(
        models,
        rows / rows.sum(axis=2, keepdims=True),
        {"mean": [0.0, 1.0], "covariance": np.eye(2), "probabilities": np.full(9, 1 / 9)},
    )
    z = series(8, steps)
    z[3], z[5, 0] = np.nan, np.nan
    for method in ("imm", "pulsating", "gpb2", "polygaussian"):
        assert_same(
            run_filter(made, z, method, engine="compiled", missing=True),
            run_filter(made, z, method, engine="numpy", missing=True),
        )


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("engine", ["numpy", "compiled"])
def test_a_gap_is_a_prediction(method, engine):
    models = random_bank(9)
    z = series(9, 3)
    gap = np.vstack([z[:2], np.full((1, 2), np.nan)])
    found = run_filter(models, gap, method, engine=engine, missing=True)
    assert_allclose(found.log_likelihood[2], found.log_likelihood[1], rtol=1e-12)
    if method != "polygaussian":
        ahead = found.probabilities[1] @ models.mode_transition[0]
        assert_allclose(found.probabilities[2], ahead, atol=1e-12)


@pytest.mark.parametrize("engine", ["numpy", "compiled"])
def test_a_likelihood_of_1e_minus_300_does_not_kill_a_mode(engine):
    one = {"F": [[1.0]], "Q": [[0.0]], "H": [[1.0]], "R": [[1.0]]}
    far = {"F": [[1.0]], "Q": [[0.0]], "H": [[1.0]], "R": [[1e4]]}
    made = Bank([one, far], np.eye(2), {"mean": [0.0], "covariance": [[1e-6]], "probabilities": [0.5, 0.5]})
    found = run_filter(made, [[200.0], *([[0.0]] * 4400)], "polygaussian", engine=engine)
    assert found.probabilities[0, 0] == 0.0
    # Each later zero is a hundred times likelier under the narrow mode; 1e-8680 is caught up with in the end.
    assert found.probabilities[-1, 0] == pytest.approx(1.0)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("method", ["pulsating", "k-pulsating", "gpb2", "imm", "polygaussian"])
def test_modes_whose_weights_underflow_and_come_back_are_the_same_in_both_engines(method, seed):
    models, z = random_bank(seed, modes=5), 200.0 * series(seed, 9)
    assert run_filter(models, z, method, engine="numpy").impossible
    compiled, readable = run_filter(models, z, method, engine="compiled"), run_filter(models, z, method, engine="numpy")
    assert_allclose(compiled.probabilities, readable.probabilities, atol=1e-9)
    assert_allclose(compiled.mean, readable.mean, rtol=1e-9, atol=1e-9)
    assert_allclose(compiled.log_likelihood, readable.log_likelihood, rtol=1e-11)


@pytest.mark.parametrize("engine", ["numpy", "compiled"])
def test_an_impossible_measurement_is_reported_and_the_estimate_continues(engine):
    models = random_bank(10)
    z = series(10, 4)
    z[1] = 1e6
    found = run_filter(models, z, "imm", engine=engine)
    assert found.impossible[0] == 2
    assert found.left_out == ()
    assert all(np.isfinite(getattr(found, name)).all() for name in FIELDS)


@pytest.mark.parametrize("engine", ["numpy", "compiled"])
def test_a_measurement_beyond_all_logarithms_is_left_out(engine):
    models, z = random_bank(11), series(11, 4)
    z[1] = 1e200
    found = run_filter(models, z, "pulsating", engine=engine)
    assert found.left_out == (2,)
    blank = z.copy()
    blank[1] = np.nan
    assert_same(found, run_filter(models, blank, "pulsating", missing=True))


def test_an_unreachable_mode_has_probability_zero_and_no_nan():
    models = random_bank(12, transition=[[0.5, 0.5, 0.0]] * 3)
    for method in ("imm", "gpb2", "pulsating", "exact"):
        for engine in ("numpy", "compiled"):
            found = run_filter(models, series(12, 4), method, engine=engine)
            assert_allclose(found.probabilities[:, 2], 0.0)
            assert np.isfinite(found.mean).all()


@pytest.mark.parametrize(
    ("method", "depth", "steps"),
    [
        ("exact", None, 5),
        ("pulsating", None, 7),
        ("k-pulsating", 3, 8),
        ("gpb2", None, 6),
        ("imm", None, 6),
        ("polygaussian", None, 6),
    ],
)
def test_filters_run_counts_the_kalman_filters_of_every_step(method, depth, steps, monkeypatch):
    ran = []
    original = engine_module.filter_branches

    def counted(models, k, branches, *rest):
        ran.append(len(branches.modes))
        return original(models, k, branches, *rest)

    monkeypatch.setattr(engine_module, "filter_branches", counted)
    found = run_filter(random_bank(13), series(13, steps), method, depth=depth, engine="numpy")
    assert found.filters_run == sum(ran)


def test_means_of_every_mode_start_the_tree_with_one_root_each():
    rule = scheme("exact")
    assert [filters_at(rule, 3, 3, k) for k in (1, 2, 3)] == [9, 27, 81]
    models = random_bank(14)
    apart = Bank(
        [{k: getattr(models, k)[0, i] for k in "FQHR"} for i in range(3)],
        models.mode_transition[0],
        {"mean": np.arange(9.0).reshape(3, 3), "covariance": np.eye(3), "probabilities": models.probabilities},
    )
    for method in METHODS:
        assert_same(
            run_filter(apart, series(14, 4), method, engine="numpy"),
            run_filter(apart, series(14, 4), method, engine="compiled"),
        )


def document(**changes):
    unit = [[1.0]]
    out = {
        "models": [{"F": unit, "Q": unit, "H": unit, "R": unit}, {"F": unit, "Q": [[4.0]], "H": unit, "R": unit}],
        "mode_transition": [[0.9, 0.1], [0.2, 0.8]],
        "initial": {"mean": [0.0], "covariance": unit, "probabilities": [0.5, 0.5]},
        "measurements": [[1.0], [2.0]],
    }
    out.update(changes)
    return out


def attempt(given, method="pulsating", **options):
    read = read_bank(given)
    return run_filter(read.bank, read.measurements, method, memoryless=read.memoryless, missing=read.missing, **options)


def with_model(**changes):
    given = document()
    given["models"][1] = {**given["models"][1], **changes}
    return given


@pytest.mark.parametrize(
    ("given", "kind", "match"),
    [
        (document(mode_transition=[[0.9, 0.2], [0.2, 0.8]]), DomainError, "row 0 sums to 1.1"),
        (document(mode_transition=[[1.1, -0.1], [0.2, 0.8]]), DomainError, "negative"),
        (document(mode_transition=[[1.0]]), ShapeError, "mode_transition"),
        (with_model(Q=[[-1.0]]), DomainError, r"models\[1\].Q.*semidefinite"),
        (with_model(R=[[-1.0]]), DomainError, r"models\[1\].R"),
        (with_model(H=[[1.0], [2.0]]), ShapeError, "share one state and one measurement"),
        (with_model(F=[[1.0, 0.0]]), ShapeError, r"models\[1\].F"),
        (with_model(F=None), ShapeError, r"models\[1\].F"),
        (document(models=[]), EmptyError, "models"),
        (document(measurements=[]), EmptyError, "measurements"),
        (document(measurements=[[1.0], [float("nan")]]), NotFiniteError, r"measurements\[1\]"),
        (document(measurements=[[1.0], [None]]), NotFiniteError, r"measurements\[1\]"),
        (document(measurements=[[1.0, 2.0]]), ShapeError, r"measurements\[0\]"),
        (document(measurements=[["x"]]), ShapeError, r"measurements\[0\]"),
        (
            document(initial={"mean": [0.0], "covariance": [[1.0]], "probabilities": [0.0, 0.0]}),
            DomainError,
            "sums to 0",
        ),
        (document(initial={"mean": [0.0], "covariance": [[1.0]]}), ShapeError, "initial.probabilities"),
        (document(memoryless="yes"), DomainError, "memoryless"),
    ],
)
def test_bad_banks_are_refused_by_name(given, kind, match):
    with pytest.raises(kind, match=match):
        attempt(given)


def test_a_tree_that_cannot_fit_is_refused_with_its_count():
    with pytest.raises(TooLargeError, match=str(2**40)):
        attempt(document(measurements=[[0.0]] * 40), "exact")
    with pytest.raises(TooLargeError, match="10\\^"):
        attempt(document(measurements=[[0.0]] * 5000), "k-pulsating", depth=4000)


@pytest.mark.parametrize(
    ("method", "options", "match"),
    [
        ("kalman", {}, "expected one of"),
        ("imm", {"depth": 2}, "belongs to k-pulsating"),
        ("k-pulsating", {"depth": 0}, "from 1 on"),
        ("polygaussian", {"memoryless": True}, "never switch"),
        ("imm", {"engine": "fast"}, "auto, numpy or compiled"),
    ],
)
def test_bad_requests_are_refused(method, options, match):
    models = random_bank(0)
    with pytest.raises(DomainError, match=match):
        run_filter(models, series(0, 2), method, **options)


def test_missing_numbers_are_taken_on_request():
    found = attempt(document(measurements=[[1.0], [None]], missing=True))
    assert found.log_likelihood[1] == pytest.approx(found.log_likelihood[0], rel=1e-14)


def test_nothing_but_navsym_errors_leaves_on_rubbish():
    rng = np.random.default_rng(15)
    pieces = [None, "x", [], [[]], [[1.0]], [1.0], 3, {}, True, [[[1.0]]], [["1"]], float("inf")]
    for _ in range(300):
        given = document()
        key = list(given)[rng.integers(4)]
        given[key] = pieces[rng.integers(len(pieces))]
        if rng.integers(2):
            given = with_model(**{"FQHR"[rng.integers(4)]: pieces[rng.integers(len(pieces))]})
        try:
            attempt(given)
        except NavsymError:
            continue
