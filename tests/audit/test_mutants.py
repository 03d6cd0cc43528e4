"""One-token mutants of readable code: none is proved equal to the original unless it computes the same."""

from __future__ import annotations

import io
import math
import random
import tokenize
from pathlib import Path

import numpy as np
import pytest

import navsym as nav

GALLERY = Path(__file__).resolve().parents[2] / "examples" / "audit" / "gallery"
SHAPES = {"x": (3,), "u": (2,), "q": (4,), "a": (3,), "m": (3,), "R": (3, 3)}
SWAPS = {"+": "-", "-": "+", "*": "/", "/": "*", "**": "*", "@": "*", "T": "copy()", "cos": "sin", "sin": "cos"}
SWAPS |= {"0": "1", "1": "2", "2": "3", "3": "2", "0.5": "0.25", "x": "y", "y": "z", "z": "w", "w": "x", "v": "dt"}
FILES = ("rotation_sign", "gravity_objective", "magnetic_reference", "bearing_speed")


def mutants(text, number):
    """The source with one token of the function ``after`` replaced, some of all."""
    start = text.index("def after")
    stop = text.find("\n\n\ndef ", start)
    line, end = text[:start].count("\n") + 1, text[: stop if stop > 0 else len(text)].count("\n") + 1
    tokens = [t for t in tokenize.generate_tokens(io.StringIO(text).readline) if line < t.start[0] <= end]
    chosen = [t for t in tokens if t.string in SWAPS]
    rows = text.split("\n")
    for token in random.Random(3).sample(chosen, min(number, len(chosen))):
        row, column = token.start[0] - 1, token.start[1]
        changed = rows[row][:column] + SWAPS[token.string] + rows[row][column + len(token.string) :]
        yield "\n".join([*rows[:row], changed, *rows[row + 1 :]])


def compute(text, given):
    """What Python computes; None where it fails."""
    scope: dict[str, object] = {}
    try:
        with np.errstate(all="ignore"):
            exec(compile(text, "mutant", "exec"), scope)
            return np.ravel(scope["after"](**given))
    except (ArithmeticError, IndexError, NameError, TypeError, ValueError, SyntaxError, AttributeError):
        return None


@pytest.mark.parametrize("name", FILES)
def test_no_mutant_is_proved_equal_unless_it_computes_the_same(name, tmp_path):
    text, generator = (GALLERY / f"{name}.py").read_text(), random.Random(5)
    declared = {n: shape for n, shape in SHAPES.items() if f"({n}," in text or f", {n}," in text or f"({n})" in text
                or f" {n})" in text}  # fmt: skip
    sizes = "".join(f"{n} = {{ {'vector' if len(s) == 1 else 'matrix'} = {list(s)} }}\n" for n, s in declared.items())
    (tmp_path / "original.py").write_text(text)
    judged = 0
    for mutant in mutants(text, 12):
        (tmp_path / "mutant.py").write_text(mutant)
        spec = "".join(f'[[code]]\nname = "{n}"\nfile = "{n}.py"\nfunction = "after"\n[code.symbols]\n{sizes}'
                       for n in ("original", "mutant"))  # fmt: skip
        spec += '[[question]]\nname = "same"\nkind = "equal"\nleft = "mutant:return"\nright = "original:return"\n'
        (tmp_path / "spec.toml").write_text(spec)
        same = True
        for _ in range(3):
            names = text[text.index("def after(") + 10 :].split(")")[0].split(", ")
            given = {n: np.reshape([generator.uniform(0.1, 1) for _ in range(math.prod(declared.get(n, ())))],
                                   declared.get(n, ())) for n in names}  # fmt: skip
            first, second = compute(text, given), compute(mutant, given)
            same &= second is not None and first.shape == second.shape and np.allclose(first, second, atol=1e-9)
        try:
            status = nav.audit(tmp_path / "spec.toml")["same"].status
        except nav.NavsymError:
            continue
        if second is None:  # a name that nobody has defined is an input of audit, and an error of Python
            continue
        assert not (status == nav.PROVED and not same), mutant
        assert not (status == nav.REFUTED and same), mutant
        judged += status in (nav.PROVED, nav.REFUTED)
    assert judged >= 5
