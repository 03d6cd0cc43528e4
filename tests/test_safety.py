"""Calls that have no place in navsym: they execute what they read, or decide what they cannot.

The sources are read, not run. Derivations may search with sympy as they like; what they find is
decided in ``navsym.proof``.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

#: Built-in functions that execute text; methods of these names are something else.
BUILTIN = frozenset({"eval", "exec", "__import__", "compile"})

#: Functions of sympy that execute text, the text that they make from names included.
EXECUTING = frozenset({"parse_expr", "parse_latex", "lambdify"})

#: Modules whose files can execute code when they are read.
UNSAFE_MODULES = frozenset({"pickle", "marshal", "shelve", "dill", "cloudpickle", "joblib", "yaml"})

#: Functions of sympy that search and do not decide: each has given wrong answers.
UNDECIDED = frozenset(
    "simplify trigsimp radsimp nsimplify solve solveset nonlinsolve linsolve integrate limit series".split()
)

#: Methods of sympy objects with the same trouble; other libraries do not have them.
UNDECIDED_METHODS = frozenset({"simplify", "trigsimp", "nsimplify", "equals"})

#: File -> reason why it may use a function of UNDECIDED as a search that something else decides.
SEARCHES: dict[str, str] = {
    "navsym/guaranteed/phases/closed_forms.py": "short forms of closed formulas; the formulas are proved afterwards",
    "navsym/observability/points.py": "points with square roots; the checker evaluates the equations there",
    "navsym/prove/calculus/candidates.py": "antiderivatives and telescopers; the checker differentiates them",
    "navsym/prove/rooms/equations.py": "guesses of simpler roots; the checker shows that they are equal",
}


def faults(source: str, name: str) -> Iterator[str]:
    """Every call and import of one file that has no place in navsym."""
    for node in ast.walk(ast.parse(source, filename=name)):
        why = ""
        if isinstance(node, ast.Call):
            why = call_fault(node, name)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            why = import_fault(node)
        if why:
            yield f"{name}:{node.lineno}: {why}"


def import_fault(node: ast.Import | ast.ImportFrom) -> str:
    """Modules that execute what they read, and functions imported past the check of calls."""
    names = [alias.name for alias in node.names]
    module = node.module or "" if isinstance(node, ast.ImportFrom) else ""
    modules = [module] if module else names
    if unsafe := [m for m in modules if m.split(".")[0] in UNSAFE_MODULES]:
        return f"{unsafe[0]} executes what it reads"
    hidden = {*EXECUTING, *UNDECIDED, "sympify", "S"}
    if module.split(".")[0] == "sympy" and (found := hidden & set(names)):
        return f"write sp.{min(found)}, so that the call can be checked"
    return ""


def call_fault(call: ast.Call, file: str) -> str:
    """What is wrong with one call, or the empty string."""
    function = call.func
    owner = getattr(getattr(function, "value", None), "id", "")
    name = getattr(function, "attr", getattr(function, "id", ""))
    if name in EXECUTING or (name in BUILTIN and (isinstance(function, ast.Name) or owner == "builtins")):
        return f"{name} executes text"
    if owner in ("np", "numpy") and name == "load":
        return "" if says(call, "allow_pickle", False) else "np.load needs allow_pickle=False"
    if owner in ("sp", "sympy") and name in ("sympify", "S"):
        return "" if says(call, "strict", True) else f"{name} evaluates strings: say strict=True"
    if file in SEARCHES:
        return ""
    is_method = isinstance(function, ast.Attribute) and name in UNDECIDED_METHODS
    if is_method or (owner in ("sp", "sympy") and name in UNDECIDED):
        return f"{name} searches, it does not decide"
    return ""


def says(call: ast.Call, keyword: str, value: bool) -> bool:
    """True when the call has this keyword with this constant."""
    given = {k.arg: k.value for k in call.keywords}
    constant = given.get(keyword)
    return isinstance(constant, ast.Constant) and constant.value is value


def test_nothing_in_navsym_executes_text_or_trusts_a_search() -> None:
    files = sorted((ROOT / "navsym").rglob("*.py"))
    found = [line for p in files for line in faults(p.read_text(), p.relative_to(ROOT).as_posix())]
    assert not found, "\n" + "\n".join(found)


def test_every_search_gives_its_reason() -> None:
    assert all(SEARCHES.values()) and all((ROOT / name).exists() for name in SEARCHES)


FAULTS = [
    "eval(text)",
    "builtins.exec(text)",
    "__import__('os')",
    "sp.parse_expr(text)",
    "compile(text, '', 'eval')",
    "sp.lambdify(x, e)",
    "sp.sympify(text)",
    "sp.sympify(text, strict=False)",
    "sp.S(text)",
    "sp.simplify(e)",
    "e.simplify()",
    "a.equals(b)",
    "sp.solve(e, x)",
    "np.load(path)",
    "np.load(path, allow_pickle=True)",
    "import pickle",
    "from pickle import loads",
    "import yaml.loader",
    "from sympy import sympify, Symbol",
    "from sympy.parsing.sympy_parser import parse_expr",
]


@pytest.mark.parametrize("source", FAULTS)
def test_a_fault_is_found(source: str) -> None:
    assert len(list(faults(source, "a.py"))) == 1


SOUND = [
    "re.compile(pattern)",
    "sp.sympify(e, strict=True)",
    "sp.S.Zero",
    "solve(problem)",
    "arb_mat(rows).solve(right)",
    "np.linalg.solve(A, b)",
    "np.load(path, allow_pickle=False)",
    "polynomial.eval(x)",
    "from sympy import Symbol",
    "import importlib",
]


@pytest.mark.parametrize("source", SOUND)
def test_a_sound_line_passes(source: str) -> None:
    assert not list(faults(source, "a.py"))
