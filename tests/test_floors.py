"""Who may import whom: floors, rooms, and one owner for each engine.

The imports are read from the source, functions and ``TYPE_CHECKING`` blocks included, and
so are modules named in ``importlib.import_module("...")``. Nothing is executed.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

#: Imports go from a higher number to a lower one, or stay in their room.
FLOORS = {
    "errors": 0,
    "checker": 0,  # stands apart: see CHECKER below
    "claims": 1,
    "text": 1,
    "store": 1,
    "models": 2,
    "numeric": 2,
    "proof": 3,
    "methods": 4,
    "export": 5,
    "report": 5,
    "testing": 5,
    "cli": 6,
    "__main__": 7,
}

#: What the independent checker may import besides the standard library.
CHECKER = frozenset({"flint"})

#: Engine -> place (file or folder) -> reason. An engine that is not here is not ours to use:
#: add a line with its reason, and the package to pyproject.toml.
OWNERS: dict[str, dict[str, str]] = {
    "sympy": {
        "navsym/text": "reads text into expressions, and back, by a grammar of its own",
        "navsym/models": "models are symbolic matrices",
        "navsym/proof": "takes expressions apart into polynomials and balls",
        "navsym/methods": "closed forms, exact conditions",
        "navsym/core/casadi_functions.py": "the bridge from expressions to fast functions",
        "navsym/export": "printed code starts from an expression",
        "navsym/report": "formulas as LaTeX and MathML",
        "navsym/testing": "strategies of expressions",
        "derivations": "the derivations themselves",
    },
    "flint": {
        "navsym/proof": "exact polynomials, rationals and balls",
        "navsym/checker": "replays certificates with balls of its own",
        "navsym/methods": "exact linear algebra and ball arithmetic inside a method",
        "navsym/models": "exact transition matrices over a polynomial ring",
        "navsym/export": "expected values of test vectors, rounded outwards",
        "derivations": "exact counts and ranks behind a Finding",
    },
    "numpy": {
        "navsym/numeric": "arrays",
        "navsym/methods": "arrays in and out of numeric",
        "navsym/models": "sampled values of a model",
        "navsym/proof": "candidates found in doubles, decided in balls",
        "navsym/text": "maps and tracks are read into arrays",
        "navsym/export": "test vectors",
        "navsym/report": "plots",
        "navsym/cli": "arrays in documents",
        "navsym/testing": "strategies of arrays",
    },
    "scipy": {
        "navsym/numeric": "reference algorithms beside our own",
        "navsym/methods": "dense linear algebra and special functions",
    },
    "casadi": {
        "navsym/core/casadi_functions.py": "fast functions from expressions",
        "navsym/guaranteed/convex.py": "LP and QP through conic and qpsol",
        "navsym/numeric/convex_casadi.py": "LP and QP through conic and qpsol",
    },
    "cvxpy": {"navsym/numeric/convex": "convex models and cross-checks"},
    "osqp": {"navsym/numeric/convex": "convex solver"},
    "clarabel": {"navsym/numeric/convex": "convex solver"},
    "highspy": {"navsym/numeric/convex": "convex solver"},
    "numba": {"navsym/numeric": "compiled loops"},
    "llvmlite": {"navsym/core/lanes.py": "values of eight lanes inside compiled loops"},
    "mpmath": {"navsym/methods": "roots to many digits, as candidates that navsym.proof decides"},
    "matplotlib": {"navsym/report": "plots"},
    "jinja2": {"navsym/report": "pages"},
    "markupsafe": {"navsym/report": "marks what is already escaped"},
    "IPython": {"navsym/report/notebook.py": "what notebooks show"},
    "ipywidgets": {"navsym/report/notebook.py": "sliders in notebooks"},
    "msgspec": {"navsym/text": "schemas of files", "navsym/report": "the ledger", "navsym/cli": "schemas of documents"},
    "typer": {"navsym/cli": "options and arguments"},
    "rich": {"navsym/cli": "tables on a terminal"},
    "dask": {"navsym/studies/cluster.py": "sweeps on a cluster"},
    "distributed": {"navsym/studies/cluster.py": "sweeps on a cluster"},
    "pyarrow": {"navsym/studies/run.py": "shards of sweeps"},
    "hypothesis": {"navsym/testing": "strategies for users' own tests"},
    "atheris": {"navsym/studies/campaigns/guided.py": "inputs guided by coverage, in a process of their own"},
    "rasterio": {"navsym/text": "GeoTIFF maps"},
    "pooch": {"navsym/text": "data sets, cached and checked", "navsym/cli/data.py": "the verb data"},
}


@dataclass(frozen=True, slots=True)
class Import:
    """One import: file relative to the root, line, dotted target; ``dynamic`` when by importlib."""

    file: str
    line: int
    target: str
    dynamic: bool = False

    @property
    def room(self) -> str:
        """The room of navsym that the file is in; ``derivations`` or empty for files outside."""
        return room_of(self.file.removesuffix(".py").removesuffix("/__init__").replace("/", "."))


def room_of(dotted: str) -> str:
    """``navsym.language.expression`` -> ``text``; ``navsym`` -> the empty string."""
    parts = dotted.split(".")
    return parts[0] if parts[0] != "navsym" else ".".join(parts[1:2])


def sources(root: Path) -> Iterator[Path]:
    """All Python files of the two packages."""
    for package in ("navsym", "derivations"):
        yield from sorted((root / package).rglob("*.py"))


def imports_of(root: Path) -> list[Import]:
    """Every import of every file, in order."""
    return [found for path in sources(root) for found in imports_in(path, root)]


def imports_in(path: Path, root: Path) -> Iterator[Import]:
    """Imports of one file; relative ones are resolved against its package."""
    file = path.relative_to(root).as_posix()
    package = file.split("/")[:-1]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"), filename=file)):
        match node:
            case ast.Import(names=names):
                yield from (Import(file, node.lineno, name.name) for name in names)
            case ast.ImportFrom(module=module, names=names, level=level):
                base = [*package[: len(package) - level + 1], module] if level else [module]
                dotted = ".".join(part for part in base if part)
                yield from from_imports(file, node.lineno, dotted, [name.name for name in names])
            case ast.Call() if dynamic_target(node):
                yield Import(file, node.lineno, dynamic_target(node), dynamic=True)


def from_imports(file: str, line: int, dotted: str, names: list[str]) -> Iterator[Import]:
    """``from navsym import text`` reaches the room text; other targets are the module itself."""
    if dotted in ("navsym", "derivations"):
        yield from (Import(file, line, f"{dotted}.{name}") for name in names if not name.startswith("__"))
    else:
        yield Import(file, line, dotted)


def dynamic_target(call: ast.Call) -> str:
    """The module named in ``import_module("...")``, as far as it is written out."""
    name = getattr(call.func, "attr", getattr(call.func, "id", ""))
    if name not in ("import_module", "__import__") or not call.args:
        return ""
    first = call.args[0]
    if isinstance(first, ast.JoinedStr) and first.values:
        first = first.values[0]
    value = first.value if isinstance(first, ast.Constant) else ""
    return value.rstrip(".") if isinstance(value, str) else ""


def trouble(found: Import) -> str | None:
    """What is wrong with one import, or None."""
    top = found.target.split(".")[0]
    if found.room == "checker":
        return None if top in sys.stdlib_module_names | CHECKER else "the checker stands apart"
    if top == "derivations":
        return derivation_trouble(found)
    if top == "navsym":
        return floor_trouble(found.room, room_of(found.target))
    if top in sys.stdlib_module_names:
        return None
    return engine_trouble(found.file, top)


def derivation_trouble(found: Import) -> str | None:
    """Derivations see each other; of navsym only the command line reaches them, by name."""
    if found.room == "derivations" or (found.room == "cli" and found.dynamic):
        return None
    return "nothing in navsym imports derivations; the command line finds them by importlib"


def floor_trouble(here: str, there: str) -> str | None:
    """Imports go down, or stay in their room; derivations stand on everything but the command line."""
    if here == there or not there:
        return None
    if here == "derivations":
        return "derivations do not import the command line" if there == "cli" else None
    if not here:
        return "navsym/__init__.py imports nothing"
    if missing := [room for room in (here, there) if room not in FLOORS]:
        return f"{missing[0]} has no floor: add it to FLOORS"
    if FLOORS[there] < FLOORS[here]:
        return None
    return f"{here} (floor {FLOORS[here]}) may not see {there} (floor {FLOORS[there]})"


def engine_trouble(file: str, engine: str) -> str | None:
    """Engines have owners, and no package imports one on the way in."""
    if file.endswith("__init__.py"):
        return f"{engine} in an __init__.py makes every import slow"
    places = OWNERS.get(engine)
    if places is None:
        return f"{engine} has no owner: add it to OWNERS with a reason"
    if any(file == p or file.startswith((p + "/", p + ".py", p + "_")) for p in places):
        return None
    return f"{engine} belongs to {', '.join(places)}"


def violations(root: Path) -> list[str]:
    """Every import that breaks a rule, with its place."""
    found = ((item, trouble(item)) for item in imports_of(root))
    return [f"{item.file}:{item.line}: imports {item.target}: {why}" for item, why in found if why]


def test_imports_go_down_and_every_engine_has_its_owner() -> None:
    found = violations(ROOT)
    assert not found, "\n" + "\n".join(found)


def test_every_room_of_the_package_has_a_floor() -> None:
    rooms = {room_of(".".join(path.relative_to(ROOT).with_suffix("").parts)) for path in sources(ROOT)}
    assert rooms - {"__init__", "derivations"} <= set(FLOORS)


def test_every_owner_gives_a_reason() -> None:
    assert all(reason.strip() for places in OWNERS.values() for reason in places.values())


BROKEN = [
    ("navsym/models/a.py", "from navsym.prove.ladder import decide", "may not see proof"),
    ("navsym/models/a.py", "import navsym.core.arrays", "may not see numeric"),
    ("navsym/claims/a.py", "from navsym.text import expression", "may not see text"),
    ("navsym/claims/a.py", "from navsym import text", "may not see text"),
    ("navsym/export/a.py", "from ..report import page", "may not see report"),
    ("navsym/proof/a.py", "def f():\n    from navsym.methods import guaranteed", "may not see methods"),
    ("navsym/proof/a.py", "if TYPE_CHECKING:\n    import navsym.cli.main", "may not see cli"),
    ("navsym/core/errors.py", "import navsym.claims", "may not see claims"),
    ("navsym/__init__.py", "import navsym.core.errors", "imports nothing"),
    ("navsym/attic/a.py", "import navsym.core.errors", "attic has no floor"),
    ("navsym/methods/a.py", "import derivations.trajectory", "imports derivations"),
    ("navsym/methods/a.py", "from derivations import trajectory", "imports derivations"),
    ("navsym/methods/a.py", "importlib.import_module('derivations')", "imports derivations"),
    ("navsym/methods/a.py", "import_module(f'derivations.{name}')", "imports derivations"),
    ("navsym/cli/a.py", "import derivations", "imports derivations"),
    ("navsym/checker.py", "import navsym.core.errors", "the checker stands apart"),
    ("navsym/checker.py", "import sympy", "the checker stands apart"),
    ("navsym/checker/balls.py", "from navsym import errors", "the checker stands apart"),
    ("derivations/a.py", "from navsym.cli.output import emit", "do not import the command line"),
    ("derivations/a.py", "import casadi", "casadi belongs to"),
    ("navsym/terrain/kernels/criteria.py", "import cvxpy as cp", "cvxpy belongs to"),
    ("navsym/numeric/convexity.py", "import cvxpy", "cvxpy belongs to"),
    ("navsym/claims/statement.py", "import sympy as sp", "sympy belongs to"),
    ("navsym/proof/__init__.py", "import sympy", "in an __init__.py"),
    ("navsym/proof/a.py", "import torch", "torch has no owner"),
]


@pytest.mark.parametrize(("file", "source", "message"), BROKEN)
def test_a_broken_rule_is_found(tmp_path: Path, file: str, source: str, message: str) -> None:
    path = tmp_path / file
    path.parent.mkdir(parents=True)
    path.write_text(f"import os\n{source}\n")
    (found,) = violations(tmp_path)
    assert file in found and message in found


ALLOWED = [
    ("navsym/proof/a.py", "import sympy\nfrom flint import arb\nfrom navsym.models import linear"),
    ("navsym/proof/a.py", "from . import balls\nfrom .balls import ball\nfrom ..claims import claim"),
    ("navsym/cli/verify.py", "import importlib\nimportlib.import_module(f'derivations.{name}')"),
    ("navsym/numeric/convex_models.py", "import cvxpy"),
    ("navsym/numeric/convex/models.py", "import cvxpy"),
    ("navsym/__main__.py", "from navsym.cli.main import main"),
    ("navsym/cli/main.py", "from navsym import __version__\nimport typer"),
    ("navsym/checker.py", "import json\nfrom flint import arb"),
    ("derivations/a.py", "import sympy\nfrom navsym.methods import guaranteed\nfrom derivations import b"),
]


@pytest.mark.parametrize(("file", "source"), ALLOWED)
def test_a_lawful_import_passes(tmp_path: Path, file: str, source: str) -> None:
    path = tmp_path / file
    path.parent.mkdir(parents=True)
    path.write_text(source + "\n")
    assert violations(tmp_path) == []
