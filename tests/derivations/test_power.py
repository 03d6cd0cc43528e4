"""A check that cannot fail proves nothing: every claim is run with its printed side spoiled."""

from __future__ import annotations

import pytest

from navsym.core.sandbox import Exhausted, run_many
from navsym.prove.ladder import decide
from tests.attacks.campaigns.edits import spoil
from tests.derivations.statements import IN_PARTS, claims, part_of


def spoiled_status(case):
    _, statement = case
    return str(decide(spoil(statement)).status)


#: The spoiled claims of one paper take as long as those of all others.
SHORT = [part for part in IN_PARTS if part != ("multistructure", "a dozen")]
ALL = [*SHORT, pytest.param("multistructure", "a dozen", marks=pytest.mark.long)]


@pytest.mark.parametrize(("name", "part"), ALL)
def test_every_spoiled_claim_falls(name, part):
    cases = part_of([(claim, statement) for claim, statement in claims(name) if claim.expect != "REFUTED"], part)
    held = []
    for outcome in run_many(spoiled_status, cases, jobs=1, seconds=60, share=16):
        claim, _ = cases[outcome.place]
        assert not isinstance(outcome.value, Exhausted), (claim.id, outcome.value)
        if outcome.value in ("PROVED", "CERTIFIED", "CONFIRMED"):
            held.append(claim.id)
    assert not held
