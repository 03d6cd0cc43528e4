"""Exact observability against independent exact routes."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
import sympy as sp

from navsym.core.errors import DomainError, EmptyError, TooLargeError, UnobservableError
from navsym.models.linear import LinearModel
from navsym.observability.chains import direction_names, need_observable, observe_jointly, prove_rank
from navsym.observability.directions import resting_directions
from navsym.observability.linear import at_point, determinant, residue_rank, scalar_product
from navsym.observability.motion import motion_of
from navsym.observability.ring import Ring
from navsym.studies.atlas import scenes
from tests.benchmarks.observability import satellite_and_odometer
from tests.observability.twins import determinant_slowly, maximal_minors

a = sp.Symbol("a")


def fraction_rank(rows: list[list[Fraction]]) -> int:
    """Rank by schoolbook elimination in Fractions: the independent route."""
    rows, rank = [list(row) for row in rows], 0
    for column in range(len(rows[0]) if rows else 0):
        pivot = next((i for i in range(rank, len(rows)) if rows[i][column]), None)
        if pivot is None:
            continue
        rows[rank], rows[pivot] = rows[pivot], rows[rank]
        for i in range(rank + 1, len(rows)):
            factor = rows[i][column] / rows[rank][column]
            rows[i] = [a - factor * b for a, b in zip(rows[i], rows[rank], strict=True)]
        rank += 1
    return rank


def krylov(F: list[list[Fraction]], h: list[Fraction], count: int) -> list[list[Fraction]]:
    n, rows = len(F), [h]
    while len(rows) < count:
        rows.append([sum(rows[-1][r] * F[r][c] for r in range(n)) for c in range(n)])
    return rows


def random_system(seed: int) -> tuple[list[list[Fraction]], list[list[Fraction]]]:
    """Rational systems up to n = 8, many of them degenerate: sparse, block triangular, repeated modes."""
    source = random.Random(seed)
    n = source.randint(1, 8)
    kind = seed % 4

    def number() -> Fraction:
        return Fraction(source.randint(-3, 3), source.choice([1, 1, 2, 3]))

    F = [[number() if kind != 1 or source.random() < 0.3 else Fraction(0) for _ in range(n)] for _ in range(n)]
    if kind == 2:
        cut = source.randint(0, n - 1)
        F = [[value if not (r < cut <= c) else Fraction(0) for c, value in enumerate(row)] for r, row in enumerate(F)]
    if kind == 3:
        F = [[Fraction(source.randint(0, 1)) if r == c else Fraction(0) for c in range(n)] for r in range(n)]
    rows = [[number() if source.random() < 0.6 else Fraction(0) for _ in range(n)] for _ in range(2)]
    for k, row in enumerate(rows):
        if not any(row) or row == rows[1 - k]:
            rows[k] = [Fraction(int(c == k % n) + 7 * k) for c in range(n)]
    return F, rows


def model_of(F: list[list[Fraction]], rows: list[list[Fraction]]) -> LinearModel:
    exact = [[sp.Rational(v.numerator, v.denominator) for v in row] for row in F]
    return LinearModel(exact, None, [[sp.Rational(v.numerator, v.denominator) for v in row] for row in rows])


@pytest.mark.parametrize("block", range(8))
def test_two_hundred_random_systems_agree_with_schoolbook_elimination(block):
    for seed in range(30 * block, 30 * block + 30):
        F, rows = random_system(seed)
        n = len(F)
        found = observe_jointly(model_of(F, rows))
        for measurement, h in zip(found.measurements, rows, strict=True):
            chain = krylov(F, h, n + 1)
            assert measurement.dimension == fraction_rank(chain)
            m = measurement.dimension
            assert [[Fraction(int(x.p), int(x.q)) for x in measurement.basis.row(r)] for r in range(m)] == chain[:m]
            theta = [Fraction(int(x.p), int(x.q)) for x in measurement.companion]
            combined = [sum(t * chain[j][c] for j, t in enumerate(theta)) for c in range(n)]
            assert combined == chain[m]
        both = [row for h in rows for row in krylov(F, h, n)]
        assert found.joint_dimension == fraction_rank(both) == prove_rank(model_of(F, rows)).rank
        assert found.unobservable.rows == n - found.joint_dimension
        for k in range(found.unobservable.rows):
            hidden = [Fraction(int(x.p), int(x.q)) for x in found.unobservable.row(k)]
            assert any(hidden)
            assert all(sum(a * b for a, b in zip(row, hidden, strict=True)) == 0 for row in both)


def test_symbolic_dimensions_agree_with_sympys_field_of_fractions():
    a, b, c = sp.symbols("a b c")
    F = sp.Matrix([[0, 1, 0, 0], [a, 0, b, 0], [0, 0, 0, 1], [c, 0, a * b, 0]])
    H = sp.Matrix([[1, 0, 0, 0], [0, 0, 1, c]])
    found = observe_jointly(LinearModel(F, None, H))
    field = sp.QQ.frac_field(a, b, c)
    for k, measurement in enumerate(found.measurements):
        rows = sp.Matrix.vstack(*[H[k, :] * F**j for j in range(4)])
        assert measurement.dimension == sp.polys.matrices.DomainMatrix.from_Matrix(rows).convert_to(field).rank()


def test_companion_coefficients_of_a_full_chain_are_those_of_the_characteristic_polynomial():
    a, b, p = sp.symbols("a b p")
    F = sp.Matrix([[a, 1, 0], [0, b, 1], [1, 0, a + b]])
    found = observe_jointly(LinearModel(F, None, [[1, 0, 0]]))
    polynomial = p**3 - sum(t * p**k for k, t in enumerate(found.measurements[0].companion))
    assert sp.expand(polynomial - F.charpoly(p).as_expr()) == 0


def test_rational_function_entries_keep_their_denominators():
    a, b = sp.symbols("a b", nonzero=True)
    F = sp.Matrix([[1 / a, 1], [b / (a + b), 0]])
    H = sp.Matrix([[1 / b, 0]])
    measurement = observe_jointly(LinearModel(F, None, H)).measurements[0]
    rows = sp.Matrix.vstack(H, H * F)
    assert (measurement.basis - rows).applyfunc(sp.cancel) == sp.zeros(2, 2)
    following = sp.Matrix([list(measurement.companion)]) * rows
    assert (following - H * F**2).applyfunc(sp.cancel) == sp.zeros(1, 2)
    assert set(observe_jointly(LinearModel(F, None, H)).assumptions) >= {b}


def test_a_coupling_of_1e_minus_15_is_not_zero():
    F = [[0, 1], [0, 0]]
    tiny = sp.Rational(1, 10**15)
    assert observe_jointly(LinearModel(F, None, [[1, 0]])).observable
    assert not observe_jointly(LinearModel(F, None, [[0, 1]])).observable
    assert observe_jointly(LinearModel(F, None, [[tiny, 1]])).observable
    assert observe_jointly(LinearModel([[0, tiny], [0, 0]], None, [[1, 0]])).observable


def test_a_hidden_direction_is_named_by_its_states():
    model = LinearModel([[0, 0, 0], [0, 0, 0], [0, 0, 0]], None, [[1, 0, 2]], ("tilt", "drift", "bias"))
    found = observe_jointly(model)
    names = {direction_names(found.unobservable[k, :], found.states) for k in range(2)}
    assert names == {"drift", "(tilt, bias) = (2, -1)"} or names == {"drift", "(tilt, bias) = (-2, 1)"}
    with pytest.raises(UnobservableError, match=r"rank 1 of 3.*drift"):
        need_observable(found)


def test_pi_is_transcendental():
    F = sp.Matrix([[0, 1], [-(sp.pi**2), 0]])
    found = observe_jointly(LinearModel(F, None, [[sp.pi, 1]]))
    assert found.observable
    assert found.measurements[0].companion == (-(sp.pi**2), 0)


def test_determinant_equals_its_slow_twin():
    symbols = sp.symbols("a b c d")
    ring = Ring.over(symbols)
    source = random.Random(1)
    gens = [ring.quotient(s).top for s in symbols]
    for size in (1, 2, 3, 4, 5):
        matrix = [
            [source.choice(gens) * source.randint(-2, 2) + source.randint(-1, 1) for _ in range(size)]
            for _ in range(size)
        ]
        matrix = [[entry + ring.constant(0) for entry in row] for row in matrix]
        assert determinant(matrix, ring) == determinant_slowly(matrix, ring)


def test_maximal_minors_are_all_square_minors():
    from itertools import combinations

    ring = Ring.over(sp.symbols("a b"))
    a, b = (ring.quotient(s).top for s in ring.symbols)
    one, zero = ring.constant(1), ring.constant(0)
    rows = [[a, one, b, zero], [b, a, zero, one]]
    direct = [determinant_slowly([[row[i], row[j]] for row in rows], ring) for i, j in combinations(range(4), 2)]
    assert sorted(map(str, maximal_minors(rows, ring))) == sorted(str(d) for d in direct if d != 0)


@pytest.mark.parametrize(
    ("F", "H", "error", "message"),
    [
        ([[0, 1], [0, 0]], None, EmptyError, "at least one measurement"),
        ([[0, 1], [0, 0]], [[0, 0]], DomainError, "not zero"),
        ([[0, sp.log(sp.Symbol("a"))], [0, 0]], [[1, 0]], DomainError, "rational function"),
        ([[0, sp.sin(1 / (1 + sp.Symbol("a")))], [0, 0]], [[1, 0]], DomainError, "angles and exponents"),
        ([[0, sp.cos(sp.Symbol("a") + sp.pi / 3)], [0, 0]], [[1, 0]], DomainError, "multiples of pi/2"),
        ([[0, sp.cos(99 * sp.Symbol("a"))], [0, 0]], [[1, 0]], TooLargeError, "multiples of an angle"),
        ([[0, 0], [0, 0]], [[2 * sp.sin(a) ** 2 + sp.cos(2 * a) - 1, 0]], DomainError, "not zero"),
        ([[0, sp.Symbol("a") ** 100], [0, 0]], [[1, 0]], TooLargeError, "exponents"),
    ],
)
def test_bad_models_are_refused_with_a_reason(F, H, error, message):
    with pytest.raises(error, match=message):
        observe_jointly(LinearModel(F, None, H))


def test_directions_that_nothing_shows_are_short_where_pivots_stand_in_columns_with_few_terms():
    """28 states at constant attitude and force: the first pivots that come give seven times as many terms."""
    model = satellite_and_odometer()
    motion, listed = motion_of(model)
    rows = [row for row, _ in listed]
    found = prove_rank(model)
    columns = resting_directions(rows, motion, found.rank, motion.points(1)[0])
    assert (found.rank, len(columns)) == (15, 13) and found.upper
    assert sum(len(x) for column in columns for x in column) < 14_000
    assert residue_rank(at_point(columns, motion.points(1)[0])) == 13
    assert all(scalar_product(row, column, motion.ring.constant(0)) == 0 for row in rows for column in columns)


def test_directions_that_are_no_columns_of_low_degree_are_exhibited():
    """A range from a body that turns about the vertical: neither short rows nor guesses give the six columns."""
    found = observe_jointly(scenes.model_of("INS: rotation about the vertical: range to a beacon"))
    assert (found.joint_dimension, found.unobservable.rows, found.proved) == (9, 6, True)


def test_equal_rows_in_disguise_are_recognised():
    a = sp.Symbol("a")
    found = observe_jointly(LinearModel([[0, 1], [0, 0]], None, [[(a + 1) ** 2, 1], [a**2 + 2 * a + 1, 1]]))
    assert (found.staircase, found.measurements[0].basis) == ((2, 0), found.measurements[1].basis)


@pytest.mark.parametrize("entry", [sp.Symbol("t", real=True), sp.exp(sp.Symbol("a")), sp.sin(sp.Symbol("a") ** 2)])
def test_an_entry_that_is_not_zero_couples_the_states(entry):
    for rows in ([[1, 0]], [[1, 0], [1, 0]]):
        assert observe_jointly(LinearModel([[0, entry], [0, 0]], None, rows)).observable
