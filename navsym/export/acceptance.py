"""Certificates replayed by the independent checker, and exported code run again on its vectors."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from navsym import checker
from navsym.claims.display import write_card, write_table
from navsym.core.answers import Answer, Answers
from navsym.core.errors import DomainError, EmptyError, NavsymError
from navsym.export.replay import Replay, replay, require_kernel
from navsym.export.roundtrip import check_export
from navsym.language.files import decode
from navsym.language.jsonfile import require_unique_keys
from navsym.language.names import quote

LARGEST = 50_000_000
NAMED = 12  # letters of a hash, which name a kept certificate
#: Every key that a certificate has: a file of nothing else is one, even if it lost its kind.
KEYS = frozenset(
    "kind left right symbols matrix solution variable rank point rows null expression box bits cells of panels "
    "functional dual support lower upper contacts radius parameter from to pieces".split()
)


@dataclass(frozen=True, slots=True)
class Check:
    """One certificate, or the code of one language: accepted, or rejected and why."""

    path: str
    kind: str | None
    status: str
    why: str
    kernel: Replay | None = None

    @property
    def holds(self) -> bool:
        """Whether it is accepted, and proved by the kernel where one was asked."""
        return self.status == "ACCEPTED" and (self.kernel is None or self.kernel.status == "PROVED")

    def words(self) -> tuple[str, str, str, str]:
        """Place, kind, status and reason for people."""
        if self.kernel is None:
            return self.path, self.kind or "", self.status, self.why
        axioms = f"{len(self.kernel.axioms)} axioms" if self.kernel.status == "PROVED" else self.kernel.why
        return self.path, self.kind or "", f"{self.status}, {self.kernel.name}: {self.kernel.status}", axioms

    def document(self) -> dict[str, Any]:
        """Its part of the JSON document; ``kernel`` where one was asked."""
        fields = asdict(self)
        if self.kernel is None:
            del fields["kernel"]
        return fields


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Checks(Answers[Check]):
    """The results of checking, in order.

    checked     : a :class:`Check` for each certificate and each exported language
    interrupted : True when Ctrl-C ended the work early
    """

    checked: tuple[Check, ...]
    interrupted: bool = False

    @property
    def accepted(self) -> bool:
        """True when everything was accepted, and proved by the kernel where one was asked."""
        return all(row.holds for row in self.checked)

    def __bool__(self) -> bool:
        return self.accepted

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym check``."""
        rows = {"checked": [row.document() for row in self.checked]}
        return {**rows, "interrupted": True} if self.interrupted else rows

    def __repr__(self) -> str:
        rejected = sum(not row.holds for row in self.checked)
        return f"<{len(self)} checked, {f'{rejected} REJECTED' if rejected else 'all ACCEPTED'}>"

    def _repr_html_(self) -> str:
        listed = write_table(("path", "kind", "status", "why"), [row.words() for row in self.checked])
        return write_card([listed], "PROVED" if self.accepted else "REFUTED")


#: A place to check, and how.
Part = tuple[str, Callable[[], list[Check]]]


def check(
    *items: Any,
    kernel: str | None = None,
    out: str | os.PathLike[str] | None = None,
    progress: Callable[[int, int, str], None] = lambda done, of, doing: None,
) -> Checks:
    """Replay certificates in the independent checker, and run exported code on its own vectors.

    items    : paths of certificates (JSON), of documents with certificates in them, such as ``--json`` prints and
               ``verify`` keeps, of exported folders or of folders of these; certificates as plain data; answers, of
               which every certificate is replayed
    kernel   : ``"coq"`` has Coq prove the statement of every accepted certificate as well, from a theory in ``out``;
               ``"ocaml"`` asks the second checker; UNWRITTEN and FAILED count as not confirmed
    out      : folder of the theories; default: beside the certificate's file, build/coq for answers
    progress : called with (done, all, name) after each

    Raises EmptyError where there is nothing to check, NavsymError for a path that does not exist, MissingEngineError
    where the kernel is not on this machine.

    >>> import navsym as nav
    >>> drift = nav.solve("examples/schuler-velocity.toml", "drift", T="pi/2")
    >>> nav.check(drift)
    <1 checked, all ACCEPTED>
    >>> forged = dict(drift.certificate, upper="4.8")
    >>> nav.check(forged)[0].status
    'REJECTED'
    """
    if kernel is not None:
        require_kernel(kernel)
    asked = Asked(kernel, None if out is None else Path(out))
    parts = [part for item in items for part in parts_of(item, asked)]
    rows: list[Check] = []
    try:
        for done, (name, run) in enumerate(parts, start=1):
            rows += run()
            progress(done, len(parts), name)
    except KeyboardInterrupt as error:
        error.checks = Checks(tuple(rows), interrupted=True)  # type: ignore[attr-defined]
        raise
    if not rows:
        where = str(items[0])[:200] if items and isinstance(items[0], (str, os.PathLike)) else "check"
        raise EmptyError("expected certificates; got none; name JSON files or exported folders", where=where)
    return Checks(tuple(rows))


@dataclass(frozen=True, slots=True)
class Asked:
    """The kernel that was asked for, and the folder of its theories."""

    kernel: str | None
    out: Path | None

    def confirm(self, row: Check, certificate: Mapping[str, Any], beside: Path) -> Check:
        """The row with the kernel's word on an accepted certificate."""
        if self.kernel is None or row.status != "ACCEPTED":
            return row
        folder = beside.parent if self.out is None else self.out
        folder.mkdir(parents=True, exist_ok=True)
        return replace(row, kernel=replay(certificate, folder / f"{beside.stem}.v", self.kernel))


def parts_of(item: Any, asked: Asked) -> list[Part]:
    """The work that an item brings: its files, the exported code of a folder, its certificates."""
    if isinstance(item, Answer):
        written = getattr(item, "out", None)
        return parts_of(written, asked) if isinstance(written, Path) else certificate_parts(item.certificates(), asked)
    if isinstance(item, Mapping):
        return certificate_parts([item], asked)
    if not isinstance(item, (str, os.PathLike)):
        message = f"expected a path, an answer or a certificate; got {quote(item)}; name one of these"
        raise DomainError(message, where="check")
    path = Path(item)
    if not os.path.exists(path):  # False, too, of a name that no system takes
        message = "expected a file or folder that exists; got none of this name; correct it"
        raise NavsymError(message, where=str(path), kind="missing-file")
    if not path.is_dir():
        parts = file_parts(path, asked)
        if not parts:
            message = "expected a certificate, or a document with some in it; got one without; name another file"
            raise EmptyError(message, where=str(path))
        return parts
    parts = [(path.name, lambda: [Check(**row) for row in check_export(path)])]
    return parts + [part for file in sorted(path.rglob("*.json")) for part in file_parts(file, asked, inside=True)]


def file_parts(path: Path, asked: Asked, *, inside: bool = False) -> list[Part]:
    """The file as a certificate, or one part for each certificate of a document, named by where it stands there.

    Data of other shapes have none when they lie in a folder: vectors and manifests do not count.
    """
    whole: list[Part] = [(path.name, lambda: [check_file(path, asked)])]
    try:
        document = json.loads(path.read_bytes(), object_pairs_hook=lambda pairs: require_unique_keys(pairs, str(path)))
    except (OSError, ValueError, RecursionError, NavsymError):
        return whole
    if not isinstance(document, dict) or not document:
        return [] if inside else whole
    if "kind" in document or document.keys() <= KEYS:
        return whole
    parts = [(name or path.name, *part) for name, *part in find_certificates(document)]
    return [(name, partial(check_beside, name, part, status, asked)) for name, part, status in parts]


def check_beside(name: str, certificate: Any, status: Any, asked: Asked) -> list[Check]:
    """A certificate of a document; rejected where it does not show what the status beside it says."""
    rows = check_plain(name, certificate, asked)
    kinds = {row.kind for row in rows}
    differs = kinds & {"counterexample", "sized"} if status != "REFUTED" else kinds <= {"proof", "words"}
    if status in ("PROVED", "CERTIFIED", "REFUTED") and differs:
        return [replace(row, status="REJECTED", why=f"not a certificate of what is {status}") for row in rows]
    return rows


def find_certificates(document: Any, place: str = "") -> Iterator[tuple[str, Any, Any]]:
    """What stands under ``certificate`` anywhere in a document, its place, and the status beside; null is none."""
    entries = document.items() if isinstance(document, dict) else enumerate(document, start=1)
    for key, entry in entries:
        if key == "certificate" and entry is not None:
            yield place, entry, document.get("status")
        elif isinstance(entry, dict | list):
            yield from find_certificates(entry, f"{place}.{str(key)[:NAMED]}".strip("."))


def certificate_parts(certificates: list[Mapping[str, Any]], asked: Asked) -> list[Part]:
    """One part for each certificate of an answer."""
    names = [f"certificate {place}" for place in range(1, len(certificates) + 1)]
    return [(n, partial(check_plain, n, c, asked)) for n, c in zip(names, certificates, strict=True)]


def check_plain(name: str, certificate: Any, asked: Asked) -> list[Check]:
    """A certificate as plain data, through the text that a file would hold; the parts of one that joins several."""
    kind = certificate.get("kind") if isinstance(certificate, Mapping) else None
    of = certificate.get("of") if kind == "all" and len(certificate) == 2 else None
    if isinstance(of, list) and of:
        parts = enumerate(of, start=1)
        return [row for place, part in parts for row in check_plain(f"{name}.{place}", part, asked)]
    beside = Path("build", "coq", f"{name.replace(' ', '-').replace('.', '-')}.json")
    try:
        text = json.dumps(certificate)
    except (TypeError, ValueError) as error:
        return [Check(name, kind if isinstance(kind, str) else None, "REJECTED", str(error))]
    return [check_text(name, text, beside, asked)]


def check_text(name: str, text: str, beside: Path, asked: Asked) -> Check:
    """The text of a certificate."""
    certificate: Any = None
    try:
        certificate = checker.load(text)
        row = Check(name, checker.check(certificate), "ACCEPTED", "")
    except checker.Refused as error:
        kind = certificate.get("kind") if isinstance(certificate, dict) else None
        return Check(name, kind if isinstance(kind, str) else None, "REJECTED", str(error))
    return asked.confirm(row, certificate, beside)


def check_file(path: Path, asked: Asked) -> Check:
    """A certificate in a file."""
    try:
        if path.stat().st_size > LARGEST:
            return Check(str(path), None, "REJECTED", "longer than 50 MB")
        text = decode(path.read_bytes(), str(path))
    except OSError as error:
        return Check(str(path), None, "REJECTED", f"cannot be read: {error.strerror}")
    except NavsymError as error:
        return Check(str(path), None, "REJECTED", error.message)
    return check_text(str(path), text, path, asked)
