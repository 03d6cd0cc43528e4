"""Campaigns resume, count and notice; here with few inputs, in full by ``navsym campaign``."""

from __future__ import annotations

import json
from pathlib import Path

import sympy as sp

from navsym.claims import Bound, Claim, Equation, Optimum, paper
from navsym.cli.main import run
from navsym.core.sandbox import run_limited
from navsym.core.store import open_store
from navsym.prove.certificates import identity_certificate
from tests.attacks.campaigns import certificates as campaign_certificates
from tests.attacks.campaigns import mutants as campaign_mutants
from tests.attacks.campaigns import parser as campaign_parser
from tests.attacks.campaigns.batches import Batch, run_campaign
from tests.attacks.campaigns.changes import changes
from tests.attacks.campaigns.edited_values import values_at
from tests.attacks.campaigns.edits import KINDS, apply_edit, list_edits
from tests.attacks.campaigns.mutants import is_denied

x, y = sp.symbols("x y", real=True)
LINE = {
    "kind": "gap",
    "variable": "t",
    "functional": ["0", "1"],
    "bits": 80,
    "cells": 40,
    "panels": [{"measurement": 0, "from": "0", "to": "2", "sigma": "1", "H": ["1", "t"]}],
    "dual": ["-0.999", "0.999"],
    "support": [[0, "0"], [0, "1"]],
    "lower": "0.9989",
    "upper": "1.0001",
    "parameter": "p",
    "from": "0",
    "to": "0",
}


def double_angle():
    return Equation(sp.sin(2 * x), 2 * sp.sin(x) * sp.cos(x))


def claim():
    return Claim("sample", "1", "The sine of a double angle.", double_angle)


def counted(item):
    return {"counts": {"seen": item}, "wrong": [], "open": [], "kept": []}


def counted_by_a_child(item):
    return counted(run_limited(abs, (item,)))


def test_a_judge_may_run_what_might_not_end_in_a_child_of_its_own():
    found = run_campaign("children", [Batch("b", 3)], counted_by_a_child)
    assert found["counts"] == {"seen": 3} and not found["stopped"]


def test_a_second_run_takes_everything_from_the_store(tmp_path):
    batches = [Batch(f"b{k}", k) for k in range(3)]
    with open_store(tmp_path / "s.sqlite") as store:
        first = run_campaign("count", batches[:2], counted, store=store)
        second = run_campaign("count", batches, counted, store=store)
    assert (first["resumed"], second["resumed"]) == (0, 2)
    assert second["counts"] == {"seen": 3} and not second["stopped"]


def test_a_batch_that_dies_is_named_and_not_counted():
    document = run_campaign("die", [Batch("b", 1)], lambda item: 1 / 0)
    assert document["counts"] == {} and "ZeroDivisionError" in document["stopped"][0]


def test_every_mutant_of_an_identity_is_refuted_or_proved():
    document = run_campaign("mutants", campaign_mutants.make_batches([claim()]), campaign_mutants.judge)
    assert document["counts"]["refuted"] >= 6 and not document["wrong"] and not document["open"]


def test_every_kind_of_change_is_made():
    matrix = sp.Matrix([[x, sp.sin(y) ** 2], [2 * x + y, 1]])
    kinds = {change.kind for change in changes(Equation(matrix, matrix, {x: (0, 1)}))}
    assert kinds == set(KINDS)


def test_a_mutant_has_the_value_of_the_formula_that_sympy_builds():
    formula = (2 * x + y**3) ** 2 / sp.exp(x * y) - sp.sqrt(3 * x + y) * sp.atan2(x, y)
    values = values_at({x: sp.Rational(1, 3), y: sp.Rational(5, 7)})
    for edit in list_edits(formula):
        direct = values_at({x: sp.Rational(1, 3), y: sp.Rational(5, 7)}).of(apply_edit(formula, edit))
        assert values.evaluate_edited(formula, edit).overlaps(direct), edit


def test_mutants_of_inequalities_numerals_and_optima_fall():
    t, end = sp.Symbol("t", real=True), sp.Symbol("T", positive=True)
    box = {end: (sp.Integer(1), sp.Integer(2))}
    zero, one = sp.Integer(0), sp.Integer(1)
    slope = ((one, t), (zero, one), t, (zero, end), (-one, 2 / end), (zero, end), (-1 / end, 1 / end), 2 / end, box)
    statements = {
        "bound": Bound(sp.sin(end), ">", sp.Rational(1, 2), box),
        "numeral": Equation(sp.Rational("3.14"), sp.pi, tolerance=sp.Rational("0.005")),
        "optimum": Optimum(*slope),
    }
    for name, statement in statements.items():
        found = campaign_mutants.judge((Claim("sample", "1", name, lambda s=statement: s), 1.0, 0))
        assert found["counts"]["refuted"] >= 4 and not found["wrong"], name
        stored = found["kept"][0]
        assert all(place is None or str(place) in stored["points"] for place in stored["at"])


def test_the_second_look_sees_a_false_proof():
    assert is_denied(Equation(sp.sin(2 * x), 2 * sp.sin(x)))
    assert not is_denied(Equation(sp.sin(2 * x), 2 * sp.sin(x) * sp.cos(x)))
    assert is_denied(Bound(x, "<", 2 * x))


def test_damaged_files_are_read_or_refused():
    document = run_campaign("parser", campaign_parser.make_batches(2000, 3), campaign_parser.judge)
    assert not document["wrong"] and sum(document["counts"].values()) > 2000


def test_a_reader_that_crashes_is_noticed(monkeypatch):
    monkeypatch.setitem(campaign_parser.READERS, "expression", (lambda data: data[99], b"x"))
    found = campaign_parser.judge(("expression", 5, 0))
    assert len(found["wrong"]) == 5


def test_altered_certificates_that_are_false_are_refused():
    identity = identity_certificate(sp.sin(2 * x), 2 * sp.sin(x) * sp.cos(x))
    batches = campaign_certificates.make_batches([identity, LINE], 200)
    document = run_campaign("certificates", batches, campaign_certificates.judge)
    assert document["counts"]["refused"] > 100 and not document["wrong"]


def test_a_checker_that_accepts_everything_is_noticed(monkeypatch):
    monkeypatch.setattr(campaign_certificates, "check", lambda item: "fine")
    identity = identity_certificate(sp.sin(2 * x), 2 * sp.sin(x) * sp.cos(x))
    assert campaign_certificates.judge((identity, 20, 0))["wrong"]


def test_the_verb_prints_one_document(monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("NAVSYM_CACHE", str(tmp_path))
    assert run(["campaign", "parser", "--inputs", "50", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["campaign"] == "parser"


def test_outside_a_checkout_the_verb_says_what_is_missing_and_how_to_get_it(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(paper, "papers_folder", lambda: tmp_path / "navsym_papers")
    monkeypatch.chdir(tmp_path)
    assert run(["campaign", "parser", "--json"]) == 3
    error = json.loads(capsys.readouterr().out)["error"]
    assert error["kind"] == "missing" and "clone the repository" in error["message"]


def test_the_current_folder_may_be_the_checkout(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(paper, "papers_folder", lambda: tmp_path / "navsym_papers")
    monkeypatch.setenv("NAVSYM_CACHE", str(tmp_path))
    monkeypatch.chdir(Path(__file__).parents[2])
    assert run(["campaign", "certificates", "--inputs", "7", "--fresh", "--json"]) == 0
    assert sum(json.loads(capsys.readouterr().out)["counts"].values()) == 7
