"""Splits of symbolic systems with known answers."""

from __future__ import annotations

import pytest
import sympy as sp

from navsym.core.errors import DomainError, ShapeError, UnobservableError
from navsym.models.linear import LinearModel
from navsym.observability.chains import observe_jointly
from navsym.observability.splits import best_split, choose_split, feasible_splits
from navsym_papers.joint_correction.experiment.observer import two_stage_blocks
from navsym_papers.joint_correction.inertial import joint_model, position_group, velocity_group

a, b, c, d, w = sp.symbols("a b c d w", real=True)


def zero(matrix: sp.MatrixBase) -> bool:
    return all(sp.cancel(entry) == 0 for entry in matrix)


def holds(model: LinearModel, i: int, j: int) -> None:
    """The blocks of a split reproduce the model: L G and the outputs, for every state."""
    found = observe_jointly(model)
    chosen = choose_split(found, i, j)
    G, h1, h2 = model.F, model.H[0, :], model.H[1, :]
    if i == found.measurements[0].dimension:
        blocks = two_stage_blocks(chosen)
        x, z = blocks.L[:i, :], blocks.L[i:, :]
        assert zero(x * G - blocks.G_x * x)
        assert zero(blocks.g_x * x - h1)
        if j:
            assert zero(z * G - blocks.G_z1 * x - blocks.G_z2 * z)
            assert zero(blocks.g_z2 * z - h2)
    elif i:
        u, v, rest = chosen.L[:i, :], chosen.tail, chosen.L[i:, :]  # joint_correction:1.14
        first = sp.Matrix.vstack(u, v)
        assert zero(first * G - chosen.Theta * first)
        assert zero(rest * G - chosen.Phi_x * u - chosen.Phi_z * rest)
        assert zero(u[0, :] - h1)
        assert zero(rest[0, :] - h2)


def similar(F: sp.Matrix, H: sp.Matrix, T: sp.Matrix) -> LinearModel:
    return LinearModel((T.inv() * F * T).applyfunc(sp.cancel), None, H * T)


SCRAMBLE = sp.Matrix([[1, 2, 0, 1], [0, 1, 1, 0], [1, 2, 1, 1], [0, 1, 1, 1]])

#: name -> model, (n, m, l), all feasible splits, the split with the least max(i, j)
KNOWN = {
    "direct sum": (
        LinearModel([[0, 1, 0, 0], [a, 0, 0, 0], [0, 0, 0, 1], [0, 0, b, 0]], None, [[1, 0, 0, 0], [0, 0, 1, 0]]),
        (4, 2, 2),
        [(2, 2)],
        (2, 2),
    ),
    "scrambled direct sum": (
        similar(
            sp.Matrix([[0, 1, 0, 0], [a, 0, 0, 0], [0, 0, 0, 1], [0, 0, b, 0]]),
            sp.Matrix([[1, 0, 0, 0], [0, 0, 1, 0]]),
            SCRAMBLE,
        ),
        (4, 2, 2),
        [(2, 2)],
        (2, 2),
    ),
    "second measurement idle (m = n)": (
        LinearModel([[0, 1, 0], [0, 0, 1], [a, b, c]], None, [[1, 0, 0], [0, 0, 1]]),
        (3, 3, 3),
        [(3, 0), (2, 1), (1, 2), (0, 3)],
        (2, 1),
    ),
    "first observes one state": (
        LinearModel([[a, 0, 0], [1, 0, 1], [0, b, 0]], None, [[1, 0, 0], [0, 1, 0]]),
        (3, 1, 3),
        [(1, 2), (0, 3)],
        (1, 2),
    ),
    "overlap in two dimensions": (
        LinearModel([[0, 1, 0, 0], [0, 0, 1, 0], [a, b, 0, 0], [0, 0, 1, d]], None, [[1, 0, 0, 0], [0, 0, 0, 1]]),
        (4, 3, 4),
        [(3, 1), (2, 2), (1, 3), (0, 4)],
        (2, 2),
    ),
    "u, v, w needed": (
        LinearModel([[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [a, b, c, d]], None, [[1, 0, 0, 0], [0, 0, 1, 0]]),
        (4, 4, 4),
        [(4, 0), (2, 2), (1, 3), (0, 4)],
        (2, 2),
    ),
    "oscillators of one frequency": (
        LinearModel(
            [[0, 1, 0, 0], [-(w**2), 0, 0, 0], [0, 0, 0, 1], [0, 0, -(w**2), 0]], None, [[1, 0, 1, 0], [0, 1, 1, 0]]
        ),
        (4, 2, 2),
        [(2, 2)],
        (2, 2),
    ),
    "triple integrator by its ends": (
        LinearModel([[0, 1, 0], [0, 0, 1], [0, 0, 0]], None, [[0, 0, 1], [1, 0, 0]]),
        (3, 1, 3),
        [(1, 2), (0, 3)],
        (1, 2),
    ),
    "velocity before position": (
        LinearModel([[0, 1, 0], [0, 0, 1], [0, 0, 0]], None, [[0, 1, 0], [1, 0, 0]]),
        (3, 2, 3),
        [(2, 1), (0, 3)],
        (2, 1),
    ),
    "velocity group": (velocity_group().model(("c1", "c2")), (6, 3, 3), [(3, 3)], (3, 3)),
    "position group": (position_group().model(("m1", "m2")), (8, 6, 6), [(6, 2), (4, 4), (2, 6)], (4, 4)),
    "two scalars": (LinearModel([[a, 0], [0, b]], None, [[1, 0], [0, 1]]), (2, 1, 1), [(1, 1)], (1, 1)),
}


@pytest.mark.parametrize("name", KNOWN)
def test_systems_with_known_answers_are_answered_completely(name):
    model, sizes, feasible, best = KNOWN[name]
    found = observe_jointly(model)
    assert (model.size, *(m.dimension for m in found.measurements)) == sizes
    assert [(s.i, s.j) for s in feasible_splits(found)] == feasible
    chosen = best_split(found)
    assert (chosen.i, chosen.j) == best
    for i, j in feasible:
        holds(model, i, j)


@pytest.mark.parametrize("name", KNOWN)
def test_the_printed_determinant_is_that_of_L(name):
    model, _, _, _ = KNOWN[name]
    found = observe_jointly(model)
    for feasible_split in feasible_splits(found):
        chosen = choose_split(found, feasible_split.i, feasible_split.j)
        assert sp.cancel(chosen.L.det(method="berkowitz") - feasible_split.determinant) == 0
        assert feasible_split.determinant != 0


def test_a_hidden_mode_refuses_every_split_and_names_the_mode():
    model = LinearModel([[0, 1, 0], [a, 0, 0], [0, 0, b]], None, [[1, 0, 0], [0, 1, 0]], ("x", "v", "mode"))
    with pytest.raises(UnobservableError, match=r"rank 2 of 3.*mode"):
        choose_split(observe_jointly(model))


def test_a_split_that_is_no_basis_names_the_determinant_that_vanishes():
    found = observe_jointly(KNOWN["position group"][0])
    with pytest.raises(DomainError, match=r"det\(a1, a2, a3, a4, a5, b1, b2, b3\) = 0 .*choose one of 6,2, 4,4, 2,6"):
        choose_split(found, 5, 3)


def test_splits_of_wrong_size_are_refused():
    found = observe_jointly(KNOWN["two scalars"][0])
    with pytest.raises(ShapeError, match=r"i \+ j = 2"):
        choose_split(found, 2, 1)
    with pytest.raises(ShapeError, match="two measurements"):
        feasible_splits(observe_jointly(joint_model()))


def test_free_matrices_change_coordinates_and_nothing_else():
    model = KNOWN["overlap in two dimensions"][0]
    chosen = choose_split(observe_jointly(model))
    C1 = sp.Matrix([[1, a, 0], [0, 1, 2], [b, 0, 1]])
    blocks = two_stage_blocks(chosen, C1, sp.Matrix([[3]]))
    x, z = blocks.L[:3, :], blocks.L[3:, :]
    assert zero(x * model.F - blocks.G_x * x)
    assert zero(z * model.F - blocks.G_z1 * x - blocks.G_z2 * z)
    with pytest.raises(DomainError, match="determinant 0"):
        two_stage_blocks(chosen, sp.zeros(3, 3))
