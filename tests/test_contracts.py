"""Who may import whom: the contracts and the owners of engines in ``pyproject.toml``."""

from __future__ import annotations

import copy
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import grimp
import pytest
from importlinter import api
from importlinter.contracts.forbidden import ForbiddenContract
from importlinter.contracts.layers import LayersContract
from importlinter.contracts.protected import ProtectedContract

ROOT = Path(__file__).resolve().parents[1]
TABLES = tomllib.loads((ROOT / "pyproject.toml").read_text())
OWNERS: dict[str, list[str]] = TABLES["tool"]["navsym"]["owners"]
UNIMPORTED: dict[str, str] = TABLES["tool"]["navsym"]["unimported"]

KINDS = {"layers": LayersContract, "forbidden": ForbiddenContract, "protected": ProtectedContract}

#: Distribution -> what is imported, where the two names differ.
MODULES = {"python-flint": "flint", "tree-sitter": "tree_sitter"}


@pytest.fixture(scope="module")
def graph() -> grimp.ImportGraph:
    """Who imports whom, read from the sources; imports inside functions count too."""
    return grimp.build_graph("navsym", "navsym_papers", include_external_packages=True, cache_dir=None)


def test_the_contracts_are_kept() -> None:
    lint = [Path(sys.executable).with_name("lint-imports"), "--no-cache", "--no-logo"]
    done = subprocess.run(lint, cwd=ROOT, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr


BREAKS = [
    ("navsym.core.errors", "navsym.claims.claim", "Imports go down"),
    ("navsym.prove.ladder", "navsym.models.linear", "Imports go down"),
    ("navsym.terrain.search", "navsym.trajectory.tracks", "Imports go down"),
    ("navsym.studies.run", "navsym.report.page", "Imports go down"),
    ("navsym.export.folder", "navsym.report.page", "Imports go down"),
    ("navsym.report.page", "navsym.cli.output", "Imports go down"),
    ("navsym.guaranteed.solver", "navsym", "Only the command line"),
    ("navsym.checker", "navsym.core.errors", "The checker imports nothing"),
    ("navsym.cli.verify", "navsym_papers.guaranteed_velocity", "The library holds no paper"),
    ("navsym_papers.guaranteed_velocity", "navsym.cli.output", "Papers do not need"),
]


@pytest.mark.parametrize(("importer", "imported", "contract"), BREAKS)
def test_a_planted_import_breaks_its_contract(
    graph: grimp.ImportGraph, importer: str, imported: str, contract: str
) -> None:
    assert {importer, imported} <= graph.modules
    spoiled = copy.deepcopy(graph)
    spoiled.add_import(importer=importer, imported=imported, line_number=1, line_contents="")
    assert any(name.startswith(contract) for name in broken(spoiled))


def broken(graph: grimp.ImportGraph) -> list[str]:
    """Names of the contracts that an import graph breaks."""
    options = api.read_configuration(str(ROOT / "pyproject.toml"))
    contracts = [KINDS[c["type"]](c["name"], options["session_options"], c) for c in options["contracts_options"]]
    return [c.name for c in contracts if not c.check(graph=copy.deepcopy(graph), verbose=False).kept]


# Engines


def users(graph: grimp.ImportGraph) -> dict[str, set[str]]:
    """Engine -> the modules that import it; the standard library is nobody's."""
    engines = {m for m in graph.modules if graph.is_module_squashed(m)} - sys.stdlib_module_names
    return {engine: graph.find_modules_that_directly_import(engine) for engine in engines}


def owner_trouble(owners: dict[str, list[str]], used: dict[str, set[str]], packages: set[str]) -> list[str]:
    """Imports without an owner, owners without an import, and packages that load an engine on the way in."""
    found = []
    for engine in sorted(used.keys() | owners.keys()):
        places, modules = owners.get(engine, []), used.get(engine, set())
        within = {place: {m for m in modules if f"{m}.".startswith(f"{place}.")} for place in places}
        strangers = modules.difference(*within.values())
        found += [f"{m} imports {engine}, which belongs to {', '.join(places) or 'nobody'}" for m in sorted(strangers)]
        found += [f"{place} owns {engine} and does not import it" for place in places if not within[place]]
        found += [f"{m}/__init__.py imports {engine} on the way in" for m in sorted(modules & packages)]
    return found


def test_every_engine_is_imported_by_its_owners_and_every_owner_imports_it(graph: grimp.ImportGraph) -> None:
    rooms = {m for m in graph.modules if m.startswith("navsym") and graph.find_children(m)}
    assert not (found := owner_trouble(OWNERS, users(graph), rooms)), "\n".join(found)


def test_trouble_with_owners_is_found() -> None:
    used = {"cvxpy": {"navsym.guaranteed.convexity", "navsym.guaranteed.convex.models"}, "torch": {"navsym.prove"}}
    owners = {"cvxpy": ["navsym.guaranteed.convex", "navsym.cli"]}
    assert owner_trouble(owners, used, {"navsym.prove"}) == [
        "navsym.guaranteed.convexity imports cvxpy, which belongs to navsym.guaranteed.convex, navsym.cli",
        "navsym.cli owns cvxpy and does not import it",
        "navsym.prove imports torch, which belongs to nobody",
        "navsym.prove/__init__.py imports torch on the way in",
    ]


def test_every_dependency_is_imported_or_says_why_not() -> None:
    names = [re.match(r"[\w-]+", line)[0] for line in TABLES["project"]["dependencies"]]
    idle = [name for name in names if MODULES.get(name, name) not in OWNERS and name not in UNIMPORTED]
    assert not idle, f"nothing imports {', '.join(idle)}"
    assert not UNIMPORTED.keys() & OWNERS.keys() and all(UNIMPORTED.values())
