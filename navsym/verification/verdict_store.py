"""Verdicts of earlier runs: which are still valid, and which may be kept."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from navsym.claims import Record
from navsym.claims.paper import papers_folder
from navsym.core.store import Store, StoreError
from navsym.verification.fingerprints import Snapshot, fingerprints, not_yet_imported, snapshot
from navsym.verification.papers import PaperModule

NAMED = 12  # claims that a remark names


def sources() -> Snapshot:
    """Times and sizes of the sources of the papers and of the deciding rooms, as they are now."""
    return snapshot(papers_folder())


class VerdictStore:
    """Verdicts of claims whose sources have not changed, by id in ``known``; ``lost`` names those not kept.

    before : the sources before they were imported: of those that changed nobody knows which version ran
    fresh  : take nothing from the store
    remark : called with a sentence when something is not kept
    """

    def __init__(
        self, chosen: Sequence[PaperModule], fresh: bool, before: Snapshot, remark: Callable[[str], None]
    ) -> None:
        self.keys = fingerprints(claim for module in chosen for claim in module.claims)
        self.mixed = sources() != before
        self.later = not_yet_imported(sources())
        self.known: dict[str, Record] = {}
        self.store: Store | None = None
        self.lost: list[str] = []
        self.remark = remark
        try:
            self.store = Store()
            records = {} if fresh else self.store.get(self.keys.values())
            self.known = {name: Record.from_json(records[key]) for name, key in self.keys.items() if key in records}
        except StoreError as error:
            self.lost = [name for name in self.keys if name not in self.known]
            if self.store is not None:
                self.store.close()
            self.store = None  # what cannot be read is not written either, and named once
            remark(f"verdicts are not kept: {error}")

    def keep(self, record: Record) -> None:
        """Keep a verdict, unless it ran out of time, which another run may not."""
        if self.store is None or record.method == "none":
            return  # without a store all are named as lost already
        try:
            if self.mixed or not set(self.later) <= set(sources()):
                raise StoreError("expected sources that stay as they are; got changed ones; run it again")
            self.store.put(self.keys[record.id], record.to_json())
        except StoreError as error:
            if not self.lost:
                self.remark(f"verdicts are not kept any more: {error}")
            self.lost.append(record.id)

    def close(self) -> None:
        """Close the file, and say which verdicts are lost."""
        if self.store is not None:
            self.store.close()
        if self.lost:
            names = ", ".join(self.lost[:NAMED]) + " …" * (len(self.lost) > NAMED)
            self.remark(f"not kept: {len(self.lost)} verdicts: {names}")
