"""Ratios of the trajectory room against named peers, measured alternately in one run.

    python tests/benchmarks/trajectory.py

* adaptive filter, all 3^n candidates of a step: against batched numpy and against a numpy loop, when only the
  innovation variance differs (criterion of one step), once with the coordinate measured, where many candidates
  are equal and are not visited, and once with a combination of all states measured, where none are;
  and against batched numpy when every candidate carries its own estimate;
* certified condition numbers: against mpmath's singular values at the precision that gives 30 digits.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from fractions import Fraction

import mpmath
import numpy as np

from navsym.models.earth import observability_rows, power_rows
from navsym.trajectory.conditioning import condition_number
from navsym_papers.trajectory.experiment.inversion import (
    Start,
    SteppedModel,
    Tuning,
    adaptive_filter,
    first_stage_model,
    normalised_scale,
    scaled_model,
    windowed_filter,
)
from tests.twins.trajectory import adaptive_filter_slowly, candidates

ROUNDS = 5


def alternately(*jobs: Callable[[], object], rounds: int = ROUNDS) -> list[float]:
    """Least CPU time of each job in seconds; the jobs take turns, so that all see the same machine."""
    best = [np.inf] * len(jobs)
    for job in jobs:
        job()  # compile, warm caches
    for _ in range(rounds):
        for i, job in enumerate(jobs):
            began = time.process_time()
            job()
            best[i] = min(best[i], time.process_time() - began)
    return best


def measurements(N: int) -> np.ndarray:
    rng = np.random.default_rng(7)
    return np.cumsum(rng.normal(size=N)) + rng.normal(size=N)


def start_of(n: int) -> Start:
    return Start(np.zeros(n), np.eye(n), np.full(n, 1e-4))


# -- peers --------------------------------------------------------------------------------------------


def batched_one_step(z: np.ndarray, model: SteppedModel, start: Start, tuning: Tuning) -> np.ndarray:
    """All candidates of a step as one stack of matrices, the usual way to do it in numpy."""
    y, P, q = start.estimate.copy(), start.P.copy(), start.Q.copy()
    n, h = model.order, model.gain_row
    factors = np.array(candidates(np.ones(n), tuning.step))
    eye = np.eye(n)
    for measured in z:
        innovation = measured - model.row @ y
        diagonals = q * factors
        ahead = model.Phi @ P @ model.Phi.T + eye * diagonals[:, None, :]
        g = ahead @ h
        S = g @ h + tuning.R
        best = int(np.argmin(np.log(S) + innovation**2 / S))
        K = g[best] / S[best]
        y, P, q = model.Phi @ y + K * innovation, ahead[best] - np.outer(K, K) * S[best], diagonals[best]
    return y


def batched_windows(z: np.ndarray, model: SteppedModel, start: Start, tuning: Tuning, window: int) -> np.ndarray:
    """Every candidate carried, as stacks of vectors and matrices."""
    y, P, q = start.estimate.copy(), start.P.copy(), start.Q.copy()
    n, h, Phi = model.order, model.gain_row, model.Phi
    factors = np.array(candidates(np.ones(n), tuning.step))
    eye = np.eye(n)
    for first in range(0, len(z), window):
        diagonals = q * factors
        ys, Ps, cost = np.tile(y, (len(factors), 1)), np.tile(P, (len(factors), 1, 1)), 0.0
        noise = eye * diagonals[:, None, :]
        for measured in z[first : first + window]:
            ahead, B = ys @ Phi.T, Phi @ Ps @ Phi.T + noise
            g = B @ h
            S, innovation = g @ h + tuning.R, measured - ahead @ h
            K = g / S[:, None]
            ys, Ps = ahead + K * innovation[:, None], B - K[:, :, None] * g[:, None, :]
            Ps = (Ps + Ps.transpose(0, 2, 1)) / 2
            cost = cost + np.log(S) + innovation**2 / S
        best = int(np.argmin(cost))
        y, P, q = ys[best], Ps[best], diagonals[best]
    return y


def mpmath_condition(rows: list[list[Fraction]], equilibrate: bool, digits: int) -> mpmath.mpf:
    n = len(rows)
    with mpmath.workdps(digits):
        A = mpmath.matrix([[mpmath.mpf(x.numerator) / x.denominator for x in row] for row in rows])
        if equilibrate:
            for j in range(n):
                length = mpmath.sqrt(sum(A[i, j] ** 2 for i in range(n)))
                for i in range(n):
                    A[i, j] /= length
        values = mpmath.svd_r(A, compute_uv=False)
        return max(values) / min(values)


# -- comparisons --------------------------------------------------------------------------------------


def combined(model: SteppedModel) -> SteppedModel:
    """The same motion, measured as a combination of all states: every candidate has a variance of its own."""
    row = 1.0 / 2.0 ** np.arange(model.order)
    return SteppedModel(model.Phi, row @ model.Phi, row)


def compare_one_step(model: SteppedModel, distinct: int, steps: int, loop_steps: int) -> None:
    start, tuning = start_of(model.order), Tuning(R=1.0)
    z = measurements(steps)
    np.testing.assert_allclose(
        adaptive_filter(z[:30], model, start, tuning).states[-1],
        batched_one_step(z[:30], model, start, tuning),
        rtol=1e-9,
    )
    ours, batched, loop = alternately(
        lambda: adaptive_filter(z, model, start, tuning),
        lambda: batched_one_step(z, model, start, tuning),
        lambda: adaptive_filter_slowly(z[:loop_steps], model, start, tuning),
        rounds=7,
    )
    ours, batched, loop = ours / steps, batched / steps, loop / loop_steps
    print(
        f"one-step criterion, n = {model.order}, {3**model.order} candidates, {distinct} different variances: "
        f"{1e6 * ours:.2f} us a step; batched numpy {batched / ours:.0f} x, numpy loop {loop / ours:.0f} x slower"
    )


def compare_filters(n: int, steps: int, loop_steps: int) -> None:
    model = scaled_model(first_stage_model(n), normalised_scale(n))
    compare_one_step(model, 3, steps, loop_steps)
    compare_one_step(combined(model), 3**n, steps, loop_steps)
    start, tuning, z, window = start_of(n), Tuning(R=1.0), measurements(steps), 25
    ours, batched = alternately(
        lambda: windowed_filter(z, model, start, tuning, window=window),
        lambda: batched_windows(z, model, start, tuning, window),
        rounds=7,
    )
    print(
        f"every candidate carried, n = {n}: {1e6 * ours / steps:.1f} us a step; batched numpy "
        f"{batched / ours:.1f} x slower"
    )


def compare_conditioning(n: int, digits: int = 30) -> None:
    cases = {
        "N_p": (observability_rows(n, Fraction(1, 6371000), Fraction(1, 5)), False),
        "N_pN": (observability_rows(n, Fraction(1, 6371000), Fraction(1, 5)), True),
        "N_f": (power_rows(n), False),
        "N_s": (power_rows(n), True),
    }
    for name, (rows, equilibrate) in cases.items():
        ours = condition_number(rows, digits=digits, equilibrate=equilibrate)
        # Singular values come with an absolute error: digits wanted plus those that the ratio eats.
        working = digits + len(str(int(ours.upper))) + 5
        theirs = mpmath_condition(rows, equilibrate, working)
        assert abs(theirs / (mpmath.mpf(ours.lower.numerator) / ours.lower.denominator) - 1) < 1e-12
        ours_time, theirs_time = alternately(
            lambda rows=rows, e=equilibrate: condition_number(rows, digits=digits, equilibrate=e),
            lambda rows=rows, e=equilibrate, w=working: mpmath_condition(rows, e, w),
            rounds=7,
        )
        print(
            f"condition number {name}, n = {n}, {digits} digits: {1e3 * ours_time:.2f} ms; mpmath "
            f"({working} digits, no guarantee) {theirs_time / ours_time:.1f} x slower"
        )


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="tiny sizes, to see that it runs")
    quick = parser.parse_args(arguments).quick
    compare_filters(3 if quick else 5, 60 if quick else 4000, 20 if quick else 60)
    for n in (6,) if quick else (20, 25, 30):
        compare_conditioning(n)


if __name__ == "__main__":
    main()
