"""Traps of meaning: what is read of a function is what it computes, by compilers, numpy and Octave."""

from __future__ import annotations

from collections import Counter

import pytest

import navsym as nav
from tests.attacks.campaigns.code import TOOLS, Subject, lacking_tool
from tests.attacks.traps import list_traps, read_trap

LONG = pytest.mark.long


@pytest.mark.parametrize(
    ("language", "every"),
    [("python", 8), ("c", 8), *(pytest.param(name, 1, marks=LONG) for name in ("python", *TOOLS))],
)
def test_what_is_read_of_a_trap_is_what_it_computes(language, every):
    if why := lacking_tool(language):
        pytest.skip(why)
    answers = {trap.name: read_trap(trap) for trap in [*list_traps(language)][::every]}
    assert {name: notes for name, (answer, notes) in answers.items() if answer in ("wrong", "silent")} == {}
    counts = Counter(answer for answer, _ in answers.values())
    assert counts["right"] >= len(answers) // 4  # what is refused is never wrong


def test_a_wrong_reading_is_noticed(monkeypatch):
    trap = Subject("f", "def f(a):\n    return a / 2 if a > 1 else a\n", "f", "python")
    assert read_trap(trap) == ("right", [])
    monkeypatch.setattr("tests.attacks.traps.compute", lambda *_: [[5.0, 6.0, 7.0, 8.0]])
    assert read_trap(trap)[0] == "wrong"


#: Rust with nalgebra, without a compiler: what is read, beside the textbook formula, or why it is not read.
NALGEBRA = {
    "Matrix2::new(a, b, 3.0, 4.0) * Vector2::new(1.0, a)": ["a + b*a", "3 + 4*a"],
    "Matrix2::new(a, b, 3.0, 4.0).transpose() * Vector2::new(1.0, a)": ["a + 3*a", "b + 4*a"],
    "Vector3::new(a, b, 1.0).cross(&Vector3::new(1.0, b, a))": ["b*a - b", "1 - a**2", "a*b - b"],
    "Vector2::new(a, b) * Vector2::new(a, b).norm_squared()": ["a*(a**2 + b**2)", "b*(a**2 + b**2)"],
    "(Quaternion::new(0.0, 1.0, 0.0, 0.0) * Quaternion::new(a, 0.0, b, 0.0)).into()": ["a", "0", "b", "0"],
    "UnitQuaternion::new_unchecked(Quaternion::new(0.0, 0.0, 0.0, 1.0)) * Vector3::new(a, b, 1.0)": ["-a", "-b", "1"],
}
REFUSED = ("Matrix2::new(a, b, 3.0, 4.0)[1]", "Matrix2::new(a, b, 3.0, 4.0).fixed_view::<1, 2>(0, 0)",
           "UnitQuaternion::from_euler_angles(a, b, 0.0)", "Matrix2::from_column_slice(&[a, b, 1.0, 2.0])",
           "Vector2::new(a, b) * Vector2::new(a, b)")  # fmt: skip


def ask(folder, expression, cells):
    """Status and reason of each cell of an expression of Rust."""
    (folder / "code.rs").write_text(f"pub fn f(a: f64, b: f64) -> Vector2<f64> {{ {expression} }}\n")
    spec = '[[code]]\nname = "m"\nfile = "code.rs"\nfunction = "f"\n'
    for k, cell in enumerate(cells):
        left = "m:return" if len(cells) == 1 else f"m:return[{k}]"
        spec += f'[[question]]\nname = "{k}"\nkind = "equal"\nleft = "{left}"\nright = "{cell}"\n'
    (folder / "spec.toml").write_text(spec)
    return [(str(q.status), q.entries[0].why if q.entries else "") for q in nav.audit(folder / "spec.toml").questions]


@pytest.mark.parametrize("expression", NALGEBRA)
def test_nalgebra_means_the_textbook_formula(tmp_path, expression):
    assert {status for status, _ in ask(tmp_path, expression, NALGEBRA[expression])} == {"PROVED"}
    wrong = [f"{cell} + 1" for cell in NALGEBRA[expression]]
    assert {status for status, _ in ask(tmp_path, expression, wrong)} == {"REFUTED"}


@pytest.mark.parametrize("expression", REFUSED)
def test_what_is_not_known_of_nalgebra_is_refused_in_words(tmp_path, expression):
    ((status, why),) = ask(tmp_path, expression, ["a"])
    assert status == "OPEN" and len(why) > 10
