"""Batches, studies, the road and the benchmark: small, and held against their twins."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from navsym.core.errors import DomainError, NoDataError, NotFiniteError, ShapeError, TooLargeError
from navsym.multimodel.bank import Bank
from navsym.multimodel.filters import run_filter
from navsym_papers.multistructure.experiment import memory as multimodel_memory
from navsym_papers.multistructure.experiment import road as multimodel_road
from navsym_papers.multistructure.experiment import study as multimodel_study
from navsym_papers.multistructure.experiment.batch import run_batch
from tests.benchmarks import multimodel as benchmark
from tests.twins.mixture import imm_in_numpy


@pytest.fixture(scope="module")
def models():
    return multimodel_study.schuler_bank()


@pytest.fixture(scope="module")
def signals(models):
    return multimodel_study.simulate(models, 19, 6, seed=3)


@pytest.mark.parametrize(
    "method", ["imm", "gpb2", *(pytest.param(name, marks=pytest.mark.long) for name in ("pulsating", "polygaussian"))]
)
def test_a_batch_is_its_runs_one_by_one(models, signals, method):
    mean, covariance, probabilities, logs = run_batch(models, signals.measurements, method)
    for row, z in enumerate(signals.measurements):
        alone = run_filter(models, z, method, engine="numpy")
        scale = np.sqrt(np.diagonal(alone.covariance, axis1=1, axis2=2))
        assert_allclose(mean[row] / scale, alone.mean / scale, atol=1e-11)
        outer = scale[:, :, None] * scale[:, None, :]
        assert_allclose(covariance[row] / outer, alone.covariance / outer, atol=1e-10)
        assert_allclose(probabilities[row], alone.probabilities, atol=1e-11)
        assert_allclose(logs[row], alone.log_likelihood, rtol=1e-11, atol=1e-11)


@pytest.mark.long
def test_the_batch_equals_stacked_numpy():
    rng = np.random.default_rng(4)
    eye = np.eye(2)
    made = Bank(
        [
            {"F": 0.9 * eye, "Q": (i + 1) * eye, "H": rng.standard_normal((2, 2)), "R": [[2.0, 0.5], [0.5, 1.0]]}
            for i in range(3)
        ],
        [[0.8, 0.1, 0.1], [0.2, 0.7, 0.1], [0.1, 0.1, 0.8]],
        {"mean": [0.0, 1.0], "covariance": eye, "probabilities": [0.2, 0.3, 0.5]},
    )
    z = 2.0 * rng.standard_normal((21, 7, 2))
    for ours, theirs in zip(run_batch(made, z, "imm"), imm_in_numpy(made, z), strict=True):
        assert_allclose(ours, theirs, rtol=1e-11, atol=1e-12)


def test_a_run_beyond_all_logarithms_does_not_spoil_its_batch(models, signals):
    z = signals.measurements.copy()
    z[2, 3] = 1e200
    mean = run_batch(models, z, "imm")[0]
    assert np.isfinite(mean).all()
    assert_allclose(mean[3], run_filter(models, z[3], "imm", engine="compiled").mean, rtol=1e-9, atol=1e-15)


def test_bad_batches_are_refused(models, signals):
    with pytest.raises(ShapeError, match="runs, steps"):
        run_batch(models, signals.measurements[0], "imm")
    z = signals.measurements.copy()
    z[1, 2, 0] = np.nan
    with pytest.raises(NotFiniteError, match=r"\(1, 2, 0\)"):
        run_batch(models, z, "imm")


def test_the_same_seed_gives_the_same_signals(models):
    first, second = (multimodel_study.simulate(models, 5, 4, seed=7) for _ in range(2))
    assert np.array_equal(first.measurements, second.measurements)
    assert np.array_equal(first.modes, second.modes)


def test_simulated_modes_follow_the_chain(models):
    signals = multimodel_study.simulate(models, 4000, 3, seed=8)
    expected = models.probabilities @ np.linalg.matrix_power(models.mode_transition[0], 3)
    share = np.bincount(signals.modes[:, 2], minlength=3) / 4000
    assert_allclose(share, expected, atol=4.0 * np.sqrt(0.25 / 4000))


def test_the_exact_filter_is_consistent_and_the_likeliest(models):
    scores = multimodel_study.compare(models, [("pulsating", None), ("gpb2", None)], 150, 5, 9, exact=True)
    exact = scores[0]
    assert abs(exact.nees.mean - 3.0) < 3.0 * exact.nees.half_width
    assert exact.excess.mean == 0.0
    assert all(item.excess.mean > 0.0 for item in scores[1:])


def test_the_interval_of_a_mean_holds_for_few_runs_too():
    """Of 4,000 means of five normal numbers 95 % lie within half a width; with the quantile of many runs 88 % would."""
    samples = np.random.default_rng(4).normal(3.0, 2.0, (4000, 5))
    found = [multimodel_study.mean_of(sample) for sample in samples]
    inside = np.mean([abs(mean.mean - 3.0) <= mean.half_width for mean in found])
    assert 0.94 <= inside <= 0.96


@pytest.mark.parametrize(("method", "calibrated"), [("gpb2", True), ("polygaussian", False)])
def test_deviations_hold_in_95_per_cent_of_simulated_states_and_probabilities_are_frequencies(
    models, method, calibrated
):
    """Modes that never switch say 0.85 and are right in 58 % of the cases: the count sees that."""
    signals = multimodel_study.simulate(models, 1500, 7, seed=5)
    found = multimodel_study.filter_all(models, signals, method)
    spread = np.sqrt(np.diagonal(found.covariance, axis1=-2, axis2=-1))
    assert 0.92 <= (np.abs(found.mean - signals.states) <= 1.96 * spread).mean() <= 0.98
    likely = (found.probabilities > 0.7) & (found.probabilities < 0.9)
    right = (np.arange(3) == signals.modes[:, :, None])[likely].mean()
    assert (abs(right - found.probabilities[likely].mean()) < 0.06) == calibrated


def test_a_study_that_cannot_be_is_refused():
    with pytest.raises(DomainError, match="at least 2 runs"):
        multimodel_study.study(runs=1)
    with pytest.raises(TooLargeError, match="hypotheses"):
        multimodel_study.study(runs=2, steps=30)


def test_the_one_pass_step_is_the_pulsating_filter(models, signals):
    z = signals.measurements[0]
    space = multimodel_memory.Workspace(
        {"mean": models.means[0], "P": models.covariances[0], "probabilities": models.probabilities}
    )
    expected = run_filter(models, z, "pulsating", engine="numpy")
    for k, row in enumerate(z, start=1):
        multimodel_memory.pulsating_step(models, k, row, space)
        scale = np.sqrt(np.diagonal(expected.covariance[k - 1]))
        assert_allclose(space.arrays["mean"] / scale, expected.mean[k - 1] / scale, atol=1e-10)
        assert_allclose(space.arrays["probabilities"], expected.probabilities[k - 1], atol=1e-11)


def test_the_memory_of_one_pass_does_not_grow_with_the_modes_but_for_a_probability_each(models):
    single, pulsating = multimodel_memory.floats_in_use(models, np.zeros(1))
    assert single == 3 + 9
    assert pulsating == 3 * (3 + 9) + 1 + 3


def made_up_road():
    """A road with a wrong fix in it: satellite rows of a car standing still."""
    reference = np.column_stack(
        [0.2 * np.arange(60.0), np.full(60, 35.0), np.full(60, 136.0), np.zeros(60), np.zeros(60)]
    )
    rng = np.random.default_rng(5)
    shift = rng.standard_normal(60) * 0.02
    shift[30:40] = 8.0
    flag = np.ones(60)
    flag[30:35] = 2
    return multimodel_road.align(
        reference,
        np.column_stack([reference[:, 0], reference[:, 1], 136.0 + shift / 91287.8, flag])[np.arange(60) != 50],
    )


def test_wrong_fixes_are_noticed_without_the_flag():
    judgement = multimodel_road.judge(made_up_road())
    assert (judgement.wrong_fixes, judgement.caught) == (5, 5)
    assert judgement.kept >= 0.9 * judgement.good_fixes
    assert judgement.rms < 0.1 * judgement.rms_raw


def test_a_road_that_is_not_there_is_named(tmp_path):
    with pytest.raises(NoDataError, match=r"nagoya_reference\.csv"):
        multimodel_road.read_road(tmp_path)


def test_the_benchmark_runs_at_its_smallest(capsys):
    benchmark.main(["--quick"])
    assert "imm" in capsys.readouterr().out
