"""Make a workspace: navsym.toml, and folders for claims, models, audits and papers with a small example each."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli.output import Told

if TYPE_CHECKING:
    from navsym.claims.workspace import Workspace


def command(folder: Path = Path("."), *, examples: bool = False) -> Told:
    """Make a workspace. Inside it, or below, every verb knows what navsym.toml lists.

    Example: navsym init drive
    """
    workspace = nav.init(folder, examples=examples)
    said = f"{workspace.root}; the documentation says what to try" if examples else ""
    return Told(workspace.document, lambda: said or as_text(workspace, folder))


def as_text(workspace: Workspace, folder: Path) -> str:
    """The files, and the next step."""
    files = [name for kind in workspace.patterns for name in workspace.list_files(kind)]
    step = "navsym verify" if folder == Path(".") else f"cd {folder}; navsym verify"
    return "\n".join(["navsym.toml", *files, f"next: {step}"])
