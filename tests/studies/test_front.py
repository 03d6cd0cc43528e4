"""``nav.sweep``, ``nav.simulate`` and ``nav.data``: the documents of the verbs, and errors that name their place."""

from __future__ import annotations

import json

import pytest

import navsym as nav
from navsym.cli.main import run
from navsym.core.errors import NavsymError

STUDY = {"kind": "filter", "jobs": 2, "runs": 3, "steps": 4}


def printed(capsys: pytest.CaptureFixture[str], *words: str) -> dict:
    assert run([*words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_the_documents_are_those_of_the_verbs(capsys: pytest.CaptureFixture[str], tmp_path) -> None:
    (tmp_path / "study.json").write_text(json.dumps(STUDY))
    found = nav.sweep(STUDY, out=tmp_path / "s", fresh=True)
    words = ("sweep", str(tmp_path / "study.json"), "--workers", "0", "--out", str(tmp_path / "s"), "--fresh")
    assert found.document() == printed(capsys, *words)
    assert found.done == 2 and len(found.rmse) == 3 and "\n" not in repr(found) and "<table>" in found._repr_html_()
    assert nav.data().document() == printed(capsys, "data") and "\n" not in repr(nav.data())


def test_an_experiment_has_figures_and_a_table() -> None:
    found = nav.simulate("multistructure", runs=2, steps=2, seed=3)
    heads, rows = found.table()
    assert found.document()["seed"] == 3 and len(heads) == len(rows[0]) and "\n" not in repr(found)


@pytest.mark.parametrize(
    ("call", "kind"),
    [
        (lambda: nav.sweep(5), "domain"),
        (lambda: nav.sweep({"kind": "filter"}), "domain"),
        (lambda: nav.sweep("none.json"), "missing-file"),
        (lambda: nav.sweep(STUDY, workers="2"), "domain"),
        (lambda: nav.sweep(STUDY, size=0), "domain"),
        (lambda: nav.sweep(STUDY, out=5), "domain"),
        (lambda: nav.simulate("nothing"), "domain"),
        (lambda: nav.simulate(5), "domain"),
        (lambda: nav.simulate("trajectory", seed=-1), "domain"),
        (lambda: nav.simulate("trajectory", steps=3), "domain"),
        (lambda: nav.simulate("trajectory", runs="2"), "domain"),
        (lambda: nav.data("nothing"), "domain"),
        (lambda: nav.data(5), "domain"),
    ],
)
def test_wrong_arguments_are_errors_with_kind_and_place(call, kind) -> None:
    with pytest.raises(NavsymError) as caught:
        call()
    assert caught.value.kind == kind and caught.value.where
