"""The sources of derivations, read and not run: what defines a name, what it mentions, where it is imported from."""

from __future__ import annotations

import ast
import functools
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

from navsym.store import key_of

PACKAGE = "derivations"

#: Names by which code reaches what it does not name: what mentions one depends on every derivation.
INDIRECT = frozenset(
    {"__import__", "import_module", "eval", "exec", "globals", "vars", "getattr", "setattr", "delattr"}
    | {"__dict__", "modules", "open", "read_text", "read_bytes"}
)


@functools.cache
def definitions(module: ModuleType) -> dict[str, tuple[str, tuple[str, ...]]]:
    """Global name -> (source text, names that it mentions) of one derivation module."""
    found: dict[str, tuple[str, tuple[str, ...]]] = {}
    for node in tree_of(module).body:
        text, mentioned = ast.unparse(node), mentioned_names(node)
        for name in bound_names(node):
            before = found.get(name, ("", ()))
            found[name] = (before[0] + text, (*before[1], *mentioned))
    return found


@functools.cache
def imports(module: ModuleType) -> dict[str, list[tuple[str, str]]]:
    """Local name -> (module, original name) of every import of it, those inside functions included."""
    found: dict[str, list[tuple[str, str]]] = {}
    for node in ast.walk(tree_of(module)):
        if isinstance(node, ast.ImportFrom):
            for alias in node.names:
                found.setdefault(alias.asname or alias.name, []).append((absolute(module, node), alias.name))
        if isinstance(node, ast.Import):
            for alias in node.names:
                found.setdefault(alias.asname or alias.name.partition(".")[0], []).append((alias.name, ""))
    return found


def absolute(module: ModuleType, node: ast.ImportFrom) -> str:
    """The full name of the module that is imported from."""
    if not node.level:
        return node.module or ""
    package = (module.__package__ or "").split(".")
    parent = package[: len(package) - node.level + 1]
    return ".".join([*parent, *([node.module] if node.module else [])])


@functools.cache
def whole_text(module: ModuleType) -> str:
    """The source of a module without comments and layout."""
    return ast.unparse(tree_of(module))


@functools.cache
def tree_of(module: ModuleType) -> ast.Module:
    """Syntax tree of the source of a module, parsed once."""
    return ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8"))


def bound_names(node: ast.stmt) -> list[str]:
    """Names that a statement at the top of a module binds, also inside ``if``, ``try``, ``for`` and ``with``."""
    if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
        return [node.name]
    stores = [n.id for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)]
    return stores + [n.name for n in ast.walk(node) if isinstance(n, (ast.FunctionDef, ast.ClassDef))]


def mentioned_names(node: ast.stmt) -> tuple[str, ...]:
    """Names, and those attributes that reach further than they say."""
    names = {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}
    return tuple(sorted(names | {n.attr for n in ast.walk(node) if isinstance(n, ast.Attribute)} & INDIRECT))


# -- the folder as a whole -------------------------------------------------------------------


@functools.cache
def package_digest_of_all() -> str:
    """Digest of every source of the derivations: what code that reaches them indirectly depends on."""
    return key_of(*(f"{path.name}={path.read_text(encoding='utf-8')}" for path in package_sources()))


def package_sources() -> list[Path]:
    """Source files of the derivations, in a fixed order; none when they are not imported."""
    package = sys.modules.get(PACKAGE)
    folders = [] if package is None else [Path(folder) for folder in package.__path__]
    return [path for folder in folders for path in sorted(folder.rglob("*.py"))]


def package_effects() -> list[str]:
    """What the derivations do to each other and to navsym when they are imported: it counts for every claim."""
    return [f"{path.name}: {text}" for path in package_sources() for text in effects(path, path.stat().st_mtime_ns)]


@functools.cache
def effects(path: Path, changed: int) -> tuple[str, ...]:
    """Statements of a file that may change what stands elsewhere; ``changed`` keeps the cache honest.

    At the top of a module that is whatever defines no name: ``TABLE[1] = 2``, and ``register(x)``, with which
    all that it might call counts. Anywhere it is an attribute that is set or deleted, directly or by name.
    """
    body = ast.parse(path.read_text(encoding="utf-8")).body
    found = [node for node in body if acts(node) or any(map(sets, ast.walk(node)))]
    calls = [node for node in found if acts(node) and any(isinstance(part, ast.Call) for part in ast.walk(node))]
    return (*map(ast.unparse, found), *([package_digest_of_all()] if calls else []))


def acts(node: ast.stmt) -> bool:
    """True of a statement at the top that is neither a definition nor a text."""
    if isinstance(node, (ast.FunctionDef, ast.ClassDef, ast.Import, ast.ImportFrom)):
        return False
    if isinstance(node, ast.Expr):
        return not isinstance(node.value, ast.Constant)
    if isinstance(node, ast.Assign):
        return not all(isinstance(name, ast.Name) for target in node.targets for name in flat(target))
    return not (isinstance(node, (ast.AnnAssign, ast.AugAssign)) and isinstance(node.target, ast.Name))


def flat(target: ast.expr) -> Iterator[ast.expr]:
    """The single targets of a nested assignment such as ``(a, *b), c = …``."""
    if isinstance(target, (ast.Tuple, ast.List)):
        for element in target.elts:
            yield from flat(element)
    else:
        yield target.value if isinstance(target, ast.Starred) else target


def sets(part: ast.AST) -> bool:
    """True where an attribute is set or deleted, or a global declared."""
    if isinstance(part, ast.Attribute):
        stored = not isinstance(part.ctx, ast.Load) and part.attr not in {"__module__", "__doc__"}
        return stored or part.attr in {"__dict__", "__setattr__", "modules"}
    if isinstance(part, ast.Name):
        return part.id in {"setattr", "delattr", "exec", "eval", "globals", "vars"}
    return isinstance(part, ast.Global)
