"""Campaigns: many small attacks in batches, kept in the store, so that a stopped one goes on.

A campaign is a list of batches, each plain data, and a judge that turns a batch into counts and a
list of what went wrong. What is kept depends on the batch, on navsym's sources and on the engines:
when any of them changes the batch is run again.
"""

from __future__ import annotations

import multiprocessing
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from navsym.core.sandbox import Exhausted, Failed, run_many
from navsym.core.store import Store, StoreError, code_digest, key_of

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


def deal(subjects: Sequence[Any], inputs: int, size: int, seed: int) -> list[Batch]:
    """``inputs`` attacks in batches of at most ``size``, the subjects in turn.

    A judge receives the subject, the number of attacks, and a seed of this batch alone.
    """
    sizes = [min(size, inputs - first) for first in range(0, inputs, size)]
    tasks = [(subjects[k % len(subjects)], n, seed * 10**6 + k) for k, n in enumerate(sizes)]
    return [Batch(repr(task), task) for task in tasks]


def result(
    counts: Counter[str], wrong: Sequence[Any] = (), undecided: Sequence[Any] = (), kept: Sequence[Any] = ()
) -> Result:
    """The record of one batch: plain data for the store."""
    return {"counts": dict(counts), "wrong": [*wrong], "open": [*undecided], "kept": [*kept]}


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
    keys = [key_of("campaign", campaign, batch.name, code_digest()) for batch in batches]
    known = store.get(keys) if store is not None else {}
    todo = [place for place, key in enumerate(keys) if key not in known]
    results, stopped = [known[key] for key in keys if key in known], []
    unsaved: list[str] = []
    for outcome in run_many(lambda place: judge_freely(judge, batches[place].items), todo, jobs, seconds):
        place = todo[outcome.place]
        name, value = batches[place].name, outcome.value
        if isinstance(value, (Exhausted, Failed)):
            stopped.append(f"{name}: {value.why if isinstance(value, Exhausted) else value.error}")
        else:
            results.append(value)
            if store is not None and not is_stored(store, keys[place], value):
                unsaved.append(name)
        progress(len(results) + len(stopped), len(batches))
    merged = {"campaign": campaign, "batches": len(batches), **merge_results(results)}
    return {**merged, "stopped": sorted(stopped), "resumed": len(known), "unsaved": unsaved}


def judge_freely(judge: Callable[[Any], Result], items: Any) -> Result:
    """Judge a batch in a worker, which may have children of its own, since what a judge runs may crash or never end."""
    multiprocessing.current_process().daemon = False
    return judge(items)


def is_stored(store: Store, key: str, value: Result) -> bool:
    """True when the store has taken the result."""
    try:
        store.put(key, value)
    except StoreError:
        return False
    return True


def merge_results(results: Sequence[Result]) -> dict[str, Any]:
    """Counts added up; wrong and open items one after the other; what each reader of files measured, at the largest."""
    counts: Counter[str] = Counter()
    measured: dict[str, dict[str, float]] = {}
    for one in results:
        counts.update(one["counts"])
        for item in (item for item in one["kept"] if "reader" in item):
            largest = measured.setdefault(item["reader"], {})
            largest.update({name: max(n, largest.get(name, n)) for name, n in item.items() if name != "reader"})
    return {
        "counts": dict(sorted(counts.items())),
        "wrong": [item for one in results for item in one["wrong"]],
        "open": [item for one in results for item in one["open"]],
        "measured": dict(sorted(measured.items())),
    }
