"""The code that decides, as one digest: navsym's rooms, the engines as they are installed, and the switches.

Two runs with the same digest decide the same statement in the same way. The engines that decide are read
whole, so that a file edited in place or another copy earlier on the path counts; engines that only propose
(a solver's answer is checked) count by their version.
"""

from __future__ import annotations

import functools
import hashlib
import importlib.metadata
import importlib.util
import os
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import FunctionType
from typing import Any

from navsym.store import key_of

ROOT = Path(__file__).parents[2]
ROOMS = ("claims", "text", "models", "numeric", "proof", "methods")
DECIDING = ("sympy", "mpmath", "flint")
PROPOSING = ("numpy", "scipy", "numba", "casadi", "cvxpy", "highspy", "clarabel", "osqp")
SWITCHES = ("SYMPY_", "MPMATH_")

#: What source files were when they were looked at: path, time of change in nanoseconds, size.
Snapshot = tuple[tuple[str, int, int], ...]


@functools.cache
def rooms_digest() -> str:
    """Digest of all that decides, whichever the claim."""
    files = [part for path in room_files() for part in (str(path.relative_to(ROOT)), path.read_text("utf-8"))]
    return key_of("rooms", *interpreter(), *map(package_digest, DECIDING), *map(version, PROPOSING), *files)


def room_files() -> list[Path]:
    """Sources of the deciding rooms, and the files beside them: the checker, the store, the errors."""
    return sorted([*ROOT.glob("*.py"), *(path for room in ROOMS for path in (ROOT / room).rglob("*.py"))])


def interpreter() -> list[str]:
    """Python, the machine, and the switches that change what runs: ``-O`` drops assertions."""
    named = sorted(f"{name}={value}" for name, value in os.environ.items() if name.startswith(SWITCHES))
    return [sys.version, sys.platform, f"optimize {sys.flags.optimize}", *named]


def version(name: str) -> str:
    """Name and version of an installed package, or that there is none."""
    try:
        return f"{name} {importlib.metadata.version(name)}"
    except importlib.metadata.PackageNotFoundError:
        return f"{name} none"


@functools.cache
def package_digest(name: str) -> str:
    """Digest of the sources and libraries of a package or module, where Python would import it from."""
    spec = importlib.util.find_spec(name)
    if spec is None or spec.origin is None:
        return f"{name} none"
    origin, digest = Path(spec.origin), hashlib.sha256()
    for path in package_files(origin.parent) if spec.submodule_search_locations else [origin]:
        data = path.read_bytes()
        digest.update(f"{path.relative_to(origin.parent)}:{len(data)}:".encode() + data)
    return f"{name} {digest.hexdigest()}"


def package_files(folder: Path) -> Iterator[Path]:
    """Sources and compiled libraries of a package without its tests, in a fixed order."""
    for where, folders, files in os.walk(folder):
        folders[:] = sorted(set(folders) - {"tests", "__pycache__"})
        yield from (Path(where, file) for file in sorted(files) if file.endswith((".py", ".so", ".pyd")))


# -- code that changes while it runs ---------------------------------------------------------


def snapshot(*folders: Path) -> Snapshot:
    """What the sources of the deciding rooms and of more folders are now.

    A verdict is kept only if a source is the same when it is imported and when the digest is made: otherwise
    nobody knows which version ran.
    """
    more = (path for folder in folders for path in sorted(folder.rglob("*.py")))
    return tuple(seen(path) for path in [*room_files(), *more])


def seen(path: Path) -> tuple[str, int, int]:
    """Path, time of change in nanoseconds and size of a file; 0 and -1 when it is gone."""
    try:
        found = path.stat()
    except OSError:  # removed meanwhile, which is a change
        return str(path), 0, -1
    return str(path), found.st_mtime_ns, found.st_size


def not_yet_imported(files: Snapshot) -> Snapshot:
    """Those sources that a process forked from this one may still import, in the version of that moment."""
    loaded = {getattr(module, "__file__", None) for module in sys.modules.copy().values()}
    return tuple(entry for entry in files if entry[0] not in loaded)


def patches() -> list[str]:
    """Functions in a deciding module that come from a file that is not installed: put there at run time."""
    known = ("<", *installed(), *(folder_of(name) for name in ("navsym", *DECIDING)))
    found = []
    for name, module in sorted(sys.modules.copy().items()):
        if name.partition(".")[0] in ("navsym", *DECIDING):
            for place, function in functions_of(name, vars(module)):
                if not function.__code__.co_filename.startswith(known):
                    found.append(f"{place}={function.__code__.co_code.hex()}")
    return found


def functions_of(owner: str, names: Mapping[str, Any]) -> Iterator[tuple[str, FunctionType]]:
    """The functions in a module and in its own classes."""
    for name, value in list(names.items()):
        if isinstance(value, FunctionType):
            yield f"{owner}.{name}", value
        elif isinstance(value, type) and value.__module__ == owner:
            inner = list(vars(value).items())
            yield from ((f"{owner}.{name}.{key}", v) for key, v in inner if isinstance(v, FunctionType))


@functools.cache
def folder_of(name: str) -> str:
    """The folder from which a package is imported."""
    spec = importlib.util.find_spec(name)
    return str(Path(spec.origin).parent) + os.sep if spec is not None and spec.origin else "<"


@functools.cache
def installed() -> tuple[str, ...]:
    """Folders of the standard library and of installed packages."""
    import sysconfig

    paths = sysconfig.get_paths()
    return tuple({paths[name] for name in ("stdlib", "platstdlib", "purelib", "platlib")})
