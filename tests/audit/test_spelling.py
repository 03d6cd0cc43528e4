"""Blanks, parentheses and signs in any order: an expression of the source means what the language says it means."""

from __future__ import annotations

import random

import pytest

from navsym.audit.mend import evaluate
from navsym.audit.names import Names
from navsym.audit.values import Scalar
from tests.attacks.campaigns.code import Subject, compute, draw_points, is_same, lacking_tool, read_code

NUMBER = 60
FORMS = {
    "c": "void f(double a, double b, double c, double d, double y[{n}])\n{{\n{body}\n}}\n",
    "cpp": "void f(double a, double b, double c, double d, double y[{n}])\n{{\n{body}\n}}\n",
    "rust": "pub fn f(a: f64, b: f64, c: f64, d: f64, y: &mut [f64; {n}]) {{\n{body}\n}}\n",
    "python": "def f(a, b, c, d):\n    y = [0.0]*{n}\n{body}\n    return y\n",
    "matlab": "function y = f(a, b, c, d)\n    y = zeros(1, {n});\n{body}\nend\n",
}
LINES = {"matlab": "    y({one}) = {text};", "python": "    y[{k}] = {text}"}


def write_expression(chosen, language, depth):
    """A random expression, with blanks and parentheses that need not be there."""
    blank = chosen.choice(("", " ", " ", "  "))
    if depth == 0 or chosen.random() < 0.2:
        name = chosen.choice("abcd")
        return f"({blank}{name}{blank})" if chosen.random() < 0.4 else name
    inner = write_expression(chosen, language, depth - 1)
    kind = chosen.random()
    if kind < 0.15:
        return f"-{blank}{inner}" if not inner.startswith("-") or language == "python" else f"-({inner})"
    if kind < 0.35:
        return f"({blank}{inner}{blank})"
    if kind < 0.45 and language in ("python", "matlab"):
        return f"{inner}{blank}{'**' if language == 'python' else '^'}{chosen.choice((blank, ' '))}2"
    if kind < 0.5 and language != "rust":
        return f"{'np.' if language == 'python' else ''}cos({blank}{inner}{blank})"
    sign = chosen.choice("+-*/")
    other = write_expression(chosen, language, depth - 1)
    return f"{inner}{blank}{sign}{' ' if other.startswith(('-', '*')) else chosen.choice((blank, ' '))}{other}"


@pytest.mark.parametrize("seed", [1, *(pytest.param(s, marks=pytest.mark.long) for s in range(2, 6))])
@pytest.mark.parametrize("language", FORMS)
def test_random_spellings_are_read_as_they_run(language, seed):
    """All are read, but towers of powers with signs inside; the compiler or interpreter computes the same."""
    if why := lacking_tool(language):
        pytest.skip(why)
    chosen = random.Random(f"{language} {seed}")
    texts = [write_expression(chosen, language, 4) for _ in range(NUMBER)]
    line = LINES.get(language, "    y[{k}] = {text};")
    body = "\n".join(line.format(k=k, one=k + 1, text=text) for k, text in enumerate(texts))
    head = {
        "python": "import numpy as np\n\n\n",
        "c": "#include <math.h>\n",
        "cpp": "#include <cmath>\nusing std::cos;\n",
    }
    text = head.get(language, "") + FORMS[language].format(n=NUMBER, body=body)
    subject, names = Subject("", text, "f", language), Names()
    (case,) = read_code("code", text, subject, names).read().cases
    (ran,) = compute([text], subject, seed)
    assert ran is not None
    cells = [*case.variables["y"].cells.values()][-NUMBER:]
    read = 0
    for k, (spelled, cell) in enumerate(zip(texts, cells, strict=True)):
        for at, point in enumerate(draw_points(subject, seed)):
            given = {names.symbols[n]: float(v[0]) for n, v in zip("abcd", point, strict=False) if n in names.symbols}
            value = evaluate(cell.tree, given) if isinstance(cell, Scalar) else None
            if value is not None:
                read += 1
                assert is_same([value], [ran[at * NUMBER + k]]) is not False, spelled
    assert read >= 3.5 * NUMBER
