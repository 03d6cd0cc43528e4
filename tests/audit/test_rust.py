"""Rust: what a line means, quaternions of nalgebra against Hamilton's rules, and what is refused with its reason."""

from __future__ import annotations

import pytest

import navsym as nav
from tests.audit.test_reading import final, read

HEAD = """use nalgebra::{Quaternion, Vector3};
const HALF: f64 = 0.5;
fn half(x: f64) -> f64 { x * HALF }
fn clear(mut v: [f64; 2]) -> f64 { v[0] = 0.0; v[1] }
fn change(v: &mut [f64; 2]) { v[0] = 0.0; }
struct State { attitude: UnitQuaternion<f64>, rate: Vector3<f64>, gain: f64 }
"""


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("*y = 1.0 / 2.0 + a;", "1/2 + a"),
        ("let n = 7; *y = ((n / 2) as f64) * a;", "3*a"),
        ("*y = half(a) + half(2.0 * a);", "a*(1/2) + (2*a)*(1/2)"),
        ("let v = [a, b]; let w = clear(v); *y = v[0] + w;", "a + b"),
        ("let mut v = [a, b]; change(&mut v); *y = v[0] + v[1];", "b"),
        ("let mut v = [a, b]; let r = &mut v; r[1] = a; *y = v[1];", "a"),
        ("let mut s = 0.0; for i in 0..3 { s += (i as f64) * a; } *y = s;", "a + 2*a"),
        ("let mut s = 0.0; for i in 1..=2 { s += (i as f64) * a; } *y = s;", "a + 2*a"),
        ("*y = if a > b { a } else { b };", "a"),
        ("*y = a.powi(2) + b.sin() + f64::sqrt(a);", "a**2 + sin(b) + sqrt(a)"),
        ("*y = a.max(b);", "a"),
        ("let v = Vector3::new(a, b, 1.0); *y = v.dot(&v);", "a*a + b*b + 1"),
        ("let v = Vector3::new(a, b, 1.0); let w = v * v; *y = w[0];", "the product of two columns"),
        ("*y = a; while a > 0.0 { *y = b; }", "a loop that does not count from one constant to another"),
        ("*y = a; match b { _ => { *y = b; } }", "a statement outside the language of audit (match expression)"),
        ("*y = read(a)?;", "an expression outside the language of audit (try expression)"),
        ("*y = a; hide!(y);", "a statement outside the language of audit (macro invocation)"),
        ("*y = 0x10 as f64;", "the number 0x10"),
        ("*y = unknown(a);", "the function unknown, which this file does not define"),
    ],
)
def test_a_line_of_rust_means_what_rust_says_or_is_refused_with_its_reason(tmp_path, body, expected):
    result = read(tmp_path, f"{HEAD}fn f(a: f64, b: f64, y: &mut f64) {{ {body} }}", end=".rs")
    assert final(result, "y") == expected


QUATERNIONS = (
    HEAD
    + """
impl State {
    fn turn(&mut self, dt: f64) {
        let q = self.attitude.as_ref();
        let rate = q * Quaternion::from_parts(0.0, self.rate) * HALF;
        self.attitude = UnitQuaternion::from_quaternion(q + rate * dt);
    }
    fn between(&self) -> Quaternion<f64> {
        let q = self.attitude.as_ref();
        q.conjugate() * q
    }
    fn rotated(&self, v: &Vector3<f64>) -> Quaternion<f64> {
        let q = self.attitude.as_ref();
        q * Quaternion::from_parts(0.0, *v) * q.conjugate()
    }
    fn checked(&self, v: &Vector3<f64>) -> Result<Vector3<f64>, Fault> {
        let Some(u) = v.try_normalize(0.0) else { return Err(Fault::Zero); };
        Ok(u * self.gain)
    }
}
"""
)
RELATION = '"self.attitude[0]**2 + self.attitude[1]**2 + self.attitude[2]**2 + self.attitude[3]**2 = 1"'


def ask(tmp_path, function, questions, relations=""):
    """The verdicts on questions about a function of the source above."""
    (tmp_path / "state.rs").write_text(QUATERNIONS)
    head = f'[[code]]\nname = "s"\nfile = "state.rs"\nfunction = "{function}"\nrelations = [{relations}]\n'
    spec = head.replace("relations = []\n", "") + questions
    (tmp_path / "spec.toml").write_text(spec)
    return nav.audit(tmp_path / "spec.toml")


def test_a_conjugate_times_its_quaternion_is_the_square_of_its_length(tmp_path):
    question = '[[question]]\nname = "q"\nkind = "equal"\nleft = "s:return[3]"\nright = "{}"\n'
    square = "self.attitude[0]**2 + self.attitude[1]**2 + self.attitude[2]**2 + self.attitude[3]**2"
    assert ask(tmp_path, "between", question.format(square))["q"].status == nav.PROVED
    assert ask(tmp_path, "between", question.format("1"))["q"].status == nav.REFUTED
    audit = ask(tmp_path, "between", question.format("1"), RELATION)
    assert audit["q"].status == nav.PROVED and audit["q"].sense == "manifold"


def test_a_rotated_vector_keeps_its_length_and_has_no_real_part(tmp_path):
    real = '[[question]]\nname = "real"\nkind = "equal"\nleft = "s:return[3]"\nright = "0"\n'
    first = '[[question]]\nname = "first"\nkind = "equal"\nleft = "s:return[0]"\nright = "{}"\n'
    x, y, z, w = (f"self.attitude[{k}]" for k in range(4))
    textbook = f"({w}**2 + {x}**2 - {y}**2 - {z}**2)*v[0] + 2*({x}*{y} - {w}*{z})*v[1] + 2*({x}*{z} + {w}*{y})*v[2]"
    audit = ask(tmp_path, "rotated", real + first.format(textbook))
    assert audit["real"].status == nav.PROVED == audit["first"].status
    spoiled = ask(tmp_path, "rotated", first.format(textbook.replace("- " + w, "+ " + w)))
    assert spoiled["first"].status == nav.REFUTED


def test_a_normalized_quaternion_has_length_one_and_an_error_computes_nothing(tmp_path):
    unit = '[[question]]\nname = "unit"\nkind = "unit"\nof = "s:self.attitude"\n'
    assert ask(tmp_path, "turn", unit)["unit"].status == nav.PROVED
    length = '[[question]]\nname = "n"\nkind = "equal"\nleft = "s:return[0]"\nright = "{}"\n'
    of = "self.gain*v[0]/sqrt(v[0]**2 + v[1]**2 + v[2]**2)"
    assert ask(tmp_path, "checked", length.format(of))["n"].status == nav.PROVED
    assert ask(tmp_path, "checked", length.format(f"2*{of}"))["n"].status == nav.REFUTED


@pytest.mark.parametrize("value", ["self.scale()", "Self::one()", "Self::K"])
def test_what_each_type_of_a_trait_may_define_otherwise_is_not_read(tmp_path, value):
    head = "trait Scale {\n    const K: f64 = 2.0;\n    fn scale(&self) -> f64 { 2.0 }\n    fn one() -> f64 { 2.0 }\n"
    trait = f"{head}    fn f(&self, a: f64, y: &mut f64) {{ *y = {value} * a; }}\n}}\n"
    assert final(read(tmp_path, trait, end=".rs"), "y") != "2*a"
    own = trait.replace("trait Scale", "impl Scale for A")
    assert final(read(tmp_path, own, end=".rs"), "y") == "2*a"
