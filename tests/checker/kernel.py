"""All certificates of the ledger or of the book through Coq: what it proves, and what not, by reason.

Theories with the same libraries go through one ``coqtop``, each in a module of its own: to load the libraries takes a
second, and most theorems take a few hundredths of one. The axioms are read once for all that one process proved. What
is known of a theory is kept by its content in a file, and a stopped run goes on from there. The limits inside of the
theories are of wall time: a failure of a process that had less than half of a processor is not kept, and asked again.

    python tests/checker/kernel.py ledger build/kernel.jsonl
    python tests/checker/kernel.py book build/kernel.jsonl --seconds 60 --first 300
"""

from __future__ import annotations

import argparse
import json
import os
import random
import re
import select
import subprocess
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

import navsym as nav
from navsym.core.errors import DomainError
from navsym.core.store import key_of
from navsym.export.coq.theory import BALLS, LEMMAS, PLAIN, write_theory
from navsym.export.replay import coq_version, read_axioms

ROOT = Path(__file__).resolve().parents[2]
LIBRARY = re.compile(r"^(?:From \w+ )?Require .*$", re.M)


def read_ledger() -> Iterator[tuple[str, Any]]:
    """The kept certificates."""
    kept = json.loads((ROOT / "derivations/certificates.json").read_text("utf-8"))
    yield from ((key, row["certificate"]) for key, row in kept.items())


def read_book(first: int | None) -> Iterator[tuple[str, Any]]:
    """Certificates of decided entries of the book, searched now; of some, in an order that is drawn."""
    entries = [entry for entry in nav.book.values() if entry.status != "OPEN"]
    random.Random(25).shuffle(entries)
    yield from ((entry.id, entry.prove().certificate) for entry in entries[:first])


def split_theory(text: str) -> tuple[str, str]:
    """What many theories begin with, and what one says."""
    head = [*LIBRARY.findall(text), "Open Scope R_scope."]
    lemmas = [files("navsym.export.coq").joinpath(name).read_text("utf-8") for name in LEMMAS]
    head += [part for part in (BALLS, PLAIN, *lemmas) if part in text]
    body = LIBRARY.sub("", text).replace("Print Assumptions all.\n", "")
    for part in head:
        body = body.replace(part, "")
    return "\n".join(head), body


class Coq:
    """One process with libraries, to which theories are said."""

    def __init__(self, head: str) -> None:
        self.folder = tempfile.TemporaryDirectory()  # of what its tactics keep
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
        self.process = subprocess.Popen(["coqtop", "-q", "-w", "none"], cwd=self.folder.name, **pipes)
        assert self.process.stdin is not None and self.process.stdout is not None
        self.ends = self.process.stdin.fileno(), self.process.stdout.fileno()
        for end in self.ends:
            os.set_blocking(end, False)
        self.proved = list[str]()
        self.count = 0
        assert "Error" not in self.say(head, 600)[0]

    def seconds(self) -> float:
        """Its processor time."""
        rows = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(rows[11]) + int(rows[12])) / os.sysconf("SC_CLK_TCK")

    def say(self, text: str, limit: float) -> tuple[str, float]:
        """What it answers to a text, and the processor time; more than the limit ends it."""
        self.count += 1
        mark, said, began = f"sentinel_{self.count}", b"", self.seconds()
        rest = f"{text}\nFail Check {mark}.\n".encode()
        while f"{mark} was not found".encode() not in said:
            readable, writable, _ = select.select([self.ends[1]], [self.ends[0]] if rest else [], [], 1)
            if writable:
                rest = rest[os.write(self.ends[0], rest[:4096]) :]
            if readable:
                said += os.read(self.ends[1], 1 << 20)
            if self.process.poll() is not None or self.seconds() - began > limit:
                self.process.kill()
                self.process.wait()
                return "Error: more processor time or memory than it had", limit
        return said.decode("utf-8", "replace"), self.seconds() - began

    def prove(self, body: str, limit: float) -> dict[str, Any]:
        """What it says of a theory."""
        name, began = f"M{self.count}", time.monotonic()
        said, seconds = self.say(f"Module {name}.\n{body}\nAbort All.\nEnd {name}.", limit)
        wrong = re.findall(r"^(?:Error:|Syntax error).*(?:\n.+)?", said, re.M)
        status = "FAILED" if wrong or "all is defined" not in said else "PROVED"
        self.proved += [f"{name}.all"] * (status == "PROVED")
        why, wall = " ".join(" | ".join(wrong)[:300].split()), time.monotonic() - began
        return {"status": status, "seconds": round(seconds, 2), "wall": round(wall, 2), "why": why}

    def end(self) -> tuple[str, ...]:
        """The axioms of all that it proved; then it ends."""
        listed = f"Definition everything := ({', '.join(self.proved)}).\nPrint Assumptions everything."
        axioms = read_axioms(self.say(listed, 600)[0]) if self.proved and self.process.poll() is None else ()
        self.process.kill()
        self.process.wait()
        return axioms


def replay_all(items: Iterator[tuple[str, Any]], kept: Path, limit: float) -> Iterator[Mapping[str, Any]]:
    """A row for each certificate; rows of theories that were asked before come from the file."""
    lines = kept.read_text("utf-8").splitlines() if kept.exists() else []
    known = {row["content"]: row for row in map(json.loads, lines)}
    groups: dict[str, list[tuple[str, str, str]]] = {}
    for name, certificate in items:
        try:
            text = write_theory(certificate)
        except DomainError as reason:
            yield {"name": name, "status": "UNWRITTEN", "seconds": 0, "why": reason.message}
            continue
        content = key_of(coq_version() or "", text)
        if content in known:
            yield known[content] | {"name": name}
        else:
            head, body = split_theory(text)
            groups.setdefault(head, []).append((name, content, body))
    for head, rows in groups.items():
        coq = Coq(head)
        for name, content, body in sorted(rows, key=lambda row: len(row[2])):
            if coq.process.poll() is not None:
                coq = Coq(head)
            row = {"name": name, "content": content} | coq.prove(body, limit)
            if row["status"] == "PROVED" or row["wall"] < 2 * row["seconds"] + 1:
                with kept.open("a", encoding="utf-8") as file:
                    print(json.dumps(row), file=file)
            yield row
        print("axioms of", len(coq.proved), "theories:", ", ".join(coq.end()) or "not read")


def main() -> None:
    """Print what is not proved, and the count."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["ledger", "book"])
    parser.add_argument("kept", type=Path)
    parser.add_argument("--seconds", type=float, default=60, help="processor time for one theory")
    parser.add_argument("--first", type=int, help="so many entries of the book")
    options = parser.parse_args()
    counts, seconds, began = Counter[str](), 0.0, time.monotonic()
    items = read_ledger() if options.what == "ledger" else read_book(options.first)
    for row in replay_all(items, options.kept, options.seconds):
        counts[row["status"]] += 1
        seconds += row["seconds"]
        if row["status"] != "PROVED":
            print(row["name"], row["status"], row["seconds"], row["why"])
    print(dict(counts), f"{seconds:.0f} s of processor time for theories, {time.monotonic() - began:.0f} s in all")


if __name__ == "__main__":
    main()
