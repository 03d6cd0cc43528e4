"""The model on which every derived side of this paper rests: symbols, the system and H(tau)."""

import sympy as sp

from navsym.claims import Optimum
from navsym.models.linear import LinearModel
from navsym.models.transition.exponential import regressors

T = sp.Symbol("T", positive=True)  # length of the correction interval, Schuler units
tau = sp.Symbol("tau", real=True)  # dimensionless time, omega_0 t
sigma1 = sp.Symbol("sigma1", positive=True)  # bound of the noise of the lateral measurement
sigma2 = sp.Symbol("sigma2", positive=True)

#: The range of validity that the paper states: T <= pi/2.
STATED = {T: (0, sp.pi / 2)}

#: Velocity error, tilt and drift of one channel, in the paper's variables; z = y1 + w.
CHANNEL = LinearModel(
    F=[[0, -1, 0], [0, 0, 1], [0, -1, 0]], H=[[1, 0, 0]], states=("y1", "y2", "y3"), measurements=("velocity",)
)


def H(at: sp.Expr = tau) -> sp.Matrix:
    """H(tau): the measurement at tau referred to the state at T, derived from the model."""
    return sp.Matrix(regressors(CHANNEL, T, at).matrix.T)


#: The three instants at which the polynomial of section 4 is extreme, found by symmetry.
INSTANTS = (sp.Integer(0), T / 2, T)


def N() -> sp.Matrix:
    """Columns H(0), H(T/2), H(T)."""
    return sp.Matrix.hstack(*(H(at) for at in INSTANTS))


def weights(state: int) -> tuple[sp.Expr, ...]:
    """Weights of the unbiased estimate of one state (0, 1, 2) at the three instants, by Cramer's rule."""
    matrix = N()
    unit = sp.Matrix(3, 1, lambda i, _: int(i == state))
    return tuple((matrix.adjugate() * unit)[j] / matrix.det() for j in range(3))


def alternating() -> sp.Matrix:
    """x with x.H = -1, +1, -1 at the three instants: the dual polynomial normed to one."""
    matrix = N().T
    return matrix.adjugate() * sp.Matrix([-1, 1, -1]) / matrix.det()


def optimum(
    state: int, dual: tuple, times: tuple, weights_: tuple, value: sp.Expr, box: dict[sp.Symbol, tuple] = STATED
) -> Optimum:
    """The optimum of one state (0, 1, 2) over [0, T], on some times with their weights."""
    unit = tuple(int(i == state) for i in range(3))
    return Optimum(tuple(H()), unit, tau, (sp.Integer(0), T), dual, times, weights_, value, box)
