"""What the verdict of a claim depends on: its own code, what that reaches, and the rooms that decide.

The fingerprint of a claim is a digest of the code of its function, of every function and constant of the
derivations that it can reach by name, of the values that it closes over, and of the deciding code
(:mod:`navsym.verification.fingerprints`). Touching one claim changes its own fingerprint and those of the
claims that share the touched lines; touching a room changes all. What cannot be described by its content gets a
mark that never comes again, so that such a claim is decided every time.
"""

from __future__ import annotations

import ast
import contextlib
import functools
import hashlib
import importlib
import importlib.metadata
import importlib.util
import os
import sys
import uuid
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from enum import Enum
from fractions import Fraction
from pathlib import Path, PurePath
from types import BuiltinFunctionType, CellType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np

from navsym.claims.claim import PAPERS, Claim
from navsym.core.store import key_of

# The sources of derivations, read and not run: what defines a name, what it mentions, where it is imported from.


PACKAGE = PAPERS

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


# The code that decides, as one digest: navsym's rooms, the engines as they are installed, and the switches.
#
# Two runs with the same digest decide the same statement in the same way. The engines that decide are read
# whole, so that a file edited in place or another copy earlier on the path counts; engines that only propose
# (a solver's answer is checked) count by their version.


ROOT = Path(__file__).parents[1]
ROOMS = (
    "core",
    "language",
    "claims",
    "prove",
    "models",
    "guaranteed",
    "observability",
    "multimodel",
    "trajectory",
    "terrain",
    "verification",
)
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


KNOWN = frozenset({"navsym", PACKAGE, *DECIDING, *PROPOSING, *sys.stdlib_module_names})
PLAIN = (str, bytes, int, float, complex, type(None), type(...), Fraction, Enum, range, slice, PurePath)


def fingerprint(claim: Claim) -> str:
    """Digest of everything that the claim's verdict depends on."""
    return fingerprints([claim])[claim.id]


def fingerprints(claims: Iterable[Claim]) -> dict[str, str]:
    """Digests by claim id; what is common to all is looked at once."""
    common = (rooms_digest(), *patches(), *package_effects())
    return {claim.id: key_of("verdict", *card(claim), *common, *reached(claim.derive)) for claim in claims}


def card(claim: Claim) -> tuple[str, ...]:
    """What a claim says beside its code: id, expected verdict, the claim it corrects, slip, reason, title."""
    return claim.id, str(claim.expect), str(claim.corrects), str(claim.slip), claim.reason, claim.title


def reached(value: Any) -> list[str]:
    """Texts of all that a value of the derivations reaches, in a fixed order."""
    reach = Reach()
    reach.value(value)
    while reach.queue:
        module, names = reach.queue.pop()
        for name in names:
            reach.name(module, name)
    return sorted(f"{key}={text}" for key, text in reach.found.items())


@dataclass(slots=True)
class Reach:
    """What was found so far: text by place, names still to be followed, values already seen."""

    found: dict[str, str] = field(default_factory=dict)
    queue: list[tuple[ModuleType, Iterable[str]]] = field(default_factory=list)
    seen: dict[int, Any] = field(default_factory=dict)

    def value(self, value: Any) -> None:
        """Describe a value by its content, and follow what it holds and calls."""
        if id(value) in self.seen:
            return
        self.seen[id(value)] = value  # kept alive, so that no other object gets its number
        self.found[f"value {described(value)}"] = ""
        for part in held(value):
            self.value(part)
        if isinstance(value, ModuleType):
            self.module(value)
        elif isinstance(value, (FunctionType, type)) and (module := sys.modules.get(home(value))) is not None:
            self.mentioned(value, module)

    def mentioned(self, value: FunctionType | type, module: ModuleType) -> None:
        """The names that a function uses, or the name of a class."""
        if package_of(module) == PACKAGE:
            names = value.__qualname__.split(".")[:1] if isinstance(value, type) else code_names(value.__code__)
            self.queue.append((module, names))
        elif package_of(module) not in KNOWN:
            self.module(module)

    def name(self, module: ModuleType, name: str) -> None:
        """A global of a derivation module: its defining lines, and what they mention in turn."""
        key = f"{module.__name__}.{name}"
        if key in self.found:
            return
        known = imports(module)
        if name in INDIRECT:
            self.found[key] = package_digest_of_all()
        if name in definitions(module):
            self.found[key], mentioned = definitions(module)[name]
            self.queue.append((module, mentioned))
        for origin, original in known.get(name, ()):
            self.imported(key, origin, original)
        if name not in definitions(module) and name not in known:
            for origin, _ in known.get("*", ()):  # it may come from there
                self.imported(key, origin, name)

    def imported(self, key: str, origin: str, original: str) -> None:
        """A name that a derivation imports: from another derivation, or from a package of the user's."""
        self.found[f"{key} from {origin} {original}"] = ""
        package = origin.partition(".")[0]
        if package not in KNOWN:
            self.found[f"package {package}"] = package_digest(package)
        if package != PACKAGE:
            return
        whole = loaded(f"{origin}.{original}" if original else origin)
        if whole is not None:
            self.module(whole)
        elif (module := loaded(origin)) is not None:
            self.queue.append((module, [original]))

    def module(self, module: ModuleType) -> None:
        """A module as a whole: all that it defines and imports counts."""
        package, key = package_of(module), f"module {module.__name__}"
        if key in self.found:
            return
        self.found[key] = ""
        if package == PACKAGE and module.__file__:
            self.found[key] = whole_text(module)
            self.queue.append((module, [*definitions(module), *imports(module)]))
        elif package not in KNOWN:
            self.found[key] = package_digest(package)


def home(value: FunctionType | type) -> str:
    """Name of the module where a function finds its names, which ``__module__`` need not say."""
    return str(value.__module__ if isinstance(value, type) else value.__globals__.get("__name__"))


def loaded(name: str) -> ModuleType | None:
    """A derivation module, imported now if a function would import it later; None if there is no such module."""
    with contextlib.suppress(ModuleNotFoundError):
        return importlib.import_module(name)
    return sys.modules.get(name)


def package_of(module: ModuleType) -> str:
    """Name of the package that a module belongs to."""
    return module.__name__.partition(".")[0]


# -- values by their content -----------------------------------------------------------------


def described(value: Any) -> str:
    """The content of a value as text: the same in every process, and another one for another content.

    A value of a kind that is not known here gets a text that is never given again.
    """
    if isinstance(value, FunctionType):
        return f"function {value.__module__}.{value.__qualname__} {code_text(value.__code__)}"
    if isinstance(value, (type, BuiltinFunctionType, ModuleType)):
        return f"{type(value).__name__} {getattr(value, '__module__', '')}.{value.__name__}"
    if isinstance(value, PLAIN):
        return f"{type(value).__qualname__} {value!r}"
    if isinstance(value, np.ndarray) and value.dtype != object:
        return f"array {value.dtype} {value.shape} {key_of(value.tobytes().hex())}"
    import sympy as sp

    if isinstance(value, (sp.Basic, sp.MatrixBase)):
        return f"formula {sp.srepr(value)}"  # the assumptions of symbols included, which str leaves out
    texts = [described(part) for part in held(value)]
    if isinstance(value, (set, frozenset)):
        texts.sort()
    if texts or isinstance(value, (tuple, list, dict, set, frozenset)):
        return f"{type(value).__qualname__} of {', '.join(f'{len(text)}:{text}' for text in texts)}"
    return f"{type(value).__qualname__} {uuid.uuid4()}"


def held(value: Any) -> list[Any]:
    """What a value holds and calls."""
    if isinstance(value, FunctionType):
        return [*(closed_over(value.__closure__ or ())), value.__defaults__, value.__kwdefaults__, value.__dict__]
    if isinstance(value, MethodType):
        return [value.__func__, value.__self__]
    if isinstance(value, functools.partial):
        return [value.func, value.args, value.keywords]
    if isinstance(value, dict):
        return [part for pair in value.items() for part in pair]
    if isinstance(value, (tuple, list, set, frozenset)):
        return list(value)
    if isinstance(value, type):
        return []
    if is_dataclass(value):
        return [type(value), *(getattr(value, entry.name) for entry in fields(value))]
    return [value.__wrapped__] if hasattr(value, "__wrapped__") else []


def closed_over(cells: Iterable[CellType]) -> list[Any]:
    """Contents of the cells that have one."""
    found = []
    for cell in cells:
        try:
            found.append(cell.cell_contents)
        except ValueError:  # not filled yet: a function that mentions itself
            found.append(None)
    return found


def code_text(code: CodeType) -> str:
    """Bytecode with its constants and names: the same for the same source, wherever it stands."""
    constants = [code_text(c) if isinstance(c, CodeType) else described(c) for c in code.co_consts]
    shape = (code.co_argcount, code.co_kwonlyargcount, code.co_posonlyargcount, code.co_flags)
    names = (*code.co_names, "/", *code.co_varnames, "/", *code.co_freevars, "/", *code.co_cellvars)
    return key_of(code.co_code.hex(), code.co_exceptiontable.hex(), str(shape), *constants, *names)


def code_names(code: CodeType) -> set[str]:
    """Names that the code and the functions inside it mention."""
    inner = (code_names(c) for c in code.co_consts if isinstance(c, CodeType))
    return set(code.co_names).union(*inner)
