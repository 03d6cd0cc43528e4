"""The guaranteed estimator beside least squares, the Kalman filter and general solvers; its worst noise.

An estimator with weights Phi has the guaranteed standard deviation ``sum_j sigma_j integral |Phi_j|``,
reached by the noise ``r_j(t) = sigma_j sgn(Phi_j(t)) xi`` with one standard normal xi: its covariance is
``sigma_j sigma_k sgn Phi_j(t) sgn Phi_k(s)`` (Martirosyan 2023, section 2).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.guaranteed.certificate.enclosure import Panel
from navsym.guaranteed.convex import LP_SOLVERS, GridProblem, guaranteed_lp
from navsym.guaranteed.problem import GuaranteedProblem
from navsym.guaranteed.solver import GuaranteedSolution

Array = NDArray[np.float64]
GRID = 201


@dataclass(frozen=True, slots=True, eq=False)
class Sampled:
    """Regressors on Gauss-Legendre points of every panel: (m, n), lengths of time and noise bounds (n,)."""

    regressors: Array
    spacing: Array
    bounds: Array


def panel_numbers(panel: Panel, v: Array) -> tuple[Array, float, float]:
    """H (m, n) at fractions v of a panel, its length and its noise bound, in double precision."""
    values = {symbol: float(ball.mid()) for symbol, ball in panel.values.items()}
    start, end, sigma = (float(x) for x in panel.ends.numbers(values))
    inputs = {**values, panel.variable: start + (end - start) * v}
    rows = [np.broadcast_to(np.asarray(h, dtype=float), v.shape) for h in panel.program.numbers(inputs)]
    return np.array(rows), end - start, sigma


def sampled(problem: GuaranteedProblem, count: int = 4000) -> Sampled:
    """Composite Gauss points, fine enough for integrals of |Phi| to six digits."""
    nodes, weights = np.polynomial.legendre.leggauss(4)
    cells = count // 4
    v = ((np.arange(cells)[:, None] + (nodes + 1) / 2) / cells).ravel()
    share = np.tile(weights / 2 / cells, cells)
    parts = [panel_numbers(panel, v) for panel in problem.exact().panels]
    return Sampled(
        np.hstack([H for H, _, _ in parts]),
        np.concatenate([length * share for _, length, _ in parts]),
        np.concatenate([np.full(v.size, sigma) for _, _, sigma in parts]),
    )


def quadratic_estimator(samples: Sampled, functional: Array, trust: Array) -> Array:
    """Weights Phi (n,) per unit of time that minimise ``integral Phi^2 / trust`` without bias.

    trust = 1 is least squares; trust = 1 / sigma^2 is what the Kalman filter converges to that knows
    nothing beforehand and believes the noise white.
    """
    H, scale = samples.regressors, np.abs(samples.regressors).max(axis=1)
    H = H / scale[:, None]
    root = np.sqrt(trust * samples.spacing)
    Q, R = np.linalg.qr((H * root).T)
    multipliers = np.linalg.solve(R.T, functional / scale)
    density: Array = (Q @ multipliers) * root / samples.spacing
    return density


def guaranteed_deviation(samples: Sampled, density: Array) -> float:
    """``sum_j sigma_j integral |Phi_j|``: the standard deviation under the estimator's own worst correlation."""
    return float(np.sum(samples.bounds * np.abs(density) * samples.spacing))


def compare(
    solution: GuaranteedSolution,
    solvers: Sequence[str] = LP_SOLVERS,
    progress: Callable[[str], None] = lambda solver: None,
) -> dict[str, Any]:
    """Guaranteed deviation of least squares and of the white-noise Kalman filter; every solver's answer.

    progress : called with the name of each solver that has answered
    """
    problem = solution.problem
    samples = sampled(problem)
    P = np.array([float(p) for p in problem.functional])
    ones = np.ones_like(samples.bounds)
    least = guaranteed_deviation(samples, quadratic_estimator(samples, P, ones))
    kalman = guaranteed_deviation(samples, quadratic_estimator(samples, P, samples.bounds**-2.0))
    rows = []
    for name in solvers:
        rows.append(solver_row(grid_problem(problem), name, solution.value))
        progress(name)
    return {"least_squares": least, "kalman_white_noise": kalman, "optimum": solution.value, "solvers": rows}


def grid_problem(problem: GuaranteedProblem, count: int = GRID) -> GridProblem:
    """The problem on ``count`` equidistant instants per measurement and stretch, both ends included."""
    v = np.linspace(0.0, 1.0, count)
    parts = [panel_numbers(panel, v) for panel in problem.exact().panels]
    bounds = np.concatenate([np.full(count, sigma) for _, _, sigma in parts])
    return GridProblem(np.hstack([H for H, _, _ in parts]), np.array([float(p) for p in problem.functional]), bounds)


def solver_row(grid: GridProblem, name: str, optimum: float) -> dict[str, Any]:
    """The answer of one solver to the problem on the grid, beside the optimum on the interval.

    relative_error : its value / optimum - 1, None without a value
    Raises NotEstimableError, and DomainError for an unknown solver.
    """
    result = guaranteed_lp(grid, solver=name)
    error = None if result.value is None else result.value / optimum - 1.0
    return {
        "solver": name,
        "status": result.status,
        "value": result.value,
        "relative_error": error,
        "residual": result.residual,
        "seconds": result.seconds,
    }


# -- the worst noise -------------------------------------------------------------------------------


def worst_covariance(solution: GuaranteedSolution) -> Array:
    """Covariance of the noise at the support instants that reaches the guaranteed deviation."""
    signed = np.array([np.sign(float(row.weight)) * bound_of(solution, row.measurement) for row in solution.support])
    return np.outer(signed, signed)


def bound_of(solution: GuaranteedSolution, measurement: str) -> float:
    """The noise bound sigma of a measurement, by its name."""
    problem = solution.problem
    return float(problem.sigma[problem.measurements.index(measurement)])


def realise(solution: GuaranteedSolution, runs: int, seed: int = 0) -> Array:
    """Errors (runs,) of the estimate in realisations of the worst noise, in units of the target.

    The noise is normal with the covariance of :func:`worst_covariance`; the same seed gives the same errors.
    """
    random = np.random.default_rng(seed)
    weights = np.array([float(w) for w in solution.weights])
    signed = np.array([np.sign(float(r.weight)) * bound_of(solution, r.measurement) for r in solution.support])
    noise = random.standard_normal(runs)[:, None] * signed
    errors: Array = noise @ weights
    return errors


def search_correlations(solution: GuaranteedSolution, tries: int, seed: int = 0) -> float:
    """Largest standard deviation that random admissible correlations of the noise produce.

    A correlation matrix is ``U U^T`` with rows of unit length; the search keeps the best and shakes it.
    """
    random = np.random.default_rng(seed)
    weights = np.array([float(w) for w in solution.weights])
    loads = weights * np.array([bound_of(solution, row.measurement) for row in solution.support])
    best, best_U = 0.0, random.standard_normal((loads.size, loads.size))
    for k in range(tries):
        fresh = random.standard_normal(best_U.shape)
        U = fresh if k % 3 == 0 else best_U + 0.3 * fresh
        U = U / np.linalg.norm(U, axis=1, keepdims=True)
        deviation = float(np.linalg.norm(loads @ U))
        if deviation > best:
            best, best_U = deviation, U
    return best
