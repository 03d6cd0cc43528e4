"""The guaranteed estimator beside least squares, the Kalman filter and general solvers.

An estimator with weights Phi has the guaranteed standard deviation ``sum_j sigma_j integral |Phi_j|``,
reached by the noise ``r_j(t) = sigma_j sgn(Phi_j(t)) xi`` with one standard normal xi: its covariance is
``sigma_j sigma_k sgn Phi_j(t) sgn Phi_k(s)`` (Martirosyan 2023, section 2).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from navsym.core.answers import Answer
from navsym.core.tables import Table
from navsym.guaranteed.convex import LP_SOLVERS, GridProblem, grid_problem, guaranteed_lp, sampled_problem
from navsym.guaranteed.problem import GuaranteedProblem

if TYPE_CHECKING:
    from navsym.guaranteed.solver import Estimator

Array = NDArray[np.float64]


def sample_regressors(problem: GuaranteedProblem, count: int = 4000) -> GridProblem:
    """Composite Gauss points, fine enough for integrals of |Phi| to six digits."""
    nodes, weights = np.polynomial.legendre.leggauss(4)
    cells = count // 4
    v = ((np.arange(cells)[:, None] + (nodes + 1) / 2) / cells).ravel()
    return sampled_problem(problem, v, np.tile(weights / 2 / cells, cells))


def quadratic_estimator(samples: GridProblem, trust: Array) -> Array:
    """Weights Phi (n,) per unit of time that minimise ``integral Phi^2 / trust`` without bias.

    trust = 1 is least squares; trust = 1 / sigma^2 is what the Kalman filter converges to that knows
    nothing beforehand and believes the noise white.
    """
    H, scale = samples.regressors, np.abs(samples.regressors).max(axis=1)
    H = H / scale[:, None]
    root = np.sqrt(trust * samples.spacing)
    Q, R = np.linalg.qr((H * root).T)
    multipliers = np.linalg.solve(R.T, samples.functional / scale)
    density: Array = (Q @ multipliers) * root / samples.spacing
    return density


def guaranteed_deviation(samples: GridProblem, density: Array) -> float:
    """``sum_j sigma_j integral |Phi_j|``: the standard deviation under the estimator's own worst correlation."""
    return float(np.sum(samples.bounds * np.abs(density) * samples.spacing))


@dataclass(frozen=True, slots=True, repr=False)
class SolverAnswer:
    """The answer of a general solver to the problem on a grid, beside the optimum on the interval.

    solver         : "programme:engine"
    status         : its own word
    value          : ``sum sigma_i |w_i|`` of its weights, None where it gave none
    relative_error : its value / optimum - 1
    residual       : largest ``|sum H(t_i) w_i - P|``
    seconds        : wall time
    """

    solver: str
    status: str
    value: float | None
    relative_error: float | None
    residual: float | None
    seconds: float


@dataclass(frozen=True, slots=True, repr=False)
class Comparison(Answer):
    """Guaranteed standard deviations of other estimators, in units of the target.

    least_squares      : of least squares, under its own worst correlation
    kalman_white_noise : of the Kalman filter that takes the noise to be white, under its own worst correlation
    optimum            : of the guaranteed estimator
    solvers            : answers of general solvers on a grid of times

    >>> import navsym as nav
    >>> beside = nav.solve("examples/schuler-velocity.toml", "drift", T="pi/2").compare(solvers=["casadi:highs"])
    >>> beside.least_squares > 1.4 * beside.optimum, beside.solvers[0].solver
    (True, 'casadi:highs')
    """

    least_squares: float
    kalman_white_noise: float
    optimum: float
    solvers: tuple[SolverAnswer, ...]

    def document(self) -> dict[str, Any]:
        """The value of ``compare`` in the document of ``navsym solve --compare``."""
        return asdict(self) | {"solvers": [asdict(answer) for answer in self.solvers]}

    def rows(self) -> list[tuple[str, str, float | None]]:
        """Estimator, status and guaranteed deviation, one row each."""
        own = [("least squares", "", self.least_squares), ("Kalman, white noise", "", self.kalman_white_noise)]
        return [*own, *((answer.solver, answer.status, answer.value) for answer in self.solvers)]

    def __repr__(self) -> str:
        least, kalman = f"least squares {self.least_squares:.6g}", f"Kalman filter {self.kalman_white_noise:.6g}"
        return f"Comparison(optimum {self.optimum:.6g}, {least}, {kalman}, {len(self.solvers)} solvers)"

    def table(self) -> Table:
        """The table of ``--compare``."""
        rows = [("guaranteed", "", self.optimum), *self.rows()]
        heads = ("estimator", "status", "guaranteed deviation")
        return heads, [(*row[:2], "" if row[2] is None else f"{row[2]:.6g}") for row in rows]


def compare_estimators(
    estimator: Estimator, solvers: Sequence[str] = LP_SOLVERS, progress: Callable[[str], None] = lambda solver: None
) -> Comparison:
    """Guaranteed deviation of least squares and of the white-noise Kalman filter; every solver's answer.

    progress : called with the name of each solver that has answered

    Raises NotEstimableError, and DomainError for an unknown solver.
    """
    problem = estimator.problem
    samples, grid = sample_regressors(problem), grid_problem(problem)
    return compare_on_grid(samples, grid, float(estimator.value), solvers, progress)


def compare_on_grid(
    samples: GridProblem, grid: GridProblem, optimum: float, solvers: Sequence[str], progress: Callable[[str], None]
) -> Comparison:
    """The same where least squares and filter measure at the samples, and the solvers on a grid."""
    ones = np.ones_like(samples.bounds)
    least = guaranteed_deviation(samples, quadratic_estimator(samples, ones))
    kalman = guaranteed_deviation(samples, quadratic_estimator(samples, samples.bounds**-2.0))
    answers = []
    for name in solvers:
        result = guaranteed_lp(grid, solver=name)
        error = None if result.value is None else result.value / optimum - 1.0
        answers.append(SolverAnswer(name, result.status, result.value, error, result.residual, result.seconds))
        progress(name)
    return Comparison(least, kalman, optimum, tuple(answers))
