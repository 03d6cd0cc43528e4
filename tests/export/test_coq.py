"""Statements for Coq: the theorem says what the statement says, and Coq proves true ones and no false one."""

from __future__ import annotations

import contextlib
import json
import random
import re
import shutil
from pathlib import Path

import pytest

import navsym as nav
from navsym import checker
from navsym.core.errors import DomainError, MissingEngineError
from navsym.export import processes, replay
from navsym.export.coq.theory import write_theory

needs_coq = pytest.mark.skipif(shutil.which("coqc") is None, reason="no coqc on this machine")


def certificate(left, relation, right, symbols=None, kind="proof", **more):
    """A certificate with this statement; its proof does not matter here."""
    statement = {"left": left, "relation": relation, "right": right, "symbols": symbols or {}, "exists": []}
    statement["tolerance"] = more.pop("tolerance", None)
    return {"kind": kind, "statement": statement, **more}


def theorem(*args, **keys):
    """The theorem of a statement, without its script."""
    text = write_theory(certificate(*args, **keys))
    return next(line for line in text.splitlines() if line.startswith("Theorem"))[len("Theorem statement_1 : ") :]


REAL = [None, None, []]
WHOLE = {"integer": ["1", "oo"]}


def test_ranges_and_what_has_to_be_defined_are_conditions():
    said = theorem("sqrt(x)/y", "<=", "1", {"x": ["0", "2", ["open-high"]], "y": [None, None, ["nonzero"]]})
    assert said == "forall (x y : R), 0 <= x -> x < 2 -> y <> 0 -> x >= 0 -> y <> 0 -> sqrt (x) / y <= 1."


def test_a_counterexample_denies_the_whole_statement():
    said = theorem("x", "=", "1", {"x": REAL}, kind="counterexample", point={"x": "2"})
    assert said == "~ (forall (x : R), x = 1)."


def test_a_tolerance_is_two_bounds():
    assert (
        theorem("pi", "=", "3.14", tolerance="0.005")
        == "(157 / 50) + (- 1) * PI <= 1 / 200 /\\ PI + ((- 157) / 50) <= 1 / 200."
    )


def test_names_that_mean_something_in_coq_get_another():
    said = theorem("PI*R*match", "=", "R_", {name: REAL for name in ("PI", "R", "R_", "match")})
    assert said == "forall (PI_ R__ R_ match_ : R), PI_ * R__ * match_ = R_."


@pytest.mark.parametrize(
    ("text", "why"), [("x**(1/3)", "no square root"), ("atan2(x, 1)", "atan2"), ("x**2000", "beyond 1000")]
)
def test_what_has_no_counterpart_is_not_written(text, why):
    with pytest.raises(DomainError, match=why):
        write_theory(certificate(text, "=", "x", {"x": ["1", "2", []]}))
    with pytest.raises(DomainError, match="one of kind gap"):
        write_theory({"kind": "gap"})


def test_a_machine_without_coq_says_how_to_get_it(monkeypatch, tmp_path):
    file = tmp_path / "c.json"
    file.write_text(json.dumps(nav.prove("x = x").certificate))
    monkeypatch.setattr(replay, "coq_version", lambda: None)
    with pytest.raises(MissingEngineError, match="libcoq-interval"):
        nav.check(file, kernel="coq")
    with pytest.raises(DomainError, match="expected one of coq"):
        nav.check(file, kernel="lean")
    assert "kernel" not in nav.check(file).document()["checked"][0]


def test_vectors_cases_and_hypotheses_are_theorems_of_their_entries():
    language = {"shapes": {"u": [["u1"], ["u2"]]}, "given": ["x >= 0"], "rates": {}}
    item = certificate("u*x", "=", "x*u", {name: REAL for name in ("u1", "u2", "x")})
    item["statement"] |= language
    text = write_theory(item)
    assert "(x u1, x u2" not in text and "x >= 0 -> u1 * x = x * u1 /\\ " in text
    item["statement"] |= {"left": "max(x, 1)", "right": "max(1, x)"}
    names = [line.split()[1] for line in write_theory(item).splitlines() if line.startswith("Theorem")]
    assert names == ["statement_1_1", "statement_1_2", "statement_1_3"]


def language(**more):
    """What the second reader of the checker has beside a plain statement."""
    return {"shapes": {}, "given": [], "rates": {}, **more}


def test_derivatives_and_integrals_stand_in_the_theorem_as_they_are_printed():
    item = certificate("diff(log(x)*y, x, 2)", "=", "-y/x**2", {"x": REAL, "y": REAL})
    item["statement"] |= language()
    text = write_theory(item)
    assert "Derive (fun x : R => Derive (fun x : R => ln (x) * y) x) x = ((- 1) * y) / (x ^ 2)." in text
    assert "x > 0 -> " in text
    text = write_theory(nav.prove("integral(exp(-b*x)*y, x, 0, oo) = y/b", b="positive").certificate)
    answer = nav.prove("integral(R*R_, R_, 0, 1) = R/2")
    assert "RInt (fun R__ : R => R_ * R__) (0) (1) = R_ / 2." in write_theory(answer.certificate)
    assert "RInt_gen (fun x : R => exp (((- 1) * b) * x) * y) (at_point (0)) (Rbar_locally p_infty) = y / b." in text


def test_finite_sums_and_products_stand_in_the_theorem_and_infinite_ones_do_not():
    text = write_theory(nav.prove("sum(2*i - 1, i, 1, n)*product_over = n**2*product_over", n=WHOLE).certificate)
    assert "sum_over (fun i : R => 2 * i + (- 1)) (1) (n)) * product_over_ = (n ^ 2) * product_over_." in text
    text = write_theory(nav.prove("product((i + 1)/i, i, 1, n) = n + 1", n=WHOLE).certificate)
    assert "1 <= n -> product_over (fun i : R => (i + 1) / i) (1) (n) = n + 1." in text
    with pytest.raises(DomainError, match="sum of this kind"):
        write_theory(nav.prove("sum(1/(i*(i + 1)), i, 1, oo) = 1").certificate)


@pytest.mark.parametrize(
    ("left", "says"),
    [
        ("dot_(x*y)", "Derive (fun time : R => (x + time * (v)) * (y + time * (x))) 0 = v."),
        (
            "dot_(diff(x*y, x))",
            "Derive (fun time : R => Derive (fun x_ : R => x_ * (y + time * (x))) (x + time * (v))) 0 = v.",
        ),
        (
            "dot_(dot_(y))",
            "Derive (fun time : R => Derive (fun time_ : R => y + time * (x) + time_ * (x + time * (v))) 0) 0 = v.",
        ),
        ("diff(x*y, x)*time", "(Derive (fun x : R => x * y) x) * time = v."),
    ],
)
def test_a_derivative_by_time_moves_all_symbols_that_are_typed(left, says):
    """Also a symbol that the derivative inside is without; no variable has the name of a symbol that stands there."""
    item = certificate(left, "=", "v", {name: REAL for name in ("x", "y", "v", "time")[: 4 if "time" in left else 3]})
    item["statement"] |= language(rates={"x": "v", "y": "x"})
    assert says in write_theory(item)


def condition(lower, upper, outside=0, **changes):
    """The condition number of [[3, 0], [4, 5]]/10, which is 3; with columns of unit length it is 3, too."""
    rows = [["3/10", "0"], ["2/5", "1/2"]]
    statement = {"matrix": rows, "unit": 0, "lower": lower, "upper": upper} | changes
    brackets = ["4499/10000", "4501/10000", "499/10000", "501/10000"]
    if statement["unit"]:
        brackets = ["1799/1000", "1801/1000", "199/1000", "201/1000"]
    item = {"kind": "condition", "statement": statement, "outside": outside, "brackets": brackets, "bits": 64}
    assert checker.check(item) == "condition"
    return item


def test_a_condition_number_is_stated_for_whole_numbers():
    text = write_theory(condition("2.9", "3.1", unit=1))
    assert "Definition matrix_statement_1 : list (list Z) := [[3; 0]; [4; 5]]%Z." in text
    says = "within matrix_statement_1 (column_squares matrix_statement_1) (29 / 10) (31 / 10)."
    assert f"Theorem statement_1 : {says}" in text and "the matrix times 10 follows" in text
    assert "beyond matrix_statement_1 (ones matrix_statement_1)" in write_theory(condition("4", "5", 1))


def test_a_theorem_on_matrices_of_any_size_has_their_letters_and_the_inverses_that_exist():
    matrices = {"P": {"matrix": ["n", "n"], "positive": True}, "K": {"matrix": ["n", 1]}, "h": {"matrix": [1, "n"]}}
    item = nav.prove("inv(P) @ K*(h @ K) = inv(P) @ K @ h @ K", **matrices).certificate
    says = next(line for line in write_theory(item).splitlines() if line.startswith("Theorem"))
    letters = "forall (n : nat) (K : mat n 1) (P : mat n n) (h : mat 1 n) (inv__P : mat n n)"
    assert says.startswith(f"Theorem statement_1 : {letters}, turn P = P -> P [*] inv__P = unit -> ")
    assert says.endswith("(number (h [*] K)) [.] (inv__P [*] K) = inv__P [*] K [*] h [*] K.")
    ridge = nav.book["ridge-dual"].prove().certificate
    says = next(line for line in write_theory(ridge).splitlines() if line.startswith("Theorem"))
    assert "inv__arg__text2 [*] (H [*] (turn H) [+] (alpha) [.] unit) = unit -> " in says
    assert says.endswith("inv__arg__text0 [*] (turn H) = turn H [*] inv__arg__text2.")
    assert "inv__R_ [*] R_ = unit" in write_theory(json.loads(json.dumps(item).replace("P", "R")))
    with pytest.raises(DomainError, match="a trace"):
        write_theory(nav.prove("trace(P) = trace(P.T)", P={"matrix": ["n", "n"]}).certificate)


def test_a_root_of_a_positive_number_is_an_exponential():
    assert theorem("2*3**(1/4)", "<=", "3") == "2 * (exp (1 / 4 * ln 3)) <= 3."


def test_equations_that_are_given_come_with_the_cofactors_of_the_certificate():
    answer = nav.prove("(x + y)**2 = 2*x*y + 1", given=["x**2 + y**2 = 1"])
    text = write_theory(answer.certificate)
    assert "rewrite ?Z; clear Z end." in text and "transitivity (" in text


@pytest.mark.parametrize(
    ("left", "why"),
    [
        ("E(x)", "an order or a moment"),
        ("floor(x)", "whole part"),
        ("integral(y, y, 0, x)", "without an answer"),
        ("diff(x**2, z)", "no symbol of the statement"),
        ("integral(diff(x*y, x), y, 0, 1)", "a derivative inside|without an answer"),
    ],
)
def test_what_the_reader_of_the_checker_computes_is_not_written(left, why):
    item = certificate(left, "=", "x", {"x": REAL})
    item["statement"] |= {"shapes": {}, "given": [], "rates": {}}
    with pytest.raises(DomainError, match=why):
        write_theory(item)


def test_a_finite_sum_of_derivatives_is_written_term_by_term():
    item = certificate("sum(diff(x**2, x)*k, k, 1, 2)", "=", "x", {"x": REAL})
    item["statement"] |= {"shapes": {}, "given": [], "rates": {}}
    slope = "(Derive (fun x : R => x ^ 2) x)"
    assert f"forall (x : R), 0 + {slope} * 1 + {slope} * 2 = x." in write_theory(item)


#: Of the book: roots of quotients, absolute values, slopes of tangents, exponentials that fall, sums and products.
ONCE_NOT = "potter-square-root code-discriminator-early-late vertical-sextant-angle laplace-of-parabola".split()
ONCE_NOT += ["sum-of-centred-squares", "running-mean-product", "arctangent-integral"]
#: Bounds by slopes, squares, discriminants and the roots of quotients.
ONCE_NOT += "tangent-above-angle kullback-leibler bhattacharyya cauchy-schwarz importance-weights-two".split()


@needs_coq
@pytest.mark.long
def test_coq_proves_what_the_checker_accepts(tmp_path):
    answers = [
        nav.prove("sin(3*a)/sin(a) = 4*cos(a)**2 - 1"),
        nav.prove("sqrt(8)*x/(x**2 - x) = 2*sqrt(2)/(x - 1)"),
        nav.prove("exp(2*x + y)/exp(x) = exp(x)*exp(y)", y=("0", "1")),
        nav.prove("sin(x)*exp(x) <= 23/10", x=("0", "1")),
        nav.prove("sin(x) = x*cos(x)"),
        nav.prove("cross(u, v) = -cross(v, u)", u={"vector": 3}, v={"vector": 3}),
        nav.prove("x*y >= 0", given=["x >= 0", "y >= 0"]),
        nav.prove("(x + y)**2 = 2*x*y + 1", given=["x**2 + y**2 = 1"]),
        nav.prove("2*cos(s/2 + pi/4)**2 = 1 - sin(s)"),
        nav.prove("diff(sqrt(x)*sin(y), x, 2) = -sin(y)/(4*x*sqrt(x))"),
        nav.prove("diff(x**3, x) = 2*x**2"),
        nav.prove("cosh(x)**2 - sinh(x)**2 = 1"),
        nav.prove("integral(x*sin(x), x, 0, t) = sin(t) - t*cos(t)"),
        nav.prove("integral(x*exp(-x), x, 0, oo) = 1"),
        nav.prove("sqrt(6)*x = sqrt(2)*sqrt(3)*x"),
        *(
            nav.book[name].prove()
            for name in ("transport-rate", "mercator-ellipsoid", "unscented-covariance", "joseph", *ONCE_NOT)
        ),
    ]
    for place, answer in enumerate(answers):
        (row,) = nav.check(answer, kernel="coq", out=tmp_path / str(place))
        assert row.kernel is not None and row.kernel.status == "PROVED", (answer, row)
        assert any("sig_forall_dec" in axiom for axiom in row.kernel.axioms)
        assert "Theorem statement_1" in (tmp_path / str(place) / "certificate-1.v").read_text()


@needs_coq
@pytest.mark.long
def test_coq_proves_condition_numbers_and_no_other_ones(tmp_path):
    """Each of the four statements, and no wrong end in its place: the script fits, the numbers do not."""
    true = [condition("2.9", "3.1"), condition("2.9", "3.1", unit=1), condition("4", "5", 1), condition("1", "2", 1)]
    for place, item in enumerate(true):
        assert replay.replay(item, tmp_path / f"{place}.v").status == "PROVED", item
    text = write_theory(true[0])
    for old, new in (("31 / 10", "29 / 10"), ("29 / 10", "31 / 10"), ("[4; 5]]", "[4; 6]]")):
        forged = text.replace(old, new).replace(f"({old.split(' ')[0]}) (10)", f"({new.split(' ')[0]}) (10)")
        assert forged != text
        (tmp_path / "forged.v").write_text(forged)
        assert processes.run(["coqc", "-q", "forged.v"], tmp_path)[0] != 0, old


@needs_coq
@pytest.mark.long
def test_coq_proves_no_false_statement(tmp_path):
    """Statements that the checker would refuse, written for Coq all the same."""
    box = {"x": ["0", "1", []]}
    false = [
        certificate("sin(2*x)", "=", "2*sin(x)", box),
        certificate("x/x", "=", "x", {"x": REAL}),
        certificate("sqrt(x**2)", "=", "x", {"x": REAL}),
        certificate("x**2", ">=", "x", box),
        certificate("x", ">=", "0", box, kind="counterexample", point={"x": "1/2"}),
        certificate("x", "<=", "0", box, kind="counterexample", point={"x": "2"}),
        certificate("diff(sqrt(x), x)", "=", "1/sqrt(x)", {"x": REAL}),
        certificate("diff(x*y, x, 2)", "=", "y", {"x": REAL, "y": REAL}),
        certificate("dot_(x*y)", "=", "v*x", {"x": REAL, "y": REAL, "v": REAL}),
        nav.prove("integral(x, x, 0, 1) = 1/2").certificate,
        nav.prove("A @ B + A = A @ (B + eye(n))", A={"matrix": ["n", "n"]}, B={"matrix": ["n", "n"]}).certificate,
        certificate("diff(x**3, x)", "=", "3*x**2", {"x": REAL}, kind="counterexample", point={"x": "2"}),
        nav.prove("sum(i, i, 1, n) = n*(n + 1)/2", n=WHOLE).certificate,
        nav.prove("product((i + 1)/i, i, 1, n) = n + 1", n=WHOLE).certificate,
    ]
    bounds = [nav.book[name].prove().certificate for name in ("cosine-parabola", "geometric-mean-inequality")]
    false += json.loads(json.dumps(bounds))
    false[-2]["statement"]["right"] = "1 - s**2/3"
    false[-1]["statement"]["right"] = "(w1 + w2)/3"
    for item in false[6:9] + false[11:12]:
        item["statement"] |= language(rates={"x": "v"} if "dot_" in item["statement"]["left"] else {})
    false[9]["statement"]["right"] = "1/3"
    false[10]["statement"]["right"] = "B @ A + A"
    false[12]["statement"]["right"] = "n*(n - 1)/2"
    false[13]["statement"]["right"] = "n"
    for place, forged in enumerate(false):
        assert replay.replay(forged, tmp_path / f"{place}.v").status == "FAILED", forged


@needs_coq
@pytest.mark.slow
def test_coq_proves_no_forgery(tmp_path):
    """A thousand forgeries of the campaign against both checkers, those among them that are written for Coq."""
    from tests.checker.test_ocaml_checker import list_forgeries, read_ledger, read_page

    def say(item):
        return json.dumps(item["statement"], sort_keys=True)

    honest = {say(item) for item in [*read_ledger(), *read_page()[0]] if "statement" in item}
    rows = []
    for text in list_forgeries(random.Random(1000), 10_000):
        with contextlib.suppress(ValueError, checker.Refused, DomainError, RecursionError):
            item = checker.load(text)
            if say(item) in honest:  # it is damaged elsewhere: what it says is true, and Coq may prove it
                continue
            rows.append(replay.replay(item, tmp_path / "forged.v"))
            assert rows[-1].status != "PROVED", text
        if sum(row.status == "FAILED" for row in rows) == 1000:
            return
    raise AssertionError(f"only {len(rows)} of the forgeries are theories")


def read_kept():
    """The kept certificates by the keys of their statements, in order, and these keys by the names of the verdicts."""
    kept = json.loads(Path("derivations/certificates.json").read_text("utf-8"))
    claims = json.loads(Path("derivations/verdicts.json").read_text("utf-8"))["claims"]
    return {key: kept[key]["certificate"] for key in sorted(kept)}, {row["id"]: row["statement"] for row in claims}


@pytest.mark.long
def test_what_the_ledger_keeps_is_written_or_has_a_listed_reason():
    listed = re.compile("one of kind observability;|an integral that fails|a theory of at most")
    for key, item in read_kept()[0].items():
        try:
            assert "Print Assumptions all." in write_theory(item), key
        except DomainError as reason:
            assert listed.search(reason.message), (key, reason)


@needs_coq
@pytest.mark.long
@pytest.mark.parametrize(
    "name",
    [
        "guaranteed_velocity:range.y3",  # a cosine that reaches its bound at an end
        "trajectory:limit.motion.3.older",  # a polynomial that touches its bound: squares of its factors
        "trajectory:limit.motion.3.youngest",
        "guaranteed_velocity:4.11.nonzero-beyond",  # not 0, by its sign: a product of sines on half a turn
        "guaranteed_velocity:4.13.y3",  # absolute values by the signs of what they are of
        "multistructure:1.nonlinear",  # a second derivative at a point of nine symbols
        "trajectory:1.degree",  # derivatives inside of derivatives inside of others
        "terrain_search:sigmaV.unit*",  # a root that is a value by its square
        "guaranteed_velocity:4.6.same-instants",  # a sine of half a turn below a line
        "joint_correction:1.8.inverse.any",  # matrices of any size with inverses, and an equation between them
        "joint_correction:1.6.kalman_unique.any",  # transposed ones that are given as equal
        "joint_correction:1.6.error.any",  # products of one row and one column are numbers
        "trajectory:limit.yawing",  # fourth roots
        "guaranteed_velocity:range.y2.end*",  # sines beyond half a turn
        "multistructure:near*",  # a bound by cones
    ],
)
def test_coq_proves_what_it_once_did_not(name, tmp_path):
    kept, keys = read_kept()
    row = replay.replay(kept[keys[name]], tmp_path / "theory.v")
    assert row.status == "PROVED", row


@needs_coq
@pytest.mark.long
def test_coq_proves_a_sample_of_the_ledger(tmp_path):
    """The ten smallest keys with theories of a moderate size; among them a product of two bounds by cones."""
    sample = []
    for item in read_kept()[0].values():
        with contextlib.suppress(DomainError):
            sample += [item] * (len(write_theory(item)) < 20_000)
        if len(sample) == 10:
            break
    rows = [replay.replay(item, tmp_path / f"{k}.v") for k, item in enumerate(sample)]
    assert len(rows) == 10 and all(row.status == "PROVED" for row in rows), rows
