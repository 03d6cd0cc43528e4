"""``nav.locate``: the document of the verb, arrays and tables, and errors that name their place."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import navsym as nav
from navsym.cli.main import run
from navsym.core.errors import NavsymError
from tests.frames import Frame

FILE = Path("examples/flight.json")


def test_the_document_is_the_one_of_the_verb(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["locate", str(FILE), "--method", "sequential", "--maps", "--offset-free", "--json"]) == 0
    found = nav.locate(FILE, "sequential", maps=True, offset_free=True)
    assert found.document() == json.loads(capsys.readouterr().out)
    assert "\n" not in repr(found) and "<table>" in found._repr_html_() and found.criterion_map.ndim == 2


def test_arrays_and_tables_go_in() -> None:
    document = json.loads(FILE.read_text())
    expected = nav.locate(document).document()
    document["map"]["heights"] = np.array(document["map"]["heights"])
    document["track"] = Frame(document["track"])
    assert nav.locate(document).document() == expected


@pytest.mark.parametrize(
    ("config", "options", "kind"),
    [
        (5, {}, "shape"),
        ({}, {}, "shape"),
        ("none.json", {}, "missing-file"),
        ({"map": 5}, {}, "shape"),
        ({"surplus": 1}, {}, "unknown-symbol"),
        (FILE, {"method": "best"}, "domain"),
        (FILE, {"method": 5}, "domain"),
    ],
)
def test_wrong_arguments_are_errors_with_kind_and_place(config, options, kind) -> None:
    with pytest.raises(NavsymError) as caught:
        nav.locate(config, **options)
    assert caught.value.kind == kind and caught.value.where
