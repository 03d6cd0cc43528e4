"""Campaigns resume, count and notice; here with few inputs, in full by ``navsym campaign``."""

from __future__ import annotations

import json

import sympy as sp

from navsym.claims import Claim, Equation
from navsym.cli.main import run
from navsym.methods import campaign_certificates, campaign_mutants, campaign_parser
from navsym.methods.campaign import Batch, run_campaign
from navsym.methods.campaign_mutants import Mutant, differs
from navsym.proof.certificates import identity_certificate
from navsym.store import opened

x = sp.Symbol("x", real=True)
LINE = {
    "kind": "gap", "variable": "t", "functional": ["0", "1"], "bits": 80, "cells": 40,
    "panels": [{"measurement": 0, "from": "0", "to": "2", "sigma": "1", "H": ["1", "t"]}],
    "dual": ["-0.999", "0.999"], "support": [[0, "0"], [0, "1"]], "lower": "0.9989", "upper": "1.0001",
}  # fmt: skip


def double_angle():
    return Equation(sp.sin(2 * x), 2 * sp.sin(x) * sp.cos(x))


def claim():
    return Claim("sample", "1", "The sine of a double angle.", double_angle)


def counted(item):
    return {"counts": {"seen": item}, "wrong": [], "open": [], "kept": []}


def test_a_second_run_takes_everything_from_the_store(tmp_path):
    batches = [Batch(f"b{k}", k) for k in range(3)]
    with opened(tmp_path / "s.sqlite") as store:
        first = run_campaign("count", batches[:2], counted, store=store)
        second = run_campaign("count", batches, counted, store=store)
    assert (first["resumed"], second["resumed"]) == (0, 2)
    assert second["counts"] == {"seen": 3} and not second["stopped"]


def test_a_batch_that_dies_is_named_and_not_counted():
    document = run_campaign("die", [Batch("b", 1)], lambda item: 1 / 0)
    assert document["counts"] == {} and "ZeroDivisionError" in document["stopped"][0]


def test_every_mutant_of_an_identity_is_refuted_or_proved():
    document = run_campaign("mutants", campaign_mutants.batches([claim()]), campaign_mutants.judge)
    assert document["counts"]["refuted"] >= 6 and not document["wrong"] and not document["open"]


def test_the_second_look_sees_a_false_proof():
    assert differs(Mutant("sample:1", sp.sin(2 * x), 2 * sp.sin(x), {}))
    assert not differs(Mutant("sample:1", sp.sin(2 * x), 2 * sp.sin(x) * sp.cos(x), {}))


def test_damaged_files_are_read_or_refused():
    document = run_campaign("parser", campaign_parser.batches(2000, 3), campaign_parser.judge)
    assert not document["wrong"] and sum(document["counts"].values()) == 2000


def test_a_reader_that_crashes_is_noticed(monkeypatch):
    monkeypatch.setitem(campaign_parser.READERS, "expression", (lambda data: data[99], b"x"))
    found = campaign_parser.judge(("expression", 5, 0))
    assert len(found["wrong"]) == 5


def test_altered_certificates_that_are_false_are_refused():
    identity = identity_certificate(sp.sin(2 * x), 2 * sp.sin(x) * sp.cos(x))
    batches = campaign_certificates.batches([identity, LINE], 200)
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
