"""`navsym filter` and `navsym simulate`: the document, the memoryless form, and bad input."""

from __future__ import annotations

import json

import numpy as np
import pytest

from navsym.claims.paper import experiment_names
from navsym.cli import main

UNIT = [[1.0]]


def bank_file(tmp_path, **changes):
    given = {
        "models": [{"F": UNIT, "Q": [[0.0]], "H": UNIT, "R": UNIT}, {"F": UNIT, "Q": [[25.0]], "H": UNIT, "R": UNIT}],
        "mode_transition": [[0.9, 0.1], [0.2, 0.8]],
        "initial": {"mean": [0.0], "covariance": UNIT, "probabilities": [0.75, 0.25]},
        "measurements": [[2.0], [3.0], [0.0]],
    }
    given.update(changes)
    path = tmp_path / "bank.json"
    path.write_text(json.dumps(given))
    return str(path)


def answer(capsys, *arguments):
    status = main.run(["filter", *arguments, "--json"])
    captured = capsys.readouterr()
    return status, json.loads(captured.out), captured.err


@pytest.mark.parametrize(
    ("options", "filters"),
    [
        ((), 6),
        (("--method", "k-pulsating", "--depth", "3"), 14),
        (("--method", "polygaussian"), 6),
        (("--method", "imm"), 6),
        (("--method", "gpb2"), 10),
        (("--method", "exact"), 14),
    ],
)
def test_every_method_writes_the_keys_of_the_interface(tmp_path, capsys, options, filters):
    status, document, _ = answer(capsys, bank_file(tmp_path), *options)
    assert status == 0
    assert list(document) == ["probabilities", "mean", "covariance", "log_likelihood", "filters_run", "remarks"]
    assert np.shape(document["probabilities"]) == (3, 2)
    assert np.shape(document["mean"]) == (3, 1)
    assert np.shape(document["covariance"]) == (3, 1, 1)
    assert document["filters_run"] == filters


def test_the_first_step_by_hand(tmp_path, capsys):
    _, document, _ = answer(capsys, bank_file(tmp_path))
    prior = np.array([0.75 * 0.9 + 0.25 * 0.2, 0.75 * 0.1 + 0.25 * 0.8])
    spread = np.array([2.0, 27.0])
    weights = prior * np.exp(-2.0 / spread * 1.0) / np.sqrt(2 * np.pi * spread)
    assert document["log_likelihood"][0] == pytest.approx(np.log(weights.sum()), rel=1e-12)
    weights /= weights.sum()
    assert document["probabilities"][0] == pytest.approx(weights, rel=1e-12)
    assert document["mean"][0][0] == pytest.approx(weights @ (2.0 * (1.0 - 1.0 / spread)), rel=1e-12)


def test_memoryless_uses_the_unconditional_chain(tmp_path, capsys):
    switch = np.array([[0.9, 0.1], [0.2, 0.8]])
    _, printed, _ = answer(capsys, bank_file(tmp_path, memoryless=True))
    stack = []
    row = np.array([0.75, 0.25])
    for _ in range(3):
        row = row @ switch
        stack.append([row.tolist()] * 2)
    _, spelled_out, _ = answer(capsys, bank_file(tmp_path, mode_transition=stack))
    assert printed["probabilities"] == pytest.approx(np.array(spelled_out["probabilities"]), rel=1e-12)
    _, markov, _ = answer(capsys, bank_file(tmp_path))
    assert printed["probabilities"][1] != pytest.approx(markov["probabilities"][1], rel=1e-6)


def test_models_over_time_are_lists(tmp_path, capsys):
    over_time = {"F": [UNIT, UNIT, [[2.0]]], "Q": [UNIT] * 3, "H": UNIT, "R": UNIT}
    given = bank_file(
        tmp_path,
        models=[over_time],
        mode_transition=UNIT,
        initial={"mean": [0.0], "covariance": UNIT, "probabilities": [1.0]},
    )
    status, document, _ = answer(capsys, given)
    assert status == 0
    mean, P = 0.0, 1.0
    for F, z in ((1.0, 2.0), (1.0, 3.0), (2.0, 0.0)):
        mean, P = F * mean, F * P * F + 1.0
        mean, P = mean + P / (P + 1.0) * (z - mean), P / (P + 1.0)
    assert document["mean"][-1][0] == pytest.approx(mean, rel=1e-12)


def test_null_is_missing_on_request_and_an_error_otherwise(tmp_path, capsys):
    path = bank_file(tmp_path, measurements=[[2.0], [None]])
    status, document, _ = answer(capsys, path)
    assert status == 2
    assert document["error"]["kind"] == "not-finite"
    assert "measurements[1]" in document["error"]["message"]
    assert answer(capsys, path, "--missing")[0] == 0
    assert answer(capsys, bank_file(tmp_path, measurements=[[2.0], [None]], missing=True))[0] == 0


def test_an_impossible_measurement_is_remarked_on_standard_error(tmp_path, capsys):
    status, document, remarks = answer(capsys, bank_file(tmp_path, measurements=[[1e6], [0.0]]))
    assert status == 0
    assert "step 1" in remarks
    assert np.isfinite(document["mean"]).all()


def model(**changes):
    return {"models": [{"F": UNIT, "Q": [[0.0]], "H": UNIT, "R": UNIT, **changes}] * 2}


def start(**changes):
    return {"initial": {"mean": [0.0], "covariance": UNIT, "probabilities": [0.75, 0.25], **changes}}


INDEFINITE = {
    "models": [{"F": np.eye(2).tolist(), "Q": [[1, 2], [2, 1]], "H": [[1, 0]], "R": UNIT}],
    "mode_transition": [[1.0]],
    **start(mean=[0, 0], covariance=np.eye(2).tolist(), probabilities=[1.0]),
}


@pytest.mark.parametrize(
    ("changes", "options", "kind", "words"),
    [
        ({"mode_transition": [[0.9, 0.2], [0.2, 0.8]]}, (), "domain", "row 0 sums to 1.1"),
        ({"mode_transition": [[1.2, -0.2], [0.2, 0.8]]}, (), "domain", "negative"),
        ({"mode_transition": [[1.0]]}, (), "shape", "mode_transition"),
        ({"mode_transition": []}, (), None, "mode_transition"),
        (model(Q=[[-1.0]]), (), "domain", "models[0].Q"),
        (model(R=[[-1.0]]), (), "domain", "models[0].R"),
        (INDEFINITE, (), "domain", "models[0].Q"),
        (start(covariance=[[-1.0]]), (), "domain", "initial.covariance"),
        (start(probabilities=[0.0, 0.0]), (), "domain", "sums to 0"),
        (start(probabilities=[0.5, 0.25, 0.25]), (), "shape", "initial.probabilities"),
        (start(mean=[0.0, 1.0]), (), "shape", "initial.mean"),
        (model(H=[[1.0, 0.0]]), (), "shape", "models[0].H"),
        (model(F=[[1.0], [0.0]]), (), "shape", "models[0].F"),
        (model(F=[[[1.0]], [[1.0]]]), (), "shape", "measurements"),
        ({"models": []}, (), "empty", "models"),
        ({"measurements": []}, (), "empty", "measurements"),
        ({"measurements": [[1.0, 2.0]]}, (), "shape", "measurements[0]"),
        ({"measurements": [[1.0], [None]]}, (), "not-finite", "measurements[1]"),
        ({"measurements": [[1.0], [True]]}, (), "shape", "measurements[1]"),
        ({"measurements": [[0.0]] * 60}, ("--method", "exact"), "too-large", str(2**60)),
        ({"measurements": [[0.0]] * 60}, ("--method", "k-pulsating", "--depth", "50"), "too-large", str(2**50)),
        ({}, ("--method", "k-pulsating", "--depth", "0"), "domain", "depth"),
        ({}, ("--method", "imm", "--depth", "2"), "domain", "depth"),
        ({}, ("--method", "kalman"), "domain", "method"),
        ({}, ("--form", "cholesky"), "domain", "form"),
        ({"memoryless": True}, ("--method", "polygaussian"), "domain", "memoryless"),
        ({"memoryless": 1}, (), "domain", "memoryless"),
        ({"memoryles": True}, (), "unknown-symbol", "memoryles"),
        (model(G=UNIT), (), "unknown-symbol", "models[0].G"),
        (start(mode=1), (), "unknown-symbol", "initial.mode"),
        (start(mean=[True]), (), "shape", "initial.mean"),
        (model(Q=[[False]]), (), "shape", "models[0].Q"),
        (model(F=[[1e200]]), (), "not-finite", "step 1"),
        (model(F=[[1e200]]), ("--method", "imm", "--form", "ud"), "not-finite", "step 1"),
        (model(F=[[1.0], [1.0, 2.0]]), (), "shape", "got rows of different lengths"),
    ],
)
def test_bad_input_is_a_document_with_status_two(tmp_path, capsys, changes, options, kind, words):
    path = bank_file(tmp_path, **changes)
    status, document, _ = answer(capsys, path, *options)
    assert status == 2 and list(document) == ["error"]
    error = document["error"]
    assert error["kind"] == kind or kind is None
    assert error["where"].startswith(path) and "expected" in error["message"]
    assert words in error["where"] + error["message"]


@pytest.mark.parametrize("text", ["9", "[]", '"x"', "null", "true"])
def test_a_document_that_is_no_object_is_refused(tmp_path, capsys, text):
    path = tmp_path / "bank.json"
    path.write_text(text)
    status, document, _ = answer(capsys, str(path))
    assert (status, document["error"]["kind"]) == (2, "shape")


def test_polygaussian_says_that_it_does_not_use_the_transitions(tmp_path, capsys):
    _, _, remarks = answer(capsys, bank_file(tmp_path), "--method", "polygaussian")
    assert "mode_transition is not used" in remarks
    path = bank_file(tmp_path, mode_transition=[[1.0, 0.0], [0.0, 1.0]])
    assert "mode_transition" not in answer(capsys, path, "--method", "polygaussian")[2]


def test_nan_in_the_file_is_named_with_its_place(tmp_path, capsys):
    path = bank_file(tmp_path)
    with open(path) as file:
        text = file.read()
    with open(path, "w") as file:
        file.write(text.replace("[3.0]", "[NaN]"))
    status, document, _ = answer(capsys, path)
    assert (status, document["error"]["kind"]) == (2, "not-finite")


@pytest.mark.parametrize("form", ["joseph", "qr", "potter", "ud"])
def test_every_form_gives_the_same_document(tmp_path, capsys, form):
    _, plain, _ = answer(capsys, bank_file(tmp_path), "--method", "gpb2")
    status, document, _ = answer(capsys, bank_file(tmp_path), "--method", "gpb2", "--form", form)
    assert status == 0
    for key in plain:
        assert np.asarray(document[key]) == pytest.approx(np.asarray(plain[key]), rel=1e-11, abs=1e-12)


def test_rows_of_the_transition_matrix_say_where_from(tmp_path, capsys):
    """Mode 0 always passes to mode 1 and mode 1 stays: from step 1 on nothing but mode 1 is possible."""
    for method in ("pulsating", "imm", "gpb2", "exact", "k-pulsating"):
        path = bank_file(tmp_path, mode_transition=[[0.0, 1.0], [0.0, 1.0]], **start(probabilities=[1.0, 0.0]))
        _, document, _ = answer(capsys, path, "--method", method)
        assert document["probabilities"] == [[0.0, 1.0]] * 3


def test_a_tree_too_large_is_refused_with_its_count(tmp_path, capsys):
    status, document, _ = answer(capsys, bank_file(tmp_path, measurements=[[0.0]] * 60), "--method", "exact")
    assert (status, document["error"]["kind"]) == (2, "too-large")
    assert str(2**60) in document["error"]["message"]


def test_the_text_names_the_most_probable_mode(tmp_path, capsys):
    assert main.run(["filter", bank_file(tmp_path)]) == 0
    assert "log-likelihood" in capsys.readouterr().out


@pytest.mark.long
def test_simulate_is_repeatable_and_scores_every_method(capsys):
    documents = []
    for _ in range(2):
        assert main.run(["simulate", "multistructure", "--runs", "4", "--steps", "3", "--json"]) == 0
        documents.append(json.loads(capsys.readouterr().out))
    for document in documents:
        for row in document["methods"]:
            assert row.pop("microseconds_per_step") > 0.0
    assert documents[0] == documents[1]
    assert [row["method"] for row in documents[0]["methods"]][:2] == ["exact", "pulsating"]


def test_an_unknown_experiment_is_refused_with_the_known_ones(capsys):
    assert main.run(["simulate", "nothing", "--json"]) == 2
    message = json.loads(capsys.readouterr().out)["error"]["message"]
    assert all(name in message for name in experiment_names())


def test_steps_left_out_stand_in_the_document(tmp_path, capsys):
    perfect = {"F": UNIT, "Q": [[0.0]], "H": [[1.0], [1.0]], "R": [[0.0, 0.0], [0.0, 0.0]]}
    given = {
        "models": [perfect],
        "mode_transition": UNIT,
        "initial": {"mean": [0.0], "covariance": UNIT, "probabilities": [1.0]},
        "measurements": [[2.0, 2.0], [2.0, 3.0], [2.0, 2.0]],
    }
    status, document, remarks = answer(capsys, bank_file(tmp_path, **given))
    assert status == 0 and document["left_out"] == [2] and "step 2" in remarks
    assert document["mean"] == [[2.0]] * 3
    assert "left_out" not in answer(capsys, bank_file(tmp_path, **{**given, "measurements": [[2.0, 2.0]]}))[1]


@pytest.mark.parametrize(
    ("changes", "kind", "words"),
    [
        (model(R=[[[1.0]]]), "shape", "at most 1 rows"),
        (model(Q=[[[1.0]]], F=[UNIT] * 3), "shape", "one length; got [1, 3]"),
        ({"mode_transition": [[[0.9, 0.1], [0.2, 0.8]]]}, "shape", "at most 1 rows"),
    ],
)
def test_a_list_over_time_of_one_matrix_is_not_for_all_steps(tmp_path, capsys, changes, kind, words):
    status, document, _ = answer(capsys, bank_file(tmp_path, **changes))
    assert status == 2 and document["error"]["kind"] == kind and words in document["error"]["message"]
