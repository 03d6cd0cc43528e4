"""``nav.prove``: what goes in, what comes out, and what is refused."""

from __future__ import annotations

import json
import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

import navsym as nav
from navsym.claims import Bound, Equation, Property
from navsym.cli.main import run
from navsym.language.printer import to_text
from navsym.prove.ladder import decide

EXAMPLE = Path(__file__).parents[2] / "examples" / "formulas.toml"
FREE, EVEN = sp.Symbol("x"), sp.Symbol("x", even=True)
REAL, POSITIVE = sp.Symbol("x", real=True), sp.Symbol("x", positive=True)


@pytest.mark.parametrize(
    ("formula", "declared", "status"),
    [
        ("sin(2*a) = 2*sin(a)*cos(a)", {}, nav.PROVED),
        ("sin(T) <= T", {"T": ("0", "pi")}, nav.PROVED),
        ("sin(2*a) = 2*sin(a)", {}, nav.REFUTED),
        ("log(x) <= x - 1", {"x": "positive"}, nav.PROVED),
        ("x**2 > 0", {"x": "nonzero"}, nav.PROVED),
        ("beta*E + I = I + E*beta", {"E": "real"}, nav.PROVED),
    ],
)
def test_a_formula_as_text_gives_its_verdict(formula, declared, status):
    verdict = nav.prove(formula, **declared)
    assert verdict.status == status and verdict.holds is status.holds
    assert str(verdict.formula) == formula


def test_both_sides_may_be_numbers_fractions_sympy_matrices_and_arrays():
    assert nav.prove(Fraction(1, 3), "<", sp.Rational(1, 2)).holds
    assert nav.prove(sp.sin(REAL) ** 2, "=", "1 - cos(x)**2").holds
    assert nav.prove(np.array([[1, 0], [0, 1]]), "=", sp.eye(2)).holds
    assert nav.prove([[REAL, 0], [0, "x"]], "=", sp.diag(REAL, REAL)).holds


def test_a_symbol_of_sympy_declares_itself():
    assert nav.prove(sp.log(POSITIVE), "<=", POSITIVE - 1).scope == "all x in (0, oo)"
    assert nav.prove(FREE**2, ">=", 0).scope == "all real x"


def test_a_range_narrows_a_positive_symbol_and_may_not_contradict_it():
    assert nav.prove(sp.sqrt(POSITIVE**2), "=", "x", x=("0", 2)).scope == "all x in (0, 2]"
    with pytest.raises(nav.NavsymError, match="inside the declaration of x"):
        nav.prove(sp.sqrt(POSITIVE**2), "=", "x", x=("-1", "1"))
    with pytest.raises(nav.NavsymError, match="takes to be positive"):
        nav.prove(sp.sqrt(POSITIVE**2), "=", "x", x="real")


def test_two_symbols_of_one_name_are_an_error_that_names_both():
    with pytest.raises(nav.NavsymError, match="two called x, positive and real"):
        nav.prove(POSITIVE, "=", REAL)


@pytest.mark.parametrize("value", [0.1, np.float64(0.1), sp.Float("0.1"), 0.1 * REAL])
def test_a_float_is_refused_with_its_exact_spelling(value):
    with pytest.raises(nav.NavsymError, match=re.escape('got the float 0.1; write "1/10" or "0.1" as text')):
        nav.prove(value, "=", "x/10")


@pytest.mark.parametrize(
    ("arguments", "declared", "kind", "where"),
    [
        (("sin(a)",), {}, "syntax", "prove: statement"),
        (("a = b = ",), {}, "empty", "prove: right"),
        ((r"a = b \quad c = d",), {}, "syntax", "prove: statement"),
        ((3,), {}, "syntax", "prove: statement"),
        ((sp.Eq(REAL, 1, evaluate=False),), {}, "syntax", "prove: statement"),
        ((None, "=", "a"), {}, "syntax", "prove: left"),
        (("a", "=", None), {}, "syntax", "prove: right"),
        (("a", "==", "b"), {}, "syntax", "prove: relation"),
        (("a", 3, "b"), {}, "syntax", "prove: relation"),
        ((EVEN, "=", 1), {}, "domain", "prove"),
        ((True, "=", 1), {}, "syntax", "prove: left"),
        ((sp.oo, "=", 1), {}, "syntax", "prove: left"),
        ((sp.sin, "=", 1), {}, "syntax", "prove: left"),
        (([["a", "b"]], "=", [["a"]]), {}, "shape", "prove"),
        (("a = 1/0",), {}, "domain", "prove: right, column 2"),
        (("ln(a) = b",), {}, "unknown-symbol", "prove: left, column 1"),
        (("a = ",), {}, "empty", "prove: right"),
        (("a = b",), {"T": "real"}, "unknown-symbol", "prove: T"),
        (("a = b",), {"a": 0.5}, "syntax", "prove: a"),
        (("a = b",), {"a": ("0", 0.5)}, "domain", "prove: a[1]"),
        (("a = b",), {"a": ("2", "1")}, "domain", "prove: a"),
        (("a = b",), {"seconds": "3"}, "domain", "prove: seconds"),
        (("a = b",), {"seconds": float("nan")}, "domain", "prove: seconds"),
        (("a = b",), {"jobs": 0}, "domain", "prove: jobs"),
        (("a = b",), {"box": 3}, "shape", "prove: box"),
        (("a = b",), {"tolerance": 0.5}, "domain", "prove: tolerance"),
        (("a = b",), {"tolerance": "0"}, "domain", "prove: tolerance"),
        (("a = b",), {"tolerance": "a"}, "unknown-symbol", "prove: tolerance, column 1"),
        (("a < b",), {"tolerance": "1"}, "domain", "prove: tolerance"),
        (("a = b",), {"exists": 3.5}, "domain", "prove: exists[0]"),
        (("a = b",), {"exists": ["1/0"]}, "domain", "prove: exists[0], column 2"),
        ((EXAMPLE,), {"tolerance": "1"}, "domain", "prove"),
        (("nothing_there.toml",), {}, "missing-file", "nothing_there.toml"),
        ((EXAMPLE,), {"T": "real"}, "domain", "prove"),
    ],
)
def test_wrong_arguments_raise_a_navsym_error_with_kind_and_place(arguments, declared, kind, where):
    with pytest.raises(nav.NavsymError) as caught:
        nav.prove(*arguments, **declared)
    assert (caught.value.kind, caught.value.where) == (kind, where)


def test_a_claim_file_gives_the_document_of_the_verb(capsys):
    verdicts = nav.prove(EXAMPLE)
    assert run(["prove", str(EXAMPLE), "--json"]) == 1
    assert json.loads(capsys.readouterr().out) == json.loads(json.dumps(verdicts.document()))
    assert [verdict.document() for verdict in verdicts] == verdicts.document()["claims"]
    assert verdicts["half-angle"].holds and not verdicts.holds
    with pytest.raises(nav.NavsymError, match="got 'none'"):
        verdicts["none"]


def test_the_formula_of_a_verdict_is_a_claim_file_of_its_own():
    from navsym.prove.claimfile import claims_from, decide_claims

    verdict = nav.prove("x + T >= T", T=("0", "1"), x="nonnegative")
    again = decide_claims(claims_from(verdict.formula.document()))
    assert again[0] == verdict and verdict.holds


def test_a_tolerance_is_that_of_a_printed_numeral():
    assert nav.prove("22/7 = pi", tolerance="0.0013").holds
    refuted = nav.prove("22/7", "=", sp.pi, tolerance=sp.Rational(12, 10000))
    assert refuted.status == nav.REFUTED and str(refuted.formula) == "22/7 +- 3/2500 = pi"
    assert r"\pm \frac{3}{2500}" in refuted.formula._repr_latex_()


def test_what_must_exist_is_an_assumption_and_its_zeros_are_no_counterexamples():
    assert nav.prove("abs(x)/x = 1").status == nav.REFUTED
    verdict = nav.prove("abs(x)/x = 1", exists="log(x)")
    assert verdict.status == nav.PROVED and "x > 0" in verdict.assumptions
    assert nav.prove("b = b", exists=["1/a", 1 / sp.Symbol("b", nonzero=True)]).assumptions == ("a != 0",)


def test_the_formula_of_a_verdict_keeps_its_tolerance_and_what_must_exist():
    from navsym.prove.claimfile import claims_from, decide_claims

    verdict = nav.prove("x/2 = x/2 + 1/100", tolerance="0.02", exists=["1/x"], x=("-1", "1"))
    again = decide_claims(claims_from(verdict.formula.document()))[0]
    assert again == verdict and verdict.holds and verdict.assumptions == ("x != 0",)


def test_a_time_limit_leaves_it_open():
    slow = "*".join(f"(sin(a{i}) + cos(b{i}) + 2)" for i in range(12))
    verdict = nav.prove(slow, ">", 0, seconds=0.05)
    assert verdict.status == nav.OPEN and "0.05 s" in verdict.evidence


def test_verdicts_show_themselves_in_one_line_and_escape_words():
    verdicts = nav.prove(EXAMPLE)
    for shown in (verdicts, *verdicts):
        assert "\n" not in repr(shown)
    assert "✓ PROVED" in verdicts._repr_html_() and r"\tan" in verdicts[0]._repr_html_()
    assert verdicts[0]._repr_latex_().endswith(r"\text{PROVED}$")
    evil = nav.Verdict(nav.OPEN, "</script><b>", assumptions=("</script>",))
    assert "</script>" not in evil._repr_html_() and "<b>" not in evil._repr_html_().replace("<b style", "")


A = sp.Symbol("a", real=True)


@pytest.mark.parametrize(
    ("statement", "where"),
    [
        (sp.Eq(A, 1, evaluate=False), "statement"),
        (Equation("sin(2*a)", A), "Equation: printed"),
        (Equation(A, None), "Equation: derived"),
        (Equation(A, [[A]]), "Equation: derived"),
        (Equation(A / 2, 0.5 * A), "Equation: derived"),
        (Equation(sp.sin, A), "Equation: printed"),
        (Equation(A, A, tolerance="0.5"), "Equation: tolerance"),
        (Equation(A, A, {A: 3}), "Equation: box"),
        (Equation(A, A, {A: ("0", 1)}), "Equation: box.a"),
        (Equation(A, A, 3), "Equation: box"),
        (Equation(A, A, nonzero=("a",)), "Equation: nonzero"),
        (Bound(A, "<", "b"), "Bound: derived"),
        (Property(1, 2), "Property: derived"),
    ],
)
def test_what_is_no_statement_is_refused_with_its_place(statement, where):
    with pytest.raises(nav.NavsymError) as caught:
        decide(statement)
    assert (caught.value.kind, caught.value.where) == ("domain", where) and caught.value.remedy


@pytest.mark.parametrize(
    ("chain", "status"),
    [
        ("dot(u, v)**2 <= dot(u, u)*dot(v, v) = norm(u)**2*norm(v)**2", nav.PROVED),
        ("dot(u, v)**2 <= dot(u, u)*dot(v, v) = norm(u)**2*norm(v)**3", nav.REFUTED),
        ("dot(u, v) = dot(v, u) < dot(u, u)", nav.REFUTED),
    ],
)
def test_a_chain_holds_when_all_of_its_links_do(chain, status):
    assert nav.prove(chain, u={"vector": 3}, v={"vector": 3}).status == status


def test_a_chain_in_latex_is_a_chain():
    assert nav.prove(r"\sin(2a) = 2\sin a\cos a \le 1").status == nav.PROVED
    assert nav.prove(r"\sin(2a) = 2\sin a\cos a \le \frac12").status == nav.REFUTED


def test_a_scope_names_the_hypotheses_and_the_small_number_of_an_order():
    assert nav.prove("x = 1", x="real", given=["x = 1"]).scope == "all real x with x = 1"
    projection = nav.prove("P @ P @ P = P", P={"matrix": ["n", "n"]}, given=["P @ P = P"])
    assert projection.scope == "all P in R^(n x n) with P @ P = P"


@pytest.mark.parametrize(
    ("statement", "given", "symbols", "status"),
    [
        ("K*S*K = K*P", ["K = P/(P + R)", "S = P + R"], {"P": "positive", "R": "positive"}, "PROVED"),
        ("K*S = P", ["K = P/S", "S = P + R"], {"P": "positive", "R": "positive"}, "PROVED"),
        ("K*S = R", ["K = P/S", "S = P + R"], {"P": "positive", "R": "positive"}, "REFUTED"),
        ("N*W**2 = a*W", ["W = sqrt(1 - e**2*sin(p)**2)", "N = a/W"], {"e": ("0", "1/2"), "a": "positive"}, "PROVED"),
        ("N*W = a**2", ["W = sqrt(1 - e**2*sin(p)**2)", "N = a/W"], {"e": ("0", "1/2"), "a": "positive"}, "REFUTED"),
        ("N >= a", ["N = a/W", "W = sqrt(1 - e**2*sin(p)**2)"], {"e": ("0", "1/2"), "a": "positive"}, "CERTIFIED"),
    ],
)
def test_hypotheses_that_build_on_each_other_have_points_in_their_order(statement, given, symbols, status):
    assert nav.prove(statement, given=given, **symbols).status == status


def test_a_name_at_the_end_of_a_sum_counts_from_one_unless_it_is_declared():
    assert "n in [1, oo) whole" in repr(nav.prove("sum(k, k, 1, n) = n*(n + 1)/2"))
    assert nav.prove("product(2, k, 0, n - 1) = 2**n").status == nav.PROVED
    assert nav.prove("sum(k, k, 1, n) = n**2").status == nav.REFUTED
    assert "n in [2, oo)" in repr(nav.prove("sum(k, k, 1, n) = n*(n + 1)/2", n={"integer": ["2", "oo"]}))
    assert "all T in (0, oo)" in repr(nav.prove("integral(k, k, 1, T) = T**2/2 - 1/2", T="positive"))


def test_a_counterexample_has_short_numbers_where_they_do():
    found = nav.prove("K = P/(P + R)")
    assert all(len(value) < 4 for value in found.counterexample.values()) and found.check()
    assert nav.prove("x**2 != 2", x=("7/5", "3/2")).counterexample == {"x": "sqrt(2)"}


def test_the_text_of_a_claim_file_is_decided_as_the_file_is():
    text = Path(EXAMPLE).read_text(encoding="utf-8")
    of_text, of_file = nav.prove(text), nav.prove(EXAMPLE)
    assert [(v.id, v.status) for v in of_text] == [(v.id, v.status) for v in of_file]
    with pytest.raises(nav.NavsymError, match="expected TOML") as caught:
        nav.prove("[[claim]] x")
    assert caught.value.where == "prove: line 1, column 11"


def test_verdicts_are_taken_by_place_id_and_slice():
    verdicts = nav.prove(EXAMPLE)
    first, *rest = verdicts
    assert verdicts[0] is first and verdicts[first.id] is first and [*verdicts[1:]] == rest
    assert type(verdicts[:1]) is type(verdicts) and verdicts[:0].document()["claims"] == []
    for wanted in ("nothing", 1.5, [1]):
        with pytest.raises(nav.NavsymError, match="the id of a part"):
            verdicts[wanted]


X, N, T = sp.Symbol("x"), sp.Symbol("n", integer=True, positive=True), sp.Symbol("T", positive=True)


@pytest.mark.parametrize(
    ("left", "right", "false"),
    [
        (sp.Sum(X, (X, 1, N)), N * (N + 1) / 2, N**2),
        (sp.Product(2, (X, 1, N)), 2**N, 2 ** (N + 1)),
        (sp.Integral(sp.exp(-T * X), (X, 0, sp.oo)), 1 / T, T),
        (sp.Integral(X * T, (X, 0, 1), (T, 0, 2)), 1, 2),
        (sp.Derivative(X**5, (X, 3)), 60 * X**2, 20 * X**3),
        (sp.Limit(sp.sin(X) / X, X, 0, "+-"), 1, 0),
        (sp.Limit((1 + X) / (2 * X), X, -sp.oo), sp.Rational(1, 2), 1),
    ],
)
def test_what_sympy_leaves_to_be_done_is_read_and_decided(left, right, false):
    assert nav.prove(left, "=", right).status == nav.PROVED
    assert nav.prove(left, "=", false).status == nav.REFUTED


@pytest.mark.parametrize(
    ("left", "message"),
    [
        (sp.Integral(X, X), "both ends"),
        (sp.Limit(abs(X) / X, X, 0), "from both sides"),
        (sp.Derivative(sp.Function("f")(X), X), "got f"),
    ],
)
def test_what_sympy_leaves_to_be_done_without_ends_or_values_is_refused(left, message):
    with pytest.raises(nav.NavsymError, match=message):
        nav.prove(left, "=", 1)
    with pytest.raises(nav.NavsymError, match=r"got (Integral|Limit|Derivative)"):
        to_text(left)


def test_a_counterexample_names_every_symbol_of_the_text():
    """What the search cancels has a value there all the same: without it nobody could try the text at the point."""
    assert set(nav.prove("x + y - y > 1", x=("0", "1"), y=("2", "5")).counterexample) == {"x", "y"}


def test_a_counterexample_near_an_end_has_few_digits():
    """A pole at the end of a range was met at a fraction of 300 digits; a few nines show the same."""
    point = nav.prove("tanh(asin(x))/acos(y) > -9588", x=("-1", "0"), y=("-1/2", "1")).counterexample
    assert max(map(len, point.values())) < 45, point
