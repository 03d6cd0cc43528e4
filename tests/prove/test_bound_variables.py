"""Variables of integrals, sums and limits: what stands outside keeps its meaning, and cases inside are decided."""

from __future__ import annotations

import copy

import pytest

import navsym as nav
from navsym import checker

MOVING = {"y": "real", "x": "real", "rates": {"y": "x"}}
MEAN = {"w": {"random": {"mean": "m", "cov": "1"}}, "m": "real"}
A = {"matrix": ["n", "n"]}
P = {"matrix": ["n", "n"], "symmetric": True, "positive": True}
N = {"matrix": ["n", "n"], "nonnegative": True}
GAIN = {"P": P, "H": {"matrix": ["m", "n"]}, "R": {"matrix": ["m", "m"], "positive": True}}


@pytest.mark.parametrize(
    ("false", "true", "given"),
    [
        ("integral(dot_(y), x, 0, 1) = 1/2", "integral(dot_(y), s, 0, 1) = x", MOVING),
        ("sum(dot_(y), x, 1, 2) = 3", "sum(dot_(y), x, 1, 2) = 2*x", MOVING),
        ("integral(E(w), m, 0, 1) = 1/2", "integral(E(w), m, 0, 1) = m", MEAN),
    ],
)
def test_a_rate_and_a_mean_do_not_know_the_variable(false, true, given):
    assert nav.prove(false, **given).status == "REFUTED"
    assert nav.prove(true, **given).status == "PROVED"


@pytest.mark.parametrize("text", ["integral(L, t, 0, 1) = L", "limit(L, t, 0) = L", "sum(L, t, 1, 2) = 2*L"])
def test_the_time_is_no_variable_where_a_symbol_depends_on_it(text):
    with pytest.raises(nav.NavsymError, match="another variable than t, on which L depends"):
        nav.prove(text, L={"function": "t"})
    assert nav.prove(text.replace("t,", "tau,"), L={"function": "t"}).status == "PROVED"


@pytest.mark.parametrize(
    ("left", "right", "wrong", "given"),
    [
        ("integral(max(x, 0), x, -1, 2)", "2", "3/2", {}),
        ("integral(max(sin(x), 0), x, 0, 2*pi)", "2", "0", {}),
        ("integral(min(x, 1/2), x, 0, 2)", "7/8", "1", {}),
        ("integral(where(x < 1, 0, x - 1), x, 0, 3)", "2", "3", {}),
        ("integral(sign(x - 1), x, 0, 3)", "1", "3", {}),
        ("integral(max(s, 1), s, 0, 2)", "5/2", "2", {}),
        ("integral(where(a > 0, x, 2*x), x, 0, 1)", "where(a > 0, 1/2, 1)", "1/2", {"a": "real"}),
        ("integral(sign(a), x, 0, 1)", "sign(a)", "1", {"a": "real"}),
        ("sum(floor(k/2), k, 0, 7)", "12", "14", {}),
        ("sum(where(k = 2, 5, sign(k - 3)), k, 1, 4)", "5", "4", {}),
        ("sum(floor(k + 1/2), k, 0, n)", "n*(n + 1)/2", "n*(n + 2)/2", {"n": {"integer": ["1", "oo"]}}),
        ("sum(integral(x**k, x, 0, 1), k, 1, 3)", "13/12", "1", {}),
        ("product(min(k, 2), k, 1, 4)", "8", "16", {}),
        ("limit(max(x, 1)/x, x, oo)", "1", "0", {}),
        ("diff(max(x, 0), x)", "where(x > 0, 1, 0)", "1", {"x": "nonzero"}),
    ],
)
def test_cases_below_a_variable_are_decided(left, right, wrong, given):
    assert nav.prove(f"{left} = {right}", **given).status == "PROVED"
    assert nav.prove(f"{left} = {wrong}", **given).status == "REFUTED"


@pytest.mark.parametrize(
    ("text", "given"),
    [
        ("integral(sign(a*x), x, 0, 1)**2 = 1", {"a": "real"}),  # false for a = 0
        ("integral(where(x < 0, log(a), x), x, 0, 1) = where(a > 0, 1/2, 7)", {"a": "real"}),  # false for a < 0
        ("integral(where(x = 0, 7, 1), x, -1, 1) = 16", {}),
        ("sum(sign(k), k, 0, n) = n + 1", {"n": {"integer": ["1", "oo"]}}),
        ("limit(sign(x), x, 0) = 0", {}),
    ],
)
def test_what_fails_at_seldom_points_alone_is_not_proved(text, given):
    assert nav.prove(text, **given).status in ("OPEN", "REFUTED")


@pytest.mark.parametrize(
    ("true", "false", "given"),
    [
        ("trace(P) > 0", "trace(P) < 0", {"P": P}),
        ("trace(A.T @ A) >= 0", "trace(A @ A) >= 0", {"A": A}),
        ("trace(A @ Q @ A.T) >= 0", "trace(A @ Q) >= 0", {"A": A, "Q": N}),
        ("trace(P @ Q) > 0", "trace(P @ Q) < 0", {"P": P, "Q": P}),
        ("x.T @ P @ x >= 0", "x.T @ P @ x <= 0", {"x": {"vector": "n"}, "P": P}),
        (
            "trace(P - P @ H.T @ inv(H @ P @ H.T + R) @ H @ P) <= trace(P)",
            "trace(P + H.T @ inv(R) @ H) <= trace(P)",
            GAIN,
        ),
    ],
)
def test_bounds_of_traces_hold_for_any_size(true, false, given):
    verdict = nav.prove(true, **given)
    assert verdict.status == "PROVED" and verdict.check().accepted
    assert nav.prove(false, **given).status == "REFUTED"


def test_what_may_vanish_is_not_above_zero():
    assert nav.prove("trace(Q) > 0", Q=N).status != "PROVED"
    assert nav.prove("trace(A.T @ A) > 0", A=A).status != "PROVED"


@pytest.mark.parametrize(
    ("above", "why"),
    [
        ([], "another sum"),
        ([{"coefficient": "-1", "matrices": ["Q"]}], "nonnegative matrices"),
        ([{"coefficient": "1", "matrices": ["A"]}], "nonnegative matrices"),
        ([{"coefficient": "1", "matrices": ["Q", "Q", "Q"]}], "nonnegative matrices"),
        ([{"coefficient": "2", "matrices": ["Q"]}], "another sum"),
        ([{"coefficient": "1", "matrices": ["Q"]}, {"coefficient": "1", "matrices": ["inv(A).T @ inv(A)"]}],
         "a part that may have no value"),
        ([{"coefficient": "1", "matrices": ["(1/a)*Q"]}], "a part that may have no value"),
    ],
)  # fmt: skip
def test_a_forged_sum_of_traces_is_refused(above, why):
    given = {"Q": N, "A": A, "a": "positive"}
    item = copy.deepcopy(dict(nav.prove("trace(Q) + 0*a*trace(A) >= 0", **given).certificate or {}))
    checker.check(item)
    with pytest.raises(checker.Refused, match=why):
        checker.check(item | {"above": above})


def test_a_strict_bound_needs_a_positive_matrix_and_an_equation_none():
    item = dict(nav.prove("trace(Q) >= 0", Q=N).certificate or {})
    strict = item | {"statement": item["statement"] | {"relation": ">"}}
    equal = item | {"statement": item["statement"] | {"relation": "="}}
    with pytest.raises(checker.Refused, match=r"expected a positive matrix|no value at the witness"):
        checker.check(strict)
    with pytest.raises(checker.Refused, match=r"nonnegative matrices|no value at the witness"):
        checker.check(equal)
