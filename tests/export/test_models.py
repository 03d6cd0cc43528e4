"""Models leave as flight code: what is compiled, read back and run is what the model says."""

from __future__ import annotations

import importlib.util
import re
import shutil
import tomllib
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg
import sympy as sp

import navsym as nav
from navsym.claims import PROVED, REFUTED, Equation
from navsym.export.algorithms import models
from navsym.export.languages.targets import TARGETS, WARNINGS
from navsym.language.expression import parse
from navsym.prove.ladder import decide

EXAMPLES = Path(__file__).parents[2] / "examples"
RANGES = {"x": ("-2", "2"), "v": ("-1", "1"), "dt": ("1/1000", "1/2")}
needs_compilers = pytest.mark.skipif(not (shutil.which("gcc") and shutil.which("g++")), reason="needs gcc and g++")


def symmetric(flat, n):
    """The symmetric matrix of an upper triangle, row by row."""
    rows, upper = iter(flat), {}
    for i in range(n):
        for j in range(i, n):
            upper[i, j] = upper[j, i] = next(rows)
    return [[upper[i, j] for j in range(n)] for i in range(n)]


def unit_upper(flat, n):
    """The unit upper triangular matrix of its strict triangle."""
    rows = iter(flat)
    return [[next(rows) if j > i else type(flat[0])(i == j) for j in range(n)] for i in range(n)]


@pytest.fixture(scope="module")
def oscillator(tmp_path_factory):
    """Folder and module of a damped oscillator with a parameter, in C and Python."""
    folder = tmp_path_factory.mktemp("oscillator")
    model = nav.Model(
        "x v",
        F=[[0, 1], ["-w**2", 0]],
        H=[["1", "0"], ["1/2", "3"]],
        sigma=["1/10", "s"],
        measurements="place both",
        name="swing",
        ranges=RANGES,
        w=("1/2", "3"),
        s=("1/10", "1"),
    )
    nav.export(model, to=["c", "python"], out=folder, vectors=8, run=False)
    spec = importlib.util.spec_from_file_location("exported_swing", folder / "python" / "navsym_functions.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return folder, module


# -- the whole loop ---------------------------------------


MODELS = [
    path
    for folder in (EXAMPLES, Path(nav.__file__).parent / "claims" / "example" / "models")
    for path in sorted(folder.glob("*.toml"))
    if {"model", "measurement"} <= tomllib.loads(path.read_text(encoding="utf-8")).keys()
]
#: Every third in every run, the others in the long ones, one by hand.
MARKS = [
    [pytest.mark.slow] if path.stem == "conventions" else [pytest.mark.long] if place % 3 else []
    for place, path in enumerate(MODELS)
]


@needs_compilers
@pytest.mark.parametrize("path", [pytest.param(p, id=p.stem, marks=m) for p, m in zip(MODELS, MARKS, strict=True)])
def test_an_example_model_is_compiled_and_replayed(path, tmp_path):
    """Every model with measurements in the examples and in a new workspace, without a warning of the compilers."""
    made = nav.export(str(path), to=["c", "cpp"], out=tmp_path, vectors=8)
    assert {outcome.status for outcome in made.outcomes} == {"verified"}
    certificates = sorted((made.out / "certificates").iterdir())
    assert all(nav.check(path).accepted for path in certificates[:: len(certificates) // 8])


def test_the_compilers_are_asked_for_every_warning_and_none_is_let_pass():
    assert all("{strict}" in TARGETS[name].steps[0] for name in ("c", "cpp"))
    assert {"-Wall", "-Wextra", "-Werror", "-pedantic"} <= set(WARNINGS)


@needs_compilers
@pytest.mark.parametrize(
    "answer",
    [
        lambda: nav.solve(EXAMPLES / "schuler-velocity.toml", "drift", T="pi/2"),
        pytest.param(
            lambda: nav.phases(EXAMPLES / "schuler-velocity.toml", "drift", T=("2", "4")), marks=pytest.mark.long
        ),
        lambda: nav.derive(EXAMPLES / "schuler-velocity.toml"),
        lambda: nav.book["third-flattening"],
        lambda: nav.prove("sin(2*a) = 2*sin(a)*cos(a)", a=("-1", "1")),
    ],
    ids=["solve", "phases", "derive", "book", "prove"],
)
def test_every_kind_of_answer_is_compiled_and_replayed(answer, tmp_path):
    """C and its Python twin run inside their enclosures; check grants all parts, the deviations from MISRA too."""
    made = nav.export(answer(), to=["c", "python"], out=tmp_path, vectors=8)
    assert {outcome.status for outcome in made.outcomes} == {"verified"}
    found = nav.check(made.out)
    assert found.accepted and {"manifest", "code:c", "code:python"} <= {part.kind for part in found}


def test_an_entry_of_the_book_with_vectors_leaves_as_a_function_of_arrays(tmp_path):
    made = nav.export("book:skew-is-cross", to=["python"], out=tmp_path, vectors=8)
    assert {outcome.status for outcome in made.outcomes} == {"verified"}
    assert "[3]: each real" in (tmp_path / "python" / "navsym_functions.py").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("item", "words"),
    [
        (f"{EXAMPLES / 'audit' / 'yaw_jacobian.toml'}:transitoin", "did you mean transition"),
        (EXAMPLES / "error_model.toml", "read from code; write F as formulas in a model file"),
    ],
)
def test_what_is_no_formula_of_an_audit_is_refused_and_says_what_to_write(item, words):
    with pytest.raises(nav.NavsymError, match=words):
        nav.export(str(item))


FAULTY = """#include <math.h>
void measure(const double pose[3], const double mark[2], double z[2], double H[2][3])
{
    double dx = mark[0] - pose[0], dy = mark[1] - pose[1];
    z[0] = sqrt(dx*dx + dy*dy);
    z[1] = dy*cos(pose[2]) - dx*sin(pose[2]);
    H[0][0] = -dx/z[0]; H[0][1] = dy/z[0]; H[0][2] = 0.0;
    H[1][0] = sin(pose[2]); H[1][1] = -cos(pose[2]); H[1][2] = -dy*sin(pose[2]) + dx*cos(pose[2]);
}
"""
QUESTION = """[[code]]
name = "m"
file = "measure.c"
function = "measure"
[code.symbols]
"mark[0]" = ["5", "9"]
"pose[0]" = ["-1", "1"]
[[question]]
name = "H"
kind = "jacobian"
of = "m:z"
by = "m:pose"
is = "m:H"
"""


def test_a_question_of_an_audit_leaves_as_what_the_code_should_be(tmp_path):
    """Two wrong signs of a Jacobian: the arguments are the arrays of the code, and differences agree."""
    (tmp_path / "measure.c").write_text(FAULTY)
    (tmp_path / "spec.toml").write_text(QUESTION)
    audit = nav.audit(tmp_path / "spec.toml")
    assert [entry.entry for entry in audit["H"].entries if entry.suggestion] == [(1, 2), (2, 3)]
    made = nav.export(f"{tmp_path / 'spec.toml'}:H", to=["c", "python"], out=tmp_path / "out", vectors=8)
    assert {outcome.status for outcome in made.outcomes} == {"verified"}
    whole = nav.export(audit, to="python", out=tmp_path / "whole", run=False)
    assert [f["name"] for f in whole.document()["functions"]] == ["measure_H"]
    spec = importlib.util.spec_from_file_location("audited", tmp_path / "out" / "python" / "navsym_functions.py")
    spec.loader.exec_module(module := importlib.util.module_from_spec(spec))
    pose, mark = np.array([0.3, -2.0, 0.7]), np.array([6.0, 1.5])

    def predict(at):
        dx, dy = mark - at[:2]
        return np.array([np.hypot(dx, dy), dy * np.cos(at[2]) - dx * np.sin(at[2])])

    steps = 1e-6 * np.eye(3)
    expected = np.column_stack([(predict(pose + d) - predict(pose - d)) / 2e-6 for d in steps])
    np.testing.assert_allclose(np.reshape(module.spec_H(pose, mark), (2, 3)), expected, atol=1e-8)


def test_a_question_that_is_open_does_not_leave(tmp_path):
    (tmp_path / "measure.c").write_text(FAULTY.replace("sqrt(dx*dx + dy*dy)", "unknown(dx)"))
    (tmp_path / "spec.toml").write_text(QUESTION)
    with pytest.raises(nav.NavsymError, match="entry 1,1 of H, which is OPEN or has cases"):
        nav.export(f"{tmp_path / 'spec.toml'}:H", out=tmp_path / "out")


@pytest.mark.long
def test_a_model_runs_in_every_language_that_is_here(tmp_path):
    pytest.importorskip("ziglang", reason="WebAssembly needs ziglang (extra cross)")
    made = nav.export(str(EXAMPLES / "schuler-velocity.toml"), to=[*TARGETS], out=tmp_path, vectors=4)
    assert {outcome.status for outcome in made.outcomes} <= {"verified", "not executed"}
    assert sum(outcome.status == "verified" for outcome in made.outcomes) >= 3


# -- read back ---------------------------------------


def read_back(path: Path, parameters: dict[str, sp.Symbol]) -> dict[str, list[sp.Expr]]:
    """Results of a C function as formulas of its arguments, read by the audit; arrays without unread entries."""
    found: dict[str, list[sp.Expr]] = {}
    for output in nav.audit(path, path.stem).formulas:
        if output.name == "return" or output.formula.startswith("not read"):
            continue
        text = re.sub(r"\[(\d+)\]", r"_\1", output.formula)
        names = {s: sp.Symbol(s, real=True) for s in re.findall(r"[A-Za-z]\w*", text)}
        known = {n: s for n, s in (names | parameters).items() if n not in ("sin", "cos", "exp", "sqrt", "pi")}
        found.setdefault(output.name.partition("[")[0], []).append(parse(text, known))
    return found


def numbered(letter, count):
    return [sp.Symbol(f"{letter}_{k}", real=True) for k in range(count)]


def joseph(P, h, r):
    """Joseph's form as the textbook has it, on matrices."""
    K = P * h.T / ((h * P * h.T)[0] + r)
    L = sp.eye(P.rows) - K * h
    return L * P * L.T + K * r * K.T


def upper_entries(matrix):
    return [matrix[i, j] for i in range(matrix.rows) for j in range(i, matrix.rows)]


W = {"w": sp.Symbol("w", positive=True), "s": sp.Symbol("s", positive=True)}
ROWS = {"place": (sp.Matrix([[1, 0]]), sp.Rational(1, 100)), "both": (sp.Matrix([[sp.Rational(1, 2), 3]]), W["s"] ** 2)}


@pytest.mark.long
@pytest.mark.parametrize("name", ROWS)
def test_the_c_of_an_update_is_proved_to_be_josephs_form(oscillator, name):
    code = read_back(oscillator[0] / "c" / f"swing_update_{name}.c", W)
    P = sp.Matrix(symmetric(numbered("P", 3), 2))
    h, r = ROWS[name]
    wanted = upper_entries(joseph(P, h, r))
    assert decide(Equation(code["next_P"], wanted)).status == PROVED
    spoiled = [wanted[0] + r / 1000, *wanted[1:]]
    assert decide(Equation(code["next_P"], spoiled)).status == REFUTED
    x, z = sp.Matrix(numbered("x", 2)), sp.Symbol("z", real=True)
    moved = x + P * h.T / ((h * P * h.T)[0] + r) * (z - (h * x)[0])
    read = code["next_x"]  # the first result also carries the guards against underflow, which the audit does not read
    assert len(read) >= 1 and decide(Equation(read, list(moved)[-len(read) :])).status == PROVED


@pytest.mark.parametrize("name", ROWS)
def test_the_c_of_an_update_in_ud_form_is_proved_to_be_josephs_form(oscillator, name):
    code = read_back(oscillator[0] / "c" / f"swing_update_{name}_ud.c", W)
    U, D = sp.Matrix([[1, sp.Symbol("U_0", real=True)], [0, 1]]), sp.diag(*numbered("D", 2))
    V, E = sp.Matrix([[1, code["next_U"][0]], [0, 1]]), sp.diag(*code["next_D"])
    wanted = upper_entries(joseph(U * D * U.T, *ROWS[name]))
    assert decide(Equation(upper_entries(V * E * V.T), wanted)).status == PROVED
    assert decide(Equation(upper_entries(V * D * V.T), wanted)).status == REFUTED


def test_the_c_of_a_prediction_is_proved_to_be_phi_p_phi(oscillator):
    code = read_back(oscillator[0] / "c" / "swing_predict.c", W)
    w, dt = W["w"], sp.Symbol("dt", real=True)
    Phi = sp.Matrix([[sp.cos(w * dt), sp.sin(w * dt) / w], [-w * sp.sin(w * dt), sp.cos(w * dt)]])
    P, Q = (sp.Matrix(symmetric(numbered(letter, 3), 2)) for letter in "PQ")
    assert decide(Equation(code["next_P"], upper_entries(Phi * P * Phi.T + Q))).status == PROVED
    assert decide(Equation(code["next_P"], upper_entries(Phi.T * P * Phi + Q))).status == REFUTED
    matrices = {name: read_back(oscillator[0] / "c" / f"swing_{name}.c", W)[name] for name in ("F", "H", "Phi")}
    assert matrices["F"] == [0, 1, -(w**2), 0] and matrices["H"] == [1, 0, sp.Rational(1, 2), 3]
    assert decide(Equation(matrices["Phi"], list(Phi))).status == PROVED


# -- run beside another program ---------------------------------------


def test_the_noise_is_that_of_van_loan(oscillator):
    w, q = 1.7, np.diag([0.3, 0.8])
    F = np.array([[0.0, 1.0], [-(w**2), 0.0]])
    for dt in (0.5, 0.01):
        block = scipy.linalg.expm(np.block([[-F, q], [np.zeros((2, 2)), F.T]]) * dt)
        wanted = block[2:, 2:].T @ block[:2, 2:]
        got = np.array(symmetric(list(oscillator[1].swing_Qd(dt, [0.3, 0.8], w)), 2))
        np.testing.assert_allclose(got, wanted, rtol=1e-9)


def test_the_noise_of_a_small_step_keeps_its_digits(oscillator):
    """``(dt - sin(2 w dt)/(2 w))/(2 w^2)`` is q dt^3/3 up to (w dt)^2: doubles that cancel would lose all of it."""
    dt = 1e-7
    entry = oscillator[1].swing_Qd(dt, [0.0, 1.0], 1.0)[0]
    assert entry == pytest.approx(dt**3 / 3, rel=1e-12)


def test_both_forms_of_a_filter_agree_along_its_way(oscillator):
    swing, generator = oscillator[1], np.random.default_rng(1)
    x, P = np.zeros(2), np.array([[2.0, 0.3], [0.3, 1.0]])
    y, U, D = x.copy(), np.array([0.3]), np.array([2.0 - 0.09, 1.0])
    q, w, s, dt = [0.02, 0.1], 1.3, 0.4, 0.1
    Phi, H = np.reshape(swing.swing_Phi(dt, w), (2, 2)), np.reshape(swing.swing_H(), (2, 2))
    Q = np.array(symmetric(list(swing.swing_Qd(dt, q, w)), 2))
    dq = [Q[0, 0] - Q[0, 1] ** 2 / Q[1, 1], Q[1, 1]]
    a, flat, reference = x.copy(), P[np.triu_indices(2)], (x.copy(), P.copy())
    for _ in range(20):
        mean, cov = Phi @ reference[0], Phi @ reference[1] @ Phi.T + Q
        a, flat = swing.swing_predict(a, flat, Q[np.triu_indices(2)], dt, w)
        y, U, D = swing.swing_predict_ud(y, U, D, [Q[0, 1] / Q[1, 1]], dq, dt, w)
        for k, (name, r) in enumerate((("place", 0.01), ("both", s**2))):
            z, h = generator.normal(), H[k]
            extra = () if name == "place" else (s,)
            gain = cov @ h / (h @ cov @ h + r)
            mean, cov = mean + gain * (z - h @ mean), cov - np.outer(gain, h @ cov)
            a, flat = getattr(swing, f"swing_update_{name}")(a, flat, z, *extra)
            y, U, D = getattr(swing, f"swing_update_{name}_ud")(y, U, D, z, *extra)
        reference = mean, cov
        factor = np.array([[1.0, U[0]], [0.0, 1.0]])
        for m, c in ((a, np.array(symmetric(list(flat), 2))), (y, factor @ np.diag(D) @ factor.T)):
            np.testing.assert_allclose(m, mean, rtol=1e-9, atol=1e-12)
            np.testing.assert_allclose(c, cov, rtol=1e-9)


# -- theorems ---------------------------------------


@pytest.mark.parametrize("theorem", [models.orthogonal_rest, models.telescoped])
def test_the_steps_of_the_ud_form_are_theorems_and_a_wrong_sign_is_none(theorem):
    statement = theorem()
    assert decide(statement).status == PROVED
    assert (
        decide(Equation(statement.printed, sp.Matrix([statement.derived]).applyfunc(lambda e: -e - 1))).status != PROVED
    )


# -- what is asked for, and what is refused ---------------------------------------


def test_missing_ranges_are_asked_for_all_at_once():
    model = nav.Model("x v", F=[[0, 1], ["-w**2", 0]], H=["x"], w="positive", ranges={"x": ("-1", "1")})
    with pytest.raises(nav.NavsymError, match=r"got none of v, dt, w; write in the model file: \[ranges\] v = "):
        nav.export(model)


@pytest.mark.parametrize(
    ("ranges", "words"),
    [
        ({"y": ("0", "1")}, "expected a state, a parameter or dt"),
        ({"dt": ("0", "1")}, "ranges.dt"),
        ({"x": ("1", "-1")}, "ranges.x"),
        ({"x": ("1",)}, "ranges.x"),
    ],
)
def test_a_wrong_range_is_an_error_at_its_place(ranges, words):
    with pytest.raises(nav.NavsymError, match=words):
        nav.Model("x v", F=[[0, 1], [0, 0]], H=["x"], ranges=ranges)


def test_ranges_are_saved_and_read_back(tmp_path):
    model = nav.Model("x v", F=[[0, 1], [0, 0]], H=["x"], ranges=RANGES)
    model.save(tmp_path / "m.toml")
    assert nav.Model.load(tmp_path / "m.toml").document() == model.document()


@pytest.mark.long
@needs_compilers
def test_words_of_languages_and_libraries_never_collide(tmp_path):
    """States, parameters and measurements with names of C, of its library and of the code's own arrays."""
    with pytest.raises(nav.NavsymError, match="already means a function"):
        nav.Model("sin int", F=[[0, 1], [0, 0]], H=["int"])
    model = nav.Model(
        ["double", "int", "time"],
        F=[["0", "y0", "0"], ["0", "0", "x0"], ["0", "0", "0"]],
        H=[["lambda", "P0_0", "0"]],
        sigma="z",
        measurements=["exit"],
        name="main",
        ranges={"double": ("-1", "1"), "int": ("-1", "1"), "time": ("-1", "1"), "dt": ("1/100", "1")},
        parameters={name: ("1/2", "2") for name in ("y0", "x0", "lambda", "P0_0", "z", "K0", "q", "q1")},
    )
    made = nav.export(model, to=["c", "cpp", "python"], out=tmp_path, vectors=4)
    assert {outcome.status for outcome in made.outcomes} == {"verified"}
