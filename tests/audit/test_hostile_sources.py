"""Hostile sources: a clear error or refused lines, in bounded time, and never a guess."""

from __future__ import annotations

import random
import re
import time
from collections import Counter
from pathlib import Path

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
    "if-some": ("double f(double a) {\n#if ZERO\n return 1;\n#else\n return a;\n#endif\n}", ".c"),
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


@pytest.mark.parametrize("name", ["recursion", "macro-of-itself", "macro-twice", "if-some", "matlab-eval", "endless"])
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


GALLERY = Path(__file__).resolve().parents[2] / "examples" / "audit" / "gallery"
TOKEN = re.compile(rb"\w+|\s+|[^\w\s]")
PIECES = rb"( ) { } [ ] ; ' \ /* # = * & -> :: end else for return @ % < ? : lambda if while goto .. 0x 1e999".split()
PIECES += [b"", b"\n", b"\t", b"\r", b"\0", b"\xff", b"\xef\xbb\xbf", b"9" * 40, b"#if 0\n"]


def spoil(source, draw):
    """The source with one to three bytes or tokens lost, doubled, exchanged or replaced."""
    for _ in range(draw.randint(1, 3)):
        spans = [m.span() for m in TOKEN.finditer(source)] or [(0, 0)]
        (a, b), (c, d) = draw.choice(spans), draw.choice(spans)
        kind, at = draw.randrange(6), draw.randrange(len(source) + 1)
        if kind == 0:
            source = source[:at] + bytes([draw.randrange(256)]) + source[at + 1 :]
        elif kind == 1:
            source = source[:at]
        elif kind == 2:
            source = source[:a] + source[c:d] + source[b:]
        elif kind == 3:
            source = source[:a] + source[a:b] * draw.choice((0, 2, 50)) + source[b:]
        elif kind == 4:
            source = source[:a] + source[min(a, c) : max(b, d)] + source[b:]
        else:
            source = source[:a] + draw.choice(PIECES) + source[draw.choice((a, b)) :]
    return source


def attack(folder, path, number, seed):
    """The counts of answers and of errors for spoiled copies of a file, and the longest time."""
    draw, counts, longest = random.Random(f"{path.name}{seed}"), Counter(), 0.0
    for _ in range(number):
        copy, start = folder / f"copy{path.suffix}", time.process_time()
        copy.write_bytes(spoil(path.read_bytes(), draw))
        try:
            nav.audit(copy, function=draw.choice(("before", "after")))
            counts["answer"] += 1
        except NavsymError as error:
            assert error.expected and error.remedy and "\n" not in str(error)
            counts[error.kind] += 1
        longest = max(longest, time.process_time() - start)
    return counts, longest


@pytest.mark.parametrize("end", [".c", ".cpp", ".py", ".m", ".rs"])
@pytest.mark.parametrize("number", [60, pytest.param(2000, marks=pytest.mark.slow)])
def test_spoiled_copies_of_the_examples_are_answered_or_refused_in_bounded_time(end, number, tmp_path):
    files = sorted(path for path in GALLERY.iterdir() if path.suffix == end)
    total, longest = Counter(), 0.0
    for path in files:
        counts, seconds = attack(tmp_path, path, -(-number // len(files)), number)
        total, longest = total + counts, max(longest, seconds)
    print(end, dict(total), f"longest {longest:.2f} s")
    assert total["answer"] > total.total() / 5 and longest < 8.0
