"""Cases: an error computes nothing, a condition that is not read has two ways, and several files are one source."""

from __future__ import annotations

import pytest

import navsym as nav

QUESTION = '[[question]]\nname = "q"\nkind = "equal"\nleft = "code:{}"\nright = "{}"\n'


def ask(tmp_path, source, end, left, right, keys=""):
    """The verdict on one question about the function f of a source."""
    (tmp_path / f"source{end}").write_text(source)
    head = f'[[code]]\nname = "code"\nfile = "source{end}"\nfunction = "f"\n{keys}\n'
    (tmp_path / "spec.toml").write_text(head + QUESTION.format(left, right))
    return nav.audit(tmp_path / "spec.toml")["q"]


RAISING = "def f(a):\n    if a < 0:\n        raise ValueError('negative')\n    return 2*a\n"


@pytest.mark.parametrize(
    ("source", "end"),
    [
        (RAISING, ".py"),
        ("float f(float a) { if (a < 0) { throw 1; } return 2*a; }", ".cpp"),
        ("function y = f(a)\n  if a < 0\n    error('negative');\n  end\n  y = 2*a;\nend\n", ".m"),
        ("fn f(a: f64) -> Result<f64, E> { if a < 0.0 { return Err(E::Negative); } Ok(2.0*a) }", ".rs"),
    ],
)
def test_a_way_that_ends_in_an_error_computes_nothing(tmp_path, source, end):
    left = "y" if end == ".m" else "return"
    assert ask(tmp_path, source, end, left, "2*a").status == nav.PROVED
    assert ask(tmp_path, source, end, left, "3*a").status == nav.REFUTED


def test_a_function_that_always_ends_in_an_error_proves_nothing(tmp_path):
    question = ask(tmp_path, "def f(a):\n    b = a\n    raise ValueError('no')\n", ".py", "b", "a")
    assert question.status == nav.OPEN and "ends in an error" in question.entries[0].why


DARK = "float f(float a, float b) {{ float y = b*a; if (strange(a)) {{ y = {}; }} return y; }}"


def test_both_ways_of_a_condition_that_is_not_read_have_to_hold(tmp_path):
    assert ask(tmp_path, DARK.format("a*b"), ".c", "return", "a*b").status == nav.PROVED
    wrong = ask(tmp_path, DARK.format("a+b"), ".c", "return", "a*b")
    assert wrong.status == nav.OPEN and "a condition that is not read: strange(a)" in wrong.entries[0].why


def test_a_point_that_nobody_can_place_in_a_case_refutes_nothing(tmp_path):
    source = "float f(float a) { if (strange(a)) { return a; } return 2*a; }"
    for right in ("a", "2*a", "3*a"):
        assert ask(tmp_path, source, ".c", "return", right).status == nav.OPEN


def test_an_unread_condition_is_not_the_same_in_two_sources(tmp_path):
    (tmp_path / "one.c").write_text("float f(float a) { if (strange(a)) { return a; } return -a; }")
    code = '[[code]]\nname = "{}"\nfile = "one.c"\nfunction = "f"\n'
    question = '[[question]]\nname = "q"\nkind = "equal"\nleft = "one:return"\nright = "two:return"\n'
    (tmp_path / "spec.toml").write_text(code.format("one") + code.format("two") + question)
    assert nav.audit(tmp_path / "spec.toml")["q"].status == nav.OPEN


def test_a_copy_that_a_function_changes_is_not_the_callers(tmp_path):
    head = "float g(Vector3f v) { v(0) = 0; return v(1); }\nfloat h(const Vector3f &v) { return v(1); }\n"
    source = head + "float f(Vector3f v) { float w = g(v) + h(v); return v(0) + w; }"
    assert ask(tmp_path, source, ".cpp", "return", "v[0] + 2*v[1]").status == nav.PROVED
    assert ask(tmp_path, source, ".cpp", "return", "2*v[1]").status == nav.REFUTED


def test_the_larger_of_two_numbers_is_two_cases(tmp_path):
    source = "float f(float a) { return fmaxf(a, 0)*fminf(a, 0) + fmaxf(2, 1) - 2; }"
    assert ask(tmp_path, source, ".c", "return", "0").status == nav.PROVED
    assert ask(tmp_path, source, ".c", "return", "a").status == nav.REFUTED


def test_functions_of_other_files_are_read_where_they_lie(tmp_path):
    (tmp_path / "skew.m").write_text("function S = skew(v)\n  S = [0 -v(3) v(2); v(3) 0 -v(1); -v(2) v(1) 0];\nend\n")
    (tmp_path / "both.m").write_text("function [s, d] = both(a, b)\n  s = a + b;\n  d = later(a - b);\nend\n")
    source = "function y = f(v, w)\n  [s, d] = both(v, w);\n  y = skew(s)*w;\nend\n"
    keys = 'also = ["skew.m", "both.m"]\n[code.symbols]\nv = { vector = 3 }\nw = { vector = 3 }'
    assert ask(tmp_path, source, ".m", "y(1)", "v[2]*w[3] - v[3]*w[2]", keys).status == nav.PROVED
    open_ = ask(tmp_path, source, ".m", "d", "0", keys).entries[0]
    assert (open_.file.rpartition("/")[2], open_.line) == ("both.m", 3)


def test_a_preprocessor_that_knows_its_names_reads_one_way(tmp_path):
    source = "float g(float a)\n#ifdef TWICE\n{ return 2*a; }\n#else\n{ return a; }\n#endif\n"
    source = "#ifdef TWICE\nfloat g(float a) { return 2*a; }\n#else\nfloat g(float a) { return a; }\n#endif\n"
    source += "float f(float a) {\n#ifndef TWICE\n a = 5*a;\n#endif\n return g(a);\n}\n"
    assert ask(tmp_path, source, ".c", "return", "2*a", 'defined = ["TWICE"]').status == nav.PROVED
    assert ask(tmp_path, source, ".c", "return", "5*a", "defined = []").status == nav.PROVED
    assert ask(tmp_path, source, ".c", "return", "5*a").status == nav.OPEN


def test_what_the_preprocessor_surely_leaves_out_is_not_read(tmp_path):
    left_out = "#if 0\ntypedef int real;\n#define K 7\nfloat g(float a) { return 7*a; }\n#elif 1\n#define K 2\n#endif\n"
    source = (
        left_out + "/*\n#if 0\n*/\nfloat f(float a) { float s = '\"';\n#ifdef K\n s = K*a;\n#endif\n return %s; }\n"
    )
    assert ask(tmp_path, source % "s", ".c", "return", "2*a").status == nav.PROVED
    assert "g, which this file does not define" in ask(tmp_path, source % "g(a)", ".c", "return", "7*a").entries[0].why
    last = "#if 0\n#elifdef X\n#define K 3\n#else\n#define K 4\n#endif\n"
    last += 'const int n = sizeof(R"(\n#if 0\n)"); // \\\n#if 0\n'
    last += "float f(float a) { return K*a; }\n"
    assert ask(tmp_path, last, ".c", "return", "4*a", "defined = []").status == nav.PROVED
    assert ask(tmp_path, last, ".c", "return", "4*a").status == nav.OPEN
    doubtful = "#ifdef X\n#define K 1\n#endif\nfloat f(float a) {\n#ifndef K\n a = 5*a;\n#endif\n return a; }\n"
    assert ask(tmp_path, doubtful, ".c", "return", "5*a").status == nav.OPEN
    assert ask(tmp_path, doubtful, ".c", "return", "a", 'defined = ["X"]').status == nav.PROVED


@pytest.mark.parametrize("value", ["SQUARE(3)", "later()", "&x"])
def test_a_constant_that_is_not_read_leaves_the_others_as_they_are(tmp_path, value):
    source = f"#define SQUARE(x) ((x)*(x))\nconst double L = 2;\nconst double K = {value};\nconst double M = K;\n"
    code = source + "double f(double a) { return %s*a; }\n"
    assert ask(tmp_path, code % "L", ".c", "return", "2*a").status == nav.PROVED
    for name in "KM":
        assert ask(tmp_path, code % name, ".c", "return", "9*a").status == nav.OPEN


def test_a_way_that_excludes_itself_is_no_case(tmp_path):
    source = "float f(float a, float b) {{ if ({}) {{ if ({}) return 7; }} return a; }}"
    for outer, inner in (("a > 3", "a < -3"), ("a - b < 0", "2*b <= 2*a"), ("a == 2", "a != 2"), ("a > 1", "!(a > 1)")):
        assert ask(tmp_path, source.format(outer, inner), ".c", "return", "a").status == nav.PROVED
    for outer, inner in (("a > 3", "a > -3"), ("a - b < 0", "b >= a"), ("a >= 3", "a <= 3"), ("a > b", "a > -b")):
        assert ask(tmp_path, source.format(outer, inner), ".c", "return", "a").status == nav.REFUTED
    ranged = source.format("a <= b", "a < 0")
    assert ask(tmp_path, ranged, ".c", "return", "a", '[code.symbols]\na = "positive"').status == nav.PROVED
    assert ask(tmp_path, ranged, ".c", "return", "a", '[code.symbols]\na = "nonzero"').status == nav.REFUTED


def test_a_mapping_replaces_a_function_of_the_file_only_when_it_says_so(tmp_path):
    source = "float g(float x) { long i = *(long*)&x; return i; }\nfloat f(float a) { return a*g(a*a); }"
    keys = '[code.functions]\ng = { of = ["x"], is = "1.0f/x"%s }\n[code.symbols]\na = "positive"'
    assert ask(tmp_path, source, ".c", "return", "1/a", keys % ", replace = true").status == nav.PROVED
    with pytest.raises(nav.NavsymError, match="replace = true"):
        ask(tmp_path, source, ".c", "return", "1/a", keys % "")


def test_a_member_beside_a_parameter_of_the_same_name_is_not_that_parameter(tmp_path):
    source = "void f(float x, float &y) { this->x = 2*x; y = x; }"
    assert ask(tmp_path, source, ".cpp", "y", "2*x").status == nav.OPEN
    clear = "void f(float z, float &y) { this->x = 2*z; y = x; }"
    assert ask(tmp_path, clear, ".cpp", "y", "2*z").status == nav.PROVED


def test_a_local_of_python_is_asked_for_where_it_has_a_value_and_a_member_everywhere(tmp_path):
    source = "def f(a):\n    if a > 0:\n        {0} = 2*a\n    return a\n"
    assert ask(tmp_path, source.format("b"), ".py", "b", "2*a").status == nav.PROVED
    assert ask(tmp_path, source.format("b"), ".py", "b", "3*a").status == nav.REFUTED
    assert ask(tmp_path, source.format("self.b"), ".py", "self.b", "2*a").status == nav.OPEN
