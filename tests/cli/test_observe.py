"""The verb ``observe``: keys, exact answers, bad input."""

from __future__ import annotations

import json

import pytest
import sympy as sp

from navsym.cli.main import run

GOOD = """
[model]
name   = "link"
states = ["x1", "x2", "x3", "x4", "x5", "x6"]
F = [["0","1","0","0","0","0"], ["-1","0","0","0","0","0"], ["0","0","0","0","0","0"],
     ["0","0","0","0","1","0"], ["0","0","0","-1","0","0"], ["0","0","0","0","0","0"]]
[parameters]
kappa = "real"
[[measurement]]
name  = "velocity"
h     = ["0", "1", "1", "kappa", "0", "0"]
sigma = "1"
[[measurement]]
name  = "second"
h     = ["-kappa", "0", "0", "0", "1", "1"]
sigma = "1"
"""

HIDDEN = """
[model]
name   = "hidden"
states = ["a", "b"]
F = [["0", "0"], ["0", "w"]]
[parameters]
w = "nonzero"
[[measurement]]
name  = "one"
h     = ["1", "0"]
sigma = "1"
"""


def with_second_row(row: str) -> str:
    """The good file with another row h for its second measurement."""
    return GOOD.replace('"-kappa", "0", "0", "0", "1", "1"', row)


@pytest.fixture
def observe(tmp_path, capsys):
    def call(text: str, *options: str):
        path = tmp_path / "model.toml"
        path.write_text(text)
        status = run(["observe", str(path), *options])
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return call


def test_the_document_has_the_promised_keys_and_exact_values(observe):
    status, out, _ = observe(GOOD, "--json", "--poles", "(p+lam)**3; (p+lam)**3")
    data = json.loads(out)
    assert status == 0
    assert data["n"] == 6 and data["observable"] is True and data["joint_dimension"] == 6
    assert [m["name"] for m in data["measurements"]] == ["velocity", "second"]
    assert data["measurements"][0]["dimension"] == 3
    assert data["measurements"][0]["basis"][0] == ["0", "1", "1", "kappa", "0", "0"]
    assert data["measurements"][0]["companion"] == ["0", "-1", "0"]
    assert data["unobservable_basis"] == []
    drops = {(d["subspace"], d["condition"], d["complete"]) for d in data["rank_drops"]}
    assert drops == {("joint", "kappa + 1 = 0", True), ("joint", "kappa - 1 = 0", True)}
    assert [(s["i"], s["j"]) for s in data["splits"]] == [(3, 3)]
    kappa = sp.Symbol("kappa")
    assert sp.expand(sp.sympify(data["split"]["det_L"], {"kappa": kappa}) - (kappa**2 - 1) ** 2) == 0
    assert data["split"]["Theta"] == [["0", "1", "0"], ["0", "0", "1"], ["0", "-1", "0"]]
    assert data["split"]["Phi_x"] == [["0"] * 3] * 3
    assert data["gains"]["K_x"] == data["gains"]["K_z"] == ["3*lam", "3*lam**2 - 1", "lam**3 - 3*lam"]


def test_without_options_gains_are_empty_and_the_split_is_the_two_stage_one(observe):
    data = json.loads(observe(GOOD, "--json")[1])
    assert data["gains"]["K_x"] == [] and data["gains"]["K_z"] == []
    assert (data["split"]["i"], data["split"]["j"]) == (3, 3)


def test_people_get_tables(observe):
    status, out, _ = observe(GOOD)
    assert status == 0
    assert "observable" in out and "kappa - 1 = 0" in out and "det L" in out


def test_an_unobservable_pair_is_described(observe):
    status, out, _ = observe(HIDDEN, "--json")
    data = json.loads(out)
    assert status == 0
    assert data["observable"] is False and data["joint_dimension"] == 1
    assert data["unobservable_basis"] == [["0", "1"]]
    assert data["unobservable_directions"] == ["b"]
    assert data["splits"] == [] and data["split"] is None


@pytest.mark.parametrize(
    ("text", "options", "kind", "words"),
    [
        (HIDDEN, ["--poles", "p+1"], "unobservable", "direction b"),
        (HIDDEN, ["--split", "1,1"], "unobservable", "direction b"),
        (GOOD, ["--split", "4,2"], "domain", "det(a1, a2, a3, a4, b1, b2) = 0"),
        (GOOD, ["--split", "4,4"], "shape", "i + j = 6"),
        (GOOD, ["--split", "x"], "syntax", "two numbers"),
        (GOOD, ["--poles", "(p+lam)**2; (p+lam)**3"], "shape", "degree 3"),
        (GOOD, ["--poles", "(p-lam)**3; (p+lam)**3"], "domain", "left half-plane"),
        (GOOD, ["--poles", "(p+1)**3; p**3"], "domain", "left half-plane"),
        (GOOD, ["--poles", "(p+x1)**3; (p+1)**3"], "duplicate", "x1"),
        (GOOD.replace("kappa", "p"), ["--poles", "(p+1)**3; (p+1)**3"], "duplicate", "p to be free"),
        (GOOD, ["--poles", "__import__('os'); p"], "syntax", ""),
        (with_second_row('"0", "0", "0", "0", "0", "0"'), [], "domain", "not zero"),
        (GOOD.replace('["0","1","0","0","0","0"], ', '["0","1","0","0","0"], '), [], "shape", ""),
        (GOOD.replace('"-1","0","0"', '"-log(kappa)","0","0"'), [], "domain", "rational function"),
        (GOOD.replace('"-1","0","0"', '"-sin(1/(1+kappa))","0","0"'), [], "domain", "angles and exponents"),
        (GOOD.replace('"-1","0","0"', '"-t","0","0"'), ["--split", "3,3"], "domain", "constant"),
        (GOOD.replace('"-1","0","0"', '"-t","0","0"'), ["--poles", "p + 1"], "domain", "constant"),
    ],
)
def test_bad_input_ends_with_status_two_and_one_clear_error(observe, text, options, kind, words):
    status, out, _ = observe(text, "--json", *options)
    error = json.loads(out)["error"]
    assert status == 2
    assert error["kind"] == kind
    assert words in error["message"]


def test_a_basis_file_has_no_system_to_observe(observe):
    basis = '[basis]\nvariable = "s"\nH = ["1", "s"]\ninterval = ["0", "1"]\n[targets]\nc = ["0", "1"]\n'
    status, out, _ = observe(basis, "--json")
    assert status == 2
    assert json.loads(out)["error"]["kind"] == "domain"


def test_a_value_can_be_put_in_and_meets_the_rank_drop(observe):
    data = json.loads(observe(GOOD, "--json", "--set", "kappa=1")[1])
    assert data["observable"] is False
    assert data["joint_dimension"] < 6


def test_pages_hold_the_decomposition_and_no_markup_of_the_file(observe, tmp_path):
    nasty = GOOD.replace('name   = "link"', 'name   = "<script>alert(1)</script>"')
    html, latex = tmp_path / "page.html", tmp_path / "page.tex"
    status, _, _ = observe(nasty, "--html", str(html), "--latex", str(latex))
    assert status == 0
    assert "<script>" not in html.read_text() and "<math" in html.read_text()
    assert r"\Theta" in latex.read_text()


def test_sines_and_cosines_of_a_latitude_are_answered_exactly(tmp_path, capsys):
    path = tmp_path / "latitude.toml"
    path.write_text(GOOD.replace('"-1","0","0"', '"-cos(kappa)**2","0","sin(kappa)"'))
    assert run(["observe", str(path), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["rank_drops_complete"] == {"velocity": True, "second": True, "joint": True}
    assert "sin(kappa)" in json.dumps(data["measurements"])


def test_a_condition_of_two_equations_is_one_polynomial(tmp_path, capsys):
    path = tmp_path / "both.toml"
    path.write_text(
        """
[model]
name   = "both"
states = ["x", "y", "z"]
F = [["0", "1", "0"], ["0", "0", "a"], ["0", "0", "0"]]
[parameters]
a = "real"
b = "real"
[[measurement]]
name = "one"
h    = ["1", "0", "0"]
[[measurement]]
name = "two"
h    = ["0", "0", "b"]
"""
    )
    assert run(["observe", str(path), "--json"]) == 0
    joint = [d for d in json.loads(capsys.readouterr().out)["rank_drops"] if d["subspace"] == "joint"]
    assert len(joint) == 1 and set(joint[0]["zeros"]) == {"a", "b"}
    left, right = joint[0]["condition"].split("=")
    assert sp.expand(sp.sympify(left) - sp.sympify("a**2 + b**2")) == 0 and right.strip() == "0"


# Further measurements

UNSEEN = """
[model]
name   = "drifts"
states = ["x", "v", "b", "c"]
F      = [["0","1","0","0"], ["0","0","g","0"], ["0","0","0","0"], ["0","0","0","0"]]
[parameters]
g = "positive"
[[measurement]]
name = "log"
h = ["0", "1", "0", "1"]
sigma = "1"
"""


def test_the_position_alone_restores_what_a_biased_log_hides(observe):
    status, out, _ = observe(UNSEEN, "--restore", "--json")
    found = json.loads(out)["restore"]
    assert status == 0 and found["hidden"] == 2 and found["needed"] == found["fewest"] == 1
    assert found["sets"] == [["x"]] and found["proved"]


def test_candidates_are_formulas_of_the_states(observe):
    options = ("--candidate", "gps = x + g*c", "--candidate", "second = 2*(v + c)")
    _, out, _ = observe(UNSEEN, "--restore", *options, "--json")
    found = json.loads(out)["restore"]
    assert found["candidates"] == ["gps", "second"] and found["sets"] == [["gps"]]
    _, out, _ = observe(UNSEEN, *options[2:])  # the option alone asks the question as well
    assert "not enough, all together: second (proved)" in out


def test_an_observable_model_needs_nothing_more(observe):
    _, out, _ = observe(GOOD, "--restore")
    assert "no further measurement is needed" in out


def test_without_the_question_the_document_has_its_old_keys(observe):
    _, out, _ = observe(UNSEEN, "--json")
    assert "restore" not in json.loads(out)


@pytest.mark.parametrize(
    "candidate, kind",
    [
        ("x", "syntax"),
        ("= x", "syntax"),
        ("a =", "empty"),
        ("a = x + 1", "domain"),
        ("a = x*v", "domain"),
        ("a = x - x", "domain"),
        ("a = abs(x)", "domain"),
        ("a = x + q", "unknown-symbol"),
        ("a = __import__('os')", "syntax"),
    ],
)
def test_a_candidate_that_is_no_sum_of_states_is_refused(observe, candidate, kind):
    status, out, _ = observe(UNSEEN, "--candidate", candidate, "--json")
    assert status == 2 and json.loads(out)["error"]["kind"] == kind


def test_a_candidate_named_twice_is_refused(observe):
    status, out, _ = observe(UNSEEN, "--candidate", "a = x", "--candidate", "a = v", "--json")
    assert status == 2 and json.loads(out)["error"]["kind"] == "duplicate"
