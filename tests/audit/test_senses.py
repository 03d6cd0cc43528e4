"""Weaker senses of equality: granted where they hold and are admitted, refused near by, never taken for exact."""

from __future__ import annotations

import json
from fractions import Fraction
from importlib import import_module

import pytest

import navsym as nav
from navsym.cli.main import run
from navsym.core.errors import NavsymError

UNIT = 'relations = ["q[0]**2 + q[1]**2 + q[2]**2 + q[3]**2 = 1"]\n'
#: The yaw of an antenna at a fixed angle, by two forms of one rotation, and its derivative written out by hand.
YAW = """
void flown(const float q[4], float c, float s, float *yaw)
{
    const float x = c * (1 - 2 * (q[2]*q[2] + q[3]*q[3])) + s * 2 * (q[1]*q[2] - q[0]*q[3]);
    const float y = c * 2 * (q[1]*q[2] + q[0]*q[3]) + s * (1 - 2 * (q[1]*q[1] + q[3]*q[3]));
    *yaw = atan2f(y, x);
}
void generated(const float q[4], float c, float s, float H[4])
{
    const float x = c * (q[0]*q[0] + q[1]*q[1] - q[2]*q[2] - q[3]*q[3]) + s * 2 * (q[1]*q[2] - q[0]*q[3]);
    const float y = c * 2 * (q[1]*q[2] + q[0]*q[3]) + s * (q[0]*q[0] - q[1]*q[1] + q[2]*q[2] - q[3]*q[3]);
    const float n = x*x + y*y;
    H[0] = (x * (2*c*q[3] + 2*s*q[0]) - y * (2*c*q[0] - 2*s*q[3])) / n;
    H[1] = (x * (2*c*q[2] - 2*s*q[1]) - y * (2*c*q[1] + 2*s*q[2])) / n;
    H[2] = (x * (2*c*q[1] + 2*s*q[2]) - y * (-2*c*q[2] + 2*s*q[1])) / n;
    H[3] = (x * (2*c*q[0] - 2*s*q[3]) - y * (-2*c*q[3] - 2*s*q[0])) / n;
}
"""


@pytest.fixture(autouse=True)
def without_mends(monkeypatch):
    """The search for mends is another test's."""
    monkeypatch.setattr(import_module("navsym.audit.answer"), "suggest", lambda *_: None)


def ask(folder, code, question, head="", functions=("f",), end="c"):
    """The answer to one question about functions of one file, which are called by their names."""
    (folder / f"code.{end}").write_text(code)
    spec = "".join(f'[[code]]\nname = "{f}"\nfile = "code.{end}"\nfunction = "{f}"\n{head}' for f in functions)
    (folder / "spec.toml").write_text(f'{spec}[[question]]\nname = "q"\n{question}\n')
    return nav.audit(folder / "spec.toml")["q"]


def check_both(folder, code, question, sense, head="", functions=("f",), end="c"):
    """Not exact, said to hold in the sense, and proved in it where it is admitted; certificates pass."""
    plain = ask(folder, code, question, head, functions, end)
    assert plain.status == nav.REFUTED and plain.sense in ("exact", "manifold")
    admitted = ask(folder, code, f'{question}\nsenses = ["{sense}"]', head, functions, end)
    assert admitted.status == nav.PROVED and admitted.sense == sense and admitted.weaker is None
    audit = nav.audit(folder / "spec.toml")
    assert {item.status for item in nav.check(audit)} == {"ACCEPTED"}
    return plain, admitted


def refuse(folder, code, question, sense, head="", functions=("f",), end="c", status=nav.REFUTED):
    """Neither said to hold in the sense nor proved in it."""
    plain = ask(folder, code, question, head, functions, end)
    assert plain.status == nav.REFUTED and plain.weaker != sense
    assert ask(folder, code, f'{question}\nsenses = ["{sense}"]', head, functions, end).status == status


# The tangent space

ROW = 'kind = "jacobian"\nof = "flown:yaw"\nby = "flown:q"\nis = "generated:H"'


def test_two_derivatives_of_yaw_agree_on_the_tangent_space_of_unit_quaternions(tmp_path):
    plain, _ = check_both(tmp_path, YAW, ROW, "tangent", UNIT, ("flown", "generated"))
    assert plain.weaker == "tangent" and all('senses = ["tangent"]' in e.why for e in plain.entries)


@pytest.mark.parametrize(
    ("old", "new"),
    [("(2*c*q[3] + 2*s*q[0])", "(2*c*q[3] - 2*s*q[0])"), ("(2*c*q[1] + 2*s*q[2]) - y", "(2*c*q[1] + s*q[2]) - y"),
     ("H[3] = (", "H[3] = 2*("), ("H[0] = (", "H[0] = q[1] + (")],
)  # fmt: skip
def test_a_wrong_row_is_not_equal_on_the_tangent_space_either(tmp_path, old, new):
    assert YAW.count(old) == 1
    refuse(tmp_path, YAW.replace(old, new), ROW, "tangent", UNIT, ("flown", "generated"))


LINE = "void f(const double q[2], double H[2])\n{{\n    H[0] = {};\n    H[1] = {};\n}}\n"
ASK = 'kind = "equal"\nleft = "f:H"\nright = ["0", "0"]\nby = "f:q"'


@pytest.mark.parametrize(
    ("relation", "first", "second", "status"),
    [
        ("q[0]**2 + q[1]**2 = 1", "q[0]*3", "q[1]*3", "PROVED"),  # a multiple of the gradient
        ("q[0]**2 + q[1]**2 = 1", "q[0]*3", "q[1]*2", "REFUTED"),
        ("q[0]**2 + q[1]**2 = 1", "-q[1]", "q[0]", "REFUTED"),  # the tangent itself
        ("q[0]*q[1] = 2", "5*q[1]", "5*q[0]", "PROVED"),
        ("q[0]*q[1] = 2", "5*q[1]", "-5*q[0]", "REFUTED"),
        ("q[0]**2*q[1] = 4", "2*q[0]*q[1]", "q[0]*q[0]", "PROVED"),
        ("q[0]**2 + q[0]*q[1] = 0", "2*q[0] + q[1]", "q[0]", "OPEN"),  # a gradient that may vanish proves nothing
        ("(q[0]**2 + q[1]**2 - 1)**2 = 0", "1", "1", "OPEN"),  # its gradient vanishes everywhere
    ],
)
def test_a_row_is_zero_on_a_tangent_space_where_it_is_a_multiple_of_the_gradient(
    tmp_path, relation, first, second, status
):
    question = ask(
        tmp_path, LINE.format(first, second), f'{ASK}\nsenses = ["tangent"]', f'relations = ["{relation}"]\n'
    )
    assert str(question.status) == status


def test_columns_that_leave_out_a_symbol_of_the_relation_have_no_tangent_space(tmp_path):
    code = "void f(const double q[2], double H[1])\n{\n    H[0] = q[0];\n}\n"
    question = 'kind = "equal"\nleft = "f:H[0]"\nright = "0"\nby = ["f:q[0]"]\nsenses = ["tangent"]'
    assert ask(tmp_path, code, question, 'relations = ["q[0]**2 + q[1]**2 = 1"]\n').status == nav.OPEN


ROTATION = "[code.symbols]\nR = { matrix = [3, 3], rotation = true }\n"
#: A weighted trace, and its gradient G as it is projected to the rotations: (G - R G' R)/2.
TRACE = """
void f(const double R[3][3], const double a[3], double t[1], double H[3][3], double S[3][3])
{
    t[0] = a[0]*R[0][0] + a[1]*R[1][1] + a[2]*R[2][2];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            double turned = 0.0;
            S[i][j] = 0.0;
            for (int k = 0; k < 3; k++) { turned += R[i][k]*a[k]*R[k][j]; S[i][j] += R[k][i]*R[k][j]; }
            H[i][j] = -turned/2.0;
        }
        H[i][i] += a[i]/2.0;
    }
}
"""
GRADIENT = 'kind = "jacobian"\nof = "f:t"\nby = "f:R"\nis = "f:H"'


def test_a_projected_gradient_agrees_on_the_tangent_space_of_rotations(tmp_path):
    plain, _ = check_both(tmp_path, TRACE, GRADIENT, "tangent", ROTATION)
    assert plain.weaker == "tangent" and all("the rotation R" in entry.why for entry in plain.entries)
    for entry in plain.entries:  # the point at which it is not exact is a rotation
        R = [[Fraction(entry.counterexample[f"R[{i}][{j}]"]) for j in range(3)] for i in range(3)]
        products = [sum(x * y for x, y in zip(R[i], R[j], strict=True)) for i in range(3) for j in range(3)]
        assert products == [1, 0, 0, 0, 1, 0, 0, 0, 1]


@pytest.mark.parametrize(
    ("old", "new"),
    [("-turned/2.0", "turned/2.0"), ("a[i]/2.0", "a[i]/3.0"), ("a[k]*R[k][j]", "a[k]*R[j][k]"),
     ("H[i][j] = -turned/2.0", "H[i][j] = -R[i][j]/2.0")],
)  # fmt: skip
def test_a_wrong_gradient_is_not_equal_on_the_tangent_space_of_rotations(tmp_path, old, new):
    assert TRACE.count(old) == 1
    refuse(tmp_path, TRACE.replace(old, new), GRADIENT, "tangent", ROTATION)


def test_the_columns_of_a_rotation_are_orthonormal_and_those_of_another_matrix_are_not(tmp_path):
    question = 'kind = "equal"\nleft = "f:S"\nright = [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]]'
    answer = ask(tmp_path, TRACE, question, ROTATION)
    assert answer.status == nav.PROVED and answer.sense == "manifold"
    assert ask(tmp_path, TRACE, question, "").status == nav.REFUTED
    wrong = ask(tmp_path, TRACE.replace("R[k][i]*R[k][j]", "R[k][i]*R[j][k]"), question, ROTATION)
    assert wrong.status == nav.REFUTED


def test_a_rotation_turns_a_cross_product_and_another_matrix_does_not(tmp_path):
    head = "Vector3d {}(const Matrix3d &R, const Vector3d &u, const Vector3d &v)\n{{\n    Vector3d y = {};\n"
    code = "".join(
        f"{head.format(*each)}    return y;\n}}\n" for each in (("f", "(R * u).cross(R * v)"), ("g", "R * u.cross(v)"))
    )
    question = 'kind = "equal"\nleft = "f:return"\nright = "g:return"'
    answer = ask(tmp_path, code, question, ROTATION, ("f", "g"), "cpp")
    assert answer.status == nav.PROVED and answer.sense == "manifold"
    assert ask(tmp_path, code, question, "", ("f", "g"), "cpp").status == nav.REFUTED


@pytest.mark.parametrize("declared", ["matrix = [2, 2], rotation = true", 'matrix = [3, 3], rotation = "yes"'])
def test_a_rotation_is_three_by_three_and_declared_with_true(tmp_path, declared):
    with pytest.raises(nav.NavsymError, match="rotation = true"):
        ask(tmp_path, TRACE, GRADIENT, f"[code.symbols]\nR = {{ {declared} }}\n")


# Orders

TURN = """
void f(double w, double dt, double R[2][2])
{{
    R[0][0] = {0}; R[0][1] = {1};
    R[1][0] = {2}; R[1][1] = {0};
}}
"""
FULL = 'kind = "equal"\nleft = "f:R"\nright = [["cos(w*dt)", "-sin(w*dt)"], ["sin(w*dt)", "cos(w*dt)"]]'
SECOND = TURN.format("1 - 0.5*w*w*dt*dt", "-w*dt", "w*dt")


def test_a_rotation_by_its_series_is_equal_up_to_the_second_order_and_no_further(tmp_path):
    up_to = 'order = {{ of = "f:dt", up_to = {} }}'
    plain, admitted = check_both(tmp_path, SECOND, f"{FULL}\n{up_to.format(2)}", "order")
    assert plain.weaker == "order" and all("up to order 2 in dt" in entry.why for entry in admitted.entries)
    refuse(tmp_path, SECOND, f"{FULL}\n{up_to.format(3)}", "order")


def test_the_strongest_order_is_found_where_the_step_of_time_is_called_so(tmp_path):
    plain = ask(tmp_path, SECOND, FULL)
    assert plain.weaker == "order" and {e.why.split(" in dt")[0][-1] for e in plain.entries} == {"3", "2"}


@pytest.mark.parametrize(
    ("entry", "up_to", "status"),
    [
        ("w*dt + dt*dt*sqrt(dt)", 2, "OPEN"),  # a root has no series
        ("w*dt + fabs(dt)*dt*dt", 2, "OPEN"),
        ("w*dt - 0.5*w*w*dt*dt", 2, "REFUTED"),
        ("w*dt - 0.5*w*w*dt*dt", 1, "PROVED"),
        ("w*dt + dt*dt*dt/(dt*dt + w)", 2, "PROVED"),
        ("w*dt + dt*dt*dt/(dt*dt)", 2, "OPEN"),  # no value at dt = 0
        ("-w*dt", 1, "REFUTED"),
    ],
)
def test_an_order_needs_a_series_and_its_terms(tmp_path, entry, up_to, status):
    code = TURN.format("1 - 0.5*w*w*dt*dt", "-w*dt", entry)
    answer = ask(tmp_path, code, f'{FULL}\norder = {{ of = "f:dt", up_to = {up_to} }}\nsenses = ["order"]')
    assert str(answer.status) == status


def test_a_branch_on_the_step_of_time_has_no_order(tmp_path):
    code = "double f(double w, double dt)\n{\n    if (dt > 0.5) { return w*dt; }\n    return sin(w*dt);\n}\n"
    question = 'kind = "equal"\nleft = "f:return"\nright = "sin(w*dt)"\n'
    question += 'order = { of = "f:dt", up_to = 1 }\nsenses = ["order"]'
    assert ask(tmp_path, code, question).status == nav.OPEN


def test_small_angles_are_small_together(tmp_path):
    code = """void f(const double a[3], double R[3][3])
{
    R[0][0] = 1; R[0][1] = -a[2]; R[0][2] = a[1];
    R[1][0] = a[2]; R[1][1] = 1; R[1][2] = -a[0];
    R[2][0] = -a[1]; R[2][1] = a[0]; R[2][2] = 1;
}
"""
    question = 'kind = "orthogonal"\nof = "f:R"\norder = {{ of = "f:a", up_to = {} }}'
    check_both(tmp_path, code, question.format(1), "order")
    refuse(tmp_path, code, question.format(2), "order")
    refuse(tmp_path, code.replace("R[1][2] = -a[0]", "R[1][2] = a[0]"), question.format(1), "order")


# Approximations

SMALL = 'approximations = ["sin(a) = a", "cos(a) = 1"]\n'


@pytest.mark.parametrize(
    ("body", "status"),
    [("x + a*y", "PROVED"), ("x - a*y", "REFUTED"), ("x", "REFUTED"), ("x + a", "REFUTED"), ("a", "REFUTED")],
)
def test_a_small_angle_is_put_for_its_sine_and_nothing_follows_from_its_being_zero(tmp_path, body, status):
    code = f"double f(double a, double x, double y)\n{{\n    return {body};\n}}\n"
    question = 'kind = "equal"\nleft = "f:return"\nright = "x*cos(a) + y*sin(a)"'
    if status == "PROVED":
        plain, admitted = check_both(tmp_path, code, question, "approximation", SMALL)
        assert plain.weaker == "approximation" and "sin(a) = a" in admitted.entries[0].why
    else:
        refuse(tmp_path, code, question, "approximation", SMALL)


def test_a_rate_that_is_constant_over_the_step_is_one_name_for_two(tmp_path):
    code = "double f(double w0, double w1, double dt)\n{\n    return w0*dt;\n}\n"
    head = 'approximations = ["w1 = w0"]\n'
    check_both(tmp_path, code, 'kind = "equal"\nleft = "f:return"\nright = "(w0 + w1)*dt/2"', "approximation", head)
    refuse(tmp_path, code, 'kind = "equal"\nleft = "f:return"\nright = "(w0 + w1)*dt/3"', "approximation", head)


# Noise

NOISE = (
    "void f(double a, double b, double V[2][2])\n{{\n    V[0][0] = {}; V[0][1] = {}; V[1][0] = {}; V[1][1] = {};\n}}\n"
)
SIGNS = 'kind = "equal"\nleft = "f:V"\nright = [["a", "b"], ["0", "1"]]\nnoise = "{}"'


@pytest.mark.parametrize(
    ("entries", "kind", "status"),
    [
        (("-a", "-b", "0", "-1"), "any", "PROVED"),
        (("-a", "-b", "0", "-1"), "independent", "PROVED"),
        (("-a", "b", "0", "1"), "independent", "PROVED"),
        (("-a", "b", "0", "1"), "any", "REFUTED"),  # correlated noises notice the sign of one
        (("a", "-b", "0", "1"), "independent", "REFUTED"),  # half a column
        (("a", "b", "0", "2"), "any", "REFUTED"),
        (("b", "a", "1", "0"), "independent", "REFUTED"),  # columns exchanged
    ],
)
def test_the_sign_of_a_noise_does_not_change_a_covariance(tmp_path, entries, kind, status):
    code = NOISE.format(*entries)
    if status == "PROVED":
        plain, _ = check_both(tmp_path, code, SIGNS.format(kind), "noise-sign")
        assert plain.weaker == "noise-sign"
    else:
        refuse(tmp_path, code, SIGNS.format(kind), "noise-sign")


def test_a_sign_is_no_sign_of_a_noise_unless_the_question_says_so(tmp_path):
    plain = ask(tmp_path, NOISE.format("-a", "-b", "0", "-1"), SIGNS.format("any").replace('noise = "any"', ""))
    assert plain.status == nav.REFUTED and plain.weaker is None


# Names and orders of the states

STATES = """
void f(const double x[3], double k, double F[3][3])
{{
    F[0][0] = {0}; F[0][1] = {1}; F[0][2] = {2};
    F[1][0] = {3}; F[1][1] = {4}; F[1][2] = {5};
    F[2][0] = {6}; F[2][1] = {7}; F[2][2] = {8};
}}
"""
CHAIN = 'kind = "equal"\nleft = "f:F"\nright = [["0", "1", "0"], ["0", "0", "k"], ["0", "0", "0"]]'


def test_states_in_another_order_are_found(tmp_path):
    code = STATES.format(*"000", *"k00", *"010")  # the chain from the last to the first
    plain, admitted = check_both(tmp_path, code, CHAIN, "renamed")
    assert plain.weaker == "renamed" and "in the order 3, 2, 1" in {e.entry: e.why for e in admitted.entries}[1, 2]
    refuse(tmp_path, STATES.format(*"000", *"k00", *"020"), CHAIN, "renamed")  # one entry is wrong besides
    refuse(tmp_path, STATES.format(*"001", *"k00", *"010"), CHAIN, "renamed")
    refuse(tmp_path, STATES.format(*"010", *"000", *"k00"), CHAIN, "renamed")  # the same entries, but no chain


def test_the_states_in_the_entries_are_renamed_with_the_rows(tmp_path):
    right = '[["x[0]", "x[1]", "0"], ["0", "1", "x[2]"], ["0", "0", "k"]]'
    question = f'kind = "equal"\nleft = "f:F"\nright = {right}\nby = "f:x"'
    turned = STATES.format("k", "0", "0", "x[0]", "1", "0", "0", "x[1]", "x[2]")  # the states 3, 2, 1
    check_both(tmp_path, turned, question, "renamed")
    kept = STATES.format("k", "0", "0", "x[2]", "1", "0", "0", "x[1]", "x[0]")  # rows moved, names not
    refuse(tmp_path, kept, question, "renamed")


# The contract


def test_a_weaker_sense_is_never_the_sense_of_a_script_that_asks_for_equality(tmp_path, capsys):
    ask(tmp_path, SECOND, FULL)
    assert run(["audit", str(tmp_path / "spec.toml"), "--json"]) == 1
    (question,) = json.loads(capsys.readouterr().out)["questions"]
    assert question["status"] == "REFUTED" and question["sense"] == "exact" and question["weaker"] == "order"
    ask(tmp_path, SECOND, f'{FULL}\norder = {{ of = "f:dt", up_to = 1 }}\nsenses = ["order"]')
    assert run(["audit", str(tmp_path / "spec.toml"), "--json", "--all"]) == 0
    (question,) = json.loads(capsys.readouterr().out)["questions"]
    assert question["status"] == "PROVED" and question["sense"] == "order" and "weaker" not in question


def test_an_entry_that_is_exact_stays_exact_and_the_question_has_the_weakest_sense(tmp_path):
    code = TURN.format("cos(w*dt)", "-sin(w*dt)", "w*dt")
    answer = ask(tmp_path, code, f'{FULL}\norder = {{ of = "f:dt", up_to = 1 }}\nsenses = ["order"]')
    assert [e.sense for e in answer.entries] == ["exact", "exact", "order", "exact"] and answer.sense == "order"


def test_one_of_several_admitted_senses_is_enough_and_the_strongest_is_named(tmp_path):
    code = "double f(double a, double dt, double x)\n{\n    return x + a*dt;\n}\n"
    question = 'kind = "equal"\nleft = "f:return"\nright = "x + sin(a)*dt"\norder = { of = "f:dt", up_to = 1 }\n'
    answer = ask(tmp_path, code, question + 'senses = ["approximation", "order"]', SMALL)
    assert answer.status == nav.PROVED and answer.sense == "approximation"
    same = question.replace("sin(a)*dt", "a*dt + dt**2")
    assert ask(tmp_path, code, same + 'senses = ["approximation", "order"]', SMALL).sense == "order"


@pytest.mark.parametrize(
    ("question", "words"),
    [
        ('senses = ["close"]', "renamed"),
        ('senses = ["tangent"]', "relations"),
        ('senses = ["order"]', "up_to"),
        ('senses = ["noise-sign"]', "independent"),
        ('senses = ["approximation"]', "approximations"),
        ('order = { of = "f:dt", up_to = 9 }', "from 0 to 7"),
        ('order = { of = "f:dt", up_to = 1, by = 2 }', "up_to"),
        ('noise = "white"', "independent"),
    ],
)
def test_a_sense_that_lacks_what_it_needs_is_refused(tmp_path, question, words):
    with pytest.raises(NavsymError, match=words):
        ask(tmp_path, SECOND, f"{FULL}\n{question}")


def test_a_mapping_puts_only_names_and_functions_for_others(tmp_path):
    with pytest.raises(NavsymError, match="a name or a function"):
        ask(tmp_path, SECOND, FULL, 'approximations = ["w*dt = 0"]\n')
