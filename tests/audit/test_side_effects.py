"""What a line that is not read may have written stays unread, whatever name it was written by."""

from __future__ import annotations

import pytest

import navsym as nav

NUMPY = ("P = np.zeros(3)", "P[0] = a")


def ask(folder, body, right="a", of="out[0]", end="cpp"):
    """The verdict on one output."""
    (folder / f"code.{end}").write_text(body)
    head = f'[[code]]\nname = "m"\nfile = "code.{end}"\nfunction = "step"\n'
    (folder / "spec.toml").write_text(f'{head}[[question]]\nkind = "equal"\nleft = "m:{of}"\nright = "{right}"\n')
    return str(nav.audit(folder / "spec.toml").questions[0].status)


def write_cpp(body):
    """A function with a body."""
    return f"void step(float a, float b, float out[3])\n{{\n    {body}\n}}\n"


def write_python(*lines):
    """A function that makes an array with a in its first place."""
    return "\n    ".join(["import numpy as np\n\ndef step(a, b, i):", *NUMPY, *lines, ""])


@pytest.mark.parametrize(
    "body",
    [
        # by a reference or a pointer
        "out[0] = a; float &r = out[0]; r = weird(a);",
        "out[0] = a; float &r = out[0]; r = a << 2;",
        "out[0] = a; float &r = out[0]; r += a << 2;",
        "out[0] = a; float &r = out[0]; if (a << 1) { r = b; }",
        "out[0] = a; float *p = &out[0]; *p = a << 2;",
        "out[0] = a; float *p = &out[0]; p[0] = a << 2;",
        "out[0] = a; float *p = &out[1]; p[-1] = b;",
        # by a target that is no entry
        "out[0] = a; (a > 0 ? out[0] : out[1]) = b;",
        "out[0] = a; *(out + 1 - 1) = b;",
        "out[0] = a; ((float*)out)[0] = b;",
        "out[0] = a; out[int(b)] = b;",
        # inside an expression
        "out[0] = a; out[1] = (out[0] = b << 1);",
        "out[0] = a; out[1] = out[0]++ * 1;",
        "out[0] = a; b += out[0]-- << 1;",
        "out[0] = a; out[2] = (a > 0) ? out[0]++ : 1;",
        "out[0] = a; float y = b << weird(out);",
        # by a function that holds the name
        "out[0] = a; auto f = [&](){ out[0] = b; }; f();",
        "float x = a; auto f = [&](){ x = b; }; x = a; f(); out[0] = x;",
    ],
)
def test_a_write_that_is_not_read_leaves_the_output_open(tmp_path, body):
    assert ask(tmp_path, write_cpp(body)) == "OPEN"


@pytest.mark.parametrize(
    "lines",
    [
        ("Q = P[0:2]", "Q[0] = a << 1", "return P[0]"),
        ("Q = P[0:2]", "Q[i] = b", "return P[0]"),
        ("Q = P[0:2]", "Q += b", "return P[0]"),
        ("Q = P[0:2]", "R = Q[0:1]", "R[0] = b", "return P[0]"),
        ("P[1] = (P := 3)", "return P[0]"),
    ],
)
def test_a_view_of_an_array_is_no_way_around(tmp_path, lines):
    assert ask(tmp_path, write_python(*lines), of="return", end="py") == "OPEN"


@pytest.mark.parametrize(
    ("body", "right"),
    [
        ("float x = a; float &r = x; r = b; out[0] = x;", "b"),
        ("out[0] = a; float &r = out[0]; r = b; r += a;", "a + b"),
        ("out[1] = b << 1; out[0] = a;", "a"),  # another entry
        ("out[0] = a; out[1] = b << 1;", "a"),
    ],
)
def test_what_is_read_is_proved_and_its_false_variant_falls(tmp_path, body, right):
    assert ask(tmp_path, write_cpp(body), right) == "PROVED"
    assert ask(tmp_path, write_cpp(body), f"{right} + 1") == "REFUTED"


def test_a_view_that_nobody_changes_is_read(tmp_path):
    assert ask(tmp_path, write_python("Q = P[0:2]", "return Q[0]"), of="return", end="py") == "PROVED"


@pytest.mark.parametrize(
    ("body", "right", "status"),
    [
        ("v.normalize();", "v(0)/sqrt(v(0)**2 + v(1)**2 + v(2)**2)", "PROVED"),
        ("v.normalize();", "v(0)", "REFUTED"),
        ("v.normalized();", "v(0)", "PROVED"),
        ("v = v.normalize();", "v(0)", "OPEN"),  # it gives nothing in Eigen
        ("v.reverseInPlace();", "v(0)", "OPEN"),
    ],
)
def test_a_method_that_changes_its_vector_changes_it(tmp_path, body, right, status):
    text = (
        f"void step(const Vector3d &v0, float out[3])\n{{\n    Vector3d v = v0;\n    {body}\n    out[0] = v(0);\n}}\n"
    )
    assert ask(tmp_path, text, right.replace("v(", "v0(")) == status


@pytest.mark.parametrize(
    ("call", "status"), [("R.T", "PROVED"), ("R.transpose()", "PROVED"), ("R.transpose(0, 1)", "OPEN")]
)
def test_a_transposition_with_an_order_of_axes_is_not_taken_for_one_without(tmp_path, call, status):
    text = f"def step(a, b, c, d):\n    R = np.array([[a, b], [c, d]])\n    S = {call}\n    return S\n"
    assert ask(tmp_path, f"import numpy as np\n\n\n{text}", "c", "return[0][1]", end="py") == status


@pytest.mark.parametrize(
    "use",
    ["change(L)", "change(L[1:])", "L.fill(a)", "return L", "return (L)[0]", "pair = [L, a]", "M = L.T", "M[1:] = L"],
)
def test_a_list_of_the_module_that_may_be_written_elsewhere_does_not_keep_its_numbers(tmp_path, use):
    head = "import numpy as np\nL = np.array([[1.0, 2.0]]) * 1\nS = np.sqrt(4.0)\ndef change(x):\n    x[0] = 5.0\n"
    code = f"{head}def other(a):\n    {{}}\ndef step(a):\n    return L[0, 1]*a + S\n"
    assert ask(tmp_path, code.format(use), "2*a + 2", "return", "py") != "PROVED"
    assert ask(tmp_path, code.format("return L[0, 0]*np.sum(L)"), "2*a + 2", "return", "py") == "PROVED"
    assert ask(tmp_path, code.format("return change(S)"), "2*a + 2", "return", "py") == "PROVED"
