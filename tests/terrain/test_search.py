"""The compiled searches against their slow twins, and the exact search against the dense one."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from navsym.terrain.kernels.bounded import BoundedResult, search_bounded, search_one_velocity
from navsym.terrain.kernels.criteria import TOGETHER, criterion_one, dense_masked, height_at, padded, patch_rows, slab
from navsym.terrain.kernels.lattice import fits, lattice, rounded
from navsym.terrain.kernels.margins import (
    CONTRASTS,
    ceiling_of,
    double_limit,
    floor_of,
    parts_about_the_mean,
    single_limit,
)
from navsym.terrain.kernels.stages import scores
from tests.twins.terrain import dense_slowly


def random_case(generator, *, ties=False):
    """A small map, a track that stays well inside, steps and counts."""
    ny, nx = generator.integers(60, 90, 2)
    counts = tuple(int(2 * k + 1) for k in generator.integers(0, 4, 4))
    n = int(generator.integers(5, 150))
    tau = np.arange(n) / n
    if ties:
        period = generator.integers(0, 9, (4, 4)).astype(float)
        H = np.tile(period, (30, 30))[:ny, :nx].copy()
        bx, by = generator.integers(25, 35, n).astype(float), generator.integers(25, 35, n).astype(float)
        steps, rates = (4.0, 2.0), (8.0, 4.0)
    else:
        rows, columns = np.mgrid[:ny, :nx]
        H = 300 * np.sin(rows / generator.uniform(3, 12)) * np.cos(columns / generator.uniform(3, 12))
        H += generator.normal(0, generator.uniform(0, 30), H.shape)
        bx = 25 + 8 * generator.random() + generator.uniform(-3, 3) * np.arange(n) / n
        by = 25 + 8 * generator.random() + generator.uniform(-3, 3) * np.arange(n) / n
        steps, rates = tuple(generator.uniform(0.2, 1.5, 2)), tuple(generator.uniform(0.5, 3, 2))
    wx, wy = rates[0] * tau, rates[1] * tau
    if ties:
        wx, wy = np.floor(wx), np.floor(wy)
    px, py = 2 * steps[0] * (counts[0] > 3), -steps[1] * (counts[1] > 1)
    z = np.array([height_at(H, bx[k] + px, by[k] + py) for k in range(n)])
    z += 0.0 if ties else generator.normal(0, generator.uniform(0, 60), n)
    return (H, bx, by, z, wx, wy), steps, counts


def dense(arguments, steps, counts, dtype=np.float64, centred=False):
    """Criteria by the vector loop."""
    H, bx, by, z, wx, wy = arguments
    Mx, My, Mvx, Mvy = counts
    out = np.zeros((Mvx, Mvy, My, padded(Mx)), dtype)
    patch = np.empty((TOGETHER, patch_rows(by, wy, steps[1], My, Mvy, H.shape[0]), padded(Mx)), dtype)
    for Vi in range(Mvx):
        slab((H, bx, by, z.astype(dtype), wx, wy), steps, (Mx, My, Mvy), float(Vi - Mvx // 2), centred, patch, out[Vi])
    return out[..., :Mx]


def two_lowest(values):
    flat = values.ravel()
    best = int(flat.argmin())
    rest = flat.copy()
    rest[best] = np.inf
    return best, flat[best], rest.min()


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("ties", [False, True])
def test_the_vector_loop_equals_the_plain_loop_to_the_last_bit(seed, ties):
    arguments, steps, counts = random_case(np.random.default_rng(seed), ties=ties)
    slow = np.empty((counts[2], counts[3], counts[1], counts[0]))
    dense_slowly(arguments, steps, counts, slow.reshape(-1))
    assert_array_equal(dense(arguments, steps, counts), slow)


@pytest.mark.parametrize("seed", range(10))
def test_the_masked_loop_equals_the_plain_loop_on_the_map(seed):
    arguments, steps, counts = random_case(np.random.default_rng(seed))
    masked = np.empty((counts[2], counts[3], counts[1], counts[0]))
    dense_masked(arguments, steps, counts, False, masked.reshape(-1))
    assert_array_equal(dense(arguments, steps, counts), masked)


def test_the_bounded_search_equals_the_dense_search_on_600_random_cases():
    generator = np.random.default_rng(20)
    for case in range(600):
        arguments, steps, counts = random_case(generator, ties=case % 3 == 0)
        if counts == (1, 1, 1, 1):
            continue
        bound = max(np.abs(arguments[0]).max(), np.abs(arguments[3]).max())
        if bound == 0.0:
            continue
        found = search_bounded(arguments, steps, counts, bound)
        best, criterion, second = two_lowest(dense(arguments, steps, counts))
        assert (found.index, found.criterion, found.second) == (best, criterion, second), case


def lowest_by_bounding(arguments, steps, counts, centred):
    bound = max(np.abs(arguments[0]).max(), np.abs(arguments[3]).max())
    found = search_bounded(arguments, steps, counts, bound, centred=centred)
    return found.index, found.criterion, found.second


def offset_free(arguments, steps, counts):
    out = np.empty((counts[2], counts[3], counts[1], counts[0]))
    dense_masked(arguments, steps, counts, True, out.reshape(-1))
    return out


def test_without_the_height_offset_bounding_equals_the_dense_search_on_500_random_cases():
    generator = np.random.default_rng(22)
    done = 0
    while done < 500:
        arguments, steps, counts = random_case(generator, ties=done % 3 == 0)
        H, bx, by, z, wx, wy = arguments
        if counts == (1, 1, 1, 1) or not H.any():
            continue
        raised = (H, bx, by, z + generator.choice([0.0, 7.0, -1e4]), wx, wy)
        found = lowest_by_bounding(raised, steps, counts, True)
        assert found == two_lowest(offset_free(raised, steps, counts)), done
        done += 1


@pytest.mark.parametrize("centred", [False, True])
def test_hypotheses_that_leave_the_map_are_shut_out_of_the_bounded_search_as_of_the_dense_one(centred):
    generator, some_out = np.random.default_rng(23), 0
    for case in range(200):
        (H, bx, by, z, wx, wy), steps, counts = random_case(generator, ties=case % 3 == 0)
        if counts == (1, 1, 1, 1) or not H.any():
            continue
        left, top = int(generator.integers(20, 27)), int(generator.integers(20, 27))
        cut = np.ascontiguousarray(H[top : top + 18, left : left + 17])
        arguments = (cut, np.clip(bx - left, 0, 16), np.clip(by - top, 0, 17), z, wx, wy)
        out = np.empty((counts[2], counts[3], counts[1], counts[0]))
        dense_masked(arguments, steps, counts, centred, out.reshape(-1))
        some_out += bool(np.isinf(out).any() and np.isfinite(out).sum() > 1)
        found = lowest_by_bounding(arguments, steps, counts, centred)
        assert found == two_lowest(out), case
    assert some_out > 80


def test_contrasts_of_four_in_single_precision_stay_within_their_margin():
    generator = np.random.default_rng(6)
    for _ in range(40):
        arguments, steps, counts = random_case(generator)
        n = arguments[3].size // 4 * 4
        some = (arguments[0], *(a[:n] for a in arguments[1:]))
        bound = max(np.abs(some[0]).max(), np.abs(some[3]).max())
        exact, single = offset_free(some, steps, counts), dense(some, steps, counts, np.float32, centred=True)
        ceilings = [ceiling_of(e, n, bound, parts_about_the_mean(n)) for e in exact.ravel()]
        for ceiling, s in zip(ceilings, single.ravel(), strict=True):
            assert s <= single_limit(ceiling, n, bound, CONTRASTS)
        assert (floor_of(single, n, bound, CONTRASTS) <= exact * (1 + 1e-12)).all()


def test_the_search_in_single_precision_equals_the_dense_search_over_positions():
    generator = np.random.default_rng(21)
    for case in range(300):
        (H, bx, by, z, wx, wy), steps, counts = random_case(generator, ties=case % 3 == 0)
        if case % 2:
            steps = (1.0, 1.0)
        bound = max(np.abs(H).max(), np.abs(z).max())
        if bound == 0.0 or counts[:2] == (1, 1):
            continue
        found = search_one_velocity(H.astype(np.float32), (H, bx, by, z, wx, wy), steps, counts[:2], bound)
        still = np.zeros_like(bx)
        values = dense((H, bx, by, z, still, still), steps, (*counts[:2], 1, 1))
        assert (found.index, found.criterion, found.second) == two_lowest(values), case


@pytest.mark.parametrize("n", [1, 3, 4, 5, 63, 64])
def test_the_lattice_equals_the_plain_loop_to_the_last_bit(n):
    generator = np.random.default_rng(n)
    H = 300 * generator.normal(size=(61, 70))
    counts = (int(generator.choice([7, 9, 17])), 11)
    bx = rounded(generator.uniform(10, 50, n), 70)
    by = rounded(generator.uniform(10, 50, n), 70)
    z = 300 * generator.normal(size=n)
    out, still = np.zeros((counts[1], padded(counts[0]))), np.zeros(n)
    assert fits(H, bx, by, counts, out.shape[1])
    lattice(H, bx, by, z, counts, out)
    values = dense((H, bx, by, z, still, still), (1.0, 1.0), (*counts, 1, 1))
    assert_array_equal(out[:, : counts[0]], values[0, 0])


def test_the_lattice_is_left_where_it_would_read_past_the_map():
    H, low, high = np.zeros((30, 30)), np.array([10.0]), np.array([26.0])
    assert fits(H, low, low, (7, 7), 16)
    assert not fits(H, high, low, (7, 7), 16)  # the last column is a border of its own
    assert not fits(H, low, high, (7, 7), 16)
    assert not fits(H, np.array([2.0]), low, (7, 7), 16)  # off the map
    assert not fits(H, np.array([20.0]), np.array([25.0]), (7, 7), 48)  # the padding would end past the array


def test_rounded_positions_keep_their_fraction_across_powers_of_two():
    b = rounded(np.array([127.3, 1.1]), 1500)
    for shift in range(-100, 1300):
        moved = b[0] + shift
        assert moved - np.floor(moved) == b[0] - np.floor(b[0])
    assert np.abs(b - [127.3, 1.1]).max() < 1e-12


def test_equal_criteria_are_settled_for_the_first_in_the_order_of_the_grid():
    arguments, steps, counts = random_case(np.random.default_rng(3), ties=True)
    counts = (5, 5, 3, 3)
    values = dense(arguments, steps, counts)
    found = search_bounded(arguments, steps, counts, 9.0)
    assert found.criterion == found.second == values.min()
    assert found.index == int(values.argmin())


def test_single_precision_never_exceeds_its_limit_for_a_sum_within_the_ceiling():
    generator = np.random.default_rng(5)
    for _ in range(40):
        arguments, steps, counts = random_case(generator)
        n = arguments[3].size
        bound = max(np.abs(arguments[0]).max(), np.abs(arguments[3]).max())
        exact, single = dense(arguments, steps, counts), dense(arguments, steps, counts, np.float32)
        for e, s in zip(exact.ravel(), single.ravel(), strict=True):
            assert s <= single_limit(ceiling_of(e, n, bound), n, bound)
        assert (floor_of(single, n, bound) <= exact * (1 + 1e-12)).all()


def test_the_margins_only_widen():
    for value in (0.0, 1e-6, 1.0, 1e9):
        ceiling = ceiling_of(value, 1000, 2000.0)
        assert value <= ceiling <= double_limit(ceiling, 1000, 2000.0)
        assert single_limit(ceiling, 32, 2000.0) >= ceiling


def test_a_sum_that_is_abandoned_lies_above_the_limit():
    arguments, steps, _ = random_case(np.random.default_rng(1))
    whole = criterion_one(arguments, (steps[0], 0.0, 0.0, 0.0), np.inf)
    part = criterion_one(arguments, (steps[0], 0.0, 0.0, 0.0), whole / 2)
    assert whole / 2 < part <= whole


def test_the_bounded_search_says_what_it_cost():
    arguments, steps, _ = random_case(np.random.default_rng(2))
    found = search_bounded(arguments, steps, (7, 7, 5, 5), 1e4)
    assert isinstance(found, BoundedResult)
    assert 0 < found.completed <= 7 * 7 * 5 * 5
    assert all(a >= b for a, b in zip(found.survivors, found.survivors[1:], strict=False))


def test_the_offset_free_criterion_is_the_least_over_all_offsets():
    arguments, steps, _ = random_case(np.random.default_rng(4))
    counts = (3, 3, 3, 1)
    H, bx, by, z, wx, wy = arguments
    out = np.empty((3, 1, 3, 3))
    dense_masked(arguments, steps, counts, True, out.reshape(-1))
    offsets = np.linspace(-200, 200, 41)
    for b in offsets:
        assert (dense((H, bx, by, z - b, wx, wy), steps, counts) >= out - 1e-6).all()
    shifted = np.empty_like(out)
    dense_masked((H, bx, by, z + 123.0, wx, wy), steps, counts, True, shifted.reshape(-1))
    np.testing.assert_allclose(shifted, out, rtol=1e-9, atol=1e-6)


def test_scores_prefer_measurements_that_tell_hypotheses_apart():
    H = np.zeros((50, 50))
    H[:, 30:] = 100.0  # a step that only late measurements see
    n = 20
    bx, by = np.linspace(10.0, 29.5, n), np.full(n, 25.0)
    z = np.array([height_at(H, u, w) for u, w in zip(bx, by, strict=True)])
    zero = np.zeros(n)
    probes = np.arange(9)
    case, grid, unused = (H, bx, by, z, zero, zero), ((1.0, 1.0), (9, 1, 1, 1)), np.zeros(n, dtype=np.bool_)
    score = scores(case, *grid, False, probes, unused)
    assert score[-1] > 0.0 and score[0] == 0.0
    late = scores(case, *grid, True, probes, np.arange(n) < 10)
    assert (late[:10] == -1.0).all() and late[-1] > late[12] > 0.0


def test_the_benchmark_runs_in_small():
    script = Path(__file__).parents[1] / "benchmarks" / "terrain.py"
    done = subprocess.run(
        [sys.executable, str(script), "--tiny"], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0 and "exact joint, median" in done.stdout, done.stderr
