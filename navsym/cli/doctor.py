"""Show what this machine has and lacks: Python, engines, compilers, data folder, cache."""

from __future__ import annotations

from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli.output import Told, table

if TYPE_CHECKING:
    from navsym.core.machine import Machine


def command() -> Told:
    """Show what this machine has and lacks. Status 3 when something required is missing.

    Example: navsym doctor
    """
    machine = nav.doctor()
    return Told(machine.document, lambda: as_text(machine), 0 if machine.complete else 3)


def as_text(machine: Machine) -> str:
    """A table and one closing line."""
    size = f", {machine.memory_bytes / 2**30:.1f} GiB of memory" if machine.memory_bytes else ""
    closing = "everything required is there" if machine.complete else "something required is missing"
    return f"{table(*machine.table())}\n{machine.cores} cores{size}; {closing}\n"
