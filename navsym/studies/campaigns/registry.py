"""Campaigns: many small attacks in batches, kept in the store, so that a stopped one goes on.

A campaign is a list of batches, each plain data, and a judge that turns a batch into counts and a
list of what went wrong. What is kept depends on the batch, on the deciding rooms and on the engines:
when any of them changes the batch is run again.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from navsym.core.sandbox import Exhausted, Failed, run_many
from navsym.core.store import Store, StoreError, key_of
from navsym.verification.fingerprints import rooms_digest

#: What a judge returns: counts by outcome, wrong results, undecided ones, exact points of refutations.
Result = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Batch:
    """One piece of a campaign.

    name  : text that fixes what is attacked; the same name gives the same attacks
    items : what the judge receives
    """

    name: str
    items: Any


def result(counts: Counter[str], wrong: list[Any], undecided: list[Any], kept: list[Any]) -> Result:
    """The record of one batch: plain data for the store."""
    return {"counts": dict(counts), "wrong": wrong, "open": undecided, "kept": kept}


def run_campaign(
    campaign: str,
    batches: Sequence[Batch],
    judge: Callable[[Any], Result],
    *,
    store: Store | None = None,
    jobs: int = 1,
    seconds: float = 300.0,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> dict[str, Any]:
    """Judge every batch that is not yet in the store; the document of ``navsym campaign``.

    Keys: ``campaign``, ``batches``, ``resumed`` (taken from the store), ``counts``, ``wrong`` (must be
    empty), ``open`` (undecided, with the reason), ``stopped`` (batches over their limit), ``measured`` (largest
    seconds, megabytes and lines reached, of each reader of files) and ``unsaved`` (batches that the store did
    not take: they count here, and another run will do them again).
    """
    keys = [key_of("campaign", campaign, batch.name, rooms_digest()) for batch in batches]
    known = store.get(keys) if store is not None else {}
    todo = [place for place, key in enumerate(keys) if key not in known]
    results, stopped = [known[key] for key in keys if key in known], []
    unsaved: list[str] = []
    for outcome in run_many(lambda place: judge(batches[place].items), todo, jobs, seconds):
        place = todo[outcome.place]
        if isinstance(outcome.value, (Exhausted, Failed)):
            stopped.append(f"{batches[place].name}: {reason(outcome.value)}")
        else:
            results.append(outcome.value)
            if store is not None and not kept(store, keys[place], outcome.value):
                unsaved.append(batches[place].name)
        progress(len(results) + len(stopped), len(batches))
    whole = document(campaign, len(batches), results, stopped)
    return {**whole, "resumed": len(known), "unsaved": unsaved}


def kept(store: Store, key: str, value: Result) -> bool:
    """True when the store took the result."""
    try:
        store.put(key, value)
    except StoreError:
        return False
    return True


def reason(value: Exhausted | Failed) -> str:
    """Why a batch has no result: the limit that it reached, or the error that ended it."""
    return value.why if isinstance(value, Exhausted) else str(value.error)


def document(campaign: str, batches: int, results: Sequence[Result], stopped: list[str]) -> dict[str, Any]:
    """The results of the batches as one: counts added up, wrong and open items one after the other.

    stopped : names of batches without a result, each with the reason; sorted in the document

    ``measured`` has what the batches of each reader of files measured, the largest of each.
    """
    counts: Counter[str] = Counter()
    for found in results:
        counts.update(found["counts"])
    return {
        "campaign": campaign,
        "batches": batches,
        "counts": dict(sorted(counts.items())),
        "wrong": [item for found in results for item in found["wrong"]],
        "open": [item for found in results for item in found["open"]],
        "stopped": sorted(stopped),
        "measured": measured(results),
    }


def measured(results: Sequence[Result]) -> dict[str, dict[str, float]]:
    """Reader -> name -> the largest number that a batch of this reader kept under the name."""
    found: dict[str, dict[str, float]] = {}
    for item in (item for one in results for item in one["kept"] if "reader" in item):
        known = found.setdefault(item["reader"], {})
        known.update({name: max(value, known.get(name, value)) for name, value in item.items() if name != "reader"})
    return dict(sorted(found.items()))
