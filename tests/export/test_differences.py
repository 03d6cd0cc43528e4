"""``navsym diff``: equal is proved, different is shown at its worst point."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import pytest
import sympy as sp

import navsym as nav
from navsym.cli.main import run


def document(capsys, *words: str) -> tuple[int, dict]:
    status = run(["diff", *words, "--json"])
    return status, json.loads(capsys.readouterr().out)


def test_two_forms_of_one_formula_are_proved_equal(capsys) -> None:
    status, found = document(capsys, "cos(x)**2 - sin(x)**2", "cos(2*x)")
    assert status == 0 and found["equal"] and found["differences"][0]["status"] == "EQUAL"


def test_a_lost_sign_is_shown_where_it_costs_most(capsys) -> None:
    status, found = document(capsys, "sin(x)", "0 - sin(x)", "--range", "x=0,pi/2")
    (record,) = found["differences"]
    assert status == 1 and record["status"] == "DIFFERENT"
    assert record["worst"] == {"x": "pi/2"} and float(record["difference"][0]) == pytest.approx(2)


def test_two_ranges_of_one_symbol_are_refused_and_both_named(capsys) -> None:
    assert run(["diff", "x", "x", "--range", "x=0,1", "--range", "x=1,2"]) == 2
    assert "got 0,1 and 1,2" in capsys.readouterr().err


def test_claim_files_are_compared_claim_by_claim(capsys, tmp_path: Path) -> None:
    text = '[symbols]\na = "real"\n[[claim]]\nid = "one"\nleft = "{}"\nright = "a"\n'
    old, new = tmp_path / "old.toml", tmp_path / "new.toml"
    old.write_text(text.format("a + a"))
    new.write_text(text.format("2*a") + '[[claim]]\nid = "two"\nleft = "a"\nright = "a"\n')
    status, found = document(capsys, str(old), str(new))
    assert status == 1
    assert {r["name"]: r["status"] for r in found["differences"]} == {"one": "EQUAL", "two": "ONLY-NEW"}


@pytest.mark.parametrize(
    ("old", "new", "status"),
    [
        ('right = "2*sin(a)*cos(a)"', 'right = "2*sin(a)*cos(a)**2"', "DIFFERENT"),
        ('right = "2*sin(a)*cos(a)"', 'right = "(sin(a) + cos(a))**2 - 1"', "EQUAL"),
        ('right = "2"\nrelation = "<="', 'right = "2"\nrelation = ">="', "DIFFERENT"),
        ('right = "2"\ntolerance = "3"', 'right = "2"\ntolerance = "1"', "DIFFERENT"),
    ],
)
def test_two_claims_are_equal_only_with_their_right_sides_and_relations(tmp_path: Path, old, new, status) -> None:
    for name, text in (("old", old), ("new", new)):
        claim = f'[symbols]\na = "real"\n[[claim]]\nid = "c"\nleft = "sin(2*a)"\n{text}\n'
        (tmp_path / f"{name}.toml").write_text(claim)
    assert nav.diff(tmp_path / "old.toml", tmp_path / "new.toml")[0].status == status


MIXED = """
[symbols]
a = "real"
b = "positive"
u = { vector = 3 }
[[claim]]
id = "numbers"
left = "sin(2*a)"
right = "2*sin(a)*cos(a)"
[[claim]]
id = "vectors"
left = "u"
right = "1*u"
[[claim]]
id = "given"
left = "a*b"
right = "1"
given = ["a = 1/b"]
[[claim]]
id = "unreadable"
left = "foo(a)"
right = "1"
"""


def test_one_claim_that_is_not_compared_is_named_and_the_others_are_compared(tmp_path: Path) -> None:
    """A condition, a declaration or a side that has changed is never EQUAL where no proof was tried."""
    for name, old, new in (("given", "1/b", "2/b"), ("given", '"positive"', '"nonzero"'), ("vectors", "1*u", "2*u")):
        (tmp_path / "old.toml").write_text(MIXED)
        (tmp_path / "new.toml").write_text(MIXED.replace(old, new))
        found = {d.name: d for d in nav.diff(tmp_path / "old.toml", tmp_path / "new.toml")}
        other = {"given": "vectors", "vectors": "given"}[name]
        assert found["numbers"].status == "EQUAL" and (found[other].status, found[other].why) == (
            "EQUAL",
            "the same text",
        )
        assert found[name].status == found["unreadable"].status == "OPEN"
        assert found[name].why.startswith("not compared") and "claim[3].left" in found["unreadable"].why
        assert not nav.diff(tmp_path / "old.toml", tmp_path / "old.toml").equal


def test_an_unreadable_claim_does_not_keep_others_of_its_file_from_export(tmp_path: Path) -> None:
    (tmp_path / "mixed.toml").write_text(MIXED)
    found = nav.export(f"{tmp_path}/mixed.toml:numbers", to=["python"], out=tmp_path / "code")
    assert found.document()["functions"]
    assert nav.show(f"{tmp_path}/mixed.toml:numbers")[0].status == "PROVED"
    for call in (nav.show, lambda claim: nav.export(claim, to=["python"], out=tmp_path / "none")):
        with pytest.raises(nav.NavsymError, match="got 'foo'"):
            call(f"{tmp_path}/mixed.toml:unreadable")


def test_exports_are_compared_by_their_formulas(capsys, tmp_path: Path) -> None:
    for name in ("a", "b"):
        words = ["export", f"weight=guaranteed_velocity:4.12.Phi3{'1' if name == 'a' else '2'}", "--no-run"]
        assert run([*words, "--out", str(tmp_path / name), "--vectors", "4"]) == 0
    capsys.readouterr()
    status, found = document(capsys, str(tmp_path / "a"), str(tmp_path / "a"))
    assert status == 0 and found["equal"]
    status, found = document(capsys, str(tmp_path / "a"), str(tmp_path / "b"))
    assert status == 1 and found["differences"][0]["status"] == "DIFFERENT"


@pytest.mark.parametrize("words", [("x +", "x"), ("", "x"), ("x", "missing.toml"), ("x", "x", "--range", "x=1")])
def test_bad_input_is_bad_input(capsys, words: tuple[str, ...]) -> None:
    status, found = document(capsys, *words)
    assert status == 2 and "expected" in found["error"]["message"]


def test_matrices_of_claim_files_are_compared_entry_by_entry(capsys, tmp_path: Path) -> None:
    sides = 'left = [["a", "1"], ["0", "{}"]]\nright = [["a", "1"], ["0", "a"]]\n'
    text = f'[symbols]\na = "real"\n[[claim]]\nid = "m"\n{sides}'
    old, new = tmp_path / "old.toml", tmp_path / "new.toml"
    old.write_text(text.format("a"))
    new.write_text(text.format("2*a"))
    status, found = document(capsys, str(old), str(new))
    assert status == 1
    assert [r["status"] for r in found["differences"]] == ["EQUAL", "EQUAL", "EQUAL", "DIFFERENT"]


def test_one_formula_on_two_ranges_is_not_called_equal(capsys, tmp_path: Path) -> None:
    text = '[symbols]\na = ["0", "{}"]\n[[claim]]\nid = "one"\nleft = "a + a"\nright = "2*a"\n'
    old, new = tmp_path / "old.toml", tmp_path / "new.toml"
    old.write_text(text.format("1"))
    new.write_text(text.format("2"))
    status, found = document(capsys, str(old), str(new))
    assert status == 1 and not found["equal"]
    assert found["differences"][0]["status"] == "OVERLAP" and "ranges differ: a" in found["differences"][0]["why"]


def test_what_equality_takes_for_granted_is_said(capsys) -> None:
    status, found = document(capsys, "1/(x - 1)", "(x + 1)/(x**2 - 1)")
    assert status == 0 and any("x**2 - 1" in a for a in found["differences"][0]["assumptions"])


def test_a_constant_difference_is_shown_with_its_size(capsys) -> None:
    assert run(["diff", "log(x)", "log(x) + 1"]) == 1
    assert "old - new = -1" in capsys.readouterr().out


def test_two_kinds_of_things_are_not_compared(capsys, tmp_path: Path) -> None:
    claims, model, other = tmp_path / "c.toml", tmp_path / "m.toml", tmp_path / "notes.txt"
    claims.write_text('[symbols]\na = "real"\n[[claim]]\nid = "one"\nleft = "a"\nright = "a"\n')
    model.write_text("[symbols]\n")
    other.write_text("x")
    for old, new in itertools.permutations([str(claims), str(model), str(tmp_path), "x"], 2):
        status, found = document(capsys, old, new)
        assert status == 2 and "of one kind" in found["error"]["message"], (old, new)
    status, found = document(capsys, str(other), "x")
    assert status == 2 and "another file" in found["error"]["message"]


def test_a_formula_outside_the_language_of_files_is_compared_as_text(capsys, tmp_path: Path) -> None:
    assert run(["export", "pulsating-filter", "--no-run", "--out", str(tmp_path / "a"), "--vectors", "4"]) == 0
    capsys.readouterr()
    status, found = document(capsys, str(tmp_path / "a"), str(tmp_path / "a"))
    assert status == 0 and "the same text" in {r["why"] for r in found["differences"]}
    other = tmp_path / "b"
    other.mkdir()
    text = (tmp_path / "a" / "manifest.json").read_text()
    (other / "manifest.json").write_text(text.replace("Min(e_1, e_2)", "Max(e_1, e_2)"))
    status, found = document(capsys, str(tmp_path / "a"), str(other))
    assert status == 1 and [r["status"] for r in found["differences"]].count("OPEN") == 1


@pytest.mark.parametrize(
    ("old", "new", "where"),
    [
        ("exp(log(x))", "x", ["x > 0"]),
        ("x", "exp(log(x))", ["x > 0"]),
        ("sqrt(x)**2", "x", ["x >= 0"]),
        ("0*log(x)", "0", ["x > 0"]),
        ("x**2/x", "1/(1/x)", ["x != 0"]),
    ],
)
def test_equality_lists_where_both_texts_have_a_value_as_prove_does(capsys, old: str, new: str, where: list) -> None:
    (found,) = nav.diff(old, new)
    assert found.status == "EQUAL" and list(found.assumptions) == where
    assert list(nav.prove(old, "=", new).assumptions) == where
    assert run(["diff", old, new]) == 0
    assert f"where {where[0]}" in capsys.readouterr().out


def test_the_domain_of_a_claim_in_a_file_is_listed(tmp_path: Path) -> None:
    for name, left in (("old", "exp(log(x))"), ("new", "x")):
        (tmp_path / f"{name}.toml").write_text(
            f'[symbols]\nx = "real"\n[[claim]]\nid = "a"\nleft = "{left}"\nright = "x"\n'
        )
    assert nav.diff(tmp_path / "old.toml", tmp_path / "new.toml")[0].assumptions == ("x > 0",)


def test_formulas_differ_only_where_both_have_a_value() -> None:
    (found,) = nav.diff("exp(log(x)) + x", "x")
    assert found.status == "DIFFERENT" and sp.Rational(found.worst["x"]) > 0
    assert nav.diff("abs(x)/x + 0*log(x)", "1")[0].status != "DIFFERENT"


def test_a_formula_longer_than_a_name_of_a_file_is_compared():
    long = " + ".join(f"sin({k}*a)" for k in range(1, 60))
    assert nav.diff(long, f"{long} + 0").equal
