"""Complete exceptional sets by the tree of cases: no point of small rank is missed, and no listed one has full rank."""

from __future__ import annotations

import functools
import itertools
import math
import random

import pytest
import sympy as sp
from flint import fmpq, fmpq_mat

import navsym as nav
from navsym import checker
from navsym.models.linear import LinearModel
from navsym.observability import tree
from navsym.observability.certificates import Certifier
from navsym.observability.chains import chains_of, observe_jointly
from navsym.observability.linear import PRIME, residue_rank
from navsym.observability.motion import residue_chains
from navsym.observability.rank_drops import find_drops
from navsym.observability.reduction import lower_row
from navsym.observability.ring import Ring
from navsym.observability.tree import is_empty, search_drops
from navsym.studies.atlas.scenes import model_of
from tests.sampling import thinned
from tests.studies.atlas_cells import find_joint_drops

a, b, c = sp.symbols("a b c", real=True)


def random_model(seed: int) -> LinearModel:
    """Sparse, so that pivots meet, with a denominator that vanishes nowhere on the grid."""
    source = random.Random(seed)
    n = source.randint(3, 5)
    entries = [0, 0, 0, 0, 1, 2, a, b, c, a * b, a - b, b + 1, a**2 - c, c / (a**2 + 1)]
    F = sp.Matrix(n, n, lambda i, j: source.choice(entries))
    H = sp.Matrix([[1, *[source.choice(entries) for _ in range(n - 1)]], [source.choice(entries), b, *[0] * (n - 2)]])
    return LinearModel(F, None, H)


def test_a_row_loses_a_unit_as_often_as_all_its_entries_hold_it():
    plain = Ring.of([a, b])
    x, y = (plain.context.gen(k) for k in (0, 1))
    ring = plain.with_units([x**2 + 1, y])
    row = [6 * (x**2 + 1) ** 2 * y, 0 * x, 4 * (x**2 + 1) ** 3 * (x - y) * y]
    assert lower_row(row, ring) == [3 + 0 * x, 0 * x, 2 * (x**2 + 1) * (x - y)]
    assert lower_row([x - y, y], ring) == [x - y, y] and lower_row([0 * x], ring) == [0 * x]


def test_a_system_with_a_real_point_is_never_called_empty_and_one_without_is():
    source, x = random.Random(4), sp.symbols("x1:5", real=True)
    plain = Ring.of(x)
    read = lambda f: plain.quotient(sp.expand(f)).top  # noqa: E731
    monomials = [*x, *(p * q for p, q in itertools.combinations_with_replacement(x, 2)), *(p**2 * x[0] for p in x)]
    for _ in range(40):
        at = {s: source.randint(-2, 2) for s in x}
        formulas = [sum(source.choice((0, 1, -1, 2)) * m for m in source.sample(monomials, 5)) for _ in range(5)]
        system = [read(f - f.subs(at)) for f in formulas[:3] if f]
        units = [read(f) for f in formulas[3:] if f and f.subs(at) != 0]
        assert not is_empty(system, plain.with_units(units)), (formulas, at)
    y, z, u, v = x
    f = z**2 * y + u * z - y * v**2 - u * v
    empty = [read(f), read((u * z - u * v) * (z + 1) + f), read(y * v + u + v**2 * (y - 1) ** 2 + 1)]
    assert is_empty(empty, plain.with_units([read(u), read(z + 1), read(y), read(v - z)])) is True
    assert not is_empty(empty[:1], plain.with_units([read(u)]))


def exact_rank(model: LinearModel, at: dict[sp.Symbol, int]) -> int:
    """Rank of the stacked rows H F^k at a point, in fractions."""
    F, H = (fractions_of(matrix.subs(at)) for matrix in (model.F, model.H))
    rows = [H]
    for _ in range(model.size - 1):
        rows.append(rows[-1] * F)
    return int(fmpq_mat(len(rows) * H.nrows(), model.size, [x for row in rows for x in row.entries()]).rank())


def fractions_of(matrix: sp.Matrix) -> fmpq_mat:
    return fmpq_mat(*matrix.shape, [fmpq(int(x.p), int(x.q)) for x in matrix])


def grid(seed: int) -> list[dict[sp.Symbol, int]]:
    """Some points of a small grid, where equations with small coefficients hold often."""
    points = random.Random(seed).sample(list(itertools.product((-2, -1, 0, 1, 3), repeat=3)), 30)
    return [dict(zip((a, b, c), values, strict=True)) for values in points]


def holds(zeros, at, nonzero=()) -> bool:
    return all(zero.subs(at) == 0 for zero in zeros) and all(factor.subs(at) != 0 for factor in nonzero)


@pytest.mark.parametrize("seed", thinned([(seed,) for seed in range(12)]))
def test_the_tree_alone_finds_the_points_of_smaller_rank_and_no_others(seed):
    model = random_model(seed)
    chains = chains_of(model)
    ring, motion = chains.ring, chains.motion
    found = search_drops([chain.vectors[0] for chain in chains.chains], chains.joint_dimension, ring, motion)
    drops = [[ring.condition(f) for f in leaf.system] for leaf in found.drops]
    left = [[ring.condition(f) for f in system] for system in found.open]

    def apart(leaf):
        return [ring.condition(f) for f in leaf.nonzero]

    for at in grid(seed):
        rank = exact_rank(model, at)
        listed = [leaf.rank for leaf, zeros in zip(found.drops, drops, strict=True) if holds(zeros, at, apart(leaf))]
        assert not listed or rank <= min(listed) < chains.joint_dimension, at
        if not any(holds(zeros, at) for zeros in left):
            assert listed or rank == chains.joint_dimension, at


@functools.cache
def joint_drops(seed):
    """A model and its joint drops."""
    model = random_model(seed)
    return model, [drop for drop in find_drops(observe_jointly(model)).drops if drop.subspace == "joint"]


@pytest.mark.parametrize("seed", (21, 22, 23, 25))
def test_nested_drops_give_the_rank_of_every_point(seed):
    """Where all lists are whole, the smallest rank listed at a point is its rank."""
    model, drops = joint_drops(seed)
    listed = list(flatten(drops))
    sure = all(drop.complete for drop in drops) and all(drop.whole for drop, depth in listed if depth < 2)
    for at in grid(seed):
        rank = exact_rank(model, at)
        here = [(drop.rank, depth) for drop, depth in listed if holds(drop.zeros, at, drop.nonzero)]
        ranks = [known for known, _ in here if known is not None]
        assert not ranks or rank <= min(ranks), at
        if sure and ranks and None not in [known for known, _ in here] and max(depth for _, depth in here) < 2:
            assert rank == min(ranks), at


def flatten(drops, depth=0):
    for drop in drops:
        yield drop, depth
        yield from flatten(drop.inside, depth + 1)


@pytest.mark.parametrize("seed", (21, 22, 23, 25))
def test_lost_directions_are_not_seen_on_their_condition(seed):
    model, drops = joint_drops(seed)
    for drop in drops:
        for at in grid(seed):
            if holds(drop.zeros, at, drop.nonzero) and drop.directions.rows:
                lost = drop.directions.subs(at).T
                assert all((model.H * model.F**k).subs(at) * lost == sp.zeros(2, lost.cols) for k in range(model.size))


def test_a_chain_of_couplings_loses_more_and_more():
    answer = nav.observe(
        nav.Model("x y z", F=[["0", "a", "0"], ["0", "0", "b"], ["0", "0", "0"]], H=["x"], a="real", b="real")
    )
    drops = {drop.condition: drop for drop in answer.rank_drops if drop.subspace == "joint"}
    assert {name: drop.rank for name, drop in drops.items()} == {"a = 0": 1, "b = 0": 2}
    assert drops["b = 0"].directions == sp.Matrix([[0, 0, 1]])
    assert [(set(inner.zeros), inner.rank) for inner in drops["b = 0"].inside] == [({a, b}, 1)]
    assert drops["b = 0"].whole and drops["a = 0"].inside == ()
    data = next(d for d in answer.document()["rank_drops"] if d["subspace"] == "joint" and d["zeros"] == ["b"])
    assert (data["rank"], data["lost_basis"], data["inside_complete"]) == (2, [["0", "0", "1"]], True)


def test_denominators_are_no_drops():
    """1/(r + h) vanishes nowhere: the model does not exist where r + h = 0."""
    model = nav.Model("x v", F=[["0", "1/(r + h)"], ["0", "0"]], H=["x"], r="real", h="real")
    assert nav.observe(model).rank_drops == ()


def test_declared_ranges_exclude_a_condition():
    F = [["0", "x - w"], ["0", "0"]]
    inside = nav.observe(nav.Model("p q", F=F, H=["p"], x=["1", "3"], w=["2", "4"]))
    outside = nav.observe(nav.Model("p q", F=F, H=["p"], x=["1", "2"], w=["3", "4"]))
    assert [drop.excluded for drop in inside.rank_drops] == [False, False]
    assert [drop.excluded for drop in outside.rank_drops] == [True, True]


@pytest.mark.parametrize("rates", [{"h": "w"}, {"h": "w", "w": "q"}])
def test_a_condition_on_a_turning_angle_lasts_where_the_turn_stops_or_nothing_is_left_of_it(rates):
    F = [["0", "a*cos(h) + b*sin(h) + c"], ["0", "0"]]
    answer = nav.observe(nav.Model("x y", F=F, H=["x"], rates=rates, **dict.fromkeys("abchwq", "real")))
    cosine, sine = sp.symbols("C S")
    h = sp.Symbol("h", real=True)
    turn = {sp.cos(h): cosine, sp.sin(h): sine}
    listed = [drop for drop in answer.rank_drops if drop.subspace == "joint" and drop.lasting]
    assert answer.rank_drops_complete["joint"]
    names = [sp.Symbol(name, real=True) for name in "abcwq"]
    for values in itertools.product((0, 3), (0, -4), (0, 5), (0, 1), (0, 2)):
        for cosine_of, sine_of in ((sp.Rational(3, 5), sp.Rational(4, 5)), (1, 0), (0, 1)):
            at = {**dict(zip(names, values, strict=True)), cosine: cosine_of, sine: sine_of}
            here = any(all(zero.subs(turn).subs(at) == 0 for zero in drop.zeros) for drop in listed)
            a, b, c, w, q = values
            rests = w == 0 and (q == 0 or "w" not in rates) and a * cosine_of + b * sine_of + c == 0
            assert here == (a == b == c == 0 or rests), values


def point_of_graph(zeros, symbols, source):
    """Residues where the zeros vanish: each is solved for a variable of its own, or the first for a square root."""
    free = [
        zero.free_symbols - set().union(*(other.free_symbols for other in zeros if other is not zero)) for zero in zeros
    ]
    named = [
        (zero, [s for s in sorted(own, key=str) if sp.degree(zero, s) == 1])
        for zero, own in zip(zeros, free, strict=True)
    ]
    for _ in range(30):
        point = {s: source.randrange(2, PRIME) for s in symbols}
        for zero, own in sorted(named, key=lambda item: bool(item[1])):
            x = own[0] if own else next(s for s in sorted(zero.free_symbols, key=str) if sp.degree(zero, s) == 2)
            *above, b, c = (value_modulo(part, point) for part in sp.Poly(zero, x).all_coeffs())
            a = above[0] if above else 0
            root = pow(b * b - 4 * a * c, (PRIME + 1) // 4, PRIME)
            point[x] = (root - b) * pow(2 * a, -1, PRIME) % PRIME if a else -c * pow(b, -1, PRIME) % PRIME
        if not any(value_modulo(zero, point) for zero in zeros):
            return point
    raise AssertionError("no point")


def value_modulo(expression, point):
    """A polynomial with whole coefficients at residues."""
    terms = sp.Poly(expression, *point).terms()
    values = [*point.values()]
    return sum(int(c) * math.prod(map(pow, values, powers, [PRIME] * len(values))) for powers, c in terms) % PRIME


def test_what_a_drop_excepts_leaves_its_rank_at_all_other_points_and_is_granted(monkeypatch):
    monkeypatch.setattr(tree, "SATURATION", (1, 1, 1))  # no closure is found
    model = model_of("INS: straight: position, known lever arm")
    joint, certifier = observe_jointly(model), Certifier.of(model)
    chains, source = joint.chains, random.Random(3)
    found = find_joint_drops(joint, [sp.Symbol("g", real=True)], 150)
    drops = [drop for drop in found.drops if drop.nonzero]
    assert found.complete["joint"] and drops
    assert all(f"{factor} != 0" in drop.condition for drop in drops for factor in drop.nonzero)
    for drop in drops:
        point = point_of_graph(drop.zeros, chains.ring.symbols, source)
        assert all(value_modulo(factor, point) for factor in drop.nonzero)
        rows = residue_chains([chain.vectors[0] for chain in chains.chains], chains.motion, [*point.values()])
        assert residue_rank(rows) == drop.rank < joint.joint_dimension
    granted = [item for item in map(certifier.certify_drop, drops) if not isinstance(item, str)]
    assert granted and all("statement" in item for item in granted)
    for item in granted:
        *zeros, last = item["statement"]["zeros"]
        assert zeros and last.endswith("- 1") and checker.check(item) == "observability"
        with pytest.raises(checker.Refused):  # the reciprocal is of what does not vanish
            checker.check(item | {"point": {**item["point"], max(item["point"], key=len): "0"}})
