"""Vectors, matrices, cases and derivatives: identities with false variants, two readings, errors in concepts."""

from __future__ import annotations

import random

import numpy as np
import pytest

import navsym as nav
from navsym import checker
from navsym.claims import PROVED, REFUTED
from navsym.core.errors import NavsymError
from navsym.language.shapes import read_shape
from navsym.language.vectors import print_value_latex, read_value
from navsym.prove.claimfile import claims_from, decide_claim
from tests.language.numbers_again import evaluate
from tests.language.vector_identities import DECLARED, EVERYTHING, RATES

SIZES = {name: read_shape(name, value, {*DECLARED}, "")[0].size for name, value in DECLARED.items()}
UNDERIVED = [row for row in EVERYTHING if not any("dot_" in text or "diff" in text for text in row)]


def decide(left, right, **more):
    block = {"id": "c", "left": left, "right": right} | more
    (claim,) = claims_from({"symbols": DECLARED, "rates": RATES, "claim": [block]}).claims
    return decide_claim(claim, 8.0)


def test_there_are_sixty_identities():
    assert len(EVERYTHING) >= 60


#: Each fifth identity in every run, the others in the long one.
ROWS = [row if k % 5 == 0 else pytest.param(*row, marks=pytest.mark.long) for k, row in enumerate(EVERYTHING)]


@pytest.mark.parametrize(("left", "right", "wrong"), ROWS, ids=lambda text: text[:40])
def test_the_identity_is_proved_and_its_false_variant_refuted(left, right, wrong):
    verdict = decide(left, right)
    assert verdict.status == PROVED and verdict.check()
    refuted = decide(left, wrong)
    assert refuted.status == REFUTED and refuted.counterexample is not None and refuted.difference


def random_point(seed):
    """Values of all declared names: arrays for numpy, balls by entry for the checker."""
    generator = random.Random(seed)
    arrays, balls = {}, {}
    for name, value in DECLARED.items():
        shape = read_shape(name, value, {*DECLARED}, "")[0]
        entries = {entry: checker.fmpq(generator.randint(1, 97), 100) for row in shape.rows for entry in row}
        balls |= {entry: checker.Jet(checker.arb(number)) for entry, number in entries.items()}
        table = np.array([[int(entries[e].p) / int(entries[e].q) for e in row] for row in shape.rows])
        arrays[name] = table if shape.size else table[0, 0]
    return arrays, balls


@pytest.mark.parametrize("text", [text for row in UNDERIVED for text in row], ids=lambda text: text[:40])
def test_the_checker_reads_the_entries_that_numpy_computes(text):
    arrays, balls = random_point(len(text))
    names = {
        name: checker.Matrix([("symbol", entry) for entry in row] for row in shape.rows)
        for name, value in DECLARED.items()
        for shape in read_shape(name, value, {*DECLARED}, "")[:1]
        if shape.size
    }
    value = np.array(evaluate(read_value(text, SIZES).tree, arrays), dtype=float)
    found = []
    choices = []
    while choices is not None:  # the case to which the point belongs
        reader = checker.Reader(names, {}, choices)
        entries = checker.list_entries(reader.read(text))
        inside = all(checker.value_of(t, balls) >= 0 for t in reader.given)
        if inside and all(abs(float(checker.value_of(t, balls).mid())) < 1e-30 for t in reader.zeros):
            found = [float(checker.value_of(entry, balls).mid()) for entry in entries]
        choices = checker.next_choices(reader.choices)
    assert np.allclose(np.ravel(value), found, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    ("text", "kind", "words"),
    [
        ("cross(F, x)", "shape", "cross of two vectors of three; got a 2 x 3 matrix and a number"),
        ("u*v", "shape", "write @ for a product of matrices, dot or cross for vectors"),
        ("A/B", "shape", "a quotient or power of numbers"),
        ("A**2", "shape", "a quotient or power of numbers"),
        ("u + x", "shape", "terms of one shape; got a vector of 3 and a number"),
        ("A @ r", "shape", "as many columns before @ as rows behind it"),
        ("A[4,1]", "shape", "counted from 1; got .4, 1. of a 3 x 3 matrix"),
        ("A[1]", "shape", "two indices"),
        ("u[0]", "syntax", "from 1 on"),
        ("x[1]", "shape", "a vector or matrix before an index; got a number"),
        ("sin(u)", "shape", "sin of a number; got a vector of 3"),
        ("det(F)", "shape", "a square matrix"),
        ("qmul(u, q)", "shape", "two quaternions, vectors of four with the scalar first"),
        ("[[x], [1, 2]]", "shape", "rows of one length"),
        ("where(x, 1, 2)", "syntax", "one of = != < <= > >="),
        ("diff(x, x + y)", "syntax", "a symbol as the second argument"),
        ("erf(u)", "shape", "erf of a number; got a vector of 3"),
        ("nobody @ u", "unknown-symbol", "a declared name"),
        ("u.t", "syntax", "T behind the point"),
        ("[1, 2", "syntax", "behind an entry"),
        ("cross(u)", "shape", "got 1 argument"),
    ],
)
def test_what_does_not_fit_is_said_in_concepts(text, kind, words):
    with pytest.raises(NavsymError, match=words) as caught:
        read_value(text, SIZES, where="c")
    assert caught.value.kind == kind and "column" in caught.value.where


@pytest.mark.parametrize(
    ("declaration", "kind"),
    [
        ({"vector": 0}, "shape"),
        ({"vector": "3"}, "shape"),
        ({"matrix": ["n", "2*n"]}, "shape"),
        ({"matrix": [2]}, "shape"),
        ({"matrix": [2, 3], "symmetric": True}, "shape"),
        ({"vector": 3, "rotation": "b to n"}, "shape"),
        ({"vector": 65}, "too-large"),
        ({"quaternion": "half"}, "domain"),
        ({"function": "s"}, "domain"),
        ({"integer": ["1/2", "3"]}, "domain"),
        ({"vector": 3, "range": ["0", "1"]}, "domain"),
        ({"tensor": 3}, "syntax"),
        (3, "shape"),
    ],
)
def test_a_declaration_that_says_nothing_is_refused(declaration, kind):
    with pytest.raises(NavsymError, match=r"expected .*; got .*; \w") as caught:
        read_shape("v", declaration, {"v"}, "f: symbols.v")
    assert caught.value.kind == kind


def test_entries_do_not_take_the_names_of_declared_symbols():
    verdict = nav.prove("v[1] = v_1", v={"vector": 3})
    assert verdict.status == REFUTED and {"v[1]", "v_1"} <= set(verdict.counterexample)
    assert nav.prove("v[1] + v_1 = v_1 + v[1]", v={"vector": 3}).holds


def test_a_symmetric_matrix_has_one_symbol_in_two_places_and_another_has_not():
    assert nav.prove("P = P.T", P={"matrix": [3, 3], "symmetric": True}).holds
    assert nav.prove("P = P.T", P={"matrix": [3, 3]}).status == REFUTED


def test_an_inverse_needs_a_determinant_and_says_so():
    verdict = nav.prove("A @ inv(A) = eye(2)", A={"matrix": [2, 2]})
    assert verdict.holds and verdict.assumptions == ("A[1,1]*A[2,2] - A[1,2]*A[2,1] != 0",)
    assert nav.prove("C @ inv(C) = eye(3)", C={"rotation": "b to n"}).assumptions == ()


def test_hypotheses_are_needed_and_a_wrong_use_of_them_is_refuted():
    vectors = {"u": {"vector": 3}, "v": {"vector": 3}}
    unit = ["dot(u, u) = 1", "dot(v, v) = 1"]
    assert nav.prove("norm(cross(u, v))**2 = 1 - dot(u, v)**2", given=unit, **vectors).holds
    assert nav.prove("norm(cross(u, v))**2 = 1 - dot(u, v)**2", **vectors).status == REFUTED
    assert nav.prove("norm(cross(u, v))**2 = 1", given=unit, **vectors).status == REFUTED
    assert nav.prove("norm(cross(u, v)) = 1", given=[*unit, "dot(u, v) = 0"], **vectors).status != REFUTED
    assert nav.prove("x = 2", given="x**2 = 4").status != PROVED
    linear = ["x + y + z = 6", "x - y = -1", "x = 1"]  # z follows when x and y are known
    assert nav.prove("z = 3", given=linear).holds and nav.prove("z = 2", given=linear).status == REFUTED
    assert nav.prove("x = 2", given=["x**2 = 4", "x > 0"], x="positive").status != REFUTED


def test_hypotheses_that_nothing_satisfies_prove_nothing():
    for given in ("dot(u, u) = -1", "1 = 2", "norm(u) = -1"):
        assert nav.prove("u = 2*u", given=given, u={"vector": 3}).status == nav.OPEN


def test_an_integer_is_no_other_number():
    n = {"integer": ["1", "oo"]}
    assert nav.prove("n**2 >= n", n=n).holds
    assert nav.prove("n != 1/2", n=n).status != REFUTED
    verdict = nav.prove("n = 3", n=n)
    assert verdict.status == REFUTED and verdict.counterexample["n"].isdigit()


def test_a_chain_holds_when_each_of_its_links_does():
    def chain(text):
        document = {"symbols": {"x": "real", "h": "positive"}, "claim": [{"id": "c", "chain": text}]}
        return decide_claim(claims_from(document).claims[0], 8.0)

    assert chain("(x + h)**2 = x**2 + 2*x*h + h**2 > 2*x*h - h").holds
    assert chain("x**2 = abs(x)**2 <= x**2 + h").holds
    assert chain("x**2 = abs(x)**2 <= x**2 - h").status == REFUTED
    assert chain("x = x + h <= x + 2*h").status == REFUTED
    assert chain("where(x < 0, -x, x) = abs(x) >= x").holds


def test_cases_and_derivatives_keep_their_domains():
    assert nav.prove("where(x > 0, 1/x, 0)*x = where(x > 0, 1, 0)").assumptions == ()
    assert nav.prove("diff(abs(x), x) = sign(x)").status in (PROVED, nav.OPEN)
    assert nav.prove("diff(sqrt(x), x) = 1/(2*sqrt(x))").assumptions == ("x > 0",)
    assert nav.prove("diff(abs(x), x) = 1").status == REFUTED


def test_rates_make_derivatives_by_time_and_none_is_taken_for_zero():
    assert nav.prove("dot_(x**2) = 2*x*y", rates={"x": "y"}).holds
    assert nav.prove("dot_(x**2) = 2*x", rates={"x": "y"}).status == REFUTED
    assert nav.prove("diff(L*x, t) = x*dot_(L)", L={"function": "t"}).holds
    with pytest.raises(NavsymError, match="expected a rate"):
        nav.prove("dot_(x) = 0")
    with pytest.raises(NavsymError, match="a rate of the shape of u"):
        nav.prove("dot_(u) = u", u={"vector": 3}, rates={"u": "1"})


def test_a_formula_is_shown_as_it_was_written_and_comes_back_from_its_document():
    verdict = nav.prove("dot(C @ u, C @ v) = dot(u, v)", C={"rotation": "b to n"}, u={"vector": 3}, v={"vector": 3})
    assert str(verdict.formula) == "dot(C @ u, C @ v) = dot(u, v)"
    assert r"C \, u" in verdict._repr_latex_() and "_{" not in verdict._repr_latex_()
    (again,) = claims_from(verdict.formula.document()).claims
    assert decide_claim(again, 8.0).certificate == verdict.certificate
    assert print_value_latex(read_value("inv(A.T)[1,2]", SIZES).tree) == (
        r"{\left(\left(A^{\top}\right)^{-1}\right)}_{1, 2}"
    )


def test_one_unreadable_claim_does_not_stop_the_others():
    claims = [{"id": "bad", "left": "cross(u, x)", "right": "u"}, {"id": "good", "left": "u", "right": "u"}]
    claims.append({"id": "typo", "left": "x +", "right": "x"})
    file = claims_from({"symbols": DECLARED, "claim": claims}, "f", go_on=True)
    assert [claim.id for claim in file.claims] == ["good"]
    assert [(claim.id, claim.error.kind) for claim in file.undefined] == [("bad", "shape"), ("typo", "syntax")]


def test_a_certificate_of_another_declaration_is_refused():
    verdict = nav.prove("C @ C.T = eye(3)", C={"rotation": "b to n"})
    statement = verdict.certificate["statement"]
    for changed in ({"given": statement["given"][1:]}, {"right": "C"}, {"given": []}):
        forged = verdict.certificate | {"statement": statement | changed}
        with pytest.raises(checker.Refused):
            checker.grant([statement | changed], forged)
