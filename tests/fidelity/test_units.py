"""Homogeneity: every claim that holds agrees with the units of its symbols; one-token slips of every paper do not."""

from __future__ import annotations

import pytest
import sympy as sp

from navsym.claims import Equation, Optimum
from tests.attacks.campaigns.edits import apply_edit, is_formula, list_edits
from tests.derivations.statements import PAPERS, assertions, symbols_in
from tests.fidelity.scaling import Scaling, narrowed, pairs_of
from tests.fidelity.units import METRE, SECOND, units_of

A_NUMBER = "a number stands beside a quantity without unit, so that the other side alone allows more"
#: Claims whose printed side allows fewer units than the derived one, and why.
NARROWER = {
    "guaranteed_velocity:2.D.never-exceeded": A_NUMBER,
    "joint_correction:1.two_stage.small": A_NUMBER,
    "joint_correction:2.scale.period": A_NUMBER,
    "terrain_search:9.small": A_NUMBER,
    "terrain_search:10.equal.sum": A_NUMBER,
}


def held(paper):
    """Claims that hold and have symbols, with the units of these."""
    for claim, statement in assertions(paper):
        if claim.expect.holds and (names := names_in(statement)):
            yield claim, statement, units_of(paper, names)


def names_in(statement):
    return {symbol.name for symbol in symbols_in(statement)}


@pytest.mark.parametrize("paper", PAPERS)
def test_every_claim_is_homogeneous_in_the_units_of_its_symbols(paper):
    for claim, statement, units in held(paper):
        assert Scaling(pairs_of(statement)).denied(units) is None, claim.id


@pytest.mark.parametrize("paper", PAPERS)
def test_what_is_printed_allows_the_units_that_its_derivation_allows(paper):
    compared = [(claim.id, s) for claim, s, _ in held(paper) if not isinstance(s, Optimum)]
    expected = {name for name in NARROWER if name.startswith(f"{paper}:")}
    assert {name for name, statement in compared if narrowed(statement)} == expected


@pytest.mark.parametrize(
    ("paper", "at_least"),
    [
        ("alpha_beta_filter", (6, 9)),
        ("guaranteed_velocity", (13, 53)),
        ("joint_correction", (0, 22)),
        ("multistructure", (17, 7)),
        ("terrain_search", (56, 4)),
        ("trajectory", (45, 12)),
    ],
)
def test_the_claims_that_units_say_something_about_are_counted(paper, at_least):
    """Those with a unit of the tables, and those whose symbols can have none at all; the rest allows any of many."""
    all_held = list(held(paper))
    with_units = sum(any(map(any, units.values())) for _, _, units in all_held)
    without = sum(len(Scaling(pairs_of(s)).solved) == len(names_in(s)) for _, s, _ in all_held)
    assert with_units >= at_least[0] and without >= at_least[1], (with_units, without, len(all_held))


# -- and it can fall ----------------------------------------------------------------------------------

#: Kinds of slips that change a unit when they touch a symbol that has one; a changed sign or number never does.
CHANGING = ("power", "index", "dropped", "doubled")


@pytest.mark.parametrize("paper", PAPERS)
def test_slips_in_the_formulas_of_every_paper_are_noticed_by_their_units(paper):
    tried = noticed = 0
    for derived, mutant in slips(paper, 140):
        slip = Equation(mutant, derived)
        denied = Scaling(pairs_of(slip)).denied(units_of(paper, names_in(slip))) is not None
        tried, noticed = tried + 1, noticed + (denied or narrowed(slip) > 0)
    assert noticed >= max(10, tried / 5), (noticed, tried)


def slips(paper, most, longest=300):
    """(derived, mutant) of one entry of equations that allow units, short ones only, a few of each entry."""
    found = []
    for _, statement, _ in held(paper):
        if not isinstance(statement, Equation) or len(Scaling(pairs_of(statement)).solved) == len(names_in(statement)):
            continue
        for printed, derived in pairs_of(statement)[:3]:
            if len(str(printed)) + len(str(derived)) < longest:
                kinds = [edit for edit in list_edits(printed) if edit.kind in CHANGING][:4]
                mutants = [mutant for edit in kinds if is_formula(mutant := apply_edit(printed, edit))]
                found += [(derived, mutant) for mutant in mutants if mutant != printed]
        if len(found) >= most:
            break
    return found


tau, r = sp.symbols("tau r", positive=True)
UNITS = {"tau": SECOND, "r": METRE}


@pytest.mark.parametrize("wrong", [tau + r, sp.sin(tau), sp.exp(-r / tau), sp.atan2(tau, r), sp.Max(r, tau), tau + 1])
def test_a_formula_that_mixes_units_is_noticed(wrong):
    assert Scaling([(wrong, wrong)]).denied(UNITS) is not None


@pytest.mark.parametrize(
    "right",
    [tau * r + 2 * tau * r, sp.sin(r / (tau + r * tau / r)) * 0, sp.atan2(r, 2 * r), sp.sqrt(r**2 + (r * sp.pi) ** 2)],
)
def test_a_homogeneous_formula_is_not_denied(right):
    assert Scaling([(right, right)]).denied(UNITS) is None


def test_a_symbol_without_a_unit_has_whatever_makes_the_formula_hold():
    a, b = sp.symbols("a b", positive=True)
    assert Scaling([(a * tau + b, r)]).denied(UNITS) is None
    assert Scaling([(a * tau + b, r), (a * b, r)]).denied(UNITS) is not None
