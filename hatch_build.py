"""The editable install: ``navsym_papers`` is the folder ``derivations/`` of this checkout, as it is in the wheel."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

NAME = "_editable_navsym_papers"

#: Run when Python starts, by the line of the .pth file; so it loads nothing before the papers are asked for.
FINDER = """import sys


class PapersFinder:
    @staticmethod
    def find_spec(name, path=None, target=None):
        if name == "navsym_papers":
            from importlib.util import spec_from_file_location

            return spec_from_file_location(name, {papers!r})


sys.meta_path.append(PapersFinder)
"""


class PapersHook(BuildHookInterface):  # type: ignore[type-arg]
    """Add the redirection to an editable wheel; an ordinary one has the files themselves."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        if version != "editable":
            return
        papers = Path(self.root, "derivations", "__init__.py")
        files = {f"{NAME}.pth": f"import {NAME}\n", f"{NAME}.py": FINDER.format(papers=str(papers))}
        folder = Path(tempfile.mkdtemp())
        for name, text in files.items():
            (folder / name).write_text(text, encoding="utf-8")
            build_data["force_include_editable"][str(folder / name)] = name
