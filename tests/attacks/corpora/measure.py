"""The front door against public corpora that lie on this machine: the table of docs/corpora.md.

``python -m tests.attacks.corpora.measure FOLDER [--every 6] [--out ROWS.jsonl] [--seconds-in-all 900]``, where FOLDER
holds checkouts named MathematicaSyntaxTestSuite, herbie and hol-light.
"""

from __future__ import annotations

import argparse
import json
import statistics
import time
from collections.abc import Iterator
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from typing import Any

from tests.attacks.corpora import inequalities, integrals, rules
from tests.attacks.statements import attack

CORPORA = {"antiderivatives": integrals, "rewrite rules": rules, "inequalities": inequalities}
COLUMNS = ("PROVED", "CERTIFIED", "REFUTED", "CONFIRMED", "OPEN", "refused", "wrong")
SECONDS = 10.0


def measure(corpus: str, checkout: Path, every: int, limit: float) -> Iterator[dict[str, Any]]:
    """A row for each statement that is asked: every so manieth that fits, as long as the clock allows."""
    end = time.monotonic() + limit
    fitting = [(place, statement) for place, statement in CORPORA[corpus].read_entries(checkout) if statement]
    for place, statement in fitting[::every]:
        if time.monotonic() > end:
            return
        start = processor_time()
        found = attack(statement, SECONDS)
        spent = round(processor_time() - start, 3)
        status = found.outcome if found.outcome in ("wrong", "refused") else found.status
        row = {"corpus": corpus, "place": place, "text": statement.text, "symbols": dict(statement.symbols)}
        yield row | {"status": status, "outcome": found.outcome, "why": found.why, "seconds": spent}


def processor_time() -> float:
    """Of this process and of its children that have ended, seconds."""
    children = getrusage(RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def make_table(rows: list[dict[str, Any]], entries: dict[str, tuple[int, int]]) -> str:
    """Markdown: a row for each corpus.

    entries : corpus -> (all entries, those that fit the language)
    """
    names = ("corpus", "entries", "fit", "asked", *COLUMNS, "false CONFIRMED", "decided, %", "median, s", "largest, s")
    lines = [f"| {' | '.join(names)} |", "| --- |" + " ---: |" * (len(names) - 1)]
    for corpus, (total, fit) in entries.items():
        of_it = [row for row in rows if row["corpus"] == corpus]
        counts = [sum(row["status"] == column for row in of_it) for column in COLUMNS]
        false = sum(row["outcome"] == "false confirmed" for row in of_it)
        seconds = [row["seconds"] for row in of_it] or [0.0]
        share = 100 * sum(counts[:3]) / max(1, len(of_it))
        cells = [corpus, total, fit, len(of_it), *counts, false, f"{share:.1f}"]
        cells += [f"{statistics.median(seconds):.2f}", f"{max(seconds):.1f}"]
        lines.append(f"| {' | '.join(map(str, cells))} |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--corpus", choices=CORPORA, action="append")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--seconds-in-all", type=float, default=1e9)
    parser.add_argument("--out", type=Path, default=Path("corpora.jsonl"))
    words = parser.parse_args()
    rows, entries = [], {}
    with words.out.open("a", encoding="utf-8") as out:
        for corpus in words.corpus or CORPORA:
            checkout = words.folder / CORPORA[corpus].REPOSITORY
            known = [statement for _, statement in CORPORA[corpus].read_entries(checkout)]
            entries[corpus] = len(known), sum(statement is not None for statement in known)
            for row in measure(corpus, checkout, words.every, words.seconds_in_all):
                rows.append(row)
                out.write(json.dumps(row) + "\n")
                out.flush()
    print(make_table(rows, entries))


if __name__ == "__main__":
    main()
