"""``nav.track``, ``nav.condition`` and ``nav.limits``: the documents of the verbs, columns and arrays, and errors."""

from __future__ import annotations

import json
from fractions import Fraction

import numpy as np
import pytest

import navsym as nav
from navsym.cli.main import run
from navsym.core.errors import NavsymError
from tests.frames import Frame

DRIVE = "examples/drive.csv"


def printed(capsys: pytest.CaptureFixture[str], *words: str) -> dict:
    assert run([*words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_the_documents_are_those_of_the_verbs(capsys: pytest.CaptureFixture[str]) -> None:
    assert nav.track(DRIVE, order=2).document() == printed(capsys, "track", DRIVE, "--order", "2")
    assert nav.condition(5, tau="1/3").document() == printed(capsys, "condition", "--n", "5", "--tau", "1/3")
    words = ("limits", "--noise", "5", "--jerk", "0.5", "--step", "1")
    assert nav.limits(5, jerk=0.5, step=1).document() == printed(capsys, *words)


def test_columns_and_arrays_are_the_track_of_the_file() -> None:
    rows = np.genfromtxt(DRIVE, delimiter=",", skip_header=1)
    columns = dict(zip(("t", "lat", "lon", "height"), rows.T.tolist(), strict=True))
    expected = nav.track(DRIVE, order=2)
    for data in (Frame(columns), columns, rows, rows.tolist()):
        np.testing.assert_array_equal(nav.track(data, order=2).velocity, expected.velocity)


def test_bad_rows_of_columns_are_repaired_on_request() -> None:
    rows = [(k, 45 + 1e-4 * k, 10.0, 100.0) for k in range(20)]
    rows[7] = (7, 99.0, 10.0, 100.0)
    with pytest.raises(NavsymError, match="latitude") as caught:
        nav.track(rows)
    assert "line 8" in caught.value.where
    assert len(nav.track(rows, policy="repair").repairs) == 1


def test_condition_numbers_are_certified_numbers() -> None:
    found = nav.condition(20, tau=Fraction(1, 5))
    assert isinstance(found.N_f.value, nav.Number) and found.N_f.value.digits >= 28 and not found.N_f.trustworthy
    assert [part.name for part in found] == ["N_p", "N_pN", "N_f", "N_s"]


def test_answers_show_themselves_in_one_line() -> None:
    for answer in (nav.track(DRIVE, order=2), nav.condition(3), nav.limits(1, acceleration=1)):
        assert "\n" not in repr(answer) and "<table>" in answer._repr_html_()


@pytest.mark.parametrize(
    ("call", "kind"),
    [
        (lambda: nav.track(5), "shape"),
        (lambda: nav.track("none.csv"), "missing-file"),
        (lambda: nav.track({"t": [1]}), "shape"),
        (lambda: nav.track([[1, 2, 3]]), "shape"),
        (lambda: nav.track(DRIVE, order="3"), "domain"),
        (lambda: nav.track(DRIVE, window=9, method="filter"), "domain"),
        (lambda: nav.track(DRIVE, sigma="1"), "domain"),
        (lambda: nav.track(DRIVE, method="magic"), "domain"),
        (lambda: nav.condition("5"), "domain"),
        (lambda: nav.condition(5, tau=0.2), "domain"),
        (lambda: nav.condition(5, rho=[1]), "syntax"),
        (lambda: nav.condition(5, rho="x"), "syntax"),
        (lambda: nav.condition(5, digits=1.5), "domain"),
        (lambda: nav.condition(500), "too-large"),
        (lambda: nav.limits("5", jerk=1), "domain"),
        (lambda: nav.limits(5), "domain"),
        (lambda: nav.limits(5, jerk=1, step="1"), "domain"),
    ],
)
def test_wrong_arguments_are_errors_with_kind_and_place(call, kind) -> None:
    with pytest.raises(NavsymError) as caught:
        call()
    assert caught.value.kind == kind and caught.value.where
