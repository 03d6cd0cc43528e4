"""Verdicts with certificates, kept under the hash of what they decide: the checker grants each again before its use.

Two places hold them: ``certificates.json`` beside the ledger, committed with the papers, and the user's own store. What
is damaged there, belongs to another statement or is refused by the checker costs a search and nothing else.
"""

from __future__ import annotations

import contextlib
import json
import signal
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec

from navsym.checker import Refused
from navsym.claims import REFUTED, Record, Verdict
from navsym.claims.paper import papers_folder
from navsym.claims.workspace import cache_file, find_workspace
from navsym.core.errors import NavsymError, ShapeError
from navsym.core.numbers import Number
from navsym.core.store import Store, StoreError, key_of, open_store
from navsym.language.jsonfile import read_json
from navsym.prove.grant import grant, is_granted

LARGEST = 200_000_000  # bytes of the file
NAMED = 12  # claims that a remark names
#: What of a record is kept: all that does not come from the source.
KEPT = ("status", "method", "scope", "assumptions", "evidence", "counterexample", "difference", "certificate")
#: Who may look at a certificate beside the checker.
JUDGES = ("coq", "ocaml")
REMEDY = "restore the file, or make it again with navsym verify --write"


def certificates_file() -> Path:
    """The file of certificates: ``certificates.json`` of the workspace, or beside the papers."""
    workspace = find_workspace()
    return papers_folder() / "certificates.json" if workspace is None else workspace.certificates_file


def read_certificates() -> dict[str, Any]:
    """Verdicts with certificates, as plain data by the hash of their statement; empty when there is no file yet.

    Raises NavsymError for a file that holds something else.
    """
    path = certificates_file()
    if not path.exists():
        return {}
    document = read_json(path, limit=LARGEST)
    if not isinstance(document, dict):
        got = f"{type(document).__name__}"
        raise ShapeError(f"expected certificates by the hash of their statement; got {got}; {REMEDY}", where=str(path))
    return document


def certificates_text(entries: Mapping[str, Any]) -> str:
    """The file's text: sorted, one line for each statement."""
    lines = [f"{json.dumps(key)}: {json.dumps(entries[key], sort_keys=True)}" for key in sorted(entries)]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def collect_certificates(records: Iterable[Record]) -> dict[str, Any]:
    """The entries of these records, made anew or, where a record comes from the ledger, those of the file."""
    old: Mapping[str, Any] = {}
    with contextlib.suppress(NavsymError):  # damaged certificates cost a search
        old = read_certificates()
    records = list(records)
    new = {record.statement: keep_entry(record) for record in records if is_kept(record)}
    return {record.statement: old[record.statement] for record in records if record.statement in old} | new


def keep_entry(record: Record) -> dict[str, Any]:
    """What is kept of a record, as plain data."""
    values = record.to_json()
    return {name: values[name] for name in KEPT}


def is_kept(record: Record) -> bool:
    """True of a verdict that rests on a certificate which the checker grants."""
    return bool(record.statement) and is_granted(verdict_of(record))


def verdict_of(record: Record) -> Verdict:
    """The verdict of a record, without the source's part."""
    return Verdict(**{name: getattr(record, name) for name in KEPT})


def grant_entry(texts: list[dict[str, Any]], entry: Any, seconds: float) -> Verdict | None:
    """The kept verdict when the checker grants it to the statement again within its time; else None."""
    try:
        verdict = read_entry(entry)
        certificate = verdict.certificate or {}
        with limited_time(seconds):
            answer = grant(texts, certificate)
    except (Refused, msgspec.MsgspecError, TypeError, ValueError, LookupError, RecursionError):
        return None
    if answer == "HOLDS":
        return verdict if verdict.status.holds else None
    point = certificate.get("point", {})
    same = all(point.get(name, value) == value for name, value in (verdict.counterexample or {}).items())
    return verdict if verdict.status == REFUTED and same else None


def read_entry(entry: Mapping[str, Any]) -> Verdict:
    """The verdict of an entry; raises one of several errors for what is none."""
    ends = entry["difference"]
    values = {name: entry[name] for name in KEPT} | {"difference": None if ends is None else Number(*ends)}
    return msgspec.convert(values, Verdict, from_attributes=True)


@contextlib.contextmanager
def limited_time(seconds: float) -> Iterator[None]:
    """Refuse a certificate whose check takes longer: what somebody else wrote must not take the search's time."""

    def stop(*_: Any) -> None:
        raise Refused(f"more than {seconds:g} s")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


class Certificates:
    """What is kept on the statements of papers; ``lost`` names claims whose new verdict could not be kept.

    fresh  : use nothing of it, and keep what is new
    remark : called with a sentence when something cannot be used or kept
    """

    def __init__(self, fresh: bool, remark: Callable[[str], None]) -> None:
        self.entries: Mapping[str, Any] = {}
        self.fresh, self.remark, self.lost = fresh, remark, list[str]()
        self.store: Store | None = None
        try:
            self.entries = {} if fresh else read_certificates()
        except NavsymError as error:
            remark(f"certificates are searched again: {error}")
        try:
            self.store = Store(cache_file())
        except StoreError as error:
            remark(f"verdicts are not kept: {error}")

    def list_entries(self, key: str) -> Iterator[Any]:
        """What is kept under the hash of a statement; in a child process, with a connection of its own."""
        if key in self.entries:
            yield self.entries[key]
        if self.store is None or self.fresh:
            return
        with contextlib.suppress(StoreError), open_store(self.store.path) as own:
            yield from own.get([store_key(key)]).values()

    def keep(self, record: Record) -> None:
        """Keep a verdict that was decided now, when it rests on a granted certificate."""
        if not is_kept(record):
            return
        try:
            if self.store is None:
                raise StoreError("expected a store; got none; see above")
            self.store.put(store_key(record.statement), keep_entry(record))
        except StoreError as error:
            if not self.lost and self.store is not None:
                self.remark(f"verdicts are not kept any more: {error}")
            self.lost.append(record.id)

    def close(self) -> None:
        """Close the store, and name the claims whose verdicts are lost."""
        if self.store is not None:
            self.store.close()
        if self.lost:
            names = ", ".join(self.lost[:NAMED]) + " …" * (len(self.lost) > NAMED)
            self.remark(f"not kept: {len(self.lost)} verdicts: {names}")


def list_parts(certificate: Mapping[str, Any]) -> Sequence[Mapping[str, Any]]:
    """The certificates of the entries of a claim, or the one of all of it."""
    return certificate["of"] if certificate.get("kind") == "all" else [certificate]


def store_key(statement: str) -> str:
    """The key in the user's store for the hash of a statement."""
    return key_of("certificate", statement)


def keep_outcome(judge: str, certificate: Mapping[str, Any], outcome: Mapping[str, Any]) -> None:
    """Keep what one of JUDGES said of a certificate, under the certificate's own text."""
    with contextlib.suppress(StoreError), open_store(cache_file()) as own:
        own.put(outcome_key(judge, certificate), outcome)


def read_outcomes(judge: str, certificates: Sequence[Mapping[str, Any]]) -> list[dict[str, Any] | None]:
    """What one of JUDGES said of each certificate when it was asked last; None where it was not asked."""
    keys, kept = [outcome_key(judge, certificate) for certificate in certificates], dict[str, Any]()
    with contextlib.suppress(StoreError), open_store(cache_file()) as own:
        kept = own.get(keys)
    return [kept.get(key) for key in keys]


def outcome_key(judge: str, certificate: Mapping[str, Any]) -> str:
    """The key in the user's store for a certificate and the one who looked at it."""
    return key_of("outcome", judge, json.dumps(certificate))
