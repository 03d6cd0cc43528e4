"""Two-stage observers with numbers that run.

First stage  dx°/dt = G_x x° + K_x (sigma_1 - g_x x°)                          (joint_correction:1.6)
second stage dz°/dt = G_z1 x° + G_z2 z° + K_z (sigma_2 - g_z1 x° - g_z2 z°)    (joint_correction:1.11, 1.13)

and xi° = L^-1 (x°, z°) (joint_correction:1.12). The observer is linear, so that a step with a measurement held over
it is a matrix product.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import sympy as sp

from navsym.core.arrays import Array, as_array, freeze
from navsym.core.errors import DomainError, ShapeError
from navsym.observability.splits import Split
from navsym_papers.joint_correction.matrices import exact_inverse, unit_row


@dataclass(frozen=True, slots=True, eq=False)
class TwoStageBlocks:
    """dx/dt = G_x x,  dz/dt = G_z1 x + G_z2 z,  sigma_1 = g_x x,  sigma_2 = g_z1 x + g_z2 z.

    ``g_z1`` is zero for the split (1.9) and whatever it is for the variant (1.13). g are rows.
    """

    L: sp.ImmutableMatrix
    G_x: sp.ImmutableMatrix
    g_x: sp.ImmutableMatrix
    G_z1: sp.ImmutableMatrix
    G_z2: sp.ImmutableMatrix
    g_z1: sp.ImmutableMatrix
    g_z2: sp.ImmutableMatrix


def two_stage_blocks(chosen: Split, C1: sp.MatrixBase | None = None, C2: sp.MatrixBase | None = None) -> TwoStageBlocks:
    """(1.5), (1.9), (1.10) for invertible C1 (m, m) and C2 (n - m, n - m); identity by default.

    Raises DomainError when the split has i < m: it then has the form u, v, w.
    """
    if chosen.i != chosen.m:
        raise DomainError(f"expected a split with i = {chosen.m}; got i = {chosen.i}; use the form u, v, w")
    one, C1_inverse = free_matrix("C1", C1, chosen.i)
    two, C2_inverse = free_matrix("C2", C2, chosen.j)
    return TwoStageBlocks(
        L=sp.ImmutableMatrix.vstack(one * chosen.L[: chosen.i, :], two * chosen.L[chosen.i :, :]),
        G_x=one * chosen.Theta * C1_inverse,  # joint_correction:1.5.x.any
        g_x=unit_row(chosen.i) * C1_inverse,  # joint_correction:1.5.gx.any
        G_z1=two * chosen.Phi_x * C1_inverse,  # joint_correction:1.9.z.any
        G_z2=two * chosen.Phi_z * C2_inverse,  # joint_correction:1.9.z.any
        g_z1=sp.ImmutableMatrix.zeros(1, chosen.i),
        g_z2=unit_row(chosen.j) * C2_inverse,  # joint_correction:1.10.gz*
    )


def free_matrix(name: str, value: sp.MatrixBase | None, size: int) -> tuple[sp.ImmutableMatrix, sp.ImmutableMatrix]:
    """An invertible matrix and its inverse, by exact elimination."""
    if value is None:
        return sp.ImmutableMatrix.eye(size), sp.ImmutableMatrix.eye(size)
    if value.shape != (size, size):
        raise ShapeError(f"{name}: expected shape {(size, size)}; got {value.shape}; one row per variable")
    matrix = sp.ImmutableMatrix(value)
    return matrix, exact_inverse(name, matrix)


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
        shapes = [(m + rest, m + rest), (m, m), (m,), (m,), (rest, m), (rest, rest), (m,), (rest,), (rest,)]
        for part, shape in zip(fields(self), shapes, strict=True):
            value = getattr(self, part.name)
            array = (
                freeze(np.zeros(shape)) if 0 in shape else as_array(part.name, value, shape, "blocks of the observer")
            )
            object.__setattr__(self, part.name, array)

    @property
    def stages(self) -> tuple[int, int]:
        """Number of variables of the first and of the second stage."""
        return len(self.K_x), len(self.K_z)


def observer_of(
    blocks: TwoStageBlocks, K_x: Sequence[Any], K_z: Sequence[Any], values: Mapping[sp.Symbol, Any] | None = None
) -> TwoStageObserver:
    """The observer of symbolic blocks and gains with numbers for all symbols.

    Raises DomainError when a symbol has no value.
    """
    values = values or {}
    found = {part.name: rounded_entries(getattr(blocks, part.name), values) for part in fields(blocks)}
    found |= {name: matrix[0] for name, matrix in found.items() if name.startswith("g_")}
    columns = (rounded_entries(sp.Matrix(len(K), 1, list(K)), values)[:, 0] for K in (K_x, K_z))
    return TwoStageObserver(**found, **dict(zip(("K_x", "K_z"), columns, strict=True)))


def rounded_entries(matrix: sp.MatrixBase, values: Mapping[sp.Symbol, Any]) -> Array:
    """Entries as floats, each rounded once from its exact value."""
    exact = sp.Matrix(matrix).subs(dict(values))
    if exact.free_symbols:
        names = ", ".join(sorted(map(str, exact.free_symbols)))
        raise DomainError(f"expected a number for every symbol; got none for {names}; give their values")
    return np.array([[float(entry) for entry in row] for row in exact.tolist()], dtype=float).reshape(exact.shape)


def observer_loop(found: TwoStageObserver) -> tuple[Array, Array]:
    """(A, B) with d(x°, z°)/dt = A (x°, z°) + B (sigma_1, sigma_2); A is also the matrix of the errors."""
    m, rest = found.stages
    A, B = np.zeros((m + rest, m + rest)), np.zeros((m + rest, 2))
    A[:m, :m] = found.G_x - np.outer(found.K_x, found.g_x)
    A[m:, :m] = found.G_z1 - np.outer(found.K_z, found.g_z1)
    A[m:, m:] = found.G_z2 - np.outer(found.K_z, found.g_z2)
    B[:m, 0], B[m:, 1] = found.K_x, found.K_z
    return A, B


def hold_measurements(A: Array, B: Array, step: float) -> tuple[Array, Array]:
    """(Phi, Gamma) of one step with constant input: the exponential of ((A, B), (0, 0)) step."""
    from scipy.linalg import expm

    n, q = A.shape[0], B.shape[1]
    block = np.zeros((n + q, n + q))
    block[:n, :n], block[:n, n:] = A * step, B * step
    whole = expm(block)
    return whole[:n, :n], whole[:n, n:]
