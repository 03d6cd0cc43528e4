"""Compile what was exported, run it on its vectors, and say what came of it.

Nothing is "verified" that did not run: a missing toolchain is reported as "not executed".
"""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from navsym.claims.display import count_in_words
from navsym.export.folder import is_plain
from navsym.export.languages.targets import TARGETS, WORDS, Target
from navsym.export.processes import run
from navsym.export.tools import misra

LINE = re.compile(r"(\w+) vectors (\d+) wrong (\d+) worst ([-+.\w]+)")
MANIFEST = "manifest.json"


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a language's vectors said.

    status    : "verified", "failed" or "not executed"
    functions : name -> (vectors, wrong, worst error in units of 2^-52 relative, or 2^-23 for float)
    """

    language: str
    status: str
    why: str
    functions: dict[str, tuple[int, int, float]]


def run_target(folder: Path, target: Target) -> Outcome:
    """Build and run the vectors of one language's folder; the build goes to a temporary folder."""
    tool = target.executable()
    if tool is None:
        return Outcome(
            target.name, "not executed", f"{target.missing_module() or target.tool} is not on this machine", {}
        )
    text = ""
    with tempfile.TemporaryDirectory(prefix="navsym-run-") as build:
        for step in steps_of(target, folder, tool, build):
            done, text = run(step, folder)
            if done != 0:
                return Outcome(target.name, "failed", words(text) or f"exit status {done}", measured(text))
    found = measured(text)
    if not found:
        return Outcome(target.name, "not executed", f"no vectors ran: {words(text)}".rstrip(": "), {})
    wrong = any(bad for _, bad, _ in found.values())
    return Outcome(target.name, "failed" if wrong else "verified", words(text) if wrong else "", found)


def steps_of(target: Target, folder: Path, tool: str, build: str) -> list[list[str]]:
    """The commands with their places filled in."""
    table = WORDS | {
        "{tool}": [tool],
        "{python}": [sys.executable],
        "{c}": [p.name for p in sorted(folder.glob("*.c"))],
    }

    def fill(word: str) -> Sequence[str]:
        return table.get(word, [word.replace("{build}", build)])

    return [[part for word in step.split() for part in fill(word)] for step in target.steps]


def measured(text: str) -> dict[str, tuple[int, int, float]]:
    """What a test program printed: name -> vectors, wrong ones, worst distance."""
    return {name: (int(n), int(wrong), float(worst)) for name, n, wrong, worst in LINE.findall(text)}


def words(text: str) -> str:
    """The first lines that say what went wrong."""
    bad = [f"{name}: {wrong} of {n} vectors outside" for name, n, wrong, _ in LINE.findall(text) if wrong != "0"]
    lines = bad or [line for line in text.splitlines() if line.strip()]
    lines = lines[-1:] if lines and lines[0].startswith("Traceback") else lines[:3]
    return "; ".join(lines)[:300]


def check_export(folder: Path) -> list[dict[str, Any]]:
    """Rows ``{"path", "kind", "status", "why"}`` for the code of an exported folder.

    The manifest's seal and hashes are compared first; then every language runs its vectors, from a copy of what the
    manifest lists. A language whose toolchain is missing is accepted for its hashes only, and the row says so.
    """
    folder = Path(folder)
    if not (folder / MANIFEST).is_file():
        lost = "expected the manifest of the code that is here; got none; export again"
        return [row(folder / MANIFEST, "manifest", lost)] if any(has_code(folder / name) for name in TARGETS) else []
    try:
        manifest, trouble = unsealed((folder / MANIFEST).read_bytes())
        files, languages = dict(manifest["files"]), [str(name) for name in manifest["languages"]]
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        came = f"{type(error).__name__}: {error}"
        return [row(folder / MANIFEST, "manifest", f"expected a manifest of navsym export; got {came}")]
    rows = [row(folder / MANIFEST, "manifest", trouble or hash_trouble(folder, files))]
    rows += [language_row(folder, name, list(files)) for name in languages]
    return rows + ([misra_row(folder / "c")] if "c" in languages and (folder / "c").is_dir() else [])


def sealed(manifest: Mapping[str, Any]) -> str:
    """The manifest as text, with the hash of all the rest as its last entry."""
    return as_json({**manifest, "seal": seal_of(manifest)})


def unsealed(data: bytes) -> tuple[dict[str, Any], str]:
    """The manifest of a file, and what is not as it was written; ValueError when there is none in it."""
    text = data.decode("utf-8")
    manifest = json.loads(text)
    if as_json(manifest) != text:
        return manifest, f"{MANIFEST}: not as exported (its layout differs)"
    rest = {key: value for key, value in manifest.items() if key != "seal"}
    return manifest, "" if manifest.get("seal") == seal_of(rest) else f"{MANIFEST}: not as exported (its seal differs)"


def seal_of(manifest: Mapping[str, Any]) -> str:
    """sha256 of a manifest without its seal."""
    return hashlib.sha256(as_json(manifest).encode()).hexdigest()


def as_json(manifest: Any) -> str:
    """The text of a manifest as it is written."""
    return json.dumps(manifest, indent=2) + "\n"


def has_code(folder: Path) -> bool:
    """True for the folder of a language: it has the program or the page that runs its vectors."""
    return folder.is_dir() and any(p.name.startswith("test_") or p.name == "index.html" for p in folder.iterdir())


def language_row(folder: Path, name: str, files: Sequence[str]) -> dict[str, Any]:
    """One language: its vectors, run on a copy of its files that the manifest lists, and on nothing else."""
    target = TARGETS.get(name)
    if target is None or not (folder / name).is_dir():
        return row(folder / name, "code", "expected a folder of a known language; got none")
    with tempfile.TemporaryDirectory(prefix="navsym-check-") as copy:
        for file in files:
            if is_plain(file) and file.startswith(f"{name}/") and (folder / file).is_file():
                (Path(copy) / file).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(folder / file, Path(copy) / file)
        outcome = run_target(Path(copy) / name, target)
    if outcome.status == "failed":
        return row(folder / name, "code", outcome.why)
    why = f"not executed: {outcome.why}" if outcome.status == "not executed" else ""
    if not why:
        vectors = sum(n for n, _, _ in outcome.functions.values())
        why = f"{count_in_words(len(outcome.functions), 'function')}, {vectors} vectors inside their enclosures"
    return {"path": str(folder / name), "kind": f"code:{name}", "status": "ACCEPTED", "why": why}


def misra_row(folder: Path) -> dict[str, Any]:
    """Findings of the MISRA add-on; accepted when none lies outside the written deviations, or when it is not there."""
    said = misra(folder)
    if said.status == "failed":
        return row(folder, "misra", said.why)
    counted = ", ".join(f"{count} of rule {rule} (deviation)" for rule, count in said.counts.items())
    why = f"not executed: {said.why}" if said.status == "not executed" else counted or "no findings"
    return {"path": str(folder), "kind": "misra", "status": "ACCEPTED", "why": why}


def hash_trouble(folder: Path, files: dict[str, Any]) -> str:
    """What differs from the manifest, in words; empty when nothing does."""
    for name, digest in files.items():
        path = folder / str(name)
        if not is_plain(name) or path.is_symlink() or not path.is_file():
            return f"{name}: expected a plain file of the export; got none"
        if hashlib.sha256(path.read_bytes()).hexdigest() != digest:
            return f"{name}: not as exported (its hash differs)"
    return ""


def row(path: Path, kind: str, why: str) -> dict[str, Any]:
    """A row of the document: ACCEPTED without a reason, else REJECTED."""
    return {"path": str(path), "kind": kind, "status": "REJECTED" if why else "ACCEPTED", "why": why}
