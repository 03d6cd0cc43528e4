"""What this machine has and lacks: Python, engines, compilers, data folder, cache."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from navsym.core.answers import Answer, named
from navsym.core.tables import Table

SUPPORTED = ((3, 11), (3, 13))
SECONDS = 60  # for one import or one "--version"

#: Engines that navsym cannot do without: module -> distribution.
NAMES = (
    "sympy flint numpy scipy casadi cvxpy osqp clarabel highspy numba msgspec jinja2 matplotlib jupytext pooch".split()
)
ENGINES = {name: "python-flint" if name == "flint" else name for name in NAMES}

#: Packages behind an extra, and programs, all optional: what each is for, and how it is asked for.
TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
EXTRAS: dict[str, str] = TABLE["extras"]
PROGRAMS: dict[str, dict[str, Any]] = TABLE["programs"]


@dataclass(frozen=True, slots=True)
class Equipment:
    """Something that navsym needs or can use.

    name     : of the engine, program or place
    required : navsym cannot work without it
    found    : it is there and it works
    version  : its own word for its version; for a folder, the folder
    advice   : its purpose and how to get it; empty when nothing is to be done
    """

    name: str
    required: bool
    found: bool
    version: str
    advice: str


@dataclass(frozen=True, slots=True, repr=False)
class Machine(Answer):
    """This machine: its engines, programs and places, its cores and its memory."""

    findings: tuple[Equipment, ...]
    cores: int
    memory_bytes: int | None
    platform: str

    @property
    def missing(self) -> tuple[str, ...]:
        """Names of what is required and not there."""
        return tuple(item.name for item in self.findings if item.required and not item.found)

    @property
    def complete(self) -> bool:
        """True when everything required is there."""
        return not self.missing

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym doctor``."""
        head = named(self, "complete") | {"navsym": version_of("navsym")}
        return head | named(self, "platform cores memory_bytes findings missing")

    def table(self) -> Table:
        """What is there and what is not."""
        words = {True: "yes", False: "no"}
        return ("name", "there", "version", "advice"), [
            (item.name, "missing" if item.required and not item.found else words[item.found], item.version, item.advice)
            for item in self.findings
        ]

    def __repr__(self) -> str:
        lacking = f"missing: {', '.join(self.missing)}" if self.missing else "everything required is there"
        return f"<{self.platform}, {self.cores} cores: {lacking}>"


def doctor() -> Machine:
    """What this machine has and lacks: Python, engines, extras, compilers, data and cache folders.

    Every engine is imported, and every program asked for its version, in a process of its own.

    >>> import navsym as nav
    >>> machine = nav.doctor()
    >>> machine.complete, machine.missing
    (True, ())
    """
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return Machine(tuple(examine()), cores, memory_size(), platform.platform())


def examine() -> list[Equipment]:
    """Look at Python, engines, extras, programs and places, in this order."""
    with ThreadPoolExecutor(max_workers=min(4, os.cpu_count() or 1)) as pool:
        engines = pool.map(engine, ENGINES, ENGINES.values())
        extras = pool.map(extra, EXTRAS, EXTRAS.values())
        programs = pool.map(program, PROGRAMS, PROGRAMS.values())
        return [python(), *engines, *extras, *programs, data_folder(), cache_folder()]


def python() -> Equipment:
    """The interpreter itself."""
    found = SUPPORTED[0] <= sys.version_info[:2] <= SUPPORTED[1]
    advice = "" if found else "use Python 3.11, 3.12 or 3.13"
    return Equipment("Python", True, found, platform.python_version(), advice)


def engine(module: str, distribution: str) -> Equipment:
    """A required package, imported in a process of its own so that a crash is a finding too."""
    found, why = importable(module)
    advice = "" if found else f"{why}; run python3 bootstrap.py doctor, it installs the locked packages"
    return Equipment(module, True, found, version_of(distribution), advice)


def extra(module: str, purpose: str) -> Equipment:
    """A package behind an extra; when it is not installed, that is no fault."""
    version = version_of(module)
    found = bool(version) and importable(module)[0]
    advice = "" if found else f"for {purpose}: python -m pip install {module} in the environment"
    return Equipment(module, False, found, version, advice)


def importable(module: str) -> tuple[bool, str]:
    """Whether a fresh interpreter can import the module, and the last line of its complaint."""
    code, output = answer([sys.executable, "-P", "-c", f"import {module}"])
    lines = output.strip().splitlines()
    return code == 0, lines[-1] if lines else f"status {code}"


def version_of(distribution: str) -> str:
    """Installed version, or the empty string."""
    try:
        return importlib.metadata.version(distribution)
    except importlib.metadata.PackageNotFoundError:
        return ""


def program(name: str, about: Mapping[str, Any]) -> Equipment:
    """A program on the path that answers when asked for its version."""
    for candidate in about["commands"]:
        path = shutil.which(candidate)
        if path is None:
            continue
        code, output = answer([path, about["question"]])
        if code == 0:
            return Equipment(name, False, True, output.strip().partition("\n")[0].strip()[:60], "")
    advice = f"for {about['purpose']}: install {about['commands'][0]} and put it on PATH"
    return Equipment(name, False, False, "", advice)


def answer(words: Sequence[str]) -> tuple[int, str]:
    """Exit status and output of a short command, its complaints last; status 127 when it cannot run or is too slow."""
    try:
        done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, timeout=SECONDS, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        return 127, str(error)
    return done.returncode, (done.stdout + done.stderr).decode("utf-8", "replace")


def data_folder() -> Equipment:
    """The local copy of the data sets, when NAVSYM_DATA names one."""
    named = os.environ.get("NAVSYM_DATA", "")
    if not named:
        return Equipment("NAVSYM_DATA", False, False, "", "names a folder with the data sets, for work offline")
    found = Path(named).is_dir() and os.access(named, os.R_OK)
    advice = "" if found else "names no readable folder: correct it"
    return Equipment("NAVSYM_DATA", False, found, named, advice)


def cache_folder() -> Equipment:
    """A folder for downloads and results; required, because several verbs keep files there."""
    folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    there = next((place for place in (folder, *folder.parents) if place.exists()), folder)
    found = there.is_dir() and os.access(there, os.W_OK)
    advice = "" if found else "cannot be written: set XDG_CACHE_HOME to a folder that can"
    return Equipment("cache", True, found, str(folder), advice)


def memory_size() -> int | None:
    """Main memory, where the system says it."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, OSError, ValueError):
        return None
