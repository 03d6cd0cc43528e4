"""What a mapping says of code that stands in other files, and some lines of a long function."""

from __future__ import annotations

import pytest

import navsym as nav
from navsym.core.errors import NavsymError

CODE = """\
#define HALF 1.0f / 2.0f
enum { FIRST, SECOND, LAST = 7, BEHIND };
void step(float x[9], float dt, float A[2][2], float out[3])
{
    const float &rate = x[SECOND];
    int whole = 3;
    LOG("step " << dt);
    for (int i = 0; i < 2; i++) {
        out[i] = square(x[i]) * dt;
        if (dt > 0) {
            out[2] = rate * dt;
        } else {
            out[2] = whole / 2 + x[BEHIND];
        }
    }
    A[0][1] = dt;
    x[OTHER] = HALF * dt;
}
"""


def ask(folder, left, right, mapping="", code=CODE, end="cpp"):
    """The verdict on one output, with the reason where it is open."""
    (folder / f"code.{end}").write_text(code)
    head = f'[[code]]\nname = "m"\nfile = "code.{end}"\nfunction = "step"\n{mapping}\n'
    (folder / "spec.toml").write_text(f'{head}[[question]]\nkind = "equal"\nleft = "m:{left}"\nright = "{right}"\n')
    (entry,) = nav.audit(folder / "spec.toml").questions[0].entries
    return str(entry.status), entry.why


SQUARE = '[code.functions]\nsquare = { of = ["u"], is = "u*u" }'


@pytest.mark.parametrize(
    ("left", "right", "mapping", "status"),
    [
        ("out(0)", "x(0)**2*dt", f"lines = [8, 15]\n[code.symbols]\ndt = 'positive'\n{SQUARE}", "PROVED"),
        ("out(0)", "x(0)*dt", f"lines = [8, 15]\n[code.symbols]\ndt = 'positive'\n{SQUARE}", "REFUTED"),
        ("out(2)", "x(1)*dt", "lines = [11, 11]", "PROVED"),  # the reference of line 5 is kept
        ("out(2)", "x(2)*dt", "lines = [11, 11]", "REFUTED"),
        ("out(1)", "x(1)**2*dt", f"lines = [9, 9]\n[code.constants]\ni = 1\n{SQUARE}", "PROVED"),
        ("A(0, 1)", "dt", "lines = [16, 16]\n[code.symbols]\nA = { matrix = [2, 2], start = 'zero' }", "PROVED"),
        ("A(1, 1)", "1", "lines = [16, 16]\n[code.symbols]\nA = { matrix = [2, 2], start = 'identity' }", "PROVED"),
        ("A(1, 1)", "0", "lines = [16, 16]\n[code.symbols]\nA = { matrix = [2, 2], start = 'identity' }", "REFUTED"),
        ("A(0, 1)", "dt", "ignored = ['LOG']", "PROVED"),
        ("A(0, 1)", "dt", "", "OPEN"),  # LOG may leave the function
        ("out(0)", "x(0)", "ignored = ['LOG']", "OPEN"),
    ],
)
def test_some_lines_are_read_with_what_the_mapping_says(tmp_path, left, right, mapping, status):
    assert ask(tmp_path, left, right, mapping)[0] == status


@pytest.mark.parametrize(
    ("left", "right", "mapping", "why"),
    [
        ("out(2)", "x(8)", "lines = [13, 13]", "integers that are no constants"),  # whole is declared before
        ("x(2)", "dt/2", "lines = [17, 17]\n[code.constants]\nOTHER = 2", "no parentheses"),
        ("out(0)", "x(0)**2*dt", f"lines = [9, 9]\n{SQUARE}", "no constant"),
        ("out(0)", "x(0)**2*dt", "lines = [9, 9]\n[code.constants]\ni = 0", "does not define"),
    ],
)
def test_what_the_lines_do_not_say_stays_unread(tmp_path, left, right, mapping, why):
    status, reason = ask(tmp_path, left, right, mapping)
    assert status == "OPEN" and why in reason


@pytest.mark.parametrize("lines", ["[11, 14]", "[30, 31]", "[9, 3]", "[1]"])
def test_lines_that_cut_a_statement_are_refused(tmp_path, lines):
    with pytest.raises(NavsymError, match=r"lines?\b"):
        ask(tmp_path, "out(0)", "0", f"lines = {lines}")


@pytest.mark.parametrize(
    ("body", "right", "status"),
    [
        ("Vector3f v(a, b, c); out = v.y();", "b", "PROVED"),
        ("Vector3f v(a, b, c); out = v.y;", "b", "PROVED"),
        ("Vector3f v(a, b, c); out = v.y;", "a", "REFUTED"),
        ("Vector3f v(a, b, c); out = v.w();", "a", "OPEN"),
        ("out = R.transpose();", "a", "OPEN"),  # of unknown size: no name of an input
        ("MatrixXd K(a, b); out = K(0);", "a", "OPEN"),  # sizes, not entries
        ("out = M.block<1, 2>(0, 1)(0, 1) * M.noalias()(0, 0);", "a", "OPEN"),
        ("Matrix2f W = Matrix2f::Identity(); W(0, 1) = a; out = W.block<1, 2>(0, 0)(0, 1);", "a", "PROVED"),
        ("Matrix2f W = Matrix2f::Identity(); W(0, 1) = a; out = W.transpose()(0, 1);", "a", "REFUTED"),
        ("Matrix2f W = Matrix2f::Identity(); W(0, 1) = a; out = W.noalias()(0, 1);", "a", "PROVED"),
        ("Matrix<float, 2, 3> W = Matrix<float, 2, 3>::Zero(); W(0, 2) = a; out = W(0, 2);", "a", "PROVED"),
    ],
)
def test_a_vector_has_no_members_of_its_own(tmp_path, body, right, status):
    code = f"void step(float a, float b, float c, float &out)\n{{\n    {body}\n}}\n"
    assert ask(tmp_path, "out", right, code=code)[0] == status


def test_a_function_that_the_mapping_declares_gives_a_vector_that_is_computed_at_once(tmp_path):
    code = "void step(const Vector2f &v, Vector2f &out)\n{\n    Vector2f w = turn(v);\n    out = w;\n}\n"
    mapping = '[code.functions]\nturn = { of = ["a"], is = "{-a(1), a(0)}" }'
    assert ask(tmp_path, "out(0)", "-v(1)", mapping, code)[0] == "PROVED"
    assert ask(tmp_path, "out(1)", "-v(0)", mapping, code)[0] == "REFUTED"


@pytest.mark.parametrize(
    ("mapping", "match"),
    [
        ("[code.constants]\nOTHER = 'two'", "a number"),
        ("[code.functions]\nstep = { of = ['u'], is = 'u' }", "another file"),
        ("[code.functions]\nsquare = { of = ['u'], is = 'u +' }", "an expression"),
        ("[code.symbols]\nA = { matrix = [2, 2], start = 'ones' }", "identity"),
        ("language = 'fortran'", "fortran"),
    ],
)
def test_a_mapping_that_cannot_be_meant_is_refused(tmp_path, mapping, match):
    with pytest.raises(NavsymError, match=match):
        ask(tmp_path, "out(0)", "0", mapping)


def test_a_wrong_version_that_forgets_an_input_is_refuted(tmp_path):
    code = "void step(float q, float r, float &out)\n{\n    out = q;\n}\n"
    assert ask(tmp_path, "out", "q*r", code=code)[0] == "REFUTED"
    with pytest.raises(NavsymError, match="declared name"):
        ask(tmp_path, "out", "q*s", code=code)


def test_names_that_numpy_gives_are_known_where_they_are_imported(tmp_path):
    body = "def step(a, b):\n    return dot(a, b)\n"
    text = f"from numpy import dot\n{body}"
    assert ask(tmp_path, "return", "a*b", code=text, end="py")[0] == "PROVED"
    assert ask(tmp_path, "return", "a*b", code=body, end="py")[0] == "OPEN"


def test_a_row_of_a_block_is_no_column(tmp_path):
    lines = ("P = np.zeros((2, 2))", "P[0, 1] = a", "P[1, 0] = b", "return P[0:2][1]")
    code = "\n    ".join(["import numpy as np\n\ndef step(a, b):", *lines, ""])
    assert ask(tmp_path, "return[0]", "b", code=code, end="py")[0] == "PROVED"
    assert ask(tmp_path, "return[0]", "a", code=code, end="py")[0] == "REFUTED"


def test_a_decimal_stands_for_a_number_that_is_the_same_to_its_last_digits(tmp_path):
    """Without the mapping the question is not proved; a number that is another one is refused."""
    (tmp_path / "a.c").write_text("double f(double x)\n{\n    return x*0.017453292519943295;\n}\n")
    question = '[[question]]\nkind = "equal"\nleft = "a:return"\nright = "x*pi/180"\n'
    answers = []
    for constants in ("", '[code.constants]\n"0.017453292519943295" = "pi/180"\n'):
        code = f'[[code]]\nname = "a"\nfile = "a.c"\nfunction = "f"\n{constants}'
        (tmp_path / "spec.toml").write_text(code + question)
        answers.append(nav.audit(tmp_path / "spec.toml").questions[0].status)
    assert answers[0] != nav.PROVED and answers[1] == nav.PROVED
    (tmp_path / "spec.toml").write_text((code + question).replace('"pi/180"', '"pi/181"'))
    with pytest.raises(nav.NavsymError, match="to its last digit"):
        nav.audit(tmp_path / "spec.toml")


def test_a_counterexample_spells_all_entries_as_the_source_does(tmp_path):
    (tmp_path / "f.m").write_text("function y = f(P)\n  y = P(1,1)*P(1,2);\nend\n")
    head = '[[code]]\nname = "m"\nfile = "f.m"\nfunction = "f"\n[code.symbols]\n'
    head += 'P = { matrix = [2, 2] }\n"P[1, 1]" = "positive"\n'
    (tmp_path / "q.toml").write_text(f'{head}[[question]]\nkind = "equal"\nleft = "m:y"\nright = "P[1, 1]"\n')
    (entry,) = nav.audit(tmp_path / "q.toml").questions[0].entries
    assert {*entry.counterexample} == {"P(1,1)", "P(1,2)"}
