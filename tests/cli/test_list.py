"""list filters claims without deciding them."""

from __future__ import annotations

import json

from navsym.cli.main import run


def listed(capsys, *words):
    status = run(["list", *words, "--json"])
    document = json.loads(capsys.readouterr().out)
    return document if status == 0 else (status, document["error"])


def test_filters_narrow_the_list(capsys):
    whole = listed(capsys, "--paper", "alpha_beta_filter")
    refuted = listed(capsys, "--paper", "alpha_beta_filter", "--status", "refuted")
    assert whole["count"] == len(whole["claims"]) > refuted["count"] == 1
    assert refuted["claims"][0]["id"] == "alpha_beta_filter:remark.critical"
    words = listed(capsys, "--words", "CRITICALLY DAMPED")
    assert {row["paper"] for row in words["claims"]} == {"alpha_beta_filter"}


def test_slips_of_paper_scan_and_one_of_the_two_make_up_all_slips(capsys):
    counts = [listed(capsys, "--slip", kind)["count"] for kind in ("paper", "scan", "undecidable", "any")]
    assert sum(counts[:3]) == counts[3] > 0


def test_unknown_filters_are_refused(capsys):
    for words in (("--status", "TRUE"), ("--slip", "pen"), ("--paper", "nothing")):
        status, error = listed(capsys, *words)
        assert status == 2 and error["kind"] == "domain"


def test_people_get_a_table_with_its_count(capsys):
    assert run(["list", "--paper", "alpha_beta_filter"]) == 0
    assert capsys.readouterr().out.rstrip().endswith("19 claims")
