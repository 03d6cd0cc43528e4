"""What this machine has and lacks: Python, engines, compilers, data folder, cache."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from navsym import __version__
from navsym.cli.output import emit, table

SUPPORTED = ((3, 11), (3, 13))
SECONDS = 60  # for one import or one "--version"

#: Engines that navsym cannot do without: module -> distribution.
ENGINES = {
    "sympy": "sympy",
    "flint": "python-flint",
    "numpy": "numpy",
    "scipy": "scipy",
    "casadi": "casadi",
    "cvxpy": "cvxpy",
    "osqp": "osqp",
    "clarabel": "clarabel",
    "highspy": "highspy",
    "numba": "numba",
    "msgspec": "msgspec",
    "jinja2": "jinja2",
    "matplotlib": "matplotlib",
    "jupytext": "jupytext",
    "pooch": "pooch",
}

#: Engines behind an extra: module -> (distribution, extra, what it is for).
EXTRAS = {
    "distributed": ("distributed", "cluster", "sweeps on a cluster"),
    "pyarrow": ("pyarrow", "cluster", "tables of sweeps"),
    "rasterio": ("rasterio", "maps", "GeoTIFF maps"),
    "jupyterlab": ("jupyterlab", "notebook", "notebooks in a browser"),
    "wasmtime": ("wasmtime", "cross", "running exported WebAssembly"),
    "atheris": ("atheris", "fuzz", "campaign fuzz"),
    "ziglang": ("ziglang", "cross", "cross-compiling exported C"),
}

#: Programs, all optional: name -> (commands to try, question for the version, what it is for).
PROGRAMS: dict[str, tuple[tuple[str, ...], str, str]] = {
    "C compiler": (("cc", "gcc", "clang"), "--version", "exported C"),
    "C++ compiler": (("c++", "g++", "clang++"), "--version", "exported C++"),
    "gfortran": (("gfortran",), "--version", "exported Fortran"),
    "rustc": (("rustc",), "--version", "exported Rust"),
    "node": (("node", "nodejs"), "--version", "exported JavaScript"),
    "julia": (("julia",), "--version", "exported Julia"),
    "octave": (("octave-cli", "octave"), "--version", "exported MATLAB"),
    "zig": (("zig",), "version", "cross-compiling exported C"),
    "cppcheck": (("cppcheck",), "--version", "static checks of exported C"),
    "chromium": (("chromium", "chromium-browser", "google-chrome"), "--version", "browser tests of reports"),
}


@dataclass(frozen=True, slots=True)
class Finding:
    """One line of the table.

    name     : what was looked for
    required : navsym cannot do its work without it
    found    : it is there and it works
    version  : what it calls itself; for a folder or a quantity, its value
    advice   : what it is for and how to get it; empty when there is nothing to do
    """

    name: str
    required: bool
    found: bool
    version: str
    advice: str


def command(json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False) -> int:
    """What this machine has and lacks. Status 3 when something required is missing.

    Example: navsym doctor
    """
    findings = examine()
    complete = all(item.found for item in findings if item.required)
    emit(document_of(findings, complete), as_json=json_, text=lambda: text_of(findings, complete))
    return 0 if complete else 3


def examine() -> list[Finding]:
    """Look at Python, engines, extras, programs and places, in this order."""
    with ThreadPoolExecutor(max_workers=min(4, os.cpu_count() or 1)) as pool:
        engines = pool.map(engine, ENGINES, ENGINES.values())
        extras = pool.map(extra, EXTRAS, EXTRAS.values())
        programs = pool.map(program, PROGRAMS, PROGRAMS.values())
        return [python(), *engines, *extras, *programs, data_folder(), cache_folder()]


def python() -> Finding:
    """The interpreter itself."""
    found = SUPPORTED[0] <= sys.version_info[:2] <= SUPPORTED[1]
    advice = "" if found else "use Python 3.11, 3.12 or 3.13"
    return Finding("Python", True, found, platform.python_version(), advice)


def engine(module: str, distribution: str) -> Finding:
    """A required package, imported in a process of its own so that a crash is a finding too."""
    found, why = importable(module)
    advice = "" if found else f"{why}; run python3 bootstrap.py doctor, it installs the locked packages"
    return Finding(module, True, found, version_of(distribution), advice)


def extra(module: str, about: tuple[str, str, str]) -> Finding:
    """A package behind an extra; when it is not installed, that is no fault."""
    distribution, name, purpose = about
    version = version_of(distribution)
    found = bool(version) and importable(module)[0]
    advice = "" if found else f"for {purpose}: python -m pip install -e '.[{name}]' in the environment"
    return Finding(module, False, found, version, advice)


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


def program(name: str, about: tuple[tuple[str, ...], str, str]) -> Finding:
    """A program on the path that answers when asked for its version."""
    commands, question, purpose = about
    for candidate in commands:
        path = shutil.which(candidate)
        if path is None:
            continue
        code, output = answer([path, question])
        if code == 0:
            lines = output.strip().splitlines()
            return Finding(name, False, True, lines[0].strip()[:60] if lines else "", "")
    return Finding(name, False, False, "", f"for {purpose}: install {commands[0]} and put it on PATH")


def answer(words: Sequence[str]) -> tuple[int, str]:
    """Exit status and output of a short command; status 127 when it cannot run or takes too long."""
    try:
        done = subprocess.run(
            words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=SECONDS
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return 127, str(error)
    return done.returncode, done.stdout.decode("utf-8", "replace")


def data_folder() -> Finding:
    """The local copy of the data sets, when NAVSYM_DATA names one."""
    named = os.environ.get("NAVSYM_DATA", "")
    if not named:
        return Finding("NAVSYM_DATA", False, False, "", "names a folder with the data sets, for work offline")
    found = Path(named).is_dir() and os.access(named, os.R_OK)
    advice = "" if found else "names no readable folder: correct it"
    return Finding("NAVSYM_DATA", False, found, named, advice)


def cache_folder() -> Finding:
    """A folder for downloads and results; required, because several verbs keep files there."""
    folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    there = next((place for place in (folder, *folder.parents) if place.exists()), folder)
    found = there.is_dir() and os.access(there, os.W_OK)
    advice = "" if found else "cannot be written: set XDG_CACHE_HOME to a folder that can"
    return Finding("cache", True, found, str(folder), advice)


def memory_bytes() -> int | None:
    """Main memory, where the system says it."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, OSError, ValueError):
        return None


def cores() -> int:
    """Processor cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def document_of(findings: list[Finding], complete: bool) -> dict[str, Any]:
    """The JSON document."""
    return {
        "complete": complete,
        "navsym": __version__,
        "platform": platform.platform(),
        "cores": cores(),
        "memory_bytes": memory_bytes(),
        "findings": [asdict(item) for item in findings],
        "missing": [item.name for item in findings if item.required and not item.found],
    }


def text_of(findings: list[Finding], complete: bool) -> str:
    """A table and one closing line."""
    rows = [
        (item.name, "yes" if item.found else "missing" if item.required else "no", item.version, item.advice)
        for item in findings
    ]
    memory = memory_bytes()
    size = f", {memory / 2**30:.1f} GiB of memory" if memory else ""
    closing = "everything required is there" if complete else "something required is missing"
    return f"{table(['what', 'there', 'version', 'what to do'], rows)}\n{cores()} cores{size}; {closing}\n"
