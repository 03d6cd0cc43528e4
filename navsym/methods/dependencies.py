"""What the verdict of a claim depends on: its own source, what that calls, and the rooms that decide.

The fingerprint of a claim is a digest of the source text of its function, of every function and
constant of the derivations that it can reach by name, of the values that it closes over, of all
of navsym's deciding rooms and of the versions of the engines. Touching one claim changes its own
fingerprint and those of the claims that share the touched lines; touching a room changes all.
"""

from __future__ import annotations

import ast
import functools
import importlib.metadata
import sys
from collections.abc import Iterable
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

from navsym.claims import Claim
from navsym.store import key_of

ROOMS = ("claims", "text", "models", "numeric", "proof", "methods")
ENGINES = ("sympy", "python-flint", "numpy", "mpmath")


def fingerprint(claim: Claim) -> str:
    """Digest of everything that the claim's verdict depends on."""
    card = (claim.id, str(claim.expect), str(claim.corrects), str(claim.slip), claim.reason, claim.title)
    return key_of("verdict", *card, rooms_digest(), *reachable_sources(claim.derive))


@functools.cache
def rooms_digest() -> str:
    """Digest of the deciding rooms and of the engines' versions."""
    root = Path(__file__).parent.parent
    files = sorted(path for room in ROOMS for path in (root / room).rglob("*.py"))
    versions = [f"{name} {importlib.metadata.version(name)}" for name in ENGINES]
    return key_of(sys.version, *versions, *(path.read_text(encoding="utf-8") for path in files))


def reachable_sources(function: Any) -> list[str]:
    """Source texts of all that a function of the derivations reaches by name, in a fixed order."""
    found: dict[str, str] = {}
    queue: list[tuple[ModuleType, Iterable[str]]] = []
    note_function(function, found, queue)
    while queue:
        module, names = queue.pop()
        for name in names:
            note_name(module, name, found, queue)
    return [f"{key}={found[key]}" for key in sorted(found)]


def note_function(function: Any, found: dict[str, str], queue: list[Any]) -> None:
    """The function itself, what it closes over, and the names that its code mentions."""
    function = getattr(function, "__wrapped__", function)
    if not isinstance(function, FunctionType):
        found[f"object {function!r}"] = ""
        return
    module = sys.modules.get(function.__module__)
    code = function.__code__
    found[f"code {code.co_filename}:{code.co_name}"] = code_text(code)
    for cell in function.__closure__ or ():
        note_value(cell.cell_contents, found, queue)
    for value in function.__defaults__ or ():
        note_value(value, found, queue)
    if module is not None:
        queue.append((module, code_names(code)))


def note_value(value: Any, found: dict[str, str], queue: list[Any]) -> None:
    if isinstance(value, FunctionType):
        note_function(value, found, queue)
    else:
        found[f"value {value!r}"] = type(value).__name__


def note_name(module: ModuleType, name: str, found: dict[str, str], queue: list[Any]) -> None:
    """A global of a derivation module: its defining lines, and what they mention in turn."""
    key = f"{module.__name__}.{name}"
    if key in found or not module.__name__.startswith("derivations"):
        return
    definition = definitions(module).get(name)
    if definition is None:
        note_imported(module, name, found, queue)
        return
    found[key], mentioned = definition
    queue.append((module, mentioned))


def note_imported(module: ModuleType, name: str, found: dict[str, str], queue: list[Any]) -> None:
    """A name that the module imports from another derivation module."""
    source = imports(module).get(name)
    if source is None:
        return
    origin, original = source
    whole = sys.modules.get(f"{origin}.{original}" if original else origin)
    if whole is not None and whole.__file__:  # imported as a whole: all that it defines and imports counts
        found[f"{module.__name__}.{name}"] = ast.unparse(tree_of(whole))
        queue.append((whole, [*definitions(whole), *imports(whole)]))
    elif origin in sys.modules:
        found[f"{module.__name__}.{name}"] = f"from {origin}"
        queue.append((sys.modules[origin], [original]))


def code_text(code: CodeType) -> str:
    """Bytecode with its constants and names: the same for the same source, wherever it stands."""
    constants = [code_text(c) if isinstance(c, CodeType) else repr(c) for c in code.co_consts]
    return key_of(code.co_code.hex(), *constants, *code.co_names, *code.co_varnames)


def code_names(code: CodeType) -> set[str]:
    """Names that the code and the functions inside it mention."""
    inner = (code_names(c) for c in code.co_consts if isinstance(c, CodeType))
    return set(code.co_names).union(*inner)


@functools.cache
def definitions(module: ModuleType) -> dict[str, tuple[str, tuple[str, ...]]]:
    """Global name -> (source text, names that it mentions) of one derivation module."""
    found: dict[str, tuple[str, tuple[str, ...]]] = {}
    for node in tree_of(module).body:
        for name in bound_names(node):
            text = found[name][0] + ast.unparse(node) if name in found else ast.unparse(node)
            found[name] = (text, mentioned_names(node))
    return found


@functools.cache
def imports(module: ModuleType) -> dict[str, tuple[str, str]]:
    """Local name -> (module, original name) of what is imported from derivations."""
    found = {}
    for node in ast.walk(tree_of(module)):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("derivations"):
            for alias in node.names:
                found[alias.asname or alias.name] = (str(node.module), alias.name)
        if isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name.startswith("derivations"):
                    found[alias.asname or "derivations"] = (alias.name, "")
    return found


def tree_of(module: ModuleType) -> ast.Module:
    return ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8"))


def bound_names(node: ast.stmt) -> list[str]:
    """Names that a statement at the top of a module binds."""
    if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
        return [node.name]
    return [n.id for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)]


def mentioned_names(node: ast.stmt) -> tuple[str, ...]:
    return tuple(sorted({n.id for n in ast.walk(node) if isinstance(n, ast.Name)}))
