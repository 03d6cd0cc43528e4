"""Where ranks drop: complete lists, checked at points on and off the loci."""

from __future__ import annotations

import itertools

import sympy as sp

from navsym.methods.observability import observe
from navsym.methods.observability_loci import compositions, rank_drops
from navsym.models.linear import LinearModel

a, b, c, w = sp.symbols("a b c w", real=True)


def conditions(model: LinearModel) -> dict[str, set[frozenset[sp.Expr]]]:
    found: dict[str, set[frozenset[sp.Expr]]] = {}
    for drop in rank_drops(observe(model)):
        assert drop.complete
        found.setdefault(drop.subspace, set()).add(frozenset(sp.expand(z) for z in drop.zeros))
    return found


def test_a_chain_breaks_where_its_coupling_vanishes():
    model = LinearModel([[0, a, 0], [0, 0, b], [0, 0, 0]], None, [[1, 0, 0]])
    assert conditions(model) == {
        "z1": {frozenset({a}), frozenset({b})},
        "joint": {frozenset({a}), frozenset({b})},
    }


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


def test_every_listed_locus_is_a_drop_and_nothing_drops_elsewhere():
    F = sp.Matrix([[0, 1, 0, 0], [-(w**2), 0, a, 0], [0, 0, 0, 1], [0, 0, -1, 0]])
    H = sp.Matrix([[1, 0, 0, b], [0, 0, c, 0]])
    model = LinearModel(F, None, H)
    generic = observe(model).joint_dimension
    loci = conditions(model).get("joint", set())
    for values in itertools.product((0, 1, -1), (0, 1, 2), (0, -1), (0, 1, sp.Rational(1, 2))):
        at = dict(zip((a, b, c, w), values, strict=True))
        rows = [H[k, :].subs(at) * F.subs(at) ** j for k in range(2) for j in range(4)]
        rank = sp.Matrix.vstack(*rows).rank()
        on_a_locus = any(all(zero.subs(at) == 0 for zero in locus) for locus in loci)
        assert (rank < generic) == on_a_locus, at


def test_the_velocity_group_breaks_at_one_value_of_the_link():
    from navsym.models.inertial import velocity_group

    drops = rank_drops(observe(velocity_group().model(("c1", "c2"))))
    assert {d.condition for d in drops} == {"mu*u_3 + 1 = 0", "mu*u_3 - 1 = 0"}
    assert {d.subspace for d in drops} == {"joint"}


def test_declared_signs_exclude_a_locus_without_hiding_it():
    s = sp.Symbol("s", positive=True)
    drops = rank_drops(observe(LinearModel([[0, s], [0, 0]], None, [[1, 0]])))
    assert [(str(d.zeros[0]), d.allowed) for d in drops] == [("s", False), ("s", False)]


def test_compositions_are_all_sums_within_their_caps():
    direct = {t for t in itertools.product(range(4), range(3), range(5)) if sum(t) == 6}
    assert set(compositions(6, [3, 2, 4])) == direct


def test_too_many_minors_give_a_list_that_does_not_call_itself_complete():
    from navsym.models.inertial import full_model

    drops = rank_drops(observe(full_model()))
    assert drops and not any(d.complete for d in drops)
    assert "omega_2 = 0" in {d.condition for d in drops}
