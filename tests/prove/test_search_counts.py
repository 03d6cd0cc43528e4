"""A search is bounded by counts: what it finds does not depend on how fast the machine is."""

from __future__ import annotations

import time

import pytest
import sympy as sp

from navsym.language.expression import to_text
from navsym.prove import search
from navsym.prove.rooms import signs
from navsym.prove.rooms.goals import player
from navsym.prove.signs import Sign, prove_sign

T, SHARE = sp.symbols("T share", real=True)
BOX = {T: (sp.Integer(1), 1 + sp.pi / 4), SHARE: (0, 1)}
QUOTIENT = (1 - sp.sin(T - 1) + sp.cos(T - 1)) / (sp.sin(T - 1) + sp.cos(T - 1))
AT = 1 - T + SHARE * (T - 1)

#: Sides of a closed form with a switch inside its interval: by an exact proof, by balls after a search in vain.
SIDES = {
    "exact": 1 - SHARE * sp.sin(T - 1) + sp.sin(T - 1) - sp.cos(T - 1)
    - QUOTIENT * (SHARE * sp.cos(T - 1) - sp.sin(T - 1) - sp.cos(T - 1)),
    "balls": 1 - sp.cos(AT) - QUOTIENT * sp.sin(AT),
}  # fmt: skip


def slow_down(monkeypatch, factor):
    """A clock of the searches on which everything takes so many times as long."""
    clock = time.process_time
    monkeypatch.setattr(search.time, "process_time", lambda: factor * clock())


@pytest.mark.long
@pytest.mark.parametrize("way", SIDES)
def test_a_sign_that_is_proved_is_proved_in_the_same_way_on_a_machine_that_is_five_times_slower(way, monkeypatch):
    slow_down(monkeypatch, 5)
    proof = prove_sign(SIDES[way], BOX)
    assert proof.sign == Sign.NONNEGATIVE and proof.exact == (way == "exact")


def test_a_search_in_vain_ends_by_its_counts_when_the_clock_stands_still(monkeypatch):
    slow_down(monkeypatch, 0)
    played = []
    plays = search.Search.plays
    monkeypatch.setattr(search.Search, "plays", lambda self, *given: played.append(given) or plays(self, *given))
    term = player.parse(to_text(SIDES["balls"]))
    box = {"T": ["1", "1 + pi/4", []], "share": ["0", "1", []]}
    goal = player.Goal(term, ">=", {name: player.read_range(limits) for name, limits in box.items()})
    assert search.find_proof(goal, 1.0, search.SIGN_ROUNDS, balls=False) is None
    assert 0 < len(played) <= sum(tries for _, tries, _ in search.SIGN_ROUNDS)


ANY, FROM_ONE = [None, None, []], ["1", None, []]


@pytest.mark.parametrize(
    ("term", "given", "x", "tries"),
    [
        ("(a*x + b*y)**2 + (a*p + b*q)**2", (), ANY, 0),  # 0 where all are 0
        ("x*(a - y)**2 + (p - q)**2", (), FROM_ONE, 0),  # 0 where all are 1, or 0 where they may be
        ("x**2 + y**2 + 1", (), ANY, 1),
        ("x**2 + y**2", ("x - 1",), ANY, 1),  # the hypothesis excludes the zero
        ("x + y**2", (), FROM_ONE, 1),
    ],
)
def test_a_sign_that_fails_at_a_simple_point_costs_no_rule(term, given, x, tries, monkeypatch):
    played = []
    plays = search.Search.plays
    monkeypatch.setattr(search.Search, "plays", lambda self, *given: played.append(given) or plays(self, *given))
    box = {name: player.read_range(x if name == "x" else ANY) for name in "abpqxy"}
    proof = search.find_proof(player.Goal(player.parse(term), ">", box, (), tuple(map(player.parse, given))))
    assert (proof is not None) == bool(played) == bool(tries)


def test_balls_that_do_not_suffice_are_not_tried_again_and_many_of_them_only_where_tries_are_left(monkeypatch):
    goal = player.Goal(player.parse("x**2 - 2*x + 1 + exp(-40)"), ">=", {"x": player.read_range(["0", "2", []])})
    tried = []
    monkeypatch.setattr(search, "SIGNS", (search.BALLS, (), ()))
    monkeypatch.setattr(search.Search, "plays", lambda self, *given: tried.append(given[0]["cells"]))
    assert search.find_proof(goal, rounds=((8, 200, 1), (8, 400, 1))) is None
    assert len(tried) == len(set(tried)) == len(search.BALLS)
    tried.clear()
    assert search.find_proof(goal, rounds=((8, 10, 1),)) is None and tried == [signs.CELLS[0] // 4]
