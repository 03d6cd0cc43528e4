"""``nav.filter`` and ``nav.Bank``: the document of the verb, what goes in, and errors that name their place."""

from __future__ import annotations

import json

import numpy as np
import pytest

import navsym as nav
from navsym.cli.main import run
from navsym.core.errors import NavsymError
from tests.frames import Frame

FILE = "examples/switching.json"
MODEL = {"F": [[1]], "Q": [[0.1]], "H": [[1]], "R": [[1]]}
START = {"mean": [0], "covariance": [[1]], "probabilities": [0.5, 0.5]}
SWITCH = [[0.9, 0.1], [0.2, 0.8]]


def small_bank() -> nav.Bank:
    return nav.Bank([MODEL, {**MODEL, "R": [[100]]}], SWITCH, START)


def test_the_document_is_the_one_of_the_verb(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["filter", FILE, "--method", "imm", "--json"]) == 0
    assert nav.filter(FILE, method="imm").document() == json.loads(capsys.readouterr().out)


def test_a_bank_a_document_and_any_table_of_measurements_go_in() -> None:
    rows = [[0.1], [30.0], [1.0]]
    document = {"models": [MODEL, {**MODEL, "R": [[100]]}], "mode_transition": SWITCH, "initial": START}
    expected = nav.filter({**document, "measurements": rows}).document()
    for z in (rows, np.array(rows), np.array(rows)[:, 0], Frame({0: [0.1, 30.0, 1.0]})):
        assert nav.filter(small_bank(), z).document() == expected == nav.filter(document, z).document()


def test_an_answer_shows_itself_in_one_line_and_says_which_engine_ran() -> None:
    found = nav.filter(FILE, engine="compiled")
    assert found.engine == "compiled" and "\n" not in repr(found) and "<table>" in found._repr_html_()
    assert found.modes.shape == found.log_likelihood.shape and found.standard_deviations.shape == found.mean.shape


def test_a_gap_of_time_stamps_is_steps_without_measurements() -> None:
    """Times 10, 10.5, 12 of a bank of half seconds are steps 1, 2 and 5; a twin without the gap is another filter."""
    document = {"models": [MODEL, {**MODEL, "R": [[100]]}], "mode_transition": SWITCH, "initial": START}
    stamped = nav.filter({**document, "measurements": [[0.1], [3.0], [1.0]], "times": [10, 10.5, 12], "step": 0.5})
    filled = nav.filter({**document, "measurements": [[0.1], [3.0], None, None, [1.0]], "missing": True})
    for name in ("mean", "covariance", "probabilities", "log_likelihood"):
        np.testing.assert_array_equal(getattr(stamped, name), getattr(filled, name)[[0, 1, 4]])
    said = stamped.document()
    assert said["times"] == [10, 10.5, 12] and said["remarks"] == ["gap after time 10.5: 2 steps without a measurement"]
    closed = nav.filter({**document, "measurements": [[0.1], [3.0], [1.0]]})
    assert abs(closed.covariance[2] - stamped.covariance[2]).max() > 1e-3


def test_modes_that_one_step_cannot_tell_apart_are_remarked() -> None:
    """A jump of the speed shows in the position one step later; a method that has merged the modes by then is blind."""
    quiet = {"F": [[1, 1], [0, 1]], "Q": [[0.01, 0], [0, 0.01]], "H": [[1, 0]], "R": [[1]]}
    start = {"mean": [0, 0], "covariance": [[4, 0], [0, 4]], "probabilities": [0.9, 0.1]}
    document = {"models": [quiet, {**quiet, "Q": [[0.01, 0], [0, 4]]}], "mode_transition": SWITCH, "initial": start}
    rows = [[0.3], [1.2], [0.4], [5.0], [11.0], [17.5]]
    blind, seeing = (nav.filter({**document, "measurements": rows}, method=word) for word in ("pulsating", "gpb2"))
    assert "mode probabilities are those of the chain" in blind.remarks[0] and not blind.modes.any()
    assert not seeing.remarks and seeing.modes[4] == 1
    assert not nav.filter({**document, "measurements": [None] * 4, "missing": True}).remarks


@pytest.mark.parametrize(
    ("extra", "kind", "words"),
    [
        ({"times": [1, 2, 2]}, "domain", "increasing"),
        ({"times": [1, 2, 3.3]}, "domain", "whole number of steps"),
        ({"times": [1, 2]}, "shape", "one for each row"),
        ({"step": 1}, "shape", "times beside it"),
        ({"times": [1, 2, 3], "step": 0}, "domain", "positive number"),
        ({"times": [0, 1, 1e9]}, "too-large", "at most"),
    ],
)
def test_time_stamps_that_make_no_steps_are_refused(extra, kind, words) -> None:
    document = {"models": [MODEL], "mode_transition": [[1]], "initial": {**START, "probabilities": [1]}}
    with pytest.raises(NavsymError, match=words) as caught:
        nav.filter({**document, "measurements": [[0.1], [3.0], [1.0]], **extra})
    assert caught.value.kind == kind


def test_data_that_contradict_every_mode_are_one_sentence_in_the_document() -> None:
    document = {"models": [MODEL], "mode_transition": [[1]], "initial": {**START, "probabilities": [1]}}
    wild = nav.filter({**document, "measurements": [[(-1) ** k * 1e3] for k in range(12)]}).document()
    calm = nav.filter({**document, "measurements": [[0.1]] * 12}).document()
    assert calm["remarks"] == [] and len(wild["remarks"]) == 1
    assert "contradict every mode at 12 steps" in wild["remarks"][0]


@pytest.mark.parametrize(
    ("arguments", "options", "kind"),
    [
        ((5,), {}, "shape"),
        (({},), {}, "shape"),
        (("missing.json",), {}, "missing-file"),
        ((small_bank(),), {}, "shape"),
        ((small_bank(), 5), {}, "shape"),
        ((small_bank(), "12"), {}, "shape"),
        ((small_bank(), {"a": 1}), {}, "shape"),
        ((small_bank(), [[[1.0]]]), {}, "shape"),
        ((small_bank(), [[None]]), {}, "not-finite"),
        ((small_bank(), [[1.0]]), {"method": ["imm"]}, "domain"),
        ((small_bank(), [[1.0]]), {"method": "kalman"}, "domain"),
        ((small_bank(), [[1.0]]), {"form": 3}, "domain"),
        ((small_bank(), [[1.0]]), {"engine": {}}, "domain"),
        ((small_bank(), [[1.0]]), {"depth": 2}, "domain"),
        ((small_bank(), [[1.0]]), {"missing": "yes"}, "domain"),
    ],
)
def test_wrong_arguments_are_errors_with_kind_and_place(arguments, options, kind) -> None:
    with pytest.raises(NavsymError) as caught:
        nav.filter(*arguments, **options)
    assert caught.value.kind == kind and caught.value.where


@pytest.mark.parametrize(
    "parts",
    [
        (5, SWITCH, START),
        ([], SWITCH, START),
        ([MODEL] * 2, SWITCH, None),
        ([5, 6], SWITCH, START),
        ("FQ", SWITCH, START),
    ],
)
def test_a_bank_of_anything_else_is_refused(parts) -> None:
    with pytest.raises(NavsymError, match="expected"):
        nav.Bank(*parts)
