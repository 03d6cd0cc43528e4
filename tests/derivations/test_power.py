"""A check that cannot fail proves nothing: every claim is run with its printed side spoiled."""

from __future__ import annotations

import importlib

import pytest

from navsym.claims import claims_of
from navsym.claims.paper import paper_names
from navsym.core.sandbox import Exhausted, run_many
from navsym.prove.ladder import decide
from tests.attacks.campaigns.edits import spoil


def spoiled_status(claim):
    return str(decide(spoil(claim.derive())).status)


@pytest.mark.parametrize("name", paper_names())
def test_every_spoiled_claim_falls(name):
    claims = [c for c in claims_of(importlib.import_module(f"navsym_papers.{name}")) if c.expect != "REFUTED"]
    held = []
    for outcome in run_many(spoiled_status, claims, jobs=1, seconds=60):
        assert not isinstance(outcome.value, Exhausted), (claims[outcome.place].id, outcome.value)
        if outcome.value in ("PROVED", "CERTIFIED", "CONFIRMED"):
            held.append(claims[outcome.place].id)
    assert not held
