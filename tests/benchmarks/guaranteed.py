"""Guaranteed estimation against cvxpy with HiGHS and highspy on grids: ``python tests/benchmarks/guaranteed.py``.

Peers and navsym run alternately in one process; medians of a few rounds, in seconds of processor time. (a) the
optimum alone, (b) with its certificate of relative width 1e-14, (c) a thousand lengths of the interval; beside each
figure stands its goal. "Cold" is with the basis of the problem made anew for every call.
"""

from __future__ import annotations

import argparse
import statistics
import time
import warnings
from dataclasses import replace

import cvxpy as cp
import highspy
import numpy as np
import sympy as sp

from navsym.core.simplex import simplex
from navsym.guaranteed.certificate.basis import cached_basis, make_basis
from navsym.guaranteed.certificate.enclosure import Panel, PanelProblem
from navsym.guaranteed.certificate.fixed import certify
from navsym.guaranteed.phases.family import Family, U
from navsym.guaranteed.search.alternance import find_alternance, local_maxima
from navsym.guaranteed.search.exchange import find_contacts
from navsym.guaranteed.search.kernels import contact_system, grid_values
from tests.benchmarks.lengths import follow_lengths, values_for_lengths
from tests.benchmarks.twofold import lagrangian, sharp_panels

t = sp.Symbol("t", real=True)


def problem(rows, functional, end):
    return PanelProblem(
        (Panel(0, tuple(map(sp.sympify, rows)), t, sp.Integer(0), sp.sympify(end), sp.Integer(1)),),
        tuple(map(sp.sympify, functional)),
    )


def unit(m, k):
    return [int(j == k) for j in range(m)]


MIXED = [
    1,
    t,
    t**2,
    sp.sin(t),
    sp.cos(t),
    sp.sin(2 * t),
    sp.cos(2 * t),
    sp.exp(-t),
    t * sp.exp(-t),
    sp.exp(t / 2),
    t * sp.sin(t),
    t * sp.cos(t),
]
PROBLEMS = {
    "velocity, T = pi/2, y3": problem([1, -sp.sin(sp.pi / 2 - t), sp.cos(sp.pi / 2 - t) - 1], unit(3, 2), sp.pi / 2),
    "monomials m = 8, e6": problem([t**k for k in range(8)], unit(8, 6), 1),
    "mixed basis of 12, sin(t)": problem(MIXED, unit(12, 3), 6),
}


def grid_arrays(case, count):
    _, H, _ = case.panels[0].numbers(np.linspace(0.0, 1.0, count))
    return H, np.array([float(p) for p in case.functional])


def by_cvxpy(H, P):
    x = cp.Variable(len(P))
    task = cp.Problem(cp.Maximize(P @ x), [H.T @ x <= 1, H.T @ x >= -1])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            task.solve(solver=cp.HIGHS)
        except cp.SolverError:
            return float("nan")
    return float("nan") if task.value is None else float(task.value)


def by_highspy(H, P):
    m, n = H.shape
    solver = highspy.Highs()
    solver.setOptionValue("output_flag", False)
    lp = highspy.HighsLp()
    lp.num_col_, lp.num_row_ = m, n
    lp.sense_ = highspy.ObjSense.kMaximize
    lp.col_cost_, lp.col_lower_, lp.col_upper_ = (P, np.full(m, -highspy.kHighsInf), np.full(m, highspy.kHighsInf))
    lp.row_lower_, lp.row_upper_ = -np.ones(n), np.ones(n)
    lp.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    lp.a_matrix_.start_ = np.arange(0, m * n + 1, m)
    lp.a_matrix_.index_ = np.tile(np.arange(m), n)
    lp.a_matrix_.value_ = np.ascontiguousarray(H.T).ravel()
    solver.passModel(lp)
    solver.run()
    return solver.getInfo().objective_function_value


def alone(case):
    return prepared(case)()


def anew(case):
    """The same problem without anything that was made for it: no tape of its functions, no basis."""
    cached_basis.cache_clear()
    return replace(case, panels=tuple(map(replace, case.panels)))


def cold(case):
    """The same with the basis made anew: what the first call costs."""
    return alone(anew(case))


def certified_cold(case):
    """The certificate with the basis made anew, too."""
    return certify(anew(case), 14)


def prepared(case):
    """The search only, with basis and grid made before, as the peers get their matrix."""
    basis = make_basis(case)
    sharp = sharp_panels(basis, case)
    return lambda: sharp.value(find_contacts(sharp.panels)) * basis.scale


def timed(function, repeats):
    """Seconds of processor time for one call, the mean of some: other programs on the machine do not count."""
    start = time.process_time()
    for _ in range(repeats):
        value = function()
    return (time.process_time() - start) / repeats, value


SEARCH, WHOLE, COLD = "(a) search", "(a) whole", "(a) whole, cold"
CERTIFIED, CERTIFIED_COLD = "(b) certified", "(b) certified, cold"
REPEATS = {SEARCH: 50, WHOLE: 50, COLD: 5, CERTIFIED: 5, CERTIFIED_COLD: 5}
#: What is to be reached: largest error, and how many times faster than cvxpy with HiGHS and than highspy alone.
ALONE, WITH_CERTIFICATE, LENGTHS = (2e-15, 1000, 300), (1e-14, 20, None), 10_000
GOALS = {SEARCH: ALONE, WHOLE: ALONE, CERTIFIED: WITH_CERTIFICATE, CERTIFIED_COLD: WITH_CERTIFICATE}


def compare_case(name, case, count, rounds):
    H, P = grid_arrays(case, count)
    exact = certify(case, 25)
    reference = (float(exact.lower) + float(exact.upper)) / 2
    run = prepared(case)
    jobs = {
        "cvxpy+HiGHS": lambda: by_cvxpy(H, P),
        "highspy": lambda: by_highspy(H, P),
        SEARCH: run,
        WHOLE: lambda: alone(case),
        COLD: lambda: cold(case),
        CERTIFIED: lambda: certify(case, 14),
        CERTIFIED_COLD: lambda: certified_cold(case),
    }
    for job in jobs.values():
        job()
    seconds = {key: [] for key in jobs}
    values = {}
    for _ in range(rounds):
        for key, job in jobs.items():
            if key in (WHOLE, CERTIFIED):
                alone(case)  # the basis is kept in these: cold jobs threw it away
            one, values[key] = timed(job, REPEATS.get(key, 1))
            seconds[key].append(one)
    median = {key: statistics.median(s) for key, s in seconds.items()}
    print(f"{name}: optimum {reference:.15g}, grid of {count}")
    for key, s in median.items():
        value = values[key]
        certified = key in (CERTIFIED, CERTIFIED_COLD)
        error = value.width if certified else abs(value / reference - 1)
        most, than_cvxpy, than_highspy = GOALS.get(key, (None, None, None))
        accuracy = beside(f"{error:.1e}", most, "<=")
        slower = [
            beside(f"{median[peer] / s:.0f}", goal)
            for peer, goal in (("cvxpy+HiGHS", than_cvxpy), ("highspy", than_highspy))
        ]
        print(
            f"  {key:19} {1e3 * s:9.3f} ms  {'width' if certified else 'error'} {accuracy}"
            f"  cvxpy/this {slower[0]}  highspy/this {slower[1].rstrip()}"
        )


def beside(figure, goal, sign=">="):
    """A figure and its goal, where there is one."""
    return f"{figure:>7} {'' if goal is None else f'({sign} {goal:g})':11}"


def compare_lengths(count, grid):
    rows = ((sp.Integer(1), sp.sin(U), sp.cos(U) - 1),)
    family = Family(
        rows,
        (sp.Integer(0), sp.Integer(0), sp.Integer(1)),
        (sp.Integer(1),),
        sp.Symbol("T", positive=True),
        True,
        ("z",),
        "y3",
    )
    lengths = np.linspace(0.2, 2.0, count)
    values_for_lengths(family, lengths[:5])
    seconds, values = timed(lambda: values_for_lengths(family, lengths), 3)
    exact = np.cos(lengths / 2) / np.sin(lengths / 4) ** 2
    peer = []
    for T in lengths[:: max(1, count // 5)]:
        u = np.linspace(0.0, T, grid)
        H = np.array([np.ones_like(u), np.sin(u), np.cos(u) - 1])
        peer.append(timed(lambda H=H: by_cvxpy(H, np.array([0.0, 0.0, 1.0])), 1)[0])
    whole = statistics.mean(peer) * count
    print(
        f"(c) {count} lengths: navsym {1e3 * seconds:.1f} ms, worst error {np.abs(values / exact - 1).max():.1e}; "
        f"cvxpy+HiGHS {whole:.1f} s (from {len(peer)} of them), cvxpy/this {whole / seconds:.0f} (>= {LENGTHS})"
    )


def main(count=10_000, rounds=3, lengths=1000, compiled=False):
    if compiled:
        for loop in (find_alternance, contact_system, grid_values, lagrangian, local_maxima, simplex):
            loop.compiled()
        follow_lengths.compiled()
    for name, case in PROBLEMS.items():
        compare_case(name, case, count, rounds)
    compare_lengths(lengths, count)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--grid", type=int, default=10_000)
    parser.add_argument("--rounds", type=int, default=3)
    arguments = parser.parse_args()
    main(arguments.grid, arguments.rounds, compiled=True)
