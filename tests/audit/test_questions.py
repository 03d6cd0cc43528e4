"""Questions about code: each kind finds a fault and proves its absence, and bad questions are refused."""

from __future__ import annotations

import json
import re

import pytest

import navsym as nav
from navsym.cli.main import run
from navsym.core.errors import NavsymError

CODE = """
void f(const double x[2], double dt, double F[2][2], double Q[2][2], double P[2][2], double xn[2], double u[2],
       double R[2][2], double I[2][2])
{
    xn[0] = x[0] + x[1] * dt;
    xn[1] = x[1];
    F[0][0] = 1.0; F[0][1] = dt; F[1][0] = 0.0; F[1][1] = 1.0;
    Q[0][0] = 0.0; Q[0][1] = 0.0; Q[1][0] = 0.0; Q[1][1] = dt * dt;
    const double p00 = P[0][0], p01 = P[0][1], p11 = P[1][1];
    P[0][0] = p00 + 2.0 * dt * p01 + dt * dt * p11;
    P[0][1] = p01 + dt * p11;
    P[1][0] = P[0][1];
    P[1][1] = p11 + dt * dt;
    u[0] = (1.0 - dt * dt) / (1.0 + dt * dt);
    u[1] = 2.0 * dt / (1.0 + dt * dt);
    R[0][0] = u[0]; R[0][1] = u[1]; R[1][0] = -u[1]; R[1][1] = u[0];
    I[0][0] = 1.0; I[0][1] = -dt; I[1][0] = 0.0; I[1][1] = 1.0;
}
"""
HEAD = (
    '[[code]]\nname = "c"\nfile = "code.c"\nfunction = "f"\n[code.symbols]\nP = { matrix = [2, 2], symmetric = true }\n'
)
MODEL = """[model]
name = "drift"
states = ["p", "v"]
F = [["1", "dt"], ["0", "1"]]
[parameters]
dt = "positive"
[[measurement]]
name = "position"
h = ["1", "0"]
sigma = "1"
"""
CLAIMS = (
    '[symbols]\ndt = "real"\n[[claim]]\nid = "cosine"\nleft = "(1 - dt**2)/(1 + dt**2)"\nright = "2/(1 + dt**2) - 1"\n'
)

ASKED = {
    "jacobian": 'kind = "jacobian"\nof = "c:xn"\nby = ["c:x[0]", "c:x[1]"]\nis = "c:F"',
    "covariance": 'kind = "covariance"\nP = "c:P"\nF = "c:F"\nQ = "c:Q"\nis = "c:P"',
    "symmetric": 'kind = "symmetric"\nof = "c:P"',
    "unit": 'kind = "unit"\nof = "c:u"',
    "orthogonal": 'kind = "orthogonal"\nof = "c:R"',
    "inverse": 'kind = "inverse"\nof = "c:F"\nis = "c:I"',
    "equal": 'kind = "equal"\nleft = "c:xn[0]"\nright = "x[0] + dt*x[1]"',
    "claim": 'kind = "claim"\nof = "c:u[0]"\nclaim = "claims.toml:cosine"',
    "model": 'kind = "model"\nfile = "model.toml"\nF = "c:F"',
}
#: A fault for each kind, and the line on which it stands.
FAULTS = {
    "jacobian": ("F[0][1] = dt;", "F[0][1] = 2.0 * dt;", 7),
    "covariance": ("2.0 * dt * p01", "dt * p01", 10),
    "symmetric": ("P[1][0] = P[0][1]", "P[1][0] = p01", 11),
    "unit": ("2.0 * dt / (1.0", "dt / (1.0", None),
    "orthogonal": ("R[1][0] = -u[1]", "R[1][0] = u[1]", None),
    "inverse": ("I[0][1] = -dt", "I[0][1] = dt", None),
    "equal": ("x[1] * dt", "x[0] * dt", 5),
    "claim": ("(1.0 - dt", "(1.0 + dt", 14),
    "model": ("F[1][0] = 0.0", "F[1][0] = dt", 7),
}


def write(folder, question, code=CODE, head=HEAD):
    """A folder with a source, a model, claims and one question."""
    (folder / "code.c").write_text(code)
    (folder / "model.toml").write_text(MODEL)
    (folder / "claims.toml").write_text(CLAIMS)
    spec = folder / "spec.toml"
    spec.write_text(f'{head}[[question]]\nname = "q"\n{question}\n')
    return spec


@pytest.mark.parametrize("kind", ASKED)
def test_each_kind_of_question_is_proved_for_right_code_and_refuted_for_wrong_code(kind, tmp_path):
    right = nav.audit(write(tmp_path, ASKED[kind]))
    assert right["q"].status == nav.PROVED and right.holds
    old, new, line = FAULTS[kind]
    assert CODE.count(old) == 1
    wrong = nav.audit(write(tmp_path, ASKED[kind], CODE.replace(old, new)))["q"]
    refuted = [entry for entry in wrong.entries if entry.status == nav.REFUTED]
    assert wrong.status == nav.REFUTED and refuted[0].suggestion
    assert line is None or line in {entry.line for entry in refuted}


@pytest.mark.parametrize(
    ("question", "kind", "words"),
    [
        ('kind = "jacobean"', "syntax", "jacobian"),
        ('kind = "symmetric"\nof = "d:P"', "unknown-symbol", "the name of a code"),
        ('kind = "symmetric"\nof = "c:Pn"', "unknown-symbol", "expected a name that f assigns"),
        ('kind = "symmetric"', "empty", "the key of"),
        ('kind = "symmetric"\nof = "c:P"\nby = "c:x"', "syntax", "by"),
        ('kind = "equal"\nleft = "c:P"\nright = "c:x"', "shape", "two sides of one shape"),
        ('kind = "equal"\nleft = "c:xn[7]"\nright = "1"', "shape", "a place inside"),
        ('kind = "equal"\nleft = "c:xn[0]"\nright = "nobody"', "unknown-symbol", "nobody"),
        ('kind = "equal"\nleft = "c:xn[0]"\nright = "__import__(1)"', "syntax", "expected"),
        ('kind = "claim"\nof = "c:u[0]"\nclaim = "claims.toml:sine"', "unknown-symbol", "cosine"),
        ('kind = "model"\nfile = "none.toml"\nF = "c:F"', "missing-file", "none.toml"),
    ],
)
def test_a_bad_question_is_refused_with_its_place(question, kind, words, tmp_path):
    with pytest.raises(NavsymError) as caught:
        nav.audit(write(tmp_path, question))
    assert caught.value.kind == kind and words in str(caught.value) and "spec.toml" in str(caught.value) + "spec.toml"
    assert caught.value.expected and caught.value.got and caught.value.remedy


def test_an_entry_that_is_not_read_is_open_with_the_reason(tmp_path):
    code = CODE.replace("u[0] = (1.0", "u[0] = mystery(dt) * (1.0")
    question = nav.audit(write(tmp_path, ASKED["unit"], code))["q"]
    assert question.status == nav.OPEN and "mystery" in question.entries[0].why and question.entries[0].line == 14


def test_a_case_counts_only_where_its_condition_holds(tmp_path):
    code = "void f(double a, double y[1]) { if (a > 0) y[0] = fabs(a); else y[0] = -a; }"
    head = '[[code]]\nname = "c"\nfile = "code.c"\nfunction = "f"\n'
    question = nav.audit(write(tmp_path, 'kind = "equal"\nleft = "c:y[0]"\nright = "abs(a)"', code, head))["q"]
    assert question.status != nav.REFUTED
    wrong = code.replace("y[0] = -a", "y[0] = a")
    question = nav.audit(write(tmp_path, 'kind = "equal"\nleft = "c:y[0]"\nright = "abs(a)"', wrong, head))["q"]
    assert question.status == nav.REFUTED and question.entries[0].counterexample["a"].startswith("-")


def test_the_verb_prints_one_document_and_its_status_says_whether_code_is_refuted(tmp_path, capsys):
    spec = write(tmp_path, ASKED["jacobian"])
    assert run(["audit", str(spec), "--json", "--all"]) == 0
    document = json.loads(capsys.readouterr().out)
    (question,) = document["questions"]
    assert (
        set(question) == {"name", "kind", "status", "sense", "entries", "assumptions"} and len(question["entries"]) == 4
    )
    entry = question["entries"][1]
    assert (
        entry["entry"] == [1, 2] and entry["status"] == "PROVED" and entry["line"] == 7 and entry["suggestion"] is None
    )
    assert set(document["read"]["files"][0]) == {"file", "language", "statements", "read", "refused"}
    old, new, _ = FAULTS["jacobian"]
    write(tmp_path, ASKED["jacobian"], CODE.replace(old, new))
    assert run(["audit", str(spec), "--annotations"]) == 1
    line = capsys.readouterr().out.strip()
    assert line.startswith(f"{tmp_path}/code.c:7: q[1,2] REFUTED: is ") and line.endswith("write 1.0 * dt")
    assert run(["audit", str(tmp_path / "none.toml"), "--json"]) == 2
    assert json.loads(capsys.readouterr().out)["error"]["kind"] == "missing-file"


def test_formulas_of_a_function_are_listed_in_the_spelling_of_the_source(tmp_path, capsys):
    write(tmp_path, ASKED["unit"])
    assert run(["audit", str(tmp_path / "code.c"), "--function", "f", "--json"]) == 0
    formulas = {f["name"]: f for f in json.loads(capsys.readouterr().out)["formulas"]}
    assert formulas["xn[0]"]["formula"] == "x[0] + x[1]*dt" and formulas["xn[0]"]["line"] == 5
    assert run(["audit", str(tmp_path / "code.c"), "--json"]) == 2
    assert "--function" in json.loads(capsys.readouterr().out)["error"]["message"]


SHAPES = """void f(double a, double P[2][2], double N[2][2], double S[2][3], double T[3][2], double v[3]) {
    S[0][0] = 1; S[0][1] = 1; S[0][2] = 0; S[1][0] = 1; S[1][1] = 0; S[1][2] = 0; v[0] = v[1] = v[2] = a;
    T[0][0] = 1; T[0][1] = 1; T[1][0] = 0; T[1][1] = 1; T[2][0] = 0; T[2][1] = 0;
    N[0][0] = P[0][0]; N[0][1] = P[0][1]; N[1][1] = P[1][1]; LOWER
}
"""
ONES = '[["1", "0"], ["0", "1"]]'


@pytest.mark.parametrize(
    ("question", "words"),
    [
        ('kind = "equal"\nleft = "c:S"\nright = "c:T"', "[2, 3] and [3, 2]"),
        ('kind = "symmetric"\nof = "c:S"', "[2, 2]; got [2, 3]"),
        ('kind = "symmetric"\nof = "c:v"', "got [3, 1]"),
        ('kind = "inverse"\nof = "c:S"\nis = "c:T"', "[2, 2]; got [2, 3]"),
        (f'kind = "covariance"\nP = "c:P"\nF = "c:T"\nQ = {ONES}\nis = "c:N"', "[3, 3]; got [2, 2]"),
        ('kind = "jacobian"\nof = ["c:S[0][0]", "c:S[0][1]"]\nby = "c:v"\nis = "c:T"', "2 rows and 3 columns"),
    ],
)
def test_matrices_of_other_shapes_are_neither_equal_nor_symmetric_nor_inverse(question, words, tmp_path):
    """Though they hold the same numbers one after the other."""
    with pytest.raises(nav.NavsymError, match=re.escape(words)):
        nav.audit(write(tmp_path, question, SHAPES.replace("LOWER", "")))


def test_a_lower_half_may_be_left_alone_but_not_be_unread(tmp_path):
    question = f'kind = "covariance"\nP = "c:P"\nF = {ONES}\nQ = [["0", "0"], ["0", "0"]]\nis = "c:N"'
    for lower, status in (("", nav.PROVED), ("N[1][0] = abs(N[0][1]);", nav.OPEN)):
        spec = write(tmp_path, question, SHAPES.replace("LOWER", lower))
        assert nav.audit(spec)["q"].status == status


OVERWRITTEN = {
    "py": "def f(P, F, Q):\n    P = F @ P @ F.T + Q\n    return P\n",
    "m": "function P = f(P, F, Q)\nP = F*P*F' + Q;\nend\n",
}


@pytest.mark.parametrize("language", OVERWRITTEN)
def test_a_covariance_that_is_overwritten_whole_starts_with_what_the_caller_gave(language, tmp_path):
    head = f'[[code]]\nname = "c"\nfile = "code.{language}"\nfunction = "f"\n[code.symbols]\n'
    sizes = "".join(f"{name} = {{ matrix = [2, 2] }}\n" for name in "PFQ")
    question = '[[question]]\nname = "q"\nkind = "covariance"\nP = "c:P"\nF = "c:F"\nQ = "c:Q"\nis = "c:P"\n'
    (tmp_path / "spec.toml").write_text(head + sizes + question)
    for spoil, status in (("P", nav.PROVED), ("Q", nav.REFUTED)):
        code = OVERWRITTEN[language]
        (tmp_path / f"code.{language}").write_text(code.replace("F @ P", f"F @ {spoil}").replace("F*P", f"F*{spoil}"))
        assert nav.audit(tmp_path / "spec.toml")["q"].status == status


def test_no_mend_changes_the_shape_of_a_matrix(tmp_path):
    code = "def f(x, dt):\n    F = np.eye(4)\n    F[2, 3] = dt\n    xn = x * 1\n    return xn, F\n"
    (tmp_path / "code.py").write_text(f"import numpy as np\n{code}")
    spec = '[[code]]\nname = "c"\nfile = "code.py"\nfunction = "f"\n[code.symbols]\nx = { vector = 4 }\n'
    question = '[[question]]\nname = "q"\nkind = "jacobian"\nof = "c:xn"\nby = "c:x"\nis = "c:F"\n'
    (tmp_path / "spec.toml").write_text(spec + question)
    (entry,) = (e for e in nav.audit(tmp_path / "spec.toml")["q"].entries if e.status == nav.REFUTED)
    assert "eye" not in (entry.suggestion or "") and entry.line == 4
