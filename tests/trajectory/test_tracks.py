"""Velocity and acceleration of tracks: identities, consistency on simulated data, edges of the Earth, real data."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import linprog
from scipy.stats import chi2

from navsym.core.errors import DomainError, EmptyError, ShapeError
from navsym.models.earth import ECCENTRICITY_SQUARED, SEMI_MAJOR, cartesian, local_axes, prime_vertical_radius
from navsym.trajectory.estimate import (
    METHODS,
    Settings,
    by_method,
    covariance_root,
    estimate,
    gaps,
    least_squares,
    marginal,
    minimum_sum,
    minimum_sum_certificate,
    minimum_sum_solution,
    noise_points,
    window_of,
)
from navsym.trajectory.kernels.tracks import ROWS, noise_root, transition
from navsym.trajectory.motion import describe_motion
from navsym.trajectory.reader import TrackFile
from navsym.trajectory.tracks import Fit, Noise, Positions, isolated_outliers, noise_of, project_positions, shaped


def document(t, positions, settings, lines=None):
    """The document of positions that stand in no file."""
    rows = np.arange(1, len(t) + 1) if lines is None else lines
    return describe_motion(TrackFile(t, t, t, t, None, rows), positions, settings).document()


def flat_track(t, position):
    """A track in fixed axes, without an Earth."""
    N = len(t)
    return Positions(t, position, np.ones((N, 3)), np.broadcast_to(np.eye(3), (N, 3, 3)))


def step_of(dt, q, n):
    """Transition and noise matrices of a step."""
    Phi, rows, g = np.empty((n, n)), np.empty((ROWS, n)), np.empty(n)
    transition(dt, 0.0, Phi, g)
    noise_root(dt, 0.0, rows, g)
    return Phi, q * rows[:n].T @ rows[:n]


def simulated(seed, N=400, q=0.02, sigma=2.0, order=3, gaps=True):
    """Motion driven by white noise of density q in the derivative of the given order, and noisy positions."""
    rng = np.random.default_rng(seed)
    steps = rng.uniform(0.5, 1.5, N) if gaps else np.ones(N)
    if gaps:
        steps[N // 2] = 12.0
    t = np.cumsum(steps)
    truth = np.zeros((3, N, order))
    for k in range(1, N):
        Phi, Q = step_of(t[k] - t[k - 1], q, order)
        for c in range(3):
            truth[c, k] = Phi @ truth[c, k - 1] + np.linalg.cholesky(Q) @ rng.normal(size=order)
    return t, truth, truth[:, :, 0].T + sigma * rng.normal(size=(N, 3))


def drifting(seed, rate, N=600, dt=0.2):
    """Motion with accelerations of 0.5 m/s^2 over 3 s; every other 12 s errors drift at a rate (m/s), and go again.

    White errors are 5 mm and 3 cm, the given deviations 1 cm and 30 cm: as of positions fixed and float.
    """
    rng, t, bad = np.random.default_rng(seed), dt * np.arange(N), (np.arange(N) // 60) % 2 == 1
    kept = np.exp(-dt / 3)
    a, v, p, d, e, z = (np.zeros((N, 3)) for _ in range(6))
    for k in range(N):
        fresh = np.sqrt(1 - kept**2) * rng.normal(size=(2, 3))
        a[k] = kept * a[k - 1] + 0.5 * fresh[0]
        v[k] = v[k - 1] + dt * a[k]
        p[k] = p[k - 1] + dt * (v[k] + v[k - 1]) / 2
        d[k] = (kept * d[k - 1] + rate * fresh[1]) * bad[k]
        e[k] = (e[k - 1] + dt * d[k]) * bad[k]
        z[k] = p[k] + e[k] + (0.03 if bad[k] else 0.005) * rng.normal(size=3)
    variance = np.repeat(np.where(bad, 0.3, 0.01)[:, None] ** 2, 3, axis=1)
    return v, bad, Positions(t, z, variance, np.broadcast_to(np.eye(3), (N, 3, 3)))


# -- weights -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("weights", [least_squares, minimum_sum])
@pytest.mark.parametrize("derivative", [1, 2])
def test_weights_are_exact_for_polynomials(weights, derivative):
    dt = np.array([-2.0, -1.3, -0.4, 0.0, 0.7, 1.1, 2.2])
    w, deviation = weights(dt, np.ones(7), 4, derivative)
    values = [0.0, 1.0, 2.0, 0.0][derivative] if derivative == 1 else 2.0
    moments = [w @ dt**p for p in range(4)]
    expected = [values if p == derivative else 0.0 for p in range(4)]
    assert_allclose(moments, expected, atol=1e-12)
    norm = np.abs(w).sum() if weights is minimum_sum else np.sqrt(w @ w)
    assert_allclose(deviation, norm, rtol=1e-12)


def test_minimum_sum_weights_are_those_of_a_linear_programme():
    rng = np.random.default_rng(3)
    for _ in range(5):
        dt, sigma = np.sort(rng.uniform(-3, 2, 15)), rng.uniform(0.5, 2, 15)
        _, value = minimum_sum(dt, sigma, 4, 1)
        V = np.vander(dt, 4, increasing=True)
        both = linprog(np.r_[sigma, sigma], A_eq=np.hstack([V.T, -V.T]), b_eq=[0, 1, 0, 0])
        assert_allclose(value, both.fun, rtol=1e-9)


@pytest.mark.parametrize("order", [2, 3, 4, 6])
def test_minimum_sum_weights_carry_exact_bounds_from_both_sides(order):
    rng = np.random.default_rng(order)
    for derivative in (1, 2) if order > 2 else (1,):
        dt, sigma = np.round(np.sort(rng.uniform(-30, 20, 40)), 6), rng.uniform(0.5, 2, 40)
        w, value, nodes, dual = minimum_sum_solution(dt, sigma, order, derivative)
        found = minimum_sum_certificate(dt, sigma, order, derivative, nodes, dual)
        assert found.lower <= found.upper and found.gap < 1e-12
        assert_allclose(float(found.upper), value, rtol=1e-10)
        # Bounds hold for any proposal: a wrong dual only lowers the lower one.
        spoiled = minimum_sum_certificate(dt, sigma, order, derivative, nodes, dual * [1.5, *[1.0] * (order - 1)])
        assert spoiled.lower <= found.upper and spoiled.gap >= found.gap
        # Other nodes are feasible too, and no better.
        other = sorted(rng.choice(40, order, replace=False).tolist())
        assert minimum_sum_certificate(dt, sigma, order, derivative, other, dual).upper >= found.lower


def test_the_guaranteed_method_reports_its_certificates():
    t, _, measured = simulated(2, N=80)
    data = document(t, flat_track(t, measured), Settings("guaranteed", window=15.0))
    assert data["certificate"]["examined"] >= 60 and data["certificate"]["largest_gap"] < 1e-10
    assert document(t, flat_track(t, measured), Settings())["certificate"] is None


def test_minimum_sum_weights_bound_the_error_of_any_noise_and_least_squares_may_not():
    dt = np.linspace(-5, 5, 21)
    w, value = minimum_sum(dt, np.ones(21), 3, 1)
    v, deviation = least_squares(dt, np.ones(21), 3, 1)
    worst = np.sign(v)
    assert abs(v @ worst) > 1.5 * deviation
    assert abs(w @ worst) <= value + 1e-12 < abs(v @ worst)


# -- methods on simulated tracks -----------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
def test_a_parabola_is_differentiated_exactly(method):
    t = np.cumsum(np.random.default_rng(1).uniform(0.2, 1.8, 60))
    position = np.column_stack([3 + 2 * t, -t + 0.05 * t**2, 0 * t])
    found, _ = estimate(flat_track(t, position), Settings(method, 3, window=12.0 if "win" in method else None))
    assert_allclose(found.velocity[5:], np.column_stack([0 * t + 2, -1 + 0.1 * t, 0 * t])[5:], atol=2e-3)
    assert_allclose(found.derivatives[1][0][5:, 1], 0.1, atol=2e-2)
    assert set(found.flags) == {"used"}


@pytest.mark.parametrize("method", ["smoother", pytest.param("filter", marks=pytest.mark.long)])
@pytest.mark.parametrize("order", [pytest.param(2, marks=pytest.mark.long), 3])
def test_standard_deviations_are_consistent_with_the_errors(method, order):
    """Normalised squared errors of independent stretches lie in the 95 % range of their mean."""
    total, count = 0.0, 0
    for seed in range(6):
        t, truth, measured = simulated(seed, q=0.02, sigma=2.0, order=order)
        found, _ = estimate(flat_track(t, measured), Settings(method, order))
        error = (found.velocity - truth[:, :, 1].T) / found.velocity_sd
        # Far enough apart to be independent.
        picked = error[40:-10:40]
        total, count = total + float((picked**2).sum()), count + picked.size
    low, high = chi2.ppf([0.025, 0.975], count) / count
    assert low < total / count < high


@pytest.mark.long
@pytest.mark.parametrize("order", [2, 3])
def test_estimated_noise_costs_no_more_consistency_than_known_noise(order):
    """On the same tracks the squared errors over their variances are at most five per cent above those of known noise.

    They may be an eighth below: what the noise may be has errors that look like motion, and the deviations count them.
    """
    means = {"known": [], "estimated": []}
    for seed in range(40, 52):
        t, truth, measured = simulated(seed, q=0.02, sigma=2.0, order=order)
        track, use = flat_track(t, measured), np.ones(len(t), np.int64)
        known = by_method(track, Noise(np.full(3, 4.0), np.full(3, 0.02)), Settings(order=order, gate=0.0), use)
        for name, found in (("known", known), ("estimated", estimate(track, Settings(order=order))[0])):
            means[name].append((((found.velocity - truth[:, :, 1].T) / found.velocity_sd)[20:-10] ** 2).mean())
    assert -0.125 < np.mean(means["estimated"]) / np.mean(means["known"]) - 1 < 0.05


def test_points_of_the_noise_have_the_covariance_of_its_estimate():
    t, _, measured = simulated(3)
    track, use = flat_track(t, measured), np.ones(400, np.int64)
    noise = noise_of(track, 3, use, gate=5.0)
    points = noise_points(track, 3, use, noise, gate=5.0)
    weights = np.array([weight for weight, _ in points])
    logs = np.log10([[moved.scale[0], moved.density[0]] for _, moved in points])
    logs -= np.log10([noise.scale[0], noise.density[0]])
    assert_allclose(weights.sum(), 1.0)
    assert_allclose(weights @ logs, 0.0, atol=1e-12)
    root = covariance_root(Fit(track, 3, use, (0, 1), 5.0, False), noise, 0)
    assert_allclose((logs * weights[:, None]).T @ logs, root @ root.T, rtol=1e-9)
    # 400 rows in two channels: the scale is known to about 2 log10(e) / sqrt(2 * 800 * share of the noise).
    assert 0.02 < np.sqrt((root @ root.T)[0, 0]) < 0.06


def test_a_long_track_takes_its_noise_from_the_middle_and_hardly_differs(monkeypatch):
    t, truth, measured = simulated(4)
    track, told = flat_track(t, measured), []
    whole = estimate(track, Settings(order=3))[0]
    for module in ("tracks", "estimate"):
        monkeypatch.setattr(f"navsym.trajectory.{module}.LONGEST_FIT", 150)
    found = estimate(track, Settings(order=3), lambda done, of, doing: told.append((done, of)))[0]
    assert (np.abs(found.velocity - whole.velocity) < whole.velocity_sd).all()
    assert 0.7 < np.median(found.velocity_sd / whole.velocity_sd) < 1.4
    done = [step[0] for step in told]
    assert done == sorted(set(done)) and told[-1][0] == told[-1][1] - 1


@pytest.mark.parametrize("method", ["filter", "smoother"])
@pytest.mark.parametrize("order", [2, 3])
def test_with_known_noise_the_errors_lie_in_the_95_per_cent_range(method, order):
    noise = Noise(np.full(3, 4.0), np.full(3, 0.02))
    errors = []
    for seed in range(8):
        t, truth, measured = simulated(seed, q=0.02, sigma=2.0, order=order)
        found = by_method(flat_track(t, measured), noise, Settings(method, order), np.ones(len(t), np.int64))
        errors.append(((found.velocity - truth[:, :, 1].T) / found.velocity_sd)[40:-10:40].ravel())
    squares = np.concatenate(errors) ** 2
    low, high = chi2.ppf([0.025, 0.975], squares.size) / squares.size
    assert low < squares.mean() < high


@pytest.mark.long
def test_errors_that_drift_where_deviations_are_large_are_no_motion():
    """Deviations hold with the drift, and are far too small without; what does not drift is not said to."""
    speed, bad, track = drifting(0, 0.5)
    found, noise = estimate(track, Settings())
    squares = ((found.velocity - speed) / found.velocity_sd) ** 2
    assert 0.7 < squares.mean() < 1.5 and (noise.drift > 0).all()
    deviation = noise.drifting(track, 0)[bad][0]
    assert 0.35 < deviation < 0.75 and 1.5 < noise.lasting[0] < 6.0
    plain = noise_of(track, 3, np.ones(600, dtype=np.int64), gate=5.0)
    without = marginal(track, [(np.ones(3), plain)], Settings(), np.ones(600, dtype=np.int64))
    assert (((without.velocity - speed) / without.velocity_sd) ** 2).mean() > 3
    assert (estimate(drifting(0, 0.0)[2], Settings())[1].drift == 0).all()


def test_slow_errors_that_look_like_motion_are_counted():
    """Errors of 2 m that last 10 s: the likeliest noise alone takes some for motion; its deviations are too small."""
    means = {"all": [], "likeliest": []}
    for seed in range(4):
        rng = np.random.default_rng(seed)
        t, slow, kept = np.arange(300.0), rng.normal(size=(300, 3)), np.exp(-0.1)
        for k in range(1, 300):
            slow[k] = kept * slow[k - 1] + np.sqrt(1 - kept**2) * slow[k]
        waves, phases = 2 * np.pi / rng.uniform(25, 150, (4, 3)), rng.uniform(0, 2 * np.pi, (4, 3))
        angle = waves * t[:, None, None] + phases
        speed = (0.4 / waves * np.sin(angle)).sum(axis=1)
        place = -(0.4 / waves**2 * np.cos(angle)).sum(axis=1)
        track, use = flat_track(t, place + 2 * slow + rng.normal(size=(300, 3))), np.ones(300, np.int64)
        noises = shaped(track, 3, use, noise_of(track, 3, use, gate=5.0), gate=5.0, fixed_scale=False)
        assert abs(sum(weight for weight, _ in noises) - np.ones(3)).max() < 1e-9
        for name, taken in (("all", noises), ("likeliest", [(np.ones(3), noises[0][1])])):
            found = marginal(track, taken, Settings(), use)
            means[name].append((((found.velocity - speed) / found.velocity_sd)[5:-5] ** 2).mean())
    assert 0.7 < np.mean(means["all"]) < 1.5 < np.mean(means["likeliest"])


@pytest.mark.parametrize("known", [True, False])
def test_a_steady_acceleration_near_what_the_rows_can_tell_is_counted(known):
    """Three deviations of its least squares: taken for none, the squared errors were 14 times their variance."""
    t, squares = np.arange(60.0), []
    acceleration = 3 * np.sqrt(720 / 60) / 60**2
    for seed in range(4):
        noise = np.random.default_rng(seed).normal(size=(60, 3))
        place, speed = (np.outer(part, np.ones(3)) for part in (t**2 / 2 * acceleration, t * acceleration))
        found, _ = estimate(flat_track(t, place + noise), Settings(fixed_scale=known))
        squares.append(np.mean(((found.velocity - speed) / found.velocity_sd) ** 2))
    assert 0.2 < np.mean(squares) < 2


def test_the_first_row_of_a_straight_track_is_as_good_as_the_last():
    """A motion that forgets begins as it goes on: with a wide first acceleration the first speed was off by 5 m/s."""
    t, rng = np.arange(60.0), np.random.default_rng(3)
    place = np.outer(t, [7.0, 11.0, 0.0]) + rng.normal(size=(60, 3)) * [0.0, 1.0, 1.0]
    found, _ = estimate(flat_track(t, place), Settings())
    assert (found.velocity_sd[0] < 2 * found.velocity_sd[-1]).all()
    assert (np.abs(found.velocity[0] - [7.0, 11.0, 0.0]) < 4 * found.velocity_sd[0]).all()


def test_the_noise_of_a_track_is_found():
    scale, density = [], []
    for seed in range(4):
        t, _, measured = simulated(seed, N=800, q=0.02, sigma=2.0)
        noise = noise_of(flat_track(t, measured), 3, np.ones(800, np.int64), gate=5.0)
        scale, density = [*scale, *noise.scale[[0, 2]]], [*density, *noise.density[[0, 2]]]
    assert_allclose(np.sqrt(scale), 2.0, rtol=0.1)
    assert_allclose(np.median(density), 0.02, rtol=0.5)


def test_isolated_outliers_are_left_out_and_harm_nothing():
    t, truth, measured = simulated(1, sigma=1.0, gaps=False)
    wild = measured.copy()
    wild[[50, 121, 300]] += [[400.0, 0, 0], [0, -300.0, 50], [90, 90, 0]]
    assert np.flatnonzero(isolated_outliers(flat_track(t, wild))).tolist() == [50, 121, 300]
    clean, _ = estimate(flat_track(t, measured), Settings())
    found, _ = estimate(flat_track(t, wild), Settings())
    assert [k for k, flag in enumerate(found.flags) if flag == "outlier"] == [50, 121, 300]
    assert np.abs(found.velocity - clean.velocity).max() < 4 * clean.velocity_sd.max()


@pytest.mark.long
@pytest.mark.parametrize("method", ["window", "guaranteed", "smoother"])
def test_neighbouring_outliers_and_outliers_beside_gaps_harm_little(method):
    t, _, measured = simulated(1, sigma=1.0)
    wild = measured.copy()
    wild[[50, 51, 198, 201]] += [[400.0, 0, 0], [-300.0, 100.0, 0], [0, 80.0, 0], [0, 0, -90.0]]
    clean, _ = estimate(flat_track(t, measured), Settings(method))
    found, _ = estimate(flat_track(t, wild), Settings(method))
    assert [k for k, flag in enumerate(found.flags) if flag == "outlier"] == [50, 51, 198, 201]
    assert np.abs(found.velocity - clean.velocity).max() < 4 * clean.velocity_sd.max()


def test_a_manoeuvre_is_not_an_outlier():
    t = np.arange(200.0)
    turn = np.where(t < 100, 20.0 * t, 2000 + 12.0 * (t - 100))  # brakes from 20 to 12 m/s in a second
    position = np.column_stack([turn, 0 * t, 0 * t]) + np.random.default_rng(3).normal(size=(200, 3)) * 0.3
    found, _ = estimate(flat_track(t, position), Settings())
    assert "outlier" not in found.flags


@pytest.mark.long
def test_the_smoother_beats_the_filter_and_both_beat_differences():
    t, truth, measured = simulated(7, sigma=3.0, q=0.005)
    rms = {}
    for method in METHODS:
        found, _ = estimate(flat_track(t, measured), Settings(method))
        rms[method] = np.sqrt(np.mean((found.velocity - truth[:, :, 1].T)[10:] ** 2))
    assert rms["smoother"] < rms["filter"] < rms["differences"]
    assert rms["window"] < rms["differences"] and rms["guaranteed"] < rms["differences"]


# -- the Earth -----------------------------------------------------------------------------------------


def geographic(path):
    """A track through given Earth-fixed points, by Newton's method on the closed formulas of the model."""
    import pyproj

    back = pyproj.Transformer.from_crs("EPSG:4978", "EPSG:4979", always_xy=True)
    lon, lat, height = back.transform(*np.asarray(path).T)
    return np.radians(lat), np.radians(lon), np.asarray(height)


@pytest.mark.parametrize("latitude, longitude", [(0.7, np.pi), (0.7, -np.pi), (np.pi / 2, 0.3), (-np.pi / 2, 0.0)])
def test_the_date_line_and_the_poles_are_ordinary_points(latitude, longitude):
    axes = local_axes(latitude, longitude)
    t = np.arange(41.0)
    speed = 10 * axes[1] + 3 * axes[0]  # towards north and east of the middle point
    path = cartesian(latitude, longitude, 20.0) + (t[:, None] - 20.3) * speed
    lat, lon, height = geographic(path)
    found, _ = estimate(project_positions(t, lat, lon, height), Settings("window", window=9.0))
    expected = np.einsum("kij,j->ki", local_axes(lat, lon), speed)
    assert_allclose(found.velocity, expected, atol=1e-4)


def test_longitudes_may_be_written_from_zero_to_a_full_turn():
    t = np.arange(30.0)
    lon = np.radians(np.linspace(-0.001, 0.001, 30))
    one = project_positions(t, np.full(30, 0.5), lon, np.zeros(30))
    two = project_positions(t, np.full(30, 0.5), lon % (2 * np.pi), np.zeros(30))
    assert_allclose(one.position, two.position, atol=1e-8)


# -- bad input -----------------------------------------------------------------------------------------


def straight_drive(seed, rows=60):
    """Three metres east and two north a second near 45 degrees, to a metre: t, latitude, longitude, height."""
    rng, t = np.random.default_rng(seed), np.arange(float(rows))
    parallel = prime_vertical_radius(np.pi / 4) * np.cos(np.pi / 4)
    north, east, up = 2 * t + rng.normal(size=rows), 3 * t + rng.normal(size=rows), rng.normal(size=rows)
    meridian = prime_vertical_radius(np.pi / 4) ** 3 * ((1 - ECCENTRICITY_SQUARED) / SEMI_MAJOR**2)
    return t, np.pi / 4 + north / meridian, 0.2 + east / parallel, 100 + up


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("lost", [(30,), (29, 30, 31)])
def test_the_velocity_of_a_lost_fix_at_zero_zero_is_that_of_its_neighbours(method, lost):
    """A receiver without a fix writes zeros; their row once had a good velocity in the axes of the Gulf of Guinea."""
    t, *where = straight_drive(5)
    for column in where:
        column[list(lost)] = 0.0
    found, _ = estimate(project_positions(t, *where), Settings(method, order=2))
    assert all(found.flags[k] != "used" for k in lost)
    error = (found.velocity - [3.0, 2.0, 0.0]) / found.velocity_sd
    assert np.abs(error[list(lost)]).max() < 4


@pytest.mark.parametrize("method", METHODS)
def test_two_receivers_merged_in_one_track_are_one_track(method):
    """Pairs of rows a nanosecond apart once made every other step a gap, and the noise was looked for in vain."""
    t, *where = straight_drive(6)
    t = np.repeat(t, 2) + np.tile([0.0, 2e-9], len(t))
    rng = np.random.default_rng(7)
    twice = [
        np.repeat(column, 2) + scale * rng.normal(size=2 * len(column))
        for column, scale in zip(where, (1e-7, 1e-7, 1.0), strict=True)
    ]
    found, _ = estimate(project_positions(t, *twice), Settings(method, order=2))
    assert list(gaps(project_positions(t, *twice))) == []
    error = (found.velocity - [3.0, 2.0, 0.0]) / found.velocity_sd
    assert np.isfinite(found.velocity_sd).all() and np.abs(error[20:-20]).max() < 5


def test_the_window_of_a_long_straight_track_does_not_grow_with_it():
    """Its memory is as long as itself; every row once looked at all others, for hours at 20,000 rows."""
    t, *where = straight_drive(8, rows=3000)
    track = project_positions(t, *where)
    quiet = Noise(np.ones(3), np.full(3, 1e-18))
    assert window_of(track, quiet, Settings("window", order=2)) == 1000.0
    assert window_of(track, quiet, Settings("window", order=2, window=2500.0)) == 2500.0


def test_bad_tracks_say_what_is_wrong():
    t = np.arange(3.0)
    with pytest.raises(EmptyError, match="at least 2 rows"):
        project_positions(t[:1], t[:1], t[:1], t[:1])
    with pytest.raises(ShapeError, match="at least 4 rows for 3 states"):
        estimate(project_positions(t, t * 1e-6, t * 1e-6, t), Settings())
    with pytest.raises(DomainError, match="convert degrees"):
        project_positions(t, t + 45, t, t)
    with pytest.raises(DomainError, match="increasing times"):
        project_positions(np.array([0.0, 1.0, 1.0]), t * 0, t * 0, t)
    with pytest.raises(DomainError, match="method"):
        Settings("magic")
    with pytest.raises(DomainError, match="window"):
        Settings(window=-1.0)
    with pytest.raises(DomainError, match="order"):
        estimate(flat_track(np.arange(20.0), np.zeros((20, 3))), Settings(order=9))


def test_a_track_that_stands_still_has_no_speed_and_finite_deviations():
    t = np.arange(50.0)
    for method in METHODS:
        found, _ = estimate(project_positions(t, t * 0 + 0.5, t * 0 + 1.0, t * 0 + 3.0), Settings(method))
        assert np.abs(found.velocity).max() < 1e-6
        assert np.isfinite(found.velocity_sd).all() and np.isfinite(found.derivatives[1][1]).all()


# -- real data -----------------------------------------------------------------------------------------


def real(name):
    folder = os.environ.get("NAVSYM_DATA", "")
    path = Path(folder) / "gnss_ins" / name
    if not folder or not path.is_file():
        pytest.skip(f"the recorded track is not here: set NAVSYM_DATA to a folder with gnss_ins/{name}")
    return path


def reference(name, columns):
    table = np.genfromtxt(real(name), delimiter=",", skip_header=1)
    return table[:, 0], table[:, columns]


@pytest.mark.parametrize("method, limit", [("smoother", 0.2), ("filter", 0.3), ("window", 0.25), ("differences", 0.25)])
def test_speed_of_a_car_from_its_reference_positions(method, limit):
    from navsym.trajectory.reader import read_track

    t, velocity = reference("pyins_gnss.csv", [5, 4, 6])
    velocity[:, 2] *= -1
    track = read_track(real("pyins_gnss.csv"))
    found, _ = estimate(project_positions(track.t, track.latitude, track.longitude, track.height), Settings(method))
    assert_allclose(track.t, t)
    assert np.sqrt(np.mean((found.velocity - velocity) ** 2, axis=0)).max() < limit


def test_speed_of_a_car_from_single_point_positions_with_gaps_and_outliers():
    from navsym.trajectory.reader import read_track

    t, velocity = reference("nagoya_reference.csv", [11, 12, 13])
    read = read_track(real("nagoya_rover_1Hz_spp.pos"))
    times = read.t - 2270 * 604800
    track = project_positions(times, read.latitude, read.longitude, read.height, read.sigma)
    expected = np.column_stack([np.interp(times, t, velocity[:, i]) for i in range(3)])
    rms = {}
    for method in ("smoother", "window", "guaranteed", "differences"):
        found, _ = estimate(track, Settings(method))
        rms[method] = np.sqrt(np.mean((found.velocity - expected)[:, :2] ** 2))
    assert rms["smoother"] < 1.3
    assert rms["smoother"] < rms["window"] < rms["differences"]
    assert rms["guaranteed"] < rms["differences"]
    remarks = document(times, track, Settings(), lines=read.lines)["warnings"]
    assert any("gap" in line for line in remarks) and any("left out" in line for line in remarks)


def speed_correlations(t, order, q=0.02, r=4.0):
    """Correlations (N, N) of the smoother's errors of the speed, from the information of all states at once."""
    N = len(t)
    information = np.diag(np.tile([1 / r, *[0.0] * (order - 1)], N))
    information[:order, :order] += 1e-6 * np.eye(order)
    for k in range(1, N):
        Phi, Q = step_of(t[k] - t[k - 1], q, order)
        rows, both = np.hstack([-Phi, np.eye(order)]), slice((k - 1) * order, (k + 1) * order)
        information[both, both] += rows.T @ np.linalg.solve(Q, rows)
    covariance = np.linalg.inv(information)[1::order, 1::order]
    deviation = np.sqrt(np.diag(covariance))
    return covariance / np.outer(deviation, deviation)


@pytest.mark.parametrize(("order", "worth"), [(2, 133), (3, 78)])
def test_the_squared_errors_of_370_rows_are_worth_far_fewer(order, worth):
    """Errors of neighbours are correlated: the band of independent rows is twice too narrow, and 1.10 no wonder in it.

    The mean of N squared normal errors with the correlations R has the variance 2/N^2 sum R^2, that of 2/var
    independent ones; rows forty apart are independent.
    """
    noise, means = Noise(np.full(3, 4.0), np.full(3, 0.02)), []
    t = simulated(0, order=order)[0]
    R = speed_correlations(t, order)
    counted = R[20:-10, 20:-10]
    spread = np.sqrt(2 * (counted**2).sum()) / len(counted)
    assert round(2 / spread**2) == worth and np.abs(R[40:-10:40, 40:-10:40] - np.eye(9)).max() < 1e-3
    for seed in range(700, 716):
        t, truth, measured = simulated(seed, order=order)
        found = by_method(flat_track(t, measured), noise, Settings(order=order, gate=0.0), np.ones(len(t), np.int64))
        means.append((((found.velocity - truth[:, :, 1].T) / found.velocity_sd)[20:-10] ** 2).mean())
    assert abs(np.mean(means) - 1) < 3 * spread / np.sqrt(3 * len(means))


@pytest.mark.slow
def test_over_a_hundred_tracks_the_squared_errors_have_the_mean_one():
    """Order 3, estimated noise: 1.010 with a standard error of 0.012; single samples of twenty tracks lie up to 1.1."""
    means = []
    for seed in range(1000, 1100):
        t, truth, measured = simulated(seed, order=3)
        found, _ = estimate(flat_track(t, measured), Settings(order=3))
        means.append((((found.velocity - truth[:, :, 1].T) / found.velocity_sd)[20:-10] ** 2).mean())
    assert abs(np.mean(means) - 1.0) < 3 * np.std(means) / np.sqrt(len(means))
