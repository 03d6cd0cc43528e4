"""Names of the files of a report, and the certificates that it keeps as files."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

Record = Mapping[str, Any]


def certificate_files(records: Sequence[Record]) -> dict[str, str]:
    """Certificates as ``navsym check`` reads them."""
    return {
        name: json.dumps(part, ensure_ascii=False, indent=1) + "\n"
        for record in records
        for name, part in certificates(record)
    }


def certificates(record: Record) -> list[tuple[str, Any]]:
    """File names and certificates of a record: one for each entry where a claim has several."""
    whole = record.get("certificate")
    if not whole:
        return []
    parts = whole["of"] if whole.get("kind") == "all" and isinstance(whole.get("of"), list) else [whole]
    name = f"certificates/{slug(record['id'])}"
    if len(parts) == 1:
        return [(f"{name}.json", parts[0])]
    return [(f"{name}.{place}.json", part) for place, part in enumerate(parts, start=1)]


def slug(name: str) -> str:
    """A name that is safe in a file name and in an address; different names stay different."""
    plain = re.sub(r"[^A-Za-z0-9.-]", "_", name)[:80].strip(".")
    return plain if plain == name else f"{plain}-{hashlib.sha256(name.encode('utf-8', 'replace')).hexdigest()[:6]}"
