"""The call of a function that nobody has defined is no value: two calls of a clock or a generator differ."""

from __future__ import annotations

import pytest

import navsym as nav

#: File -> an expression with two equal calls, whose difference nobody may take for zero.
CALLS = [
    ("c", "rand() - rand()"),
    ("c", "read_adc(1) - read_adc(1)"),
    ("c", "NOW - NOW"),
    ("cpp", "s.pop() - s.pop()"),
    ("cpp", "s.next(1) - s.next(1)"),
    ("cpp", "s.next()(0) - s.next()(0)"),
    ("cpp", "s->next().v - s->next().v"),
    ("hpp", "a - b"),
    ("py", "random.random() - random.random()"),
    ("py", "np.random.rand() - np.random.rand()"),
    ("m", "rand(3) - rand(3)"),
    ("m", "toc - toc"),
    ("rs", "rand() - rand()"),
    ("rs", "s.next() - s.next()"),
]
TEXTS = {
    "c": "#define NOW clock()\ndouble f(double x) {{ double y = x + {}; return y; }}\n",
    "cpp": "double f(double x, S s) {{ double y = x + {}; return y; }}\n",
    "hpp": "double f(double x, S s) {{ auto &a = s.at(0); auto &b = s.at(0); double y = x + {}; return y; }}\n",
    "py": "def f(x, s):\n    y = x + {}\n    return y\n",
    "m": "function y = f(x)\n  y = x + {};\nend\n",
    "rs": "pub fn f(x: f64, s: S) -> f64 {{ let y = x + {}; y }}\n",
}


def ask(folder, end, expression, symbols=""):
    """Status and reason of ``y = x`` behind ``y = x + expression``."""
    (folder / f"code.{end}").write_text(TEXTS[end].format(expression))
    spec = f'[[code]]\nname = "m"\nfile = "code.{end}"\nfunction = "f"\n[code.symbols]\n{symbols}\n'
    spec += '[[question]]\nname = "same"\nkind = "equal"\nleft = "m:y"\nright = "x"\n'
    (folder / "spec.toml").write_text(spec)
    (entry,) = nav.audit(folder / "spec.toml")["same"].entries
    return entry.status, entry.why


@pytest.mark.parametrize(("end", "expression"), CALLS, ids=str)
def test_two_calls_of_an_unknown_function_are_not_one_value(tmp_path, end, expression):
    status, why = ask(tmp_path, end, expression)
    assert status == nav.OPEN and why.startswith("not read: ")


@pytest.mark.parametrize(
    ("end", "expression", "symbols"),
    [
        ("cpp", "s.v(0) - s.v(0)", '"s.v" = { vector = 3 }'),
        ("cpp", "s.q().w - s.q().w", '"s.q().w" = "real"'),
        ("cpp", "cov(0, 1) - cov(0, 1)", "cov = { matrix = [2, 2] }"),
        ("m", "cov(1, 2) - cov(1, 2)", "cov = { matrix = [2, 2] }"),
    ],
)
def test_what_a_mapping_declares_is_one_value(tmp_path, end, expression, symbols):
    assert ask(tmp_path, end, expression, symbols)[0] == nav.PROVED
    assert ask(tmp_path, end, expression, "")[0] == nav.OPEN


@pytest.mark.parametrize(
    ("other", "status"),
    [("cov(0, 1) = 2;", nav.PROVED), ("double cov = 2; cov = 3;", nav.OPEN), ("s.v(0) = 2;", nav.OPEN)],
)
def test_an_entry_that_the_class_writes_is_no_call_and_a_local_name_is_none(tmp_path, other, status):
    end = f"return y; }} void C::g(void) {{ {other} "
    assert ask(tmp_path, "cpp", f"cov(0, 1) - cov(0, 1); {end}")[0] == status


#: File -> a text, its output, what that is, and a text in which it is not known.
MEANINGS = {
    "cpp": (
        "double f(const Vector2d &v) {{ Eigen::MatrixXd m = {}; double y = m(0) * m(1); return y; }}\n",
        ("v", "v[0]*v[1]", "w"),
    ),
    "py": (
        "import numpy as np\n\n\ndef g({}):\n    return 2 * a\n\n\ndef f(x):\n    y = np.sin(x)\n    return y\n",
        ("a=np.pi", "sin(x)", "a, np"),
    ),
}


@pytest.mark.parametrize("end", MEANINGS)
def test_a_matrix_of_open_size_has_that_of_its_value_and_a_default_binds_no_module(tmp_path, end):
    text, (known, meaning, unknown) = MEANINGS[end]
    for inside, right, status in ((known, meaning, nav.PROVED), (unknown, "0", nav.OPEN)):
        (tmp_path / f"code.{end}").write_text(text.format(inside))
        spec = f'[[code]]\nname = "m"\nfile = "code.{end}"\nfunction = "f"\n'
        spec += f'[[question]]\nname = "y"\nkind = "equal"\nleft = "m:y"\nright = "{right}"\n'
        (tmp_path / "spec.toml").write_text(spec)
        assert nav.audit(tmp_path / "spec.toml")["y"].status == status


def test_a_declared_accessor_of_a_vector_is_the_whole_vector(tmp_path):
    bodies = {"twice": "2.0f*s.v()", "sum": "s.v() + s.v()"}
    written = (f"Vector3f {name}(S s) {{ Vector3f y = {value}; return y; }}" for name, value in bodies.items())
    (tmp_path / "code.cpp").write_text("\n".join(written))
    spec = "".join(
        f'[[code]]\nname = "{name}"\nfile = "code.cpp"\nfunction = "{name}"\n'
        '[code.symbols]\n"s.v()" = { vector = 3 }\n'
        for name in bodies
    )
    spec += '[[question]]\nname = "same"\nkind = "equal"\nleft = "twice:y"\nright = "sum:y"\n'
    (tmp_path / "spec.toml").write_text(spec)
    assert [entry.status for entry in nav.audit(tmp_path / "spec.toml")["same"].entries] == [nav.PROVED] * 3
