"""The ball kinds again: at other precisions by the checker, and by mpmath's intervals, which share no code with it."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from typing import Any

import mpmath
import pytest

from navsym import checker
from tests.checker import second
from tests.checker.examples import EDGE, GOOD, POSITIVITY
from tests.checker.forgeries import verdict

iv = mpmath.iv
# One with two hundred panels alike is left to the checker.
OPTIMA = [o for o in GOOD if o["kind"] in ("gap", "touch", "sliver") and len(o["panels"]) < 9]
RANGES = [item for item in GOOD if item["kind"] == "range"]


@pytest.mark.parametrize("bits", [150, 311, 1000])
@pytest.mark.parametrize("item", [*OPTIMA, *RANGES, POSITIVITY], ids=lambda item: item["kind"])
def test_a_certificate_holds_at_every_higher_precision(item, bits):
    assert verdict(item | {"bits": bits}, checker) == ""


def interval(node: Any, names: dict[str, Any]) -> Any:
    """The tree of the second opinion in mpmath's intervals."""
    if isinstance(node, Fraction):
        return iv.mpf(node.numerator) / node.denominator
    if isinstance(node, str):
        return iv.pi if node == "pi" else names[node]
    if len(node) == 2:
        return getattr(iv, node[0])(interval(node[1], names))
    x = interval(node[1], names)
    if node[0] == "**":
        return x ** int(second.constant(node[2]))
    y = interval(node[2], names)
    return x + y if node[0] == "+" else x - y if node[0] == "-" else x * y if node[0] == "*" else x / y


def number(text: str) -> Any:
    return interval(Fraction(text), {})


def hull(low: Any, high: Any, k: int, n: int) -> Any:
    """Part k of n of the interval between two."""
    return low + (high - low) * iv.mpf([k, k + 1]) / n


def regressors(panel: dict[str, Any], place: Any, names: dict[str, Any], t: str) -> list[Any]:
    low, high, sigma = (interval(second.tree(panel[key]), names) for key in ("from", "to", "sigma"))
    here = names | {t: low + (high - low) * place}
    return [interval(second.tree(h), here) / sigma for h in panel["H"]]


@pytest.mark.parametrize("item", OPTIMA, ids=lambda item: item["kind"])
def test_the_dual_of_an_optimum_stays_below_one_in_other_intervals(item):
    iv.dps, n = 40, 2000
    names = {item["parameter"]: iv.mpf([item["from"], item["to"]])} if item["kind"] == "sliver" else {}
    dual = item["dual"] if "dual" in item else item["pieces"][0]["dual"]
    x = [number(c[0] if isinstance(c, list) else c) for c in dual]
    for panel, k in product(item["panels"], range(n)):
        q = regressors(panel, hull(iv.mpf(0), iv.mpf(1), k, n), names, item["variable"])
        assert abs(sum(a * b for a, b in zip(x, q, strict=True))).b < 1 + 0.02  # naive intervals: one cell wide


def around(text: str, radius: str) -> Any:
    """The box of a certificate: a centre and a radius."""
    return number(text) + number(radius) * iv.mpf([-1, 1])


@pytest.mark.parametrize("item", [o for o in OPTIMA if o["kind"] == "touch"], ids=lambda item: item["kind"])
def test_the_boxes_of_a_touch_satisfy_the_constraints_and_cost_the_dual_value(item):
    iv.dps = 40
    (piece,) = item["pieces"]
    m, rows = len(piece["dual"]), piece["contacts"]
    centres = [c[0] for c in (*piece["dual"], *(row["at"] for row in rows), *(row["weight"] for row in rows))]
    boxes = [around(c, r) for c, r in zip(centres, piece["radius"], strict=True)]
    total, cost = [iv.mpf(0)] * m, iv.mpf(0)
    for row, place, w in zip(rows, boxes[m : m + len(rows)], boxes[m + len(rows) :], strict=True):
        q = regressors(item["panels"][row["panel"]], place, {}, item["variable"])
        total, cost = [a + w * b for a, b in zip(total, q, strict=True)], cost + abs(w)
    P = [interval(second.tree(p), {}) for p in item["functional"]]
    value = sum(x * p for x, p in zip(boxes[:m], P, strict=True))
    assert all(0 in a - p for a, p in zip(total, P, strict=True))
    assert 0 in cost - value
    assert number(item["lower"]).a - value.delta < value.mid < number(item["upper"]).b + value.delta


@pytest.mark.parametrize("item", [POSITIVITY, EDGE], ids=["waves", "edge"])
def test_a_positive_expression_is_positive_in_other_intervals(item):
    iv.dps, n = 20, 60
    tree, names = second.tree(item["expression"]), list(item["box"])
    ends = [[interval(second.tree(e), {}) for e in item["box"][s]] for s in names]
    for cell in product(range(n), repeat=len(names)):
        here = {s: hull(*pair, k, n) for s, pair, k in zip(names, ends, cell, strict=True)}
        assert interval(tree, here).a > 0
