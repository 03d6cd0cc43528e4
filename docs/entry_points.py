"""Which functions and classes a user meets: those that verbs, notebooks and the examples of these pages import.

The reference shows them first, and a test holds their docstrings to the standard. The list is read from the
sources, so that it needs no keeping. ``python docs/entry_points.py`` prints it.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = "navsym"
#: Rooms that are not a user's: the command line itself.
INSIDE = ("navsym.cli",)


@dataclass(frozen=True, slots=True)
class EntryPoint:
    """A function or class: its module, and its node in the module's syntax tree."""

    module: str
    node: ast.FunctionDef | ast.ClassDef

    @property
    def name(self) -> str:
        return f"{self.module}.{self.node.name}"

    @property
    def docstring(self) -> str:
        return ast.get_docstring(self.node) or ""


def entry_points() -> list[EntryPoint]:
    """All entry points by module and place in it; errors come last."""
    wanted: dict[str, set[str]] = {}
    for source in sources():
        for module, name in imported(source):
            wanted.setdefault(module, set()).add(name)
    return [EntryPoint(module, node) for module in sorted(wanted, key=late) for node in defined(module, wanted[module])]


def late(module: str) -> tuple[bool, str]:
    """Sorts the errors behind what raises them."""
    return module == f"{PACKAGE}.errors", module


def sources() -> Iterator[str]:
    """Programs that use navsym as a user does."""
    for path in (*sorted((ROOT / PACKAGE / "cli").glob("*.py")), *sorted((ROOT / "notebooks").glob("*.py"))):
        yield path.read_text(encoding="utf-8")
    for page in sorted((ROOT / "docs").glob("*.md")):
        yield from re.findall(r"^```python\n(.*?)^```$", page.read_text(encoding="utf-8"), re.M | re.S)


def imported(source: str) -> Iterator[tuple[str, str]]:
    """(module, name) of everything that a program imports from the package."""
    for node in ast.walk(ast.parse(source)):
        module = str(node.module) if isinstance(node, ast.ImportFrom) else ""
        if isinstance(node, ast.ImportFrom) and module.startswith(f"{PACKAGE}.") and not module.startswith(INSIDE):
            yield from ((module, alias.name) for alias in node.names)


def defined(module: str, names: set[str]) -> Iterator[ast.FunctionDef | ast.ClassDef]:
    """Functions and classes of those names that the module defines itself."""
    path = ROOT.joinpath(*module.split(".")).with_suffix(".py")
    if path.exists():
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.FunctionDef | ast.ClassDef) and node.name in names:
                yield node


if __name__ == "__main__":
    for point in entry_points():
        print(point.name)
