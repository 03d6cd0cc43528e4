"""Claim files of the prove verb."""

from __future__ import annotations

import pytest
import sympy as sp

from navsym.core.errors import NavsymError
from navsym.language.tomlfile import parse_toml
from navsym.prove.claimfile import claims_from, read_claims

FILE = """
[symbols]
T = ["0", "2*pi"]
a = "real"
[[claim]]
id    = "double-angle"
left  = "sin(2*a)*a/a"
right = "2*sin(a)*cos(a)"
relation = "="
[[claim]]
id = "bound"
left = "sin(T)"
right = "T"
relation = "<="
box = {T = ["0", "1"]}
[[claim]]
id = "rotation"
left = [["1", "a"], ["0", "1"]]
right = [["1", "a"], [0, 1.0]]
"""


def read(text):
    return claims_from(parse_toml(text, "c.toml"), "c.toml")


def test_claims_are_read_exactly(tmp_path):
    path = tmp_path / "c.toml"
    path.write_text(FILE)
    file = read_claims(path)
    T, a = file.symbols["T"].symbol, file.symbols["a"].symbol
    first, second, third = file.claims
    assert (first.id, first.relation) == ("double-angle", "=")
    assert first.left == sp.sin(2 * a) and first.right == 2 * sp.sin(a) * sp.cos(a)
    assert first.divisors == (a,)
    assert first.box == {T: (0, 2 * sp.pi)} and second.box == {T: (0, 1)}
    assert third.left == third.right == sp.Matrix([[1, a], [0, 1]])


@pytest.mark.parametrize(
    ("old", "new", "kind", "place"),
    [
        ('id = "bound"', 'id = "double-angle"', "duplicate", "claim"),
        ('id = "bound"', 'id = ""', "empty", "claim[1].id"),
        ('id = "bound"', 'id = "a b"', "syntax", "claim[1].id"),
        ('id = "bound"', "id = 3", "syntax", "claim[1].id"),
        ('id = "bound"\n', "", "empty", "claim[1].id"),
        ('"<="', '"=="', "syntax", "claim[1].relation"),
        ('"<="', '"≤"', "syntax", "claim[1].relation"),
        ('left = "sin(T)"\n', "", "empty", "claim[1].left"),
        ('"sin(T)"', '"sin(tau)"', "unknown-symbol", "claim[1].left, column 5"),
        ('"sin(T)"', '["sin(T)"]', "shape", "claim[1]"),
        ('T = ["0", "1"]', 'T = ["0", "7"]', "domain", "claim[1].box.T"),
        ('T = ["0", "1"]', 'S = ["0", "1"]', "syntax", "claim[1].box.S"),
        ('["1", "a"], ["0", "1"]', '["1", "a"], ["0"]', "shape", "claim[2].left"),
        ('["0", "2*pi"]', '["2*pi", "0"]', "domain", "symbols.T"),
        ('a = "real"', 'a = "complex"', "syntax", "symbols.a"),
        ('a = "real"', 'abs = "real"', "duplicate", "symbols.abs"),
        ("[symbols]", "[symbol]", "syntax", "symbol"),
        ('relation = "<="', 'relation = "<="\ntolerance = 0.5', "domain", "claim[1].tolerance"),
        ('relation = "="', 'relation = "="\ntolerance = -0.5', "domain", "claim[0].tolerance"),
        ('relation = "="', 'relation = "="\nexists = "1/a"', "shape", "claim[0].exists"),
        ('relation = "="', 'relation = "="\nexists = ["1/b"]', "unknown-symbol", "claim[0].exists[0], column 3"),
        ('relation = "="', 'relatoin = "="', "syntax", "claim[0].relatoin"),
    ],
)
def test_a_mistake_in_a_claim_is_named_with_its_place(old, new, kind, place):
    assert old in FILE
    with pytest.raises(NavsymError, match=r"expected .*; got .*; \w") as caught:
        read(FILE.replace(old, new))
    assert caught.value.kind == kind
    assert place in caught.value.where


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("[symbols]", "empty"),
        ("claim = []", "empty"),
        ("[claim]", "shape"),
        ("claim = [1]", "shape"),
        ("[symbols]\n" + "\n".join(f'a{i} = "real"' for i in range(65)) + '\n[[claim]]\nid="a"', "too-large"),
    ],
)
def test_a_file_needs_claims(text, kind):
    with pytest.raises(NavsymError) as caught:
        read(text)
    assert caught.value.kind == kind
