"""Faults of one token are mended: each kind of fault by its own correction, and random ones nearly always."""

from __future__ import annotations

import importlib
import random
from collections import Counter
from pathlib import Path

import pytest

import navsym as nav
from tests.attacks.campaigns.code import decide_mutant, list_mutants, list_subjects

HEAD = "#include <math.h>\nstatic double product(double a, double b)\n{\n    return a - 2*b;\n}\n"
START = "void f(const double x[3], double dt, double s, double c, double y[3])\n{\n"
ORIGINAL = [
    "const double r = s*x[0] - c*x[1];",
    "const double k = dt*dt*x[2];",
    "y[0] = 1.0; y[1] = dt;",
    "for (int i = 0; i < 2; i++) { y[0] += r*x[i] + c; }",
    "y[2] = product(r, k) + sqrt(x[0]*x[0] + 4.0)*dt;",
]
LAST = "product(r, k) + sqrt(x[0]*x[0] + 4.0)*dt"
#: Kind of fault: the line, what stands there, what a fault makes of it, and what the mend says.
FAULTS = {
    "sign": (0, "- c*x[1]", "+ c*x[1]", "s*x[0] - c*x[1]"),
    "index": (0, "s*x[0]", "s*x[2]", "s*x[0] - c*x[1]"),
    "factor": (4, "4.0", "2.0", LAST),
    "power": (1, "dt*dt*", "dt*", "(dt*dt)*x[2]"),
    "missing term": (3, " + c;", ";", "r*x[i] + c"),
    "operator": (1, "dt*dt*", "dt/dt*", "dt*dt*x[2]"),
    "swapped argument": (4, "product(r, k)", "product(k, r)", LAST),
    "function": (4, "sqrt(x", "cos(x", LAST),
    "name": (0, "- c*", "- dt*", "s*x[0] - c*x[1]"),
    "array": (3, "r*x[i]", "r*y[i]", "r*x[i] + c"),
    "target": (4, "y[2] =", "y[0] =", f"y[2] = {LAST}"),
    "declared name": (1, "double k", "double r", "k = dt*dt*x[2]"),
    "bound of a loop": (3, "i < 2", "i < 1", "2"),
}


def audit_fault(folder, line, old, new):
    """The question whether the code with a fault computes the same as the code without."""
    lines = [*ORIGINAL]
    assert lines[line].count(old) == 1
    lines[line] = lines[line].replace(old, new)
    for name, body in (("right", ORIGINAL), ("wrong", lines)):
        (folder / f"{name}.c").write_text("\n    ".join([HEAD + START, *body, "\n}\n"]))
    spec = "".join(f'[[code]]\nname = "{n}"\nfile = "{n}.c"\nfunction = "f"\n' for n in ("right", "wrong"))
    question = '[[question]]\nname = "same"\nkind = "equal"\nleft = "wrong:y"\nright = "right:y"\n'
    (folder / "spec.toml").write_text(spec + question)
    return nav.audit(folder / "spec.toml")["same"]


#: Every second kind in every run, the others in the long ones.
KINDS = [pytest.param(kind, marks=[pytest.mark.long] * (place % 2)) for place, kind in enumerate(FAULTS)]


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_of_fault_is_mended(kind, tmp_path):
    line, old, new, mend = FAULTS[kind]
    question = audit_fault(tmp_path, line, old, new)
    refuted = [entry for entry in question.entries if entry.status == nav.REFUTED]
    assert refuted and all(entry.suggestion for entry in refuted)
    assert mend.replace(" ", "") in {entry.suggestion.replace(" ", "") for entry in refuted}


def test_a_fault_of_two_places_is_not_mended_by_one_and_no_suggestion_is_made_up(tmp_path):
    lines = ["const double r = s*x[0] - c*x[1];", "const double k = dt*dt*x[2];"]
    wrong = (
        HEAD
        + START
        + "\n".join([lines[0].replace("-", "+"), lines[1].replace("dt*dt*", ""), "y[0] = sin(r + k);\n}\n"])
    )
    right = HEAD + START + "\n".join([*lines, "y[0] = sin(r + k);\n}\n"])
    for name, text in (("right", right), ("wrong", wrong)):
        (tmp_path / f"{name}.c").write_text(text)
    spec = "".join(f'[[code]]\nname = "{n}"\nfile = "{n}.c"\nfunction = "f"\n' for n in ("right", "wrong"))
    question = '[[question]]\nname = "same"\nkind = "equal"\nleft = "wrong:y[0]"\nright = "right:y[0]"\n'
    (tmp_path / "spec.toml").write_text(spec + question)
    (entry,) = nav.audit(tmp_path / "spec.toml")["same"].entries
    assert entry.status == nav.REFUTED
    assert entry.suggestion is None or "dt" in entry.suggestion  # the whole formula, written at the place of the entry


def test_random_faults_of_one_token_are_mended_nearly_always():
    """In C, Python, MATLAB and Rust."""
    chosen, counts = random.Random(2026), Counter()
    subjects = [s for s in list_subjects() if s.function in ("before", "after")]
    while counts.total() < 12:
        subject = chosen.choice(subjects)
        counts.update(
            [mended] if (mended := decide_mutant(subject, chosen.choice(list_mutants(subject)), True)[1]) else []
        )
    assert counts["mended"] >= 11


GALLERY = Path(__file__).resolve().parents[2] / "examples" / "audit" / "gallery"


@pytest.mark.parametrize("name", ["bearing_speed", "joseph_column", "product_in_place"])
def test_mends_that_are_sifted_in_one_run_are_those_that_single_runs_find(name, monkeypatch):
    mends, runs = [], Counter()
    execute, mend = (importlib.import_module(f"navsym.audit.{name}") for name in ("execute", "mend"))
    read, sift = execute.list_cases, mend.sift
    for is_alone in (False, True):
        monkeypatch.setattr(execute, "list_cases", lambda *a, k=is_alone: runs.update([k]) or read(*a))
        monkeypatch.setattr(mend, "sift", (lambda mends, *_: iter(mends)) if is_alone else sift)
        mends.append([(e.line, e.suggestion) for e in nav.audit(GALLERY / f"{name}.toml")["before"].entries])
    assert mends[0] == mends[1] and any(text for _, text in mends[0])
    assert 3 * runs[False] < runs[True]


#: Body of a function in Python: what is wrong in it, and the mend, with a name of what is expected or another group.
BODIES = {
    "group": ("(a - b)*s + k", "a - b*s + k"),
    "divisor": ("k*(a - b)", "k/s*(a - b)"),
    "constant": ("3.0", "2.0"),
    "names as of what is sought": ("gapx0 - gapxx0", "gapx0 + gapxx0"),
    "name of what is expected": ("k*a - u", "k*a - b"),
    "square of a divisor": ("(a + k)*s", "(a + k)/(s*s)"),
}


@pytest.mark.parametrize("kind", BODIES)
def test_a_mend_uses_what_is_expected(kind, tmp_path):
    wrong, right = BODIES[kind]
    (tmp_path / "f.py").write_text(f"def f(a, s, k, u, gapx0, gapxx0):\n    return {wrong}\n")
    (tmp_path / "g.py").write_text(f"def g(a, b, s, k, gapx0, gapxx0):\n    return {right}\n")
    spec = "".join(f'[[code]]\nname = "{n}"\nfile = "{n}.py"\nfunction = "{n}"\n' for n in "fg")
    (tmp_path / "s.toml").write_text(f'{spec}[[question]]\nkind = "equal"\nleft = "f:return"\nright = "g:return"\n')
    wanted, (entry,) = right.replace(" ", ""), nav.audit(tmp_path / "s.toml").questions[0].entries
    assert entry.status == nav.REFUTED and entry.suggestion.replace(" ", "") == wanted


def test_a_mend_in_python_knows_what_is_imported(tmp_path):
    text = "from numpy import dot\n\n\ndef f(A):\n    return dot(A.T, A)\n\n\ndef g(A):\n    return dot(A, A.T)\n"
    (tmp_path / "f.py").write_text(text)
    spec = "".join(
        f'[[code]]\nname = "{n}"\nfile = "f.py"\nfunction = "{n}"\n[code.symbols]\nA = {{ matrix = [2, 2] }}\n'
        for n in "fg"
    )
    (tmp_path / "s.toml").write_text(f'{spec}[[question]]\nkind = "equal"\nleft = "f:return"\nright = "g:return"\n')
    entries = nav.audit(tmp_path / "s.toml").questions[0].entries
    assert {entry.suggestion for entry in entries} == {"dot(A, A.T)"}
