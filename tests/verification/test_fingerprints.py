"""The fingerprint of a claim changes with what its verdict depends on, and with nothing else."""

from __future__ import annotations

import importlib
import json
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from navsym.claims import claims_of
from navsym.claims.paper import papers_folder
from navsym.verification import fingerprints as deciding_code
from navsym.verification import fingerprints as sources
from navsym.verification.fingerprints import fingerprint, fingerprints

ROOT = Path(__file__).resolve().parents[2]

HEAD = """
    import functools
    import numpy as np
    import sympy as sp
    from navsym.claims import Claim, Equation, claim
"""

CLAIMS = """
    @claim("1")
    def first():
        \"\"\"The first claim of a small module.\"\"\"
        return Equation(helper(), helper())

    @claim("2")
    def second():
        \"\"\"The second claim of a small module.\"\"\"
        return Equation(other(), other())

    def other():
        return sp.Integer(3)
"""


@pytest.fixture
def prints(tmp_path, monkeypatch):
    """A function from the texts of modules to the fingerprints of the claims of the first one."""
    import navsym_papers

    monkeypatch.setattr(navsym_papers, "__path__", [str(tmp_path)])
    monkeypatch.syspath_prepend(str(tmp_path))

    def make(**modules):
        for module in [m for m in sys.modules if m.startswith("navsym_papers.made_up") or m == "made_up_elsewhere"]:
            del sys.modules[module]
            navsym_papers.__dict__.pop(module.rpartition(".")[2], None)
        for name, source in modules.items():
            (tmp_path / f"made_up_{name}.py").write_text(textwrap.dedent(source))
        importlib.invalidate_caches()
        for cached in (deciding_code.package_digest, sources.package_digest_of_all, sources.effects):
            cached.cache_clear()
        for file in (tmp_path / "__pycache__").glob("*"):  # the time of change is the same within a second
            file.unlink()
        return list(fingerprints(claims_of(importlib.import_module("navsym_papers.made_up_one"))).values())

    yield make
    make(one=HEAD)


#: What is done to a helper of the first claim -> the two sources; nothing else differs.
CHANGES = {
    "a constant": ("F = 2\ndef helper(): return sp.Integer(F)", "F = 5\ndef helper(): return sp.Integer(F)"),
    "a constant changed afterwards": (
        "F = [2]\ndef helper(): return F[0]",
        "F = [2]\nF[0] = 5\ndef helper(): return F[0]",
    ),
    "a list that is appended to": (
        "F = [2]\ndef helper(): return F[-1]",
        "F = [2]\nF.append(5)\ndef helper(): return F[-1]",
    ),
    "a table filled by a function": (
        "F = {}\ndef fill(): F[1] = 2\nfill()\ndef helper(): return F[1]",
        "F = {}\ndef fill(): F[1] = 5\nfill()\ndef helper(): return F[1]",
    ),
    "the assumption of a symbol": (
        "def make(s):\n def h(): return sp.sqrt(s**2)\n return h\nhelper = make(sp.Symbol('T', positive=True))",
        "def make(s):\n def h(): return sp.sqrt(s**2)\n return h\nhelper = make(sp.Symbol('T', real=True))",
    ),
    "a default of a keyword": ("def helper(*, n=2): return sp.Integer(n)", "def helper(*, n=5): return sp.Integer(n)"),
    "a wrapper": (
        "def w(f):\n @functools.wraps(f)\n def g(): return f()\n return g\n@w\ndef helper(): return sp.Integer(2)",
        "def w(f):\n @functools.wraps(f)\n def g(): return 2*f()\n return g\n@w\ndef helper(): return sp.Integer(2)",
    ),
    "a function inside if": (
        "if True:\n def helper(): return sp.Integer(2)",
        "if True:\n def helper(): return sp.Integer(5)",
    ),
    "what is caught": (
        "def helper():\n try: return 1 // 0\n except ZeroDivisionError: return sp.Integer(2)",
        "def helper():\n try: return 1 // 0\n except ArithmeticError: return sp.Integer(2)",
    ),
    "a method": (
        "class A:\n def f(self): return sp.Integer(2)\ndef helper(): return A().f()",
        "class A:\n def f(self): return sp.Integer(5)\ndef helper(): return A().f()",
    ),
}


@pytest.mark.parametrize("change", CHANGES)
def test_a_change_of_a_helper_changes_the_claim_that_calls_it(prints, change):
    before, after = (prints(one=HEAD + textwrap.indent(text, "    ") + CLAIMS) for text in CHANGES[change])
    assert before[0] != after[0]


@pytest.mark.parametrize("change", ["a constant", "a default of a keyword", "a wrapper", "a method"])
def test_a_change_of_a_helper_leaves_the_other_claims_alone(prints, change):
    before, after = (prints(one=HEAD + textwrap.indent(text, "    ") + CLAIMS) for text in CHANGES[change])
    assert before[1] == after[1]


#: The claims of a family close over values; two lambdas of one line have the same name.
FAMILY = """
    TWO = [lambda: sp.Integer(1), lambda: sp.Integer({n})]
    DATA = np.arange(5000)
    DATA[2500] = {data}

    def member(functions, data, options):
        def derive():
            return Equation([f() for f in functions], [int(data[2500]), options.keywords])
        return Claim("made_up_one", "1", "A member.", derive)

    CLAIMS = (member(TWO, DATA, functools.partial(sorted, key={key})),)
"""


def test_values_that_a_claim_closes_over_count_by_their_whole_content(prints):
    kinds = [dict(n=2, data=0, key=None), dict(n=5, data=0, key=None), dict(n=2, data=1, key=None)]
    found = [prints(one=HEAD + FAMILY.format(**kind))[0] for kind in [*kinds, dict(n=2, data=0, key="len")]]
    assert len(set(found)) == 4
    assert found[0] == prints(one=HEAD + FAMILY.format(**kinds[0]))[0]


@pytest.mark.parametrize(
    "line",
    [
        "from navsym_papers.made_up_two import helper",
        "from navsym_papers.made_up_two import *",
        "from .made_up_two import helper",
        "from . import made_up_two\n    def helper(): return made_up_two.helper()",
        "import navsym_papers.made_up_two as two\n    def helper(): return two.helper()",
        "def helper():\n        from navsym_papers.made_up_two import helper as inner\n        return inner()",
        "from importlib import import_module\n"
        "    def helper():\n        return import_module('navsym_papers.made_up_two').helper()",
        "def helper():\n        from made_up_elsewhere import VALUE\n        return VALUE",
        "import made_up_elsewhere\n    def helper(): return made_up_elsewhere.VALUE",
    ],
)
def test_a_helper_in_another_module_counts_however_it_is_imported(prints, line):
    found = []
    for number in (2, 5):
        two = f"import sympy as sp\n__all__ = ['helper']\nN = {number}\ndef helper(): return sp.Integer(N)"
        source = HEAD + "    " + line + CLAIMS
        (papers_folder() / "made_up_elsewhere.py").write_text(f"VALUE = {number}")
        found.append(prints(one=source, two=two)[0])
    assert found[0] != found[1]


@pytest.mark.parametrize(
    "patch",
    [
        "sp.Symbol.is_nonzero = property(lambda self: True)",
        "setattr(sp, 'sin', sp.cos)",
        "def patch(): sp.sin = sp.cos\n    X = patch()",
        "from navsym.proof import ladder\n    ladder.decide = None",
        "from navsym.proof import bounds\n    bounds.__dict__['LIMIT'] = 1",
    ],
)
def test_a_derivation_that_patches_others_changes_every_claim(prints, patch):
    plain = HEAD + "    def helper(): return sp.Integer(2)" + CLAIMS
    before = prints(one=plain, other=HEAD)
    # Only read: another module of the folder does it, whether or not it is imported in this run.
    after = prints(one=plain, other=HEAD + "    " + patch)
    assert all(a != b for a, b in zip(before, after, strict=True))


def test_a_function_put_into_a_deciding_room_at_run_time_changes_every_claim(monkeypatch):
    from navsym.prove import ladder

    claims = claims_of(importlib.import_module("navsym_papers.alpha_beta_filter"))
    before = fingerprint(claims[0])
    monkeypatch.setattr(ladder, "decide", lambda statement: None)
    assert fingerprint(claims[0]) != before


def test_the_rooms_the_checker_and_the_switches_count(monkeypatch, tmp_path):
    digest = deciding_code.rooms_digest.__wrapped__
    before = digest()
    names = {path.relative_to(deciding_code.ROOT).as_posix() for path in deciding_code.room_files()}
    assert {"checker.py", "core/store.py", "core/errors.py", "prove/ladder.py", "verification/decide.py"} <= names
    monkeypatch.setenv("SYMPY_GROUND_TYPES", "python")
    assert digest() != before
    monkeypatch.delenv("SYMPY_GROUND_TYPES")
    monkeypatch.setattr(deciding_code, "version", lambda name: f"{name} 0")
    assert digest() != before


def test_another_copy_of_an_engine_on_the_path_counts(monkeypatch, tmp_path):
    before = deciding_code.package_digest("mpmath")
    (tmp_path / "mpmath").mkdir()
    (tmp_path / "mpmath" / "__init__.py").write_text("from decimal import Decimal as mpf")
    script = "from navsym.verification.fingerprints import package_digest; print(package_digest('mpmath'))"
    told = {
        path: subprocess.run(
            [sys.executable, "-c", script],
            cwd=ROOT,
            env={"PYTHONPATH": path},
            capture_output=True,
            text=True,
            timeout=60,
        ).stdout.strip()
        for path in (str(ROOT), f"{tmp_path}:{ROOT}")
    }
    assert told[str(ROOT)] == before and told[f"{tmp_path}:{ROOT}"] not in ("", before)


def test_what_a_claim_reaches_is_told_alike_by_every_process():
    script = (
        "import importlib, json; from navsym.claims import claims_of; "
        "from navsym.verification.fingerprints import reached; "
        "claims = claims_of(importlib.import_module('navsym_papers.joint_correction')); "
        "print(json.dumps([reached(claim.derive) for claim in claims]))"
    )
    told = [
        json.loads(
            subprocess.run(
                [sys.executable, "-c", script],
                cwd=ROOT,
                env={"PYTHONHASHSEED": seed},
                capture_output=True,
                check=True,
                timeout=300,
            ).stdout
        )
        for seed in ("1", "2")
    ]
    assert told[0] == told[1] and len(set(map(tuple, told[0]))) == len(told[0])


def test_a_value_that_cannot_be_described_is_never_taken_for_an_old_one(prints):
    opaque = "class Opaque: pass\ndef make(o):\n def helper(): return o\n return helper\n"
    source = HEAD + textwrap.indent(opaque + "CLAIMS = (Claim('made_up_one', '1', 'x', make(Opaque())),)", "    ")
    assert prints(one=source) != prints(one=source)
