"""Where ranks drop: complete lists, checked at points on and off the loci."""

from __future__ import annotations

import itertools
import random

import pytest
import sympy as sp

from navsym.core.errors import TooLargeError
from navsym.models.linear import LinearModel
from navsym.observability.chains import observe_jointly
from navsym.observability.rank_drops import all_loci, compositions, drops_by_staircases, find_drops
from tests.observability.twins import drops_and_completeness, drops_by_minors, rank_drops, staircases

a, b, c, w = sp.symbols("a b c w", real=True)


def conditions(model: LinearModel) -> dict[str, set[frozenset[sp.Expr]]]:
    found: dict[str, set[frozenset[sp.Expr]]] = {}
    for drop in rank_drops(observe_jointly(model)):
        assert drop.complete
        found.setdefault(drop.subspace, set()).add(frozenset(sp.expand(z) for z in drop.zeros))
    return found


def test_a_chain_breaks_where_its_coupling_vanishes():
    model = LinearModel([[0, a, 0], [0, 0, b], [0, 0, 0]], None, [[1, 0, 0]])
    assert conditions(model) == {"z1": {frozenset({a}), frozenset({b})}, "joint": {frozenset({a}), frozenset({b})}}


def test_a_drop_of_codimension_two_is_listed_as_two_conditions_together():
    model = LinearModel([[0, a], [0, 0]], None, [[1, 0], [0, b]])
    found = conditions(model)
    assert found["joint"] == {frozenset({a, b})}
    assert found["z1"] == {frozenset({a})}
    assert found["z2"] == {frozenset({b})}


def test_sums_of_squares_vanish_over_the_reals_only_term_by_term():
    model = LinearModel([[0, a**2 + b**2], [0, 0]], None, [[1, 0]])
    assert conditions(model)["joint"] == {frozenset({a, b})}
    model = LinearModel([[0, a**2 + 1], [0, 0]], None, [[1, 0]])
    assert conditions(model) == {}


@pytest.mark.parametrize(
    "f",
    [
        (a - b * c) ** 2 + c**2 * (b**2 + 1),
        (a * b - c) ** 2 + (a + c) ** 2,
        (a - b) ** 2 - c,
        4 * a**2 * b**2 * c**2 + 9 * a**4 - 14 * a**2 * b**2 + 9 * b**4,
    ],
)
def test_two_squares_vanish_together_and_nowhere_else(f):
    found = observe_jointly(LinearModel(sp.Matrix([[0, f], [0, 0]]), None, [[1, 0]]))
    drops, complete = drops_and_completeness(found)
    joint = [d for d in drops if d.subspace == "joint"]
    assert complete["joint"] and {len(d.zeros) for d in joint} == ({1} if f.coeff(c) == -1 else {2})
    for values in itertools.product(range(-3, 4), repeat=3):
        at = dict(zip((a, b, c), values, strict=True))
        assert (f.subs(at) == 0) == any(all(z.subs(at) == 0 for z in d.zeros) for d in joint), at


def test_every_listed_locus_is_a_drop_and_nothing_drops_elsewhere():
    F = sp.Matrix([[0, 1, 0, 0], [-(w**2), 0, a, 0], [0, 0, 0, 1], [0, 0, -1, 0]])
    H = sp.Matrix([[1, 0, 0, b], [0, 0, c, 0]])
    model = LinearModel(F, None, H)
    generic = observe_jointly(model).joint_dimension
    loci = conditions(model).get("joint", set())
    for values in itertools.product((0, 1, -1), (0, 1, 2), (0, -1), (0, 1, sp.Rational(1, 2))):
        at = dict(zip((a, b, c, w), values, strict=True))
        rows = [H[k, :].subs(at) * F.subs(at) ** j for k in range(2) for j in range(4)]
        rank = sp.Matrix.vstack(*rows).rank()
        on_a_locus = any(all(zero.subs(at) == 0 for zero in locus) for locus in loci)
        assert (rank < generic) == on_a_locus, at


def test_the_velocity_group_breaks_at_one_value_of_the_link():
    from navsym_papers.joint_correction.inertial import velocity_group

    drops = rank_drops(observe_jointly(velocity_group().model(("c1", "c2"))))
    assert {d.condition for d in drops} == {"mu*u_3 + 1 = 0", "mu*u_3 - 1 = 0"}
    assert {d.subspace for d in drops} == {"joint"}


def test_declared_signs_exclude_a_locus_without_hiding_it():
    s = sp.Symbol("s", positive=True)
    drops = rank_drops(observe_jointly(LinearModel([[0, s], [0, 0]], None, [[1, 0]])))
    assert [(str(d.zeros[0]), d.excluded) for d in drops] == [("s", True), ("s", True)]


def test_compositions_are_all_sums_within_their_caps():
    direct = {t for t in itertools.product(range(4), range(3), range(5)) if sum(t) == 6}
    assert set(compositions(6, [3, 2, 4])) == direct


def test_the_full_error_model_of_sixteen_states_has_a_complete_list():
    from navsym_papers.joint_correction.inertial import full_model

    drops, complete = drops_and_completeness(observe_jointly(full_model()))
    assert all(complete.values()) and all(drop.rank is not None for drop in drops)
    joint = {frozenset(d.condition.split(" and ")) for d in drops if d.subspace == "joint"}
    assert joint == {
        frozenset({"mu = 0"}),
        frozenset({"mu**2*omega_1**2 + mu**2*omega_2**2 - 1 = 0"}),
        frozenset({"omega_1 = 0", "omega_2 = 0", "u_1 = 0", "u_2 = 0"}),
    }


def random_symbolic_model(seed: int) -> LinearModel:
    source = random.Random(seed)
    n = source.randint(3, 4)
    entries = [0, 0, 0, 1, -1, a, b, c, a * b, a + c, b - 1, a**2 - b]
    F = sp.Matrix(n, n, lambda i, j: source.choice(entries))
    H = sp.Matrix([[1, *[source.choice(entries) for _ in range(n - 1)]], [source.choice(entries), 1, *[0] * (n - 2)]])
    return LinearModel(F, None, H)


@pytest.mark.parametrize("seed", [*range(8), *(pytest.param(seed, marks=pytest.mark.long) for seed in range(8, 16))])
def test_drops_by_cases_hold_at_a_point_exactly_where_the_rank_is_smaller(seed):
    model = random_symbolic_model(seed)
    found = observe_jointly(model)
    drops, complete = drops_and_completeness(found)
    for values in itertools.product((0, 1, -1), (0, 1, -2), (0, 1)):
        at = dict(zip((a, b, c), values, strict=True))
        F, H = model.F.subs(at), model.H.subs(at)
        ranks = {
            name: sp.Matrix.vstack(*[H[k, :] * F**j for k in rows for j in range(model.size)]).rank()
            for name, rows in (("z1", [0]), ("z2", [1]), ("joint", [0, 1]))
        }
        generic = {m.name: m.dimension for m in found.measurements} | {"joint": found.joint_dimension}
        for name, rank in ranks.items():
            listed = [d for d in drops if d.subspace == name]
            on_a_locus = any(all(zero.subs(at) == 0 for zero in d.zeros) for d in listed)
            assert not on_a_locus or rank < generic[name], (name, at)
            assert on_a_locus or not complete[name] or rank == generic[name], (name, at)


@pytest.mark.parametrize("seed", range(16, 28))
def test_drops_by_cases_are_the_common_zeros_of_all_minors(seed):
    chains = observe_jointly(random_symbolic_model(seed)).chains
    locus = all_loci(chains)["joint"][1]
    fast, complete = locus.lasting, locus.complete
    slow = drops_by_minors([chains.staircase_vectors(s) for s in staircases(chains)], chains.ring)
    size = len(chains.ring.symbols)
    for point in itertools.product(range(-3, 4), repeat=size):
        on_slow, on_fast = (any(all(f(*point) == 0 for f in system) for system in listed) for listed in (slow, fast))
        assert on_fast == on_slow or (on_slow and not complete), point


def dense_model(n: int, symbols: tuple[sp.Symbol, ...], outputs: int, seed: int) -> LinearModel:
    """No zeros to lean on: every entry a number, or an affine function of a parameter."""
    rng = random.Random(seed)
    entries = [
        rng.randint(1, 3) * rng.choice(symbols) + rng.randint(-1, 1) if rng.random() < 0.4 else rng.randint(1, 3)
        for _ in range(n * n)
    ]
    H = sp.Matrix(outputs, n, lambda i, j: 1 if i == j else rng.randint(-2, 2))
    return LinearModel(sp.Matrix(n, n, entries), None, H)


@pytest.mark.parametrize(
    ("n", "count", "outputs"), [(5, 3, 2), pytest.param(7, 2, 2, marks=pytest.mark.long), (5, 2, 3)]
)
def test_dense_systems_of_several_measurements_are_listed_completely(n, count, outputs):
    """By the determinants of the staircases; pivots alone left them open. Every listed point has to be a drop."""
    symbols = (a, b, c)[:count]
    model = dense_model(n, symbols, outputs, 4)
    found = observe_jointly(model)
    drops, complete = drops_and_completeness(found)
    assert complete["joint"] and found.joint_dimension == n
    joint = [d.zeros for d in drops if d.subspace == "joint"]
    for values in itertools.product((-2, 0, 1), repeat=count):
        at = dict(zip(symbols, values, strict=True))
        F, H = model.F.subs(at), model.H.subs(at)
        rank = sp.Matrix.vstack(*[H * F**j for j in range(n)]).rank()
        assert (rank < n) == any(all(zero.subs(at) == 0 for zero in zeros) for zeros in joint), at


def test_staircases_list_the_drops_of_a_scrambled_system():
    """Two equal modes, told apart by the coupling c alone."""
    turn = sp.Matrix([[1, 1, 0], [0, 1, 1], [1, 1, 1]])
    core = sp.Matrix([[a, c, 0], [0, b, 0], [0, 0, b]])
    model = LinearModel(turn.inv() * core * turn, None, sp.Matrix([[1, 0, 0], [0, b, 1]]) * turn)
    found = observe_jointly(model)
    listed = drops_by_staircases(found.chains, found.chains.chains, found.joint_dimension)
    assert found.joint_dimension == 3 and listed is not None
    for values in itertools.product(range(-2, 3), repeat=3):
        at = dict(zip((a, b, c), values, strict=True))
        rank = sp.Matrix.vstack(*[(model.H * model.F**j).subs(at) for j in range(3)]).rank()
        ring = found.chains.ring
        point = [int(at[symbol]) for symbol in ring.symbols]
        assert (rank < 3) == any(all(f(*point) == 0 for f in system) for system in listed), at


def test_a_list_that_is_too_long_to_prove_says_so():
    symbols = sp.symbols("a b c d e f", real=True)
    F = sp.Matrix(7, 7, lambda i, j: symbols[(3 * i + j * j) % 6] + (i * j) % 4 * symbols[(i + 2 * j) % 6])
    found = observe_jointly(LinearModel(F, None, [[1, *[0] * 6]]))
    _, complete = drops_and_completeness(found)
    assert found.joint_dimension == 7 and complete == {"z1": False, "joint": False}


# Angles


def test_a_latitude_under_sines_and_cosines_is_exact():
    phi = sp.Symbol("phi", real=True)
    F = sp.Matrix([[0, w * sp.sin(phi), 0], [-w * sp.sin(phi), 0, w * sp.cos(phi)], [0, -w * sp.cos(phi), 0]])
    found = observe_jointly(LinearModel(F, None, [[1, 0, 0]]))
    assert found.joint_dimension == 3
    # Cayley and Hamilton for a rotation: the squares of sine and cosine have gone.
    assert found.measurements[0].companion == (0, -(w**2), 0)
    assert conditions_by_name(found)["joint"] == {"w = 0", "sin(phi) = 0", "cos(phi) = 0"}


def conditions_by_name(found) -> dict[str, set[str]]:
    drops, complete = drops_and_completeness(found)
    assert all(complete.values())
    listed: dict[str, set[str]] = {}
    for drop in drops:
        listed.setdefault(drop.subspace, set()).add(drop.condition)
    return listed


def test_a_symbol_that_also_stands_under_a_sine_takes_the_sine_to_zero_with_it():
    """Where w vanishes sin(w) does too: the rank there is that of the model at w = 0. Of w = a no rank is claimed."""
    w = sp.Symbol("w", real=True)
    F = sp.Matrix([[0, 0, sp.sin(w)], [0, w, 1], [w + 1, 0, 0]])
    model = LinearModel(F, None, [[-1, -w, 0]])
    (found,) = [d for d in rank_drops(observe_jointly(model)) if d.subspace == "joint" and d.condition == "w = 0"]
    assert found.rank == observe_jointly(LinearModel(F.subs(w, 0), None, [[-1, 0, 0]])).joint_dimension == 1
    assert not found.inside
    a = sp.Symbol("a", real=True)
    equal = observe_jointly(LinearModel([[0, w - a], [0, 0]], None, [[sp.sin(w) - sp.sin(a), 1]]))
    assert all(d.rank is None for d in rank_drops(equal) if d.condition in ("a - w = 0", "-a + w = 0"))
    fixed = observe_jointly(LinearModel([[0, w - 1], [0, 0]], None, [[1, sp.sin(w)]]))
    assert {(d.condition, d.rank) for d in rank_drops(fixed)} == {("w - 1 = 0", 1)}
    # sin(w) = 0 holds at w = 0 and at other points, where less is lost; a range may leave w = 0 alone
    many = observe_jointly(LinearModel(sp.zeros(2), None, [[w * sp.sin(w), w * sp.sin(w) + w], [0, sp.sin(w)]]))
    listed = [(d.condition, d.rank) for d in rank_drops(many) if d.subspace == "joint"]
    assert sorted(listed) == [("sin(w) = 0", None), ("w = 0", 0)]


def test_an_exponential_is_one_only_where_its_exponent_is_zero():
    """exp(w) = 1 is w = 0, with the rank of the model there, and exp(w) + 1 vanishes nowhere."""
    w = sp.Symbol("w", real=True)
    model = LinearModel([[0, sp.exp(w) - 1], [0, 0]], None, [[w, 0], [sp.exp(2 * w) - 1, 0]])
    listed = [(d.condition, d.rank) for d in rank_drops(observe_jointly(model)) if d.subspace == "joint"]
    assert listed == [("w = 0", 0)]
    turned = observe_jointly(LinearModel([[0, 0], [sp.tan(w), 0]], None, [[0, sp.exp(w) - 1]]))
    ranks = {d.condition: d.rank for d in rank_drops(turned) if d.subspace == "joint"}
    assert ranks["sin(w) = 0"] is None


def test_a_drop_at_one_end_of_the_circle_is_found_with_half_the_angle():
    phi = sp.Symbol("phi", real=True)
    found = observe_jointly(LinearModel([[0, 1 + sp.cos(phi)], [0, 0]], None, [[1, 0]]))
    assert {d.condition for d in rank_drops(found)} == {"cos(phi/2) = 0"}
    found = observe_jointly(LinearModel([[0, 2 + sp.cos(phi)], [0, 0]], None, [[1, 0]]))
    assert all(sp.N(d.zeros[0].subs(phi, sp.Rational(k, 7))) != 0 for d in rank_drops(found) for k in range(50))


def test_pythagoras_makes_a_row_vanish_and_two_rows_equal():
    phi = sp.Symbol("phi", real=True)
    equal = observe_jointly(LinearModel([[0, 1], [0, 0]], None, [[sp.cos(2 * phi), 1], [1 - 2 * sp.sin(phi) ** 2, 1]]))
    assert (equal.staircase, equal.measurements[0].basis) == ((2, 0), equal.measurements[1].basis)
    hidden = observe_jointly(LinearModel([[0, 0], [0, 0]], None, [[sp.cos(phi), sp.sin(phi)]])).unobservable
    assert sp.simplify(hidden[0, 0] * sp.cos(phi) + hidden[0, 1] * sp.sin(phi)) == 0


@pytest.mark.parametrize("seed", range(8))
def test_angles_agree_with_numbers_for_the_angle(seed):
    phi, source = sp.Symbol("phi", real=True), random.Random(seed)
    pool = [0, 1, sp.sin(phi), sp.cos(phi), a * sp.sin(phi), sp.tan(phi), sp.cos(2 * phi) - 1, sp.sin(phi / 2)]
    F = sp.Matrix(4, 4, lambda i, j: source.choice(pool))
    found = observe_jointly(LinearModel(F, None, [[1, 0, 0, 0]]))
    at = {phi: sp.Rational(source.randint(1, 9), 7), a: sp.Rational(3, 5)}
    numbers = sp.Matrix(F.subs(at)).evalf(40)
    row, rows = sp.Matrix([[1, 0, 0, 0]]), []
    for _ in range(found.joint_dimension + 1):
        rows.append(row)
        row = row * numbers
    theta = [sp.N(value.subs(at), 40) for value in found.measurements[0].companion]
    combined = sum((t * r for t, r in zip(theta, rows, strict=False)), sp.zeros(1, 4))
    assert max(abs(x) for x in combined - rows[found.joint_dimension]) < 1e-25


# -- dense systems, checked over a finite field --------------------------------------------------------


def dense_system(seed, n=8, parameters=4):
    """Random numbers in a third of the places and every parameter in one."""
    source = random.Random(seed)
    symbols = sp.symbols(f"a0:{parameters}", real=True)
    F = sp.Matrix(n, n, lambda i, j: source.randint(-3, 3) if source.random() < 0.3 else 0)
    for symbol in symbols:
        F[source.randrange(n), source.randrange(n)] = symbol
    H = sp.zeros(1, n)
    for place in source.sample(range(n), 2):
        H[0, place] = source.choice([1, -1, 2])
    return LinearModel(sp.ImmutableMatrix(F), None, sp.ImmutableMatrix(H)), symbols


def rank_modulo(rows, p):
    """Rank over the field of p elements, by schoolbook elimination."""
    rows, rank = [row[:] for row in rows], 0
    for column in range(len(rows[0])):
        pivot = next((k for k in range(rank, len(rows)) if rows[k][column] % p), None)
        if pivot is None:
            continue
        rows[rank], rows[pivot] = rows[pivot], rows[rank]
        inverse = pow(rows[rank][column], -1, p)
        for k in range(rank + 1, len(rows)):
            factor = rows[k][column] * inverse % p
            rows[k] = [(x - factor * y) % p for x, y in zip(rows[k], rows[rank], strict=True)]
        rank += 1
    return rank


def krylov_modulo(F, h, p):
    rows = [h]
    while len(rows) < len(F):
        rows.append([sum(x * F[i][j] for i, x in enumerate(rows[-1])) % p for j in range(len(F))])
    return rows


@pytest.mark.parametrize("seed", [8, pytest.param(0, marks=pytest.mark.long), pytest.param(10, marks=pytest.mark.long)])
def test_a_dense_system_has_all_its_drops_also_over_a_finite_field(seed):
    """One parameter runs through all p values: the rank is smaller exactly at the zeros of the conditions."""
    p, (model, symbols) = 101, dense_system(seed)
    found = observe_jointly(model)
    drops, complete = drops_and_completeness(found)
    assert complete["z1"] and found.measurements[0].dimension == 8
    source = random.Random(seed)
    others = {symbol: source.randrange(p) for symbol in symbols[1:]}
    conditions = [
        [sp.Poly(zero.subs(others), symbols[0], modulus=p) for zero in drop.zeros]
        for drop in drops
        if drop.subspace == "z1"
    ]
    F = model.F.subs(others)
    for value in range(p):
        numbers = [[int(x.subs(symbols[0], value)) % p for x in F[i, :]] for i in range(8)]
        smaller = rank_modulo(krylov_modulo(numbers, [int(x) % p for x in model.H], p), p) < 8
        assert smaller == any(all(f.eval(value) % p == 0 for f in system) for system in conditions)


def test_a_drop_whose_lost_directions_are_too_long_is_listed_without_them(monkeypatch):
    def refuse(*given):
        raise TooLargeError("expected rows that can be written; got too many terms; fix some parameters")

    monkeypatch.setattr("navsym.observability.rank_drops.lost_columns", refuse)
    found = observe_jointly(LinearModel(sp.Matrix([[0, a], [0, 0]]), None, sp.Matrix([[1, 0]])))
    joint = [drop for drop in find_drops(found).drops if drop.subspace == "joint"]
    assert [(drop.condition, drop.rank, drop.directions.rows) for drop in joint] == [("a = 0", 1, 0)]
