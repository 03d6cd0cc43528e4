"""The languages: who writes the files, what runs them, and how accurate their libraries are taken to be."""

from __future__ import annotations

import functools
import importlib
import importlib.util
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from navsym.core.errors import DomainError

WARNINGS = ("-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-pedantic", "-Werror")
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")


@dataclass(frozen=True, slots=True)
class Target:
    """One language.

    writer  : "module:function" that makes the files of the folder
    tool    : program that must be there to run the vectors; "" when Python itself is enough
    steps   : commands, run in the folder; their words "{tool}", "{python}" and "{c}", and {build}, are replaced
    library : accuracy of sin, cos, exp, … in ulps, as taken for the bounds
    reals   : types that the target can be written in
    widen   : factor on the rounding error, where the order of operations is not ours
    """

    name: str
    writer: str
    tool: str
    steps: tuple[str, ...]
    library: int = 1
    reals: tuple[str, ...] = ("double",)
    widen: int = 1
    modules: tuple[str, ...] = ()

    def files(self) -> Callable[..., dict[str, str]]:
        """The function that makes the files, imported when it is first needed."""
        module, _, name = self.writer.partition(":")
        found: Callable[..., dict[str, str]] = getattr(importlib.import_module(module), name)
        return found

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
    try:
        done = subprocess.run([path, "--version"], stdin=subprocess.DEVNULL, capture_output=True, timeout=60)
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0


BOTH = ("double", "float")
HEADLESS = """--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking
    --disable-component-update --disable-sync --virtual-time-budget=20000"""
PYTHON = "{python} -B test_vectors.py"
RUN = "{build}/run"
STRICT = " ".join(WARNINGS)
WRITERS = "navsym.export.languages"
TARGETS = {
    target.name: target
    for target in (
        Target(
            "c",
            f"{WRITERS}.c:files",
            "gcc",
            (f"{{tool}} -std=c99 -O2 -ffp-contract=off {STRICT} {{c}} -o {RUN} -lm", RUN),
            reals=BOTH,
        ),
        Target(
            "cpp",
            f"{WRITERS}.cpp:files",
            "g++",
            (f"{{tool}} -std=c++17 -O1 -ffp-contract=off {STRICT} test_main.cpp -o {RUN}", RUN),
            reals=BOTH,
        ),
        Target("python", f"{WRITERS}.python:files", "", (PYTHON,), library=4, reals=BOTH),
        Target("javascript", f"{WRITERS}.javascript:files", "node", ("{tool} test_vectors.mjs",)),
        Target(
            "rust",
            f"{WRITERS}.rust:files",
            "rustc",
            (f"{{tool}} --edition=2021 -D warnings test_main.rs -o {RUN}", RUN),
            reals=BOTH,
        ),
        Target("casadi", f"{WRITERS}.casadi:files", "", (PYTHON,), widen=64, modules=("casadi",)),
        Target("batch", f"{WRITERS}.batch:files", "gcc", (PYTHON,), library=4, reals=BOTH),
        Target(
            "fortran",
            f"{WRITERS}.fortran:files",
            "gfortran",
            (f"{{tool}} -std=f2008 -Wall -J {{build}} navsym_functions.f90 test_vectors.f90 -o {RUN}", RUN),
            library=2,
        ),
        Target("julia", f"{WRITERS}.julia:files", "julia", ("{tool} --startup-file=no test_vectors.jl",)),
        Target(
            "wasm",
            f"{WRITERS}.wasm:wasm_files",
            "",
            (
                f"{{python}} -m ziglang cc -target wasm32-wasi -O2 -std=c99 -ffp-contract=off {STRICT} {{c}} "
                f"-o {RUN}.wasm -lm",
                f"{{python}} -B run_wasi.py {RUN}.wasm",
            ),
            modules=("ziglang", "wasmtime"),
            reals=BOTH,
        ),
        Target(
            "html",
            f"{WRITERS}.wasm:page_files",
            "chromium",
            (f"{{tool}} {HEADLESS} --user-data-dir={{build}}/profile --dump-dom index.html",),
            reals=BOTH,
        ),
        Target(
            "octave",
            f"{WRITERS}.octave:files",
            "octave-cli",
            ("{tool} --norc --no-history --quiet --eval test_vectors",),
            library=2,
        ),
    )
}
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
