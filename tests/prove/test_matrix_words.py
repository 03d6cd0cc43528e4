"""Matrices of any size: textbook identities are proved, their false variants fall, and nothing holds only for n = 1."""

from __future__ import annotations

import json
import random
import re

import numpy as np
import pytest

import navsym as nav
from navsym import checker
from navsym.prove.claimfile import claims_from, decide_claim
from tests.checker import words
from tests.prove.matrix_identities import IDENTITIES, SYMBOLS

SQUARE = {"matrix": ["n", "n"]}
POSITIVE = {"matrix": ["n", "n"], "symmetric": True, "positive": True}
VECTOR = {"vector": "n"}


def decide(left, right, given=(), symbols=SYMBOLS):
    block = {"id": "claim", "left": left, "right": right, **({"given": list(given)} if given else {})}
    return decide_claim(claims_from({"symbols": symbols, "claim": [block]}).claims[0], 10)


@pytest.mark.parametrize("name, left, right, wrong, given", IDENTITIES, ids=[item[0] for item in IDENTITIES])
def test_an_identity_of_estimation_is_proved_and_its_false_variant_falls(name, left, right, wrong, given):
    verdict = decide(left, right, given)
    assert verdict.status == "PROVED"
    assert verdict.check().accepted
    fallen = decide(left, wrong, given)
    assert fallen.status == "REFUTED"
    assert fallen.check().accepted


@pytest.mark.parametrize("name, left, right, wrong, given", IDENTITIES[::4], ids=[item[0] for item in IDENTITIES[::4]])
def test_numpy_agrees_with_every_counterexample(name, left, right, wrong, given):
    point = decide(left, wrong, given).counterexample
    names = {n: np.array([[float(eval_fraction(e)) for e in row] for row in rows]) for n, rows in matrices_of(point)}
    names |= {n: float(eval_fraction(text)) for n, text in point.items() if n not in names}
    names |= {n: int(v) for n, v in names.items() if n in ("n", "m")}
    values = [evaluate(text, names) for text in (left, wrong)]
    assert np.max(np.abs(values[0] - values[1])) > 1e-9
    for text in given:
        sides = [evaluate(side, names) for side in text.split(" = ")]
        assert np.allclose(*sides)


def matrices_of(point):
    for name, text in point.items():
        if text.startswith("["):
            yield name, json.loads(re.sub(r"([-\d/]+)", r'"\1"', text))


def eval_fraction(text):
    top, _, bottom = text.strip("()").partition("/")
    return int(top) / int(bottom or 1)


def evaluate(text, names):
    known = {"inv": np.linalg.inv, "eye": np.eye, "trace": np.trace, "zeros": lambda m, n: np.zeros((m, n))}
    return eval(text, {"__builtins__": {}}, {**known, **names})


def test_the_checker_refuses_every_forged_sum_of_words():
    assert [*words.discrepancies(checker)] == []


@pytest.mark.parametrize(
    "formula, declared",
    [
        ("A @ B = B @ A", {"A": SQUARE, "B": SQUARE}),
        ("A @ B @ A = A @ A @ B", {"A": SQUARE, "B": SQUARE}),
        ("A.T = A", {"A": SQUARE}),
        ("(A @ B).T = A.T @ B.T", {"A": SQUARE, "B": SQUARE}),
        ("trace(A)*eye(n) = n*A", {"A": SQUARE}),
        ("trace(A @ B) = trace(A)*trace(B)", {"A": SQUARE, "B": SQUARE}),
        ("u @ u.T = dot(u, u)*eye(n)", {"u": VECTOR}),
        ("inv(A + B) = inv(A) + inv(B) - inv(A) - inv(B) + inv(B + A) + A @ B - B @ A", {"A": SQUARE, "B": SQUARE}),
        ("u @ v.T = v @ u.T", {"u": VECTOR, "v": VECTOR}),
    ],
)
def test_what_holds_for_n_equal_to_one_alone_is_refuted(formula, declared):
    verdict = nav.prove(formula, **declared)
    assert verdict.status == "REFUTED"
    assert int(verdict.counterexample["n"]) > 1
    certificate = dict(verdict.certificate)
    certificate["point"] = {**certificate["point"], "sizes": {"n": 1}}
    with pytest.raises(checker.Refused):
        checker.check(certificate)


@pytest.mark.parametrize(
    "formula, declared, given",
    [
        ("C.T @ C = eye(n)", {"C": SQUARE}, "C @ C.T = eye(n)"),
        ("A = B", {"A": SQUARE, "B": SQUARE, "P": POSITIVE}, "A @ P = B @ P"),
        ("A = eye(n)", {"A": {**SQUARE, "invertible": True}}, "A @ A = A"),
        ("u @ u.T @ u @ u.T = u @ u.T", {"u": VECTOR}, "dot(u, u) = 1"),
        ("F @ F = F", {"F": SQUARE, "u": VECTOR, "v": VECTOR}, ["F = u @ v.T", "dot(u, v) = 1"]),
        ("D @ E = E @ D", {"D": {**SQUARE, "diagonal": True}, "E": {**SQUARE, "diagonal": True}}, ()),
        ("inv(eye(n) + S).T = inv(eye(n) - S)", {"S": {**SQUARE, "skew": True}}, ()),
    ],
)
def test_a_hypothesis_is_used_and_needed(formula, declared, given):
    assert nav.prove(formula, given=given, **declared).status == "PROVED"
    weaker = {name: {k: v for k, v in item.items() if k in ("matrix", "vector")} for name, item in declared.items()}
    names = set(re.findall(r"[A-Za-z]\w*", formula))
    assert nav.prove(formula, **{n: item for n, item in weaker.items() if n in names}).status == "REFUTED"


def test_a_left_inverse_of_a_matrix_that_is_not_square_is_no_right_inverse():
    wide = {"matrix": ["n", "m"]}
    assert nav.prove("C.T @ C = eye(m)", C=wide, given="C @ C.T = eye(n)").status == "REFUTED"


def test_an_inverse_is_assumed_unless_positive_matrices_give_it():
    m, H, P, R = {"matrix": ["m", "m"]}, {"matrix": ["m", "n"]}, POSITIVE, {"matrix": ["m", "m"], "positive": True}
    formula = "inv(H @ P @ H.T + R) @ (H @ P @ H.T + R) = eye(m)"
    assert nav.prove(formula, H=H, P=P, R=R).assumptions == ()
    assert nav.prove(formula, H=H, P={"matrix": ["n", "n"], "nonnegative": True}, R=R).assumptions == ()
    assert nav.prove(formula, H=H, P=SQUARE, R=R).assumptions == ("H @ P @ H.T + R invertible",)
    assert nav.prove(formula, H=H, P=P, R={**m, "symmetric": True}).assumptions == ("H @ P @ H.T + R invertible",)
    negative = formula.replace("+ R", "- R")
    assert nav.prove(negative, H=H, P=P, R=R).assumptions == ("H @ P @ H.T - R invertible",)
    normal = nav.prove("inv(H.T @ R @ H) @ H.T @ R @ H = eye(n)", H=H, R=R)
    assert normal.assumptions == ("H.T @ R @ H invertible",)


def test_the_inverse_of_a_singular_matrix_proves_nothing():
    verdict = nav.prove("inv(A - A) = inv(A - A)", A=SQUARE)
    assert verdict.status == "OPEN"
    assert nav.prove("A = B", A=SQUARE, B=SQUARE, given=["A @ inv(B - B) = A"]).status == "OPEN"
    assert nav.prove("A = B", A=SQUARE, B=SQUARE, given=["eye(n) = zeros(n, n)"]).status == "OPEN"


@pytest.mark.parametrize(
    "formula, declared, words",
    [
        ("A + B = A", {"A": SQUARE, "B": {"matrix": ["m", "n"]}}, "terms of one shape; got a n x n matrix and a m x n"),
        ("A @ B = A", {"A": SQUARE, "B": {"matrix": ["m", "n"]}}, "as many columns before @ as rows behind it"),
        ("A @ B = eye(m)", {"A": SQUARE, "B": {"matrix": ["n", "m"]}}, "sides of one shape"),
        ("inv(B) = B", {"B": {"matrix": ["n", "m"]}}, "inv of a square matrix"),
        ("trace(B) = 0", {"B": {"matrix": ["n", "m"]}}, "trace of a square matrix"),
        ("det(A) = 0", {"A": SQUARE}, "det of a square matrix of at most 5 rows; got a n x n matrix"),
        ("A[1,1] = 0", {"A": SQUARE}, "a matrix of fixed size before an index"),
        ("A*A = A", {"A": SQUARE}, "write @"),
        ("norm(u) = 1", {"u": VECTOR}, "got norm"),
        ("A = A", {"A": {"matrix": ["n", "m"], "positive": True}}, "a square matrix to be positive; got n x m"),
        ("A = A", {"A": {"matrix": ["n", "sin"]}}, "the name of one"),
        ("A = A", {"A": {"matrix": ["n", "n"], "function": "t"}}, "a constant matrix"),
        ("n*A = A", {"A": SQUARE, "n": "real"}, "n as a dimension alone"),
        ("x = x", {"x": {"sign": "real", "invertible": True}}, "invertible beside a matrix"),
        ("A = A", {"A": {"matrix": ["n", "n"], "invertible": "yes"}}, "true or false"),
    ],
)
def test_what_has_no_meaning_is_refused_in_the_words_of_matrices(formula, declared, words):
    with pytest.raises(nav.NavsymError, match=re.escape(words)):
        nav.prove(formula, **declared)


def test_a_claim_file_and_the_front_door_agree(tmp_path):
    path = tmp_path / "joseph.toml"
    path.write_text(
        "[symbols]\n"
        'P = { matrix = ["n", "n"], symmetric = true, positive = true }\n'
        'R = { matrix = ["m", "m"], positive = true }\n'
        'H = { matrix = ["m", "n"] }\n'
        "[[claim]]\n"
        'id = "gain"\n'
        'chain = "P @ H.T @ inv(H @ P @ H.T + R) = inv(inv(P) + H.T @ inv(R) @ H) @ H.T @ inv(R) = P @ H.T"\n'
        "[[claim]]\n"
        'id = "same"\n'
        'left = "P.T"\n'
        'right = "P"\n'
    )
    verdicts = nav.prove(path)
    assert [v.status for v in verdicts] == ["REFUTED", "PROVED"]
    assert verdicts.check().accepted
    assert verdicts["gain"].document()["counterexample"]["P"].startswith("[[")


def test_a_formula_is_shown_in_latex():
    verdict = nav.prove("inv(A @ B).T = inv(A).T @ inv(B).T", A=SQUARE, B=SQUARE)
    assert r"\left(A \, B\right)^{-1}" in verdict._repr_latex_()
    assert nav.prove(r"\left(A B\right)^{-1} = B^{-1} A^{-1}", A=SQUARE, B=SQUARE).status == "PROVED"


def test_fixed_sizes_have_the_same_properties():
    small = {"matrix": [2, 2]}
    assert nav.prove("P[1,1] >= 0", P={**small, "positive": True}).status == "PROVED"
    assert nav.prove("det(P) < 1", P={**small, "positive": True}).status == "REFUTED"
    assert nav.prove("P[1,2] = P[2,1]", P={**small, "positive": True}).status == "PROVED"
    assert nav.prove("U @ U.T = eye(2)", U={**small, "orthogonal": True}).status == "PROVED"
    assert nav.prove("A[1,1] = 0", A={**small, "skew": True}).status == "PROVED"
    assert nav.prove("A[1,1] = 0", A={**small, "symmetric": True}).status == "REFUTED"


def test_random_rewritings_are_proved_and_random_claims_agree_with_numpy():
    """A claim that is rewritten by what is declared stays true; PROVED never contradicts floating point."""
    generator = random.Random(5)
    symbols = {"A": SQUARE, "B": SQUARE, "P": POSITIVE, "O": {**SQUARE, "orthogonal": True}, "u": VECTOR}
    laws = [("A", "(A @ O @ O.T)"), ("P", "P.T"), ("B", "(inv(P) @ P @ B)"), ("A", "(A + B - B)"), ("u", "(u.T.T)")]
    counts = {"PROVED": 0, "REFUTED": 0, "OPEN": 0}
    for _ in range(60):
        left = grow(generator, "n", 3)
        right, is_true = left, generator.random() < 0.6
        for old, new in generator.sample(laws, 2):
            right = re.sub(rf"\b{old}\b", new, right, count=1)
        right = right if is_true else right.replace("A", "B", 1).replace(" + ", " - ", 1)
        verdict = decide(left, right, symbols=symbols)
        counts[verdict.status] += 1
        assert not (is_true and verdict.status == "REFUTED")
        for seed in range(3) if verdict.status == "PROVED" else ():
            x, y = (evaluate(text, draw(seed)) for text in (left, right))
            assert np.max(np.abs(x - y)) <= 1e-6 * (1 + np.max(np.abs(x)))
    assert counts["OPEN"] == 0 and min(counts["PROVED"], counts["REFUTED"]) > 8


def grow(generator, columns, depth):
    """A random square matrix, or column, of the symbols above."""
    if columns == 1:
        return "u" if depth == 0 else f"{grow(generator, 'n', depth - 1)} @ u"
    if depth == 0:
        return generator.choice(["A", "B", "P", "O", "A.T", "eye(n)"])
    x, y = (grow(generator, "n", depth - 1) for _ in range(2))
    return generator.choice([f"({x} + {y})", f"{x} @ {y}", f"({x}).T @ ({y})", f"({x})*2", f"u @ u.T @ ({x})"])


def draw(seed):
    g, n = np.random.default_rng(seed), 3
    P = g.normal(size=(n, n))
    names = {name: g.normal(size=(n, n)) for name in "AB"}
    return {**names, "P": P @ P.T + np.eye(n), "O": np.linalg.qr(P)[0], "u": g.normal(size=(n, 1)), "n": n}
