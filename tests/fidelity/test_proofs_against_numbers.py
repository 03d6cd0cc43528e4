"""Random claim files: no verdict may be contradicted by the numbers of the text it was given.

The text is evaluated by Python's reader and mpmath. Where both sides have a value, what was PROVED or CERTIFIED
holds; at the counterexample of what was REFUTED both sides have a value and the statement fails.
"""

from __future__ import annotations

import random

import mpmath
import pytest

from navsym.claims import CERTIFIED, PROVED, REFUTED
from navsym.core.errors import NavsymError
from navsym.core.sandbox import run_many
from navsym.prove.claimfile import claims_from, decide_claim
from navsym.verification.decide import warm_up
from tests.fidelity.plain_arithmetic import Undefined, value
from tests.fidelity.random_claims import random_claim

DIGITS = 500  # 1 - cos(x**2) of an x of 1e-31 loses a quarter of them
ZERO = mpmath.mpf(10) ** -150  # of the larger side: x**4 of an x of 1e-30 is not zero,
LEAST = mpmath.mpf(10) ** -200  # and sin(pi) is
FAILS = {
    "=": lambda d: abs(d) > ZERO,
    "!=": lambda d: abs(d) <= ZERO,
    "<": lambda d: d >= -ZERO,
    "<=": lambda d: d > ZERO,
    ">": lambda d: d <= ZERO,
    ">=": lambda d: d < -ZERO,
}
#: At a random point nothing is to be told of what is exactly zero: only what fails by a margin denies a proof.
DENIES = {**FAILS, "!=": lambda d: False, "<": lambda d: d > ZERO, ">": lambda d: d < -ZERO}


def sides(document, point):
    """The difference of the sides as a part of the larger one."""
    row = document["claim"][0]
    with mpmath.workdps(DIGITS):
        left, right = (value(row[side], point, DIGITS) for side in ("left", "right"))
        return (left - right) / max(abs(left), abs(right), LEAST)


def ends(declared):
    if isinstance(declared, list):
        return tuple(value(end, {}, DIGITS) for end in declared)
    return {"positive": (mpmath.mpf(0), None), "nonnegative": (mpmath.mpf(0), None)}.get(declared, (None, None))


def random_point(document, source):
    point = {}
    for name, declared in document["symbols"].items():
        low, high = ends(declared)
        with mpmath.workdps(DIGITS):
            share = mpmath.mpf(source.choice([1, 3, 7, 500, 997, source.randint(1, 999)])) / 1000
            if high is not None:
                point[name] = low + (high - low) * share
            else:
                wide = 6 * share  # larger ones lose all digits in cosh(u)**2 - sinh(u)**2
                point[name] = wide if low is not None or source.random() < 0.5 else -wide
    return point


def contradicted(document, record, source):
    """Why the numbers deny the verdict, or None."""
    relation = document["claim"][0]["relation"]
    if record.status == REFUTED:
        point = {**random_point(document, source), **record.counterexample}  # what cancelled may be anything
        try:
            d = sides(document, point)
        except Undefined:
            return f"no value at {dict(record.counterexample)}"
        return None if FAILS[relation](d) else f"true at {dict(record.counterexample)}"
    if record.status in (PROVED, CERTIFIED):
        seen = 0
        for _ in range(40):
            point = random_point(document, source)
            try:
                d = sides(document, point)
            except Undefined:
                continue
            seen += 1
            if DENIES[relation](d):
                return f"{record.status}, and the difference is {mpmath.nstr(d, 5)} at {point}"
        if not seen and not record.assumptions:
            return f"{record.status} without assumptions, and no value anywhere"
    return None


def judged(document):
    try:
        (claim,) = claims_from(document, "f").claims
    except NavsymError:
        return None
    return decide_claim(claim)


def attack(seed, count, seconds=2):
    """Statuses, and what the numbers deny. A claim that takes longer than its seconds has no verdict."""
    source = random.Random(seed)
    documents = [random_claim(source) for _ in range(count)]
    statuses, found = {}, []
    warm_up()
    for outcome in run_many(judged, documents, 2, seconds):
        verdict = outcome.value
        status = getattr(verdict, "status", "none")
        statuses[status] = statuses.get(status, 0) + 1
        why = contradicted(documents[outcome.place], verdict, source) if hasattr(verdict, "status") else None
        if why:
            found.append((documents[outcome.place], why))
    return statuses, found


@pytest.mark.long
def test_no_verdict_on_a_random_claim_is_contradicted():
    statuses, found = attack(seed=1, count=50)
    assert not found, found
    assert statuses.get(PROVED, 0) > 5 and statuses.get(REFUTED, 0) > 5


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2, 42))
def test_no_verdict_on_many_random_claims_is_contradicted(seed):
    """Eight thousand in all, in pieces of less than a minute, so that a stopped campaign loses little."""
    _, found = attack(seed, 200, seconds=5)
    assert not found, found


def test_a_sine_that_is_zero_has_no_sign():
    """sqrt(cos(x)) has a value at pi/2, and atan2(sin(x), cos(x)) is pi at pi: rounding would deny both."""
    with mpmath.workdps(DIGITS):
        assert value("sqrt(cos(x))", {"x": "pi/2"}, DIGITS) == 0
        assert value("sqrt(-cos(x))", {"x": "3*pi/2"}, DIGITS) == 0
        assert value("atan2(sin(x), cos(x))", {"x": "pi"}, DIGITS) > 3
        assert value("sin(x)", {"x": "1/10**40"}, DIGITS) > 0
