"""The guaranteed estimator on a grid of instants, by general convex solvers.

Among the unbiased linear estimators of P^T q from z_i = H(t_i)^T q + r_i, |r_i| <= sigma_i in the mean
square and of any correlation, the guaranteed standard deviation is sum_i sigma_i |Phi_i|; its minimum
is a linear programme (Lidov 1964). Least squares minimises another sum, and is judged here by the same.

A solver's word is a hint: value, constraint residual and lower bound are computed here from the
weights and multipliers that it returns, and its own status is reported as it stands.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from navsym.core.arrays import Array, frozen, named, positive
from navsym.core.errors import DomainError, MissingEngineError, NotEstimableError

#: Programme and engine; the first that is named is the default.
LP_SOLVERS = ("casadi:highs", "casadi:osqp", "cvxpy:HIGHS", "cvxpy:CLARABEL", "cvxpy:OSQP")
QP_SOLVERS = ("casadi:osqp", "casadi:highs", "cvxpy:CLARABEL", "cvxpy:OSQP", "cvxpy:HIGHS")

#: What a solver says when it believes that it has succeeded.
SUCCESS = frozenset({"Optimal", "solved", "optimal"})
SILENT = {"highs": {"highs": {"output_flag": False}}, "osqp": {"osqp": {"verbose": False}}}


@dataclass(frozen=True, slots=True, eq=False)
class GridProblem:
    """Estimate functional^T q from measurements at n instants.

    regressors : (m, n) columns H(t_i)
    functional : (m,)   P
    bounds     : (n,)   sigma_i, bounds of the standard deviations
    spacing    : (n,)   length of time that each instant stands for; only least squares needs it
    """

    regressors: Array
    functional: Array
    bounds: Any = None  # arrays once constructed
    spacing: Any = None

    def __post_init__(self) -> None:
        regressors = named("regressors", self.regressors, (None, None), "unknowns by instants")
        m, n = regressors.shape
        ones = np.ones(n)
        put = object.__setattr__
        put(self, "regressors", regressors)
        put(self, "functional", named("functional", self.functional, (m,), "one entry per unknown"))
        for name, why in (("bounds", "one entry per instant"), ("spacing", "one entry per instant")):
            value = getattr(self, name)
            put(self, name, positive(name, ones if value is None else value, (n,), why))


def grid_problem(
    regressors: Callable[..., Any],
    functional: Any,
    interval: tuple[float, float],
    *constants: float,
    intervals: int = 200,
    sigma: float = 1.0,
) -> GridProblem:
    """The problem on equally spaced instants, both ends included.

    regressors : casadi function H(tau, *constants) -> (m, 1), as made from a derived expression
    constants  : its further arguments, for example T
    intervals  : number of steps; an even one puts the middle on the grid

    The spacing is that of the trapezoidal rule.
    """
    from navsym.core.casadi_functions import on_grid

    start, end = interval
    if not start < end or intervals < 1:
        raise DomainError(
            f"interval: expected start < end and at least one step; got {interval}, {intervals}; widen it"
        )
    instants = np.linspace(start, end, intervals + 1)
    spacing = np.full(intervals + 1, (end - start) / intervals)
    spacing[[0, -1]] /= 2
    bounds = np.full(intervals + 1, float(sigma))
    return GridProblem(on_grid(regressors, instants, *constants), functional, bounds, spacing)


@dataclass(frozen=True, slots=True, eq=False)
class ConvexResult:
    """What a solver returned, and what it is worth.

    solver   : "programme:engine"
    status   : the solver's own word, or the reason why it gave none
    value    : sum sigma_i |Phi_i| of the returned weights, None when there are none
    weights  : (n,) Phi_i, or None
    residual : max |sum_i H(t_i) Phi_i - P|, computed here; None without weights
    seconds  : wall time of the solver's call
    lower    : lower bound of the optimum from the returned multipliers, made feasible here; or None
    claims   : True when the solver calls its answer a success
    """

    solver: str
    status: str
    value: float | None
    weights: Array | None
    residual: float | None
    seconds: float
    lower: float | None
    claims: bool


#: (weights or None, multipliers or None, status)
Answer = tuple[Any, Any, str]


def guaranteed_lp(problem: GridProblem, *, solver: str = LP_SOLVERS[0]) -> ConvexResult:
    """min sum sigma_i |Phi_i| subject to sum H(t_i) Phi_i = P, on the grid.

    The weights are split into positive and negative parts. Raises NotEstimableError when P does not
    lie in the range of the regressors, DomainError for an unknown solver.
    """
    need_estimable(problem)
    programme, engine = engine_of(solver, LP_SOLVERS)
    run = {"casadi": lp_by_casadi, "cvxpy": lp_by_cvxpy}[programme]
    return judged(problem, solver, run, engine)


def least_squares_qp(problem: GridProblem, *, solver: str = QP_SOLVERS[0]) -> ConvexResult:
    """min sum Phi_i^2 / spacing_i subject to sum H(t_i) Phi_i = P: least squares in continuous time.

    With Phi_i = Phi(t_i) spacing_i this is the minimum of the integral of Phi^2. Its value in the result
    is the guaranteed one, sum sigma_i |Phi_i|: what least squares yields under its own worst correlation.
    Raises DomainError for an unknown solver, NotEstimableError when the measurements do not determine the functional.
    """
    need_estimable(problem)
    programme, engine = engine_of(solver, QP_SOLVERS)
    run = {"casadi": qp_by_casadi, "cvxpy": qp_by_cvxpy}[programme]
    return judged(problem, solver, run, engine)


def engine_of(solver: str, known: tuple[str, ...]) -> tuple[str, str]:
    """ "programme:engine" as a pair; DomainError when it is not known."""
    if solver not in known:
        raise DomainError(f"solver: expected one of {', '.join(known)}; got {solver!r}; name one of them")
    programme, engine = solver.split(":")
    return programme, engine


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
            f"functional: expected a combination of the regressors at the {H.shape[1]} instants; got one "
            f"outside their range (rank {rank} of {H.shape[0]}); add instants or estimate fewer unknowns"
        )


def judged(problem: GridProblem, solver: str, run: Callable[[GridProblem, str], Answer], engine: str) -> ConvexResult:
    """Run a solver, measure it, and compute what its answer is worth."""
    start = time.perf_counter()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # "may be inaccurate" is in the status too
            weights, multipliers, status = run(problem, engine)
    except MemoryError:
        raise
    except Exception as reason:  # engines raise types of their own
        weights, multipliers, status = None, None, f"failed: {type(reason).__name__}: {first_line(reason)}"
    seconds = time.perf_counter() - start
    weights = usable(weights)
    residual = value = None
    if weights is not None:
        value = float(problem.bounds @ np.abs(weights))
        residual = float(np.abs(problem.regressors @ weights - problem.functional).max())
    lower = lower_bound(problem, usable(multipliers))
    return ConvexResult(solver, status, value, weights, residual, seconds, lower, status in SUCCESS)


def first_line(reason: Exception) -> str:
    """The first line of an error of a solver, cut short."""
    return (str(reason).strip().splitlines() or [""])[0][:120]


def usable(vector: Any) -> Array | None:
    """A finite read-only vector, or None."""
    if vector is None:
        return None
    array = np.array(vector, dtype=float).reshape(-1)
    return frozen(array) if array.size and np.isfinite(array).all() else None


def lower_bound(problem: GridProblem, multipliers: Array | None) -> float | None:
    """|x . P| / max_i |x . H(t_i)| / sigma_i: every vector x bounds the optimum from below (weak duality).

    In double precision, hence a bound up to rounding.
    """
    if multipliers is None:
        return None
    reach = np.abs(multipliers @ problem.regressors / problem.bounds).max()
    return float(abs(multipliers @ problem.functional) / reach) if reach > 0.0 else None


# --- casadi ------------------------------------------------------------------------------------------


def conic(quadratic: Any, A: Array, engine: str) -> Any:
    """A casadi solver of  min x^T Q x / 2 + g^T x,  A x = b,  lb <= x <= ub."""
    import casadi as ca

    need_one_highs(engine)
    shapes = {"h": quadratic.sparsity(), "a": ca.DM(A).sparsity()}
    return ca.conic("grid", engine, shapes, {"error_on_fail": False, "print_time": False, **SILENT[engine]})


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


def lp_by_casadi(problem: GridProblem, engine: str) -> Answer:
    """The linear programme through casadi, with weights = positive part - negative part."""
    import casadi as ca

    n = problem.regressors.shape[1]
    A = np.hstack([problem.regressors, -problem.regressors])
    solver = conic(ca.DM(2 * n, 2 * n), A, engine)
    cost = np.concatenate([problem.bounds, problem.bounds])
    answer = solver(g=cost, a=A, lba=problem.functional, uba=problem.functional, lbx=0.0, ubx=np.inf)
    x = np.array(answer["x"]).reshape(-1)
    return x[:n] - x[n:], np.array(answer["lam_a"]).reshape(-1), str(solver.stats()["return_status"])


def qp_by_casadi(problem: GridProblem, engine: str) -> Answer:
    """The quadratic programme through casadi."""
    import casadi as ca

    Q = ca.diag(ca.DM(1.0 / problem.spacing))
    solver = conic(Q, problem.regressors, engine)
    H, P = problem.regressors, problem.functional
    answer = solver(h=Q, g=0.0, a=H, lba=P, uba=P, lbx=-np.inf, ubx=np.inf)
    return np.array(answer["x"]), np.array(answer["lam_a"]), str(solver.stats()["return_status"])


# --- cvxpy -------------------------------------------------------------------------------------------


def lp_by_cvxpy(problem: GridProblem, engine: str) -> Answer:
    """The linear programme through cvxpy, with the absolute value left to it."""
    import cvxpy as cp

    weights = cp.Variable(problem.regressors.shape[1])
    objective = cp.Minimize(problem.bounds @ cp.abs(weights))
    return solved_by_cvxpy(problem, objective, weights, engine)


def qp_by_cvxpy(problem: GridProblem, engine: str) -> Answer:
    """The quadratic programme through cvxpy."""
    import cvxpy as cp

    weights = cp.Variable(problem.regressors.shape[1])
    objective = cp.Minimize(cp.sum_squares(cp.multiply(1.0 / np.sqrt(problem.spacing), weights)))
    return solved_by_cvxpy(problem, objective, weights, engine)


def solved_by_cvxpy(problem: GridProblem, objective: Any, weights: Any, engine: str) -> Answer:
    """Run cvxpy, and take weights, multipliers and its own word."""
    import cvxpy as cp

    unbiased = problem.regressors @ weights == problem.functional
    task = cp.Problem(objective, [unbiased])
    task.solve(solver=engine, verbose=False)
    return weights.value, unbiased.dual_value, str(task.status)


# --- where solvers stop being trustworthy ---------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Trust:
    """One solver on one problem whose optimum is known.

    parameter : what distinguishes the problem, for example T
    error     : |value - expected| / expected, None when there is no value
    honest    : False when the solver claims success and is off by more than ``tolerance``
    """

    parameter: float
    solver: str
    status: str
    value: float | None
    expected: float
    error: float | None
    residual: float | None
    honest: bool


def trust_table(
    problems: Iterable[tuple[float, GridProblem, float]],
    *,
    solvers: tuple[str, ...] = LP_SOLVERS,
    tolerance: float = 1e-6,
) -> tuple[Trust, ...]:
    """Every solver on every problem (parameter, problem, exact optimum), in the order given.

    The exact optimum comes from a closed form; the grid must contain its support, so that the optimum on
    the grid is the same.
    """
    rows = []
    for parameter, problem, expected in problems:
        for solver in solvers:
            result = guaranteed_lp(problem, solver=solver)
            error = None if result.value is None else abs(result.value - expected) / expected
            off = error is None or error > tolerance
            rows.append(
                Trust(
                    parameter,
                    solver,
                    result.status,
                    result.value,
                    expected,
                    error,
                    result.residual,
                    honest=not (result.claims and off),
                )
            )
    return tuple(rows)


def trusted_until(table: Iterable[Trust], *, tolerance: float = 1e-6) -> dict[str, float | None]:
    """For each solver the smallest parameter down to which it solved all within the tolerance."""
    limits: dict[str, float | None] = {}
    failed: set[str] = set()
    for row in sorted(table, key=lambda row: -row.parameter):
        limits.setdefault(row.solver, None)
        if row.error is None or row.error > tolerance:
            failed.add(row.solver)
        elif row.solver not in failed:
            limits[row.solver] = row.parameter
    return limits
