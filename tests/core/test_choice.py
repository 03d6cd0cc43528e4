"""A word that is misspelt is answered with the one that was meant, in every verb that knows a list of words."""

from __future__ import annotations

import pytest

from navsym.cli.main import run
from navsym.core.choice import one_of
from navsym.core.errors import DomainError


@pytest.mark.parametrize(
    "words, meant",
    [
        ("simulate terain_search", "terrain_search"),
        ("data get nagoya-rtkk", "nagoya-rtk"),
        ("campaign mutant", "mutants"),
        ("completion fsh", "fish"),
        ("list --slip papr", "paper"),
        ("list --status refutd", "REFUTED"),
        ("list --paper trajectry", "trajectory"),
        ("verify alpha_beta", "alpha_beta_filter"),
        ("report trajectori --out nowhere", "trajectory"),
    ],
)
def test_what_was_meant_is_suggested_in_one_line(words, meant, capsys):
    assert run(words.split()) == 2
    err = capsys.readouterr().err
    assert err.rstrip().endswith(f"did you mean {meant}?") and err.count("\n") == 1


def test_what_resembles_nothing_gets_the_list():
    with pytest.raises(DomainError, match=r"expected one of a, b; got zebra; name one of them"):
        one_of("zebra", ("a", "b"), "here")
    assert one_of("b", iter("ab"), "here") == "b"
