"""Determinants of chains from values at points: equal to elimination, within their degrees, refused when too long."""

from __future__ import annotations

import itertools
import random

import pytest
import sympy as sp
from flint import fmpz

from navsym.models.linear import LinearModel
from navsym.observability.chains import observe_jointly
from navsym.observability.linear import determinant, transposed_times
from navsym.observability.motion import motion_of
from navsym.observability.rank_drops import (
    POINTS,
    affine_steps,
    along_first_axis,
    chain_determinant,
    generator_degree_bound,
    points_needed,
)
from tests.observability.twins import drops_and_completeness

p1, p2, p3 = sp.symbols("p1:4", real=True)


def prepared(F: sp.Matrix, H: sp.Matrix):
    motion, rows = motion_of(LinearModel(F, None, H))
    return motion.ring, motion.matrix, [row for row, _ in rows]


def by_elimination(starts, matrix, ring):
    vectors = []
    for row, count in starts:
        for _ in range(count):
            vectors.append(row)
            row = transposed_times(matrix, row, ring)
    return determinant(vectors, ring)


def random_case(seed: int):
    """Two to five states, one or two chains, entries from numbers to squares of the parameters."""
    source = random.Random(seed)
    n = source.randint(2, 5)
    kinds = [[0, 1, -2, p1, p2 + 1], [0, 3, p1 * p2, p2], [1, -1, p1**2 - 1, p2, p3]][seed % 3]
    F = sp.Matrix(n, n, lambda i, j: source.choice(kinds))
    H = sp.Matrix(2, n, lambda k, j: 1 if j == k else source.choice([0, 2, p1]))
    first = source.randint(0, n)
    ring, matrix, rows = prepared(F, H)
    return ring, matrix, [(rows[0], first), (rows[1], n - first)]


@pytest.mark.parametrize("seed", range(30))
def test_values_and_elimination_give_one_determinant(seed):
    ring, matrix, starts = random_case(seed)
    expected = by_elimination(starts, matrix, ring)
    assert chain_determinant(starts, matrix, ring) == expected
    if expected != 0:
        for place, degree in enumerate(expected.degrees()):
            assert degree <= generator_degree_bound(starts, matrix, place)


def test_a_parameter_in_one_entry_has_the_degree_of_the_number_of_steps():
    """Vectors of a chain of six have degrees up to five, fifteen together; their determinant has at most five."""
    source = random.Random(5)
    F = sp.Matrix(6, 6, lambda i, j: source.choice([-3, -2, -1, 1, 2, 3]))
    F[2, 4] = p1
    ring, matrix, (row,) = prepared(F, sp.Matrix([[1, 2, 0, 1, 1, 3]]))
    assert affine_steps(matrix, 0) == 1 and generator_degree_bound([(row, 6)], matrix, 0) == 5
    assert 0 < chain_determinant([(row, 6)], matrix, ring).degrees()[0] <= 5


def test_the_interpolation_undoes_the_powers():
    """Values on a grid of a polynomial in two variables give its coefficients back, one axis after the other."""
    for n, m in itertools.product(range(6), range(4)):
        coefficients = [[i * i - 3 * j + 1 for j in range(m + 1)] for i in range(n + 1)]
        terms = [(c, i, j) for i, row in enumerate(coefficients) for j, c in enumerate(row)]
        values = [fmpz(sum(c * x**i * y**j for c, i, j in terms)) for x in range(n + 1) for y in range(m + 1)]
        assert along_first_axis(along_first_axis(values, n), m) == [c for c, _, _ in terms]


def test_too_many_points_are_refused_before_they_are_taken():
    symbols = sp.symbols("q1:8", real=True)
    F = sp.Matrix(8, 8, lambda i, j: symbols[(i + j) % 7])
    ring, matrix, (row,) = prepared(F, sp.Matrix([[1] * 8]))
    assert points_needed([(row, 8)], matrix) > POINTS
    assert chain_determinant([(row, 8)], matrix, ring) is None


@pytest.mark.long
def test_a_dense_system_with_parameters_in_single_entries_is_listed_completely():
    """Eight states without a zero; four parameters stand in one entry each. Pivots and minors left it open."""
    source = random.Random(5)
    F = sp.Matrix(8, 8, lambda i, j: source.choice([-3, -2, -1, 1, 2, 3]))
    for place, symbol in enumerate((p1, p2, p3)):
        F[2 * place, 7 - place] = symbol
    model = LinearModel(F, None, sp.Matrix([[1, 2, -1, 1, 3, 1, -2, 1]]))
    found = observe_jointly(model)
    drops, complete = drops_and_completeness(found)
    joint = [drop for drop in drops if drop.subspace == "joint"]
    assert complete == {"z1": True, "joint": True} and joint
    condition = sp.prod(zero for drop in joint for zero in drop.zeros)
    at = {p1: 3, p2: -2, p3: 5}
    value = sp.Matrix.vstack(*[model.H * model.F.subs(at) ** j for j in range(8)]).det()
    ratio = value / condition.subs(at)
    other = {p1: -1, p2: 4, p3: 2}
    again = sp.Matrix.vstack(*[model.H * model.F.subs(other) ** j for j in range(8)]).det()
    assert ratio != 0 and again == ratio * condition.subs(other)
