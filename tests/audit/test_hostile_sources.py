"""Hostile sources: a clear error or refused lines, in bounded time, and never a guess."""

from __future__ import annotations

import time

import pytest

import navsym as nav
from navsym.core.errors import NavsymError

DEEP = "(" * 5_000 + "a" + ")" * 5_000
HOSTILE = {
    "deep": (f"double f(double a) {{ return {DEEP}; }}", ".c"),
    "deep-blocks": ("double f(double a) { " + "{" * 5_000 + "}" * 5_000 + " return a; }", ".c"),
    "long-line": ("double f(double a) { return a" + " + a" * 300_000 + "; }", ".c"),
    "huge": ("/*" + "x" * 2_100_000 + "*/ double f(double a) { return a; }", ".c"),
    "encoding": (b"double f(double a) { return a; } // \xff\xfe caf\xe9", ".c"),
    "nul": (b"double f(double a) { return a; }\0", ".c"),
    "recursion": ("double f(double a) { return f(a - 1.0); }", ".c"),
    "two-recursions": ("double g(double a) { return f(a); }\ndouble f(double a) { return g(a); }", ".c"),
    "endless": ("double f(double a) { for (int i = 0; i < 2000000000; i++) a = a + 1.0; return a; }", ".c"),
    "nested-loops": ("double f(double a) { " + "for (int i = 0; i < 99; i++) " * 4 + "a += 1.0; return a; }", ".c"),
    "huge-array": ("double f(double a) { double x[99999][99999] = {{0}}; return x[0][0]; }", ".c"),
    "macro-of-itself": ("#define A B\n#define B A\ndouble f(double a) { return A; }", ".c"),
    "macro-twice": ("#define A 1\n#undef A\n#define A 2\ndouble f(double a) { return A; }", ".c"),
    "if-0": ("double f(double a) {\n#if 0\n return 1;\n#else\n return a;\n#endif\n}", ".c"),
    "half": ("double f(double a) { return a +", ".c"),
    "empty": ("", ".c"),
    "power": ("def f(a):\n    return 9 ** 9 ** 9 ** 9\n", ".py"),
    "digits": ("def f(a):\n    return " + "9" * 100_000 + "\n", ".py"),
    "doubling": ("def f(a):\n" + "    a = a * a + a\n" * 200 + "    return a\n", ".py"),
    "python-import": ("def f(a):\n    return __import__('os').system('touch touched')\n", ".py"),
    "decorated": ("@exec\ndef f(a):\n    return a\n", ".py"),
    "matlab-eval": ("function y = f(a)\ny = eval('system(1)');\nend\n", ".m"),
    "name": ("double f(double a) { return a + " + "b" * 10_000 + "; }", ".c"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_source_is_answered_in_bounded_time(name, tmp_path):
    text, end = HOSTILE[name]
    path, start = tmp_path / f"hostile{end}", time.process_time()
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    try:
        answer = nav.audit(path, function="f")
    except NavsymError as error:
        assert error.where and error.expected and error.remedy
    else:
        known = ("a", "0") if name not in ("name", "power") else tuple(f.formula for f in answer.formulas)
        assert all(f.formula in known or f.formula.startswith(("not read: ", "not shown: ")) for f in answer.formulas)
    assert time.process_time() - start < 8.0
    assert not (tmp_path / "touched").exists()


@pytest.mark.parametrize("name", ["recursion", "macro-of-itself", "macro-twice", "if-0", "matlab-eval", "endless"])
def test_what_is_not_understood_is_refused_and_not_guessed(name, tmp_path):
    text, end = HOSTILE[name]
    path = tmp_path / f"hostile{end}"
    path.write_text(text)
    try:
        answer = nav.audit(path, function="f")
    except NavsymError:
        return
    assert answer.files[0].refused and all(f.formula.startswith("not read: ") for f in answer.formulas)


@pytest.mark.parametrize("ends", ["\r\n", "\r", "\n\t\t"])
def test_line_ends_and_tabs_change_nothing(ends, tmp_path):
    text = "double f(double a)\n{\n  double b = 2.0*a;\n  return b;\n}\n"
    path = tmp_path / "code.c"
    path.write_bytes(text.replace("\n", ends).encode())
    assert [f.formula for f in nav.audit(path, function="f").formulas] == ["2*a"]
