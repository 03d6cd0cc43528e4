"""The guard on the recorded Doppler velocities of a drive in a city: faults, and interval contractors beside it."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from tests.benchmarks.protection import CURVED, PRIOR, choose_places, compare_widths, contract, inject, recorded


def contract_by_codac(codac, constraints):
    """The box of the contractors by a library of interval methods."""
    box, x = codac.IntervalVector([list(side) for side in PRIOR]), codac.VectorVar(len(PRIOR))
    forms = [(codac.AnalyticFunction([x], sum((float(a) * x[k] for k, a in enumerate(h) if a and k), x[0])), low, high)
             for h, low, high in constraints]  # fmt: skip
    contractors = [codac.CtcInverse(f, codac.Interval(low, high)) for f, low, high in forms]
    for _ in range(200):
        before = codac.IntervalVector(box)
        for contractor in contractors:
            contractor.contract(box)
        if max(abs(a.lb() - b.lb()) + abs(a.ub() - b.ub()) for a, b in zip(box, before, strict=True)) < 1e-9:
            break
    return np.array([[side.lb(), side.ub()] for side in box])


def need_recorded():
    if recorded() is None:
        pytest.skip("the recorded drive is not here: set NAVSYM_DATA to a folder with gnss_ins/nagoya_reference.csv")


def test_the_guard_is_never_wider_than_interval_contractors_and_narrower_for_slopes():
    """Wherever a single measurement shows the target the two agree; for drifts the guard is narrower."""
    need_recorded()
    ratios = {}
    for target in CURVED["states"].split():
        pairs = compare_widths(contract, target, 90)
        assert len(pairs) > 60
        ratios[target] = float(np.median(pairs[:, 0] / pairs[:, 1]))
    assert ratios["e"] <= 1 + 1e-9 and ratios["d"] < 0.9 and ratios["c"] < 0.75


def test_a_library_of_interval_methods_finds_the_box_of_the_plain_contractors():
    need_recorded()
    codac = pytest.importorskip("codac", reason="pip install codac")
    ours, theirs = (
        compare_widths(contract, "d", 40),
        compare_widths(functools.partial(contract_by_codac, codac), "d", 40),
    )
    assert np.allclose(ours, theirs, rtol=1e-6)


@pytest.mark.parametrize("outliers", [1, 2])
def test_faults_of_any_size_leave_the_level_true_and_no_epoch_is_accused_wrongly(outliers):
    rng, seconds = np.random.default_rng(5), [*range(40)]
    errors = rng.uniform(-0.6, 0.6, len(seconds))
    errors[7] = 9.0  # taken away before faults are put in
    counts = inject(rng, seconds, list(errors), outliers)
    assert counts["epochs"] > 30 and not (counts["violated"] or counts["wrong"] or counts["refused"])
    assert counts["proofs"] and counts["proved 3"] == counts["size 3"] > 0  # beyond ten bounds all are proved


def test_no_window_of_the_memory_has_more_faults_than_are_allowed():
    rng = np.random.default_rng(1)
    for outliers in (1, 2):
        for _ in range(50):
            marks = np.bincount(choose_places(rng, 200, outliers), minlength=200)
            assert np.convolve(marks, np.ones(12)).max() == outliers
