"""A bound that holds strictly on a closed box brings a certificate that the checker replays."""

from __future__ import annotations

import pytest

from navsym import checker
from navsym.prove.claimfile import claims_from, decide_claim

SYMBOLS = {"s": ["-1", "1"], "p": ["0", "1"], "t": ["0", "pi/2"], "T": "positive"}


def decided(left, relation, right):
    document = {"symbols": SYMBOLS, "claim": [{"id": "one", "left": left, "relation": relation, "right": right}]}
    return decide_claim(claims_from(document).claims[0])


@pytest.mark.parametrize(
    ("left", "relation", "right"),
    [
        ("exp(s) - s", ">", "1/2"),
        ("sin(t) + p", ">=", "-1"),
        ("1/(1 + p)", "<", "2"),
        ("log(1 + p)", "<", "1"),
        ("sqrt(2 - p)", ">", "1/2"),
        ("tan(t/2)", "<", "2"),
        ("tanh(s)", "<", "1"),
        ("atan(s)", "<", "1"),
        ("p", "!=", "2"),
        ("2", "<", "3"),
        ("(1 + p)**(1/3)", "<", "2"),
        ("exp(-p)*cos(s)", ">", "1/10"),
        ("cot(t/2 + 1/10)", ">", "0"),
    ],
)
def test_the_checker_accepts_it_and_refuses_it_for_the_opposite(left, relation, right):
    certificate = decided(left, relation, right).certificate
    assert checker.check(certificate) == "proof"
    statement = certificate["statement"]
    with pytest.raises(checker.Refused):
        opposite = {"left": right, "right": left} if relation != "!=" else {"right": left}
        checker.check({**certificate, "statement": {**statement, **opposite}})


@pytest.mark.parametrize(("left", "relation", "right"), [("sin(t)", "<=", "t"), ("abs(s)", "<", "2")])
def test_what_is_touched_or_bent_has_one_too(left, relation, right):
    verdict = decided(left, relation, right)
    assert verdict.status.holds and checker.check(verdict.certificate) == "proof"
