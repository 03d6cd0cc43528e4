"""The independent checker accepts what is true and refuses every forgery, each for its own reason."""

from __future__ import annotations

import copy
import random
import re

import pytest
from flint import fmpq

from navsym import checker
from tests.checker import calculus
from tests.checker.adversary import tricks
from tests.checker.examples import EXPONENTIAL, GAP, GOOD, PARABOLA, RANGE, TOUCH
from tests.checker.forgeries import (
    BROKEN,
    EQUAL,
    FORGERIES,
    FUNCTIONS,
    OUTSIDE,
    STATIONARY,
    UNEQUAL,
    changed,
    enclosed,
    identity,
    judged,
    readable,
    verdict,
)


@pytest.mark.parametrize("item", GOOD, ids=lambda item: item["kind"])
def test_a_true_certificate_is_accepted(item):
    assert verdict(item, checker) == ""


@pytest.mark.parametrize(("item", "path", "value", "why"), FORGERIES, ids=lambda x: str(x)[:24])
def test_each_forgery_is_refused_for_its_own_reason(item, path, value, why):
    assert re.search(why, verdict(changed(item, path, value), checker) or "accepted")


def test_the_stationary_point_inside_its_panel_is_accepted():
    longer = changed(STATIONARY, ["panels", 0, "to"], "2")
    assert verdict(changed(longer, ["pieces", 0, "contacts", 0, "at"], ["0.5"]), checker) == ""


@pytest.mark.parametrize("pair", EQUAL, ids=lambda pair: pair[0])
def test_a_true_identity_is_accepted(pair):
    assert verdict(identity(*pair), checker) == ""


@pytest.mark.parametrize("pair", UNEQUAL, ids=lambda pair: pair[0])
def test_a_false_identity_is_refused(pair):
    assert verdict(identity(*pair), checker) == "the sides differ"


@pytest.mark.parametrize("text", OUTSIDE)
def test_anything_outside_the_language_is_refused(text):
    assert verdict(identity(text, text), checker)


@pytest.mark.parametrize("text", BROKEN, ids=lambda text: text[:20])
def test_floats_duplicates_and_broken_json_are_refused(text):
    assert not readable(text, checker)


@pytest.mark.parametrize(("text", "series"), FUNCTIONS, ids=lambda x: x if isinstance(x, str) else "")
def test_a_function_of_the_parameter_has_its_two_derivatives(text, series):
    assert enclosed(text, series, checker)


def test_an_answer_leaves_the_precision_of_the_caller_alone():
    before = checker.ctx.prec, checker.ctx.cap
    checker.check(PARABOLA)
    assert (checker.ctx.prec, checker.ctx.cap) == before


def test_no_trick_is_accepted_and_none_is_an_error_of_another_kind():
    found = list(tricks())
    assert len(found) > 2000
    assert [name for name, item in found if judged(item, checker) == ""] == []


def alterations(item, rng):
    """One random change of a number, a sign, a name or a list, at any depth."""
    forged = copy.deepcopy(item)
    places = []

    def walk(node, path):
        children = node.items() if isinstance(node, dict) else enumerate(node)
        for key, child in children:
            places.append((*path, key))
            if isinstance(child, dict | list):
                walk(child, (*path, key))

    walk(forged, ())
    path = rng.choice([p for p in places if p[-1] not in ("cells", "bits", "measurement", "radius")])
    node = forged
    for key in path[:-1]:
        node = node[key]
    old = node[path[-1]]
    if isinstance(old, str) and old.replace(".", "").replace("-", "").isdigit():
        node[path[-1]] = rng.choice(
            [old + "1" if "." in old else old + ".1", "-" + old if old[0] != "-" else old[1:], "7"]
        )
    elif isinstance(old, int):
        node[path[-1]] = rng.choice([-old - 1, old + 1, "1", 0.5])
    elif isinstance(old, str):
        node[path[-1]] = rng.choice([old + "*2", "no", "1/0", ""])
    else:
        node[path[-1]] = rng.choice([[], {}, None, "1"])
    return forged, path, old, node[path[-1]]


def harmless(kind, path, old, new) -> bool:
    """True for changes that leave the statement true.

    Bounds made wider, another label, a hint moved within its box, another parameter that occurs nowhere.
    """
    if kind != "range" and path[0] in ("parameter", "from", "to"):
        return True
    return old == new or path[-1] in ("lower", "upper", "variable", "kind") or "radius" in path or "null" in path


def test_random_alterations_do_not_pass():
    rng = random.Random(3)
    passed = []
    for _ in range(400):
        item = rng.choice([GAP, TOUCH, PARABOLA, RANGE, EXPONENTIAL])
        forged, path, old, new = alterations(item, rng)
        if not harmless(item["kind"], path, old, new) and verdict(forged, checker) == "":
            passed.append((item["kind"], path, old, new))
    # A digit appended far behind stays inside the box that is proved: the certificate is still true.
    assert [p for p in passed if not still_true(p)] == []


def still_true(case) -> bool:
    kind, path, old, new = case
    try:
        size = abs(float(new) - float(old))
    except (TypeError, ValueError):
        return False
    return size < 0.01 * max(1.0, abs(float(old))) or (kind == "gap" and path[0] in ("support", "dual"))


def test_a_certificate_is_not_consumed_by_its_check():
    assert list(calculus.discrepancies(checker)) == list(calculus.discrepancies(checker)) == []


def test_what_a_number_is_does_not_depend_on_what_was_asked_before(monkeypatch):
    monkeypatch.setattr(checker, "EFFORT", [checker.MOST_EFFORT])
    assert checker.constant_of(checker.parse("(1/11)*2")) == fmpq(2, 11)
    with pytest.raises(checker.Refused, match="too many terms"):
        checker.Exact(2) * 3
    assert (checker.Exact(2) * 3).terms == {frozenset(): 6}
