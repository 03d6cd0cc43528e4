"""The languages: who writes the files, what runs them, and how accurate their libraries are taken to be."""

from __future__ import annotations

import functools
import importlib
import importlib.util
import shutil
import sys
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from navsym.core.errors import DomainError
from navsym.export.processes import run

WARNINGS = ("-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-pedantic", "-Werror")
WORDS = {
    "{strict}": WARNINGS,
    "{headless}": """--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking
    --disable-component-update --disable-sync --virtual-time-budget=20000""".split(),
}


@dataclass(frozen=True, slots=True)
class Target:
    """One language.

    writer  : "module:function" of this folder that makes the files; by default from the table ``spellings.toml``
    tool    : program that must be there to run the vectors; "" when Python itself is enough
    steps   : commands, run in the folder; their words "{tool}", "{python}", "{c}" and those of ``WORDS``, and {build},
              are replaced
    library : accuracy of sin, cos, exp, … in ulps, as taken for the bounds
    reals   : types that the target can be written in
    widen   : factor on the rounding error, where the order of operations is not ours
    """

    name: str
    steps: tuple[str, ...]
    writer: str = "modules:files"
    tool: str = ""
    library: int = 1
    reals: tuple[str, ...] = ("double",)
    widen: int = 1
    modules: tuple[str, ...] = ()

    def files(self) -> Callable[..., dict[str, str]]:
        """The function that makes the files, imported when it is first needed."""
        module, _, name = self.writer.partition(":")
        found: Callable[..., dict[str, str]] = getattr(importlib.import_module(f"{__package__}.{module}"), name)
        return functools.partial(found, self.name) if module == "modules" else found

    def executable(self) -> str | None:
        """Path of the tool on this machine, or None; a tool that does not answer is not there."""
        if self.missing_module():
            return None
        return sys.executable if not self.tool else answering(self.tool)

    def missing_module(self) -> str:
        """The first Python package that is needed and not installed, or the empty string."""
        return next((name for name in self.modules if importlib.util.find_spec(name) is None), "")


def answering(tool: str) -> str | None:
    """Path of a program that tells its version: a stub on the path, without its compiler, does not."""
    path = shutil.which(tool)
    return path if path is not None and answers(path) else None


@functools.cache
def answers(path: str) -> bool:
    """True when the program ends well after being asked for its version."""
    return run([path, "--version"], Path.cwd())[0] == 0


def read_row(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row of the table with its lists as tuples."""
    return {key: tuple(value) if isinstance(value, list) else value for key, value in row.items()}


TABLE: Mapping[str, Mapping[str, Any]] = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
TARGETS = {name: Target(name, **read_row(row)) for name, row in TABLE.items()}
ALIASES = {"js": "javascript", "numpy": "python", "c++": "cpp", "matlab": "octave"}


def find_targets(names: Sequence[str], real: str) -> list[Target]:
    """Targets by name, in the order given; raises DomainError for an unknown one."""
    found = []
    for name in dict.fromkeys(ALIASES.get(n.strip().lower(), n.strip().lower()) for n in names if n.strip()):
        if name not in TARGETS:
            message = f"expected languages among {', '.join(TARGETS)}; got {name[:40]!r}; correct it"
            raise DomainError(message, where="export: to")
        if real not in TARGETS[name].reals:
            raise DomainError(f"expected a language with {real}; got {name}, which has only double; leave it out")
        found.append(TARGETS[name])
    if not found:
        raise DomainError(f"expected at least one language; got none; name some of {', '.join(TARGETS)}")
    return found
