"""What a source means on symbols is what it computes when it is run; everything else is refused, never guessed."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from navsym.audit.execute import read_function
from navsym.audit.mend import evaluate
from navsym.audit.names import Names
from navsym.audit.sources import find_function, load_unit
from navsym.audit.values import Array, Scalar, Unread

GALLERY = Path(__file__).resolve().parents[2] / "examples" / "audit" / "gallery"


def read(tmp_path, text, name="f", end=".c", shapes=None):
    """The cases of a function in a text, with the table of its names."""
    path = tmp_path / f"source{end}"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    unit, names = load_unit(path), Names()
    reading = read_function(unit, find_function(unit, name, ""), names.symbol, shapes)
    return SimpleNamespace(cases=reading.cases, refused=reading.refused, names=names)


def final(result, name, *place, case=0):
    """What a name holds at the end: a text, or the reason why it is not read."""
    variable = result.cases[case].variables[name]
    cell = variable.all_unread or variable.cells.get(place)
    return cell.why if isinstance(cell, Unread) else result.names.show(repr(cell.tree)[1:-1])


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("y = 1/2 + a;", "a"),
        ("y = 7/2*a;", "3*a"),
        ("y = 1.0f/2 + a;", "1/2 + a"),
        ("y = (float)1/2;", "1/2"),
        ("int n = 5; y = n/2*a;", "2*a"),
        ("y = a; { float a = 2; y += a; } y += a;", "a + 2 + a"),
        ("float b = a; const float *p = &b; b = 3*a; y = *p;", "3*a"),
        ("float b = a; float &r = b; r = 2*a; y = b;", "2*a"),
        ("float v[2] = {a}; y = v[0] + v[1];", "a"),
        ("for (int i = 3; i > 0; i--) y += i*a;", "y + 3*a + 2*a + a"),
        ("y = a > 0 ? SCALE*a : 0;", "2*a"),
        ("y = a - 1e-3;", "a - 1/1000"),
        ("y = power(a, 2);", "the function power, which this file does not define"),
        ("y = SQUARE(a);", "SQUARE: a macro with arguments"),
        ("y = a % 2;", "a quotient or remainder of integers that are no constants"),
        ("y = (int)a;", "a real number cut to an integer"),
        ("float b; y = b;", "b has no value there"),
        ("y = 0x10;", "the number 0x10"),
        ("y = 010;", "an octal number"),
        ("y = a ^ 2;", "the operator ^"),
        (
            "y = a; if (a > 0) goto end; y = 0; end: return;",
            "a statement outside the language of audit (goto statement)",
        ),
        ("y = a; change(&y);", "the function change, which this file does not define"),
        ("y = a; if (mystery(a)) return; y = 0;", "a"),  # in the case in which it returns
        ("y = a; if (mystery(&y)) return; y = 0;", "the function mystery, which this file does not define"),
        ("y = fmaxf(a, 2);", "a"),
        ("auto n = 5; y = n/2*a;", "2*a"),
        ("y = a; if (a < 0) { throw 1; }", "a"),
        (
            "y = a; for (int i = 0; i < 2; i++) { if (a > i) break; y = 0; }",
            "a statement outside the language of audit (break statement)",
        ),
        ("y = a; RETURN_IF(a); y = 0;", "the function RETURN_IF, which this file does not define"),
        ("y = a; switch (1) { case 1: y = 0; }", "0"),
        ("y = a; switch (3) { case 1: y = 0; break; case 3: y = 2; default: y += a; }", "2 + a"),
        ("y = a;\n#if ONE\n y = 0;\n#endif\n", "a statement outside the language of audit (preproc if)"),
        (
            "static float s = 1; s = 2*s; y = s;",
            "a variable that keeps its value between calls, or is changed elsewhere",
        ),
        ("static const float s = 3; y = s*a;", "3*a"),
        ("y = a; while (y > 0) { y -= 1; }", "a loop that does not count from one constant to another"),
        ("y = a; for (int i = 3; i > 0; i--) { i -= 1; y += i; }", "a + 2"),
    ],
)
def test_a_line_of_c_means_what_c_says_or_is_refused_with_its_reason(tmp_path, body, expected):
    head = "#define SCALE 2.0f\n#define SQUARE(x) ((x)*(x))\n"
    result = read(tmp_path, f"{head}void f(float a, float &y) {{ {body} }}", end=".cpp")
    assert final(result, "y") == expected


def test_what_depends_on_a_refused_line_is_unread_and_the_rest_is_read(tmp_path):
    result = read(
        tmp_path, "void f(float a, float y[3]) {\n y[0] = a;\n float b = mystery(a);\n y[1] = b + a;\n y[2] = 2*a; }"
    )
    assert final(result, "y", 0) == "a" and final(result, "y", 2) == "2*a"
    assert final(result, "y", 1) == "the function mystery, which this file does not define"
    assert list(result.refused) == [3]


def test_an_unknown_call_leaves_unread_what_does_not_belong_to_the_function(tmp_path):
    result = read(tmp_path, "float g;\nvoid f(float y[2]) { y[0] = g; mystery(); y[1] = g; }")
    assert final(result, "y", 0) == "g"
    assert "mystery" in final(result, "y", 1)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("void f(Quatf p, Quatf q, float &y) { y = p*q; }", "p as a whole, of a type that is no number"),
        ("void f(S s, S t, float &y) { s.a = 1; s = t; y = s.a; }", "t as a whole, of a type that is no number"),
        ("void g(S *s) { s->a = 2; }\nvoid f(float &y) { S t; t.a = 1; g(&t); y = t.a; }",
         "a structure that g knows by another name"),
        ("namespace a { const float k = 1; } namespace b { const float k = 2; }\nvoid f(float &y) { y = k; }",
         "k, which this file defines in another place"),
        ("union U { float x; float v[1]; };\nvoid f(float a, float &y) { U u; u.x = 2; u.v[0] = a; y = u.x; }",
         "a member of a union, which shares its place with others"),
    ],
)  # fmt: skip
def test_what_is_no_number_is_refused_with_its_members(text, why, tmp_path):
    assert final(read(tmp_path, text, end=".cpp"), "y") == why


def test_every_way_through_branches_is_a_case_and_constants_decide(tmp_path):
    text = "void f(float a, int n, float y[1]) { if (1 < 2) y[0] = a; if (a > 1 && n == 2) y[0] = 3; else y[0] = 2*a; }"
    result = read(tmp_path, text)
    outcomes = [
        (tuple(c.holds for c in case.conditions), final(result, "y", 0, case=i)) for i, case in enumerate(result.cases)
    ]
    assert sorted(outcomes) == [((False,), "2*a"), ((True, False), "2*a"), ((True, True), "3")]


def test_more_than_32_cases_leave_unread_what_the_branches_write(tmp_path):
    branches = "".join(f"if (b[{n}] > a) y[0] += {n};" for n in range(7))
    head = "void f(float a, const float b[7], float y[1], float z[1])"
    result = read(tmp_path, f"{head} {{ y[0] = 0; z[0] = a; {branches} }}")
    assert len(result.cases) == 1 and final(result, "z", 0) == "a"
    assert final(result, "y", 0) == "one of more than 32 cases"


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("b = a\n    b[0] = 5.0\n    y = a[0] + 0", "5"),
        ("b = a[0:2]\n    a[0] = 5.0\n    y = b[0] + 0", "a view of an array that has changed; write a copy"),
        ("M = np.array([[1, 0], [0, 1]])\n    M[0, 1] = a[0]\n    y = M[0, 1] + 0", "a real number cut to an integer"),
        ("M = np.eye(2)\n    M[0, 1] = a[0]\n    y = M[0, 1] + 0", "a[0]"),
        ("y = (a @ a) / 2", "1/2*(a[0]*a[0] + a[1]*a[1])"),
        ("M = np.array([[1.0, 2.0], [3.0, 4.0]])\n    N = M * M\n    y = N[1, 0] + 0", "9"),
        ("M = np.array([[1.0, 2.0], [3.0, 4.0]])\n    N = M @ M\n    y = N[1, 0] + 0", "15"),
        ("u, v = v, u\n    y = u", "v"),
        ("y = sum(a)", "the function sum, which this file does not define"),
        ("y = -a[-1]**2", "-a[1]**2"),
        ("y = a.mean()", "the method mean"),
    ],
)
def test_a_line_of_python_means_what_numpy_does_or_is_refused(tmp_path, body, expected):
    text = f"import numpy as np\n\ndef f(a, u, v):\n    {body}\n"
    assert final(read(tmp_path, text, end=".py", shapes={"a": (2,)}), "y") == expected


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("y = v' * v;", "v(1)*v(1) + v(2)*v(2)"),
        ("M = [1 2; 3 4]; y = M(2,1);", "3"),
        ("M = zeros(2); M(1,:) = v; y = M(1,2);", "v(2)"),
        ("y = 0; for i = 1:2\n y = y + v(i)^2;\nend", "v(1)**2 + v(2)**2"),
        ("y = -v(1)^2;", "-v(1)**2"),
        ("y = 2^3^2;", "64"),
        ("y = 3*-v(1)^2;", "3*(-v(1)**2)"),
        ("y = 2^-v(1)^2;", "a sign inside a tower of powers, which MATLAB and Octave read differently"),
        ("M = [v v]; y = M(2,2) + M(1,1);", "v(2) + v(1)"),
        ("M = [a 2; v(1:2)']; y = M(2,1);", "v(1)"),
        ("M = [v; a]; y = M(3);", "a"),
        ("M = [v a]; y = M(1);", "blocks of different sizes side by side"),
        ("y = w' * 2;", "the transpose of what has no known size; declare it under [code.symbols]"),
        ("y = v \\ v;", "the operator \\"),
        ("[y, z] = size(v);", "several names assigned at once"),
    ],
)
def test_a_line_of_matlab_means_what_octave_does_or_is_refused(tmp_path, body, expected):
    result = read(tmp_path, f"function y = f(v, w)\n{body}\nend\n", end=".m", shapes={"v": (2,)})
    assert final(result, "y") == expected


def test_matrices_of_eigen_are_multiplied_as_matrices(tmp_path):
    text = """Matrix2f f(const Matrix2f &A, const Vector2f &v) {
        Matrix2f M; M << 1, 2, 3, 4;
        return A * M + v * v.transpose() + Matrix2f::Identity(); }"""
    returned = read(tmp_path, text, end=".cpp").cases[0].returned
    assert isinstance(returned, Array) and returned.shape == (2, 2)
    values = {"A_0_0": 2.0, "A_0_1": 3.0, "A_1_0": 5.0, "A_1_1": 7.0, "v_0": 11.0, "v_1": 13.0}
    found = [evaluate(cell.tree, values) for cell in returned.cells if isinstance(cell, Scalar)]
    A, v = np.array([[2, 3], [5, 7]]), np.array([11, 13])
    assert np.allclose(found, (A @ np.array([[1, 2], [3, 4]]) + np.outer(v, v) + np.eye(2)).ravel())


@pytest.mark.parametrize("file", sorted(GALLERY.glob("*.py")), ids=lambda path: path.stem)
def test_the_formulas_of_a_python_example_are_what_python_computes(file):
    generator, known = random.Random(7), {"x": (3,), "u": (2,), "q": (4,), "a": (3,), "m": (3,), "R": (3, 3)}
    scope: dict[str, object] = {}
    exec(compile(file.read_text(), str(file), "exec"), scope)
    unit = load_unit(file)
    for name in ("before", "after"):
        function, names = find_function(unit, name, ""), Names()
        shapes = {a.name: known[a.name] for a in function.arguments if a.name in known}
        given = {a.name: np.array([generator.uniform(-1, 1) for _ in range(math.prod(shapes.get(a.name, ())))])
                 .reshape(shapes.get(a.name, ())) for a in function.arguments}  # fmt: skip
        returned = read_function(unit, function, names.symbol, shapes).cases[0].returned
        point = {}
        for spelling, symbol in names.symbols.items():
            head, _, rest = spelling.partition("[")
            place = tuple(int(n) for n in rest.rstrip("]").split(",")) if rest else ()
            point[symbol] = float(given[head][place])
        assert isinstance(returned, Array)
        found = [evaluate(cell.tree, point) for cell in returned.cells]
        assert np.allclose(found, np.ravel(scope[name](**given)), atol=1e-12)


def test_numbers_are_read_exactly(tmp_path):
    result = read(tmp_path, "float f(void) { return 0.1f + 1e-7; }")
    assert result.cases[0].returned.tree.args[0] == Fraction("0.1") + Fraction("1e-7")


@pytest.mark.parametrize("sign", [">>", "<<", "|", "&", "^"])
def test_an_assignment_with_an_operator_on_bits_is_no_quotient(tmp_path, sign):
    result = read(tmp_path, f"def f(a):\n    n = 9\n    n {sign}= 2\n    y = a * n\n    return y\n", end=".py")
    assert final(result, "y") == f"the assignment {sign}="


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("void f(Matrix3f &M, float &y) { M.topRows(1) = M.row(2); y = M(0, 0); }", "topRows"),
        ("void f(Mat &M, float a, float &y) { M.topRows(1) = a; y = M(0, 0); }", "one of its methods"),
        ("void f(Mat &M, float a, float &y) { M(0, 0) = a; M.topRows(1) = a; y = M(0, 0); }", "topRows"),
    ],
)  # fmt: skip
def test_what_a_method_of_a_matrix_writes_is_in_the_matrix(tmp_path, text, why):
    assert why in final(read(tmp_path, text, end=".cpp"), "y")
    member = "void f(State &s, float a, float &y) { s.P(0, 0) = a; s.K(0, 0) = 1; y = s.P(0, 0); }"
    assert final(read(tmp_path, member, end=".cpp"), "y") == "a"


def test_the_counter_of_a_loop_without_a_round_is_empty_in_matlab(tmp_path):
    text = "function y = f(a)\n  k = 9;\n  for k = {}:1\n    a = a + 1;\n  end\n  y = a + k;\nend\n"
    assert final(read(tmp_path, text.format(1), end=".m"), "y") == "a + 1 + 1"
    assert "without a round" in final(read(tmp_path, text.format(5), end=".m"), "y")


def test_all_entries_of_a_row_are_a_column_in_matlab(tmp_path):
    text = "function y = f(v)\n  w = v';\n  y = [w(:)'; w];\nend\n"
    result = read(tmp_path, text, end=".m", shapes={"v": (2, 1)})
    assert [final(result, "y", 1, j) for j in (0, 1)] == ["v(1,1)", "v(2,1)"]
