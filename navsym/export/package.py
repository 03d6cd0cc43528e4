"""A whole export: code in every language, vectors, certificates and a manifest that regenerates it."""

from __future__ import annotations

import hashlib
import json
import platform
import shlex
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from navsym import __version__
from navsym.core.answers import Answer, named
from navsym.core.errors import DomainError, DuplicateError, NavsymError
from navsym.export.accuracy.vectors import Vector, vectors
from navsym.export.folder import require_free, write_folder
from navsym.export.functions import rebounded
from navsym.export.languages.summary import bound_text, function_record
from navsym.export.languages.targets import Target
from navsym.export.parts import ExportedFunction, Piece
from navsym.export.roundtrip import MANIFEST, Outcome, run_target, sealed
from navsym.prove.certificates import identity_certificate
from navsym.verification.certificates import list_parts

COUNT = 48
LICENSE = "Apache-2.0"


@dataclass(frozen=True, slots=True)
class Order:
    """What is wanted: languages, licence, number of vectors, and the command for the manifest.

    force    : replace files that are there; execute : compile and run the code
    progress : called with the name of each language that was written and run
    """

    targets: tuple[Target, ...]
    license: str = LICENSE
    count: int = COUNT
    command: tuple[str, ...] = ()
    force: bool = False
    execute: bool = True
    progress: Callable[[str], None] = lambda language: None


def files_of(functions: Sequence[ExportedFunction], order: Order) -> dict[str, str]:
    """Relative name -> text of everything that is exported, the manifest included."""
    names = [function.name.lower() for function in functions]
    if len(set(names)) < len(names):
        raise DuplicateError("expected functions with different names; got one name twice; name each claim once")
    notice = f"SPDX-License-Identifier: {license_id(order.license)}"
    found: dict[str, str] = {}

    @cache
    def bounded(library: int) -> list[ExportedFunction]:
        """The functions with the bounds that hold for a library that is accurate to so many ulps."""
        return [f if library == f.arithmetic.library else rebounded(f, library) for f in functions]

    @cache
    def tests(library: int, widen: int) -> dict[str, list[Vector]]:
        """Vectors of every function by name, for the languages that share them."""
        return {f.name: vectors(f, order.count, library=library, widen=widen) for f in bounded(library)}

    for target in order.targets:
        made = target.files()(bounded(target.library), tests(target.library, target.widen), notice)
        found |= {f"{target.name}/{name}": text for name, text in made.items()}
    for function in functions:
        found |= certificate_texts(function)
    found[MANIFEST] = sealed(
        manifest([function_record(f) for f in functions], functions[0].arithmetic.name, order, found)
    )
    return found


def license_id(text: str) -> str:
    """The identifier as it is; raises DomainError when it cannot be one of SPDX."""
    if not text or len(text) > 80 or not all(c.isascii() and (c.isalnum() or c in ".-+() ") for c in text):
        message = f"expected an SPDX identifier such as Apache-2.0; got {text[:40]!r}; correct it"
        raise DomainError(message, where="export: license")
    return text


def certificate_texts(function: ExportedFunction) -> dict[str, str]:
    """The claim's own certificates, and those that the code graph equals the claim's formula.

    One file for each, in a form that ``navsym check`` replays.
    """
    found = {}
    for place, piece in enumerate(function.pieces):
        stem = f"certificates/{function.name}" + (f".{place}" if len(function.pieces) > 1 else "")
        claimed = [dict(part) for part in list_parts(piece.source.certificate or {}) if part]
        for kind, parts in (("claim", claimed), ("graph", ties_of(piece))):
            for number, part in enumerate(parts):
                tail = f".{number}" if len(parts) > 1 else ""
                found[f"{stem}.{kind}{tail}.json"] = json.dumps(part, indent=2) + "\n"
    return found


def ties_of(piece: Piece) -> list[dict[str, Any]]:
    """``formula = graph`` for every result that was rewritten, for the independent checker."""
    if piece.tie != "normal form":
        return []
    found = {(left, right): identity_certificate(left, right) for left, right in piece.equals if left != right}
    return [dict(part) for part in found.values() if part is not None]


def manifest(
    functions: Sequence[Mapping[str, Any]], real: str, order: Order, files: Mapping[str, str]
) -> dict[str, Any]:
    """What was exported from what, with which versions, and how to make it again byte for byte."""
    return {
        "navsym": __version__,
        "made_with": {"python": platform.python_version()}
        | {p: version(p) for p in ("sympy", "python-flint", "numpy")},
        "command": shlex.join(order.command),
        "license": order.license,
        "real": real,
        "languages": [target.name for target in order.targets],
        "functions": functions,
        "files": {name: hashlib.sha256(text.encode()).hexdigest() for name, text in sorted(files.items())},
    }


# The whole export


class FailedError(NavsymError):
    """Generated code that does not hold; it is not written."""

    kind = "failed"
    status = 1


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Exported(Answer):
    """Verified code in a folder.

    out       : the folder
    functions : what was exported: name, claims, status, rounding bounds
    outcomes  : for each language, how its code did on the vectors
    files     : names of the written files
    """

    out: Path
    functions: tuple[dict[str, Any], ...]
    outcomes: tuple[Outcome, ...]
    files: tuple[str, ...]

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym export``."""
        parts = {"languages": [outcome_record(outcome) for outcome in self.outcomes], "files": len(self.files)}
        return named(self, "out functions") | parts

    def __repr__(self) -> str:
        said = ", ".join(f"{outcome.language} {outcome.status}" for outcome in self.outcomes)
        return f"<export of {', '.join(f['name'] for f in self.functions)} to {self.out}: {said}>"


def write_export(functions: Sequence[ExportedFunction], order: Order, out: Path) -> Exported:
    """Make an export, run it, and write it when it held.

    Raises FailedError when a language's vectors fail, FolderError when nothing may be written.
    """
    files = files_of(functions, order)
    outcomes = write_verified(files, order, out)
    return Exported(out, tuple(summary_record(f) for f in functions), outcomes, tuple(files))


def write_verified(files: Mapping[str, str], order: Order, out: Path) -> tuple[Outcome, ...]:
    """Run the vectors of every language in a trial folder, and write the files to their own when they held."""
    require_free(out, files, force=order.force)
    with tempfile.TemporaryDirectory(prefix="navsym-export-") as trial:
        write_folder(Path(trial), files, force=True)
        outcomes = []
        for target in order.targets:
            asked = run_target(Path(trial) / target.name, target) if order.execute else None
            outcomes.append(asked or Outcome(target.name, "not executed", "not asked for", {}))
            order.progress(target.name)
    failed = [outcome for outcome in outcomes if outcome.status == "failed"]
    if failed:
        raise FailedError(
            f"expected {failed[0].language} code inside its enclosures; got {failed[0].why}; "
            "nothing was written; leave this language out, and report the claim"
        )
    write_folder(out, files, force=order.force)
    return tuple(outcomes)


def summary_record(function: ExportedFunction) -> dict[str, Any]:
    """A function for the document of the verb: claims, verdicts, rounding bounds."""
    return {
        "name": function.name,
        "claims": [source.claim for source in function.sources],
        "status": sorted({source.status for source in function.sources}),
        "rounding": [bound_text(function, piece) for piece in function.pieces],
    }


def outcome_record(outcome: Outcome) -> dict[str, Any]:
    """The outcome of a language as plain data."""
    functions = {
        name: {"vectors": n, "wrong": wrong, "worst": worst} for name, (n, wrong, worst) in outcome.functions.items()
    }
    return {"language": outcome.language, "status": outcome.status, "why": outcome.why, "functions": functions}
