"""The guaranteed problem on a grid, written down for users who want a solver of their own.

Weights are split, ``Phi = a - b`` with ``a, b >= 0``, one pair for each instant and measurement:

    lp     minimise  sum sigma (a + b)
    qp     minimise  sum (a - b)^2 sigma^2 / (2 spacing)          (white noise: least squares, the Kalman filter)
    mixed  minimise  sum sigma (a + b) + mixture * sum (a - b)^2 sigma^2 / (2 spacing)

subject to ``sum H (a - b) = P``. Files hold decimal numbers with 17 digits and nothing else.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from navsym.core.answers import Answer
from navsym.core.errors import DomainError
from navsym.guaranteed.convex import GridProblem, grid_problem
from navsym.guaranteed.problem import GuaranteedProblem, problem_of
from navsym.language.files import file_in_errors

if TYPE_CHECKING:
    from navsym.models.model import Model

FORMATS = ("casadi", "cvxpy", "mps")
KINDS = ("lp", "qp", "mixed")
Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, repr=False)
class Formulation(Answer):
    """The problem on a grid as the text of a file for another program: an MPS file, or a script for casadi or cvxpy.

    to   : "casadi", "cvxpy" or "mps"
    kind : "lp", "qp" or "mixed"
    grid : times of each measurement
    text : contents of the file

    >>> import navsym as nav
    >>> program = nav.formulate("examples/schuler-velocity.toml", "drift", T="1", grid=5)
    >>> program, program.text.splitlines()[0]
    (Formulation(lp for mps, 5 times of each measurement), 'NAME guaranteed')
    """

    to: str
    kind: str
    grid: int
    text: str

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym formulate``, printed and not written to a file."""
        return {"to": self.to, "kind": self.kind, "grid": self.grid, "out": None, "text": self.text}

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"Formulation({self.kind} for {self.to}, {self.grid} times of each measurement)"


def formulate(
    model: Model | str | os.PathLike[str] | GuaranteedProblem,
    target: str | None = None,
    *,
    to: str = "mps",
    kind: str = "lp",
    grid: int = 201,
    mixture: float = 1.0,
    values: Mapping[str, Any] | None = None,
    **parameters: Any,
) -> Formulation:
    """The guaranteed problem on a grid of times as a linear or quadratic programme for another program.

    ``lp`` minimises ``sum sigma |w|`` (worst correlation), ``qp`` the variance under white noise, ``mixed`` the first
    plus ``mixture`` times the second, each subject to ``sum H w = P``.

    model      : a :class:`navsym.Model`, the path of a model file, or a :class:`GuaranteedProblem`
    target     : name of the target; not needed where the model has one
    to         : "mps" (free form; QUADOBJ for qp and mixed), or a Python script for "casadi" or "cvxpy"
    grid       : equidistant times of each measurement, 2 to 100000
    parameters : values of parameters of the model; ``values`` is the same as a mapping

    Raises DomainError for an unknown format or kind, a grid out of range or a mixture that is not positive, and the
    errors of model files.

    >>> import navsym as nav
    >>> nav.formulate("examples/schuler-velocity.toml", "drift", to="cvxpy", kind="qp", T="pi/2")
    Formulation(qp for cvxpy, 201 times of each measurement)
    """
    with file_in_errors(model):
        problem = problem_of(model, target, values, parameters, "formulate")
        return Formulation(to, kind, grid, formulation_text(problem, to, kind=kind, count=grid, mixture=mixture))


def formulation_text(
    problem: GuaranteedProblem, to: str, *, kind: str = "lp", count: int = 201, mixture: float = 1.0
) -> str:
    """Text of a file: a Python script for casadi or cvxpy, or free-form MPS (QUADOBJ for qp and mixed).

    Raises DomainError for an unknown format or kind, a grid of fewer than two instants, or a mixture
    that is not positive.
    """
    if to not in FORMATS or kind not in KINDS:
        raise DomainError(
            f"expected one of {', '.join(FORMATS)} and one of {', '.join(KINDS)}; got {to!r} and {kind!r}; "
            "name one of each"
        )
    if not np.isfinite(mixture) or mixture <= 0:
        raise DomainError(f"mixture: expected a positive number; got {mixture}; choose one")
    grid = grid_problem(problem, count)
    linear = np.zeros_like(grid.bounds) if kind == "qp" else grid.bounds
    factor = {"lp": 0.0, "qp": 1.0, "mixed": mixture}[kind]
    quadratic = factor * grid.bounds**2 / grid.spacing
    if to == "mps":
        return mps_text(grid, linear, quadratic)
    return script_text(grid, linear, quadratic, to)


def number_list(values: Array) -> str:
    """A row of numbers as a JSON list whose decimals give the same doubles when read."""
    return json.dumps([float(x) for x in values])


def mps_text(grid: GridProblem, linear: Array, quadratic: Array) -> str:
    """Free-form MPS; columns a0, b0, a1, b1, …, rows u0, u1, … for the unknowns."""
    m, n = grid.regressors.shape
    lines = ["NAME guaranteed", "ROWS", " N cost", *(f" E u{j}" for j in range(m)), "COLUMNS"]
    for i in range(n):
        for name, sign in (("a", 1.0), ("b", -1.0)):
            if linear[i]:
                lines.append(f" {name}{i} cost {float(linear[i])!r}")
            lines += [f" {name}{i} u{j} {float(sign * grid.regressors[j, i])!r}" for j in range(m)]
    lines += ["RHS", *(f" RHS u{j} {float(p)!r}" for j, p in enumerate(grid.functional))]
    if quadratic.any():
        lines.append("QUADOBJ")
        for i, q in enumerate(quadratic):
            value = float(q)
            lines += [f" a{i} a{i} {value!r}", f" a{i} b{i} {-value!r}", f" b{i} b{i} {value!r}"]
    return "\n".join([*lines, "ENDATA", ""])


HEAD = '''"""Guaranteed estimation on a grid of instants: weights Phi = a - b, a >= 0, b >= 0, sum H Phi = P."""
import numpy as np

times = np.array({times})
H = np.array({rows})
P = np.array({functional})
linear = np.array({linear})
quadratic = np.array({quadratic})
'''

CVXPY = """import cvxpy as cp

a, b = cp.Variable(len(times), nonneg=True), cp.Variable(len(times), nonneg=True)
cost = linear @ (a + b) + cp.sum(cp.multiply(quadratic / 2, cp.square(a - b)))
problem = cp.Problem(cp.Minimize(cost), [H @ (a - b) == P])

if __name__ == "__main__":
    value = problem.solve(solver=cp.CLARABEL if quadratic.any() else cp.HIGHS)
    found = zip(times.tolist(), (a.value - b.value).tolist())
    print(float(value), [(t, w) for t, w in found if abs(w) > 1e-6])
"""

CASADI = """import casadi as ca

n = len(times)
Q = ca.diag(ca.DM(quadratic))
h = ca.sparsify(ca.blockcat([[Q, -Q], [-Q, Q]]))
A = ca.DM(np.hstack([H, -H]))
solver = ca.conic("grid", "highs", {"h": h.sparsity(), "a": A.sparsity()}, {"highs": {"output_flag": False}})

if __name__ == "__main__":
    answer = solver(h=h, g=np.r_[linear, linear], a=A, lba=P, uba=P, lbx=0)
    x = np.array(answer["x"]).ravel()
    found = zip(times.tolist(), (x[:n] - x[n:]).tolist())
    print(float(answer["cost"]), [(t, w) for t, w in found if abs(w) > 1e-6])
"""


def script_text(grid: GridProblem, linear: Array, quadratic: Array, to: str) -> str:
    """Python source that states the problem on the grid for cvxpy or casadi and solves it.

    linear, quadratic : (N,) of the cost ``linear . (a + b) + quadratic . (a - b)^2 / 2``
    """
    head = HEAD.format(
        times=number_list(grid.times),
        rows="[" + ",\n".join(number_list(row) for row in grid.regressors) + "]",
        functional=number_list(grid.functional),
        linear=number_list(linear),
        quadratic=number_list(quadratic),
    )
    return head + (CVXPY if to == "cvxpy" else CASADI)
