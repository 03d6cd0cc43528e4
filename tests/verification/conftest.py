"""A folder of papers that tests may write and edit, with a store and a ledger of its own."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from types import ModuleType

import pytest

import navsym as nav
from navsym.claims.claim import PAPERS

HEAD = """
import sympy as sp

from navsym.claims import Bound, Equation, Paper, claim

x = sp.Symbol("x", real=True)
PAPER = Paper({name!r}, "Tiny", (), 2026, "none", "English", equations=())
"""
CLAIM = '''

@claim("1")
def first():
    """The first."""
    return {statement}
'''


class Papers:
    """The folder; what Python has imported from it is forgotten before every use, as a new process would."""

    def __init__(self, folder: Path):
        self.folder = folder / PAPERS
        self.folder.mkdir()

    def write(self, name: str, text: str) -> None:
        """Write a file of the folder, or one beside it with a path that starts with two points."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def add(self, name: str, helper: str = "", two: str = "2", statement: str = "") -> None:
        """Write a paper with one claim, ``x + x = two*x`` or another one, after some lines that give ``two``."""
        claim = CLAIM.format(statement=statement or f"Equation(x + x, {two}*x)")
        self.write(f"{name}.py", HEAD.format(name=name) + helper + claim)

    def forget(self) -> None:
        """Import everything again, from the files as they are now."""
        outside = str(self.folder.parent)
        for name, module in list(sys.modules.items()):
            if name.startswith(f"{PAPERS}.") or str(getattr(module, "__file__", None)).startswith(outside):
                del sys.modules[name]
        package = ModuleType(PAPERS)
        package.__path__ = [str(self.folder)]
        sys.modules[PAPERS] = package
        importlib.invalidate_caches()
        sys.path_importer_cache.clear()

    def verify(self, *names: str, **options) -> nav.Ledger:
        self.forget()
        return nav.verify(*names, jobs=1, **options)

    def status(self, **options) -> str:
        """The verdict of the only claim."""
        (record,) = self.verify(**options)
        return str(record.status)


@pytest.fixture
def papers(tmp_path, monkeypatch):
    monkeypatch.setenv("NAVSYM_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # a change within the same second counts
    monkeypatch.syspath_prepend(str(tmp_path))
    before = {name: module for name, module in sys.modules.items() if name.partition(".")[0] == PAPERS}
    folder = Papers(tmp_path)
    yield folder
    folder.forget()
    del sys.modules[PAPERS]
    sys.modules.update(before)
