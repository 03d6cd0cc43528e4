"""nav.export, nav.check and nav.diff: answers become code, and what cannot is refused with the reason."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path

import pytest

import navsym as nav

MODEL = Path(__file__).parents[2] / "examples" / "schuler-velocity.toml"


@pytest.fixture(scope="module")
def drift():
    return nav.solve(MODEL, "drift", T="pi/2")


def exported(folder: Path):
    spec = importlib.util.spec_from_file_location("exported_front", folder / "python" / "navsym_functions.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_an_estimator_is_a_function_of_its_measurements(drift, tmp_path):
    made = nav.export(drift, to="python", out=tmp_path / "drift")
    assert [outcome.status for outcome in made.outcomes] == ["verified"] and nav.check(made).accepted
    estimate, times, value = exported(tmp_path / "drift").drift([1.0, 2.0, 3.0])
    assert estimate == pytest.approx(sum(float(w) * z for w, z in zip(drift.weights, (1, 2, 3), strict=True)))
    assert list(times) == pytest.approx([float(point.at) for point in drift.support])
    assert value == pytest.approx(float(drift.value), rel=1e-15)


@pytest.mark.long
def test_phases_are_functions_of_the_parameter(tmp_path):
    found = nav.phases(MODEL, "drift", T=("2", "4"))
    nav.export(found, to="python", out=tmp_path)
    value, *_ = exported(tmp_path).drift(3.0)
    assert value == pytest.approx(float(found.at(T="3").value), rel=1e-14)


def test_a_derivation_is_its_transition_matrix(tmp_path):
    swing = nav.Model("x v", F=[[0, 1], ["-w**2", 0]], H=["x"], interval="T", w="positive", T="positive")
    nav.export(nav.derive(swing), to="python", out=tmp_path, run=False)
    Phi = exported(tmp_path).model_Phi(0.5, 2.0)
    assert Phi.shape == (2, 2) and Phi[0, 0] == pytest.approx(0.5403023058681398)


def test_a_forged_certificate_is_rejected(drift):
    assert nav.check(drift).accepted
    assert nav.check(dict(drift.certificate, upper="4.8"))[0].status == "REJECTED"


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: nav.export("guaranteed_velocity:4.3.u2"), "export guaranteed_velocity:4.3.u2.*, which corrects it"),
        (lambda: nav.export(1.5), "expected a claim id"),
        (lambda: nav.export("guaranteed_velocity:4.3.u2*", to="cobol"), "expected languages among"),
        (lambda: nav.export("guaranteed_velocity:4.3.u2*", real="half"), "expected double or float"),
        (lambda: nav.check("no such file"), "exists"),
        (lambda: nav.check(3), "expected a path"),
        (lambda: nav.diff(0.5, "x"), "write"),
        (lambda: nav.diff("x", "x", x=3), "expected two ends"),
        (lambda: nav.plot(3), "expected one of"),
    ],
)
def test_a_wrong_argument_is_a_navsym_error_that_says_what_to_write(call, words):
    with pytest.raises(nav.NavsymError, match=words):
        call()


def test_a_document_that_says_more_than_its_certificate_is_rejected(tmp_path):
    """A status that was edited, a list without certificates, and keys given twice, beside a certificate that holds."""
    claims = nav.prove("x**2 >= 0", x="real").document(), nav.prove("x**2 > 0", x="real").document()
    assert [claim["status"] for claim in claims] == ["PROVED", "REFUTED"]
    file = tmp_path / "document.json"

    def statuses(*rows):
        file.write_text(json.dumps({"claims": rows}))
        return [row.status for row in nav.check(file)]

    good, bad = claims
    assert statuses(good, bad) == ["ACCEPTED", "ACCEPTED"]
    assert statuses(good, {**bad, "status": "PROVED"}) == ["ACCEPTED", "REJECTED"]
    assert statuses(bad, {**good, "status": "REFUTED"}) == ["ACCEPTED", "REJECTED"]
    assert statuses(good, {**good, "certificate": bad["certificate"]}) == ["ACCEPTED", "REJECTED"]
    assert statuses(good, {**good, "certificate": {}}) == ["ACCEPTED", "REJECTED"]
    assert statuses(good, {**good, "certificate": {"kind": "all", "of": []}}) == ["ACCEPTED", "REJECTED"]
    text = json.dumps({"claims": [good]})
    file.write_text(text.replace('"statement": {', '"statement": {"left": "1",', 1))
    assert [row.status for row in nav.check(file)] == ["REJECTED"]
