"""What an answer takes for granted of the code is said in it; what may be something else is refused with its reason."""

from __future__ import annotations

import pytest

import navsym as nav
from navsym.cli.audit import as_text

CLASSES = """
class Three:
    def __get__(self, owner, kind=None): return 3.0
class Base:
    @property
    def x(self): return 2*self.k
    y = Three()
    z = property(lambda self: 1)
    w = 4.0
class Other(Base):
    def f(self, a):
        self.v = a
        return self.%s*a
"""
OWN = """
class Filter:
    @property
    def x(self): return 2*self.k
    def f(self, a): return self.x*a
def outside(c, a):
    c.x = a
    return c.x
"""
METHOD = "struct B {{ {}double k() const{} {{ return 2; }} double f(double a) const {{ return k()*a; }} }};\n"
IN_PLACE = "double E::f({} d) {{ x += d; y += d; return y; }}\n"
ROW = "double f(const double *P, double *K) { K[0] = P[0]; K[1] = P[1]; return 0; }\n"
SIZES = "[code.symbols]\nP = { vector = 2 }\nK = { vector = 2 }\n"


def ask(folder, end, source, left, right, more="", function="f"):
    """The answer to one question about a function."""
    (folder / f"source{end}").write_text(source)
    head = f'[[code]]\nname = "code"\nfile = "source{end}"\nfunction = "{function}"\n{more}\n'
    (folder / "spec.toml").write_text(f'{head}[[question]]\nkind = "equal"\nleft = "code:{left}"\nright = "{right}"\n')
    return nav.audit(folder / "spec.toml")


@pytest.mark.parametrize(
    ("end", "source", "right", "said"),
    [
        (".cpp", "template <typename T> T f(T a, T b) { T c = a/b; return c; }\n", "a/b", "taken as real: T"),
        (".cpp", "template <typename T> T f(const Vector<T, 2> &a) { return a(0); }\n", "a(0)", "taken as real: T"),
        (".cpp", "struct S { ftype x; double f(double a) { return x*a; } };\n", "x*a", "taken as real: ftype"),
        (".rs", "pub fn f<T: Real>(a: T, b: T) -> T { a/b }\n", "a/b", "taken as real: T"),
        (".m", "function y = f(a, b)\ny = a*b;\nend\n", "b*a", "sizes: scalar: a, b"),
        (".py", "def f(a, b):\n    return a*b\n", "b*a", "sizes: scalar: a, b"),
        (".cpp", "double E::k() { return 2; }\ndouble E::f(double a) { return k()*a; }\n", "2*a", "not overridden: k"),
        (".cpp", IN_PLACE.format("const double &"), "y + d", "apart in memory: d, x"),
    ],
)
def test_a_proof_that_rests_on_more_than_the_code_says_so(tmp_path, end, source, right, said):
    answer = ask(tmp_path, end, source, "y" if end == ".m" else "return", right)
    (question,) = answer.questions
    assert question.status == nav.PROVED and question.assumptions == (said,) == answer.assumptions
    assert said in as_text(answer)
    assert answer.document()["assumptions"] == answer.document()["questions"][0]["assumptions"] == [said]


@pytest.mark.parametrize(
    ("end", "source", "left", "right", "more"),
    [
        (".cpp", "using T = double;\nT f(T a, T b) { return a/b; }\n", "return", "a/b", ""),
        (".cpp", IN_PLACE.format("double"), "return", "y + d", ""),
        (".cpp", IN_PLACE.format("const double &"), "return", "y + d", 'distinct = ["d"]'),
        (".c", ROW, "K[1]", "P[1]", 'distinct = ["K"]\n' + SIZES),
        (".m", "function y = f(a, b)\ny = a*b;\nend\n", "y", "b*a", '[code.symbols]\na = "real"\nb = "positive"'),
        (".cpp", METHOD.format("", ""), "return", "2*a", ""),
        (".cpp", METHOD.format("", " final"), "return", "2*a", ""),
        (".py", OWN, "return", "2*self.k*a", '[code.symbols]\n"self.k" = "real"\na = "real"'),
    ],
)
def test_what_the_code_or_the_mapping_says_is_no_assumption(tmp_path, end, source, left, right, more):
    (question,) = ask(tmp_path, end, source, left, right, more).questions
    assert question.status == nav.PROVED and question.assumptions == ()


def test_pointers_that_may_overlap_are_named(tmp_path):
    (question,) = ask(tmp_path, ".c", ROW, "K[1]", "P[1]", SIZES).questions
    assert question.assumptions == ("apart in memory: K, P",)


@pytest.mark.parametrize(
    ("end", "source", "reason"),
    [
        (".cpp", METHOD.format("virtual ", ""), "virtual"),
        (".cpp", METHOD.format("", " override"), "override"),
        (".cpp", METHOD.format("__attribute__((weak)) ", ""), "weak"),
        (".c", "double k(void) __attribute__((weak));\ndouble k(void) { return 2; }\n"
         "double f(double a) { return k()*a; }\n",
         "weak"),
        (".py", CLASSES % "x", "self.x"), (".py", CLASSES % "y", "self.y"), (".py", CLASSES % "z", "self.z"),
        (".py", OWN.replace("def f", "def __getattr__(self, n): return 1\n    def f").replace("self.x", "self.q"),
         "self.q"),
    ],
)  # fmt: skip
def test_what_may_be_another_function_or_value_is_refused_with_line_and_reason(tmp_path, end, source, reason):
    answer = ask(tmp_path, end, source, "return", "2*a")
    (question,) = answer.questions
    ((line, why),) = answer.files[0].refused
    assert question.status == nav.OPEN and reason in why and reason in question.entries[0].why
    assert line == next(
        n for n, text in enumerate(source.split("\n"), 1) if "a) " in text or "self." + reason[5:] + "*a" in text
    )


def test_a_plain_member_of_a_class_is_read(tmp_path):
    for member, right in (("v", "a*a"), ("w", "a*w")):
        more = '[code.symbols]\n"self.w" = { name = "w" }'
        assert ask(tmp_path, ".py", CLASSES % member, "return", right, more).questions[0].status == nav.PROVED


def test_a_property_of_another_object_is_not_what_was_put_there(tmp_path):
    (question,) = ask(tmp_path, ".py", OWN, "return", "a", function="outside").questions
    assert question.status == nav.OPEN and "c.x" in question.entries[0].why


@pytest.mark.parametrize(
    ("end", "source"),
    [
        (".cpp", "struct A { double h(double x, double k = 2) { return x*k; } double f(double x) { return h(x); } };\n"
                 "struct B { double h(double x) { return 7*x; } };\n"),
        (".py", "class A:\n    def h(self, x, k=2):\n        return x*k\n    def f(self, x): return self.h(x)\n"
                "class B:\n    def h(self, x):\n        return 7*x\n"),
    ],
)  # fmt: skip
def test_a_function_with_a_value_left_out_is_not_taken_for_another_class_s(tmp_path, end, source):
    (question,) = ask(tmp_path, end, source, "return", "7*x").questions
    assert question.status == nav.OPEN and "definitions" in question.entries[0].why
