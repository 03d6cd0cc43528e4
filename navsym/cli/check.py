"""Re-verify certificates with the independent checker."""

from __future__ import annotations

import importlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from navsym.cli._progress import Progress
from navsym.cli.output import emit, table
from navsym.core.errors import EmptyError, NavsymError
from navsym.language.files import decode

LARGEST = 50_000_000
#: Every key that a certificate has: a file of nothing else is one, even if it lost its kind.
KEYS = frozenset(
    "kind left right symbols matrix solution variable rank point rows null expression box bits cells of panels "
    "functional dual support lower upper contacts radius parameter from to pieces".split()
)


def command(
    paths: Annotated[list[Path], typer.Argument(help="certificates (JSON) or folders of them")],
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Accept or reject every certificate; status 1 when one is rejected.

    Example: navsym check report/certificates
    """
    rows: list[dict[str, Any]] = []
    work = [part for path in paths for part in parts_of(path)]
    try:
        with Progress("parts", len(work), "those checked follow; name the other paths for the rest") as bar:
            for check, path in work:
                rows += check(path)
                bar.step(path.name)
    except KeyboardInterrupt:
        emit({"checked": rows, "interrupted": True}, as_json=json_, text=lambda: as_text(rows))
        raise
    if not rows:
        raise EmptyError("expected certificates; got none; name JSON files or exported folders", where=str(paths[0]))
    emit({"checked": rows}, as_json=json_, text=lambda: as_text(rows))
    if any(row["status"] != "ACCEPTED" for row in rows):
        raise typer.Exit(1)


Part = tuple[Callable[[Path], list[dict[str, Any]]], Path]


def parts_of(path: Path) -> list[Part]:
    """What there is to check: a file, or the exported code and every JSON file of a folder."""
    if not path.exists():
        message = "expected a file or folder that exists; got none of this name; do correct it"
        raise NavsymError(message, where=str(path), kind="missing-file")
    if path.is_dir():
        return [(check_exported, path), *((check_folder_file, file) for file in sorted(path.rglob("*.json")))]
    return [(lambda file: [check_file(file)], path)]


def check_folder_file(file: Path) -> list[dict[str, Any]]:
    """A JSON file in a folder counts when it is a certificate; vectors and manifests do not."""
    try:
        document = json.loads(file.read_text("utf-8"))
    except (OSError, ValueError):
        return [check_file(file)]
    certificate = isinstance(document, dict) and bool(document) and ("kind" in document or document.keys() <= KEYS)
    return [check_file(file)] if certificate else []


def check_file(path: Path) -> dict[str, Any]:
    from navsym import checker

    try:
        if path.stat().st_size > LARGEST:
            raise checker.Refused("longer than 50 MB")
        item = checker.load(decode(path.read_bytes(), str(path)))
        kind = checker.check(item)
    except OSError as error:
        return verdict(path, None, f"cannot be read: {error.strerror}")
    except NavsymError as error:
        return verdict(path, None, error.message)
    except checker.Refused as error:
        return verdict(path, kind_of(path), str(error))
    return {"path": str(path), "kind": kind, "status": "ACCEPTED", "why": ""}


def verdict(path: Path, kind: str | None, why: str) -> dict[str, Any]:
    return {"path": str(path), "kind": kind, "status": "REJECTED", "why": why}


def kind_of(path: Path) -> str | None:
    try:
        document = json.loads(path.read_text("utf-8"))
    except (ValueError, RecursionError):
        return None
    kind = document.get("kind") if isinstance(document, dict) else None
    return kind if isinstance(kind, str) else None


def check_exported(folder: Path) -> list[dict[str, Any]]:
    """Exported code runs on its own vectors; the export room knows how, when it is there."""
    try:
        roundtrip = importlib.import_module("navsym.export.roundtrip")
    except ModuleNotFoundError:
        return []
    check = getattr(roundtrip, "check_folder", None)
    return list(check(folder)) if check is not None else []


def as_text(rows: list[dict[str, Any]]) -> str:
    cells = [(row["path"], row["kind"] or "", row["status"], row["why"]) for row in rows]
    return table(("path", "kind", "status", "why"), cells)
