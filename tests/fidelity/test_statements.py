"""What is decided is what is printed: every claim's text read back, and evaluated by other means.

1. every formula of every claim goes through the printer and the parser and comes back the same;
2. the texts of both sides, evaluated by Python's reader and mpmath, agree where the claim holds, and differ
   at the counterexample where it is refuted; printed numerals agree within half a unit of their last digit.

Units are looked at in ``test_units.py``.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import mpmath
import pytest
import sympy as sp

from navsym.claims import Bound, Equation, Optimum, Property
from navsym.claims.paper import import_paper
from navsym.language.expression import parse, to_text
from navsym.language.tokens import LENGTH
from navsym.prove.equations import list_entries
from navsym.prove.sampling.points import draw_points
from navsym.verification.decide import sides
from navsym.verification.papers import paper_module
from tests.attacks.campaigns.edited_values import values_at
from tests.derivations.statements import IN_PARTS, PAPERS, assertions, claims, formulas, part_of, symbols_in
from tests.fidelity.plain_arithmetic import Undefined, value

ROOT = Path(__file__).resolve().parents[2]
CLOSE = mpmath.mpf(10) ** -25
SHORT = 1_000  # characters of a formula that is looked at in every run


@cache
def ledger():
    records = json.loads((ROOT / "derivations" / "verdicts.json").read_text())["claims"]
    return {record["id"]: record for record in records}


# -- 1. printer and parser -------------------------------------------------------------------------

OUTSIDE = (sp.Max, sp.Min, sp.sign)  # not in the language of files


@pytest.mark.parametrize(("paper", "part"), IN_PARTS)
def test_every_formula_comes_back_from_its_text(paper, part):
    """Short ones in every run; primes and the like are named anew."""
    not_back = lost_on_the_way(part_of(assertions(paper), part), SHORT)
    assert not not_back, "\n".join(not_back[:20])


@pytest.mark.slow
@pytest.mark.parametrize("paper", PAPERS)
def test_every_long_formula_comes_back_from_its_text(paper):
    """Up to the length that the language of files allows."""
    not_back = lost_on_the_way(assertions(paper), LENGTH)
    assert not not_back, "\n".join(not_back[:20])


def lost_on_the_way(some, longest):
    failed = []
    for claim, statement in some:
        assert len({s.name for s in symbols_in(statement)}) == len(symbols_in(statement)), claim.id
    for formula in dict.fromkeys(f for _, s in some for f in formulas(s) if not f.has(*OUTSIDE)):
        renamed, symbols = in_plain_names(formula)
        text = to_text(renamed)
        if len(text) <= longest:
            back = parse(text, symbols)
            if back != renamed and not same_number(back, renamed):
                failed.append(f"{formula!s:.80} came back as {back!s:.80}")
    return failed


def in_plain_names(formula):
    """The formula in symbols s0, s1, ... that are declared like its own."""
    ordered = sorted(formula.free_symbols, key=str)
    plain = [sp.Symbol(f"s{k}", **known.assumptions0) for k, known in enumerate(ordered)]
    return formula.xreplace(dict(zip(ordered, plain, strict=True))), {s.name: s for s in plain}


def same_number(left, right):
    """Equal balls at points of a box of positive numbers: what differs is only the order of building."""
    for point in draw_points(sorted(left.free_symbols | right.free_symbols, key=str), {}, 5):
        values = values_at(point)
        if not (values.of(left) - values.of(right)).contains(0):
            return False
    return True


@pytest.mark.parametrize("paper", PAPERS)
def test_the_ledger_prints_what_is_decided(paper):
    for claim, statement in claims(paper):
        record = ledger().get(claim.id)
        if record is not None:
            assert (record["printed"], record["derived"]) == sides(statement), claim.id


# -- 2. the texts, evaluated by other means -----------------------------------------------------------


def texts(statement):
    """Pairs of texts (printed, derived) of an equation or inequality, entry by entry."""
    pairs = zip(list_entries(statement.printed), list_entries(statement.derived), strict=True)
    return [(text(p), text(d)) for p, d in pairs if not (p.has(*OUTSIDE) or d.has(*OUTSIDE))]


@cache
def text(formula):
    """Text of the language of files; names with primes and the like are spelled out."""
    names = {s: sp.Symbol(plain(s.name), **s.assumptions0) for s in formula.free_symbols if plain(s.name) != s.name}
    return to_text(formula.xreplace(names))


def plain(name):
    return name.replace("'", "_prime")


def differences(statement, point, digits=50, longest=10**6):
    """printed - derived of every entry that has a value at the point, from the texts alone."""
    place = {plain(symbol.name): to_text(value) for symbol, value in point.items()}
    found = []
    for printed, derived in texts(statement):
        if len(printed) + len(derived) > longest:
            continue
        try:
            left, right = value(printed, place, digits), value(derived, place, digits)
        except Undefined:
            continue
        with mpmath.workdps(digits):
            found.append((left - right, max(abs(left), abs(right), 1)))
    return found


def symbols_of(statement):
    parts = (*list_entries(statement.printed), *list_entries(statement.derived))
    return sorted(set().union(*(part.free_symbols for part in parts)), key=str)


DENIED = {
    "=": lambda d, e: abs(d) > e,
    "!=": lambda d, e: False,
    "<": lambda d, e: d > e,
    "<=": lambda d, e: d > e,
    ">": lambda d, e: d < -e,
    ">=": lambda d, e: d < -e,
}


@pytest.mark.parametrize(("paper", "part"), IN_PARTS)
def test_what_holds_is_not_denied_by_the_numbers_of_its_text(paper, part):
    assert compared(part_of(assertions(paper), part), SHORT, 2) > 2


@pytest.mark.slow
@pytest.mark.parametrize("paper", PAPERS)
def test_long_formulas_are_not_denied_by_their_numbers_either(paper):
    assert compared(assertions(paper), 10**6, 4) > 20


def compared(some, longest, count):
    """Number of entries that were compared at points; asserts that none is denied."""
    seen = 0
    for claim, statement in some:
        if isinstance(statement, Optimum) or not claim.expect.holds:
            continue
        relation = getattr(statement, "relation", "=")
        room = mpmath.mpf(0)
        if isinstance(statement, Equation) and statement.tolerance is not None:
            room = value(to_text(sp.sympify(statement.tolerance, strict=True)), {})
        for point in draw_points(symbols_of(statement), statement.box, count, seed=5):
            for difference, size in differences(statement, point, longest=longest):
                seen += 1
                with mpmath.workdps(50):
                    assert not DENIED[relation](difference, room + CLOSE * size), (claim.id, point, difference)
    return seen


@pytest.mark.parametrize("paper", PAPERS)
def test_what_is_refuted_is_denied_at_its_counterexample(paper):
    for claim, statement in assertions(paper):
        record = ledger().get(claim.id, {})
        place = record.get("counterexample")
        if isinstance(statement, Optimum) or record.get("status") != "REFUTED" or not record.get("difference"):
            continue
        symbols = {s.name: s for s in symbols_of(statement)}
        point = {symbols[name]: parse(text, {}) for name, text in place.items() if name in symbols}
        found = [difference for difference, _ in differences(complete(statement, point), point)]
        with mpmath.workdps(50):
            low, high = (mpmath.mpf(end) for end in record["difference"])
            assert any(low - CLOSE <= d <= high + CLOSE for d in found), (claim.id, found, record["difference"])


def complete(statement, point):
    """The statement without the entries that have symbols beyond the point."""
    pairs = zip(list_entries(statement.printed), list_entries(statement.derived), strict=True)
    kept = [(p, d) for p, d in pairs if (p - d).free_symbols | p.free_symbols | d.free_symbols <= set(point)]
    return type("Kept", (), {"printed": [p for p, _ in kept], "derived": [d for _, d in kept]})


@pytest.mark.parametrize("paper", ["guaranteed_velocity"])
def test_inequalities_and_optima_are_among_what_is_read_back(paper):
    kinds = {type(statement) for _, statement in claims(paper)}
    assert kinds == {Equation, Bound, Optimum, Property}
    assert sum(len(paper_module(import_paper(name)).claims) for name in PAPERS) >= 750
