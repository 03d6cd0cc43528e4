"""Make a workspace: navsym.toml, and folders for claims, models, audits and papers with a small example each."""

from __future__ import annotations

from pathlib import Path

import navsym as nav
from navsym.cli.output import Told


def command(folder: Path = Path("."), *, examples: bool = False) -> Told:
    """Make a workspace. Inside it, or below, every verb knows what navsym.toml lists.

    Example: navsym init drive
    """
    workspace = nav.init(folder, examples=examples)
    if examples:
        return Told(workspace.document, f"{workspace.root}; the documentation says what to try")
    files = [name for kind in workspace.patterns for name in workspace.list_files(kind)]
    step = "navsym verify" if folder == Path(".") else f"cd {folder}; navsym verify"
    return Told(workspace.document, "\n".join(["navsym.toml", *files, f"next: {step}"]))
