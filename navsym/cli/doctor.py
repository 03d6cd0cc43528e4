"""Show what this machine has and lacks: Python, engines, compilers, data folder, cache."""

from __future__ import annotations

import navsym as nav
from navsym.cli.output import Told, table


def command() -> Told:
    """Show what this machine has and lacks. Status 3 when something required is missing.

    Example: navsym doctor
    """
    machine = nav.doctor()
    size = f", {machine.memory_bytes / 2**30:.1f} GiB of memory" if machine.memory_bytes else ""
    closing = "everything required is there" if machine.complete else "something required is missing"
    text = f"{table(*machine.table())}\n{machine.cores} cores{size}; {closing}"
    return Told(machine.document, text, 0 if machine.complete else 3)
