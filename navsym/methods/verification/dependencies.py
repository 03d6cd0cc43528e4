"""What the verdict of a claim depends on: its own code, what that reaches, and the rooms that decide.

The fingerprint of a claim is a digest of the code of its function, of every function and constant of the
derivations that it can reach by name, of the values that it closes over, and of the deciding code
(:mod:`navsym.methods.verification.deciding_code`). Touching one claim changes its own fingerprint and those of the
claims that share the touched lines; touching a room changes all. What cannot be described by its content gets a
mark that never comes again, so that such a claim is decided every time.
"""

from __future__ import annotations

import contextlib
import functools
import importlib
import sys
import uuid
from collections.abc import Iterable
from dataclasses import dataclass, field, fields, is_dataclass
from enum import Enum
from fractions import Fraction
from pathlib import PurePath
from types import BuiltinFunctionType, CellType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np
import sympy as sp

from navsym.claims import Claim
from navsym.methods.verification.deciding_code import DECIDING, PROPOSING, package_digest, patches, rooms_digest
from navsym.methods.verification.sources import (
    INDIRECT,
    PACKAGE,
    definitions,
    imports,
    package_digest_of_all,
    package_effects,
    whole_text,
)
from navsym.store import key_of

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
