"""Two-stage observers that run: numbers in, estimates out.

The observer is linear, d(x°, z°)/dt = A (x°, z°) + B sigma, so that a step with a measurement held
over it is a matrix product: no integrator, no step-size error. Beside it stand the steady Kalman
gain and the exact propagation of the covariance of the errors.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from navsym.core.arrays import Array, covariance, frozen, named
from navsym.core.errors import DomainError
from navsym.observability.splits import TwoStageBlocks


@dataclass(frozen=True, slots=True, eq=False)
class TwoStageObserver:
    """Matrices of (1.6), (1.11)-(1.13) as numbers; the variant (1.13) has g_z1 different from zero.

    L : (n, n), (x, z) = L xi;  rows g are vectors; gains K_x (m,), K_z (n - m,)
    """

    L: Array
    G_x: Array
    g_x: Array
    K_x: Array
    G_z1: Array
    G_z2: Array
    g_z1: Array
    g_z2: Array
    K_z: Array

    def __post_init__(self) -> None:
        m, rest = np.shape(self.G_x)[0], np.shape(self.G_z2)[0]
        shapes = {
            "L": (m + rest, m + rest),
            "G_x": (m, m),
            "g_x": (m,),
            "K_x": (m,),
            "G_z1": (rest, m),
            "G_z2": (rest, rest),
            "g_z1": (m,),
            "g_z2": (rest,),
            "K_z": (rest,),
        }
        for name, shape in shapes.items():
            value = getattr(self, name)
            array = frozen(np.zeros(shape)) if 0 in shape else named(name, value, shape, "blocks of the observer")
            object.__setattr__(self, name, array)

    @property
    def stages(self) -> tuple[int, int]:
        """Number of variables of the first and of the second stage."""
        return len(self.K_x), len(self.K_z)


def observer(
    blocks: TwoStageBlocks, K_x: Sequence[Any], K_z: Sequence[Any], values: Mapping[sp.Symbol, Any] | None = None
) -> TwoStageObserver:
    """The observer of symbolic blocks and gains with numbers for all symbols.

    Raises DomainError when a symbol has no value.
    """
    values = values or {}
    return TwoStageObserver(
        L=numbers(blocks.L, values),
        G_x=numbers(blocks.G_x, values),
        g_x=numbers(blocks.g_x, values)[0],
        K_x=numbers(sp.Matrix(len(K_x), 1, list(K_x)), values)[:, 0],
        G_z1=numbers(blocks.G_z1, values),
        G_z2=numbers(blocks.G_z2, values),
        g_z1=numbers(blocks.g_z1, values)[0],
        g_z2=numbers(blocks.g_z2, values)[0],
        K_z=numbers(sp.Matrix(len(K_z), 1, list(K_z)), values)[:, 0],
    )


def numbers(matrix: sp.MatrixBase, values: Mapping[sp.Symbol, Any]) -> Array:
    """Entries as floats, each rounded once from its exact value."""
    exact = sp.Matrix(matrix).subs(dict(values))
    if exact.free_symbols:
        names = ", ".join(sorted(map(str, exact.free_symbols)))
        raise DomainError(f"expected a number for every symbol; got none for {names}; give their values")
    return np.array([[float(entry) for entry in row] for row in exact.tolist()], dtype=float).reshape(exact.shape)


def closed_loop(found: TwoStageObserver) -> tuple[Array, Array]:
    """(A, B) with d(x°, z°)/dt = A (x°, z°) + B (sigma_1, sigma_2); A is also the matrix of the errors."""
    m, rest = found.stages
    A, B = np.zeros((m + rest, m + rest)), np.zeros((m + rest, 2))
    A[:m, :m] = found.G_x - np.outer(found.K_x, found.g_x)
    A[m:, :m] = found.G_z1 - np.outer(found.K_z, found.g_z1)
    A[m:, m:] = found.G_z2 - np.outer(found.K_z, found.g_z2)
    B[:m, 0], B[m:, 1] = found.K_x, found.K_z
    return A, B


def run(found: TwoStageObserver, sigma: Array, step: float, start: Array | None = None) -> Array:
    """Estimates of xi at the ends of the steps, (N, n), for measurements (N, 2) held over each step.

    start : (n,) estimate of (x, z) at the beginning; zero by default
    """
    A, B = closed_loop(found)
    n = len(A)
    sigma = named("sigma", sigma, (None, 2), "one row per step")
    Phi, Gamma = held(A, B, positive_step(step))
    state = np.zeros(n) if start is None else np.array(named("start", start, (n,), "one entry per variable"))
    back = np.linalg.inv(found.L)
    estimates = np.empty((len(sigma), n))
    for k, measured in enumerate(sigma):
        state = Phi @ state + Gamma @ measured
        estimates[k] = back @ state
    return estimates


def run_slowly(
    found: TwoStageObserver, sigma: Array, step: float, start: Array | None = None, parts: int = 200
) -> Array:
    """Twin of :func:`run`: the two stages one after the other, by many small steps of Runge and Kutta."""
    m, _ = found.stages
    x, z = (np.zeros(size) for size in found.stages) if start is None else np.split(np.array(start, dtype=float), [m])
    back = np.linalg.inv(found.L)
    estimates, h = [], step / parts

    def rates(x: Array, z: Array, measured: Array) -> tuple[Array, Array]:
        first = found.G_x @ x + found.K_x * (measured[0] - found.g_x @ x)  # joint_correction:1.6
        second = found.G_z1 @ x + found.G_z2 @ z
        return first, second + found.K_z * (
            measured[1] - found.g_z1 @ x - found.g_z2 @ z
        )  # joint_correction:1.11, 1.13

    for measured in sigma:
        for _ in range(parts):
            k1 = rates(x, z, measured)
            k2 = rates(x + h / 2 * k1[0], z + h / 2 * k1[1], measured)
            k3 = rates(x + h / 2 * k2[0], z + h / 2 * k2[1], measured)
            k4 = rates(x + h * k3[0], z + h * k3[1], measured)
            x = x + h / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
            z = z + h / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
        estimates.append(back @ np.concatenate([x, z]))
    return np.array(estimates)


def held(A: Array, B: Array, step: float) -> tuple[Array, Array]:
    """(Phi, Gamma) of one step with the input held: the exponential of ((A, B), (0, 0)) step."""
    n, q = A.shape[0], B.shape[1]
    block = np.zeros((n + q, n + q))
    block[:n, :n], block[:n, n:] = A * step, B * step
    whole = exponential(block)
    return whole[:n, :n], whole[:n, n:]


def exponential(A: Array) -> Array:
    """exp(A) by scaling, a Taylor sum of 18 terms and squaring: 1e-15 relative for the norms met here."""
    norm = float(np.abs(A).sum(axis=1).max()) if A.size else 0.0
    squarings = max(0, int(np.ceil(np.log2(norm * 4.0)))) if norm > 0.25 else 0
    scaled = A / 2.0**squarings
    total, term = np.eye(len(A)), np.eye(len(A))
    for k in range(1, 19):
        term = term @ scaled / k
        total = total + term
    for _ in range(squarings):
        total = total @ total
    return total


def error_covariance(A: Array, intensity: Array, P: Array, step: float, count: int) -> Array:
    """Covariances (count + 1, n, n) of e, de/dt = A e + white noise of the given intensity, at multiples of
    the step.

    Exact: the noise of a step is an integral that Van Loan's exponential gives.
    """
    Phi, noise = noise_of_step(A, intensity, positive_step(step))
    found = [np.array(covariance("P", P, len(A)))]
    for _ in range(count):
        following = Phi @ found[-1] @ Phi.T + noise
        found.append((following + following.T) / 2)
    return np.array(found)


def noise_of_step(A: Array, intensity: Array, step: float) -> tuple[Array, Array]:
    """Phi = exp(A step) and the covariance (n, n) that white noise adds in a step.

    Van Loan's exponential holds exp(-A t), which swamps the noise over many time constants: it is taken over a part
    of the step that A hardly moves, and doubled by N(2 t) = Phi N Phi^T + N, a sum in which nothing cancels.
    """
    n = len(A)
    norm = float(np.abs(A).sum(axis=1).max()) * step
    doublings = max(0, int(np.ceil(np.log2(norm)))) if norm > 1.0 else 0
    part = step / 2.0**doublings
    block = np.zeros((2 * n, 2 * n))
    block[:n, :n], block[:n, n:], block[n:, n:] = -A * part, intensity * part, A.T * part
    whole = exponential(block)
    Phi: Array = whole[n:, n:].T
    noise: Array = Phi @ whole[:n, n:]
    for _ in range(doublings):
        noise, Phi = Phi @ noise @ Phi.T + noise, Phi @ Phi
    return Phi, noise


def positive_step(step: float) -> float:
    """The step as it is; DomainError unless it is a positive number."""
    if not (np.isfinite(step) and step > 0):
        raise DomainError(f"step: expected a positive number; got {step}; time runs forward")
    return step


def riccati_gain(G: Array, g: Array, intensity: Array, r: float) -> tuple[Array, Array]:
    """(K, P) of the steady Kalman-Bucy filter for one measurement: G P + P G^T + Q - P g g^T P / r = 0.

    G : (m, m), g : (m,), intensity Q : (m, m) >= 0, r > 0. From the stable invariant subspace of the
    Hamiltonian matrix. Raises DomainError when that subspace does not have m dimensions (an
    undamped mode that the noise does not reach).
    """
    m = len(G)
    intensity = covariance("intensity", intensity, m)
    if not r > 0:
        raise DomainError(f"r: expected a positive intensity; got {r}; give that of the measurement noise")
    hamiltonian = np.block([[G.T, -np.outer(g, g) / r], [-intensity, -G]])
    values, vectors = np.linalg.eig(hamiltonian)
    scale = max(1.0, float(np.abs(values).max()))
    stable = values.real < -1e-9 * scale
    if stable.sum() != m:
        raise DomainError(
            f"expected a filter with a steady state; got {int(stable.sum())} of {m} decaying modes; add process noise"
        )
    basis = vectors[:, stable]
    P = np.real(np.linalg.solve(basis[:m].T, basis[m:].T).T)
    P = (P + P.T) / 2
    return P @ g / r, P


def casadi_observer(
    blocks: TwoStageBlocks, K_x: Sequence[Any], K_z: Sequence[Any], parameters: Sequence[sp.Symbol]
) -> Any:
    """Right-hand side as a casadi function (state (n,), sigma (2,), parameters) -> rate (n,)."""
    from navsym.core.casadi_functions import casadi_function

    m, rest = blocks.G_x.rows, blocks.G_z2.rows
    state = sp.Matrix(sp.symbols(f"s1:{m + rest + 1}", real=True))
    sigma = sp.Matrix(sp.symbols("sigma1 sigma2", real=True))
    x, z = state[:m, :], state[m:, :]
    first = blocks.G_x * x + sp.Matrix(m, 1, list(K_x)) * (sigma[0] - (blocks.g_x * x)[0])
    known = (blocks.g_z1 * x)[0] + ((blocks.g_z2 * z)[0] if rest else 0)
    second = blocks.G_z1 * x + blocks.G_z2 * z + sp.Matrix(rest, 1, list(K_z)) * (sigma[1] - known)
    rate = sp.Matrix([*first, *second])
    return casadi_function("two_stage", [list(state), list(sigma), *parameters], rate)
