"""Faults planted into the rooms of the search, one by one: each says yes wrongly, and no false statement holds by it.

Sampling is made blind beside each, so that false statements reach the room: only the checker stands behind it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from flint import arb

import navsym as nav
from navsym.claims.verdict import PROVED, Verdict
from navsym.prove import assumptions, equations, grant, ladder, optimum, search
from navsym.prove.calculus import candidates
from navsym.prove.relations import judge
from navsym.prove.sampling.points import Sample
from navsym.prove.sampling.second_look import Look
from navsym.prove.signs import Sign, SignProof
from navsym.prove.words import judge as words
from navsym.prove.words.points import draw_sized_points
from tests.sampling import thinned

FALSE = {
    "sin(2*x) = 2*sin(x)": {},
    "sqrt(x**2) = x": {},
    "x**2 + 1 > 2*x": {},
    "exp(x) > 1 + x": {},
    "sqrt(2) + sqrt(3) = 3146/1000": {},
    "1/x <= 1/x - 1/10**9": {},
    "sin(x) = x": {"x": ["0", "1"], "tolerance": "1/10"},
    "x**2 + y**2 >= 2*x*y + 1/10**9": {},
    "integral(t**2, t, 0, x) = x**3/2": {},
    "dot(u, v) = 0": {"u": {"vector": 3}, "v": {"vector": 3}},
    "A @ B = B @ A": {"A": {"matrix": ["n", "n"]}, "B": {"matrix": ["n", "n"]}},
}
TRUE = ("sin(x)**2 + cos(x)**2 = 1", "exp(x) >= 1 + x", "x**2 + 1 >= 2*x")
RULES = ("identity", "balls", "range", "corners", "given", "empty", "roots")


def say(value: Any) -> Any:
    """A function that answers the same to everything."""
    return lambda *given, **named: value


def lie(goal: Any, sample: Any) -> Any:
    """A room that proposes the rules without data for every goal."""
    yield from ({"rule": rule} | ({"bits": 64, "cells": 9} if rule == "balls" else {}) for rule in RULES)


def forge(document: Any, verdict: Any, seconds: float) -> Any:
    """The certificate of an entry, with a proof of nothing."""
    witness = dict.fromkeys(document["symbols"], "1")
    return {"kind": "proof", "statement": document, "bits": 64, "witness": witness, "proofs": [{"rule": "identity"}]}


def hold(document: Any) -> Any:
    """Points at which the statement is said to hold."""
    yield from ((point, True) for point, _ in draw_sized_points(document))


YES = Verdict(PROVED, "a lie")
SIGN = SignProof(Sign.POSITIVE, "a lie")
#: What the fault is, and (where, the name there, what stands in its place).
FAULTS: dict[str, list[tuple[Any, str, Any]]] = {
    "equations hold": [(ladder, "decide_equation", say(YES))],
    "bounds hold": [(ladder, "decide_bound", say(YES))],
    "differences vanish": [(equations, "vanishes_identically", say(True))],
    "numbers are 0": [(equations, "is_zero", say(True)), (equations, "vanishes_identically", say(False))],
    "entries are equal": [(equations, "decide_entry", say(YES))],
    "differences hold": [(equations, "decide_difference", say(YES))],
    "roots break nothing": [(equations, "look_at_roots", say(Look()))],
    "a look proves": [(equations, "judge_look", say(YES))],
    "nothing is taken for granted": [(equations, "remaining_assumptions", say(()))],
    "signs are positive": [(assumptions, "prove_sign", say(SIGN)), (optimum, "prove_sign", say(SIGN))],
    "rules are right": [(search, "check_rule", say(None))],
    "every goal has a proof": [(search.Search, "find", say({"rule": "identity"}))],
    "every goal has balls": [(search.Search, "find", say({"rule": "balls", "bits": 64, "cells": 1}))],
    "every text has a proof": [(module, "find_proof", say({"rule": "identity"})) for module in (judge, grant)],
    "every entry has a certificate": [(grant, "prove_document", forge)],
    "the copy of the checker requires nothing": [(search.player, "require", say(None))],
    "the copy sees identities": [(search.player, "is_identity", say(True))],
    "goals vanish": [(search, "vanishes", say(True))],
    "integrals are wrong": [(candidates, "list_antiderivatives", lambda *given: iter(("x**3/2", "t**3/2")))],
    "rooms of equations lie": [(search, "EQUATIONS", ((lie,), ()))],
    "rooms of signs lie": [(search, "SIGNS", ((lie,), (), ()))],
    "points of one size prove": [(words, "refute", say(YES))],
    "words fail nowhere, and are sums": [(words, "draw_sized_points", hold), (words, "find_shares", say([]))],
}  # fmt: skip


def make_blind(monkeypatch: pytest.MonkeyPatch) -> None:
    """No sample meets a counterexample."""
    monkeypatch.setattr(equations, "search_counterexample", say(Sample(None, None, 64, arb(0))))
    monkeypatch.setattr(equations, "look_again", say(Look()))
    monkeypatch.setattr(equations, "look_at_places", say(None))
    for module in (grant, judge):
        monkeypatch.setattr(module, "find_failure", say(None))
    monkeypatch.setattr(search, "fails", say(False))


@pytest.mark.parametrize("fault", thinned(([fault] for fault in FAULTS), keep=6))
def test_a_room_that_says_yes_wrongly_gives_no_false_verdict(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, fault: str
) -> None:
    make_blind(monkeypatch)
    told = tmp_path / "told"  # a file, since statements may be decided in a child process

    def plant(lying: Any) -> Any:
        return (lambda *given, **named: (told.touch(), lying(*given, **named))[1]) if callable(lying) else lying

    for place, name, lying in FAULTS[fault]:
        monkeypatch.setattr(place, name, plant(lying))
    assert not [text for text, given in FALSE.items() if nav.prove(text, **given).holds]
    assert told.exists() or fault.startswith("rooms of")


def test_a_counterexample_that_is_none_refutes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        equations,
        "search_counterexample",
        lambda f, *given, **named: Sample(dict.fromkeys(f.free_symbols, 1), arb(1), 64, arb(1)),
    )
    assert not [text for text in TRUE if str(nav.prove(text).status) == "REFUTED"]
