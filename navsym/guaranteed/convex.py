"""The guaranteed estimator on a grid of times, by general convex solvers.

Among the unbiased linear estimators of P^T q from z_i = H(t_i)^T q + r_i, |r_i| <= sigma_i in the mean
square and of any correlation, the guaranteed standard deviation is sum_i sigma_i |Phi_i|; its minimum
is a linear programme (Lidov 1964). Least squares minimises another sum, and is judged here by the same.

A solver's word is a hint: value and constraint residual are computed here from the weights that it returns, and
its own status is reported as it stands.
"""

from __future__ import annotations

import sys
import time
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from navsym.core.arrays import Array, as_array, as_positive, freeze
from navsym.core.errors import DomainError, MissingEngineError, NotEstimableError
from navsym.guaranteed.problem import GuaranteedProblem

#: Programme and engine; the first that is named is the default.
LP_SOLVERS = ("casadi:highs", "casadi:osqp", "cvxpy:HIGHS", "cvxpy:CLARABEL", "cvxpy:OSQP")
MOST_TIMES = 100_000

SILENT = {"highs": {"highs": {"output_flag": False}}, "osqp": {"osqp": {"verbose": False}}}


@dataclass(frozen=True, slots=True, eq=False)
class GridProblem:
    """Estimate functional^T q from measurements at n times.

    regressors : (m, n) columns H(t_i)
    functional : (m,)   P
    bounds     : (n,)   sigma_i, bounds of the standard deviations; ones by default
    spacing    : (n,)   length of time that each time stands for, ones by default; only least squares needs it
    times      : (n,)   t_i; by default their numbers
    """

    regressors: Array
    functional: Array
    bounds: Any = None  # arrays once constructed
    spacing: Any = None
    times: Any = None

    def __post_init__(self) -> None:
        regressors = as_array("regressors", self.regressors, (None, None), "unknowns by times")
        m, n = regressors.shape
        ones = np.ones(n)
        put = object.__setattr__
        put(self, "regressors", regressors)
        put(self, "functional", as_array("functional", self.functional, (m,), "one entry per unknown"))
        for name in ("bounds", "spacing"):
            value = getattr(self, name)
            put(self, name, as_positive(name, ones if value is None else value, (n,), "one entry per time"))
        times = np.arange(n) if self.times is None else self.times
        put(self, "times", as_array("times", times, (n,), "one entry per time"))


def grid_problem(problem: GuaranteedProblem, count: int = 201) -> GridProblem:
    """The problem on ``count`` equidistant times per measurement and piece, both ends included.

    The spacing is that of the trapezoidal rule. Raises DomainError for fewer than two times, or too many.
    """
    if not 2 <= count <= MOST_TIMES:
        raise DomainError(f"grid: expected 2 to {MOST_TIMES} times; got {count}; choose a number between")
    share = np.full(count, 1.0 / (count - 1))
    share[[0, -1]] /= 2
    return sampled_problem(problem, np.linspace(0.0, 1.0, count), share)


def sampled_problem(problem: GuaranteedProblem, v: Array, share: Array) -> GridProblem:
    """The problem at fractions v (n,) of every measurement and piece, each of which stands for a share (n,) of it."""
    panels = problem.exact().panels
    parts = [(panel.numbers(v), [float(e.mid()) for e in panel.edges()]) for panel in panels]
    return GridProblem(
        np.hstack([H for (_, H, _), _ in parts]),
        np.array([float(p) for p in problem.functional]),
        np.concatenate([np.full(v.size, sigma) for (_, _, sigma), _ in parts]),
        np.concatenate([(end - start) * share for _, (start, end, _) in parts]),
        np.concatenate([times for (times, _, _), _ in parts]),
    )


@dataclass(frozen=True, slots=True, eq=False)
class ConvexResult:
    """What a solver returned, and what it is worth.

    solver   : "programme:engine"
    status   : the solver's own word, or the reason why it gave none
    value    : sum sigma_i |Phi_i| of the returned weights, None when there are none
    weights  : (n,) Phi_i, or None
    residual : max |sum_i H(t_i) Phi_i - P|, computed here; None without weights
    seconds  : wall time of the solver's call
    """

    solver: str
    status: str
    value: float | None
    weights: Array | None
    residual: float | None
    seconds: float


def guaranteed_lp(problem: GridProblem, *, solver: str = LP_SOLVERS[0]) -> ConvexResult:
    """min sum sigma_i |Phi_i| subject to sum H(t_i) Phi_i = P, on the grid.

    The weights are split into positive and negative parts. Raises NotEstimableError when P does not
    lie in the range of the regressors, DomainError for an unknown solver.
    """
    need_estimable(problem)
    if solver not in LP_SOLVERS:
        raise DomainError(f"solver: expected one of {', '.join(LP_SOLVERS)}; got {solver!r}; name one of them")
    programme, engine = solver.split(":")
    run = {"casadi": lp_by_casadi, "cvxpy": lp_by_cvxpy}[programme]
    start = time.perf_counter()
    found: Any = None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # "may be inaccurate" is in the status too
            found, status = run(problem, engine)
    except MemoryError:
        raise
    except Exception as reason:  # engines raise types of their own
        said = (str(reason).strip().splitlines() or [""])[0][:120]
        status = f"failed: {type(reason).__name__}: {said}"
    seconds = time.perf_counter() - start
    weights = None if found is None else np.array(found, dtype=float).reshape(-1)
    if weights is None or not weights.size or not np.isfinite(weights).all():
        return ConvexResult(solver, status, None, None, None, seconds)
    residual = float(np.abs(problem.regressors @ weights - problem.functional).max())
    return ConvexResult(solver, status, float(problem.bounds @ np.abs(weights)), freeze(weights), residual, seconds)


def need_estimable(problem: GridProblem) -> None:
    """Refuse a functional that clearly lies outside the range of the regressors.

    Rows are scaled to one. Clearly means a gap in the singular values: where they fall off smoothly, as
    for a steep basis, double precision cannot tell, and the residual of the answer has to.
    """
    scale = np.abs(problem.regressors).max(axis=1)
    scale[scale == 0.0] = 1.0
    H, P = problem.regressors / scale[:, np.newaxis], problem.functional / scale
    weights, _, rank, values = np.linalg.lstsq(H, P, rcond=None)
    outside = np.abs(H @ weights - P).max() > 1e-6 * np.abs(P).max()
    if outside and (rank == 0 or values[rank - 1] > 1e-8 * values[0]):
        raise NotEstimableError(
            f"functional: expected a combination of the regressors at the {H.shape[1]} times; got one "
            f"outside their range (rank {rank} of {H.shape[0]}); add times or estimate fewer unknowns"
        )


# --- casadi ------------------------------------------------------------------------------------------


def need_one_highs(engine: str) -> None:
    """Refuse to load casadi's HiGHS beside another shared one: the process would die in it.

    Since 1.14 highspy brings a shared library under the same name as casadi's; whichever comes
    second is bound to the first. Earlier versions of highspy are self-contained.
    """
    loaded = sys.modules.get("highspy")
    if engine != "highs" or loaded is None or not loaded.__file__:
        return
    if any(Path(loaded.__file__).parent.glob("libhighs*")):
        raise MissingEngineError(
            "casadi:highs: expected one HiGHS library in the process; got a second one with highspy; "
            'install "highspy<1.14"'
        )


def lp_by_casadi(problem: GridProblem, engine: str) -> tuple[Any, str]:
    """The linear programme through casadi, with weights = positive part - negative part."""
    import casadi as ca

    n = problem.regressors.shape[1]
    A = np.hstack([problem.regressors, -problem.regressors])
    need_one_highs(engine)
    shapes = {"h": ca.DM(2 * n, 2 * n).sparsity(), "a": ca.DM(A).sparsity()}
    solver = ca.conic("grid", engine, shapes, {"error_on_fail": False, "print_time": False, **SILENT[engine]})
    cost = np.concatenate([problem.bounds, problem.bounds])
    answer = solver(g=cost, a=A, lba=problem.functional, uba=problem.functional, lbx=0.0, ubx=np.inf)
    x = np.array(answer["x"]).reshape(-1)
    return x[:n] - x[n:], str(solver.stats()["return_status"])


# --- cvxpy -------------------------------------------------------------------------------------------


def lp_by_cvxpy(problem: GridProblem, engine: str) -> tuple[Any, str]:
    """The linear programme through cvxpy, with the absolute value left to it."""
    import cvxpy as cp

    weights = cp.Variable(problem.regressors.shape[1])
    unbiased = problem.regressors @ weights == problem.functional
    task = cp.Problem(cp.Minimize(problem.bounds @ cp.abs(weights)), [unbiased])
    task.solve(solver=engine, verbose=False)
    return weights.value, str(task.status)
