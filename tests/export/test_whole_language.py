"""Claims with vectors, integrals, derivatives and cases leave as code of a closed side, entry by entry."""

from __future__ import annotations

import importlib.util
import math
import random

import pytest

import navsym as nav
from navsym.core.errors import NavsymError

HEAD = """[symbols]
x = "real"
T = ["1/2", "2"]
w = "positive"
s = ["0", "1"]
u = { vector = 3 }
v = { vector = 3 }
C = { rotation = "b to n" }
P = { matrix = [2, 2], symmetric = true }
L = { function = "t", range = ["-pi/2", "pi/2"] }
[rates]
L = "x"
[[claim]]
id = "it"
"""


def cross(u, v):
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]


def times(C, u):
    """A matrix in one list, row by row, times a vector."""
    return [sum(C[len(u) * i + j] * u[j] for j in range(len(u))) for i in range(len(C) // len(u))]


#: Both sides of a claim, the arguments in their order with their sizes, and the value by hand.
CASES = {
    "integral left": ("integral(sin(w*s), s, 0, T)", "(1 - cos(w*T))/w", "T w", lambda T, w: (1 - math.cos(w * T)) / w),
    "integral right": ("T**2/2", "integral(s, s, 0, T)", "T", lambda T: T * T / 2),
    "derivative": ("diff(x*sin(x), x)", "sin(x) + x*cos(x)", "x", lambda x: math.sin(x) + x * math.cos(x)),
    "rate": ("dot_(sin(L))", "x*cos(L)", "L x", lambda L, x: x * math.cos(L)),
    "cases left": ("min(x, 1)", "(x + 1 - abs(x - 1))/2", "x", lambda x: min(x, 1.0)),
    "vector": ("cross(u, v)", "-cross(v, u)", "u:3 v:3", cross),
    "number of vectors": ("dot(u, v)", "dot(v, u)", "u:3 v:3", lambda u, v: sum(map(lambda a, b: a * b, u, v))),
    "matrix": ("C @ u", "C.T.T @ u", "C:9 u:3", times),
    "part of a vector": ("u[1] + integral(s, s, 0, T)", "u[1] + T**2/2", "u:3 T", lambda u, T: u[0] + T * T / 2),
    "symmetric": ("P @ [x, 1]", "P.T @ [x, 1]", "P_1_1 P_1_2 P_2_2 x", lambda a, b, c, x: [a * x + b, b * x + c]),
}


def written(tmp_path, left, right, relation="=", more=""):
    path = tmp_path / "it.toml"
    path.write_text(f'{HEAD}left = "{left}"\nright = "{right}"\nrelation = "{relation}"\n{more}')
    return f"{path}:it"


@pytest.mark.parametrize("name", CASES)
def test_the_code_of_a_closed_side_has_its_value(name, tmp_path):
    left, right, arguments, value = CASES[name]
    nav.export(written(tmp_path, left, right), to=["python"], out=tmp_path / "code")
    spec = importlib.util.spec_from_file_location("code", tmp_path / "code" / "python" / "navsym_functions.py")
    code = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(code)
    draw = random.Random(1)
    sizes = [int(size or 0) for _, _, size in (word.partition(":") for word in arguments.split())]
    for _ in range(20):
        given = {
            word.partition(":")[0]: [draw.uniform(0.5, 1.5) for _ in range(size)] if size else draw.uniform(0.5, 1.5)
            for word, size in zip(arguments.split(), sizes, strict=True)
        }
        found, expected = code.it_it(**given), value(*given.values())
        entries = expected if isinstance(expected, list) else [expected]
        assert [float(x) for x in (found if isinstance(expected, list) else [found])] == pytest.approx(entries)
    assert all(done.status == "ACCEPTED" for done in nav.check(tmp_path / "code"))


@pytest.mark.parametrize(
    ("left", "right", "relation", "more", "message"),
    [
        ("integral(exp(-s**2), s, 0, T)", "integral(exp(-(T-s)**2), s, 0, T)", "=", "", "a side without"),
        ("dot(u, u)", "0", ">=", "", "expected one exact equation .*; got 'dot"),
        ("sin(x)", "x", "=", "order = { x = 3 }", "expected one exact equation .*; got 'sin"),
        ("integral(s, s, 0, T)", "T**2", "=", "", "which is refuted; correct it first"),
        ("where(x > 0, x, -x)", "max(x, -x)", "=", "", "a side without"),
        ("erf(x) + 0", "erf(x)", "=", "", "a side without .*erf.*got 'erf"),
        ("x - floor(x)", "-(floor(x) - x)", "=", "", "a side without .*floor.*got 'x - floor"),
    ],
)
def test_what_has_no_closed_side_is_refused_with_its_claim_and_a_remedy(tmp_path, left, right, relation, more, message):
    with pytest.raises(NavsymError, match=message) as caught:
        nav.export(written(tmp_path, left, right, relation, more), to=["python"], out=tmp_path / "code")
    assert "; " in str(caught.value) and not (tmp_path / "code").exists()


def test_a_whole_number_and_a_range_without_an_end_leave_as_declared(tmp_path):
    """The code of a sum up to n names n as whole and takes none below 1; it was refused, or a function of any n."""
    text = '[symbols]\nn = { integer = ["1", "oo"] }\nx = { range = ["-oo", "3"] }\n[[claim]]\nid = "it"\n'
    (tmp_path / "it.toml").write_text(text + 'left = "x*sum(k, k, 1, n)"\nright = "x*n*(n + 1)/2"\n', encoding="utf-8")
    nav.export(f"{tmp_path}/it.toml:it", to=["python"], out=tmp_path / "code")
    source = (tmp_path / "code" / "python" / "navsym_functions.py").read_text(encoding="utf-8")
    assert "n: 1 <= n, n whole; accepted from 1.0 on" in source and "x: x <= 3; accepted up to 3.0" in source


def test_a_verdict_of_vectors_leaves_as_its_file_would(tmp_path):
    verdict = nav.prove("cross(u, v) = -cross(v, u)", u={"vector": 3}, v={"vector": 3})
    nav.export(verdict, to=["c"], out=tmp_path / "code")
    header = next((tmp_path / "code" / "c").glob("*.h")).read_text(encoding="utf-8")
    assert "const double u[3]" in header and "const double v[3]" in header
