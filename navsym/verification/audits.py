"""Questions about source code as claims of a workspace: ``audits/ekf.toml:transition``.

A verdict is kept under the bytes of every file that the questions name; its certificates are granted again before use.
"""

from __future__ import annotations

import contextlib
import json
import re
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from navsym.audit.answer import audit_specification, read_blocks
from navsym.audit.syntax import SIZE
from navsym.claims import PROVED, REFUTED, Claim, Finding, Property, Status
from navsym.claims.workspace import cache_file
from navsym.core.store import StoreError, code_digest, key_of, open_store
from navsym.language.files import name_file, read_bytes
from navsym.language.names import join_place
from navsym.language.schema import as_title, require_distinct
from navsym.language.tomlfile import read_toml
from navsym.prove.claimfile import NOTES
from navsym.prove.grant import REFUSALS, grant
from navsym.verification.sources import claim_of_notes, place_of_line

if TYPE_CHECKING:
    from navsym.audit.answer import AuditedQuestion

SHOWN = 3  # entries that the evidence names


def claims_of_audit(name: str, path: Path) -> tuple[Claim, ...]:
    """One claim for each question of a file; without ``expect`` it is declared to hold."""
    document, where = read_toml(path), join_place(name_file(path), "question")
    claims = tuple(
        claim_of_question(name, path, block, join_place(where, i))
        for i, block in enumerate(read_blocks(document, "question", name_file(path)))
    )
    require_distinct((claim.number for claim in claims), where)
    return claims


def claim_of_question(name: str, path: Path, block: Mapping[str, Any], where: str) -> Claim:
    """The claim that the code is as a question expects it."""
    number = as_title(block.get("name", block.get("kind")), join_place(where, "name"))
    notes = {key: read(block[key], join_place(where, key)) for key, read in NOTES.items() if key in block}
    title = f"The code answers the question {number} ({block.get('kind')})."
    place = place_of_line(name, path, rf"\s*name\s*=\s*{re.escape(json.dumps(number))}")
    return claim_of_notes(name, number, title, partial(property_of_question, path, number), notes, place)


def files_of_source(path: Path) -> list[Path]:
    """The file of a workspace and, of an audit, the files that it names and that are there."""
    document = read_toml(path)
    blocks = [
        block for key in ("code", "question") for block in listed(document.get(key)) if isinstance(block, Mapping)
    ]
    names = [str(block[key]) for block in blocks for key in ("file", "claim") if key in block]
    inside = [path.parent / re.sub(r"(\.toml):.*", r"\1", name, flags=re.DOTALL) for name in names]
    return [path, *(file for file in dict.fromkeys(inside) if file.is_file())]


def listed(value: Any) -> list[Any]:
    """A list, or none."""
    return value if isinstance(value, list) else []


def property_of_question(path: Path, number: str) -> Property:
    """Whether the code is as a question expects: decided now, or as kept for the same bytes of all files."""
    texts = [read_bytes(file, SIZE).hex() for file in files_of_source(path)]
    key = key_of("audit", code_digest(), number, *texts)
    kept = read_kept(key)
    if kept is None:
        kept = write_finding(audit_specification(path, number)[number])
        with contextlib.suppress(StoreError), open_store(cache_file()) as store:
            store.put(key, kept)
    status = Status(kept["status"])
    is_right = status != REFUTED
    parts = kept["certificates"] if is_right else [c for c in kept["certificates"] if c["kind"] == "counterexample"][:1]
    is_whole = bool(parts) and (not is_right or kept["whole"])
    whole = {"kind": "all", "of": parts} if is_right else next(iter(parts), None)
    certificate = whole if is_whole else None
    decided = status if is_right else PROVED
    finding = Finding(is_right, "audit of source code", decided, "", (), kept["evidence"], certificate)
    return Property(True, finding, tuple(part["statement"] for part in parts) if is_whole else ())


def read_kept(key: str) -> dict[str, Any] | None:
    """What is kept, when the checker grants every certificate of it again; else None."""
    try:
        with open_store(cache_file()) as store:
            kept: dict[str, Any] | None = store.get([key]).get(key)
        for certificate in kept["certificates"] if kept else ():
            grant([certificate["statement"]], certificate)
        return kept
    except (StoreError, *REFUSALS):
        return None


def write_finding(question: AuditedQuestion) -> dict[str, Any]:
    """The verdict on a question as plain data: the first entries that do not hold, and all certificates."""
    failed = [entry for entry in question.entries if not entry.status.holds]
    counted = f"{len(question.entries) - len(failed)} of {len(question.entries)} entries are proved"
    remarks = [
        f"[{e.entry[0]},{e.entry[1]}] {e.status} at {Path(e.file).name}:{e.line}: {e.remark()}" for e in failed[:SHOWN]
    ]
    if question.status.holds and question.sense != "exact":
        counted += f" in the sense {question.sense}"
    evidence = "; ".join([counted, *remarks])
    whole = all(entry.certificate is not None for entry in question.entries)
    found = {"status": str(question.status), "evidence": evidence, "whole": whole}
    return found | {"certificates": question.certificates()}
