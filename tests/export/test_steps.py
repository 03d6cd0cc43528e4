"""Exported programs are the algorithms of the theory: init once, step by step; what is refused changes nothing."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from numpy.testing import assert_allclose

from navsym.core.errors import DomainError
from navsym.export.chain import Chain, Link
from navsym.export.functions import RefusedError
from navsym.export.languages.c import files
from navsym.multimodel.bank import Bank
from navsym.multimodel.filters import run_filter
from navsym.multimodel.kalman import correct, predict
from navsym.terrain.centre import information
from navsym_papers.guaranteed_velocity.model import H, T, tau
from navsym_papers.joint_correction import programs as observer
from navsym_papers.joint_correction.experiment.observer import hold_measurements
from navsym_papers.joint_correction.inertial import joint_model
from tests.benchmarks import export as benchmark
from tests.export import programs

PROGRAM = """#include "trajectory_filter.h"
#include <math.h>
#include <stdio.h>

int main(void)
{
    static const double zero[3] = {0.0, 0.0, 0.0}, bad[3] = {NAN, 0.0, 0.0}, q[3] = {0.25, 0.125, 0.0625};
    static const double one[6] = {1.0, 0.0, 0.0, 1.0, 0.0, 1.0}, P[6] = {4.0, 0.0, 0.0, 3.0, 0.0, 2.0};
    trajectory_filter_state s;
    double z;
    if (trajectory_filter_init(&s, bad, one) != NAVSYM_DOMAIN) { return 1; }
    if (trajectory_filter_init(&s, zero, P) != NAVSYM_OK) { return 2; }
    while (scanf("%lf", &z) == 1) {
        const navsym_status status = trajectory_filter_step(&s, q, 0.5, z);
        if (isnan(z) ? (status != NAVSYM_DOMAIN) : (status != NAVSYM_OK)) { return 3; }
        printf("%.17g %.17g %.17g %.17g %.17g\\n", s.f[0], s.f[1], s.f[2], s.P[0], s.P[5]);
    }
    return 0;
}
"""
MEASUREMENTS = [*np.sin(np.arange(12.0)), np.nan, 0.5]


@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs a C compiler")
def test_the_exported_filter_follows_the_textbook(tmp_path: Path) -> None:
    functions = programs.functions("trajectory-filter")
    for name, text in files(functions, {f.name: [] for f in functions}, programs.LICENSE).items():
        if not name.startswith("test_"):
            (tmp_path / name).write_text(text)
    (tmp_path / "main.c").write_text(PROGRAM)
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror"]
    sources = [*(f"{f.name}.c" for f in functions), "main.c"]
    subprocess.run(["gcc", *flags, *sources, "-o", "run", "-lm"], cwd=tmp_path, check=True, timeout=120)
    text = " ".join(map(repr, map(float, MEASUREMENTS)))
    done = subprocess.run([str(tmp_path / "run")], input=text, capture_output=True, text=True, check=True, timeout=60)
    rows = [[float(x) for x in line.split()] for line in done.stdout.splitlines()]
    assert_allclose(rows, textbook(), rtol=1e-12, atol=1e-13)


def test_a_refused_measurement_leaves_the_python_state_as_it_was() -> None:
    made = programs.module("trajectory-filter").trajectory_filter([0.0] * 3, [4.0, 0.0, 0.0, 3.0, 0.0, 2.0])
    rows = []
    for z in MEASUREMENTS:
        if np.isnan(z):
            with pytest.raises(ValueError, match="z: expected numbers"):
                made.step([0.25, 0.125, 0.0625], 0.5, z)
        else:
            made.step([0.25, 0.125, 0.0625], 0.5, z)
        rows.append([*made.f, made.P[0], made.P[5]])
    assert_allclose(rows, textbook(), rtol=1e-12, atol=1e-13)


def textbook() -> list[list[float]]:
    """The same filter by the house's own Kalman step: Phi of Pascal's triangle, the first state is measured."""
    F = np.array([[1.0, 1.0, 1.0], [0.0, 1.0, 2.0], [0.0, 0.0, 1.0]])
    Q, row, R = np.diag([0.25, 0.125, 0.0625]), np.array([[1.0, 0.0, 0.0]]), np.array([[0.5]])
    mean, P, rows = np.zeros(3), np.diag([4.0, 3.0, 2.0]), []
    for z in MEASUREMENTS:
        if not np.isnan(z):
            mean, P = predict(mean, P, F, Q)
            mean, P, _ = correct(mean, P, np.array([z]), row, R)
        rows.append([*mean, P[0, 0], P[2, 2]])
    return rows


# -- pulsating ---------------------------------------

MODELS = [
    {"F": [[1.0, 0.5], [-0.2, 0.9]], "Q": [[0.3, 0.1], [0.1, 0.2]], "H": [[1.0, 0.2]], "R": [[0.5]]},
    {"F": [[0.8, 0.1], [0.3, 1.1]], "Q": [[0.9, 0.0], [0.0, 0.7]], "H": [[0.4, 1.0]], "R": [[2.0]]},
]
TRANSITION = [[0.9, 0.1], [0.25, 0.75]]


def test_the_exported_pulsating_filter_is_the_house_filter() -> None:
    series = np.random.default_rng(3).normal(0.0, 3.0, 40)
    models = Bank(
        MODELS, TRANSITION, {"mean": [1.0, -1.0], "covariance": [[2.0, 0.3], [0.3, 1.0]], "probabilities": [0.6, 0.4]}
    )
    expected = run_filter(models, series[:, None], "pulsating")
    made = programs.module("pulsating-filter").pulsating_filter([1.0, -1.0], [2.0, 0.3, 1.0], [0.6, 0.4])
    for k, z in enumerate(series):
        made.step(*(x for m in MODELS for x in plainly(m)), np.ravel(TRANSITION), z)
        assert_allclose(made.mean, expected.mean[k], rtol=1e-9, atol=1e-10)
        assert_allclose(made.covariance, expected.covariance[k][[0, 0, 1], [0, 1, 1]], rtol=1e-9)
        assert_allclose(made.probabilities, expected.probabilities[k], rtol=1e-9, atol=1e-12)


def plainly(m: dict) -> tuple:
    return np.ravel(m["F"]), [m["Q"][0][0], m["Q"][0][1], m["Q"][1][1]], m["H"][0], m["R"][0][0]


def test_a_measurement_far_from_both_modes_still_weighs_them() -> None:
    made = programs.module("pulsating-filter").pulsating_filter([0.0, 0.0], [1.0, 0.0, 1.0], [0.5, 0.5])
    made.step(*(x for m in MODELS for x in plainly(m)), np.ravel(TRANSITION), 200.0)
    assert_allclose(np.sum(made.probabilities), 1.0, rtol=1e-14)


# -- two stages ---------------------------------------

VALUES = {"mu": 0.08, "omega_1": 0.6, "omega_2": -0.4, "u_3": 0.7}


def test_the_exported_observer_follows_the_exact_solution_within_its_stated_error() -> None:
    made = programs.module("two-stage-observer").two_stage_observer(0.9, 0.3, np.zeros(6), np.zeros(4))
    model, h = joint_model(), 0.02
    symbols = {s.name: s for s in model.F.free_symbols | model.H.free_symbols}
    table = {symbols[name]: value for name, value in VALUES.items() if name in symbols}
    F, rows = (np.array(M.subs(table), dtype=float) for M in (model.F, model.H))
    gains = np.zeros((10, 4))
    gains[:3, 0], gains[3:6, 1] = made.Kc[:3], made.Kc[3:]
    gains[6:8, 2], gains[8:, 3] = made.Kh[:2], made.Kh[2:]
    A = F - gains @ rows
    Phi, Gamma = hold_measurements(A, gains, h)
    state, generator, room = np.zeros(10), np.random.default_rng(1), 0.0
    for _ in range(60):
        sigma = generator.normal(0.0, 1.0, 4)
        state = Phi @ state + Gamma @ sigma
        made.step(*VALUES_IN_ORDER, sigma[:2], sigma[2:], h)
        room += (np.linalg.norm(A, 2) * h) ** 5 / 120 * (np.abs(state).max() + np.abs(sigma).max())
        assert np.abs(np.array([*made.x, *made.y]) - state).max() <= room
    assert room < 1e-4


VALUES_IN_ORDER = (VALUES["mu"], VALUES["u_3"], VALUES["omega_1"], VALUES["omega_2"])


def test_the_gains_belong_to_the_channels_of_the_paper() -> None:
    model = joint_model()
    uncoupled = {s: 0 for s in model.F.free_symbols | model.H.free_symbols}
    F, rows = model.F.subs(uncoupled), model.H.subs(uncoupled)
    gains = sp.zeros(10, 4)
    found = observer.gain_formulas()
    for k, (row, gain) in enumerate(zip((0, 0, 0, 1, 1, 1, 2, 2, 3, 3), found, strict=True)):
        gains[k, row] = gain
    p = sp.Symbol("p")
    polynomial = (p * sp.eye(10) - (F - gains * rows)).det(method="berkowitz")
    assert sp.expand(polynomial - (p + observer.lam_c) ** 6 * (p + observer.lam_h) ** 4) == 0


# -- velocity ---------------------------------------


@pytest.mark.parametrize("state", ["y1", "y2", "y3"])
@pytest.mark.parametrize("end", [0.4, 1.5, 2.5, 3.3, 4.4, 5.5, 6.2])
def test_the_queue_estimates_without_bias_in_every_regime(state: str, end: float) -> None:
    name = f"velocity-estimator-{state}"
    made = getattr(programs.module(name), name.replace("-", "_"))(end)
    truth, before = np.array([0.3, -1.1, 0.7]), -1.0
    for _ in range(4):  # one more than there are instants
        at = float(made.instants[0])
        assert -1e-15 <= before <= at <= end or before < 0
        row = np.array(H().subs({T: end, tau: at}), dtype=float)[:, 0]
        made.step(float(row @ truth))
        before = at
    assert_allclose(made.sum, truth[int(state[1]) - 1], atol=1e-12)
    assert float(made.value) >= 1.0 - 1e-12


def test_the_value_is_the_sum_of_the_sizes_of_the_weights() -> None:
    start = programs.module("velocity-estimator-y3").velocity_estimator_y3_start
    _, weights, _, value = start(np.linspace(0.1, 6.28, 200))
    assert_allclose(np.abs(weights).sum(axis=-1), value, rtol=1e-13)


# -- terrain, earth ---------------------------------------


def test_sums_over_the_track_give_the_crossing_times_of_the_house() -> None:
    generator = np.random.default_rng(5)
    p, q = generator.normal(0.0, 1.0, (2, 50))
    made = programs.module("terrain-crossing").terrain_crossing([0.0] * 3, [0.0] * 3, 0.0)
    for slope in zip(p, q, strict=True):
        made.step(*slope)
    info = information(p, q, np.arange(50.0))
    low, high, mean = programs.module("terrain-t-G-extremes").terrain_t_G_extremes(made.G, made.M)
    angles = np.linspace(0.0, np.pi, 100_001)[:-1]
    v = np.stack([np.cos(angles), np.sin(angles)])
    quotients = np.sum(v * (info.M1 @ v), axis=0) / np.sum(v * (info.G @ v), axis=0)
    assert_allclose([low, high, mean], [*info.interval, quotients.mean()], rtol=1e-12)
    found = programs.module("terrain-t-G").terrain_t_G(made.G, made.M, np.cos(angles), np.sin(angles))
    assert_allclose([found.min(), found.max(), found.mean()], [low, high, mean], rtol=1e-8)


def test_geocentric_position_is_that_of_another_program() -> None:
    from pyproj import Transformer

    turn = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)
    e = np.sqrt(2 / 298.257223563 - 1 / 298.257223563**2)
    for latitude, height in ((0.0, 0.0), (0.7, 1200.0), (-1.2, 9000.0)):
        x, y, z = turn.transform(30.0, np.degrees(latitude), height)
        made = programs.module("earth-geocentric").earth_geocentric(latitude, height * 1e-6, 6.378137, e)
        assert_allclose(made[0], np.arctan2(z, np.hypot(x, y)), rtol=1e-13, atol=1e-15)
        assert_allclose(made[1] * 1e6, np.sqrt(x * x + y * y + z * z), rtol=1e-14)


def test_the_correction_moves_along_the_velocity_error_from_the_crossing() -> None:
    call = programs.module("terrain-correction").terrain_correction
    position, velocity = call(100.0, 200.0, 50.0, -20.0, 3, -4, 2, 1, 50.0, 50.0, 1.0, 1.0, 500.0, 10.0, 480.0, 0.5)
    assert_allclose(position, [100 + 150 + 2 * (500 - 250), 200 - 200 + (500 - 250)])
    assert_allclose(velocity, [52.0, -19.0])


# -- what does not hold does not leave ---------------------------------------

a, b = sp.symbols("a b", real=True)


def test_a_link_whose_theorem_fails_is_refused() -> None:
    from navsym.claims import Equation

    wrong = Link(("s",), "", (a + b,), lambda: Equation(a + b, a - b))
    with pytest.raises(RefusedError, match="refuted"):
        Chain("wrong", (wrong,), {"s": "s"}).function("wrong", programs.decided, "double")


def test_a_refuted_claim_in_a_chain_names_its_correction() -> None:
    chain = Chain("printed", (Link(("x",), "trajectory:earth.tan_phi"),), {"x": "x"})
    with pytest.raises(RefusedError, match=r"earth\.tan_phi\*"):
        chain.function("printed", programs.decided, "double")


def test_a_value_does_not_enter_a_claim_with_a_proved_range() -> None:
    links = (Link(("radius",), "", (a,)), Link(("rate",), "trajectory:kinematics.phi_rate"))
    with pytest.raises(DomainError, match="proved range"):
        Chain("loose", links, {"rate": "rate"}).function("loose", programs.decided, "double")


@pytest.mark.long
@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs a C compiler")
def test_the_benchmark_runs_at_a_tiny_size() -> None:
    assert {"hand-written C", "casadi C", "lambdify(cse=True), batch"} <= set(benchmark.measure(1000))
    assert set(benchmark.measure_update(50)) == {"Kalman update, hand-written C", "Kalman update, casadi C"}
