"""What a reader of the report has to trust: the certificates by kind and size, and the verdicts that have none."""

from __future__ import annotations

import json
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from navsym import checker
from navsym.prove.grant import UNCHECKED
from navsym.verification.certificates import JUDGES, list_parts, read_outcomes
from navsym.verification.ledger import Ledger, Record


def count_certificates(ledger: Ledger) -> dict[str, Any]:
    """What stands on the page.

    rows      : kinds of certificates, the most frequent first: how many, median and largest size in bytes
    rules     : rules of proofs, and the number of verdicts that use them
    unchecked : verdicts that rest on the code that computes them
    sampled   : verdicts that are neither proved nor refuted
    lines     : of the checker
    judged    : what the second checker and Coq have said of all certificates
    """
    kinds, rules = defaultdict[str, list[int]](list), Counter[str]()
    certificates = [record.certificate for record in ledger.claims if record.certificate]
    parts = [part for certificate in certificates for part in list_parts(certificate)]
    for part in parts:
        kinds[str(part.get("kind"))].append(len(json.dumps(part, ensure_ascii=False).encode()))
    for certificate in certificates:
        rules.update({*list_rules(certificate)})
    rows = [(kind, len(sizes), round(median(sizes)), max(sizes)) for kind, sizes in kinds.items()]
    return {
        "rows": sorted(rows, key=lambda row: (-row[1], row[0])),
        "rules": sorted(rules.items(), key=lambda item: (-item[1], item[0])),
        "unchecked": ledger.unchecked,
        "sampled": [record for record in ledger.claims if record.status in ("CONFIRMED", "OPEN")],
        "lines": len(Path(checker.__file__).read_text(encoding="utf-8").splitlines()),
        "judged": [outcome_words(judge, parts) for judge in JUDGES],
    }


def list_rules(value: Any) -> Iterator[str]:
    """The rules that stand anywhere in a certificate."""
    if isinstance(value, Mapping):
        if isinstance(value.get("rule"), str):
            yield value["rule"]
        for part in value.values():
            yield from list_rules(part)
    elif isinstance(value, list):
        for part in value:
            yield from list_rules(part)


def backing_words(record: Record) -> str:
    """What stands behind a verdict, in words: kind and size of its certificate, who accepted it; or none."""
    if record.certificate:
        parts = list_parts(record.certificate)
        size = sum(len(json.dumps(part, ensure_ascii=False).encode()) for part in parts)
        kinds = " and ".join(sorted({part["kind"] for part in parts}))
        judge = "not looked at by the checker" if UNCHECKED in record.evidence else "accepted by the checker"
        return "; ".join([f"{kinds}, {size:,} bytes, {judge}", *(outcome_words(name, parts) for name in JUDGES)])
    if record.status in ("CONFIRMED", "OPEN"):
        return "none: nothing is proved"
    if UNCHECKED not in record.evidence:
        return "beside the ledger, in certificates.json, and not in this report: make one without --from"
    return "none: unchecked, the verdict rests on the code that computes it"


def outcome_words(judge: str, parts: Sequence[Mapping[str, Any]]) -> str:
    """What the second checker, or Coq, has said of the parts of a certificate when it was asked."""
    name, verb = {"coq": ("Coq", "proved"), "ocaml": ("second checker", "accepted")}[judge]
    outcomes = [outcome for outcome in read_outcomes(judge, parts) if outcome]
    if not outcomes:
        return f"{name} not asked"
    counts = Counter(outcome["status"] for outcome in outcomes)
    words = {"PROVED": verb, "FAILED": f"not {verb}", "UNWRITTEN": "no words for it"}
    said = ", ".join(f"{words[status]} {count} of {len(parts)}" for status, count in sorted(counts.items()))
    return f"{name} ({', '.join(sorted({outcome['version'] for outcome in outcomes}))}): {said}"
