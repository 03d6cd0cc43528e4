"""Ratios of the trajectory room against named peers, measured alternately in one run.

    python tests/benchmarks/trajectory.py

Certified condition numbers: against mpmath's singular values at the precision that gives 30 digits.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable
from fractions import Fraction

import mpmath

from navsym.models.earth import observability_rows, power_rows
from navsym.trajectory.conditioning import condition_number

ROUNDS = 5


def alternately(*jobs: Callable[[], object], rounds: int = ROUNDS) -> list[float]:
    """Least CPU time of each job in seconds; the jobs take turns, so that all see the same machine."""
    best = [math.inf] * len(jobs)
    for job in jobs:
        job()  # compile, warm caches
    for _ in range(rounds):
        for i, job in enumerate(jobs):
            began = time.process_time()
            job()
            best[i] = min(best[i], time.process_time() - began)
    return best


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
    for n in (6,) if quick else (20, 25, 30):
        compare_conditioning(n)


if __name__ == "__main__":
    main()
